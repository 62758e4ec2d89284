"""Non-conservative forces at one point, pulled back to whatever unknowns its values depend on (Lagrange-d'Alembert).

With slots s(u) of unknowns u and a rotation's own variation η, δp = ½ p η,

    δW = Σ f·δs = (Σ (∂s/∂u)ᵀ f)·δu,   ds/dt = ∂s/∂u u̇,   power = Σ f·ds/dt.
"""

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, from_sx, symbols, to_sx, wrap, zeros
from cayley.density.force import KINDS, MOVING, NODE, SPREAD, STILL, STRAIN
from cayley.discrete.element import element_points
from cayley.discrete.embedded import embedded_point, inputs_by_name, normalized
from cayley.discrete.layout import Layout
from cayley.discrete.node import node_point, tangent
from cayley.discrete.places import constants_at
from cayley.discrete.polynomial import polynomial_points
from cayley.discrete.program import Program
from cayley.discrete.rules import Points

TINY = 1e-12
"""Rate at which Jacobians are taken instead of 0: the length of a velocity, as in drag, has no derivative at rest."""
Weighted = Sequence[tuple[float, Mapping[str, Any]]]


def pulled_forces(
    density: Density, place: str, kind: str, points: Weighted, unknown: ca.SX, moving: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """Forces conjugate to unknowns, and their power.

    Args:
        density: the density, with a force.
        place: "node", "strain" or "spread".
        kind: "still" or "moving".
        points: (weight, values of the slots as expressions of the unknowns) pairs.
        unknown: the unknowns u, a column of symbols.
        moving: their rates u̇, a column.

    Returns: Σ weight (∂s/∂u)ᵀ f, a column as long as unknown, and Σ weight f·ds/dt.
    """
    force, power = ca.SX.zeros(unknown.shape), ca.SX(0)
    for weight, point in points:
        motion = motion_of(density, point, unknown, moving)
        found = density.forces(place, kind, dict(point) | motion)
        for name, f in found.items():
            column = to_sx(f)
            power += weight * ca.dot(column, to_sx(_rate_of(density, name, motion)))
            force += weight * _pulled(density, name, column, point, unknown)
    return force, power


def motion_of(density: Density, point: Mapping[str, Any], unknown: ca.SX, moving: ca.SX) -> dict[str, Any]:
    """Velocities of the fields and rates of their slopes at a point, from the rates of the unknowns (pulled_forces)."""
    motion: dict[str, Any] = {}
    along = density.lagrangian.interval
    for name in density.lagrangian.fields:
        if name in density.frames:
            turned = _turned(point, name)
            motion[f"{name}_t"] = _column(_turn(turned, ca.jtimes(turned, unknown, moving)))
        else:
            motion[f"{name}_t"] = _column(ca.jtimes(to_sx(point[name]), unknown, moving))
        slope = f"{name}_{along}"
        if along is not None and slope in point:
            motion[f"rate of {slope}"] = _column(ca.jtimes(to_sx(point[slope]), unknown, moving))
    return motion


def _rate_of(density: Density, slot: str, motion: Mapping[str, Any]) -> Any:
    return motion[f"{slot}_t"] if slot in density.lagrangian.fields else motion[f"rate of {slot}"]


def _pulled(density: Density, slot: str, f: ca.SX, point: Mapping[str, Any], unknown: ca.SX) -> ca.SX:
    """(∂slot/∂u)ᵀ f by one reverse sweep."""
    if slot in density.frames:
        turned = _turned(point, slot)
        change = ca.SX.sym("change", turned.numel())
        f = ca.jacobian(_turn(turned, change), change).T @ f
        return ca.jtimes(turned, unknown, f, True)
    return ca.jtimes(to_sx(point[slot]), unknown, f, True)


def _turned(point: Mapping[str, Any], name: str) -> ca.SX:
    """What turns with a rotation: a quaternion of any length where there is one, else the frame, as a column."""
    if f"quaternion of {name}" in point:
        return to_sx(point[f"quaternion of {name}"])
    return ca.vec(to_sx(np.asarray(point[f"frame of {name}"], dtype=object)))


def _turn(fixed: ca.SX, change: ca.SX) -> ca.SX:
    """η of a change of what turns: 2 Im(z̄ δz)/‖z‖² of a quaternion, the vector of skew Λᵀ δΛ of a frame."""
    if fixed.numel() == 4:
        w, v, dw, dv = fixed[0], fixed[1:], change[0], change[1:]
        return (2.0 / ca.dot(fixed, fixed)) * (w * dv - dw * v - ca.cross(v, dv))
    product = ca.reshape(fixed, 3, 3).T @ ca.reshape(change, 3, 3)
    return 0.5 * ca.vertcat(product[2, 1] - product[1, 2], product[0, 2] - product[2, 0], product[1, 0] - product[0, 1])


def _with_quaternions(layout: Layout, points: Any, ends: list[Expression] | None, z: Expression | None = None) -> Any:
    """Points of an element between two nodes, or in the embedding space, with the quaternions that turn there."""
    if layout.representation.rows != 4 or (ends is not None and len(ends) > 2):
        return points
    made = []
    for k, (weight, point) in enumerate(points):
        own = dict(point)
        for name in layout.rotations:
            rows = layout.rows_of(name)
            if z is not None:
                own[f"quaternion of {name}"] = z[rows]
            elif ends is not None:
                own[f"quaternion of {name}"] = ends[k][rows] if len(points) > 1 else wrap(ends[0][rows] + ends[1][rows])
        made.append((weight, own))
    return made


def node_forcing(
    density: Density, layout: Layout, node: Expression, rate: Expression, place: Mapping[str, Any], kind: str
) -> Expression:
    """Forces without slopes on a node per unit of its weight, left-trivialized, shape (dofs,).

    Args:
        density: the density, with or without a force.
        layout: rows of a node.
        node: its values, shape (rows,).
        rate: its velocities, shape (dofs,).
        place: "t", and the coordinate "here".
        kind: "still" or "moving".
    """
    point = node_point(layout, node, density.lagrangian.interval, place)
    point |= {f"{name}_t": rate[layout.dofs_of(name)] for name in layout.fields}
    found = density.forces(NODE, kind, point)
    return wrap(np.concatenate([found.get(name, zeros(field.size)) for name, field in layout.fields.items()]))


def element_forcing(
    density: Density,
    points: Points,
    layout: Layout,
    ends: list[Expression],
    rates: list[Expression],
    place: Mapping[str, Any],
    kind: str,
    *,
    where: tuple[str, ...] = (STRAIN, SPREAD),
) -> list[Expression]:
    """Forces with slopes on the nodes of an element per unit of its length, left-trivialized, shape (dofs,) each.

    Args:
        density: the density, with a force.
        points: where the strain terms stand.
        layout: rows of a node.
        ends: values at the nodes, m + 1 of shape (rows,).
        rates: their velocities, m + 1 of shape (dofs,).
        place: "inverse" 1/ds, "t", and the coordinates "left" and "right".
        kind: "still" or "moving".
        where: STRAIN for those whose quantity has slopes: stresses; SPREAD for the others.
    """
    if len(ends) > 2:
        found: Weighted = polynomial_points(density, points, layout, ends, place)
    else:
        found = _with_quaternions(layout, element_points(density, points, layout, (ends[0], ends[1]), place), ends)
    tangents = [tangent(layout, end) for end in ends]
    unknown = ca.vertcat(*[to_sx(end) for end in ends])
    moving = ca.vertcat(*[t @ to_sx(v) for t, v in zip(tangents, rates, strict=True)])
    pulled = ca.SX.zeros(unknown.shape)
    for place_of in where:
        pulled += pulled_forces(density, place_of, kind, found, unknown, moving)[0]
    r = layout.rows
    return [_column(t.T @ pulled[k * r : (k + 1) * r]) for k, t in enumerate(tangents)]


def force_program(
    density: Density, layout: Layout, name: str, points: Points | None, varying: tuple[str, ...]
) -> Program:
    """Non-conservative forces at one quadrature point in the embedding space (see discrete.embedded): implicit rules.

    name "force_point": forces with slopes in them, at a strain point, of unknowns u = (z, z′), or of the two end nodes
    u = (z_a, z_b) where the rule takes corners or screws. Rows

        (z, z′, ż, ż′ (R each), here, inverse, varying ...) -> (f (2R), work, loss, Jacobian 2R × 4R row by row).

    name "node_force_point": those without slopes, at an inertia point, u = z. Rows

        (z, ż (R each), here, inverse, varying ...) -> (f (R), work, loss, Jacobian R × 2R row by row).

    f is conjugate to u: δW = f·δu, contracted like the gradient of −W. work is the power of forces that do not depend
    on velocities, loss minus the power of those that do; work − loss = f·u̇. The Jacobian is that of f along (u, u̇).
    Either name with "_force" at its end gives f, work and loss only. The length of a quaternion does not matter.

    Args:
        density: the density, with a force.
        layout: rows of a node, rotations as quaternions.
        name: which forces.
        points: where the strain terms stand.
        varying: names of constants that differ from point to point (see embedded.point_program).
    """
    at_node, light = name.startswith("node_"), name.endswith("_force")
    along = str(density.lagrangian.interval)
    here, inverse, t = (ca.SX.sym(n) for n in ("here", "inverse", "t"))
    parts = [symbols(n, layout.rows) for n in (("z",) if at_node else ("z", "dz"))]
    rates = [symbols(f"{n}_t", layout.rows) for n in (("z",) if at_node else ("z", "dz"))]
    place = {"t": wrap(t), along: wrap(here)}
    constants = inputs_by_name(density, varying)
    if at_node:
        found: Weighted = [(1.0, embedded_point(layout, parts[0], symbols("unused", layout.rows), "t") | place)]
    elif points is not None and points.between_ends:
        ends = {"inverse": wrap(inverse), "t": wrap(t), "left": wrap(here), "right": wrap(here + 1.0 / inverse)}
        ends["at points"] = [constants_at(constants, k) for k in range(len(points.at))]
        both = normalized(layout, parts[0]), normalized(layout, parts[1])
        found = _with_quaternions(layout, element_points(density, points, layout, both, ends), list(both))
    else:
        found = [(1.0, embedded_point(layout, parts[0], parts[1], along) | place)]
    if at_node or points is None or not points.between_ends:
        found = _with_quaternions(layout, found, None, parts[0])
    unknown, moving = (ca.vertcat(*[to_sx(v) for v in values]) for values in (parts, rates))
    f, powers = ca.SX.zeros(unknown.shape), dict.fromkeys(KINDS, ca.SX(0))
    for where, kind in itertools.product((NODE,) if at_node else (STRAIN, SPREAD), KINDS):
        force, power = pulled_forces(density, where, kind, found, unknown, moving)
        f, powers[kind] = f + force, powers[kind] + power
    outputs = [*ca.vertsplit(ca.densify(f)), powers[STILL], -powers[MOVING]]
    if not light:
        jacobian = ca.densify(ca.jacobian(f, ca.vertcat(unknown, moving)))
        shifted = moving + TINY * ca.DM(1.0 + np.arange(moving.numel()) / 7.0)  # in no direction of anyone's
        outputs += ca.vertsplit(ca.vec(ca.substitute([jacobian], [moving], [shifted])[0].T))
    inputs = [*ca.vertsplit(unknown), *ca.vertsplit(moving), here, inverse, *(constants[n] for n in varying)]
    return Program(
        name=name,
        uniforms=(t, *(constants[n] for n in density.names if n not in varying)),
        lanes=tuple((s, i, 0) for i, s in enumerate(inputs)),
        steps=(),
        stores=tuple((len(inputs) + i, v) for i, v in enumerate(outputs)),
        rows=len(inputs) + len(outputs),
    )


def _column(value: ca.SX) -> Expression:
    return wrap(np.atleast_1d(from_sx(ca.densify(value))))


__all__ = ["element_forcing", "force_program", "motion_of", "node_forcing", "pulled_forces"]
