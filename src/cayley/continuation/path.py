"""What continuation leaves: the points of a path as a run has frames, their stability, and where it changes."""

import functools
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.continuation.critical import Critical
from cayley.continuation.follow import Found
from cayley.continuation.mode import Mode
from cayley.continuation.track import Track
from cayley.model import Model
from cayley.results.frames import Frames
from cayley.results.observe import Observations, observe
from cayley.results.trajectory import Trajectory
from cayley.statics import Equilibrium
from cayley.statics.newton import Solution
from cayley.statics.result import at_rest
from cayley.steppers.still import Still
from cayley.system.system import State

if TYPE_CHECKING:
    import xarray as xr


class Path:
    """A path of equilibria: ``path.parameter`` and, along it, ``path[part]`` with the dimension "point".

    ``path.port``, ``path.joint`` and ``path.reaction`` are those of a run; ``path.unstable`` counts, at each point, the
    motions that lower the energy; ``path.limits`` and ``path.bifurcations`` are the critical points on it.
    """

    def __init__(
        self,
        *,
        model: Model,
        parts: Mapping[str, slice],
        track: Track,
        found: Found,
        time: float,
        onward: Callable[..., "Path"],
    ) -> None:
        """Hold what was found.

        Args:
            model: the model, as the user has it.
            parts: nodes of each part by name.
            track: the equations.
            found: points, critical points, and why it ended.
            time: at which all that is no parameter was taken [s].
            onward: (critical, mode, direction, options) -> the Path that branches off there.
        """
        self.model, self.time, self._parts, self._track, self._found = model, time, dict(parts), track, found
        self._onward = onward

    @property
    def name(self) -> str:
        """What the parameter is."""
        return self._track.scaled.name

    @property
    def unit(self) -> str:
        """Its unit."""
        return self._track.scaled.unit

    @property
    def parameter(self) -> np.ndarray:
        """λ at every point, shape (points,)."""
        return np.array([point.parameter for point in self._found.points])

    @property
    def unstable(self) -> np.ndarray:
        """Number of independent motions that lower the energy at every point, 0 where it is stable, shape (points,)."""
        return np.array([point.unstable for point in self._found.points])

    @property
    def stable(self) -> np.ndarray:
        """Whether each point is stable, shape (points,)."""
        return self.unstable == 0

    @property
    def critical(self) -> list[Critical]:
        """All critical points in order; critical.point is the number of each among the points."""
        return list(self._found.critical)

    @property
    def limits(self) -> list[Critical]:
        """Limit points: the parameter turns back there, and a load that grows on snaps through."""
        return [one for one in self._found.critical if one.kind == "limit"]

    @property
    def bifurcations(self) -> list[Critical]:
        """Points where other equilibria branch off."""
        return [one for one in self._found.critical if one.kind == "bifurcation"]

    @property
    def ended(self) -> str:
        """Why the path ends where it does."""
        return self._found.ended

    def __len__(self) -> int:
        """Number of points."""
        return len(self._found.points)

    def mode(self, critical: Critical, k: int = 0) -> Mode:
        """The motion without stiffness at a critical point, the k-th where there are several."""
        self._track.at(critical.place)
        return Mode(self.model, self._parts, self._track.still, critical.vectors[k])

    def branch(self, critical: Critical | int = 0, *, direction: int = 1, mode: int = 0, **options: Any) -> "Path":
        """Follow the path that branches off at a bifurcation point.

        Args:
            critical: one of ``bifurcations``, or its number.
            direction: 1 or -1: along the motion or against it.
            mode: which motion, where there are several.
            options: range, points, step and turn, as of cy.trace; those of this path without.

        Raises:
            ValueError: it is no bifurcation point of this path, or direction or mode do not fit.
            EquilibriumError: no equilibrium was found beside it.
        """
        if isinstance(critical, int):
            if not 0 <= critical < len(self.bifurcations):
                raise ValueError(f"branch: there are {len(self.bifurcations)} bifurcation points, none is {critical}")
            critical = self.bifurcations[critical]
        if not any(critical is one for one in self.bifurcations):
            raise ValueError(f"branch: {critical!r} is no bifurcation point of this path; give one of .bifurcations")
        if direction not in (1, -1):
            raise ValueError(f"branch: direction is {direction!r}; give 1 or -1")
        if not 0 <= mode < len(critical.vectors):
            raise ValueError(f"branch: mode is {mode!r}; this point has {len(critical.vectors)}, counted from 0")
        return self._onward(critical, mode, direction, options)

    def state(self, k: int = -1) -> State:
        """Values at a point, at rest, at the time of the trace: for start= of cy.simulate and others."""
        values = self._found.points[k].values
        momenta = np.zeros((len(values), self._track.still.system.layout.dofs))
        return State(values=values.copy(), momenta=momenta, origin=self.time)

    def equilibrium(self, k: int = -1) -> Equilibrium:
        """A point as what cy.equilibrium finds, with its loads."""
        point, track = self._found.points[k], self._track
        system = track.scaled.system_at(track.still.system, point.parameter)
        still = Still.at(system, point.values, point.parameter)
        still.put(point.values, point.multipliers)
        told = Solution(found=True, how="continuation", iterations=point.corrections)
        return Equilibrium(self.model, self._parts, still, told, track.rounding)

    @functools.cached_property
    def frames(self) -> Trajectory:
        """The points as the frames of a run, whose time is the parameter."""
        return self._run(self.model)

    def __getitem__(self, part: Any) -> "xr.Dataset":
        """Fields of one rod or body, given itself or by name, as those of a run, with the dimension "point"."""
        return self._labeled(self.frames[part])

    def port(self, part: Any, name: str | None = None) -> "xr.Dataset":
        """Place and frame of a port, see Trajectory.port."""
        return self._labeled(self.frames.port(part, name))

    def joint(self, joint: Any) -> "xr.Dataset":
        """Force [N] and moment [N m] of a joint, see Trajectory.joint."""
        return self._labeled(self.frames.joint(joint))

    def reaction(self, support: Any, name: str | None = None) -> "xr.Dataset":
        """Force [N] and moment [N m] by which the ground holds a part, see Trajectory.reaction."""
        return self._labeled(self.frames.reaction(support, name))

    def save(self, path: str | File, *, overwrite: bool = False) -> None:
        """Write it to a Zarr store, as a run whose time is the parameter; Trajectory.open reads it.

        Args:
            path: the store.
            overwrite: replace a run that is there.

        Raises:
            FileExistsError: if something is there; with overwrite, something that is no run.
        """
        self._run(self._track.scaled.model).save(path, overwrite=overwrite)

    def __repr__(self) -> str:
        """What was followed."""
        found = [f"{len(self)} points of the {self.name}"]
        found += [f"{one.kind} at {one.parameter:.6g}" for one in self._found.critical]
        return f"<Path: {', '.join(found)}; ended: {self.ended}>"

    def _labeled(self, data: "xr.Dataset") -> "xr.Dataset":
        attributes = {"units": self.unit, "long_name": self.name}
        if self._track.scaled.gravity is not None:  # these are those of the whole gravity at every point
            data = data.drop_vars(["potential_energy", "energy"], errors="ignore")
        found = data.rename({"time": "point"}).assign_coords(point=np.arange(len(self)))
        return found.assign_coords(parameter=("point", self.parameter, attributes))

    def _run(self, model: Model) -> Trajectory:
        points, system = self._found.points, self._track.still.system
        values = np.stack([point.values for point in points])
        frames = Frames(
            times=self.parameter,
            steps=np.arange(len(points)),
            values=values,
            momenta=np.zeros((*values.shape[:2], system.layout.dofs)),
            origin=0.0,
            h=0.0,
        )
        critical = [{"kind": one.kind, "parameter": one.parameter, "point": one.point} for one in self._found.critical]
        path = {"name": self.name, "unit": self.unit, "unstable": self.unstable.tolist(), "critical": critical}
        return Trajectory(
            frames=frames,
            info={"wall_time": 0.0, "path": path},
            system=system,
            observed=self._observed(frames),
            model=model,
            parts=self._parts,
        )

    def _observed(self, frames: Frames) -> Observations:
        """What frames say; where gravity is the parameter, of a system of its own for each."""
        system, scaled = at_rest(self._track.still.system), self._track.scaled
        if scaled.gravity is None:
            return observe(system, frames)
        one_by_one = []
        for k, parameter in enumerate(frames.times):
            own = {name: getattr(frames, name)[k : k + 1] for name in ("times", "steps", "values", "momenta")}
            one_by_one.append(observe(scaled.system_at(system, float(parameter)), Frames(**own, origin=0.0, h=0.0)))
        joined: dict[str, Any] = {}
        for one in fields(Observations):
            found = [getattr(each, one.name) for each in one_by_one]
            joined[one.name] = found[0] if one.name == "held" or found[0] is None else np.concatenate(found)
        return Observations(**joined)
