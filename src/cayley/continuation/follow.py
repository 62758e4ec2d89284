"""A path of equilibria, point by point: arc steps that fit the corrections they take, and critical points between."""

from dataclasses import dataclass, field, replace

import numpy as np

from cayley.continuation.critical import Critical, between
from cayley.continuation.track import Point, Track

WANTED = 4
"""Corrections of a step that is as long as it should be."""
LONGER, SHORTER = 2.0, 0.5
"""Most that an arc step grows or shrinks from one point to the next."""
SMALLEST = 1e-5
"""Arc step, over the largest, below which a path cannot be followed."""
STRAIGHT = 0.7
"""Least cosine between tangents of neighbors: another branch would lie across."""

AWAY, HALVINGS = 0.05, 10
"""Arc length from a bifurcation point to the first point of a branch, and how often it is halved."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """How far and how finely a path is followed.

    Args:
        low: least λ.
        high: greatest λ.
        points: most points.
        step: largest arc step.
        turn: largest turn of a node from one point to the next [rad].
    """

    low: float
    high: float
    points: int
    step: float
    turn: float


@dataclass(slots=True)
class Found:
    """What was followed.

    Args:
        points: in their order.
        critical: limit and bifurcation points between them.
        ended: why it ended there.
    """

    points: list[Point]
    critical: list[Critical] = field(default_factory=list)
    ended: str = ""


def follow(track: Track, first: Point, limits: Limits, *, begin: Critical | None = None) -> Found:
    """Follow a path from a point along its tangent.

    Args:
        track: the equations.
        first: the point.
        limits: how far.
        begin: where a branch leaves; it is the point before the first one.
    """
    found = Found([first] if begin is None else [replace(begin.place, unstable=first.unstable), first])
    ds = SHORTER * limits.step
    while len(found.points) < limits.points:
        last = found.points[-1]
        track.at(last)
        ds = min(ds, limits.step, limits.turn / max(track.turn(last), 1e-300))
        if ds < SMALLEST * limits.step:
            found.ended = f"no equilibrium found beyond {last.parameter:.6g}; give a smaller step or turn"
            return found
        point = track.step(last, ds)
        if point is None or track.alike(last, point) < STRAIGHT:
            ds *= SHORTER
            continue
        end = min(max(point.parameter, limits.low), limits.high)
        if end != point.parameter:
            ds *= (end - last.parameter) / (point.parameter - last.parameter)
            landed = _landed(track, last, ds, end)
            if landed is not None:
                _add(track, found, landed, ds)
            found.ended = f"the range ends at {end:.6g}"
            return found
        _add(track, found, point, ds)
        ds *= float(np.clip(2.0 ** (0.5 * (WANTED - point.corrections)), SHORTER, LONGER))
    found.ended = f"{limits.points} points"
    return found


def _landed(track: Track, last: Point, ds: float, end: float) -> Point | None:
    """The point at the end of the range, which a step just reaches."""
    track.at(last)
    track.still.move(last.tangent, ds)
    return track.correct(end, np.zeros_like(last.tangent), 1.0, along=last)


def _add(track: Track, found: Found, point: Point, ds: float) -> None:
    """Add a point, and the critical ones before it."""
    for one in list(between(track, found.points[-1], point, ds)):
        found.critical.append(replace(one, point=len(found.points)))
        found.points.append(one.place)
    found.points.append(point)


def leave(track: Track, critical: Critical, vector: np.ndarray, size: float) -> Point | None:
    """The first point of a branch: an arc length from a bifurcation point along a motion, corrected across it.

    Args:
        track: the equations.
        critical: the bifurcation point.
        vector: a motion without stiffness, of arc length 1; its sign is the direction.
        size: greatest arc length; halved until a point is found.
    """
    size = min(size, AWAY)
    for _ in range(HALVINGS):
        track.at(critical.place)
        track.still.move(vector, size)
        point = track.correct(critical.parameter, vector, 0.0)
        if point is not None:
            return point
        size *= 0.5
    return None
