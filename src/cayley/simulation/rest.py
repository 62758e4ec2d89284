"""The fastest way to rest: by statics where that is possible, else by a damped run."""

import logging
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.discrete import rules
from cayley.discrete.rules import Rule
from cayley.model import Model
from cayley.model.settling import settling, slowest_frequency
from cayley.results.residual import residual_speed
from cayley.results.trajectory import Trajectory
from cayley.simulation.failure import SimulationError
from cayley.simulation.run import run
from cayley.simulation.saves import Saves, positive
from cayley.simulation.start import kept_shallow, start_of_model
from cayley.statics import Equilibrium, EquilibriumError, equilibrium
from cayley.system.discretize import spans
from cayley.system.system import State

if TYPE_CHECKING:
    import xarray as xr

_log = logging.getLogger("cayley.run")

STATICS, RUN = "statics", "damped run"
STRETCH, FRAMES = 2.0, 8
"""Length of a piece of a damped run, in 1/ω of the slowest motion, and the frames at which its speed is looked at."""
LONGEST = 200.0
"""Length of a damped run at which it is given up, in 1/ω."""


SLOWER, SHALLOW = 10, 6
"""Tries with half the step where parts touch too fast, and those in which depth counts, too: it is much for corners."""


class SettleError(RuntimeError):
    """The model did not come to rest; how far it came is in ``partial``."""

    def __init__(self, message: str, partial: Trajectory) -> None:
        """Hold the message and the last piece of the run."""
        super().__init__(message)
        self.partial = partial


@dataclass(frozen=True, slots=True, kw_only=True)
class Settled:
    """A model at rest.

    ``settled[part]`` is the Dataset of a part, ``cy.simulate(model, start=settled, ...)`` runs from here.

    Attributes:
        route: "statics" or "damped run".
        residual: largest speed of a node over the length of its rod [1/s], in the last piece of a damped run; 0 by
            statics.
        force: by statics the largest force or moment left on a node [N, N m]; not a number after a damped run.
        found: the Equilibrium, or the last piece of the damped run.
    """

    route: str
    residual: float
    force: float
    found: Equilibrium | Trajectory

    @property
    def state(self) -> State:
        """Values and momenta (at rest) of all nodes, to start a run from."""
        state = self.found.state
        return replace(state, momenta=np.zeros_like(state.momenta))

    def __getitem__(self, part: Any) -> "xr.Dataset":
        """Fields of one rod or body, given itself or by name, as those of a run without the time."""
        return self.found[part] if isinstance(self.found, Equilibrium) else self.found[part].isel(time=-1)

    def poses(self, part: Any) -> tuple[np.ndarray, np.ndarray]:
        """Positions [m] and unit quaternions wxyz of a part's nodes alone, shape (nodes, 3) and (nodes, 4)."""
        position, rotation = self.found.poses(part)
        return (position, rotation) if isinstance(self.found, Equilibrium) else (position[-1], rotation[-1])

    def __repr__(self) -> str:
        """Say how, and how well."""
        left = f"force left {self.force:.2g}" if self.route == STATICS else f"speed left {self.residual:.2g} lengths/s"
        return f"<Settled: by {self.route}, {left}>"


def settle(
    model: Model,
    *,
    start: Any = None,
    initial: Mapping[Any, Mapping[str, Any]] | None = None,
    tolerance: float = 1e-5,
    rule: Rule | None = None,
    route: str | None = None,
    rate: float | None = None,
) -> Settled:
    """Bring a model to rest, the fastest way: by statics where nothing touches, else by a damped run.

    Statics solves δ(∫ L(q, 0) ds) + loads = 0 and goes on downhill where that is unstable. A damped run adds −α m ẋ,
    −α J ω to all rods and ends when no node has been faster than the tolerance for 2/ω, ω the slowest frequency.

    Args:
        model: rods, bodies, joints, supports and loads; loads and prescribed motions are taken as they are at time 0 by
            statics, and as they go on in a damped run.
        start: an Equilibrium, a Trajectory or a State to begin from; the reference without it.
        initial: positions and rotations to begin from by part, as of cy.simulate.
        tolerance: largest speed left, in lengths of the rod per second [1/s].
        rule: how strain is measured; midpoint by statics, verlet in a run without it.
        route: "statics" or "damped run"; None: statics, and a run where there is contact or statics finds nothing.
        rate: α of a damped run [1/s]; None: twice the slowest frequency, as model.settling estimates it.

    Returns: the Settled; it has the residual and the route.

    Raises:
        ValueError: if an argument does not fit, or statics is wanted where there is contact.
        EquilibriumError: if statics alone was wanted and finds nothing.
        SettleError: if a damped run does not come to rest.
        SimulationError: if it stops.
    """
    if not isinstance(model, Model):
        raise TypeError(f"settle: {model!r} is no Model; make one with cy.Model(...)")
    if route not in (None, STATICS, RUN):
        raise ValueError(f'settle: route is {route!r}; give "{STATICS}", "{RUN}" or None')
    positive("tolerance", tolerance, "1/s")
    if route == STATICS and model.contact is not None:
        raise ValueError("settle: statics knows no contact; leave route out, or give a model without contact")
    if route != RUN and model.contact is None:
        try:
            return _by_statics(model, start, initial, rule or rules.midpoint)
        except EquilibriumError as error:
            if route == STATICS:
                raise
            _log.info("settle: no equilibrium by statics, so by a damped run: %s", error)
    return _by_run(model, start, initial, rule or rules.verlet, tolerance, rate)


def _by_statics(model: Model, start: Any, initial: Mapping[Any, Mapping[str, Any]] | None, rule: Rule) -> Settled:
    rest = equilibrium(model, start=start, initial=initial, rule=rule)
    if not rest.stable:
        rest = equilibrium(model, start=start, initial=initial, rule=rule, relax=True)
    return Settled(route=STATICS, residual=0.0, force=rest.residual, found=rest)


def _by_run(
    model: Model,
    start: Any,
    initial: Mapping[Any, Mapping[str, Any]] | None,
    rule: Rule,
    tolerance: float,
    rate: float | None,
) -> Settled:
    damped, unit = settling(model, rate), 1.0 / slowest_frequency(model)
    system, state = start_of_model(damped, "quaternion", initial, start=start)(rule)
    shallow = kept_shallow(system, state.values)
    parts = dict(zip(model.names, spans(model, rule.degree), strict=True))
    end, residual = state.time + LONGEST * unit, np.inf
    step: float | None = None
    saves, tries = Saves(every=STRETCH * unit / FRAMES), 0
    while residual > tolerance:
        try:
            tried = shallow if tries < SHALLOW else system
            piece = run(tried, state, state.time + STRETCH * unit, step, saves, model=damped, parts=parts)
        except SimulationError as error:
            if not error.too_fast or tries == SLOWER:
                raise
            step, tries = 0.5 * error.partial.frames.h, tries + 1  # something touched too fast for the step
            continue
        state, step = piece.state, piece.dt
        residual = max(residual_speed(system, piece.frames.state(k), damped, parts) for k in range(1, len(piece.time)))
        if state.time > end and residual > tolerance:
            raise SettleError(
                f"settle: after {state.time:.3g} s nodes still move by {residual:.2g} lengths per second, over the "
                f"tolerance {tolerance:g}; give a larger one, another rate, or hold what flies free",
                piece,
            )
    return Settled(route=RUN, residual=residual, force=float("nan"), found=piece)


__all__ = ["SettleError", "Settled", "settle"]
