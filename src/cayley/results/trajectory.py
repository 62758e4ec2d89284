"""The result of a run: labelled fields of every part, energies and momenta."""

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from cayley.lie import quaternion
from cayley.results.observe import Frames, Observations, observe
from cayley.results.series import Series
from cayley.system.system import State, System

AXES = ["x", "y", "z"]


class Trajectory:
    """What a run left: saved states, and everything that follows from them.

    ``run[rod]`` is a Dataset of a rod, ``run.data`` one of all fields by their names; energies and momenta are
    DataArrays over time. Quantities are evaluated from the saved states when first asked for.
    """

    def __init__(
        self,
        *,
        system: System,
        frames: Frames,
        info: Mapping[str, Any],
        model: Any = None,
        parts: Mapping[str, slice] | None = None,
    ) -> None:
        """Hold the frames of a run of a system; parts are the nodes of each rod by name."""
        self.system, self.frames, self.model = system, frames, model
        self.info = dict(info)
        self._parts = dict(parts or {})

    @property
    def rule(self) -> str:
        """Name of the rule."""
        return self.system.equations.rule.name

    @property
    def dt(self) -> float:
        """Time step [s]."""
        return self.frames.h

    @property
    def steps(self) -> int:
        """Number of steps taken."""
        return int(self.frames.steps[-1] - self.frames.steps[0])

    @property
    def wall_time(self) -> float:
        """Time spent integrating [s], without compilation."""
        return float(self.info["wall_time"])

    @property
    def time(self) -> np.ndarray:
        """Times of the saved frames [s]."""
        return self.frames.times

    @property
    def state(self) -> State:
        """The last state, to go on from."""
        return self.frames.state()

    def __getitem__(self, part: Any) -> xr.Dataset:
        """Fields of one rod, given itself or by name."""
        name = part if isinstance(part, str) else self._name_of(part)
        if name not in self._parts:
            raise KeyError(f"the run has no part {name!r}; it has {', '.join(self._parts) or 'none (use run.data)'}")
        return self._rod(name)

    def __repr__(self) -> str:
        """Say what ran."""
        what = f"{len(self.time)} frames, t = {self.time[0]:g} to {self.time[-1]:g} s"
        parts = f", parts {', '.join(self._parts)}" if self._parts else ""
        return f"<Trajectory: rule {self.rule}, {self.steps} steps of {self.dt:.3g} s, {what}{parts}>"

    @functools.cached_property
    def observed(self) -> Observations:
        """Velocities, energies and forces of all frames."""
        return observe(self.system, self.frames)

    @property
    def kinetic_energy(self) -> xr.DataArray:
        """Kinetic energy, q̇·∂T/∂q̇ − T [J], dims (time,)."""
        return self._series(self.observed.kinetic, "kinetic energy", "J")

    @property
    def potential_energy(self) -> xr.DataArray:
        """Strain energy and energy of the load terms [J], dims (time,)."""
        return self._series(self.observed.strain + self.observed.load, "potential energy", "J")

    @property
    def energy(self) -> xr.DataArray:
        """Total energy [J], dims (time,)."""
        total = self.observed.kinetic + self.observed.strain + self.observed.load
        return self._series(total, "energy", "J")

    @property
    def linear_momentum(self) -> xr.DataArray:
        """Linear momentum, Σ μ_x [kg m/s], dims (time, axis)."""
        total = sum((self._momenta(name).sum(axis=1) for name in self._vectors()), start=np.zeros((len(self.time), 3)))
        return self._series(total, "linear momentum", "kg m/s")

    @property
    def angular_momentum(self) -> xr.DataArray:
        """Angular momentum about the origin, Σ x × μ_x + Λ(p) μ_p [kg m²/s], dims (time, axis)."""
        total = np.zeros((len(self.time), 3))
        for name in self._vectors():
            total += np.cross(self._values(name), self._momenta(name)).sum(axis=1)
        for name in self.system.layout.rotations:
            total += np.asarray(quaternion.rotate(self._rotation(name), self._momenta(name)), dtype=float).sum(axis=1)
        return self._series(total, "angular momentum", "kg m^2/s")

    @functools.cached_property
    def data(self) -> xr.Dataset:
        """Values, velocities (NAME_t) and momenta (NAME_momentum) of all fields."""
        layout = self.system.layout
        interval = self.system.equations.density.lagrangian.interval
        place = () if interval is None else ("node",)
        fields: dict[str, Any] = {}
        for name in layout.fields:
            turns = name in layout.rotations
            width = self._values(name).shape[-1]
            own = "axis" if width == 3 else f"{name}_component"
            value = self._rotation(name) if turns else self._values(name)
            fields[name] = (("time", *place, "wxyz" if turns else own), self._squeeze(value))
            rate = self.observed.velocity[..., layout.dofs_of(name)]
            own = "axis" if turns or width == 3 else f"{name}_component"
            fields[f"{name}_t"] = (("time", *place, own), self._squeeze(rate))
            fields[f"{name}_momentum"] = (("time", *place, own), self._squeeze(self._momenta(name)))
        coordinates: dict[str, Any] = {"time": ("time", self.time, {"units": "s"})}
        if interval is not None:
            coordinates[interval] = ("node", self.system.nodes, {"units": "m"})
        data = xr.Dataset(fields, coordinates)
        return data.assign_coords({d: c for d, c in (("axis", AXES), ("wxyz", list("wxyz"))) if d in data.dims})

    def save(self, path: str | Path) -> None:
        """Write the run to a Zarr store, to be opened with Trajectory.open."""
        from cayley.results.store import save

        save(self, path)

    @classmethod
    def open(cls, path: str | Path) -> "Any":
        """Read a run from a Zarr store."""
        from cayley.results.store import open_run

        return open_run(path)

    def _name_of(self, part: Any) -> str:
        if self.model is None:
            raise KeyError("this run has no model; use run.data, or the name of a part")
        return self.model.name_of(part)

    def _rod(self, name: str) -> xr.Dataset:
        from cayley.results.rod import rod_dataset

        return rod_dataset(self, self._parts[name], name)

    def _series(self, values: np.ndarray, long_name: str, units: str) -> xr.DataArray:
        coordinates: dict[str, Any] = {"time": ("time", self.time, {"units": "s"})}
        dims = ("time",)
        if values.ndim == 2:
            dims, coordinates["axis"] = ("time", "axis"), AXES
        attributes = {"long_name": long_name, "units": units}
        return Series(values, coordinates, dims, name=long_name.replace(" ", "_"), attrs=attributes)

    def _vectors(self) -> list[str]:
        layout = self.system.layout
        return [n for n, kind in layout.fields.items() if n not in layout.rotations and kind.size == 3]

    def _values(self, name: str) -> np.ndarray:
        return self.frames.values[..., self.system.layout.rows_of(name)]

    def _momenta(self, name: str) -> np.ndarray:
        return self.frames.momenta[..., self.system.layout.dofs_of(name)]

    def _rotation(self, name: str) -> np.ndarray:
        return self.system.layout.representation.to_quaternion(self._values(name))

    def _squeeze(self, values: np.ndarray) -> np.ndarray:
        return values if "length" in self.system.named else values[:, 0]


__all__ = ["AXES", "Trajectory"]
