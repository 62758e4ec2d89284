"""Paths of equilibria through limit points and bifurcation points, and linear buckling."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cayley.continuation.critical import Critical
from cayley.continuation.follow import Limits, follow, leave
from cayley.continuation.linear import Buckling, buckling
from cayley.continuation.mode import Mode
from cayley.continuation.path import Path
from cayley.continuation.prepare import prepared
from cayley.continuation.track import Track
from cayley.discrete import rules
from cayley.discrete.rules import Rule
from cayley.model import Model, validate
from cayley.statics import EquilibriumError
from cayley.statics.newton import solve

STEP, TURN, POINTS = 0.03, 0.3, 200
"""Largest arc step, largest turn of a node in one [rad], and most points."""


def trace(
    model: Model,
    parameter: Any,
    *,
    range: tuple[float, float] = (0.0, 1.0),
    begin: float | None = None,
    start: Any = None,
    initial: Mapping[Any, Mapping[str, Any]] | None = None,
    time: float = 0.0,
    rule: Rule = rules.midpoint,
    direction: int = 1,
    points: int = POINTS,
    step: float = STEP,
    turn: float = TURN,
) -> Path:
    """Follow equilibria of a model along a parameter, through points where it turns back.

    f(u, λ) = 0,   arc length ds² = mean over nodes of (turns² + (shifts/extent)²) + (dλ/(λ₁ − λ₀))²

    Args:
        model: rods, bodies, joints, supports and loads.
        parameter: a load of the model (its value is multiplied by λ), a joint or support with a prescribed motion, or
            its name (the motion is taken at the time λ), several of these, or "time": all is taken at the time λ.
        range: (λ₀, λ₁); the path ends where it leaves it.
        begin: λ to begin at; λ₀ without it.
        start: an Equilibrium, a Trajectory (its last frame) or a State to begin near; the reference without it.
        initial: positions and rotations to begin near by part, as of cy.simulate.
        time: time at which all that is no parameter is taken [s].
        rule: says how strain is measured along an element, as in a run.
        direction: 1: λ first goes toward λ₁; -1: away from it.
        points: most points.
        step: largest arc step.
        turn: largest turn of a node in one step [rad].

    Returns: the Path.

    Raises:
        TypeError: if the parameter is none of these.
        ValueError: if an argument does not fit.
        EquilibriumError: if no equilibrium is found to begin at.

    Source: H. B. Keller (1977); E. Riks, An incremental approach to the solution of snapping and buckling problems
    (1979).
    """
    low, high = _range(range)
    at = low if begin is None else validate.number("trace", "begin", begin, "-")
    if not min(low, high) <= at <= max(low, high):
        raise ValueError(validate.wrong("trace", "begin", at, f"in the range from {low:g} to {high:g}"))
    if direction not in (1, -1):
        raise ValueError(validate.wrong("trace", "direction", direction, "1 or -1"))
    limits = _limits((low, high), points, step, turn)
    made = prepared("trace", model, parameter, at, start=start, initial=initial, time=time, rule=rule)
    if not solve(made.still, inertia=made.inertia).found:
        raise EquilibriumError(
            f"trace: no equilibrium found at {made.scaled.name} = {at:g} to begin at; give another begin, or start="
        )
    track = Track(made.still, made.scaled, made.inertia, abs(high - low))
    track.see_free_motions()
    sense = direction * (1.0 if high > low else -1.0)
    first = track.correct(at, np.zeros_like(track.weight), sense)
    if first is None:
        raise EquilibriumError(f"trace: the equilibrium at {made.scaled.name} = {at:g} has no tangent; begin elsewhere")
    found = follow(track, first, limits)

    def onward(critical: Critical, mode: int, direction: int, options: Mapping[str, Any]) -> Path:
        return _branch(path, track, critical, direction * critical.vectors[mode], limits, options)

    path = Path(model=model, parts=made.parts, track=track, found=found, time=time, onward=onward)
    return path


def _branch(
    path: Path, track: Track, critical: Critical, vector: np.ndarray, limits: Limits, options: Mapping[str, Any]
) -> Path:
    unknown = set(options) - {"range", "points", "step", "turn"}
    if unknown:
        raise TypeError(f"branch: {', '.join(sorted(unknown))} is no option; give range, points, step or turn")
    given = {"range": (limits.low, limits.high), "points": limits.points, "step": limits.step, "turn": limits.turn}
    given |= options
    own = _limits(_range(given["range"]), given["points"], given["step"], given["turn"])
    fresh = Track(track.still, track.scaled, track.rounding, own.high - own.low)
    fresh.inertia, fresh.raised = track.inertia, track.raised
    first = leave(fresh, critical, vector, own.step)
    if first is None:
        raise EquilibriumError(
            f"branch: no equilibrium found beside the bifurcation at {critical.parameter:.6g}; give another mode"
        )
    if len(critical.vectors) > 1:  # perhaps one of many alike, such as a round rod that may bend to any side
        fresh.at(first)
        fresh.see_free_motions()
    found = follow(fresh, first, own, begin=critical)

    def onward(critical: Critical, mode: int, direction: int, options: Mapping[str, Any]) -> Path:
        return _branch(made, fresh, critical, direction * critical.vectors[mode], own, options)

    made = Path(model=path.model, parts=path._parts, track=fresh, found=found, time=path.time, onward=onward)
    return made


def _range(given: Any) -> tuple[float, float]:
    right = "two different finite numbers (from, to)"
    found = validate.array("trace", "range", given, (2,), right)
    if found[0] == found[1]:
        raise ValueError(validate.wrong("trace", "range", given, right))
    return float(found[0]), float(found[1])


def _limits(range: tuple[float, float], points: Any, step: Any, turn: Any) -> Limits:
    if validate.count("trace", "points", points) < 2:
        raise ValueError(validate.wrong("trace", "points", points, "at least 2"))
    return Limits(
        low=min(range),
        high=max(range),
        points=points,
        step=validate.positive("trace", "step", step, "-"),
        turn=validate.positive("trace", "turn", turn, "rad"),
    )


__all__ = ["Buckling", "Critical", "Mode", "Path", "buckling", "trace"]
