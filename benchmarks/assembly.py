"""What joints and closed loops cost under the rule ``midpoint``.

A tree of rods, welded at their ends, is stepped against one rod of as many elements of the same kind, in turn. That
rod has corners, in directions drawn as those of the tree, so that it moves alike. Times are those of the loop, over
elements and steps; the ratio is given over Newton iterations, too.

In a square lattice of rods every place where rods meet closes loops: the matrix of its step is factored by the block LU
of the library and by SuperLU (scipy.sparse.linalg.splu). For that its entries are numbers drawn by chance, with the
pattern of the step: 6 x 6 blocks of nodes with large diagonals, derivatives of constraints, a zero block below them.
"""

import argparse
import ctypes
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from harness import paired, spread, write
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

import cayley as cy
from cayley.steppers import implicit_run
from cayley.steppers.native import address, library
from cayley.steppers.outcome import Outcome
from cayley.steppers.problem import Plan
from cayley.system.discretize import discretize, initial_values
from cayley.system.legendre import initial_state
from cayley.system.system import State, System, aligned

RODS, EACH = 100, 100
"""Rods of the tree, and elements of each."""
ELEMENT = 0.02
"""Length of an element [m]."""
SIDE = 19
"""Places along an edge of the lattice: 4·19·18 ends of rods at 19² places make 1007 joints."""
STEP, STEPS = 2e-3, 10
RATIO_WANTED = 1.5
"""Largest cost of the tree over that of the chain."""


@dataclass(frozen=True, slots=True)
class Problem:
    """A model ready to be stepped.

    Args:
        system: compiled and discretized.
        plan: its cells and blocks.
        state: at rest.
        elements: number of elements.
    """

    system: System
    plan: Plan
    state: State
    elements: int


def section() -> cy.Section:
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    return cy.Section.circle(0.02, rubber)


def problem(model: cy.Model) -> Problem:
    system = discretize(model, cy.rules.midpoint)
    values, velocity, _ = initial_values(model, system, {})
    state = initial_state(system, values, velocity).at_step(STEP)
    return Problem(system, implicit_run.make_plan(system), state, sum(rod.elements for rod in model.rods))


def tree(rods: int, each: int) -> cy.Model:
    """Every rod carries two others, in directions drawn by chance; the first is clamped."""
    rng, length, made, ties = np.random.default_rng(0), each * ELEMENT, [], []
    for k in range(rods):
        parent = made[(k - 1) // 2] if k else None
        origin = (0.0, 0.0, 0.0) if parent is None else parent.end.place[0]
        own = cy.Rod(
            section(), length=length, elements=each, origin=origin, direction=rng.normal(size=3), name=f"rod{k}"
        )
        if parent is not None:
            ties.append(cy.joints.weld(parent.end, own.start))
        made.append(own)
    return _held(made, ties)


def chain(pieces: int, each: int) -> cy.Model:
    """One rod of straight pieces, their directions drawn by chance."""
    ways = np.random.default_rng(0).normal(size=(pieces, 3))
    steps = each * ELEMENT * ways / np.linalg.norm(ways, axis=1, keepdims=True)
    points = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    return _held([cy.Rod.polyline(section(), points, elements=pieces * each)], [])


def lattice(side: int) -> cy.Model:
    """Rods of two elements along the edges of squares, welded where they meet."""
    ends: dict[tuple[int, int], list[Any]] = {}
    made = []
    for i in range(side):
        for j in range(side):
            for there in ((i + 1, j), (i, j + 1)):
                if max(there) == side:
                    continue
                step = np.array([*there, 0.0]) - (i, j, 0.0)
                origin = 2.0 * ELEMENT * np.array((i, j, 0.0))
                rod = cy.Rod(
                    section(),
                    length=2.0 * ELEMENT,
                    elements=2,
                    origin=origin,
                    direction=step,
                    normal=(0, 0, 1),
                    name=f"rod{len(made)}",
                )
                made.append(rod)
                ends.setdefault((i, j), []).append(rod.start)
                ends.setdefault(there, []).append(rod.end)
    ties = [cy.joints.weld(meeting[0], other) for meeting in ends.values() for other in meeting[1:]]
    return _held(made, ties)


def _held(rods: list[Any], ties: list[Any]) -> cy.Model:
    gravity = cy.loads.gravity((0.0, 1.0, -9.81))
    return cy.Model(*rods, supports=[cy.supports.clamp(rods[0].start)], joints=ties, loads=[gravity])


def run(given: Problem, steps: int) -> tuple[float, int]:
    """Time of the loop [s] and Newton iterations of some steps."""
    frames = np.empty((1, given.system.size, given.system.layout.rows + given.system.layout.dofs))
    began = time.perf_counter()
    done = implicit_run.advance(given.plan, given.state, steps, frames)
    wall_time = time.perf_counter() - began
    if done.outcome is not Outcome.FINISHED:
        raise RuntimeError(f"a run of {given.elements} elements ended as {done.outcome} at step {done.counts[2]}")
    return wall_time, int(done.counts[0])


def compare(repeats: int, steps: int) -> dict[str, Any]:
    """The tree against the chain."""
    branched, single = problem(tree(RODS, EACH)), problem(chain(RODS, EACH))
    pairs = paired(lambda: run(branched, steps)[0], lambda: run(single, steps)[0], repeats)
    iterations = [run(each, steps)[1] / steps for each in (branched, single)]
    share = 1e6 / (steps * RODS * EACH)
    figures = {
        "elements": branched.elements,
        "joints": len(branched.system.joints),
        "dt_s": STEP,
        "steps": steps,
        "tree_us_per_element_step": spread([share * t for t in pairs.first]),
        "chain_us_per_element_step": spread([share * t for t in pairs.second]),
        "ratio": spread(pairs.ratios),
        "ratio_wanted": RATIO_WANTED,
        "iterations_per_step": {"tree": iterations[0], "chain": iterations[1]},
        "ratio_per_iteration": spread([r * iterations[1] / iterations[0] for r in pairs.ratios]),
    }
    costs = [figures[f"{name}_us_per_element_step"]["median"] for name in ("tree", "chain")]
    print(
        f"tree {costs[0]:.2f} us, chain {costs[1]:.2f} us per element and step: {figures['ratio']['median']:.2f} times"
        f" (wanted {RATIO_WANTED}); iterations a step {iterations[0]:.2f} and {iterations[1]:.2f}; over iterations"
        f" {figures['ratio_per_iteration']['median']:.2f} times"
    )
    return figures


def filled(plan: Plan) -> tuple[csc_array, np.ndarray]:
    """A matrix with the pattern of a step: sparse, and in the storage of the block LU."""
    rng, blocks, dofs = np.random.default_rng(1), plan.blocks, plan.system.layout.dofs
    starts = blocks.starts
    first = starts[plan.block_of] + plan.base
    entries: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []

    def add(rows: np.ndarray, columns: np.ndarray, values: np.ndarray) -> None:
        """Blocks of values (m, r, c) at first rows and columns (m,)."""
        across = np.broadcast_to(columns[:, None, None] + np.arange(values.shape[2]), values.shape)
        entries.append(
            (np.broadcast_to(rows[:, None, None] + np.arange(values.shape[1])[:, None], values.shape), across, values)
        )

    add(first, first, np.tile(30.0 * np.eye(dofs), (plan.size, 1, 1)))
    for cells in plan.terms:
        if cells.nodes.shape[1] == 2:
            for a in range(2):
                for b in range(2):
                    add(
                        first[cells.nodes[:, a]],
                        first[cells.nodes[:, b]],
                        rng.normal(size=(len(cells.nodes), dofs, dofs)),
                    )
    for cells, (owner, place) in zip(plan.constraints, plan.multipliers, strict=True):
        spot = starts[owner] + place
        for nodes in cells.nodes.T:
            slope = rng.normal(size=(len(nodes), cells.count, dofs))
            add(spot, first[nodes], slope)
            add(first[nodes], spot, slope.transpose(0, 2, 1))
    rows, columns, values = (np.concatenate([e[k].reshape(-1) for e in entries]) for k in range(3))
    unknowns = int(blocks.sizes.sum())
    matrix = csc_array(coo_array((values, (rows, columns)), shape=(unknowns, unknowns)))
    compact = matrix.tocoo()
    order = np.argsort(starts)
    block = order[np.searchsorted(starts[order], compact.row, side="right") - 1]
    other = order[np.searchsorted(starts[order], compact.col, side="right") - 1]
    where = blocks.locate(block, other)
    stored = aligned((blocks.size,))
    stored[:] = 0.0
    stored[where[:, 0] + (compact.row - starts[block]) * where[:, 1] + compact.col - starts[other]] = compact.data
    return matrix, stored


def factor(side: int, repeats: int) -> dict[str, Any]:
    """The lattice's matrix, by both factorizations."""
    given = problem(lattice(side))
    plan = given.plan
    matrix, stored = filled(plan)
    engine, work = library(plan.lanes), aligned(stored.shape)
    pivots = np.zeros(matrix.shape[0], dtype=np.int64)
    fronts, pointers = ctypes.c_int64(plan.blocks.fronts), [address(work), address(pivots)]

    def ours() -> float:
        work[:] = stored
        began = time.perf_counter()
        failed = engine.factorize(fronts, *pointers, None)
        wall_time = time.perf_counter() - began
        if failed:
            raise RuntimeError(f"block {failed - 1} of the lattice is singular")
        return wall_time

    def theirs() -> float:
        began = time.perf_counter()
        splu(matrix)
        return time.perf_counter() - began

    pairs = paired(ours, theirs, repeats)
    right = np.random.default_rng(2).normal(size=matrix.shape[0])
    found = right.copy()
    engine.solve(fronts, *pointers, address(found))
    left = float(np.abs(matrix @ found - right).max())
    left_theirs = float(np.abs(matrix @ splu(matrix).solve(right) - right).max())
    wall_time, iterations = run(given, 3)
    figures = {
        "joints": len(given.system.joints),
        "elements": given.elements,
        "unknowns": matrix.shape[0],
        "entries": int(matrix.nnz),
        "block_lu_ms": spread([1e3 * t for t in pairs.first]),
        "superlu_ms": spread([1e3 * t for t in pairs.second]),
        "ratio": spread(pairs.ratios),
        "residual": {"block_lu": left, "superlu": left_theirs},
        "step_ms": 1e3 * wall_time / 3,
        "iterations_per_step": iterations / 3,
    }
    print(
        f"lattice of {figures['joints']} joints, {figures['unknowns']} unknowns: block LU"
        f" {figures['block_lu_ms']['median']:.1f} ms, SuperLU {figures['superlu_ms']['median']:.1f} ms;"
        f" residuals {left:.1e}, {left_theirs:.1e}; a step takes {figures['step_ms']:.1f} ms"
    )
    return figures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    figures = {
        "problem": "rubber rods, radius 20 mm, elements of 20 mm, clamped at one end, let go under their weight",
        "rule": "midpoint",
        "tree": compare(given.repeats, given.steps),
        "lattice": factor(SIDE, given.repeats),
    }
    write("assembly", figures, to=given.out)


if __name__ == "__main__":
    main()
