"""One step of rules with one stage in time and two nodes in an element, assembled whole: residual, momenta, tangent.

With q̄ = (q⁰ + q¹)/2 and q̇ = (q¹ − q⁰)/h unnormalized in the embedding space (see discrete.embedded), the discrete
Lagrangian of a node is w h (T − U)(q̄, q̇) and that of an element −h ds W(q̄ₐ, q̄_b). Everything that block
tridiagonal Newton needs of them fits in one kernel over the nodes.
"""

from dataclasses import dataclass

import casadi as ca

from cayley.density import Density
from cayley.density.expression import Expression, symbols, to_sx, wrap
from cayley.discrete.element import element_energy
from cayley.discrete.embedded import embedded_point, normalized
from cayley.discrete.layout import Layout
from cayley.discrete.node import tangent
from cayley.discrete.program import Assign, Carry, Program, Step
from cayley.discrete.rules import Points


@dataclass(frozen=True, slots=True)
class FusedRows:
    """Where things stand in a block of the fused kernel.

    Args:
        before: values at the start of the step.
        after: values at its end: the unknown.
        named: single rows: "weight", "length" of the element to the right (0 where there is none), "here",
            "inverse" and constants that vary.
        residual: D₀ L_d of the node, without its momentum.
        momentum: D₁ L_d of the node.
        diagonal: derivative of the residual along the node's own unknown, row by row.
        upper: that along the next node's unknown.
        lower: derivative of the next node's residual along this node's unknown.
        carried: what is handed to the next node.
        count: number of rows.
    """

    before: slice
    after: slice
    named: dict[str, int]
    residual: slice
    momentum: slice
    diagonal: slice
    upper: slice
    lower: slice
    carried: slice
    count: int


def fused_rows(density: Density, layout: Layout, varying: tuple[str, ...]) -> FusedRows:
    """Rows of the fused kernel."""
    r, d = layout.rows, layout.dofs
    names = ["weight", *(["length", "here", "inverse"] if density.lagrangian.interval else []), *varying]
    at = 0

    def take(size: int) -> slice:
        nonlocal at
        at += size
        return slice(at - size, at)

    before, after = take(r), take(r)
    named = {name: take(1).start for name in names}
    residual, momentum, diagonal, upper, lower, carried = (take(n) for n in (d, d, d * d, d * d, d * d, 2 * d + d * d))
    return FusedRows(before, after, named, residual, momentum, diagonal, upper, lower, carried, at)


def fused_program(density: Density, layout: Layout, points: Points, varying: tuple[str, ...]) -> Program:
    """The program "fused": residual, momenta and tangent of every node.

    Args:
        density: the density.
        layout: rows of a node, rotations as quaternions.
        points: where the strain terms stand along an element: corners, middle or screw.
        varying: names of constants that differ from node to node.
    """
    rows = fused_rows(density, layout, varying)
    h, t = ca.SX.sym("h"), ca.SX.sym("t")
    constants = dict(zip(density.names, ca.vertsplit(density.parameters), strict=True))
    named = {name: constants.get(name, ca.SX.sym(name)) for name in rows.named}
    before, after = symbols("q0", layout.rows), symbols("q1", layout.rows)
    lanes = [(s, i, 0) for s, i in zip(_list(before), _range(rows.before), strict=True)]
    lanes += [(s, i, 0) for s, i in zip(_list(after), _range(rows.after), strict=True)]
    lanes += [(named[n], i, 0) for n, i in rows.named.items()]
    tangents = [tangent(layout, before), tangent(layout, after)]
    residual, momentum, diagonal = _node(density, layout, (before, after), tangents, named, h, t)
    steps: list[Step] = []
    size = layout.dofs
    upper = lower = ca.SX.zeros(size, size)
    if density.lagrangian.interval is not None:
        other = symbols("r0", layout.rows), symbols("r1", layout.rows)
        for row, values in ((rows.before, other[0]), (rows.after, other[1])):
            lanes += [(s, i, 1) for s, i in zip(_list(values), _range(row), strict=True)]
        own, upper, lower, handed = _element(density, layout, points, (before, after), other, named, h, t)
        names = _list(symbols("handed", len(handed)))
        carried = _list(symbols("carried", len(handed)))
        steps = [
            Assign(tuple(names), tuple(handed)),
            Carry(tuple(carried), tuple(names), tuple(_range(rows.carried))),
        ]
        column = ca.vertcat(*carried)
        residual += own[0] + column[:size]
        momentum += own[1] + column[size : 2 * size]
        diagonal += own[2] + ca.reshape(column[2 * size :], size, size).T
    stores = []
    outputs = ((rows.residual, residual), (rows.momentum, momentum), (rows.diagonal, diagonal))
    for row, value in (*outputs, (rows.upper, upper), (rows.lower, lower)):
        stores += list(zip(_range(row), ca.vertsplit(ca.vec(ca.densify(value).T)), strict=True))
    uniforms = (h, t, *(s for n, s in constants.items() if n not in varying))
    return Program("fused", uniforms, tuple(lanes), tuple(steps), tuple(stores), rows.count)


def _node(density, layout, ends, tangents, named, h, t):  # type: ignore[no-untyped-def]
    """Inertia and loads of a node: residual, momentum, tangent."""
    z, slope = symbols("z", layout.rows), symbols("dz", layout.rows)
    place = {"t": wrap(t), str(density.lagrangian.interval): wrap(named.get("here", ca.SX(0)))}
    point = embedded_point(layout, z, slope, "t") | place
    value = density.value("inertia", point) - density.value("load", point)
    unknown = ca.vertcat(to_sx(z), to_sx(slope))
    gradient = ca.gradient(value, unknown)
    hessian = ca.jacobian(gradient, unknown)
    q0, q1 = (to_sx(q) for q in ends)
    at = ca.vertcat(0.5 * (q0 + q1), (q1 - q0) / h)
    gradient, hessian = ca.substitute([gradient, hessian], [unknown], [at])
    r, w = layout.rows, named["weight"]
    g1, g2 = 0.5 * h * gradient[:r], gradient[r:]
    blocks = 0.25 * h * hessian[:r, :r] + 0.5 * (hessian[:r, r:] - hessian[r:, :r]) - hessian[r:, r:] / h
    residual, momentum = tangents[0].T @ (g1 - g2), tangents[1].T @ (g1 + g2)
    return w * residual, w * momentum, w * (tangents[0].T @ blocks @ tangents[1])


def _element(density, layout, points, ends, other, named, h, t):  # type: ignore[no-untyped-def]
    """Strain of an element: residual, momentum, tangent of its left node; upper, lower; what its right node gets."""
    along = str(density.lagrangian.interval)
    left, right = symbols("zl", layout.rows), symbols("zr", layout.rows)
    inverse, here, length = wrap(named["inverse"]), wrap(named["here"]), named["length"]
    if points.between_ends:
        place = {"inverse": inverse, "t": wrap(t), "left": here, "right": here + 1.0 / inverse}
        value = element_energy(density, points, layout, (normalized(layout, left), normalized(layout, right)), place)
    else:
        point = embedded_point(layout, wrap(0.5 * (left + right)), wrap((right - left) * inverse), along)
        value = density.value("strain", point | {along: here + 0.5 / inverse, "t": wrap(t)})
    unknown = ca.vertcat(to_sx(left), to_sx(right))
    gradient = ca.gradient(value, unknown)
    hessian = ca.jacobian(gradient, unknown)
    at = ca.vertcat(*[0.5 * (to_sx(q[0]) + to_sx(q[1])) for q in (ends, other)])
    gradient, hessian = ca.substitute([gradient, hessian], [unknown], [at])
    r, scale = layout.rows, -h * length
    old = [tangent(layout, q[0]) for q in (ends, other)]
    new = [tangent(layout, q[1]) for q in (ends, other)]
    parts = [gradient[:r], gradient[r:]]
    residual = [0.5 * scale * (old[k].T @ parts[k]) for k in range(2)]
    momentum = [0.5 * scale * (new[k].T @ parts[k]) for k in range(2)]
    blocks = [
        [0.25 * scale * (old[i].T @ hessian[i * r : (i + 1) * r, k * r : (k + 1) * r] @ new[k]) for k in range(2)]
        for i in range(2)
    ]

    def there(matrix: ca.SX) -> ca.SX:
        """Zero behind the last node of a chain."""
        entries = [
            e if e.is_zero() else ca.if_else(length != 0, e, 0) for e in ca.vertsplit(ca.vec(ca.densify(matrix)))
        ]
        return ca.reshape(ca.vertcat(*entries), *matrix.shape)

    own = [there(residual[0]), there(momentum[0]), there(blocks[0][0])]
    handed = ca.vertcat(there(residual[1]), there(momentum[1]), ca.vec(there(blocks[1][1]).T))
    return own, there(blocks[0][1]), there(blocks[1][0]), ca.vertsplit(handed)


def _list(value: Expression) -> list[ca.SX]:
    return ca.vertsplit(to_sx(value))


def _range(rows: slice) -> list[int]:
    return list(range(rows.start, rows.stop))
