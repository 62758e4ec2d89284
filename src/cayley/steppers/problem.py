"""The problem that the compiled steppers work on: nodes, terms, constraints and the blocks of a matrix, as arrays."""

import ctypes
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.discrete.rules import MIDDLE, Points, lagrange, lobatto
from cayley.steppers.arrays import coupling_arrays, term_arrays
from cayley.steppers.blocks import Blocks
from cayley.steppers.cells import Cells
from cayley.steppers.native import fill, library, structure
from cayley.system.redundancy import ground_values
from cayley.system.system import State, System, aligned

HISTORY = 4
"""Iterations that a failure tells of."""
TANGENT_COST, TANGENT_SIZE = 4.0, 15.0
"""Cost of an evaluation with tangent and factorization over that of one without, for small blocks, and the size of a
block from which on factorization prevails: measured 5 for blocks of 6."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What does not change from call to call.

    Args:
        system: the system.
        nodes: its nodes that take part, shape (n,); cells number them by their place here, n is the ground.
        tables: ℓ, ℓ′, weights, positions of stages and controls, extrapolation.
        terms: cells of inertia of every density, then those of strain, forces and springs.
        constraints: cells of constraints.
        blocks: how unknowns are eliminated.
        block_of: block of every node, shape (n,).
        base: place of its first unknown in the block, shape (n,).
        multipliers: for every cells of constraints, block and place in it of the first multiplier of each cell.
    """

    system: System
    nodes: np.ndarray
    tables: Mapping[str, np.ndarray]
    terms: tuple[Cells, ...]
    constraints: tuple[Cells, ...]
    blocks: Blocks
    block_of: np.ndarray
    base: np.ndarray
    multipliers: tuple[tuple[np.ndarray, np.ndarray], ...]

    @property
    def size(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @property
    def lanes(self) -> int:
        """Doubles in a vector."""
        return self.system.kernels.lanes

    @property
    def inertia(self) -> int:
        """How many of the terms, the first ones, are those of inertia, which alone return derivatives along rates."""
        return sum(cells.rated for cells in self.terms)

    @property
    def stages(self) -> int:
        """Number of stages."""
        return len(self.tables["weights"])


def make_plan(
    system: System, nodes: np.ndarray, time: Points, groups: np.ndarray, terms: list[Cells], constraints: list[Cells]
) -> Plan:
    """Plan the elimination of the unknowns of a step.

    Args:
        system: the system.
        nodes: its nodes that take part.
        time: the stages of a step.
        groups: number of the group of each of them, from 0; those of a group are eliminated together.
        terms: cells of inertia first.
        constraints: cells of constraints.
    """
    return Plan(
        system,
        nodes,
        _tables(time),
        tuple(terms),
        tuple(constraints),
        *_blocks(system, time, groups, terms, constraints),
    )


def _tables(time: Points) -> dict[str, np.ndarray]:
    stages = MIDDLE if time.corners else time
    ends = lobatto(len(stages.at))
    ell, dell = lagrange(ends, stages.at)
    onward = np.ascontiguousarray(lagrange(ends, 1.0 + ends)[0])
    weights, at = np.array(stages.weights), np.array(stages.at)
    return {"ell": ell, "dell": dell, "weights": weights, "at": at, "ends": ends, "onward": onward}


def _blocks(
    system: System, time: Points, groups: np.ndarray, terms: list[Cells], constraints: list[Cells]
) -> tuple[Blocks, np.ndarray, np.ndarray, tuple[tuple[np.ndarray, np.ndarray], ...]]:
    """Blocks of unknowns: a group of nodes, and multipliers with one of their nodes.

    The multipliers of a cell stand with the last of its nodes, which goes after the others: then the pivots of what is
    eliminated are those of a system whose remaining nodes are held, and no constraint is left without its nodes.
    """
    size, count = len(groups), int(groups.max()) + 1
    stages = 1 if time.corners else len(time.at)
    width = stages * system.layout.dofs
    base = width * _ranks(groups)
    sizes = np.bincount(groups, minlength=count) * width
    known = [cells for cells in terms if cells.nodes.shape[1] > 1]
    pairs = [_couples(groups, cells.nodes) for cells in (*known, *constraints)]
    multipliers, before = [], []
    for cells in constraints:
        nodes = np.where(cells.nodes < size, cells.nodes, -1)
        owner = groups[nodes.max(axis=1)]
        more = stages * cells.gauss * cells.count
        multipliers.append((owner, sizes[owner] + more * _ranks(owner)))
        sizes = sizes + more * np.bincount(owner, minlength=count)
        for column in nodes.T:
            other = np.where(column >= 0, groups[column], owner)
            before.append(np.column_stack([other, owner])[other != owner])
    empty = np.zeros((0, 2), dtype=np.int64)
    blocks = Blocks(system.kernels.lanes, sizes, np.concatenate([empty, *pairs]), np.concatenate([empty, *before]))
    return blocks, groups, base, tuple(multipliers)


def _ranks(groups: np.ndarray) -> np.ndarray:
    """Number of earlier entries that are equal, of each entry."""
    order = np.argsort(groups, kind="stable")
    found = np.empty(len(groups), dtype=np.int64)
    found[order] = np.arange(len(groups)) - np.searchsorted(groups[order], groups[order])
    return found


def _couples(groups: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Groups that cells couple, shape (m, 2)."""
    found = []
    for a, b in itertools.combinations(range(nodes.shape[1]), 2):
        both = nodes[:, [a, b]]
        found.append(groups[both[(both < len(groups)).all(axis=1)]])
    return np.concatenate(found)


@dataclass(slots=True)
class Problem:
    """The arrays of struct problem, and the structs that point to them.

    Args:
        plan: the plan.
        arrays: by the names of the fields.
        couplings: those of every struct coupling.
        struct: the struct.
        alive: what must live as long.
    """

    plan: Plan
    arrays: dict[str, Any]
    couplings: list[dict[str, Any]]
    struct: Any
    alive: list[Any]

    @property
    def engine(self) -> Any:
        """The functions for it."""
        pose = [tuple(row) for row in self.arrays["field"]] == [(1, 0, 0, 3), (0, 4, 3, 3)]
        return library(self.plan.lanes, pose=pose)


def make_problem(plan: Plan, state: State, steps: int, saves: int, more: Mapping[str, Any] | None = None) -> Problem:
    """Fill the arrays for a call that begins at a state.

    Args:
        plan: the plan.
        state: where it begins.
        steps: number of steps.
        saves: number of saved frames, steps between them equal.
        more: fields of struct problem, instead of those of a problem without loads and frames.
    """
    layout, nodes, stages = plan.system.layout, plan.size, plan.stages
    values = (nodes + 1, layout.rows)
    unknowns = int(plan.blocks.sizes.sum())
    starts = plan.blocks.starts
    control = np.zeros((stages + 1, *values))
    control[:, :nodes] = state.values[plan.nodes]
    control[:, nodes] = ground_values(layout)
    memory = np.zeros((stages, *values))
    memory[:, nodes] = control[0, nodes]
    couplings = [coupling_arrays(plan, cells, k, steps, state, starts) for k, cells in enumerate(plan.constraints)]
    terms = [term_arrays(plan, cells) for cells in plan.terms]
    padded = -(-layout.dofs // plan.lanes) * plan.lanes
    arrays: dict[str, Any] = {
        **plan.tables,
        "field": field_table(plan.system),
        "control": control,
        "memory": memory,
        "accepted": np.zeros_like(control),
        "reached": np.zeros_like(control),
        "momenta": np.concatenate([state.momenta[plan.nodes], np.zeros((1, layout.dofs))]),
        "velocity": np.zeros((nodes + 1, layout.dofs)),
        "after": np.zeros((nodes + 1, layout.dofs)),
        "residual": np.zeros((nodes + 1, stages, layout.dofs)),
        "free": np.concatenate([plan.system.free[plan.nodes].astype(float), np.zeros((1, layout.dofs))]),
        "place": starts[plan.block_of] + plan.base,
        "diagonal": plan.blocks.diagonal(),
        "matrix": aligned((plan.blocks.size,)),
        "pivots": np.zeros(unknowns, dtype=np.int64),
        "watch": np.zeros((unknowns, 2)) if couplings else 0,
        "unknown": np.zeros(unknowns),
        "taken": np.zeros(unknowns),
        "mass": aligned((nodes + 1, layout.dofs, padded)),
        "bias": np.zeros((nodes + 1, layout.dofs)),
        "cells": aligned((_room(plan) * plan.lanes,)),
        "table": np.zeros((1, 1, 1)),
        "entries": np.zeros((0, 7), dtype=np.int64),
        "scales": np.zeros(0),
        "frames": np.zeros(0),
        "contact_nodes": 0,
        "contact_places": 0,
        "contact_told": np.zeros(0),
        "contact_force": np.zeros(0),
        "motion": 0,
        "rates": np.zeros(0),
        "works": np.zeros(0),
        "counts": np.zeros(4, dtype=np.int64),
        "history": np.full((HISTORY, 2), np.nan),
        "energy": np.zeros(3),
    }
    arrays["mass"][:] = 0.0
    parts = [
        (structure("term") * len(terms))(*(fill("term", t) for t in terms)),
        (structure("coupling") * len(couplings))(*(fill("coupling", c) for c in couplings)),
    ]
    numbers = {
        "nodes": nodes,
        "rows": layout.rows,
        "dofs": layout.dofs,
        "fields": len(arrays["field"]),
        "stages": stages,
        "still": 0,
        "order": 0,
        "penalty": 0,
        "spin": 0,
        "tangent_cost": TANGENT_COST * (1.0 + float(plan.blocks.sizes.max()) / TANGENT_SIZE),
        "extent": 1.0 / reach(plan.system),
        "term": ctypes.addressof(parts[0]),
        "terms": len(terms),
        "inertia": plan.inertia,
        "coupling": ctypes.addressof(parts[1]),
        "couplings": len(couplings),
        "contacts": 0,
        "renew": 0,
        "fronts": plan.blocks.fronts,
        "matrix_size": plan.blocks.size,
        "unknowns": unknowns,
        "origin": state.origin,
        "h": state.h,
        "first": float(state.step),
        "warm": 0,
        "saves": saves,
        "stride": steps // max(saves, 1),
        "history_size": HISTORY,
    }
    arrays |= dict(more or {})
    numbers |= {"columns": arrays["table"].shape[-1], "entry_count": len(arrays["scales"])}
    struct = fill("problem", numbers | arrays)
    return Problem(plan, arrays, couplings, struct, [terms, *parts])


def _room(plan: Plan) -> int:
    """Vectors of the largest block of cells in terms.c and couplings.c."""
    rows, dofs = plan.system.layout.rows, plan.system.layout.dofs
    width = max(cells.nodes.shape[1] for cells in (*plan.terms, *plan.constraints))
    controls = 2 * (plan.stages + 1) * width * rows
    return controls + (plan.stages**2 + 4) * rows**2 + rows * dofs + dofs**2 + rows + 16


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
