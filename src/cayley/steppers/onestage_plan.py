"""What the driver of one-stage rules works on: blocks of lanes and the mesh."""

from dataclasses import dataclass

import numpy as np

from cayley.discrete.fused import FusedRows, fused_rows
from cayley.steppers import onestage
from cayley.steppers.galerkin_plan import HISTORY, Advance, field_table, load_entries, reach, recall, stage_table
from cayley.steppers.outcome import Outcome
from cayley.system.system import State, System, aligned, scatter


@dataclass(frozen=True, slots=True)
class Plan:
    """What the driver needs besides the state and the loads.

    Args:
        call: addresses of run and setup of the kernel "fused", shape (2,).
        uniforms: its uniform inputs and room behind them.
        rows: rows of its blocks.
        fields: (is rotation, first row, first dof, size) of each field.
        chains: (first node, last node) of each chain.
        extent: what corrections of vectors are measured by [m].
        entries: loaded nodes, shape (k, 7).
        scales: their factors.
    """

    call: np.ndarray
    uniforms: np.ndarray
    rows: FusedRows
    fields: np.ndarray
    chains: np.ndarray
    extent: float
    entries: np.ndarray
    scales: np.ndarray


def make_plan(system: System, state: State) -> Plan:
    """Kernel, mesh and loads of a system."""
    equations = system.equations
    varying = tuple(n for n in equations.density.names if n in equations.varying)
    kernel = system.kernels["fused"]
    uniforms = np.zeros(kernel.width)
    known = dict(zip(equations.uniforms, system.uniforms, strict=True))
    values = [known[n] for n in equations.density.names if n not in equations.varying]
    uniforms[2 : 2 + len(values)] = values
    edges = np.cumsum([0, *system.chains])
    entries, scales = load_entries(system)
    return Plan(
        call=np.array([kernel.run, kernel.setup], dtype=np.int64),
        uniforms=uniforms,
        rows=fused_rows(equations.density, system.layout, varying),
        fields=field_table(system),
        chains=np.column_stack([edges[:-1], edges[1:]]).astype(np.int64),
        extent=reach(system),
        entries=entries,
        scales=scales,
    )


def advance(system: System, plan: Plan, state: State, stride: int, frames: np.ndarray) -> Advance:
    """One call of the driver."""
    rows, layout = plan.rows, system.layout
    data = _pack(system, state, rows)
    table = stage_table(system, state, np.array([0.5]), len(frames) * stride)
    momenta, memory, warm = recall(system, state)
    counts, history = np.zeros(4, dtype=np.int64), np.full((HISTORY, 2), np.nan)
    starts = [part.start for part in (rows.residual, rows.momentum, rows.diagonal, rows.upper, rows.lower)]
    at = np.array([layout.rows, *starts], dtype=np.int64)
    clock = np.array([state.origin, state.h, float(state.step)])
    mesh = (plan.chains, 1.0 / plan.extent, (0,) * layout.dofs)
    loads = (table, plan.entries, plan.scales)
    problem = (plan.call, data, at, plan.uniforms.copy(), plan.fields, system.free, mesh, momenta, loads)
    code, reached = onestage.advance(problem, memory, warm, clock, stride, frames, counts, history)
    return Advance(list(Outcome)[code], reached, counts, memory, history)


def _pack(system: System, state: State, rows: FusedRows) -> np.ndarray:
    """Blocks with the state, coordinates and constants; padding lanes hold a node at rest without element."""
    lanes = system.kernels.lanes
    data = aligned((-(-system.size // lanes) + 2, rows.count, lanes))
    data[:] = 0.0
    data[:, rows.before] = data[:, rows.after] = state.values[-1][None, :, None]
    known = dict(zip(system.equations.uniforms, system.uniforms, strict=True))
    for name, row in rows.named.items():
        values = np.asarray(system.named[name]) if name in system.named else np.full(system.size, known[name])
        data[:, row] = 0.0 if name == "length" else values[-1]
        scatter(data, slice(row, row + 1), values[:, None])
    scatter(data, rows.before, state.values)
    return data
