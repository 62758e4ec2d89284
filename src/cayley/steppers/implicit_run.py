"""Run a system of an implicit rule from frame to frame."""

from collections.abc import Callable
from dataclasses import replace
from types import ModuleType

import numpy as np

from cayley.steppers import constrained_implicit_plan, galerkin_plan, onestage_plan
from cayley.steppers.outcome import Outcome, Result
from cayley.system.system import State, System

CHUNK = 2_000
"""Most steps in one call of the driver."""


def scheme_of(system: System) -> ModuleType:
    """The scheme that steps a system: the quick one where a step has one stage and an element two nodes."""
    if system.equations.density.constraints.numel():
        return constrained_implicit_plan
    return onestage_plan if system.equations.rule.one_stage else galerkin_plan


def run(
    system: System,
    state: State,
    *,
    stride: int,
    saves: int,
    receive: Callable[[np.ndarray, np.ndarray], None],
    progress: Callable[[float, float], None] | None = None,
) -> Result:
    """Advance a state through frames, each stride steps after the one before; arguments as in decoupled_run.run."""
    scheme = scheme_of(system)
    plan = scheme.make_plan(system, state)
    rows = system.layout.rows
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        frames = np.empty((count, system.size, rows + system.layout.dofs))
        outcome, reached, counts, memory = scheme.advance(system, plan, state, stride, frames)
        if reached:
            values, momenta = frames[:reached, :, :rows], frames[:reached, :, rows:]
            receive(values.copy(), momenta.copy())
            last = state.step + reached * stride
            known = memory if outcome is Outcome.FINISHED else None  # after a failure it is not that of the last frame
            state = replace(state, values=values[-1].copy(), momenta=momenta[-1].copy(), step=last, memory=known)
        if outcome is not Outcome.FINISHED:
            return Result(outcome, state, state.step + int(counts[2]) - reached * stride, int(counts[3]))
        done += count
        if progress is not None:
            progress(done / saves, state.time)
    return Result(Outcome.FINISHED, state, state.step)


def prepare(system: System) -> None:
    """Compile or load everything a run of the system calls."""
    state = State(values=system.reference, momenta=np.zeros((system.size, system.layout.dofs)), h=1.0)
    frames = np.empty((0, system.size, system.layout.rows + system.layout.dofs))
    scheme = scheme_of(system)
    scheme.advance(system, scheme.make_plan(system, state), state, 1, frames)
