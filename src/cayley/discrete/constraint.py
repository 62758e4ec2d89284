"""Constraints g(q) = 0 at the strain points of elements: their programs for rules with corners in time.

With ι the impulses of the multipliers of a step (h ds λ), G the left-trivialized derivative of g and M the mass matrix,

    P + h F(qʲ) − Gᵀ(qʲ) ι = −D₀ T_d(qʲ, qʲ⁺¹),   g(qʲ⁺¹) = 0   ->   qʲ⁺¹, ι          (SHAKE)
    G M⁻¹ (μ − Gᵀ ν) = 0   ->   ν                                                     (RATTLE, at saved frames)

Source: Ryckaert, Ciccotti, Berendsen (1977); Andersen (1983); Hairer, Lubich, Wanner (2006), section VII.1.4.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, symbols, to_sx, wrap
from cayley.discrete.element import element_points
from cayley.discrete.layout import Layout
from cayley.discrete.node import mass_matrix, node_point, tangent
from cayley.discrete.program import Assign, Carry, Program, Step
from cayley.discrete.rules import Points
from cayley.discrete.solve import Inverse, find_structure, solve_steps


def element_constraints(
    density: Density, points: Points, layout: Layout, ends: tuple[Expression, Expression], place: Mapping[str, Any]
) -> ca.SX:
    """The constraints g of an element at its strain points, a column (see element_points)."""
    found = element_points(density, points, layout, ends, place)
    return ca.vertcat(*[density.constraint(point) for _, point in found])


def constrained_rows(rows: Any, layout: Layout, count: int) -> Any:
    """Rows of a node and more of them for the programs here, where there are constraints.

    next, after: values and momenta at j + 1; multiplier: ι; violation: g at j + 1; left, right: G of the element to the
    right of the node; diagonal, coupling: blocks of G M⁻¹ Gᵀ, the latter between the elements left and right of the
    node; rate: G M⁻¹ μ; handed, before: carried between nodes.
    """
    if not count:
        return rows
    d = layout.dofs
    sizes = {"next": layout.rows, "after": d, "multiplier": count, "violation": count, "left": count * d}
    sizes |= {"right": count * d, "diagonal": count**2, "coupling": count**2, "rate": count}
    sizes |= {"handed": d, "before": count * d}
    edges = np.cumsum([rows.count, *sizes.values()]).tolist()
    found = {name: slice(edges[i], edges[i + 1]) for i, name in enumerate(sizes)}
    return replace(rows, count=edges[-1], constraint=found)


def constrained_program(writer: Any, name: str) -> Program:
    """The program "drift", "violation", "schur" or "rate", or one of them with "_held" for supports."""
    kind, held = name.removesuffix("_held"), name.endswith("_held")
    return {"drift": _drift, "violation": _violation, "schur": _schur, "rate": _rate}[kind](writer, name, held)


def _drift(w: Any, name: str, held: bool) -> Program:
    """From P + h F and ι to qʲ⁺¹ and the momentum after the inertia of the step."""
    count, dofs, rows = w.density.constraints.numel(), w.layout.dofs, w.rows
    left, right = symbols("left", count, dofs), symbols("right", count, dofs)
    impulse, handed, carried = symbols("iota", count), symbols("handed", dofs), symbols("carried", dofs)
    given, pushed = symbols("given", dofs), symbols("pushed", dofs)
    weight, inverse = wrap(w.symbol["weight"]), wrap(w.symbol["1/weight"])
    total = w.momenta[0] - left.T @ impulse - carried
    steps: list[Step] = [
        Assign(tuple(_list(handed)), tuple(_list(wrap(right.T @ impulse)))),
        Carry(tuple(_list(carried)), tuple(_list(handed)), tuple(_range(rows.constraint["handed"]))),
        Assign(tuple(_list(given)), tuple(_list(total))),
        Assign(tuple(_list(pushed)), tuple(_list(given * inverse))),
    ]
    residual, column, inertia = w._residual(0, pushed)
    blocks = find_structure(residual, column)
    momentum = given + inertia.total * weight
    if held:
        free = to_sx(w.free[0])
        residual = free * residual + (1.0 - free) * column
        momentum = w.free[0] * momentum
    steps += solve_steps(residual, column, blocks)
    stores = [*_stores(rows, "next", inertia.after), *_stores(rows, "after", momentum)]
    more = _lanes(rows, left=left, right=right, multiplier=impulse)
    return w._program(name, steps, stores, more)


def _violation(w: Any, name: str, held: bool) -> Program:
    """G at j + 1, zero where there is no element."""
    a, b = symbols("a", w.layout.rows), symbols("b", w.layout.rows)
    g = element_constraints(w.density, w.rule.strain, w.layout, (a, b), w._place())
    stores = _stores(w.rows, "violation", _there(w, g))
    more = [*_lanes(w.rows, next=a), *_lanes(w.rows, 1, next=b)]
    return w._program(name, [], stores, more)


def _schur(w: Any, name: str, held: bool) -> Program:
    """G and the blocks of G M⁻¹ Gᵀ at the values of the nodes."""
    count, dofs = w.density.constraints.numel(), w.layout.dofs
    g = element_constraints(w.density, w.rule.strain, w.layout, (w.nodes[0], w.next), w._place())
    left, right = (_there(w, ca.jacobian(g, to_sx(end)) @ tangent(w.layout, end)) for end in (w.nodes[0], w.next))
    (here, there), more = _inverse_masses(w, held)
    names = [symbols(n, count, dofs) for n in ("left", "right", "before")]
    own, other, before = (to_sx(n) for n in names)
    flat = [ca.vertsplit(ca.vec(m.T)) for m in (own, other, before)]
    steps: list[Step] = [
        Assign(tuple(flat[0]), tuple(ca.vertsplit(ca.vec(left.T)))),
        Assign(tuple(flat[1]), tuple(ca.vertsplit(ca.vec(right.T)))),
        Carry(tuple(flat[2]), tuple(flat[1]), tuple(_range(w.rows.constraint["before"]))),
    ]
    diagonal = own @ here @ own.T + other @ there @ other.T
    outputs = {"left": own, "right": other, "diagonal": diagonal, "coupling": before @ here @ own.T}
    stores = [pair for n, value in outputs.items() for pair in _stores(w.rows, n, ca.vec(ca.densify(value).T))]
    return w._program(name, steps, stores, more)


def _rate(w: Any, name: str, held: bool) -> Program:
    """G M⁻¹ μ of every element, from the stored G."""
    count, dofs = w.density.constraints.numel(), w.layout.dofs
    left, right, momentum = symbols("left", count, dofs), symbols("right", count, dofs), symbols("mu_next", dofs)
    (here, there), more = _inverse_masses(w, held)
    rate = to_sx(left) @ here @ to_sx(w.momenta[0]) + to_sx(right) @ there @ to_sx(momentum)
    more += [*_lanes(w.rows, left=left, right=right)]
    more += [(s, i, 1) for s, i in zip(_list(momentum), _range(w.rows.momenta), strict=True)]
    return w._program(name, [], _stores(w.rows, "rate", rate), more)


def _inverse_masses(w: Any, held: bool) -> tuple[list[ca.SX], list[tuple[ca.SX, int, int]]]:
    """M⁻¹ of the node and of the next, of what is free, and what must be read for it."""
    place = w._place()
    free, weight = symbols("free_next", w.layout.dofs), ca.SX.sym("weight_next")
    more = [(s, i, 1) for s, i in zip(_list(free), _range(w.rows.held), strict=True)]
    more.append((weight, w.rows.named["weight"], 1))
    constants = [name for name in w.density.names if name in w.rows.named]
    ahead = {name: wrap(ca.SX.sym(f"{name} of the next")) for name in constants}
    more += [(to_sx(ahead[name]), w.rows.named[name], 1) for name in constants]
    found = []
    nodes = (
        (w.nodes[0], w.free[0], w.symbol["weight"], place),
        (w.next, free, weight, place | {"here": place.get("right", 0.0)} | ahead),
    )
    for node, mask, heavy, where in nodes:
        point = node_point(w.layout, node, w.density.lagrangian.interval, where)
        mass = mass_matrix(w.density, w.layout, point)
        if held:
            f = ca.diag(to_sx(mask))
            mass = f @ mass @ f + ca.diag(1.0 - to_sx(mask))
        inverse = Inverse(mass)
        columns = ca.horzcat(*[inverse(ca.SX(e)) for e in np.eye(w.layout.dofs)])
        found.append((f @ columns @ f if held else columns) / heavy)
    return found, more


def _there(w: Any, matrix: ca.SX) -> ca.SX:
    """Zero behind the last node of a chain."""
    length = w.symbol["length"]
    entries = [e if e.is_zero() else ca.if_else(length != 0, e, 0) for e in ca.vertsplit(ca.vec(ca.densify(matrix)))]
    return ca.reshape(ca.vertcat(*entries), *matrix.shape)


def _lanes(rows: Any, shift: int = 0, **named: Expression) -> list[tuple[ca.SX, int, int]]:
    pairs = [(_list(wrap(value.reshape(-1))), _range(rows.constraint[name])) for name, value in named.items()]
    return [(s, i, shift) for entries, where in pairs for s, i in zip(entries, where, strict=True)]


def _stores(rows: Any, name: str, value: Any) -> list[tuple[int, ca.SX]]:
    column = value if isinstance(value, ca.SX) else to_sx(value)
    return list(zip(_range(rows.constraint[name]), ca.vertsplit(ca.densify(column)), strict=True))


def _list(value: Expression) -> list[ca.SX]:
    return ca.vertsplit(to_sx(value))


def _range(rows: slice) -> list[int]:
    return list(range(rows.start, rows.stop))
