"""Derivatives of the strain of a screw motion, through the relative pose of an element's ends.

The strain sees two nodes (p, a) and (q, b) only through γ = Im r/(1 + Re r), r the direction of p̄ q, and
y = Λ(p)ᵀ(b − a)/ds: six numbers. Between them and the embedding space stand the increments φ of rotations in space,
p + δp ∥ (1 + φ) p, and the turn λ between the ends that they make.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, cross, dot, from_sx, symbols, to_sx, wrap, zeros
from cayley.discrete.jet import Jet, jet
from cayley.discrete.layout import Layout
from cayley.discrete.representation import homogeneous
from cayley.lie import quaternion, series

DRAWS = 4
"""Random points at which a density is asked whether it depends on the strains alone."""
AXES = (np.eye(3)[[2, 0, 1]], np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
"""Turns of the axes into one another, by a third about their diagonal and a quarter about e₃."""


def strains_only(density: Density, part: str) -> bool:
    """Whether W, or the constraints, depend on pose and slopes only through Λᵀx′ and Ω, and there are no other fields.

    Asked is f(Λ, x, Λ c, Ω) = f(I, 0, c, Ω): of the expressions themselves for turns of the axes into one another,
    which leave no rounding behind which something small could hide, and in numbers for turns of any kind.

    Args:
        density: the density.
        part: "strain" or "constraint".
    """
    turn, position = density.lagrangian.pose or ("", "")
    if set(density.lagrangian.fields) != {turn, position}:
        return False
    tangent, along = f"{position}_{density.lagrangian.interval}", str(density.lagrangian.interval)
    seen, x = symbols("c", 3), symbols("x", 3)
    shared = {f"{turn}_{along}": symbols("w", 3), along: symbols("s"), "t": symbols("t")}

    def at(frame: Any, place: Any) -> ca.SX:
        point = shared | {f"frame of {turn}": frame, position: place, tangent: wrap(frame @ seen)}
        return density.constraint(point) if part == "constraint" else density.value(part, point)

    alone = at(np.eye(3), np.zeros(3))
    if any(str(at(frame, x)) != str(alone) for frame in AXES):
        return False
    frame = symbols("f", 3, 3)
    free = [to_sx(frame), _column(*shared.values(), seen, x), density.parameters]
    function = ca.Function("both", free, [at(frame, x), alone])
    rng = np.random.default_rng(0)
    for _ in range(DRAWS):
        turned = quaternion.to_matrix(quaternion.normalize(rng.normal(size=4)))
        numbers = rng.normal(size=free[1].numel()), rng.uniform(0.5, 2.0, size=density.parameters.numel())
        one, other = (np.array(v) for v in function(turned, *numbers))
        if not np.allclose(one, other, rtol=1e-9, atol=1e-12):
            return False
    return True


def strain_jet(
    density: Density,
    term: Callable[[dict[str, Expression]], ca.SX],
    points: Sequence[tuple[float, Mapping[str, Any]]],
    unknown: ca.SX,
    *,
    weights: ca.SX,
    second: bool,
) -> Jet:
    """Σ weight f(Ω, Λᵀx′) at some points, and its derivatives by way of those six numbers at each.

    Args:
        density: the density.
        term: from the values of the slots to the term, which depends on strains alone (see strains_only).
        points: (weight, values of the slots) pairs.
        unknown: what the points are functions of.
        weights: λ of the Hessian of λ·term.
        second: whether that Hessian is wanted.
    """
    turn, position = density.lagrangian.pose or ("", "")
    bend, tangent = f"{turn}_{density.lagrangian.interval}", f"{position}_{density.lagrangian.interval}"
    strains = symbols("strain", len(points), 6)
    value, inner = ca.SX(0), []
    for strain, (weight, point) in zip(strains, points, strict=True):
        others = {k: v for k, v in point.items() if k not in (turn, position, f"frame of {turn}")}
        value += weight * term(others | {bend: strain[:3], tangent: strain[3:]})
        inner += [point[bend], point[f"frame of {turn}"].T @ point[tangent]]
    found = jet(value, _column(*strains), _column(*inner), weights=weights, second=second)
    return found.through(_column(*inner), unknown, unknown)


def screw_jet(
    density: Density,
    layout: Layout,
    term: Callable[[dict[str, Expression]], ca.SX],
    ends: tuple[Expression, Expression],
    place: Mapping[str, Any],
    *,
    weights: ca.SX,
    second: bool,
) -> Jet:
    """A term of an element (see element._screw_point) and its derivatives along both ends.

    θ = 4 A γ,  Ω = θ/ds,  Γ + e₃ = y − 2 A γ × y + C γ × (γ × y),   A = 1 − g B,  C = 1 + (1 − g) B,  g = γ·γ

    Args:
        density: the density.
        layout: rows of a node, rotations as quaternions.
        term: from the values of the slots to the term, which depends on strains alone (see strains_only).
        ends: rows of the two nodes, quaternions of any length.
        place: "inverse" 1/ds, and the other slots of the term, "t" and the coordinate.
        weights: λ of the Hessian of λ·term.
        second: whether that Hessian is wanted.
    """
    turn, position = density.lagrangian.pose or ("", "")
    inverse = place["inverse"]
    p, q = (end[layout.rows_of(turn)] for end in ends)
    d = ends[1][layout.rows_of(position)] - ends[0][layout.rows_of(position)]
    size = dot(p, p)
    relative = wrap(np.asarray(quaternion.multiply(quaternion.conjugate(p), q))) / np.sqrt(size * dot(q, q))
    frame = homogeneous(p, 2.0 / size)
    half = relative[1:] * (1.0 / (1.0 + relative[0]))
    y = (frame.T @ d) * inverse

    found = _of_relative_pose(_of_strain(density, term, place), half, y, inverse, weights=weights, second=second)
    turned, shifted = symbols("turned", 3), symbols("shifted", 3)
    found = found.through(_column(_half(turned, relative), shifted), _column(turned, shifted), _column(np.zeros(3), y))
    inner = _column(frame.T @ turned, (frame.T @ shifted) * inverse)
    found = found.through(inner, _column(turned, shifted), _column(np.zeros(3), d))
    left, right = symbols("left", 3), symbols("right", 3)
    swung = shifted - 2.0 * cross(left, shifted - cross(left, shifted))
    inner = _column(right - left - cross(left, right), swung)
    found = found.through(inner, _column(left, right, shifted), _column(np.zeros(6), d))
    moves = symbols("dz", layout.rows), symbols("dzz", layout.rows)
    increments = [_increment(v[layout.rows_of(turn)], z) for v, z in zip(moves, (p, q), strict=True)]
    inner = _column(*increments, d + moves[1][layout.rows_of(position)] - moves[0][layout.rows_of(position)])
    return found.through(inner, _column(*moves), ca.SX.zeros(2 * layout.rows))


def screw_forces(
    density: Density,
    layout: Layout,
    term: Callable[[dict[str, Expression]], ca.SX],
    ends: tuple[Expression, Expression],
    place: Mapping[str, Any],
) -> tuple[Expression, Expression]:
    """Forces of an element on its two nodes, −∂f left-trivialized.

    With gamma = ∂f/∂γ, upsilon = ∂f/∂y and even ± odd = ½ ((1 − γ·γ) gamma/2 + (γ·gamma) γ ± γ × gamma):
    (even + odd + y × upsilon, Λ upsilon/ds) on the left node, (odd − even, −Λ upsilon/ds) on the right one.

    Args:
        density: the density.
        layout: rows of a node.
        term: from the values of the slots to a term that depends on strains alone (see strains_only).
        ends: rows of the two nodes.
        place: "inverse" 1/ds, and the other slots of the term, "t" and the coordinate.

    Returns: forces on the left and the right node, shape (layout.dofs,) each.
    """
    turn, position = density.lagrangian.pose or ("", "")
    inverse, (a, b) = place["inverse"], (end[layout.rows_of(position)] for end in ends)
    p, q = (end[layout.rows_of(turn)] for end in ends)
    r0, v = layout.representation.relative(p, q)
    frame, half = layout.representation.matrix(p), v * (1.0 / (1.0 + r0))
    y = frame.T @ ((b - a) * inverse)
    of_strain = _of_strain(density, term, place)
    found = _of_relative_pose(of_strain, half, y, inverse, weights=ca.SX(1.0), second=False)
    slope = from_sx(ca.densify(found.slope.T))
    gamma, upsilon = slope[:3], slope[3:]
    even = 0.25 * (1.0 - dot(half, half)) * gamma + 0.5 * dot(half, gamma) * half
    odd = 0.5 * cross(half, gamma)
    pull = frame @ (upsilon * inverse)
    left, right = zeros(layout.dofs), zeros(layout.dofs)
    turns, moves = layout.dofs_of(turn), layout.dofs_of(position)
    left[turns], left[moves] = even + odd + cross(y, upsilon), pull
    right[turns], right[moves] = odd - even, -pull
    return left, right


def _of_strain(
    density: Density, term: Callable[[dict[str, Expression]], ca.SX], place: Mapping[str, Any]
) -> Callable[[Expression], ca.SX]:
    """A term as a function of (Ω, Γ + e₃)."""
    turn, position = density.lagrangian.pose or ("", "")
    along = density.lagrangian.interval
    others = {k: v for k, v in place.items() if k != "inverse"}
    return lambda e: term(others | {f"{turn}_{along}": e[:3], f"{position}_{along}": e[3:]})


def _of_relative_pose(
    term: Callable[[Expression], ca.SX],
    half: Expression,
    y: Expression,
    inverse: Expression,
    *,
    weights: ca.SX,
    second: bool,
) -> Jet:
    """A function of (Ω, Γ + e₃) as one of (γ, y)."""
    strain, square = symbols("strain", 6), ca.SX.sym("square")
    gamma, chord, scalars = symbols("gamma", 3), symbols("chord", 3), symbols("scalars", 2)
    defect = to_sx(series.arctan_defect(np.asarray(wrap(square)).reshape(1)))
    ratios = ca.vertcat(1.0 - square * defect, 1.0 + (1.0 - square) * defect)
    once = cross(gamma, chord)
    straight = chord - 2.0 * scalars[0] * once + scalars[1] * cross(gamma, once)
    inner, unknown = _column(4.0 * inverse * scalars[0] * gamma, straight), _column(gamma, chord, scalars)
    at = _column(half, y, dot(half, half))
    known = ca.substitute([ratios], [square], [at[6]])[0]
    here = ca.vertcat(at[:6], known)
    strains = ca.substitute([inner], [unknown], [here])[0]
    found = jet(term(strain), _column(strain), strains, weights=weights, second=second)
    found = found.through(inner, unknown, here)
    found = found.through(ca.vertcat(unknown[:6], ratios), ca.vertcat(unknown[:6], square), at)
    return found.through(ca.vertcat(unknown[:6], to_sx(dot(gamma, gamma))), unknown[:6], at[:6])


def _half(turned: Expression, relative: Expression) -> Expression:
    """γ of Cay(λ) r."""
    made = wrap(np.asarray(quaternion.multiply(np.concatenate([np.ones(1), turned]), relative)))
    return made[1:] * (1.0 / (np.sqrt(1.0 + dot(turned, turned)) + made[0]))


def _increment(moved: Expression, p: Expression) -> Expression:
    """φ of p + δp to second order: with π = δp p⁻¹, (1 + π)p ∥ (1 + φ)p, φ = Im π/(1 + Re π)."""
    part = wrap(np.asarray(quaternion.multiply(moved, quaternion.conjugate(p * (1.0 / dot(p, p))))))
    return part[1:] * (1.0 - part[0])


def _column(*parts: object) -> ca.SX:
    return ca.vertcat(*[to_sx(part) for part in parts])
