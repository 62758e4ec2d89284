"""Run a system of an implicit rule from frame to frame."""

import ctypes
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cayley.codegen.kernels import Kernels
from cayley.discrete.equations import derive
from cayley.discrete.layout import Layout
from cayley.steppers import problem
from cayley.steppers.cells import constraint_cells, term_cells
from cayley.steppers.outcome import Outcome, Result
from cayley.steppers.problem import Plan
from cayley.system.system import LoadEntries, State, System

CHUNK = 2_000
"""Most steps in one call of the driver."""


def run(
    system: System,
    state: State,
    *,
    stride: int,
    saves: int,
    receive: Callable[..., None],
    progress: Callable[[float, float], None] | None = None,
) -> Result:
    """Advance a state through frames, each stride steps after the one before; arguments as in decoupled_run.run."""
    if system.layout.representation.name != "quaternion":
        return _run_turned(system, state, stride=stride, saves=saves, receive=receive, progress=progress)
    plan = make_plan(system)
    accounted = system.accounted
    rows = system.layout.rows
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        frames = np.empty((count, system.size, rows + system.layout.dofs))
        call = advance(plan, state, stride, frames)
        outcome, reached, counts = call.outcome, call.reached, call.counts
        if reached:
            values, momenta = frames[:reached, :, :rows].copy(), frames[:reached, :, rows:].copy()
            receive(values, momenta, work=call.work[:reached]) if accounted else receive(values, momenta)
            last = state.step + reached * stride
            # after a failure the memory is not that of the last frame
            memory = call.memory if outcome is Outcome.FINISHED else None
            work = call.work[reached - 1] if accounted else None
            state = replace(state, values=values[-1], momenta=momenta[-1], step=last, memory=memory, work=work)
        if outcome is not Outcome.FINISHED:
            return Result(outcome, state, state.step + int(counts[2]) - reached * stride, int(counts[3]), call.history)
        done += count
        if progress is not None:
            progress(done / saves, state.time)
    return Result(Outcome.FINISHED, state, state.step)


def make_plan(system: System) -> Plan:
    """Cells and blocks, kernels compiled: a node between elements is a block, those inside one are one together."""
    if "implicit" in system.plans:
        return system.plans["implicit"]
    nodes = np.arange(system.size)
    cells = term_cells(system), constraint_cells(system, nodes)
    plan = problem.make_plan(system, nodes, system.equations.rule.time, element_groups(system), *cells)
    system.plans["implicit"] = plan
    return plan


def element_groups(system: System) -> np.ndarray:
    """Number of the block of every node: those inside an element are one together, shape (nodes,)."""
    degree, groups, first = system.equations.rule.degree, [], 0
    for count in system.chains:
        element, inner = np.divmod(np.arange(count), degree)
        own = 2 * element + (inner > 0) if degree > 1 else element
        groups.append(first + own)
        first += int(own[-1]) + 1
    return np.concatenate(groups)


def prepare(system: System) -> None:
    """Compile or load everything a run of the system calls."""
    make_plan(embedded(system))


@dataclass(frozen=True, slots=True)
class Advance:
    """What one call of the driver returns.

    Args:
        outcome: how it ended.
        reached: frames written.
        counts: iterations in all, most in a step, number and node of the last step, shape (4,).
        memory: control nodes and multipliers of the last step, flat.
        history: relative correction and largest residual [N s, N m s] of the last iterations, shape (HISTORY, 2).
        work: work and loss at the frames [J], shape (frames, 1, 2).
    """

    outcome: Outcome
    reached: int
    counts: np.ndarray
    memory: np.ndarray
    history: np.ndarray
    work: np.ndarray


def advance(plan: Plan, state: State, stride: int, frames: np.ndarray) -> Advance:
    """One call of the driver."""
    system, steps = plan.system, len(frames) * stride
    entries, scales = load_entries(system)
    work = np.zeros((len(frames), 1, 2))
    made = problem.make_problem(
        plan,
        state,
        steps,
        len(frames),
        {
            "table": stage_table(system, state, plan.tables["at"], steps),
            "entries": entries,
            "scales": scales,
            "frames": frames,
            "works": work,
        },
    )
    if state.work is not None:
        made.arrays["energy"][1:] = state.work[0]
    made.struct.warm = int(_recall(state, made))
    reached = ctypes.c_int64(0)
    code = made.engine.advance(ctypes.byref(made.struct), ctypes.byref(reached))
    flat = [made.arrays["memory"][:, :-1].reshape(-1), *(c["start"].reshape(-1) for c in made.couplings)]
    outcome, counts = list(Outcome)[code], made.arrays["counts"]
    if outcome is Outcome.REDUNDANT:
        counts[3] = np.flatnonzero(plan.block_of == counts[3])[0]
    return Advance(outcome, reached.value, counts, np.concatenate(flat), made.arrays["history"], work)


def _recall(state: State, made: problem.Problem) -> bool:
    """Put what a state remembers of the last step into the arrays; returns whether there was anything."""
    inner = made.arrays["memory"][:, :-1]
    sizes = [inner.size, *(c["start"].size for c in made.couplings)]
    if state.memory is None or state.memory.shape != (sum(sizes),):
        return False
    first, *others = np.split(state.memory, np.cumsum(sizes)[:-1])
    inner[:] = first.reshape(inner.shape)
    for coupling, values in zip(made.couplings, others, strict=True):
        coupling["start"][:] = values.reshape(coupling["start"].shape)
    return True


def stage_table(system: System, state: State, stages: np.ndarray, steps: int) -> np.ndarray:
    """Values of the time-dependent loads at the stages of the next steps, shape (steps, stages, columns)."""
    if system.loads is None:
        return np.zeros((1, 1, 1))
    times = state.origin + (state.step + np.arange(steps)[:, None] + stages[None]) * state.h
    return np.ascontiguousarray(system.loads.table.at_stages(times, state.h, state.origin))


def load_entries(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Loaded nodes.

    Returns: (node, row, row of rotation, form, column, is moment, dof) per entry, shape (k, 7), and their factors and
    levers, shape (k, 4).
    """
    loads, layout = system.loads, system.layout
    if loads is None:
        return np.zeros((0, 7), dtype=np.int64), np.zeros((0, 4))
    row_of_dof = {layout.dofs_of(n).start: layout.rows_of(n).start for n in layout.fields}
    moments = {layout.dofs_of(n).start for n in layout.rotations}
    row = [row_of_dof[int(d)] for d in loads.dof]
    moment = [int(int(d) in moments) for d in loads.dof]
    columns = [loads.node, np.array(row), loads.turn, loads.form, loads.column, np.array(moment), loads.dof]
    return np.column_stack(columns).astype(np.int64), loads.factors


def _run_turned(
    system: System,
    state: State,
    *,
    receive: Callable[..., None],
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

    def receive_turned(values: np.ndarray, momenta: np.ndarray, **more: np.ndarray) -> None:
        receive(_turned(system, inner, values, to_quaternion=False), momenta, **more)

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
    equations, known = system.equations, system.plans
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
