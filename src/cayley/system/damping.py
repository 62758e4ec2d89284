"""Linearized non-conservative forces: what they add to the stiffness of a system, and its damping."""

from typing import Any

import casadi as ca
import numpy as np

from cayley.density.expression import Expression, symbols, to_sx, wrap
from cayley.density.force import KINDS
from cayley.discrete.equations import DiscreteEquations
from cayley.discrete.forcing import TINY, element_forcing, node_forcing
from cayley.discrete.node import tangent
from cayley.discrete.places import constants_at, placed
from cayley.system.system import System

Matrices = tuple[np.ndarray, np.ndarray]


def forced_matrices(
    system: System, inputs: np.ndarray, lengths: np.ndarray, rates: np.ndarray
) -> tuple[Matrices, Matrices]:
    """Symmetric parts of −∂F/∂q and −∂F/∂q̇ of all forces that are not in the Lagrangian.

    Args:
        system: the system.
        inputs: values of the nodes of every element, 1/ds, s of its ends, t, weight of its first node, its length and
            the constants, shape (nodes, inputs), as the stability of the system takes them.
        lengths: of the elements, each at its first node, 0 where none starts, shape (nodes,).
        rates: velocities, shape (nodes, dofs).

    Returns: stiffness and damping, each of elements (nodes, (m + 1) d, (m + 1) d) and of nodes (nodes, d, d).
    """
    equations = system.equations
    function = equations.once("forced linearization", lambda: _linearization(equations))
    count = equations.rows.cell + 1
    others = TINY + np.column_stack([np.roll(rates, -k, axis=0) for k in range(count)])
    numbers = [np.asarray(m) for m in function(np.column_stack([inputs, others]).T)]
    made = [_symmetric(m, len(inputs)) for m in numbers]
    for k in (0, 2):
        made[k][lengths == 0.0] = 0.0
    return (made[0], made[1]), (made[2], made[3])


def _linearization(equations: DiscreteEquations) -> ca.Function:
    """−∂F/∂q and −∂F/∂q̇ of an element and of a node, as a function of rows of inputs and velocities."""
    density, layout, count = equations.density, equations.layout, equations.rows.cell + 1
    ends = [symbols(f"end{k}", layout.rows) for k in range(count)]
    moving = [symbols(f"rate{k}", layout.dofs) for k in range(count)]
    names: dict[str, Any] = {n: wrap(ca.SX.sym(n)) for n in ("inverse", "left", "right", "t", "weight", "length")}
    extra = {n: ca.SX.sym(n) for n in placed(equations.varying)}
    place: dict[str, Any] = names | {"here": names["left"]}
    place["at points"] = [constants_at(extra, k) for k in range(len(equations.rule.strain.at))]
    zero = ca.SX.zeros(count * layout.dofs)
    of_node, of_element = ca.SX.zeros(layout.dofs), zero
    for kind in KINDS:
        of_node += to_sx(node_forcing(density, layout, ends[0], moving[0], place, kind)) * to_sx(names["weight"])
        if density.force is not None and density.force.between_nodes(kind):
            found = element_forcing(density, equations.rule.strain, layout, ends, moving, place, kind)
            of_element += ca.vertcat(*[to_sx(f) for f in found]) * to_sx(names["length"])
    turn = ca.diagcat(*[tangent(layout, end) for end in ends])
    q, v = _joined(ends), _joined(moving)
    d = layout.dofs
    outputs = [
        -ca.jacobian(of_element, q) @ turn,
        -ca.jacobian(of_node, q)[:, : layout.rows] @ turn[: layout.rows, :d],
        -ca.jacobian(of_element, v),
        -ca.jacobian(of_node, v)[:, :d],
    ]
    symbols_of = ca.vertcat(q, _joined(list(names.values())), density.parameters, *extra.values(), v)
    return ca.Function("forced", [symbols_of], [ca.densify(o) for o in outputs])


def _joined(values: list[Expression]) -> ca.SX:
    return ca.vertcat(*[to_sx(v) for v in values])


def _symmetric(matrix: np.ndarray, count: int) -> np.ndarray:
    """Symmetric parts of a row of square matrices, (r, count·r) -> (count, r, r)."""
    made = matrix.reshape(matrix.shape[0], count, -1).transpose(1, 0, 2)
    return np.asarray(0.5 * (made + made.transpose(0, 2, 1)))
