"""What the compiled implicit stepper works on: interpolation tables, terms, constraints, blocks of unknowns."""

import ctypes
import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.discrete.rules import lagrange, lobatto
from cayley.steppers.blocks import Blocks
from cayley.steppers.native import fill, library, structure
from cayley.steppers.outcome import Outcome
from cayley.steppers.terms import Cells, constraint_cells, coupling_arrays, element_cells, node_cells, term_arrays
from cayley.system.system import LoadEntries, State, System, aligned

HISTORY = 4
"""Iterations that a failure tells of."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What does not change from call to call.

    Args:
        system: the system.
        tables: ℓ, ℓ′, weights, positions of stages and controls, extrapolation.
        terms: cells of inertia, then of strain and forces.
        constraints: cells of constraints.
        blocks: how unknowns are eliminated.
        block_of: block of every node, shape (nodes,).
        base: place of its first unknown in the block, shape (nodes,).
        multiplier_base: the same of the multipliers of every cell of constraints, and their block.
    """

    system: System
    tables: dict[str, np.ndarray]
    terms: tuple[Cells, ...]
    constraints: tuple[Cells, ...]
    blocks: Blocks
    block_of: np.ndarray
    base: np.ndarray
    multipliers: tuple[tuple[np.ndarray, np.ndarray], ...]


@dataclass(frozen=True, slots=True)
class Advance:
    """What one call of the driver returns.

    Args:
        outcome: how it ended.
        reached: frames written.
        counts: iterations in all, most in a step, number and node of the last step, shape (4,).
        memory: control nodes and multipliers of the last step, flat.
        history: relative correction and largest residual [N s, N m s] of the last iterations, shape (HISTORY, 2).
        work: of loads, and of forces [J].
    """

    outcome: Outcome
    reached: int
    counts: np.ndarray
    memory: np.ndarray
    history: np.ndarray
    work: np.ndarray


def make_plan(system: System) -> Plan:
    """Interpolation, cells and blocks of a system, its kernels compiled."""
    rule = system.equations.rule
    ends = lobatto(len(rule.time.at))
    ell, dell = lagrange(ends, rule.time.at)
    tables = {
        "ell": ell,
        "dell": dell,
        "weights": np.array(rule.time.weights),
        "at": np.array(rule.time.at),
        "ends": ends,
        "onward": np.ascontiguousarray(lagrange(ends, 1.0 + ends)[0]),
    }
    terms, constraints = [node_cells(system)], []
    if any(count > 1 for count in system.chains):
        terms.append(element_cells(system, "strain_point"))
        if system.equations.density.constraints.numel():
            constraints.append(constraint_cells(system))
    return Plan(system, tables, tuple(terms), tuple(constraints), *_blocks(system, terms, constraints))


def _blocks(
    system: System, terms: list[Cells], constraints: list[Cells]
) -> tuple[Blocks, np.ndarray, np.ndarray, tuple[tuple[np.ndarray, np.ndarray], ...]]:
    """Group unknowns: a node between elements by itself, those inside an element together, multipliers with a node.

    The multipliers of a cell stand with the last of its nodes, which goes after the others: then the pivots of what is
    eliminated are those of a system whose remaining nodes are held, and no constraint is left without its nodes.
    """
    stages, degree = len(system.equations.rule.time.at), system.equations.rule.degree
    width = stages * system.layout.dofs
    block_of, base = np.empty(system.size, dtype=np.int64), np.zeros(system.size, dtype=np.int64)
    start = block = 0
    for count in system.chains:
        k = np.arange(count)
        element, inner = np.divmod(k, degree)
        block_of[start : start + count] = block + (2 * element + (inner > 0) if degree > 1 else k)
        base[start : start + count] = width * np.maximum(inner - 1, 0)
        block = int(block_of[start + count - 1]) + 1
        start += count
    sizes = np.bincount(block_of, minlength=block) * width
    pairs = [block_of[cells.nodes][:, [a, b]] for cells in terms for a, b in _two(cells.nodes.shape[1])]
    multipliers, before = [], []
    for cells in constraints:
        nodes = np.where(cells.nodes < system.size, cells.nodes, -1)
        owner = block_of[nodes.max(axis=1)]
        more = stages * cells.gauss * cells.count
        order = np.argsort(owner, kind="stable")  # several cells may belong to one block
        ranks = np.empty(len(owner), dtype=np.int64)
        first = np.searchsorted(owner[order], owner[order])
        ranks[order] = np.arange(len(owner)) - first
        multipliers.append((owner, sizes[owner] + ranks * more))
        sizes = sizes + np.bincount(owner, minlength=block) * more
        for a in range(nodes.shape[1]):
            other = np.where(nodes[:, a] >= 0, block_of[nodes[:, a]], owner)
            distinct = other != owner
            before.append(np.column_stack([other, owner])[distinct])
        pairs += [
            np.column_stack([block_of[nodes[:, a]], block_of[nodes[:, b]]])[(nodes[:, a] >= 0) & (nodes[:, b] >= 0)]
            for a, b in _two(nodes.shape[1])
        ]
    empty = np.zeros((0, 2), dtype=np.int64)
    blocks = Blocks(system.kernels.lanes, sizes, np.concatenate([empty, *pairs]), np.concatenate([empty, *before]))
    return blocks, block_of, base, tuple(multipliers)


def _two(width: int) -> list[tuple[int, int]]:
    return list(itertools.combinations(range(width), 2))


def advance(plan: Plan, state: State, stride: int, frames: np.ndarray) -> Advance:
    """One call of the driver."""
    call = Call.of(plan, state, stride, frames)
    return call.run()


@dataclass(slots=True)
class Call:
    """The arrays of one call of the driver, and the structs that point to them."""

    plan: Plan
    arrays: dict[str, Any]
    parts: list[Any]
    problem: Any
    shape: tuple[int, ...]
    multipliers: list[dict[str, Any]]

    @classmethod
    def of(cls, plan: Plan, state: State, stride: int, frames: np.ndarray) -> "Call":
        """Fill the arrays."""
        system, tables = plan.system, plan.tables
        layout, lanes, nodes = system.layout, system.kernels.lanes, system.size
        stages = len(tables["weights"])
        values = (nodes + 1, layout.rows)
        steps = max(len(frames) * stride, 1)
        unknowns = int(plan.blocks.sizes.sum())
        starts = plan.blocks.starts
        control = np.zeros((stages + 1, *values))
        control[:, :nodes] = state.values
        control[:, nodes] = ground(system)
        couplings = [
            coupling_arrays(plan, cells, k, steps, state, starts) for k, cells in enumerate(plan.constraints)
        ]
        memory = np.zeros((stages, *values))
        warm = _recall(state, memory, couplings)
        memory[:, nodes] = control[0, nodes]
        terms = [term_arrays(plan, cells) for cells in plan.terms]
        padded = -(-layout.dofs // lanes) * lanes
        entries, scales = load_entries(system)
        arrays: dict[str, Any] = {
            **tables,
            "field": field_table(system),
            "control": control,
            "memory": memory,
            "accepted": np.zeros_like(control),
            "reached": np.zeros_like(control),
            "momenta": np.concatenate([state.momenta, np.zeros((1, layout.dofs))]),
            "after": np.zeros((nodes + 1, layout.dofs)),
            "residual": np.zeros((nodes + 1, stages, layout.dofs)),
            "free": np.concatenate([system.free.astype(float), np.zeros((1, layout.dofs))]),
            "place": starts[plan.block_of] + plan.base,
            "diagonal": plan.blocks.diagonal(),
            "matrix": aligned((plan.blocks.size,)),
            "pivots": np.zeros(unknowns, dtype=np.int64),
            "unknown": np.zeros(unknowns),
            "taken": aligned((max(unknowns, (nodes + 1) * layout.dofs * padded),)),
            "cells": aligned((_room(plan) * lanes,)),
            "table": stage_table(system, state, tables["at"], steps),
            "entries": entries,
            "scales": scales,
            "frames": frames,
            "counts": np.zeros(4, dtype=np.int64),
            "history": np.full((HISTORY, 2), np.nan),
            "energy": np.zeros(3),
        }
        arrays["taken"][:] = 0.0
        parts = [(structure("term") * len(terms))(*(fill("term", t) for t in terms))]
        parts.append((structure("coupling") * len(couplings))(*(fill("coupling", c) for c in couplings)))
        numbers = {
            "nodes": nodes,
            "rows": layout.rows,
            "dofs": layout.dofs,
            "fields": len(arrays["field"]),
            "stages": stages,
            "extent": 1.0 / reach(system),
            "term": _address(parts[0]),
            "terms": len(terms),
            "inertia": 1,
            "coupling": _address(parts[1]),
            "couplings": len(couplings),
            "fronts": plan.blocks.fronts,
            "matrix_size": plan.blocks.size,
            "unknowns": unknowns,
            "columns": arrays["table"].shape[2],
            "entry_count": len(scales),
            "origin": state.origin,
            "h": state.h,
            "first": float(state.step),
            "warm": int(warm),
            "stride": stride,
            "saves": len(frames),
            "history_size": HISTORY,
        }
        problem = fill("problem", arrays | numbers)
        return cls(plan, arrays, [terms, *parts], problem, values, couplings)

    def run(self) -> Advance:
        """Call the driver."""
        pose = [tuple(field) for field in field_table(self.plan.system)] == [(1, 0, 0, 3), (0, 4, 3, 3)]
        engine = library(self.plan.system.kernels.lanes, pose=pose)
        reached = ctypes.c_int64(0)
        code = engine.advance(ctypes.byref(self.problem), ctypes.byref(reached))
        memory = self.arrays["memory"][:, :-1]
        flat = [memory.reshape(-1), *(c["start"].reshape(-1) for c in self.multipliers)]
        outcome = list(Outcome)[code]
        counts = self.arrays["counts"]
        if outcome is Outcome.REDUNDANT:
            counts[3] = int(np.flatnonzero(self.plan.block_of == counts[3])[0])
        return Advance(
            outcome, reached.value, counts, np.concatenate(flat), self.arrays["history"], self.arrays["energy"][1:]
        )


def _address(array: Any) -> int:
    return ctypes.addressof(array)


def _recall(state: State, memory: np.ndarray, couplings: list[dict[str, Any]]) -> bool:
    """Put what a state remembers of the last step into the arrays; returns whether there was anything."""
    inner = memory[:, :-1]
    sizes = [inner.size, *(c["start"].size for c in couplings)]
    if state.memory is None or state.memory.shape != (sum(sizes),):
        return False
    first, *others = np.split(state.memory, np.cumsum(sizes)[:-1])
    inner[:] = first.reshape(inner.shape)
    for coupling, values in zip(couplings, others, strict=True):
        coupling["start"][:] = values.reshape(coupling["start"].shape)
    return True


def _room(plan: Plan) -> int:
    """Vectors of the largest block of cells in terms.c and couplings.c."""
    rows, dofs = plan.system.layout.rows, plan.system.layout.dofs
    stages = len(plan.tables["weights"])
    width = max(cells.nodes.shape[1] for cells in (*plan.terms, *plan.constraints))
    controls = 2 * (stages + 1) * width * rows
    return controls + (stages**2 + 4) * rows**2 + rows * dofs + dofs**2 + rows + 16


def ground(system: System) -> np.ndarray:
    """Values of the node that stands for the ground: rotations one, vectors zero, shape (rows,)."""
    layout = system.layout
    found = np.zeros(layout.rows)
    for name in layout.rotations:
        found[layout.rows_of(name).start] = 1.0
    return found


def field_table(system: System) -> np.ndarray:
    """(is rotation, first row, first dof, size) of every field, shape (f, 4)."""
    layout = system.layout
    kinds = [
        (name in layout.rotations, layout.rows_of(name).start, layout.dofs_of(name).start, kind.size)
        for name, kind in layout.fields.items()
    ]
    return np.array(kinds, dtype=np.int64)


def reach(system: System) -> float:
    """Extent of the reference: what a correction of vectors is measured by; 1 where everything is at one place."""
    layout = system.layout
    extent = np.ptp(system.reference, axis=0)
    vectors = [name for name in layout.fields if name not in layout.rotations]
    found = max((float(extent[layout.rows_of(name)].max()) for name in vectors), default=0.0)
    return found if found > 0.0 else 1.0


def stage_table(system: System, state: State, stages: np.ndarray, steps: int) -> np.ndarray:
    """Values of the time-dependent loads at the stages of the next steps, shape (steps, stages, columns)."""
    if system.loads is None:
        return np.zeros((1, 1, 1))
    times = state.origin + (state.step + np.arange(steps)[:, None] + stages[None]) * state.h
    return np.ascontiguousarray(system.loads.table.at_stages(times, state.h, state.origin))


def load_entries(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Loaded nodes.

    Returns: (node, row, row of rotation, form, column, is moment, dof) per entry, shape (k, 7), and their factors (k,).
    """
    loads, layout = system.loads, system.layout
    if loads is None:
        return np.zeros((0, 7), dtype=np.int64), np.zeros(0)
    return _entries_of(loads, layout)


def _entries_of(loads: LoadEntries, layout: Any) -> tuple[np.ndarray, np.ndarray]:
    row_of_dof = {layout.dofs_of(n).start: layout.rows_of(n).start for n in layout.fields}
    moments = {layout.dofs_of(n).start for n in layout.rotations}
    row = [row_of_dof[int(d)] for d in loads.dof]
    moment = [int(int(d) in moments) for d in loads.dof]
    columns = [loads.node, np.array(row), loads.turn, loads.form, loads.column, np.array(moment), loads.dof]
    return np.column_stack(columns).astype(np.int64), np.ascontiguousarray(loads.scale)
