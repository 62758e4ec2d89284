"""What is told of a run that stopped: time, place, reason and remedy."""

import math

import numpy as np

from cayley.results.trajectory import Trajectory
from cayley.steppers.outcome import Outcome, Result
from cayley.system.system import System


class SimulationError(RuntimeError):
    """A run that stopped: the message tells time, place and remedy; what was saved before is in ``partial``."""

    def __init__(self, message: str, partial: Trajectory, *, too_fast: bool = False) -> None:
        """Hold the message and the frames saved before; too_fast: what touches wants a smaller step."""
        super().__init__(message)
        self.partial, self.too_fast = partial, too_fast


class Interrupted(KeyboardInterrupt):
    """Ctrl-C in a run: what was saved before is in ``partial``, and in its store."""

    def __init__(self, partial: Trajectory) -> None:
        """Hold the frames saved before."""
        path = partial.path
        where = "" if path is None else f"; {path} has all frames, cy.resume({str(path)!r}) goes on"
        super().__init__(f"stopped by hand at t = {partial.time[-1]:.6g} s{where}")
        self.partial = partial


def explain(system: System, result: Result, trajectory: Trajectory) -> str:
    """One line on a run that stopped.

    Args:
        system: the system.
        result: how the last call of the stepper ended.
        trajectory: the frames saved before.
    """
    h = trajectory.frames.h
    time = trajectory.frames.origin + result.step * h
    node = ""
    if result.node >= 0 and "length" in system.named:
        place = result.node
        for name, nodes in trajectory._parts.items():
            if nodes.start <= result.node < nodes.stop:
                node, place = f" of {name}", result.node - nodes.start
        node = f" at node {place}{node}"
    if result.outcome is Outcome.REDUNDANT:
        return f"stopped at t = {time:.6g} s (step {result.step}){node}: {result.outcome.value}; hold less"
    if result.outcome is Outcome.CROWDED:
        return (
            f"stopped at t = {time:.6g} s (step {result.step}): {result.outcome.value}; make meshes coarser where rods "
            "lie on them, or leave pairs out (Contact(without=...)). "
            f"The last good frame, t = {trajectory.time[-1]:.6g} s, and those before are in the exception's .partial"
        )
    if result.outcome.hasty:
        return (
            f"stopped at t = {time:.6g} s (step {result.step}), at {result.partners}: {result.outcome.value}; give dt "
            f"below {0.5 * h:.3g} s. The last good frame, t = {trajectory.time[-1]:.6g} s, and those before are in the "
            "exception's .partial"
        )
    limit = system.stable_dt(result.state) if np.isfinite(result.state.values).all() else math.nan
    remedy = (
        f"give dt below {0.5 * h:.3g} s"
        if not limit < h
        else f"dt is over the step limit {limit:.3g} s there: give less"
    )
    return (
        f"stopped at t = {time:.6g} s (step {result.step}){node}: {result.outcome.value}{_history(result)}; {remedy}. "
        f"The last good frame, t = {trajectory.time[-1]:.6g} s, and those before are in the exception's .partial"
    )


def _history(result: Result) -> str:
    """The last iterations of a step that was not solved."""
    if result.history is None or result.outcome is not Outcome.NOT_CONVERGED:
        return ""
    told = [f"{size:.1e} ({residual:.1e})" for size, residual in result.history if math.isfinite(residual)]
    return f" (relative corrections and residuals in N s or N m s at last: {', '.join(told)})" if told else ""


def name_of(system: System) -> str:
    """The Lagrangian of a system, or its Lagrangians, in words."""
    names = [group.equations.density.lagrangian.name for group in system.groups]
    return f"Lagrangian{'s' * (len(names) > 1)} {', '.join(names)}"
