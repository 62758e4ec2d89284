"""Run a system of an implicit rule from frame to frame."""

from collections.abc import Callable
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np

from cayley.codegen.kernels import Kernels
from cayley.discrete.equations import derive
from cayley.discrete.layout import Layout
from cayley.steppers import constrained_implicit_plan, galerkin_plan, onestage_plan
from cayley.steppers.outcome import Outcome, Result
from cayley.system.system import LoadEntries, State, System

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
    if system.layout.representation.name != "quaternion":
        return _run_turned(system, state, stride=stride, saves=saves, receive=receive, progress=progress)
    scheme = scheme_of(system)
    plan = scheme.make_plan(system, state)
    rows = system.layout.rows
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        frames = np.empty((count, system.size, rows + system.layout.dofs))
        outcome, reached, counts, memory, history = scheme.advance(system, plan, state, stride, frames)
        if reached:
            values, momenta = frames[:reached, :, :rows], frames[:reached, :, rows:]
            receive(values.copy(), momenta.copy())
            last = state.step + reached * stride
            known = memory if outcome is Outcome.FINISHED else None  # after a failure it is not that of the last frame
            state = replace(state, values=values[-1].copy(), momenta=momenta[-1].copy(), step=last, memory=known)
        if outcome is not Outcome.FINISHED:
            return Result(outcome, state, state.step + int(counts[2]) - reached * stride, int(counts[3]), history)
        done += count
        if progress is not None:
            progress(done / saves, state.time)
    return Result(Outcome.FINISHED, state, state.step)


def _run_turned(
    system: System,
    state: State,
    *,
    receive: Callable[[np.ndarray, np.ndarray], None],
    **options: Any,
) -> Result:
    """Run a system whose rotations are stored as matrices.

    The steps are those of unit quaternions: control nodes are interpolated in their embedding R⁴, where matrices would
    need a polar decomposition at every point. Frames hold matrices; what is remembered of the last step holds its end
    as quaternions too, so that a run goes on bit for bit.
    """
    inner = embedded(system)
    values, memory = _turned(system, inner, state.values, to_quaternion=True), None
    if state.memory is not None and state.memory.shape[2] == inner.layout.rows:
        remembered = state.memory[:, -1].copy()
        if np.array_equal(_turned(system, inner, remembered, to_quaternion=False), state.values):
            values, memory = remembered, state.memory[:, :-1].copy()

    def receive_turned(values: np.ndarray, momenta: np.ndarray) -> None:
        receive(_turned(system, inner, values, to_quaternion=False), momenta)

    begin = replace(state, values=values, memory=memory)
    result = run(inner, begin, receive=receive_turned, **options)
    end = result.state
    memory = None if end.memory is None else np.concatenate([end.memory, end.values[:, None]], axis=1)
    reached = state.values if end is begin else _turned(system, inner, end.values, to_quaternion=False)
    return replace(result, state=replace(end, values=reached, memory=memory))


def embedded(system: System) -> System:
    """The same system with rotations as unit quaternions."""
    if system.layout.representation.name == "quaternion":
        return system
    equations = system.equations
    known = equations._derived
    if "embedded" not in known:
        made = derive(equations.density, equations.rule, varying=equations.varying)
        known["embedded"] = made, Kernels(made)
    made, kernels = known["embedded"]
    inner = replace(system, equations=made, kernels=kernels, loads=_turned_loads(system, made.layout))
    return replace(inner, reference=_turned(system, inner, system.reference, to_quaternion=True))


def _turned(system: System, inner: System, values: np.ndarray, *, to_quaternion: bool) -> np.ndarray:
    """Values with quaternions for matrices or the other way round, shape (..., nodes, rows)."""
    source, target = (system, inner) if to_quaternion else (inner, system)
    found = np.empty((*values.shape[:-1], target.layout.rows))
    matrix = system.layout.representation
    for name in system.layout.fields:
        part = values[..., source.layout.rows_of(name)]
        if name in system.layout.rotations:
            part = matrix.to_quaternion(part) if to_quaternion else matrix.from_quaternion(part)
        found[..., target.layout.rows_of(name)] = part
    return found


def _turned_loads(system: System, layout: Layout) -> LoadEntries | None:
    """Loads with the rows of the other form."""
    if system.loads is None:
        return None
    row = {system.layout.rows_of(name).start: layout.rows_of(name).start for name in layout.rotations}
    return replace(system.loads, turn=np.array([row[int(turn)] for turn in system.loads.turn], dtype=np.int64))


def prepare(system: System) -> None:
    """Compile or load everything a run of the system calls."""
    system = embedded(system)
    state = State(values=system.reference, momenta=np.zeros((system.size, system.layout.dofs)), h=1.0)
    frames = np.empty((0, system.size, system.layout.rows + system.layout.dofs))
    scheme = scheme_of(system)
    scheme.advance(system, scheme.make_plan(system, state), state, 1, frames)
