"""Limit points and bifurcation points between two points of a path, located, with the motions that lose stiffness."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from cayley.continuation.track import Point, Track

LOCATED = 1e-7
"""Arc length within which a critical point is found, over the step between its neighbors."""
BESIDE = 1e-4
"""Distance from a limit point at which motions are counted, likewise."""
TOGETHER = 1e-5
"""Likewise, how near bifurcation points are one, of several motions: rounding errors split those of round rods."""
NEAR = 1e-3
"""Likewise, a bracket in which Newton's method may fail."""
MOST = 4
"""Most bifurcation points between two neighbors that are told apart."""
SPARE, ROUNDS = 4, 6
"""More vectors than are wanted, and steps of inverse iteration, which is close to the eigenvalue."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Critical:
    """A point where a motion has no stiffness.

    Args:
        kind: "limit" (λ turns back) or "bifurcation" (other equilibria branch off).
        parameter: λ there.
        place: the point.
        vectors: motions without stiffness, of arc length 1, shape (k, unknowns).
        change: by how many more motions the path is unstable behind it.
        point: its number among the points of the path.
    """

    kind: str
    parameter: float
    place: Point
    vectors: np.ndarray
    change: int
    point: int = 0

    def __repr__(self) -> str:
        """Kind and parameter."""
        return f"<Critical: {self.kind} at {self.parameter:.6g}, {self.change:+d} unstable>"


def between(track: Track, left: Point, right: Point, ds: float) -> Iterator[Critical]:
    """Critical points between two points of a path, in order.

    A limit point is a root of dλ/ds; at a bifurcation point the number of unstable motions changes without one.

    Args:
        track: the equations.
        left: a point.
        right: the next one.
        ds: arc length from left to right.
    """
    turning = left.slope * right.slope < 0.0
    if not turning and left.unstable == right.unstable:
        return
    edges = [(0.0, left), (ds, right)]
    limit = _limit(track, left, ds) if turning else None
    if limit is None:
        yield from _bifurcations(track, left, *edges)
        return
    before, behind = (track.step(left, min(max(limit + side * BESIDE * ds, 0.0), ds)) for side in (-1.0, 1.0))
    place = track.step(left, limit)
    if place is None or before is None or behind is None:
        return
    yield from _bifurcations(track, left, edges[0], (limit - BESIDE * ds, before))
    yield Critical(
        kind="limit",
        parameter=place.parameter,
        place=place,
        vectors=place.tangent[None] / np.sqrt(track.dot(place.tangent, place.tangent)),
        change=behind.unstable - before.unstable,
    )
    yield from _bifurcations(track, left, (limit + BESIDE * ds, behind), edges[1])


def _limit(track: Track, left: Point, ds: float) -> float | None:
    def slope(s: float) -> float:
        found = track.step(left, s)
        if found is None:
            raise ArithmeticError
        return found.slope

    try:
        return float(brentq(slope, 0.0, ds, xtol=LOCATED * ds))
    except (ArithmeticError, ValueError):
        return None


def _bifurcations(
    track: Track, start: Point, low: tuple[float, Point], high: tuple[float, Point]
) -> Iterator[Critical]:
    """Points between two arc lengths from a start at which the number of unstable motions changes, by bisection."""
    tolerance = LOCATED * (high[0] - low[0])
    for _ in range(MOST):
        if low[1].unstable == high[1].unstable:
            return
        inner, outer = low, high
        while outer[0] - inner[0] > tolerance:
            s = 0.5 * (inner[0] + outer[0])
            found = track.step(start, s)
            if found is None and outer[0] - inner[0] < NEAR * (high[0] - low[0]):
                break  # so near that what has no stiffness is moved by rounding errors
            if found is None:
                return
            if found.unstable == low[1].unstable:
                inner = s, found
            else:
                outer = s, found
        place, beyond = outer[1], min(outer[0] + TOGETHER * (high[0] - low[0]), high[0])
        behind = (track.step(start, beyond) if beyond < high[0] else high[1]) or place
        change = behind.unstable - low[1].unstable
        low = beyond, behind
        if not change:
            continue
        vectors = _without_stiffness(track, place, abs(change))
        yield Critical(kind="bifurcation", parameter=place.parameter, place=place, vectors=vectors, change=change)


def _without_stiffness(track: Track, place: Point, count: int) -> np.ndarray:
    """The motions of least stiffness at a point, of those that have any elsewhere, of arc length 1, by rows.

    K x = ω² M x by inverse iteration of a few vectors; what nothing resists anywhere has less than rounding.
    """
    track.at(place)
    still, free = track.still, track.still.free
    mass, stiffness = -still.matrix(2), -still.matrix(0)
    still.tangent(inertia=track.inertia)
    x = np.zeros((min(count + SPARE, len(free)), mass.shape[0]))
    x[:, free] = np.random.default_rng(1).standard_normal((len(x), len(free)))
    for _ in range(ROUNDS):
        x = np.array([-still.solve(mass @ row) for row in x])
        x[:, still.spots] = 0.0
        values, vectors = np.linalg.eigh(x @ (mass @ x.T))
        good = values > 1e-13 * values[-1]
        x = (vectors[:, good] / np.sqrt(values[good])).T @ x
    values, vectors = np.linalg.eigh(x @ (stiffness @ x.T))
    known: Any = np.flatnonzero(np.abs(values) > track.raised)
    known = known if len(known) >= count else np.arange(len(values))
    chosen = known[np.argsort(np.abs(values[known]))][:count]
    found = vectors.T[chosen] @ x
    return found / np.sqrt([[track.dot(row, row)] for row in found])
