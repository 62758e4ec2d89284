"""Run a system from frame to frame: pack, advance, unpack, and find the place of a failure."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cayley.codegen.abi import ARGUMENTS, LEVER
from cayley.steppers import decoupled
from cayley.steppers.outcome import Outcome, Result
from cayley.system.system import State, System, aligned, by_node, gather, pack

TILE = 32
"""Blocks of a tile: with its neighbors in the wavefront it stays in a second-level cache."""
DEPTH = 8
"""Steps a tile takes together once a system no longer fits the cache."""
CHUNK = 20_000
"""Most steps in one call of the driver; it bounds the tables of loads and the time between progress reports."""
CACHED_BYTES = 500_000


@dataclass(frozen=True, slots=True)
class Plan:
    """Everything the driver needs besides state and loads.

    Args:
        kernels: addresses of run and setup of step, step_held, kick and predict, shape (4, 2).
        uniforms: their uniform inputs and room behind them, shape (4, width).
        timed: whether the density depends on time.
        spans: tiles, (first block, last block, held), shape (tiles, 3).
        depth: steps a tile takes together.
        held: (block, row, lane) of momenta that stay zero, shape (m, 3).
        entries: loads by node, sorted by tile, shape (k, 7).
        scales: their factors and levers, shape (k, 4).
        places: first entry of each tile, shape (tiles + 1,); with forces a predictor takes all entries, tiles none.
    """

    kernels: np.ndarray
    uniforms: np.ndarray
    timed: bool
    spans: np.ndarray
    depth: int
    held: np.ndarray
    entries: np.ndarray
    scales: np.ndarray
    places: np.ndarray


def run(
    system: System,
    state: State,
    *,
    stride: int,
    saves: int,
    receive: Callable[..., None],
    progress: Callable[[float, float], None] | None = None,
) -> Result:
    """Advance a state through frames, each stride steps after the one before.

    Args:
        system: the system, of a rule whose nodes decouple.
        state: where it starts; its h is the time step [s].
        stride: steps between two frames.
        saves: number of frames.
        receive: called with values (m, nodes, rows) and momenta (m, nodes, dofs) of frames, as they come, and with
            work=(m, cells, 2) where there are forces (see State).
        progress: called with (fraction done, time [s]) between calls of the driver.

    Returns: how it ended and the last good state.
    """
    plan = make_plan(system)
    data = pack(system, state)
    rows = system.equations.rows
    kept = rows.kept
    before = aligned(data.shape)
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        frames = np.empty((count, data.shape[0] - 2, kept, data.shape[2]))
        before[:] = data
        outcome, reached = _advance(system, plan, data, state, stride, frames)
        if reached:
            values, momenta = (by_node(system, frames[:reached], part) for part in (rows.values, rows.momenta))
            state = replace(state, values=values[-1], momenta=momenta[-1], step=state.step + reached * stride)
            if rows.forced:
                work = gather(frames[:reached], rows.forced["account"], system.cells)
                receive(values, momenta, work=work)
                state = replace(state, work=work[-1])
            else:
                receive(values, momenta)
        if outcome is not Outcome.FINISHED:
            if reached:
                before[1:-1, :kept] = frames[reached - 1]
            return _locate(system, plan, before, state, stride, outcome)
        done += count
        if progress is not None:
            progress(done / saves, state.time)
    return Result(Outcome.FINISHED, state, state.step)


def prepare(system: System) -> None:
    """Compile or load everything a run of the system calls, so that running is all that takes time then."""
    state = State(values=system.reference, momenta=np.zeros((system.size, system.layout.dofs)), h=1.0)
    data = pack(system, state)
    frames = np.empty((0, data.shape[0] - 2, system.equations.rows.kept, data.shape[2]))
    _advance(system, make_plan(system), data, state, 1, frames)


def make_plan(system: System) -> Plan:
    """Cut a system into tiles and sort held components and loads by them."""
    rows, lanes, layout = system.equations.rows, system.kernels.lanes, system.layout
    blocks = -(-system.cells // lanes)
    cell, position = np.divmod(system.slots, rows.cell)
    block, lane = 1 + cell // lanes, cell % lanes
    momenta = rows.momenta.start + position * layout.dofs
    held_node, held_dof = np.nonzero(~system.free)
    with_held = np.zeros(blocks + 2, dtype=bool)
    with_held[block[held_node]] = True
    large = not rows.forced and blocks * rows.momenta.stop * lanes * 8 > CACHED_BYTES
    cuts = {1, blocks + 1} | (set(range(1, blocks + 1, TILE)) if large else set())
    cuts |= {int(b) for b in np.flatnonzero(np.diff(with_held.astype(int))) + 1 if 1 <= b <= blocks}
    edges = sorted(cuts)
    spans = np.array([(a, b, int(with_held[a])) for a, b in itertools.pairwise(edges)], dtype=np.int64)
    held = np.column_stack([block[held_node], momenta[held_node] + held_dof, lane[held_node]]).astype(np.int64)
    entries, scales = np.zeros((0, 7), dtype=np.int64), np.zeros((0, 4))
    if system.loads is not None:
        loads = system.loads
        node = loads.node
        form = loads.form + 2 * (loads.form > 0) * (layout.representation.rows == 9)
        form = form + LEVER * np.any(loads.lever != 0.0, axis=1)
        tile = np.searchsorted(spans[:, 0], block[node], side="right") - 1
        turn = position[node] * layout.rows + loads.turn
        target = rows.forced["pushed"].start + position * layout.dofs if rows.forced else momenta
        columns = [block[node], lane[node], target[node] + loads.dof, turn, form, loads.column, tile]
        order = np.argsort(tile, kind="stable")
        entries = np.column_stack(columns).astype(np.int64)[order]
        scales = loads.factors[order]
    places = np.searchsorted(entries[:, 6], np.arange(len(spans) + 1))
    names = ["step", "step_held" if len(held) else "step", "kick"]
    if rows.forced:
        names.append("predict")
        places[:] = 0
    found = [system.kernels[name] for name in names]
    uniforms = np.zeros((4, max(kernel.width for kernel in found)))
    uniforms[:, : len(system.uniforms)] = system.uniforms
    kernels = np.zeros((4, 2), dtype=np.int64)
    kernels[: len(found)] = [(kernel.run, kernel.setup) for kernel in found]
    timed = system.equations.density.timed
    return Plan(kernels, uniforms, timed, spans, DEPTH if large else 1, held, entries, scales, places)


def _advance(
    system: System,
    plan: Plan,
    data: np.ndarray,
    state: State,
    stride: int,
    frames: np.ndarray,
) -> tuple[Outcome, int]:
    """One call of the driver."""
    steps = len(frames) * stride
    if system.loads is None:
        table = np.zeros((1, 1))
    else:
        times = state.origin + (state.step + np.arange(steps + 1)) * state.h
        table = np.ascontiguousarray(system.loads.table(times, state.h, state.origin))
    clock = np.array([state.origin, state.h, float(state.step)])
    saves, blocks, kept, lanes = frames.shape
    failed = decoupled.advance(
        dict(zip(ARGUMENTS[:8], plan.kernels.flat, strict=True))
        | {"data": data, "blocks": blocks, "rows": data.shape[1], "lanes": lanes, "kept": kept}
        | {"uniforms": plan.uniforms, "width": plan.uniforms.shape[1], "timed": plan.timed}
        | {"spans": plan.spans, "tiles": len(plan.spans), "depth": plan.depth}
        | {"fixed": plan.held, "fixed_count": len(plan.held)}
        | {"table": table, "columns": table.shape[1], "entries": plan.entries, "entry_count": len(plan.entries)}
        | {"scales": plan.scales, "places": plan.places}
        | {"stride": stride, "saves": saves, "frames": frames, "clock": clock}
    )
    good = np.isfinite(frames[: saves if failed < 0 else failed]).all(axis=(1, 2, 3))
    if not good.all():
        return Outcome.NOT_FINITE, int(np.argmin(good))
    return (Outcome.FINISHED, saves) if failed < 0 else (Outcome.NOT_CONVERGED, failed)


def _locate(system: System, plan: Plan, data: np.ndarray, state: State, stride: int, outcome: Outcome) -> Result:
    """Repeat the last interval step by step to find the step and the node that failed."""
    frame = np.empty((1, data.shape[0] - 2, system.equations.rows.kept, data.shape[2]))
    good = aligned(data.shape)
    for k in range(stride):
        good[:] = data
        found, _ = _advance(system, plan, data, replace(state, step=state.step + k), 1, frame)
        if found is not Outcome.FINISHED:
            return Result(outcome, state, state.step + k, _failed_node(system, good, data))
    return Result(outcome, state, state.step + stride)


def _failed_node(system: System, before: np.ndarray, after: np.ndarray) -> int:
    """The first node that is not finite, else the one that moved most."""
    rows = system.equations.rows
    new, old = (by_node(system, blocks[1:-1], rows.values) for blocks in (after, before))
    momenta = by_node(system, after[1:-1], rows.momenta)
    broken = ~(np.isfinite(new).all(axis=1) & np.isfinite(momenta).all(axis=1))
    if broken.any():
        return int(np.argmax(broken))
    return int(np.argmax(np.abs(new - old).max(axis=1)))
