"""Areas of polygons with holes: their integrals by Green's theorem, and what is wrong with one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cayley.model import validate
from cayley.model.validate import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Areas:
    """Integrals over a plane area.

    Attributes:
        area: A [m^2].
        centroid: (y1, y2) [m].
        moments: I1 = ∫ y2² dA, I2 = ∫ y1² dA and I12 = ∫ y1 y2 dA about the centroid [m^4].
    """

    area: float
    centroid: tuple[float, float]
    moments: tuple[float, float, float]

    @property
    def principal_angle(self) -> float:
        """Angle from e1 to the principal axis of the larger I1 [rad], in (-π/4, π/4]: tan 2α = 2 I12/(I2 − I1)."""
        i1, i2, i12 = self.moments
        if abs(i12) <= 1e-12 * (i1 + i2):
            return 0.0
        return 0.25 * np.pi if i1 == i2 else 0.5 * float(np.arctan(2.0 * i12 / (i2 - i1)))


def areas(outline: Array, holes: Sequence[Array] = ()) -> Areas:
    """The integrals of a polygon less its holes, exact.

    With c = y1 y2' − y1' y2 over the edges from y to y':
    A = ½ Σ c,   ∫ y = ⅙ Σ c (y + y'),   ∫ y2² = 1/12 Σ c (y2² + y2 y2' + y2'²),
    ∫ y1 y2 = 1/24 Σ c (2 y1 y2 + y1 y2' + y1' y2 + 2 y1' y2')

    Args:
        outline: counter-clockwise, shape (k, 2) [m].
        holes: counter-clockwise too, inside it.

    Source: Green's theorem; Steger (1996), On the calculation of arbitrary moments of polygons.
    """
    start = outline.mean(axis=0)  # so that a place far from the origin costs no digits
    parts = [_raw(outline - start), *(-_raw(hole - start) for hole in holes)]
    a, s1, s2, m1, m2, m12 = sum(parts[1:], start=parts[0])
    y1, y2 = s1 / a, s2 / a
    moments = (float(m1 - a * y2 * y2), float(m2 - a * y1 * y1), float(m12 - a * y1 * y2))
    return Areas(area=float(a), centroid=(float(start[0] + y1), float(start[1] + y2)), moments=moments)


def _raw(points: Array) -> Array:
    """A, ∫y1, ∫y2, ∫y2², ∫y1², ∫y1y2 about the origin."""
    (x, y), (u, v) = points.T, np.roll(points, -1, axis=0).T
    c = x * v - u * y
    return np.array(
        [
            0.5 * c.sum(),
            (c * (x + u)).sum() / 6.0,
            (c * (y + v)).sum() / 6.0,
            (c * (y * y + y * v + v * v)).sum() / 12.0,
            (c * (x * x + x * u + u * u)).sum() / 12.0,
            (c * (2.0 * x * y + x * v + u * y + 2.0 * u * v)).sum() / 24.0,
        ]
    )


def closed(owner: str, name: str, value: object) -> Array:
    """A polygon without crossings as counter-clockwise points.

    Raises:
        TypeError: not numbers.
        ValueError: fewer than three points, a point twice in a row, edges that cross, or no area.
    """
    right = "3 or more points (y1, y2) [m] around an area, shape (k, 2)"
    points = validate.array(owner, name, value, (-1, 2), right)
    if len(points) > 1 and np.array_equal(points[0], points[-1]):
        points = points[:-1]
    if len(points) < 3:
        raise ValueError(validate.wrong(owner, name, value, right))
    size = float(np.ptp(points, axis=0).max())
    edges = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    if edges.min() <= 1e-12 * size:
        raise ValueError(f"{owner}: {name} has point {int(edges.argmin())} twice in a row; give each corner once")
    hit = crossing(points, points)
    if hit is not None:
        raise ValueError(f"{owner}: {name} crosses itself, edge {hit[0]} edge {hit[1]}; give the corners in order")
    twice = float(_raw(points - points[0])[0])
    if abs(twice) <= 1e-12 * size * size:
        raise ValueError(f"{owner}: {name} has no area; {name} must be {right}")
    return points if twice > 0.0 else points[::-1].copy()


def crossing(one: Array, other: Array) -> tuple[int, int] | None:
    """Two edges of two closed polygons that have a point in common (of one polygon: and are no neighbors), or None."""
    same = one is other
    a, b = one[:, None], np.roll(one, -1, axis=0)[:, None]
    c, d = other[None], np.roll(other, -1, axis=0)[None]
    first, second = _side(a, b, c) * _side(a, b, d), _side(c, d, a) * _side(c, d, b)
    meets = (first < 0.0) & (second < 0.0)
    meets |= (first <= 0.0) & (second <= 0.0) & ~((first == 0.0) & (second == 0.0))
    if same:
        k = np.arange(len(one))
        apart = np.abs(k[:, None] - k[None])
        meets &= (apart > 1) & (apart < len(one) - 1)
    found = np.argwhere(meets)
    return (int(found[0, 0]), int(found[0, 1])) if len(found) else None


def inside(points: Array, polygon: Array) -> NDArray[np.bool_]:
    """Which points lie inside a closed polygon: a ray from each crosses its edges an odd number of times."""
    x, y = points[:, :1], points[:, 1:]
    (u, v), (p, q) = polygon.T, np.roll(polygon, -1, axis=0).T
    between = (v > y) != (q > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = x < (p - u) * (y - v) / (q - v) + u
    odd: NDArray[np.bool_] = (between & left).sum(axis=1) % 2 == 1
    return odd


def refuse_outside(owner: str, ring: Array, holes: Sequence[Array]) -> None:
    """Refuse holes that are not inside the outline, or not apart from each other.

    Raises:
        ValueError: there is such a hole.
    """
    for k, hole in enumerate(holes):
        if crossing(hole, ring) is not None or not inside(hole, ring).all():
            raise ValueError(f"{owner}: holes[{k}] is not inside the outline; give holes that are")
        for j, other in enumerate(holes[:k]):
            if crossing(hole, other) is not None or inside(hole, other).any() or inside(other, hole).any():
                raise ValueError(f"{owner}: holes[{j}] and holes[{k}] overlap; give holes that are apart")


def _side(a: Array, b: Array, p: Array) -> Array:
    """Sign of the turn from a to b to p."""
    turn = (b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (p[..., 0] - a[..., 0])
    return np.asarray(np.sign(turn), dtype=float)


__all__ = ["Areas", "areas", "closed", "crossing", "inside", "refuse_outside"]
