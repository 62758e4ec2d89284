"""Run a system of an implicit rule from frame to frame."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from cayley.codegen.kernels import Kernels
from cayley.discrete.equations import derive
from cayley.discrete.layout import Layout
from cayley.steppers.implicit_plan import advance, make_plan
from cayley.steppers.outcome import Outcome, Result
from cayley.system.system import LoadEntries, State, System

CHUNK = 2_000
"""Most steps in one call of the driver."""


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
    plan = make_plan(system)
    rows = system.layout.rows
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        frames = np.empty((count, system.size, rows + system.layout.dofs))
        call = advance(plan, state, stride, frames)
        outcome, reached, counts = call.outcome, call.reached, call.counts
        if reached:
            values, momenta = frames[:reached, :, :rows], frames[:reached, :, rows:]
            receive(values.copy(), momenta.copy())
            last = state.step + reached * stride
            known = call.memory if outcome is Outcome.FINISHED else None  # after a failure it is not that of the last frame
            state = replace(state, values=values[-1].copy(), momenta=momenta[-1].copy(), step=last, memory=known)
        if outcome is not Outcome.FINISHED:
            return Result(outcome, state, state.step + int(counts[2]) - reached * stride, int(counts[3]), call.history)
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
    values, memory, size = _turned(system, inner, state.values, to_quaternion=True), None, inner.reference.size
    if state.memory is not None and state.memory.ndim == 1 and len(state.memory) > size:
        remembered = state.memory[-size:].reshape(inner.reference.shape)
        if np.array_equal(_turned(system, inner, remembered, to_quaternion=False), state.values):
            values, memory = remembered.copy(), state.memory[:-size]

    def receive_turned(values: np.ndarray, momenta: np.ndarray) -> None:
        receive(_turned(system, inner, values, to_quaternion=False), momenta)

    begin = replace(state, values=values, memory=memory)
    result = run(inner, begin, receive=receive_turned, **options)
    end = result.state
    memory = None if end.memory is None else np.concatenate([end.memory, end.values.reshape(-1)])
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
    make_plan(embedded(system))
