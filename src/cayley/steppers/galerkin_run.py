"""Run a system of an implicit rule from frame to frame: interpolation tables, mesh and work arrays for the driver."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial

from cayley.discrete.rules import Points, lobatto
from cayley.steppers import galerkin
from cayley.steppers.outcome import Outcome, Result
from cayley.system.system import State, System, aligned

CHUNK = 2_000
"""Most steps in one call of the driver."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What the driver needs besides the state and the loads.

    Args:
        calls: addresses of run and setup of the kernels inertia_point and strain_point, shape (2, 2).
        rule: ℓ, ℓ′ and weights of the stages, extrapolation, φ, φ′ and weights in space, positions of the stages and
            of the control nodes.
        mesh: weights of nodes; elements; block and place of each node; fields; free; size of each block; whether
            derivatives scale with 1/length; chains of blocks; 1/extent.
        entries: (node, row, row of rotation, form, column, is moment) per loaded node, shape (k, 6).
        scales: their factors.
    """

    calls: np.ndarray
    rule: tuple[Any, ...]
    mesh: tuple[Any, ...]
    entries: np.ndarray
    scales: np.ndarray


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
    plan = make_plan(system, state)
    rows = system.layout.rows
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        frames = np.empty((count, system.size, rows + system.layout.dofs))
        outcome, reached, counts = _advance(system, plan, state, stride, frames)
        if reached:
            values, momenta = frames[:reached, :, :rows], frames[:reached, :, rows:]
            receive(values.copy(), momenta.copy())
            last = state.step + reached * stride
            state = replace(state, values=values[-1].copy(), momenta=momenta[-1].copy(), step=last)
        if outcome is not Outcome.FINISHED:
            return Result(outcome, state, state.step + int(counts[2]) - reached * stride, int(counts[3]))
        done += count
        if progress is not None:
            progress(done / saves, state.time)
    return Result(Outcome.FINISHED, state, state.step)


def prepare(system: System) -> None:
    """Compile or load everything a run of the system calls."""
    state = State(values=system.reference, momenta=np.zeros((system.size, system.layout.dofs)), h=1.0)
    frames = np.empty((0, system.size, system.layout.rows + system.layout.dofs))
    _advance(system, make_plan(system, state), state, 1, frames)


def make_plan(system: System, state: State) -> Plan:
    """Interpolation, mesh and kernels of a system."""
    equations, layout = system.equations, system.layout
    rule = equations.rule
    ends = lobatto(len(rule.time.at))
    ell, dell = lagrange(ends, rule.time.at)
    onward, _ = lagrange(ends, [1.0 + tau for tau in ends])
    phi, psi, heavy, scaled = _in_space(rule.strain)
    kinds = [
        (n in layout.rotations, layout.rows_of(n).start, layout.dofs_of(n).start, k.size)
        for n, k in layout.fields.items()
    ]
    fields = np.array(kinds, dtype=np.int64)
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
    extent = np.ptp(state.values, axis=0)
    reach = max(
        (float(extent[layout.rows_of(n)].max()) for n in layout.fields if n not in layout.rotations), default=0.0
    )
    mesh = (
        np.ascontiguousarray(system.named["weight"]),
        np.array(elements, dtype=float).reshape(-1, 3),
        np.array(places, dtype=np.int64),
        fields,
        system.free,
        np.array(active, dtype=np.int64),
        scaled,
        np.array(chains, dtype=np.int64),
        np.array([1.0 / reach if reach > 0.0 else 1.0]),
    )
    names = ("inertia_point", "strain_point" if elements else "inertia_point")
    calls = np.array([(system.kernels[n].run, system.kernels[n].setup) for n in names], dtype=np.int64)
    weights = np.array(rule.time.weights)
    tables = (ell, dell, weights, onward, phi, psi, heavy, np.array(rule.time.at), ends)
    entries, scales = np.zeros((0, 6), dtype=np.int64), np.zeros(0)
    if system.loads is not None:
        loads = system.loads
        row_of_dof = {layout.dofs_of(n).start: layout.rows_of(n).start for n in layout.fields}
        moments = {layout.dofs_of(n).start for n in layout.rotations}
        row = [row_of_dof[int(d)] for d in loads.dof]
        moment = [int(int(d) in moments) for d in loads.dof]
        entries = np.column_stack([loads.node, row, loads.turn, loads.form, loads.column, moment]).astype(np.int64)
        scales = np.ascontiguousarray(loads.scale)
    return Plan(calls, tables, mesh, entries, scales)


def lagrange(nodes: np.ndarray, at: Any) -> tuple[np.ndarray, np.ndarray]:
    """Lagrange polynomials of the nodes and their derivatives, shape (len(at), len(nodes)) each."""
    basis = []
    for i, node in enumerate(nodes):
        others = np.delete(nodes, i)
        basis.append(Polynomial.fromroots(others) / float(np.prod(node - others)) if len(others) else Polynomial([1.0]))
    points = np.asarray(at, dtype=float)
    values = np.column_stack([p(points) for p in basis])
    return np.ascontiguousarray(values), np.ascontiguousarray(np.column_stack([p.deriv()(points) for p in basis]))


def _in_space(strain: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
    """φ, φ′ and weights of the strain points; for corners the kernel takes the two end nodes as they are."""
    if strain.corners:
        return np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]]), np.ones(1), False
    phi, psi = lagrange(lobatto(len(strain.at)), strain.at)
    return phi, psi, np.array(strain.weights), True


def _advance(
    system: System, plan: Plan, state: State, stride: int, frames: np.ndarray
) -> tuple[Outcome, int, np.ndarray]:
    """One call of the driver."""
    layout, lanes = system.layout, system.kernels.lanes
    stages, order, steps = len(plan.rule[2]), plan.rule[0].shape[1], len(frames) * stride
    if system.loads is None:
        table = np.zeros((1, 1, 1))
    else:
        times = state.origin + (state.step + np.arange(max(steps, 1))[:, None] + plan.rule[7][None]) * state.h
        table = np.ascontiguousarray(system.loads.table.at_stages(times, state.h, state.origin))
    control = np.repeat(state.values[:, None, :], order, axis=1)
    momenta = state.momenta.copy()
    blocks, width = plan.mesh[5].shape[0], layout.dofs * stages * system.equations.rule.degree
    work = (
        np.zeros((system.size, order, layout.rows)),
        np.zeros((system.size, stages, layout.rows)),
        np.zeros((blocks, width, width)),
        np.zeros((blocks, width, width)),
        np.zeros((blocks, width, width)),
        np.zeros((blocks, width)),
        _points(system, "inertia_point", np.arange(system.size), lanes),
        _points(system, "strain_point", np.repeat(plan.mesh[1][:, 0].astype(int), len(plan.rule[6])), lanes),
        _uniforms(system),
        control,
    )
    counts = np.zeros(4, dtype=np.int64)
    clock = np.array([state.origin, state.h, float(state.step)])
    loads = (table, plan.entries, plan.scales)
    code, reached = galerkin.advance(
        plan.calls, plan.rule, plan.mesh, work, (control, momenta), loads, clock, stride, frames, counts
    )
    return list(Outcome)[code], reached, counts


def _points(system: System, name: str, nodes: np.ndarray, lanes: int) -> np.ndarray:
    """Blocks for a point kernel, with coordinates and varying constants of the nodes filled in."""
    equations, rows = system.equations, system.layout.rows
    if len(nodes) == 0:
        return np.zeros((0, 1, lanes))
    program = equations.program(name)
    data = aligned((-(-len(nodes) // lanes), program.rows, lanes))
    data[:] = 0.0
    known = dict(zip(equations.uniforms, system.uniforms, strict=True))
    inverse = system.named.get("inverse", np.full(system.size, known.get("inverse", 1.0)))
    varying = [system.named[n] for n in equations.density.names if n in equations.varying]
    inputs = [system.named.get("here", np.zeros(system.size)), inverse, *varying]
    for row, values in enumerate(inputs):
        flat = np.resize(values[nodes], data.shape[0] * lanes)
        data[:, 2 * rows + row] = flat.reshape(-1, lanes)
    for name_of_rotation in system.layout.rotations:  # padding: a rotation that is one
        data[:, system.layout.rows_of(name_of_rotation).start] = 1.0
    return data


def _uniforms(system: System) -> np.ndarray:
    """Uniform inputs of the point kernels: the time, then the constants."""
    equations = system.equations
    known = dict(zip(equations.uniforms, system.uniforms, strict=True))
    values = [known[n] for n in equations.density.names if n not in equations.varying]
    has_elements = equations.density.lagrangian.interval is not None
    names = ("inertia_point", "strain_point") if has_elements else ("inertia_point",)
    found = np.zeros((2, max(system.kernels[n].width for n in names)))
    found[:, 1 : 1 + len(values)] = values
    return found
