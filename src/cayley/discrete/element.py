"""The strain terms of one element between two nodes: kinematics, energy and forces."""

from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, cross, dot, from_sx, to_sx, wrap, zeros
from cayley.discrete.layout import Layout
from cayley.discrete.pose import screw_forces, strains_only
from cayley.discrete.rules import Points
from cayley.lie import series

Point = dict[str, Any]


def element_points(
    density: Density, points: Points, layout: Layout, ends: tuple[Expression, Expression], place: Mapping[str, Any]
) -> list[tuple[float, Point]]:
    """Values of every slot at the quadrature points of an element.

    Corners: x′ = (x_b − x_a)/ds, Ω = (2/ds) Im(p̄ₐ p_b), values of either node.
    Screw:   Ω = log(p̄ₐ p_b)/ds, Γ + e₃ = V(Ω ds)⁻¹ Λₐᵀ(x_b − xₐ)/ds, V the integral of the turning along the element.
    Middle:  the same x′, Ω = (4/ds) Im(p̄ₐ p_b)/(1 + Re(p̄ₐ p_b)), p = (pₐ + p_b)/‖pₐ + p_b‖, x = (xₐ + x_b)/2.

    Args:
        density: what is evaluated.
        points: corners, middle or screw.
        layout: rows of a node.
        ends: values at the two nodes, shape (layout.rows,) each.
        place: "inverse" 1/ds, "t", the coordinates "left", "right" of the nodes, and "at points", if given the
            constants that each point has of its own.

    Returns: (weight, point) pairs.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 7 and 8; screw: Hante, Tumiotto, Arnold (2022).
    """
    if points.screw:
        return [(1.0, _screw_point(density, layout, ends, place))]
    along = density.lagrangian.interval
    shared: Point = {"t": place["t"]}
    values: list[Point] = [{}, {}] if points.corners else [{}]
    coordinates = (place["left"], place["right"])
    for k, value in enumerate(values):
        value[str(along)] = coordinates[k] if points.corners else 0.5 * (coordinates[0] + coordinates[1])
    for name in layout.fields:
        a, b = (end[layout.rows_of(name)] for end in ends)
        if name in layout.rotations:
            r0, v = layout.representation.relative(a, b)
            if points.corners:
                shared[f"{name}_{along}"] = 2.0 * place["inverse"] * v
                for value, rows in zip(values, (a, b), strict=True):
                    value[f"frame of {name}"] = layout.representation.matrix(rows)
            else:
                half = v * (1.0 / (1.0 + r0))
                shared[f"{name}_{along}"] = 4.0 * place["inverse"] * half
                shared[f"half turn of {name}"] = half
                values[0][f"frame of {name}"] = layout.representation.middle(a, b, r0, half)
        else:
            shared[f"{name}_{along}"] = (b - a) * place["inverse"]
            for value, x in zip(values, (a, b) if points.corners else (0.5 * (a + b),), strict=True):
                value[name] = x
    own = place.get("at points", [{}] * len(values))
    return [(w, shared | value | more) for w, value, more in zip(points.weights, values, own, strict=True)]


def element_energy(
    density: Density, points: Points, layout: Layout, ends: tuple[Expression, Expression], place: Mapping[str, Any]
) -> ca.SX:
    """Strain energy of an element per unit of its length, Σ weight W [J/m]."""
    found = element_points(density, points, layout, ends, place)
    return sum((weight * density.value("strain", point) for weight, point in found), start=ca.SX(0))


def element_forces(
    density: Density, points: Points, layout: Layout, ends: tuple[Expression, Expression], place: Mapping[str, Any]
) -> tuple[Expression, Expression]:
    """Forces on the two nodes of an element per unit of its length.

    f = −D (Σ weight W), left-trivialized: the gradient at each point, brought back to the nodes by the transposed
    derivative of the kinematics (element_points).

    Returns: forces on the left and the right node, shape (layout.dofs,) each.
    """
    if points.screw:
        return _screw_forces(density, points, layout, ends, place)
    found = element_points(density, points, layout, ends, place)
    left, right = (zeros(layout.dofs) for _ in range(2))
    along = density.lagrangian.interval
    quotients = {name: np.zeros(kind.size) for name, kind in layout.fields.items()}
    constant = density.gradient("strain", found[0][1], only="quotients")  # the same at all points
    for name in layout.fields:
        quotients[name] = constant[f"{name}_{along}"]
    for k, (weight, point) in enumerate(found):
        gradient = density.gradient("strain", point, only="values")
        for name in layout.fields:
            dofs = layout.dofs_of(name)
            quotients[name] = quotients[name] + weight * gradient[f"{name}_{along}"]
            pulled = weight * gradient[name]
            if points.corners:
                (left, right)[k][dofs] -= pulled
                continue
            turn = cross(pulled, point[f"half turn of {name}"]) if name in layout.rotations else 0.0
            left[dofs] -= 0.5 * (pulled - turn)
            right[dofs] -= 0.5 * (pulled + turn)
    for name in layout.fields:
        dofs = layout.dofs_of(name)
        g = quotients[name] * place["inverse"]
        if name not in layout.rotations:
            left[dofs] += g
            right[dofs] -= g
            continue
        even, odd = _pull_curvature(points, layout, name, ends, g)
        left[dofs] += even - odd
        right[dofs] -= even + odd
    return left, right


def _pull_curvature(
    points: Points, layout: Layout, name: str, ends: tuple[Expression, Expression], g: Expression
) -> tuple[Expression, Expression]:
    """Transposed derivative of Ω ds: δ(Ω ds)·g = even·(η_b − η_a) + odd·(η_a + η_b)."""
    a, b = (end[layout.rows_of(name)] for end in ends)
    r0, v = layout.representation.relative(a, b)
    if points.corners:  # δ(2v) = r₀ (η_b − η_a) + v × (η_a + η_b)
        return wrap(r0 * g), cross(g, v)
    half = v * (1.0 / (1.0 + r0))  # δ(4γ) = (1 − γ·γ + 2 γ γᵀ)(η_b − η_a) + 2 γ × (η_a + η_b)
    return wrap((1.0 - dot(half, half)) * g + 2.0 * dot(half, g) * half), cross(2.0 * g, half)


def _screw_point(
    density: Density, layout: Layout, ends: tuple[Expression, Expression], place: Mapping[str, Any]
) -> Point:
    """The constant strain of the screw motion from one pose to the other, seen from the left end.

    With γ = v/(1 + r₀) = tan(θ/4) n, y = Λₐᵀ(x_b − xₐ), A = arctan(‖γ‖)/‖γ‖ = 1 − g B and g = γ·γ:

    θ = log(p̄ₐ p_b) = 4 A γ,  Ω = θ/ds,  Γ + e₃ = (y − ½ θ × y + c θ × (θ × y))/ds,  c = (1 + B − g B)/(16 A²)
    """
    along = str(density.lagrangian.interval)
    turn, position = density.lagrangian.pose or ("", "")
    point: Point = {"t": place["t"], along: 0.5 * (place["left"] + place["right"])}
    for name in layout.fields:
        if name in (turn, position):
            continue
        if name in layout.rotations:
            raise ValueError(f"the screw rules take one rotation, that of the pose; {name} is another")
        a, b = (end[layout.rows_of(name)] for end in ends)
        point[name], point[f"{name}_{along}"] = 0.5 * (a + b), (b - a) * place["inverse"]
    p, q = (end[layout.rows_of(turn)] for end in ends)
    a, b = (end[layout.rows_of(position)] for end in ends)
    representation = layout.representation
    r0, v = representation.relative(p, q)
    half = v * (1.0 / (1.0 + r0))
    g = dot(half, half)
    defect = wrap(series.arctan_defect(np.asarray(g).reshape(1)))[0]
    ratio = 1.0 - g * defect
    theta = (4.0 * ratio) * half
    chord = representation.matrix(p).T @ ((b - a) * place["inverse"])
    once = cross(theta, chord)
    straight = chord - 0.5 * once + ((1.0 + defect - g * defect) / (16.0 * ratio * ratio)) * cross(theta, once)
    middle = representation.middle(p, q, r0, half)
    point[f"frame of {turn}"], point[f"{turn}_{along}"] = middle, theta * place["inverse"]
    point[position], point[f"{position}_{along}"] = 0.5 * (a + b), middle @ straight
    return point


def _screw_forces(
    density: Density, points: Points, layout: Layout, ends: tuple[Expression, Expression], place: Mapping[str, Any]
) -> tuple[Expression, Expression]:
    """By way of the relative pose where W depends on nothing else, or else as −Tᵀ∂W/∂(rows)."""

    def strain(point: Mapping[str, Any]) -> ca.SX:
        return density.value("strain", point)

    if strains_only(density, "strain"):
        middle = {str(density.lagrangian.interval): 0.5 * (place["left"] + place["right"])}
        return screw_forces(density, layout, strain, ends, middle | {k: place[k] for k in ("inverse", "t")})
    energy = element_energy(density, points, layout, ends, place)
    forces = []
    for end in ends:
        gradient = wrap(np.atleast_1d(from_sx(ca.densify(ca.gradient(energy, to_sx(end))))))
        pulled = zeros(layout.dofs)
        for name in layout.fields:
            rows = layout.rows_of(name)
            turns = name in layout.rotations
            own = layout.representation.tangent(end[rows]).T @ gradient[rows] if turns else gradient[rows]
            pulled[layout.dofs_of(name)] = -wrap(own)
        forces.append(pulled)
    return forces[0], forces[1]
