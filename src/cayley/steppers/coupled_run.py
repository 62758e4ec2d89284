"""Run a system of an explicit rule with constraints, springs or dampers between its nodes from frame to frame."""

import ctypes
import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cayley.steppers import problem, saddle
from cayley.steppers.cells import spring_cells
from cayley.steppers.contacts import TOLD, make_contacts, with_ground
from cayley.steppers.native import fill, structure
from cayley.steppers.outcome import Outcome, Result
from cayley.steppers.problem import Plan
from cayley.steppers.turned_run import run_turned
from cayley.system.system import State, System, aligned, by_node, gather, joined, pack, split
from cayley.system.turned import embedded

CHUNK = 20_000
"""Most steps in one call of the driver."""


@dataclass(frozen=True, slots=True)
class Group:
    """What does not change from call to call of the blocks of one density.

    Args:
        system: its system.
        calls: addresses of run and setup of kick, drift and predict (0 without), by their names in struct
            explicit_group.
        uniforms: their uniform inputs and room behind them, shape (3, width).
        spans: first block, last block, and whether constraints know a node there, shape (m, 3).
        fixed: block, row, lane of momenta that stay zero, shape (f, 3).
    """

    system: System
    calls: dict[str, int]
    uniforms: np.ndarray
    spans: np.ndarray
    fixed: np.ndarray


@dataclass(frozen=True, slots=True)
class Explicit:
    """What does not change from call to call.

    Args:
        plan: the problem of the constrained nodes.
        groups: the densities.
        slot: group, block, lane, first row of values, of momenta and of predicted velocities (−1 without) of the
            constrained nodes, shape (n, 6).
        touching: the same of all nodes, and the first row to which forces are added, shape (nodes, 7).
        entries: loads: group, block, lane, row, row of the rotation, form and column, shape (k, 7).
        scales: their factors and levers, shape (k, 4).
    """

    plan: Plan
    groups: tuple[Group, ...]
    slot: np.ndarray
    touching: np.ndarray
    entries: np.ndarray
    scales: np.ndarray


def make_plan(system: System) -> Explicit:
    """Kernels, rows and loads of a system."""
    if "coupled" in system.plans:
        return system.plans["coupled"]
    nodes = saddle.constrained_nodes(system)
    plan = saddle.make_plan(system, spring_cells(system, nodes))
    slots = np.concatenate([_slots(group, k) for k, group in enumerate(system.groups)])
    known = np.zeros(system.size, dtype=bool)
    known[nodes] = True
    entries, scales = np.zeros((0, 7), dtype=np.int64), np.zeros((0, 4))
    if system.loads is not None:
        loads = system.loads
        number, block, lane, values, _, _, target = slots[loads.node].T
        columns = [number, block, lane, target + loads.dof, values + loads.turn, loads.form, loads.column]
        entries, scales = np.column_stack(columns).astype(np.int64), loads.factors
    made = Explicit(
        plan=plan,
        groups=tuple(_group(group, slots[own], known[own]) for group, own in system.spans),
        slot=np.ascontiguousarray(slots[nodes, :6]),
        touching=np.ascontiguousarray(slots),
        entries=entries,
        scales=scales,
    )
    system.plans["coupled"] = made
    return made


def _slots(system: System, number: int) -> np.ndarray:
    """Where the nodes of a group are, a row of Explicit.slot for each, and the first row to which loads are added."""
    rows, layout = system.equations.rows, system.layout
    cell, position = np.divmod(system.slots, rows.cell)
    block, lane = 1 + cell // system.kernels.lanes, cell % system.kernels.lanes
    momenta = rows.momenta.start + position * layout.dofs
    predicted, loaded = np.full(system.size, -1), momenta
    if rows.forced:
        predicted, loaded = (rows.forced[name].start + position * layout.dofs for name in ("predicted", "pushed"))
    columns = [np.full(system.size, number), block, lane, position * layout.rows, momenta, predicted, loaded]
    return np.column_stack(columns).astype(np.int64)


def _group(system: System, slots: np.ndarray, known: np.ndarray) -> Group:
    """Kernels and blocks of a group, from the slots of its nodes and whether constraints know them."""
    _, block, lane, _, momenta, _, _ = slots.T
    node, dof = np.nonzero(~system.free)
    names = ["kick", "drift_held" if len(node) else "drift", *(["predict"] if system.equations.forced else [])]
    found = [system.kernels[name] for name in names]
    uniforms = np.zeros((3, max(kernel.width for kernel in found)))
    uniforms[:, : len(system.uniforms)] = system.uniforms
    addresses = [address for kernel in found for address in (kernel.run, kernel.setup)]
    return Group(
        system=system,
        calls=dict.fromkeys(_CALLS, 0) | dict(zip(_CALLS, addresses, strict=False)),
        uniforms=uniforms,
        spans=_spans(-(-system.cells // system.kernels.lanes), set(block[known].tolist())),
        fixed=np.column_stack([block[node], momenta[node] + dof, lane[node]]).astype(np.int64),
    )


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
    explicit = make_plan(system)
    data = [pack(*pair) for pair in split(system, _without_ties(state))]
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        works = np.zeros((count, 1, 2))
        frames = [
            aligned((count, own.shape[0] - 2, group.system.equations.rows.kept, own.shape[2]))
            for group, own in zip(explicit.groups, data, strict=True)
        ]
        call = _advance(explicit, data, state, stride, frames, works)
        outcome, reached, counts = call.outcome, call.reached, call.counts
        if reached:
            values, momenta, own = _unpacked(explicit, [part[:reached] for part in frames])
            last = state.step + reached * stride
            known = call.memory if outcome is Outcome.FINISHED else None
            state = replace(state, values=values[-1], momenta=momenta[-1], step=last, memory=known)
            more: dict[str, Any] = {}
            if system.accounted:
                more["work"] = joined([*own, works[:reached]], axis=1)
                state = replace(state, work=more["work"][-1])
            if system.contact is not None:
                more["contact"] = call.contact[:reached]
            receive(values, momenta, **more)
        if outcome is not Outcome.FINISHED:
            last = state.step + int(counts[2]) - reached * stride
            return Result(outcome, state, last, int(counts[3]), partners=call.partners)
        done += count
        if progress is not None:
            progress(done / saves, state.time)
    return Result(Outcome.FINISHED, state, state.step)


def _without_ties(state: State) -> State:
    """The state without the account of ties, which stands behind those of the cells."""
    return state if state.work is None else replace(state, work=state.work[:-1])


def _unpacked(explicit: Explicit, frames: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Values and momenta of all nodes, and accounts of the cells of groups that have them, of frames."""
    values, momenta, accounts = [], [], []
    for group, own in zip(explicit.groups, frames, strict=True):
        system, rows = group.system, group.system.equations.rows
        values.append(by_node(system, own, rows.values))
        momenta.append(by_node(system, own, rows.momenta))
        if rows.forced:
            accounts.append(gather(own, rows.forced["account"], system.cells))
    return joined(values, axis=1), joined(momenta, axis=1), accounts


def prepare(system: System) -> None:
    """Compile or load everything a run of the system calls."""
    make_plan(embedded(system))


@dataclass(frozen=True, slots=True)
class _Call:
    """What one call of the driver returns.

    Args:
        outcome: how it ended.
        reached: frames written.
        counts: see struct problem.
        memory: multipliers, and what is remembered of contacts.
        contact: of each frame what is told of contacts and their forces on all nodes, flat, shape (frames, k).
        partners: which touch where it stopped for that.
    """

    outcome: Outcome
    reached: int
    counts: np.ndarray
    memory: np.ndarray
    contact: np.ndarray
    partners: str


def _advance(
    explicit: Explicit, data: list[np.ndarray], state: State, stride: int, frames: list[np.ndarray], works: np.ndarray
) -> _Call:
    """One call of the driver."""
    plan = explicit.plan
    system, steps = plan.system, len(works) * stride
    made = problem.make_problem(plan, state, steps, len(works), {"works": works})
    if state.work is not None:
        made.arrays["energy"][1:] = state.work[-1]
    sizes = [c["start"].size for c in made.couplings]
    kept = None if state.memory is None else np.split(state.memory, [sum(sizes)])
    if kept is not None and kept[0].size == sum(sizes):
        for coupling, end, size in zip(made.couplings, np.cumsum(sizes), sizes, strict=True):
            coupling["start"][:] = kept[0][end - size : end].reshape(coupling["start"].shape)
    contacts = None if system.contact is None else make_contacts(system, state.h)
    told, force = (
        np.zeros((len(works), TOLD)),
        np.zeros((len(works), system.size if contacts else 0, system.layout.dofs)),
    )
    if contacts is not None:
        contacts.begin(state.values, None if kept is None else kept[1])
    table = np.zeros((1, 1))
    if system.loads is not None:
        times = state.origin + (state.step + np.arange(steps + 1)) * state.h
        table = np.ascontiguousarray(system.loads.table(times, state.h, state.origin))
    given = np.zeros((plan.size + 1, system.layout.dofs))
    groups = [_fields(*three) for three in zip(explicit.groups, data, frames, strict=True)]
    structs = (structure("explicit_group") * len(groups))(*(fill("explicit_group", fields) for fields in groups))
    arrays = {
        "slot": explicit.slot,
        "contact_slot": explicit.touching,
        "contact_values": with_ground(system.layout, state.values) if contacts else np.zeros(1),
        "contact_told": told,
        "contact_force": force,
        "given": given,
        "before": np.zeros_like(given),
        "table": table,
        "entries": explicit.entries,
        "scales": explicit.scales,
    }
    numbers = {
        "problem": ctypes.addressof(made.struct),
        "contacts": 0 if contacts is None else ctypes.addressof(contacts.struct),
        "group": ctypes.addressof(structs),
        "groups": len(groups),
        "columns": table.shape[1],
        "entry_count": len(explicit.scales),
    }
    struct, reached = fill("explicit_run", arrays | numbers), ctypes.c_int64(0)
    code = made.engine.advance_explicit(ctypes.byref(struct), ctypes.byref(reached))
    counts, outcome = made.arrays["counts"], list(Outcome)[code]
    if outcome is Outcome.REDUNDANT:
        counts[3] = plan.nodes[np.flatnonzero(plan.block_of == counts[3])[0]]
    elif outcome is Outcome.NOT_CONVERGED or outcome.hasty:
        counts[3] = -1
    memory = np.concatenate([np.zeros(0), *(c["start"].reshape(-1) for c in made.couplings)])
    partners = ""
    if contacts is not None:
        outcome, memory, partners = contacts.close(outcome, memory)
    contact = np.concatenate([told, force.reshape(len(works), -1)], axis=1)
    return _Call(outcome, reached.value, counts, memory, contact, partners)


def _fields(group: Group, data: np.ndarray, frames: np.ndarray) -> dict[str, Any]:
    """Fields of struct explicit_group."""
    arrays = {"data": data, "saved": aligned(data.shape), "frames": frames}
    arrays |= {"uniforms": group.uniforms, "spans": group.spans, "fixed": group.fixed}
    numbers = {
        "width": group.uniforms.shape[1],
        "blocks": data.shape[0] - 2,
        "rows": data.shape[1],
        "kept": frames.shape[2],
        "span_count": len(group.spans),
        "fixed_count": len(group.fixed),
    }
    return arrays | numbers | group.calls


_CALLS = ("kick", "kick_setup", "drift", "drift_setup", "predict", "predict_setup")
