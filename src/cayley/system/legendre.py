"""The Legendre transform of a system: momenta from velocities."""

import itertools

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.equations import DiscreteEquations
from cayley.discrete.node import node_point
from cayley.discrete.representation import continuous
from cayley.system.system import State, System, by_node, joined, pack, split


def initial_state(system: System, values: np.ndarray, velocity: np.ndarray, *, time: float = 0.0) -> State:
    """A state from values and velocities by the Legendre transform, μ = weight × ∂T/∂q̇.

    Args:
        system: the system.
        values: shape (nodes, rows); quaternions of neighbors in different hemispheres are brought into one.
        velocity: ẋ in space, ω in the body frame, shape (nodes, dofs); held degrees of freedom do not move.
        time: time of the state [s].

    Returns: the state at its step 0.
    """
    values = in_one_hemisphere(system, values)
    momenta = momenta_of(system, values, np.where(system.free, velocity, 0.0), time)
    return State(values=values, momenta=np.where(system.free, momenta, 0.0), origin=time)


def velocities_of(system: System, state: State) -> np.ndarray:
    """Velocities of every node, shape (nodes, dofs), from its momenta, zero where held."""
    return joined([_velocities_of(*pair) for pair in split(system, state)])


def _velocities_of(system: System, state: State) -> np.ndarray:
    kernel, rows = system.kernels["observe"], system.equations.rows
    uniforms = np.zeros(kernel.width)
    uniforms[: len(system.uniforms)] = system.uniforms
    uniforms[1] = uniforms[2] = state.time
    data = pack(system, state)
    kernel(data, uniforms, 1, data.shape[0] - 1)
    return by_node(system, data[1:-1], rows.observed["velocity"])


def in_one_hemisphere(system: System, values: np.ndarray) -> np.ndarray:
    """Signs of quaternions that are continuous along every chain: p and −p are one rotation, but not their mean."""
    layout = system.layout
    if layout.representation.name != "quaternion":
        return values
    chosen = values.copy()
    edges = np.cumsum([0, *system.chains])
    for name in layout.rotations:
        rows = layout.rows_of(name)
        for first, last in itertools.pairwise(edges):
            chosen[first:last, rows] = continuous(values[first:last, rows])
    return chosen


def momenta_of(system: System, values: np.ndarray, velocity: np.ndarray, time: float) -> np.ndarray:
    """Nodal momenta μ = weight × ∂T/∂q̇, left-trivialized, for values and velocities of every node.

    Args:
        system: the system.
        values: shape (nodes, rows).
        velocity: shape (nodes, dofs).
        time: the time [s].

    Returns: momenta, shape (nodes, dofs).

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 2.
    """
    return joined([_momenta_of(group, values[nodes], velocity[nodes], time) for group, nodes in system.spans])


def _momenta_of(system: System, values: np.ndarray, velocity: np.ndarray, time: float) -> np.ndarray:
    equations, layout, density = system.equations, system.layout, system.equations.density
    function = equations.once("momenta", lambda: _momenta_function(equations))
    known = dict(zip(equations.uniforms, system.uniforms, strict=True))
    n = system.size
    columns = [system.named.get("here", np.zeros(n)), np.full(n, time), system.named["weight"]]
    constants = [np.broadcast_to(system.named.get(k, known.get(k, 0.0)), n) for k in density.names]
    rows = np.column_stack([values, velocity, *columns, *constants])
    return np.array(function(rows.T)).T.reshape(n, layout.dofs)


def _momenta_function(equations: DiscreteEquations) -> ca.Function:
    """Weight × ∂T/∂q̇ as a function of rows (values, velocities, s, t, weight, constants)."""
    layout, density = equations.layout, equations.density
    node, v = symbols("q", layout.rows), symbols("v", layout.dofs)
    here, t, weight = (wrap(ca.SX.sym(name)) for name in ("here", "t", "weight"))
    point = node_point(layout, node, density.lagrangian.interval, {"here": here, "t": t})
    point |= {f"{name}_t": v[layout.dofs_of(name)] for name in layout.fields}
    gradient = density.gradient("inertia", point)
    momentum = ca.vertcat(*[to_sx(gradient[f"{name}_t"] * weight) for name in layout.fields])
    inputs = ca.vertcat(*[to_sx(e) for e in (node, v, here, t, weight)], density.parameters)
    return ca.Function("momenta", [inputs], [ca.densify(momentum)])
