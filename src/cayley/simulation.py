"""Run a model or any compiled Lagrangian through time."""

import functools
import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cayley.choice import Choice, Task, choose
from cayley.choice.costs import seconds_of_loads
from cayley.choice.pilot import stepper_of
from cayley.choice.schedule import Schedule, schedule
from cayley.discrete import rules
from cayley.discrete.rules import Rule
from cayley.model import Model
from cayley.model.loads import Gravity
from cayley.results.observe import Frames
from cayley.results.trajectory import Trajectory
from cayley.steppers.outcome import Outcome, Result
from cayley.system.discretize import discretize, initial_values, spans
from cayley.system.legendre import initial_state
from cayley.system.system import State, System

SAFETY = 0.9
"""Part of the step limit that is taken when no step is given."""
CANDIDATES = (rules.verlet, rules.midpoint, rules.galerkin(time=2), rules.galerkin(time=3))
"""Rules among which an accuracy chooses; all have the same nodes."""
START_TOLERANCE = 1e-8
"""Largest violation of a constraint at the start; the first step removes it."""
ATTEMPTS = 4
"""How often a rule and step are chosen, when runs stop that their trials promised."""


class SimulationError(RuntimeError):
    """A run that stopped: the message tells time, place and remedy; what was saved before is in ``partial``."""

    def __init__(self, message: str, partial: Trajectory) -> None:
        """Hold the message and the frames saved before."""
        super().__init__(message)
        self.partial = partial


def simulate(
    model: Model,
    t_end: float,
    dt: float | None = None,
    *,
    rule: Rule | None = None,
    accuracy: float | None = None,
    save_every: float | None = None,
    initial: Mapping[Any, Mapping[str, Any]] | None = None,
    rotation: str = "quaternion",
    balance: bool = False,
    allow_unstable: bool = False,
    progress: Callable[[float, float], None] | None = None,
) -> Trajectory:
    """Run a model from its reference configuration, or from what ``initial`` says.

    Args:
        model: rods, supports and loads.
        t_end: end of the run [s].
        dt: upper bound of the time step [s], fitted to the saves; without it and accuracy, 0.9 of the guaranteed step
            limit.
        rule: quadrature rule; verlet, or the one that accuracy chooses, without it.
        accuracy: largest wanted error of positions from steps in time, relative to the extent of the model, instead of
            dt: step and, if it is not given, rule are chosen; run.why tells how.
        save_every: time between saved frames [s]; a hundredth of the run without it.
        initial: rod or its name -> position, rotation, velocity, angular_velocity (body frame), momentum,
            angular_momentum (per length, Γ⁰ and Π⁰ of the paper); arrays for all nodes or functions of s.
        rotation: "quaternion" or "matrix".
        balance: keep account of the work of loads, for run.energy_balance; with damping and other forces beside the
            Lagrangian it is kept anyway.
        allow_unstable: run even with a step over the limit.
        progress: called with (fraction done, time [s]) now and then.

    Returns: the Trajectory.

    Raises:
        ValueError: if an argument does not fit, dt is over the step limit, or no rule reaches the accuracy.
        SimulationError: if a step is not solved or the motion blows up.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014).
    """
    if not isinstance(model, Model):
        raise TypeError(
            f"simulate: {model!r} is no Model; for a Lagrangian of your own use cy.compile and cy.integrate"
        )
    if rule is not None and not isinstance(rule, Rule):
        raise TypeError(f"simulate: rule is {rule!r}; give one of cy.rules, such as cy.rules.verlet")
    begin = _beginning(model, rotation, initial, balance=balance)

    def run(rule: Rule, dt: float | None) -> Trajectory:
        system, state = begin(rule)
        parts = dict(zip(model.names, spans(model, rule.degree), strict=True))
        options: dict[str, Any] = {"allow_unstable": allow_unstable, "progress": progress}
        return _run(system, state, t_end, dt, save_every, **options, model=model, parts=parts)

    if accuracy is None:
        return run(rule or rules.verlet, dt)
    _check_accuracy(accuracy, dt)
    task = _task(begin, t_end, save_every, accuracy, rule or CANDIDATES[0], model)
    return _run_chosen(task, _candidates(rule, begin), run)


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
    begin = _beginning(model, rotation, initial)
    task = _task(begin, t_end, save_every, accuracy, rule or CANDIDATES[0], model)
    return choose(task, _candidates(rule, begin), thorough=True)


def integrate(
    system: System,
    start: Mapping[str, Any] | State,
    t_end: float,
    dt: float | None = None,
    *,
    accuracy: float | None = None,
    save_every: float | None = None,
    t_start: float = 0.0,
    allow_unstable: bool = False,
    progress: Callable[[float, float], None] | None = None,
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
        allow_unstable: run even with a step over the limit.
        progress: called with (fraction done, time [s]) now and then.

    Returns: the Trajectory.

    Raises:
        ValueError: if the start or another argument does not fit, dt is over the step limit, or the accuracy is not
            reached.
        SimulationError: if a step is not solved or the motion blows up.
    """
    if not isinstance(system, System):
        raise TypeError(f"integrate: {system!r} is no compiled system; make one with cy.compile(lagrangian, rule=...)")
    if isinstance(start, State):
        state = _fitting(system, start)
    else:
        values, velocity = _start(system, start)
        state = _consistent(system, initial_state(system, values, velocity, time=t_start))

    def run(rule: Rule, dt: float | None) -> Trajectory:
        return _run(system, state, t_end, dt, save_every, allow_unstable=allow_unstable, progress=progress)

    rule = system.equations.rule
    if accuracy is None:
        return run(rule, dt)
    _check_accuracy(accuracy, dt)
    return _run_chosen(_task(lambda _: (system, state), t_end, save_every, accuracy, rule), [rule], run)


def _beginning(
    model: Model, rotation: str, initial: Mapping[Any, Mapping[str, Any]] | None, *, balance: bool = False
) -> Callable[[Rule], tuple[System, State]]:
    """A function that makes system and start for a rule, once for each."""

    @functools.cache
    def begin(rule: Rule) -> tuple[System, State]:
        system = discretize(model, rule, rotation=rotation, account=balance)
        values, velocity, momenta = initial_values(model, system, initial or {})
        state = initial_state(system, values, velocity)
        given = np.isfinite(momenta) & system.free
        state = replace(state, momenta=np.where(given, momenta, state.momenta))
        return system, _consistent(system, state, check_rates=not given.any())

    return begin


def _check_accuracy(accuracy: Any, dt: float | None) -> None:
    if dt is not None:
        raise ValueError(f"dt = {dt!r} and accuracy = {accuracy!r} are given; give one of them")
    if isinstance(accuracy, bool) or not isinstance(accuracy, int | float | np.floating) or not 1e-12 < accuracy < 0.5:
        raise ValueError(f"accuracy is {accuracy!r}; give a number between 1e-12 and 0.5, such as 1e-3")


def _candidates(rule: Rule | None, begin: Callable[[Rule], tuple[System, State]]) -> tuple[Rule, ...]:
    if rule is not None:
        return (rule,)
    forced = begin(CANDIDATES[0])[0].equations.density.force is not None
    return tuple(r for r in CANDIDATES if not (forced and r.implicit))  # implicit rules take no such forces yet


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
    span = _span(state, t_end)
    starts = [load.start for load in (model.loads if model else ()) if not isinstance(load, Gravity)]
    return Task(
        begin=begin,
        nodes=system.size,
        span=span,
        save_every=_spacing(save_every, span),
        accuracy=accuracy,
        loads=seconds_of_loads(system),
        constrained=system.equations.density.constraints.numel() > 0,
        busy_after=max((start for start in starts if start < t_end), default=0.0),
    )


def _run_chosen(task: Task, rules: Sequence[Rule], run: Callable[[Rule, float | None], Trajectory]) -> Trajectory:
    """Choose and run; where a run stops that its trials promised, choose again by trials of whole runs."""
    told = ""
    for attempt in range(ATTEMPTS):
        choice = choose(task, rules)
        best = choice.best
        try:
            trajectory = run(best.rule, best.dt)
        except SimulationError as error:
            if attempt == ATTEMPTS - 1:
                raise
            told = f" Before, {best.rule} with dt = {best.dt:.3g} s stopped at t = {error.partial.time[-1]:.3g} s."
            task = replace(task, whole=True, limits={**task.limits, best.rule: 0.5 * best.dt})
        else:
            break
    trajectory.info |= {"error_estimate": best.error, "why": choice.why + told}
    return trajectory


def _span(state: State, t_end: float) -> float:
    span = _positive("t_end", t_end, "s") - state.time
    if span <= 0.0:
        raise ValueError(f"t_end is {t_end:g} s, the start is at {state.time:g} s; t_end must be later")
    return span


def _spacing(save_every: float | None, span: float) -> float:
    return span / 100.0 if save_every is None else min(_positive("save_every", save_every, "s"), span)


def _run(
    system: System,
    state: State,
    t_end: float,
    dt: float | None,
    save_every: float | None,
    *,
    allow_unstable: bool,
    progress: Callable[[float, float], None] | None,
    model: Model | None = None,
    parts: Mapping[str, slice] | None = None,
) -> Trajectory:
    span = _span(state, t_end)
    save_every = _spacing(save_every, span)
    step = _step_size(system, state, dt, span, allow_unstable=allow_unstable)
    plan = schedule(span, step, save_every)
    state = state.at_step(plan.h)
    begin, received = state, [_Block.of(system, state)]
    stepper = stepper_of(system)

    def receive(stride: int, values: np.ndarray, momenta: np.ndarray, work: np.ndarray | None = None) -> None:
        numbers = received[-1].steps[-1] + stride * (1 + np.arange(len(values)))
        received.append(_Block(numbers, values, momenta, work))

    stepper.prepare(system)
    started = clock.perf_counter()
    result = Result(Outcome.FINISHED, state, state.step)
    for stride, saves in ((plan.stride, plan.saves), (plan.rest, 1)):
        if stride and saves and result.outcome is Outcome.FINISHED:
            keep = functools.partial(receive, stride)
            result = stepper.run(system, result.state, stride=stride, saves=saves, receive=keep, progress=progress)
    info = {"wall_time": clock.perf_counter() - started, "t_end": t_end, "save_every": save_every}
    steps = np.concatenate([block.steps for block in received])
    frames = Frames(
        times=begin.origin + steps * begin.h,
        steps=steps,
        values=np.concatenate([block.values for block in received]),
        momenta=np.concatenate([block.momenta for block in received]),
        origin=begin.origin,
        h=begin.h,
        memory=result.state.memory,
        work=_work(received),
    )
    trajectory = Trajectory(system=system, frames=frames, info=info, model=model, parts=parts)
    if result.outcome is not Outcome.FINISHED:
        raise SimulationError(_explain(system, result, trajectory), trajectory)
    return trajectory


@dataclass(frozen=True, slots=True)
class _Block:
    """Frames received from one call of the driver."""

    steps: np.ndarray
    values: np.ndarray
    momenta: np.ndarray
    work: np.ndarray | None = None

    @classmethod
    def of(cls, system: System, state: State) -> "_Block":
        work = None if state.work is None else state.work[None]
        return cls(np.array([state.step]), state.values[None], state.momenta[None], work)


def _work(blocks: Sequence[_Block]) -> np.ndarray | None:
    """Work and loss at all frames; none at the start, unless the run goes on from one that had some."""
    found = [block.work for block in blocks if block.work is not None]
    if not found:
        return None
    shape = found[-1].shape[1:]
    return np.concatenate([np.zeros((len(b.steps), *shape)) if b.work is None else b.work for b in blocks])


def _step_size(system: System, state: State, dt: float | None, span: float, *, allow_unstable: bool) -> float:
    """The step asked for, or one from the limit."""
    if dt is not None:
        _positive("dt", dt, "s")
        if allow_unstable:
            return dt
    elif state.h > 0.0:
        return state.h  # go on as if the run had never stopped
    limit = system.stable_dt(state, enough=math.inf if dt is None else dt)
    if dt is None:
        if not math.isfinite(limit):
            raise ValueError(f"{_name(system)} has no step limit under the rule {system.equations.rule}; give dt [s]")
        return min(SAFETY * limit, span)
    if dt > limit:
        raise ValueError(
            f"dt is {dt:.4g} s, over the step limit {limit:.4g} s of the rule {system.equations.rule} for this system; "
            f"give a smaller dt, leave it out, or insist with allow_unstable=True"
        )
    return dt


def _explain(system: System, result: Result, trajectory: Trajectory) -> str:
    h = trajectory.frames.h
    time = trajectory.frames.origin + result.step * h
    node = ""
    if result.node >= 0 and "length" in system.named:
        place = result.node
        for name, nodes in trajectory._parts.items():
            if nodes.start <= result.node < nodes.stop:
                node, place = f" of {name}", result.node - nodes.start
        node = f" at node {place}{node}"
    if result.outcome is Outcome.REDUNDANT:
        return f"stopped at t = {time:.6g} s (step {result.step}){node}: {result.outcome.value}; hold less"
    limit = system.stable_dt(result.state) if np.isfinite(result.state.values).all() else math.nan
    remedy = (
        f"give dt below {0.5 * h:.3g} s"
        if not limit < h
        else f"dt is over the step limit {limit:.3g} s there: give less"
    )
    return (
        f"stopped at t = {time:.6g} s (step {result.step}){node}: {result.outcome.value}{_history(result)}; {remedy}. "
        f"The last good frame, t = {trajectory.time[-1]:.6g} s, and those before are in the exception's .partial"
    )


def _history(result: Result) -> str:
    """The last iterations of a step that was not solved."""
    if result.history is None or result.outcome is not Outcome.NOT_CONVERGED:
        return ""
    told = [f"{size:.1e} ({residual:.1e})" for size, residual in result.history if math.isfinite(residual)]
    return f" (relative corrections and residuals in N s or N m s at last: {', '.join(told)})" if told else ""


def _consistent(system: System, state: State, *, check_rates: bool = True) -> State:
    """A start that agrees with the constraints of the density, its momenta projected.

    Raises:
        ValueError: if positions violate a constraint, velocities do, or a constraint is redundant.
    """
    if not system.equations.density.constraints.numel():
        return state
    from cayley.steppers.constrained_run import projected, violation

    found = np.abs(violation(system, state.values)).max(axis=1)
    worst = int(np.argmax(found))
    where = f"the start violates the constraint of {_name(system)} in the element at s = {system.nodes[worst]:.6g} m"
    if not found[worst] <= START_TOLERANCE:
        raise ValueError(f"{where} by {found[worst]:.3g}; give positions and rotations for which it is zero")
    momenta, node = projected(system, state)
    if node >= 0:
        raise ValueError(
            f"at node {node} of the model: {Outcome.REDUNDANT.value}; hold less or give another kinematics"
        )
    change = np.abs(momenta - state.momenta).max(axis=0)
    scale = np.abs(state.momenta).max(axis=0)
    if check_rates and np.any(change > 1e-6 * scale.max(initial=0.0)):
        worst = int(np.argmax(np.abs(momenta - state.momenta).max(axis=1)))
        raise ValueError(
            f"the velocities at the start violate the constraint of {_name(system)}, most at node {worst}; give "
            f"velocities that keep it, such as v = v0 + w x r with the angular velocity w, or momenta, which are "
            f"projected"
        )
    return replace(state, momenta=momenta)


def _fitting(system: System, state: State) -> State:
    """The state, if it can be one of the system."""
    sizes = (system.size, system.layout.rows), (system.size, system.layout.dofs)
    if (state.values.shape, state.momenta.shape) != sizes:
        raise ValueError(
            f"start is a state of values {state.values.shape} and momenta {state.momenta.shape}, of another system or "
            f"rotation form; this one has values {sizes[0]} and momenta {sizes[1]}"
        )
    return state


def _start(system: System, start: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Values and velocities of all nodes from a mapping by field."""
    layout = system.layout
    values, velocity = system.reference.copy(), np.zeros((system.size, layout.dofs))
    allowed = [name + suffix for name in layout.fields for suffix in ("", "_t")]
    for key, given in start.items():
        if key not in allowed:
            raise ValueError(f"start names {key!r}; give {', '.join(allowed)}")
        name = key.removesuffix("_t") if key not in layout.fields else key
        turns = name in layout.rotations and key == name
        width = 4 if turns else layout.dofs_of(name).stop - layout.dofs_of(name).start
        try:
            array = np.broadcast_to(np.asarray(given, dtype=float), (system.size, width))
        except (TypeError, ValueError):
            raise ValueError(
                f"start[{key!r}] has shape {np.shape(given)}; give ({system.size}, {width}) or ({width},)"
            ) from None
        if not np.all(np.isfinite(array)):
            raise ValueError(f"start[{key!r}] has an entry that is not finite")
        if key != name:
            velocity[:, layout.dofs_of(name)] = array
        elif turns:
            length = np.linalg.norm(array, axis=1, keepdims=True)
            if np.any(np.abs(length - 1.0) > 1e-6):
                raise ValueError(f"start[{key!r}]: quaternions must have length 1, one has {length.max():.6g}")
            values[:, layout.rows_of(name)] = layout.representation.from_quaternion(array / length)
        else:
            values[:, layout.rows_of(name)] = array
    missing = [
        n for n in layout.fields if n not in start and n not in layout.rotations and "length" not in system.named
    ]
    if missing:
        raise ValueError(
            f"start does not give {missing[0]}; give its values, shape ({layout.fields[missing[0]].size},)"
        )
    return values, velocity


def _positive(name: str, value: Any, unit: str) -> float:
    if (
        isinstance(value, bool)
        or not isinstance(value, int | float | np.floating | np.integer)
        or not math.isfinite(value)
        or value <= 0
    ):
        raise ValueError(f"{name} is {value!r}; give a positive number [{unit}]")
    return float(value)


def _name(system: System) -> str:
    return f"Lagrangian {system.equations.density.lagrangian.name}"


__all__ = ["Choice", "Schedule", "SimulationError", "advise", "integrate", "schedule", "simulate"]
