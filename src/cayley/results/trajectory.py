"""The result of a run: labeled fields of every part, energies and momenta."""

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley import extension
from cayley.model import Model
from cayley.model.notebook import html_table
from cayley.results.frames import Frames
from cayley.results.observe import Observations, observe
from cayley.results.outline import Outline
from cayley.results.parts import part_dataset, saved_spans
from cayley.results.residual import residual_speed
from cayley.system.system import State, System

if TYPE_CHECKING:
    import xarray as xr

    from cayley.report.plots import Plots


class Trajectory:
    """What a run left: saved states, and everything that follows from them.

    ``run[part]`` is a Dataset of a rod or body, ``run.port(part, name)`` one of a port, ``run.joint(joint)`` and
    ``run.reaction(support)`` are those of forces, ``run.data`` has all fields by their names; energies and momenta are
    DataArrays over time. Quantities are evaluated from the saved states when first asked for; those of a run opened
    from a store are read from it.
    """

    def __init__(
        self,
        *,
        frames: Frames,
        info: Mapping[str, Any],
        system: System | None = None,
        outline: Outline | None = None,
        observed: Observations | None = None,
        model: Model | None = None,
        parts: Mapping[str, slice] | None = None,
        only: np.ndarray | None = None,
    ) -> None:
        """Hold the frames of a run.

        Args:
            frames: the saved states.
            info: facts of the run; "wall_time" [s] among them.
            system: the system that ran; or else
            outline: its outline, and
            observed: what was observed of it; without it, that is observed when first asked for.
            model: the model it came from, if any.
            parts: nodes of each part by name, among all nodes of the system.
            only: nodes that frames have, in rising order; all without it.
        """
        if system is None and outline is None:
            raise TypeError("Trajectory: give the system, or its outline")
        self.frames, self.model = frames, model
        self.path: Path | None = None
        self.memories: Mapping[int, np.ndarray] = {}  # of frames in a store from which implicit rules go on
        self.seen: Observations | None = None  # of the frames in arrays,
        self.late: Frames | None = None  # and those of the journal with all nodes: where only some are saved
        self.info = dict(info)
        self.only, self.spans = only, dict(parts or {})
        self._parts = self.spans if only is None else saved_spans(self.spans, only)
        for name, given in (("system", system), ("outline", outline), ("observed", observed)):
            if given is not None:
                self.__dict__[name] = given  # where the cached property of that name would put it

    @functools.cached_property
    def system(self) -> System:
        """The system that ran; that of an opened run of a model is compiled when first asked for.

        Raises:
            ValueError: for an opened run with a Lagrangian of your own, whose function is not in the store.
        """
        from cayley.results.reopened import system_of

        return system_of(self)

    @functools.cached_property
    def outline(self) -> Outline:
        """Fields, rows and nodes."""
        return Outline.of(self.system)

    @property
    def rule(self) -> str:
        """Name of the rule."""
        return self.outline.rule

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
    def error_estimate(self) -> float:
        """Estimated largest error of positions from steps in time, over the extent; not a number if dt was given."""
        return float(self.info.get("error_estimate", float("nan")))

    @property
    def why(self) -> str:
        """Why this rule and step were chosen."""
        return str(self.info.get("why", "Rule and step were given, or the step limit of the rule was taken."))

    @property
    def time(self) -> np.ndarray:
        """Times of the saved frames [s]."""
        return self.frames.times

    @property
    def state(self) -> State:
        """The last state, to go on from."""
        return self.frames.state()

    @property
    def residual(self) -> float:
        """Largest speed of a node at the last frame, over the length of its rod [1/s]: how far from rest it is."""
        return residual_speed(self.system, self.state, self.model, self.spans)

    def poses(self, part: Any) -> tuple[np.ndarray, np.ndarray]:
        """Positions and rotations of a part's nodes alone, for programs: nothing else is evaluated.

        Args:
            part: a rod or body of the model, or its name.

        Returns: positions [m], shape (frames, nodes, 3), and unit quaternions wxyz, shape (frames, nodes, 4).

        Raises:
            KeyError: there is no such part.
        """
        nodes = self._parts[self._name_of(part)]
        return self._values("x")[:, nodes], self._rotation("p")[:, nodes]

    def __getitem__(self, part: Any) -> "xr.Dataset":
        """Fields of one rod or body, given itself or by name."""
        return part_dataset(self, part)

    def port(self, part: Any, name: str | None = None) -> "xr.Dataset":
        """Motion of a port: position, rotation of its frame, velocity, angular velocity about its axes.

        Args:
            part: a part or its name, with a name; or a port, such as ``arm.end.offset((0, 0, 0.1))``.
            name: of a body's port, or "start" or "end" of a rod.

        Raises:
            KeyError: there is no such part or port.
        """
        from cayley.results.body import port_dataset, port_of

        return port_dataset(self, *port_of(self, part, name))

    def joint(self, joint: Any) -> "xr.Dataset":
        """Force [N] and moment [N m] of a joint on its second side, in space, the moment about its place there.

        Its first side has the opposite, of a joint to the ground the part. The value at a frame is that of its state,
        by Newton's second law; where steps do not resolve how fast motions are damped, viscous forces in it are of
        velocities that the last three steps say together (results.observe.acting_velocity).

        Args:
            joint: a joint, guide or drive of the model, or its name.

        Raises:
            KeyError: there is no such joint.
        """
        from cayley.results.reactions import joint_dataset

        return joint_dataset(self, joint)

    def reaction(self, support: Any, name: str | None = None) -> "xr.Dataset":
        """Force [N] and moment [N m] by which the ground holds a part, in space, the moment about the held place.

        Values are those of the state of a frame, as in joint.

        Args:
            support: a support, or a joint to the ground or its name; or a place, for all that holds its node to the
                ground together: a port, or a part or its name, with a name.
            name: of a body's port, or "start" or "end" of a rod.

        Raises:
            KeyError: there is no such support or place, or nothing holds it to the ground.
        """
        from cayley.results.reactions import reaction_dataset

        return reaction_dataset(self, support, name)

    @property
    def contacts(self) -> "xr.Dataset":
        """Contacts over time: their number, energy [J], depth and the deepest so far [radii], dims (time,).

        Raises:
            ValueError: if nothing can touch in its model, or frames have some nodes only.
        """
        from cayley.results.contact_dataset import contacts_dataset

        return contacts_dataset(self)

    def contacts_at(self, frame: int) -> "xr.Dataset":
        """All contacts at a frame: partners, their elements, place [m], normal, depth [m] and normal force [N].

        Raises:
            ValueError: as contacts.
            IndexError: there is no such frame.
        """
        from cayley.results.contact_dataset import contacts_at

        return contacts_at(self, frame)

    @property
    def plot(self) -> "Plots":
        """Figures of the run for papers, by Matplotlib: ``run.plot.energy()``, ``run.plot.snapshots()``, ..."""
        made: Plots = extension("plot")(self)
        return made

    def animate(self, path: str | Path, **options: Any) -> Path:
        """Write a film of the run: a .gif, or an .mp4 by the program ffmpeg, which the extra "film" has.

        Args:
            path: of the film; an old one is replaced.
            **options: ``speed`` (seconds of the run in a second of the film), ``fps``, ``part`` (a rod, its name, or a
                list of them).

        Returns: the path.

        Raises:
            ValueError: another ending, or a value that is not positive.
            RuntimeError: for .mp4 without ffmpeg.
        """
        written: Path = extension("animate")(self, path, **options)
        return written

    def _repr_html_(self) -> str:
        """What ran, as a table in a notebook."""
        rows = [
            ("rule", self.rule),
            ("steps", f"{self.steps} of {self.dt:.3g} s"),
            ("time", f"{self.time[0]:g} to {self.time[-1]:g} s, {len(self.time)} frames"),
            ("integrated in", f"{self.wall_time:.3g} s"),
        ]
        for name, nodes in self._parts.items():
            count = nodes.stop - nodes.start
            rows.append((name, f"{count} nodes" if count > 1 else "body"))
        return html_table("Trajectory", rows)

    def __repr__(self) -> str:
        """Say what ran."""
        what = f"{len(self.time)} frames, t = {self.time[0]:g} to {self.time[-1]:g} s"
        parts = f", parts {', '.join(self._parts)}" if self._parts else ""
        return f"<Trajectory: rule {self.rule}, {self.steps} steps of {self.dt:.3g} s, {what}{parts}>"

    @functools.cached_property
    def observed(self) -> Observations:
        """Velocities, energies and forces of all frames."""
        if self.only is None:
            return observe(self.system, self.frames)
        if self.late is None:
            raise ValueError("what was observed of this run is lost, and it saved some nodes only (save_only)")
        found = observe(self.system, self.late).at_nodes(self.only)
        return found if self.seen is None else self.seen.then(found)

    @property
    def kinetic_energy(self) -> "xr.DataArray":
        """Kinetic energy, q̇·∂T/∂q̇ − T [J], dims (time,)."""
        return self._series(self.observed.kinetic, "kinetic energy", "J")

    @property
    def potential_energy(self) -> "xr.DataArray":
        """Strain energy and energy of the load terms [J], dims (time,)."""
        return self._series(self.observed.strain + self.observed.load, "potential energy", "J")

    @property
    def energy(self) -> "xr.DataArray":
        """Total energy [J], dims (time,)."""
        total = self.observed.kinetic + self.observed.strain + self.observed.load
        return self._series(total, "energy", "J")

    @property
    def accounted(self) -> bool:
        """Whether the run kept account of work and loss."""
        return self.frames.work is not None

    @property
    def work(self) -> "xr.DataArray":
        """Work since the start of loads and forces that do not depend on velocities, gravity apart [J], dims (time,).

        Added up every step, Σ h F·v.

        Raises:
            ValueError: if the run kept no account of it.
        """
        return self._series(self._account(0), "work", "J")

    @property
    def dissipated(self) -> "xr.DataArray":
        """Minus the work since the start of forces that depend on velocities [J], dims (time,); as work."""
        return self._series(self._account(1), "dissipated", "J")

    @property
    def energy_balance(self) -> "xr.Dataset":
        """Energy, work, dissipated, and defect = change of energy − work + dissipated [J], dims (time,).

        The defect is what the steps lose or gain; it vanishes with the order of the rule.
        """
        import xarray as xr

        energy, work, dissipated = self.energy, self.work, self.dissipated
        defect = self._series((energy - energy[0] - work + dissipated).values, "defect", "J")
        return xr.Dataset({"energy": energy, "work": work, "dissipated": dissipated, "defect": defect})

    @property
    def linear_momentum(self) -> "xr.DataArray":
        """Linear momentum, Σ μ_x [kg m/s], dims (time, axis)."""
        from cayley.results.totals import linear_momentum

        return self._series(linear_momentum(self), "linear momentum", "kg m/s")

    @property
    def angular_momentum(self) -> "xr.DataArray":
        """Angular momentum about the origin, Σ x × μ_x + Λ(p) μ_p [kg m²/s], dims (time, axis)."""
        from cayley.results.totals import angular_momentum

        return self._series(angular_momentum(self), "angular momentum", "kg m^2/s")

    @functools.cached_property
    def data(self) -> "xr.Dataset":
        """Values, velocities (NAME_t) and momenta (NAME_momentum) of all fields."""
        from cayley.results.totals import all_fields

        return all_fields(self)

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write the run to a Zarr store, a directory, to be opened with Trajectory.open.

        Args:
            path: the store.
            overwrite: replace a run that is there.

        Raises:
            FileExistsError: if something is there; with overwrite, something that is no run.
        """
        from cayley.results.store import save

        save(self, path, overwrite=overwrite)

    def export(self, kind: str, target: str | Path) -> list[Path]:
        """Write the run for other programs: "csv", "netcdf" or "vtk"; see cayley.results.export.

        Returns: the files to open.

        Raises:
            ValueError: the kind is unknown, the run is of no model, or the extra "export" is not installed.
        """
        import cayley

        return cayley.export(self, kind, target)

    @classmethod
    def open(cls, path: str | Path, *, model: Model | None = None) -> "Trajectory":
        """Read a run from a Zarr store; all numbers are those of the run, bit for bit.

        Args:
            path: the store.
            model: the model that ran, if it is at hand: checked against the store and taken for the one in it. So its
                rods find their results, and loads that are functions of time, which a store can't hold, can go on.

        Raises:
            FileNotFoundError: if there is nothing.
            ValueError: if it is no run, of a newer format or damaged, or the model is not the one that ran.
        """
        from cayley.results.store import open_run

        return open_run(path, model=model)

    def resume(self, t_end: float | None = None, **options: Any) -> "Trajectory":
        """Go on with the run in its store, as if it had never stopped; see cy.resume.

        Raises:
            ValueError: if it is in no store.
        """
        import cayley

        if self.path is None:
            raise ValueError(
                "the run is in no store; save and open it, or go on with cy.simulate(model, start=run, ...)"
            )
        return cayley.resume(self.path, t_end, **({"model": self.model} | options))

    def index_of(self, node: int) -> int:
        """Where a node of the system stands in the frames.

        Raises:
            KeyError: its frames were not saved.
        """
        if self.only is None:
            return node
        found = int(np.searchsorted(self.only, node))
        if found == len(self.only) or self.only[found] != node:
            raise KeyError("the frames of that place were not saved (save_only)")
        return found

    def _account(self, column: int) -> np.ndarray:
        from cayley.results.totals import account

        return account(self, column)

    def _series(self, values: np.ndarray, long_name: str, units: str) -> "xr.DataArray":
        from cayley.results.totals import series  # xarray is slow to import: only when results are looked at

        return series(self, values, long_name, units)

    def _name_of(self, part: Any) -> str:
        """Name of a part, given itself or by name.

        Raises:
            KeyError: there is no such part.
        """
        from cayley.results.record import name_of

        name = part if isinstance(part, str) else name_of(part, self.model)
        if name not in self._parts:
            raise KeyError(f"the run has no part {part!r}; it has {', '.join(self._parts) or 'none (use run.data)'}")
        return str(name)

    def _part(self, name: str) -> Any:
        return dict(zip(self.model.names, self.model.parts, strict=True)).get(name) if self.model else None

    def _vectors(self) -> list[str]:
        layout = self.outline.layout
        return [n for n, kind in layout.fields.items() if n not in layout.rotations and kind.size == 3]

    def _values(self, name: str) -> np.ndarray:
        return self.frames.values[..., self.outline.layout.rows_of(name)]

    def _momenta(self, name: str) -> np.ndarray:
        return self.frames.momenta[..., self.outline.layout.dofs_of(name)]

    def _rotation(self, name: str) -> np.ndarray:
        return self.outline.layout.representation.to_quaternion(self._values(name))


__all__ = ["Trajectory"]
