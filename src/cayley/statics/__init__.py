"""Equilibria of models, at rest or turning steadily."""

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np

from cayley.discrete import rules
from cayley.discrete.rules import Rule
from cayley.model import Model
from cayley.model.loads import Gravity
from cayley.statics.free import free_motions, simplified, tell
from cayley.statics.newton import Solution, solve
from cayley.statics.result import Equilibrium
from cayley.steppers.still import Still
from cayley.system.discretize import discretize, initial_values, spans
from cayley.system.legendre import in_one_hemisphere

_log = logging.getLogger("cayley.statics")

ALONG = 1e-9
"""Sine of the angle between gravity and spin that counts as none."""
ROUNDING = 10.0 * np.finfo(float).eps
"""Rounding error of stiffness, relative to the largest over its mass."""


class EquilibriumError(RuntimeError):
    """No equilibrium was found; the message tells how far, where and what would help."""


def equilibrium(
    model: Model,
    *,
    start: Any = None,
    initial: Mapping[Any, Mapping[str, Any]] | None = None,
    time: float = 0.0,
    spin: Any = None,
    rule: Rule = rules.midpoint,
    relax: bool | None = None,
) -> Equilibrium:
    """Find an equilibrium of a model: values at which the action is stationary among all that rest.

    δ(∫ L(q, 0) ds + λ·g(q)) + loads = 0, by Newton's method with the exact tangent; loads are put on in as many steps
    as are needed. Motions that nothing resists are left alone, unless loads drive them.

    Args:
        model: rods, bodies, joints, supports and loads.
        start: an Equilibrium, a Trajectory (its last frame) or a State to begin from; the reference without it.
        initial: positions and rotations to begin from by part, as of cy.simulate.
        time: time at which loads and prescribed motions are taken [s]; springs and rods are at rest there.
        spin: angular velocity about the origin [rad/s] of a frame in which the model rests, a number (about z) or a
            vector: a steady rotation.
        rule: says how strain is measured along an element, as in a run: screw or galerkin(time=1, space=m), say. What
            it does in time has no part here.
        relax: True: go downhill from the start, for starts far from the equilibrium; False: never; None: where Newton's
            method fails.

    Returns: the Equilibrium.

    Raises:
        ValueError: if an argument does not fit.
        EquilibriumError: if none is found.

    Source: J. C. Simo and L. Vu-Quoc, A three-dimensional finite-strain rod model, part II (1986); the static limit of
    Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 6.
    """
    if not isinstance(model, Model):
        raise TypeError(f"equilibrium: {model!r} is no Model; make one with cy.Model(...)")
    turning = spin_of(spin)
    _check_gravity(model, turning)
    system = discretize(model, rule)
    if start is not None and initial is not None:
        raise ValueError("equilibrium: both start and initial are given; give one")
    values = initial_values(model, system, initial or {})[0] if start is None else values_of(start, system.reference)
    values = in_one_hemisphere(system, values)
    still = Still.at(system, values, _number("time", time), turning)
    inertia = ROUNDING * (still.fastest() or 1.0)  # bodies alone have no stiffness
    if start is not None and hasattr(start, "still") and start.still.multipliers.shape == still.multipliers.shape:
        still.put(values, start.still.multipliers)
    solution = solve(still, inertia=inertia, relax=relax, bent=bool(initial))
    facts = {"found": solution.found, "iterations": solution.iterations, "load_steps": solution.load_steps}
    _log.info("equilibrium: %d corrections by %s", solution.iterations, solution.how, extra=facts)
    if not solution.found:
        raise EquilibriumError(_failure(model, still, solution, inertia))
    parts = dict(zip(model.names, spans(model, rule.degree), strict=True))
    return Equilibrium(model, parts, still, solution, inertia)


def values_of(start: Any, reference: np.ndarray) -> np.ndarray:
    """Values of all nodes of an Equilibrium, Trajectory or State.

    Raises:
        ValueError: if it is none, or of another system.
    """
    state = getattr(start, "state", start)
    values = getattr(state, "values", None)
    if not isinstance(values, np.ndarray):
        raise ValueError(f"start is a {type(start).__name__}; give an Equilibrium, a Trajectory or a State")
    if values.shape != reference.shape:
        raise ValueError(
            f"start has values of shape {values.shape}, this model under this rule {reference.shape}; give one of the "
            "same parts, elements and degree in space"
        )
    return values


def spin_of(spin: Any) -> np.ndarray | None:
    """Angular velocity as a vector: a number is one about z.

    Raises:
        ValueError: if it is neither a number nor three.
    """
    if spin is None:
        return None
    try:
        given = np.asarray(spin, dtype=float)
    except (TypeError, ValueError):
        given = np.zeros(0)
    if given.shape not in ((), (3,)) or not np.all(np.isfinite(given)):
        raise ValueError(f"spin is {spin!r}; give an angular velocity about z or a vector of three [rad/s]")
    return given if given.shape else np.array([0.0, 0.0, float(given)])


def _check_gravity(model: Model, spin: np.ndarray | None) -> None:
    """Refuse gravity across the axis of a frame that turns: seen from there its direction changes all the time."""
    for load in model.loads:
        if spin is None or not isinstance(load, Gravity):
            continue
        g = np.array(load.acceleration)
        if np.linalg.norm(np.cross(g, spin)) > ALONG * np.linalg.norm(g) * np.linalg.norm(spin):
            raise ValueError(
                f"equilibrium: {load} is not along the spin {tuple(spin.tolist())} rad/s, so nothing rests in the "
                "turning frame; leave gravity out, or run the model with cy.simulate"
            )


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | np.floating) or not np.isfinite(value):
        raise ValueError(f"{name} is {value!r}; give a number [s]")
    return float(value)


def _failure(model: Model, still: Still, solution: Solution, inertia: float) -> str:
    """One line on a search that failed; the system is where it began."""
    motions = simplified(free_motions(still, inertia))
    force = still.force()
    pushed = [m for m in motions if abs(m @ force) > 1e-6 * np.abs(m).max() * np.abs(force).max()]
    if pushed:
        free = "; ".join(tell(still, model, np.array(pushed)))
        return f"no equilibrium found: nothing holds the model where its loads push it ({free}); hold it, or join it"
    among = zip(model.names, spans(model, still.system.equations.rule.degree), strict=True)
    part, nodes = next(pair for pair in among if max(solution.worst, 0) < pair[1].stop)
    node = max(solution.worst, 0) - nodes.start
    told = ", ".join(f"{size:.1e} ({force:.1e})" for size, force in solution.history[-3:])
    return (
        f"no equilibrium found after {solution.iterations} corrections, worst at node {node} of {part} (last "
        f"corrections and forces in N or N m: {told}); start nearer with start= or initial=, follow a load with "
        "cy.trace, or give relax=True"
    )


__all__ = ["Equilibrium", "EquilibriumError", "equilibrium"]
