"""Run a system of an explicit rule with constraints, springs or dampers between its nodes from frame to frame."""

import ctypes
import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cayley.steppers import problem, saddle
from cayley.steppers.cells import spring_cells
from cayley.steppers.native import fill
from cayley.steppers.outcome import Outcome, Result
from cayley.steppers.problem import Plan
from cayley.steppers.turned_run import run_turned
from cayley.system.system import State, System, aligned, by_node, gather, pack
from cayley.system.turned import embedded

CHUNK = 20_000
"""Most steps in one call of the driver."""


@dataclass(frozen=True, slots=True)
class Explicit:
    """What does not change from call to call.

    Args:
        plan: the problem of the constrained nodes.
        calls: addresses of run and setup of kick, drift and predict (0 without), shape (3, 2).
        uniforms: their uniform inputs and room behind them, shape (3, width).
        slot: block, lane, first row of values, of momenta and of predicted velocities (−1 without), shape (n, 5).
        spans: first block, last block, and whether constraints know a node there, shape (m, 3).
        entries: loads: block, lane, row, row of the rotation, form and column, shape (k, 6).
        scales: their factors and levers, shape (k, 4).
        fixed: block, row, lane of momenta that stay zero, shape (f, 3).
    """

    plan: Plan
    calls: np.ndarray
    uniforms: np.ndarray
    slot: np.ndarray
    spans: np.ndarray
    entries: np.ndarray
    scales: np.ndarray
    fixed: np.ndarray


def make_plan(system: System) -> Explicit:
    """Kernels, rows and loads of a system."""
    if "coupled" in system.plans:
        return system.plans["coupled"]
    nodes = saddle.constrained_nodes(system)
    plan = saddle.make_plan(system, spring_cells(system, nodes))
    rows, layout, lanes = system.equations.rows, system.layout, system.kernels.lanes
    cell, position = np.divmod(system.slots, rows.cell)
    block, lane = 1 + cell // lanes, cell % lanes
    momenta = rows.momenta.start + position * layout.dofs
    predicted = rows.forced["predicted"].start + position * layout.dofs if rows.forced else np.full(system.size, -1)
    node, dof = np.nonzero(~system.free)
    names = ["kick", "drift_held" if len(node) else "drift", *(["predict"] if rows.forced else [])]
    found = [system.kernels[name] for name in names]
    uniforms = np.zeros((3, max(kernel.width for kernel in found)))
    uniforms[:, : len(system.uniforms)] = system.uniforms
    calls = np.zeros((3, 2), dtype=np.int64)
    calls[: len(found)] = [(kernel.run, kernel.setup) for kernel in found]
    entries, scales = np.zeros((0, 6), dtype=np.int64), np.zeros((0, 4))
    if system.loads is not None:
        loads = system.loads
        target = rows.forced["pushed"].start + position * layout.dofs if rows.forced else momenta
        at, turn = loads.node, position[loads.node] * layout.rows + loads.turn
        columns = [block[at], lane[at], target[at] + loads.dof, turn, loads.form, loads.column]
        entries, scales = np.column_stack(columns).astype(np.int64), loads.factors
    made = Explicit(
        plan=plan,
        calls=calls,
        uniforms=uniforms,
        slot=np.column_stack([block, lane, position * layout.rows, momenta, predicted])[nodes].astype(np.int64),
        spans=_spans(-(-system.cells // lanes), set(block[nodes].tolist())),
        entries=entries,
        scales=scales,
        fixed=np.column_stack([block[node], momenta[node] + dof, lane[node]]).astype(np.int64),
    )
    system.plans["coupled"] = made
    return made


def _spans(blocks: int, known: set[int]) -> np.ndarray:
    """Stretches of blocks that constraints know, and of others; a kernel hands forces on from block to block."""
    marks = [block in known for block in range(1, blocks + 1)]
    found, first = [], 1
    for mark, group in itertools.groupby(marks):
        count = len(list(group))
        found.append((first, first + count, int(mark)))
        first += count
    return np.array(found, dtype=np.int64)


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
        return run_turned(run, system, state, stride=stride, saves=saves, receive=receive, progress=progress)
    explicit, rows = make_plan(system), system.equations.rows
    data = pack(system, state if state.work is None else replace(state, work=state.work[:-1]))
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        frames = aligned((count, data.shape[0] - 2, rows.kept, data.shape[2]))
        works = np.zeros((count, 1, 2))
        outcome, reached, counts, memory = _advance(explicit, data, state, stride, frames, works)
        if reached:
            values, momenta = (by_node(system, frames[:reached], part) for part in (rows.values, rows.momenta))
            last = state.step + reached * stride
            known = memory if outcome is Outcome.FINISHED else None
            state = replace(state, values=values[-1], momenta=momenta[-1], step=last, memory=known)
            more: dict[str, Any] = {}
            if system.accounted:
                own = gather(frames[:reached], rows.forced["account"], system.cells) if rows.forced else works[:0, :0]
                more["work"] = works[:reached]
                if rows.forced:
                    own = gather(frames[:reached], rows.forced["account"], system.cells)
                    more["work"] = np.concatenate([own, works[:reached]], axis=1)
                state = replace(state, work=more["work"][-1])
            receive(values, momenta, **more)
        if outcome is not Outcome.FINISHED:
            return Result(outcome, state, state.step + int(counts[2]) - reached * stride, int(counts[3]))
        done += count
        if progress is not None:
            progress(done / saves, state.time)
    return Result(Outcome.FINISHED, state, state.step)


def prepare(system: System) -> None:
    """Compile or load everything a run of the system calls."""
    make_plan(embedded(system))


def _advance(
    explicit: Explicit, data: np.ndarray, state: State, stride: int, frames: np.ndarray, works: np.ndarray
) -> tuple[Outcome, int, np.ndarray, np.ndarray]:
    """One call of the driver: the outcome, the frames reached, counts (see struct problem), and the multipliers."""
    plan = explicit.plan
    system, steps = plan.system, len(frames) * stride
    made = problem.make_problem(plan, state, steps, len(frames), {"works": works})
    if state.work is not None:
        made.arrays["energy"][1:] = state.work[-1]
    sizes = [c["start"].size for c in made.couplings]
    if state.memory is not None and state.memory.shape == (sum(sizes),):
        for coupling, end, size in zip(made.couplings, np.cumsum(sizes), sizes, strict=True):
            coupling["start"][:] = state.memory[end - size : end].reshape(coupling["start"].shape)
    table = np.zeros((1, 1))
    if system.loads is not None:
        times = state.origin + (state.step + np.arange(steps + 1)) * state.h
        table = np.ascontiguousarray(system.loads.table(times, state.h, state.origin))
    saved, given = aligned(data.shape), np.zeros((plan.size + 1, system.layout.dofs))
    numbers = {name: int(v) for name, v in zip(_CALLS, explicit.calls.reshape(-1), strict=True)}
    arrays = {
        "uniforms": explicit.uniforms,
        "data": data,
        "slot": explicit.slot,
        "spans": explicit.spans,
        "saved": saved,
        "given": given,
        "before": np.zeros_like(given),
        "table": table,
        "entries": explicit.entries,
        "scales": explicit.scales,
        "fixed": explicit.fixed,
        "frames": frames,
    }
    numbers |= {
        "problem": ctypes.addressof(made.struct),
        "width": explicit.uniforms.shape[1],
        "blocks": data.shape[0] - 2,
        "rows": data.shape[1],
        "kept": frames.shape[2],
        "span_count": len(explicit.spans),
        "columns": table.shape[1],
        "entry_count": len(explicit.scales),
        "fixed_count": len(explicit.fixed),
    }
    struct, reached = fill("explicit_run", arrays | numbers), ctypes.c_int64(0)
    code = made.engine.advance_explicit(ctypes.byref(struct), ctypes.byref(reached))
    counts, outcome = made.arrays["counts"], list(Outcome)[code]
    if outcome is Outcome.REDUNDANT:
        counts[3] = plan.nodes[np.flatnonzero(plan.block_of == counts[3])[0]]
    elif outcome is Outcome.NOT_CONVERGED:
        counts[3] = -1
    memory = np.concatenate([np.zeros(0), *(c["start"].reshape(-1) for c in made.couplings)])
    return outcome, reached.value, counts, memory


_CALLS = ("kick", "kick_setup", "drift", "drift_setup", "predict", "predict_setup")
