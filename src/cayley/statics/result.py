"""What a static analysis leaves: one frame with everything that a frame of a run has, and how it was found."""

import functools
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.model import Model
from cayley.model.notebook import html_table
from cayley.results.frames import Frames
from cayley.results.trajectory import Trajectory
from cayley.statics.free import free_motions, tell
from cayley.statics.newton import CLEAR, Solution
from cayley.steppers.still import Still
from cayley.system.legendre import initial_state
from cayley.system.system import State, System

if TYPE_CHECKING:
    import xarray as xr

SYMMETRIC = 1e-12
"""Largest difference of a stiffness from its transpose that is rounding, relative to its largest entry."""


class Equilibrium:
    """An equilibrium of a model: as one frame of a run, without the time.

    ``rest[part]``, ``rest.port(...)``, ``rest.joint(...)`` and ``rest.reaction(...)`` are the Datasets of a run at this
    one time; ``cy.simulate(model, start=rest, ...)`` runs from here, ``cy.modes(model, about=rest)`` vibrates about it.
    """

    def __init__(
        self, model: Model, parts: Mapping[str, slice], still: Still, solution: Solution, inertia: float
    ) -> None:
        """Hold what was found.

        Args:
            model: the model.
            parts: nodes of each part by name.
            still: the system at the equilibrium.
            solution: how it was found.
            inertia: mass matrices of about the size of rounding errors of the stiffness [1/s²].
        """
        self.model, self.still, self.solution, self.inertia = model, still, solution, inertia
        self._parts = dict(parts)

    @property
    def system(self) -> System:
        """The discrete system."""
        return self.still.system

    @property
    def time(self) -> float:
        """Time at which loads and prescribed motions were taken [s]."""
        return self.still.time

    @functools.cached_property
    def state(self) -> State:
        """Values and momenta, to start a run from; in a frame that turns, with the velocities of its turning."""
        system, values = self.system, self.still.values
        return initial_state(system, values, frame_velocity(self.still, values), time=self.time)

    @functools.cached_property
    def frame(self) -> Trajectory:
        """The equilibrium as a run of one frame."""
        state, system = self.state, self.system
        if self.still.spin is None:
            state, system = replace(state, momenta=np.zeros_like(state.momenta)), at_rest(system)
        named: dict[str, Any] = {"model": self.model, "parts": self._parts}
        return Trajectory(frames=Frames.of(state), info={"wall_time": 0.0}, system=system, **named)

    def __getitem__(self, part: Any) -> "xr.Dataset":
        """Fields of one rod or body, given itself or by name, as those of a run without the time."""
        return self.frame[part].isel(time=0)

    def poses(self, part: Any) -> tuple[np.ndarray, np.ndarray]:
        """Positions [m] and unit quaternions wxyz of a part's nodes alone, see Trajectory.poses."""
        position, rotation = self.frame.poses(part)
        return position[0], rotation[0]

    def port(self, part: Any, name: str | None = None) -> "xr.Dataset":
        """Place and frame of a port, see Trajectory.port."""
        return self.frame.port(part, name).isel(time=0)

    def joint(self, joint: Any) -> "xr.Dataset":
        """Force [N] and moment [N m] of a joint, see Trajectory.joint."""
        return self.frame.joint(joint).isel(time=0)

    def reaction(self, support: Any, name: str | None = None) -> "xr.Dataset":
        """Force [N] and moment [N m] by which the ground holds a part, see Trajectory.reaction."""
        return self.frame.reaction(support, name).isel(time=0)

    @property
    def potential_energy(self) -> float:
        """Strain energy and energy of the load terms [J]."""
        return float(self.frame.potential_energy[0])

    @property
    def iterations(self) -> int:
        """Number of Newton corrections."""
        return self.solution.iterations

    @property
    def load_steps(self) -> int:
        """Number of steps in which the loads were put on."""
        return self.solution.load_steps

    @property
    def history(self) -> list[tuple[float, float]]:
        """Size (radians, lengths over the extent) and largest force before [N, N m] of the last corrections."""
        return self.solution.history

    @functools.cached_property
    def residual(self) -> float:
        """Largest force or moment that is left on a node [N, N m]."""
        return float(np.abs(self.still.force()[self.still.free]).max(initial=0.0))

    @functools.cached_property
    def unstable(self) -> int:
        """Number of independent motions that lower the energy: 0 where the equilibrium is stable (or indifferent).

        Where loads are not conservative, those along which the symmetric part of the stiffness is negative: without any
        it is stable, with some it may be or not.
        """
        return self.still.unstable(inertia=CLEAR * self.inertia)

    @functools.cached_property
    def conservative(self) -> bool:
        """Whether the stiffness is symmetric, as where all loads have an energy."""
        stiffness = self.still.matrix(0)
        return float(abs(stiffness - stiffness.T).max()) <= SYMMETRIC * float(abs(stiffness).max())

    @property
    def stable(self) -> bool:
        """Whether no small motion lowers the energy."""
        return self.unstable == 0

    @functools.cached_property
    def free_motions(self) -> list[str]:
        """Motions that nothing resists, in words."""
        return tell(self.still, self.model, free_motions(self.still, self.inertia))

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write it to a Zarr store, as a run of one frame; Trajectory.open reads it."""
        self.frame.save(path, overwrite=overwrite)

    @property
    def _kind(self) -> str:
        if not self.stable and not self.conservative:
            return "stability open under loads without an energy (see cy.modes)"
        return "stable" if self.stable else f"unstable in {self.unstable} motion{'s' * (self.unstable > 1)}"

    def _repr_html_(self) -> str:
        """How it was found, as a table in a notebook."""
        rows = [
            ("kind", self._kind),
            ("found by", self.solution.how),
            ("corrections", f"{self.iterations} in {self.load_steps} load step{'s' * (self.load_steps != 1)}"),
            ("largest force left", f"{self.residual:.1e} N, N m"),
            ("potential energy", f"{self.potential_energy:.6g} J"),
            *(("free to move", motion) for motion in self.free_motions),
        ]
        return html_table("Equilibrium", rows)

    def __repr__(self) -> str:
        """Say how it was found."""
        loads = f" in {self.load_steps} load steps" if self.load_steps > 1 else ""
        free = f", free to move: {'; '.join(self.free_motions)}" if self.free_motions else ""
        return (
            f"<Equilibrium: {self._kind}, {self.iterations} corrections{loads} by {self.solution.how}, "
            f"largest force left {self.residual:.1e}{free}>"
        )


def at_rest(system: System) -> System:
    """The system with prescribed motions that stand still: their rates and accelerations take no forces."""
    return replace(system, joints=tuple(replace(joint, steady=True) for joint in system.joints))


def frame_velocity(still: Still, values: np.ndarray) -> np.ndarray:
    """Velocities of nodes at rest in the turning frame: Ω × x, Λ(p)ᵀΩ; zero without one, shape (nodes, dofs)."""
    from cayley.lie import quaternion

    layout = still.system.layout
    found = np.zeros((len(values), layout.dofs))
    if still.spin is not None:
        for name, kind in layout.fields.items():
            part = values[:, layout.rows_of(name)]
            if name in layout.rotations:
                found[:, layout.dofs_of(name)] = quaternion.inverse_rotate(part, still.spin)
            elif kind.size == 3:
                found[:, layout.dofs_of(name)] = np.cross(still.spin, part)
    return found
