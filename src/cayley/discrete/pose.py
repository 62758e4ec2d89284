"""Derivatives of the strain of a screw motion, through the relative pose of an element's ends.

The strain sees two nodes (p, a) and (q, b) only through γ = Im r/(1 + Re r), r the direction of p̄ q, and
y = Λ(p)ᵀ(b − a)/ds: six numbers. Between them and the embedding space stand the increments φ of rotations in space,
p + δp ∥ (1 + φ) p, and the turn λ between the ends that they make.
"""

from collections.abc import Callable, Mapping
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, cross, dot, symbols, to_sx, wrap
from cayley.discrete.jet import Jet, jet
from cayley.discrete.layout import Layout
from cayley.discrete.representation import homogeneous
from cayley.lie import quaternion, series

DRAWS = 8
"""Random points at which a density is asked whether it depends on the strains alone."""


def strains_only(density: Density, term: Callable[[dict[str, Expression]], ca.SX]) -> bool:
    """Whether a term depends on pose and slopes only through Λᵀx′ and Ω, and there are no other fields.

    It is asked at random points: f(Λ, x, x′, Ω) = f(I, 0, Λᵀx′, Ω).

    Args:
        density: the density.
        term: from the values of the slots to the term, such as the strain energy.
    """
    turn, position = density.lagrangian.pose or ("", "")
    if set(density.lagrangian.fields) != {turn, position}:
        return False
    along = str(density.lagrangian.interval)
    frame, x, slope, bend = symbols("f", 3, 3), symbols("x", 3), symbols("dx", 3), symbols("w", 3)
    place, t = ca.SX.sym(along), ca.SX.sym("t")
    shared = {f"{turn}_{along}": bend, along: wrap(place), "t": wrap(t)}
    whole = term(shared | {f"frame of {turn}": frame, position: x, f"{position}_{along}": slope})
    seen = term(shared | {f"{position}_{along}": frame.T @ slope})
    free = ca.vertcat(to_sx(bend), to_sx(slope), to_sx(x), place, t, density.parameters)
    function = ca.Function("both", [to_sx(frame), free], [whole, seen])
    rng = np.random.default_rng(0)
    for _ in range(DRAWS):
        turned = quaternion.to_matrix(quaternion.normalize(rng.normal(size=4)))
        one, other = (np.array(v) for v in function(turned, rng.normal(size=free.numel())))
        if not np.allclose(one, other, rtol=1e-9, atol=1e-9):
            return False
    return True


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
    along, inverse = str(density.lagrangian.interval), place["inverse"]
    p, q = (end[layout.rows_of(turn)] for end in ends)
    d = ends[1][layout.rows_of(position)] - ends[0][layout.rows_of(position)]
    size = dot(p, p)
    relative = wrap(np.asarray(quaternion.multiply(quaternion.conjugate(p), q))) / np.sqrt(size * dot(q, q))
    frame = homogeneous(p, 2.0 / size)
    half = relative[1:] * (1.0 / (1.0 + relative[0]))
    y = (frame.T @ d) * inverse

    def of_strain(e: Expression) -> ca.SX:
        others = {k: v for k, v in place.items() if k != "inverse"}
        return term(others | {f"{turn}_{along}": e[:3], f"{position}_{along}": e[3:]})

    found = _of_relative_pose(of_strain, half, y, inverse, weights=weights, second=second)
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
