"""What the driver of Galerkin rules works on: interpolation tables, mesh and work arrays."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from cayley.discrete.rules import Points, lagrange, lobatto
from cayley.steppers import galerkin
from cayley.steppers.outcome import Outcome
from cayley.system.system import State, System, aligned

HISTORY = 4
"""Iterations that a failure tells of."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What the driver needs besides the state and the loads.

    Args:
        calls: addresses of run and setup of the kernels inertia_point and strain_point, shape (2, 2).
        rule: ℓ, ℓ′ and weights of the stages, extrapolation, φ, φ′ and weights in space, positions of the stages and
            of the control nodes.
        mesh: weights of nodes; elements; block and place of each node; fields; free; size of each block; whether
            derivatives scale with 1/length; chains of blocks; 1/extent.
        entries: loaded nodes (see load_entries), shape (k, 7).
        scales: their factors.
    """

    calls: np.ndarray
    rule: tuple[Any, ...]
    mesh: tuple[Any, ...]
    entries: np.ndarray
    scales: np.ndarray


def make_plan(system: System, state: State) -> Plan:
    """Interpolation, mesh and kernels of a system."""
    equations, layout = system.equations, system.layout
    rule = equations.rule
    ends = lobatto(len(rule.time.at))
    ell, dell = lagrange(ends, rule.time.at)
    onward, _ = lagrange(ends, [1.0 + tau for tau in ends])
    phi, psi, heavy, scaled = _in_space(rule.strain)
    fields = field_table(system)
    width, degree = layout.dofs * len(rule.time.at), rule.degree
    places, chains, active, elements = [], [], [], []
    start = block = 0
    for count in system.chains:
        first = block
        for k in range(count):
            inner = 0 if k == 0 else (k - 1) % degree
            if k == 0 or inner == 0:
                active.append(width * (1 if k == 0 else degree))
                block += 1
            places.append((block - 1, inner * width))
        chains.append((first, block))
        for e in range((count - 1) // degree):
            node = start + e * degree
            length = float(system.named["length"][node : node + degree].sum())
            elements.append((node, length, 1.0 / length))
        start += count
    mesh = (
        np.ascontiguousarray(system.named["weight"]),
        np.array(elements, dtype=float).reshape(-1, 3),
        np.array(places, dtype=np.int64),
        fields,
        system.free,
        np.array(active, dtype=np.int64),
        scaled,
        np.array(chains, dtype=np.int64),
        np.array([1.0 / reach(system)]),
    )
    names = ("inertia_point", "strain_point" if elements else "inertia_point")
    calls = np.array([(system.kernels[n].run, system.kernels[n].setup) for n in names], dtype=np.int64)
    weights = np.array(rule.time.weights)
    tables = (ell, dell, weights, onward, phi, psi, heavy, np.array(rule.time.at), ends)
    entries, scales = load_entries(system)
    return Plan(calls, tables, mesh, entries, scales)


def field_table(system: System) -> np.ndarray:
    """(is rotation, first row, first dof, size) of every field, shape (f, 4)."""
    layout = system.layout
    kinds = [
        (name in layout.rotations, layout.rows_of(name).start, layout.dofs_of(name).start, kind.size)
        for name, kind in layout.fields.items()
    ]
    return np.array(kinds, dtype=np.int64)


def recall(system: System, state: State) -> tuple[np.ndarray, np.ndarray, bool]:
    """Momenta, memory of the step before, and whether there is one."""
    shape = (system.size, len(system.equations.rule.time.at), system.layout.rows)
    if state.memory is None or state.memory.shape != shape:
        return state.momenta.copy(), np.zeros(shape), False
    return state.momenta.copy(), state.memory.copy(), True


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
    times = state.origin + (state.step + np.arange(max(steps, 1))[:, None] + stages[None]) * state.h
    return np.ascontiguousarray(system.loads.table.at_stages(times, state.h, state.origin))


def load_entries(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Loaded nodes for implicit drivers.

    Returns: (node, row, row of rotation, form, column, is moment, dof) per entry, shape (k, 7), and their factors (k,).
    """
    loads, layout = system.loads, system.layout
    if loads is None:
        return np.zeros((0, 7), dtype=np.int64), np.zeros(0)
    row_of_dof = {layout.dofs_of(n).start: layout.rows_of(n).start for n in layout.fields}
    moments = {layout.dofs_of(n).start for n in layout.rotations}
    row = [row_of_dof[int(d)] for d in loads.dof]
    moment = [int(int(d) in moments) for d in loads.dof]
    columns = [loads.node, np.array(row), loads.turn, loads.form, loads.column, np.array(moment), loads.dof]
    return np.column_stack(columns).astype(np.int64), np.ascontiguousarray(loads.scale)


def _in_space(strain: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
    """φ, φ′ and weights of the strain points; between ends the kernel takes the two end nodes as they are."""
    if strain.between_ends:
        return np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]]), np.ones(1), False
    phi, psi = lagrange(lobatto(len(strain.at)), strain.at)
    return phi, psi, np.array(strain.weights), True


class Advance(NamedTuple):
    """What one call of an implicit driver returns.

    Args:
        outcome: how it ended.
        reached: frames written.
        counts: iterations in all, most in a step, number and node of the last step, shape (4,).
        memory: control nodes of the last step.
        history: relative correction and largest residual [N s, N m s] of the last iterations, shape (HISTORY, 2).
    """

    outcome: Outcome
    reached: int
    counts: np.ndarray
    memory: np.ndarray
    history: np.ndarray


def advance(system: System, plan: Plan, state: State, stride: int, frames: np.ndarray) -> Advance:
    """One call of the driver."""
    order, steps = plan.rule[0].shape[1], len(frames) * stride
    table = stage_table(system, state, plan.rule[7], steps)
    control = np.repeat(state.values[:, None, :], order, axis=1)
    momenta, memory, warm = recall(system, state)
    work = work_arrays(system, plan, control)
    counts = np.zeros(4, dtype=np.int64)
    clock = np.array([state.origin, state.h, float(state.step)])
    loads = (table, plan.entries, plan.scales)
    code, reached = galerkin.advance(
        plan.calls, plan.rule, plan.mesh, work, (control, momenta, memory), warm, loads, clock, stride, frames, counts
    )
    return Advance(list(Outcome)[code], reached, counts, memory, work[14])


def work_arrays(
    system: System, plan: Plan, control: np.ndarray, names: tuple[str, ...] = ("inertia_point", "strain_point")
) -> tuple[Any, ...]:
    """Room for the driver, with the control nodes; names are those of the point kernels."""
    layout, lanes = system.layout, system.kernels.lanes
    stages, order = len(plan.rule[2]), plan.rule[0].shape[1]
    blocks, width = plan.mesh[5].shape[0], layout.dofs * stages * system.equations.rule.degree
    starts, lengths = plan.mesh[1][:, 0].astype(int), plan.mesh[1][:, 1]
    strain = system.equations.rule.strain
    along = np.outer(lengths, [0.0] if strain.between_ends else strain.at)
    strain_points = points_of(system, "strain_point", np.repeat(starts, along.shape[1]), lanes, along.reshape(-1))
    return (
        np.zeros((system.size, order, layout.rows)),
        np.zeros((system.size, stages, layout.rows)),
        np.zeros((blocks, width, width)),
        np.zeros((blocks, width, width)),
        np.zeros((blocks, width, width)),
        np.zeros((blocks, width)),
        points_of(system, "inertia_point", np.arange(system.size), lanes),
        stacked(strain_points, stages),
        _uniforms(system, names),
        control,
        _room(system, order - 1, len(plan.rule[6])),
        np.zeros((blocks, width), dtype=np.int64),
        np.zeros_like(control),
        np.zeros((blocks, width)),
        np.full((HISTORY, 2), np.nan),
    )


def points_of(system: System, name: str, nodes: np.ndarray, lanes: int, along: Any = 0.0) -> np.ndarray:
    """Blocks for a point kernel, with coordinates and varying constants filled in; points are ``along`` from nodes."""
    equations, rows = system.equations, system.layout.rows
    if len(nodes) == 0:
        return np.zeros((0, 1, lanes))
    program = equations.program(name)
    data = aligned((-(-len(nodes) // lanes), program.rows, lanes))
    data[:] = 0.0
    known = dict(zip(equations.uniforms, system.uniforms, strict=True))
    inverse = system.named.get("inverse", np.full(system.size, known.get("inverse", 1.0)))
    varying = [system.named[n] for n in equations.density.names if n in equations.varying]
    here = system.named.get("here", np.zeros(system.size))[nodes] + along
    inputs = [here, *(values[nodes] for values in (inverse, *varying))]
    for row, values in enumerate(inputs):
        flat = np.resize(values, data.shape[0] * lanes)
        data[:, 2 * rows + row] = flat.reshape(-1, lanes)
    for name_of_rotation in system.layout.rotations:  # padding: a rotation that is one
        data[:, system.layout.rows_of(name_of_rotation).start] = 1.0
    return data


def stacked(points: np.ndarray, stages: int) -> np.ndarray:
    """The same blocks for every stage, aligned."""
    data = aligned((stages, *points.shape))
    data[:] = points
    return data


def _room(system: System, degree: int, points: int) -> tuple[np.ndarray, ...]:
    """Room for contractions, and where the entries of a Hessian stand in its upper triangle.

    Returns: half a trivialized matrix, one row of it, a matrix, the Hessians of an element in four parts, one matrix
    for every pair of controls; the places.
    """
    rows, dofs = system.layout.rows, system.layout.dofs
    size = 2 * rows
    index = np.zeros((size, size), dtype=np.int64)
    upper = np.triu_indices(size)
    index[upper] = np.arange(len(upper[0]))
    index = np.maximum(index, index.T)
    square = np.zeros((rows, rows))
    hessians, pairs = np.zeros((degree, points, 4, rows, rows)), np.zeros((degree, degree, rows, rows))
    return np.zeros((dofs, rows)), np.zeros(dofs), square, hessians, pairs, index


def _uniforms(system: System, names: tuple[str, ...]) -> np.ndarray:
    """Uniform inputs of the point kernels: the time, then the constants."""
    equations = system.equations
    known = dict(zip(equations.uniforms, system.uniforms, strict=True))
    values = [known[n] for n in equations.density.names if n not in equations.varying]
    if equations.density.lagrangian.interval is None:
        names = names[:1]
    found = np.zeros((max(2, len(names)), max(system.kernels[n].width for n in names)))
    found[:, 1 : 1 + len(values)] = values
    return found
