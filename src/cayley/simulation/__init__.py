"""Run a model or any compiled Lagrangian through time."""

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cayley.choice import Choice, Task, choose
from cayley.choice.costs import seconds_of_loads, seconds_of_ties
from cayley.choice.schedule import Schedule, schedule
from cayley.discrete import rules
from cayley.discrete.rules import Rule
from cayley.model import Model
from cayley.model.loads import Gravity
from cayley.model.settling import settling, slowest_frequency
from cayley.results.trajectory import Trajectory
from cayley.results.writer import WriteError, add_info
from cayley.simulation.failure import Interrupted, SimulationError
from cayley.simulation.rest import SHALLOW, SLOWER, STRETCH, Settled, SettleError, settle
from cayley.simulation.restart import resume
from cayley.simulation.run import Calm, span_of
from cayley.simulation.run import run as _run
from cayley.simulation.saves import Saves, nodes_of, positive
from cayley.simulation.start import kept_shallow, start_of_model, start_of_system
from cayley.system.discretize import spans
from cayley.system.system import State, System

CANDIDATES = (rules.verlet, rules.midpoint, rules.galerkin(time=2), rules.galerkin(time=3))
"""Rules among which an accuracy chooses; all have the same nodes."""
_log = logging.getLogger("cayley.run")

ATTEMPTS = 4
"""How often a rule and step are chosen, when runs stop that their trials promised."""


def simulate(
    model: Model,
    t_end: float,
    dt: float | None = None,
    *,
    rule: Rule | None = None,
    accuracy: float | None = None,
    save_every: float | None = None,
    save_steps: int | None = None,
    save_at: Sequence[float] | None = None,
    store: str | Path | None = None,
    overwrite: bool = False,
    save_only: Sequence[Any] | None = None,
    start: Any = None,
    initial: Mapping[Any, Mapping[str, Any]] | None = None,
    rotation: str = "quaternion",
    settle: bool | float = False,
    rest: float | None = None,
    balance: bool = False,
    allow_unstable: bool = False,
    progress: Callable[[float, float], None] | None = None,
    watch: Callable[[System, State], None] | None = None,
) -> Trajectory:
    """Run a model from its reference configuration, or from what ``start`` or ``initial`` say.

    Args:
        model: rods, supports and loads.
        t_end: end of the run [s].
        dt: upper bound of the time step [s], fitted to the saves; without it and accuracy, 0.9 of the guaranteed step
            limit.
        rule: quadrature rule; verlet, or the one that accuracy chooses, without it.
        accuracy: largest wanted error of positions from steps in time, relative to the extent of the model, instead of
            dt: step and, if it is not given, rule are chosen; run.why tells how.
        save_every: time between saved frames [s]; a hundredth of the run without it.
        save_steps: steps between saved frames, instead.
        save_at: times of saved frames [s], instead; the steps nearest to them are saved, and the end.
        store: a Zarr store, a directory, to be written while the run goes on; it stays whole when the run is killed,
            and cy.resume goes on with it. Frames stay in memory without it.
        overwrite: replace a run that is at store.
        save_only: parts, names or ports (rod.node(3)): with a store, frames have these alone, and energies of all;
            forces of joints and supports want their places; the store keeps what resume needs.
        start: an Equilibrium, the last frame of a Trajectory, or a State to begin from, at its time, instead of the
            reference at time 0; of the same parts, elements and degree in space. Loads may be others.
        initial: rod or its name -> position, rotation, velocity, angular_velocity (body frame), momentum,
            angular_momentum (per length, Γ⁰ and Π⁰ of the paper); arrays for all nodes or functions of s.
        rotation: "quaternion" or "matrix".
        settle: True: for the sake of where the motion ends, all rods are damped by −α m ẋ, −α J ω with α twice the
            slowest frequency, and more at the very start; a number: with this α [1/s]. run.residual tells how fast
            they still move at the end; cy.settle goes straight to rest.
        rest: end a run that settles before t_end, when no node was faster than this many lengths of its rod per second
            [1/s], at no frame for 2/ω, ω the slowest frequency.
        balance: keep account of the work of loads, for run.energy_balance; with damping and other forces beside the
            Lagrangian it is kept anyway.
        allow_unstable: run even with a step over the limit.
        progress: called with (fraction done, time [s]) now and then.
        watch: called with the system and its state then.

    Returns: the Trajectory.

    Raises:
        ValueError: if an argument does not fit, dt is over the step limit, or no rule reaches the accuracy.
        SimulationError: if a step is not solved or the motion blows up.
        FileExistsError: if something is at store.
        WriteError: if the store can't be written; all but the last frames are there.
        Interrupted: on Ctrl-C; it has the frames saved before.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014).
    """
    if not isinstance(model, Model):
        raise TypeError(
            f"simulate: {model!r} is no Model; for a Lagrangian of your own use cy.compile and cy.integrate"
        )
    if rule is not None and not isinstance(rule, Rule):
        raise TypeError(f"simulate: rule is {rule!r}; give one of cy.rules, such as cy.rules.verlet")
    model, calm = _settling(model, settle, rest)
    begin = start_of_model(model, rotation, initial, start=start, account=balance)

    saves = _saves(save_every, save_steps, save_at, store, overwrite=overwrite)
    slower = accuracy is None and dt is None and model.contact is not None

    def run(rule: Rule, dt: float | None, attempt: int = 0) -> Trajectory:
        system, state = begin(rule)
        system = kept_shallow(system, state.values) if slower and attempt < SHALLOW else system
        parts = dict(zip(model.names, spans(model, rule.degree), strict=True))
        options: dict[str, Any] = {"allow_unstable": allow_unstable, "progress": progress, "watch": watch, "calm": calm}
        only = None if save_only is None else nodes_of(save_only, model, rule.degree)
        again = replace(saves, overwrite=saves.overwrite or attempt > 0, only=only)
        return _run(system, state, t_end, dt, again, **options, model=model, parts=parts)

    if slower:
        return _run_slower(rule or rules.verlet, run)
    if accuracy is None:
        return run(rule or rules.verlet, dt)
    _check_accuracy(accuracy, dt)
    task = _task(begin, t_end, save_every, accuracy, rule or CANDIDATES[0], model)
    return _run_chosen(task, _candidates(rule), run)


def advise(
    model: Model,
    t_end: float,
    accuracy: float,
    *,
    rule: Rule | None = None,
    save_every: float | None = None,
    initial: Mapping[Any, Mapping[str, Any]] | None = None,
    rotation: str = "quaternion",
) -> Choice:
    """Compare rules for a run of a model without running it; the arguments are those of simulate.

    Returns: the Choice, with all alternatives tried.

    Raises:
        ValueError: if an argument does not fit or no rule reaches the accuracy.
    """
    _check_accuracy(accuracy, None)
    task = _task(start_of_model(model, rotation, initial), t_end, save_every, accuracy, rule or CANDIDATES[0], model)
    return choose(task, _candidates(rule), thorough=True)


def integrate(
    system: System,
    start: Mapping[str, Any] | State,
    t_end: float,
    dt: float | None = None,
    *,
    accuracy: float | None = None,
    save_every: float | None = None,
    t_start: float = 0.0,
    save_steps: int | None = None,
    save_at: Sequence[float] | None = None,
    store: str | Path | None = None,
    overwrite: bool = False,
    allow_unstable: bool = False,
    progress: Callable[[float, float], None] | None = None,
    watch: Callable[[System, State], None] | None = None,
) -> Trajectory:
    """Run a compiled Lagrangian from given fields and velocities.

    Args:
        system: made by ``cy.compile``.
        start: field -> values at the nodes, field_t -> velocities (zero where absent); or a State to go on from.
        t_end: end of the run [s].
        dt: upper bound of the time step [s], fitted to the saves; without it and accuracy, the step of a State that has
            run, else 0.9 of the guaranteed step limit.
        accuracy: largest wanted error of positions from steps in time, relative to the extent of the system at the
            start, instead of dt: the step is chosen. Of a single node it is relative to its way, and rotations count
            in radians.
        save_every: time between saved frames [s]; a hundredth of the run without it.
        t_start: time of the start [s].
        save_steps: steps between saved frames, instead.
        save_at: times of saved frames [s], instead; the steps nearest to them are saved, and the end.
        store: a Zarr store to be written while the run goes on, see cy.simulate.
        overwrite: replace a run that is at store.
        allow_unstable: run even with a step over the limit.
        progress: called with (fraction done, time [s]) now and then.
        watch: called with the system and its state then.

    Returns: the Trajectory.

    Raises:
        ValueError: if the start or another argument does not fit, dt is over the step limit, or the accuracy is not
            reached.
        SimulationError: if a step is not solved or the motion blows up.
        FileExistsError: if something is at store.
        WriteError: if the store can't be written; all but the last frames are there.
        Interrupted: on Ctrl-C; it has the frames saved before.
    """
    if not isinstance(system, System):
        raise TypeError(f"integrate: {system!r} is no compiled system; make one with cy.compile(lagrangian, rule=...)")
    state = start_of_system(system, start, t_start)

    saves = _saves(save_every, save_steps, save_at, store, overwrite=overwrite)

    def run(rule: Rule, dt: float | None, attempt: int = 0) -> Trajectory:
        again = replace(saves, overwrite=saves.overwrite or attempt > 0)
        options: dict[str, Any] = {"allow_unstable": allow_unstable, "progress": progress, "watch": watch}
        return _run(system, state, t_end, dt, again, **options)

    rule = system.equations.rule
    if accuracy is None:
        return run(rule, dt)
    _check_accuracy(accuracy, dt)
    return _run_chosen(_task(lambda _: (system, state), t_end, save_every, accuracy, rule), [rule], run)


def _settling(model: Model, settle: bool | float, rest: float | None) -> tuple[Model, Calm | None]:
    """The model, damped if that is wanted, and when it rests."""
    if settle is False:
        if rest is not None:
            raise ValueError(f"rest is {rest!r}, but nothing settles; give settle=True, too")
        return model, None
    damped = settling(model, None if settle is True else settle)
    if rest is None:
        return damped, None
    return damped, Calm(positive("rest", rest, "1/s"), STRETCH / slowest_frequency(model))


def _saves(
    every: float | None, steps: int | None, at: Sequence[float] | None, store: str | Path | None, *, overwrite: bool
) -> Saves:
    where = None if store is None else Path(store)
    return Saves(every=every, steps=steps, at=at, store=where, overwrite=overwrite)


def _check_accuracy(accuracy: Any, dt: float | None) -> None:
    if dt is not None:
        raise ValueError(f"dt = {dt!r} and accuracy = {accuracy!r} are given; give one of them")
    if isinstance(accuracy, bool) or not isinstance(accuracy, int | float | np.floating) or not 1e-12 < accuracy < 0.5:
        raise ValueError(f"accuracy is {accuracy!r}; give a number between 1e-12 and 0.5, such as 1e-3")


def _candidates(rule: Rule | None) -> tuple[Rule, ...]:
    return CANDIDATES if rule is None else (rule,)


def _task(
    begin: Callable[[Rule], tuple[System, State]],
    t_end: float,
    save_every: float | None,
    accuracy: float,
    rule: Rule,
    model: Model | None = None,
) -> Task:
    """What is to be chosen for; the rule is one whose nodes are those of all candidates."""
    system, state = begin(rule)
    span = span_of(state, t_end)
    starts = [load.start for load in (model.loads if model else ()) if not isinstance(load, Gravity)]
    return Task(
        begin=begin,
        nodes=system.size,
        span=span,
        save_every=Saves(every=save_every).spacing(span),
        accuracy=accuracy,
        loads=seconds_of_loads(system),
        ties=lambda rule: seconds_of_ties(rule, system),
        busy_after=max((start for start in starts if start < t_end), default=0.0),
    )


def _run_slower(rule: Rule, run: Callable[[Rule, float | None, int], Trajectory]) -> Trajectory:
    """Run with the step of the limit; where something touches too fast for it or sinks in, again with half of it."""
    dt: float | None = None
    for attempt in range(SLOWER):
        try:
            return run(rule, dt, attempt)
        except SimulationError as error:
            if not error.too_fast or attempt == SLOWER - 1:
                raise
            dt = 0.5 * error.partial.frames.h
            at = error.partial.time[-1]
            _log.info("parts touch too fast or sink in too deep at t = %.3g s: again with dt = %.3g s", at, dt)
    raise AssertionError


def _run_chosen(task: Task, rules: Sequence[Rule], run: Callable[[Rule, float, int], Trajectory]) -> Trajectory:
    """Choose and run; where a run stops that its trials promised, choose again by trials of whole runs."""
    told = ""
    for attempt in range(ATTEMPTS):
        choice = choose(task, rules)
        best = choice.best
        try:
            trajectory = run(best.rule, best.dt, attempt)
        except SimulationError as error:
            if attempt == ATTEMPTS - 1:
                raise
            told = f" Before, {best.rule} with dt = {best.dt:.3g} s stopped at t = {error.partial.time[-1]:.3g} s."
            task = replace(task, whole=True, limits={**task.limits, best.rule: 0.5 * best.dt})
        else:
            break
    chosen = {"error_estimate": best.error, "why": choice.why + told}
    trajectory.info |= chosen
    if trajectory.path is not None:
        add_info(trajectory.path, chosen)
    return trajectory


__all__ = [
    "Choice",
    "Interrupted",
    "Schedule",
    "SettleError",
    "Settled",
    "SimulationError",
    "WriteError",
    "advise",
    "integrate",
    "resume",
    "schedule",
    "settle",
    "simulate",
]
