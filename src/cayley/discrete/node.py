"""Inertia and loads of one node over one step: the part of the discrete Lagrangian that knows nothing of neighbors."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, cross, dot, from_sx, to_sx, wrap, zeros
from cayley.discrete.layout import Layout
from cayley.discrete.places import constants_of


@dataclass(frozen=True, slots=True)
class Inertia:
    """Derivatives of the inertia part of the discrete Lagrangian of a node, per unit of its weight.

    Args:
        before: D₀ = ∂T_d/∂(node at j), left-trivialized, shape (dofs,).
        total: D₀ + ∂T_d/∂(node at j + 1); the momentum after the step is momentum before + this.
        scale: rows of the residual are multiplied by this (1 + f·f for rotations whose momentum is linear in ω).
        after: values of the node at j + 1, shape (rows,).
    """

    before: Expression
    total: Expression
    scale: Expression
    after: Expression


def corner_inertia(
    density: Density, layout: Layout, node: Expression, unknown: Expression, place: Mapping[str, Any]
) -> Inertia:
    """Inertia with values at both ends of the step and difference quotients between them.

    T_d = h/2 (T(qʲ, v) + T(qʲ⁺¹, v)),  v = (xʲ⁺¹ − xʲ)/h,  ω = (2/h) Im(p̄ʲ pʲ⁺¹),  pʲ⁺¹ = pʲ Cay f:

    D₀ = −c (G + f × G) + ..., D₁ = c (G − f × G) + ... with G = ∂T/∂ω and c = 1/√(1 + f·f).

    Args:
        density: the density.
        layout: rows of a node.
        node: its values at j.
        unknown: increments x⁺ − x and Cayley vectors f, shape (dofs,).
        place: "h", "t", "t_next", the coordinate "here", and constants that the node has of its own ("c.mass").

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 8; design of the unknown: section 5.1.
    """
    along = density.lagrangian.interval
    h = place["h"]
    after = node.copy()
    cosines: dict[str, Any] = {}
    velocity: dict[str, Any] = {}
    homogeneous = _homogeneous_rotations(density, layout)
    for name in layout.fields:
        u = unknown[layout.dofs_of(name)]
        rows = layout.rows_of(name)
        if name in layout.rotations:
            cosines[name] = np.sqrt(1.0 / (1.0 + dot(u, u)))
            after[rows] = layout.representation.compose(node[rows], u, cosines[name])
            velocity[f"{name}_t"] = (2.0 / h) * u * (1.0 if name in homogeneous else cosines[name])
        else:
            after[rows] = node[rows] + u
            velocity[f"{name}_t"] = u / h
    corners = [(node, place["t"]), (after, place["t_next"])]
    if not _depends_on_place(density, layout):
        corners = corners[:1]  # both corners give the same: evaluate once
    gradients = []
    for value, time in corners:
        point: dict[str, Any] = velocity | {"t": time, str(along): place.get("here", 0.0)} | constants_of(place)
        for name in layout.fields:
            rows = layout.rows_of(name)
            if name in layout.rotations:
                point[f"frame of {name}"] = layout.representation.matrix(value[rows])
            else:
                point[name] = value[rows]
        gradients.append(density.gradient("inertia", point))
    before, total, scale = (zeros(layout.dofs) for _ in range(3))
    for name in layout.fields:
        dofs = layout.dofs_of(name)
        u = unknown[dofs]
        momentum = sum((g[f"{name}_t"] for g in gradients), start=np.zeros(3 if name in layout.rotations else u.size))
        momentum = momentum * (1.0 / len(gradients))
        slopes = [0.5 * h * g[name] for g in gradients] if len(gradients) == 2 else [np.zeros(u.size)] * 2
        if name not in layout.rotations:
            scale[dofs] = 1.0
            before[dofs] = slopes[0] - momentum
            total[dofs] = slopes[0] + slopes[1]
            continue
        c = cosines[name]
        twist = cross(u, momentum)
        if name in homogeneous:  # here momentum is that of c = 1, and c² = 1/(1 + f·f) moves to the other side
            scale[dofs] = 1.0 + dot(u, u)
            before[dofs] = -momentum - twist
            total[dofs] = -(2.0 * c * c) * twist
        else:
            scale[dofs] = 1.0
            before[dofs] = slopes[0] - c * (momentum + twist)
            total[dofs] = slopes[0] + slopes[1] - 2.0 * c * twist
    return Inertia(wrap(before), wrap(total), wrap(scale), wrap(after))


def node_load(density: Density, layout: Layout, node: Expression, place: Mapping[str, Any]) -> Expression:
    """Force of the load terms on a node per unit of its weight, −D U, shape (dofs,)."""
    along = density.lagrangian.interval
    gradient = density.gradient("load", node_point(layout, node, along, place))
    return wrap(np.concatenate([np.atleast_1d(-gradient[name]) for name in layout.fields]))


def node_point(layout: Layout, node: Expression, along: str | None, place: Mapping[str, Any]) -> dict[str, Any]:
    """Values of the slots at a node at rest."""
    point: dict[str, Any] = {"t": place["t"], str(along): place.get("here", 0.0)} | constants_of(place)
    for name in layout.fields:
        rows = layout.rows_of(name)
        if name in layout.rotations:
            point[f"frame of {name}"] = layout.representation.matrix(node[rows])
        else:
            point[name] = node[rows]
    return point


def mass_matrix(density: Density, layout: Layout, point: Mapping[str, Any]) -> ca.SX:
    """∂²T/∂v² of a node per unit of its weight, shape (dofs, dofs)."""
    velocity = ca.vertcat(*[to_sx(density.slots[f"{name}_t"]) for name in layout.fields])
    free = dict(point) | {f"{name}_t": density.slots[f"{name}_t"] for name in layout.fields}
    gradient = density.gradient("inertia", free)
    momentum = ca.vertcat(*[to_sx(gradient[f"{name}_t"]) for name in layout.fields])
    return ca.substitute([ca.jacobian(momentum, velocity)], [velocity], [ca.SX.zeros(velocity.shape)])[0]


def tangent(layout: Layout, rows: Expression) -> ca.SX:
    """Derivative of a node's rows along its degrees of freedom, shape (rows, dofs)."""
    found = np.zeros((layout.rows, layout.dofs), dtype=object)
    for name in layout.fields:
        where = layout.rows_of(name), layout.dofs_of(name)
        turns = name in layout.rotations
        found[where] = layout.representation.tangent(rows[where[0]]) if turns else np.eye(layout.fields[name].size)
    return to_sx(wrap(found))


def _depends_on_place(density: Density, layout: Layout) -> bool:
    """Tell whether T depends on anything but velocities and the coordinate along the interval."""
    total = ca.vertcat(*[term for _, term in density.terms["inertia"]])
    values = [to_sx(density.slots[name]) for name in layout.fields]
    frames = [ca.vec(to_sx(f)) for f in density.frames.values()]
    return bool(ca.depends_on(total, ca.vertcat(*values, *frames, to_sx(density.places["t"]))))


def _homogeneous_rotations(density: Density, layout: Layout) -> frozenset[str]:
    """Rotations whose momentum ∂T/∂ω is linear in their own ω and depends on nothing else that moves."""
    if _depends_on_place(density, layout):
        return frozenset()
    gradient = density.gradient("inertia", {name: density.slots[name] for name in density.velocities})
    found = set()
    for name in layout.rotations:
        momentum, own = to_sx(gradient[f"{name}_t"]), to_sx(density.slots[f"{name}_t"])
        others = [to_sx(density.slots[n]) for n in density.velocities if n != f"{name}_t"]
        jacobian = ca.jacobian(momentum, own)
        at_rest = ca.substitute([momentum], [own], [ca.SX.zeros(3)])[0]
        alone = not others or not ca.depends_on(momentum, ca.vertcat(*others))
        if alone and at_rest.is_zero() and not ca.depends_on(jacobian, own):
            found.add(name)
    return frozenset(found)


__all__ = ["Inertia", "corner_inertia", "from_sx", "mass_matrix", "node_load", "node_point", "tangent"]
