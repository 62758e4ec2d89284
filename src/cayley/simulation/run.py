"""The run from one save to the next: its step, the frames it leaves, and where it stops."""

import contextlib
import functools
import logging
import math
import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from cayley.choice.pilot import stepper_of
from cayley.choice.schedule import Schedule
from cayley.model import Model
from cayley.results.append import about_run
from cayley.results.contact import warn_of_depth
from cayley.results.outline import Outline
from cayley.results.residual import residual_speed
from cayley.results.trajectory import Trajectory
from cayley.results.writer import Writer, begin_store, finish
from cayley.simulation.failure import Interrupted, SimulationError, explain, name_of
from cayley.simulation.record import Record
from cayley.simulation.saves import Saves, positive
from cayley.steppers.contacts import at_start
from cayley.steppers.outcome import Outcome, Result
from cayley.system.system import State, System

_log = logging.getLogger("cayley.run")

SAFETY = 0.9
"""Part of the step limit that is taken when no step is given."""


@dataclass(frozen=True, slots=True)
class Calm:
    """When a run has come to rest: at no frame for some time a node was faster than the tolerance.

    Args:
        tolerance: of the largest speed of a node over the length of its rod [1/s].
        time: for how long [s].
    """

    tolerance: float
    time: float


def run(
    system: System,
    state: State,
    t_end: float,
    dt: float | None,
    saves: Saves,
    *,
    allow_unstable: bool = False,
    progress: Callable[[float, float], None] | None = None,
    watch: Callable[[System, State], None] | None = None,
    model: Model | None = None,
    parts: Mapping[str, slice] | None = None,
    resumed: bool = False,
    calm: Calm | None = None,
) -> Trajectory:
    """Run a system from a state, by equal steps that meet the saves.

    Args:
        system: the system.
        state: the start.
        t_end: end of the run [s].
        dt: upper bound of the step [s]; None takes that of the state, or one from the step limit.
        saves: when and where frames are saved.
        allow_unstable: run even with a step over the limit.
        progress: called with (fraction done, time [s]) now and then.
        watch: called with the system and its state then.
        model: the model that the system is of, if any.
        parts: nodes of its rods by name.
        resumed: whether the store has the frames up to the start already.
        calm: end at rest.

    Returns: the Trajectory.

    Raises:
        ValueError: if a time or the step does not fit.
        FileExistsError: if something is where the store is to be.
        SimulationError: if a step is not solved or the motion blows up.
        Interrupted: on Ctrl-C; what was saved is in its ``partial``.
    """
    span = span_of(state, t_end)
    step = _step_size(system, state, dt, span, allow_unstable=allow_unstable)
    plan = saves.schedule(state.time, span, step)
    begin = state.at_step(plan.h)
    stepper_of(system).prepare(system)
    info: dict[str, Any] = {"t_end": t_end, **saves.info()}
    store = None if saves.store is None else _writer(system, begin, plan, saves, info, model, parts, resumed=resumed)
    known = resumed and (store is None or store.done > 0)
    record = Record(begin, store, known=known, contact=None if known else at_start(system, begin.values, begin.h))
    facts = {"rule": str(system.equations.rule), "dt": begin.h, "nodes": system.size, "store": str(saves.store or "")}
    _log.info(
        "run of %s: %d steps of %.3g s from t = %.6g s", name_of(system), plan.steps, plan.h, begin.time, extra=facts
    )
    started, result = clock.perf_counter(), None
    moving = None if calm is None else _Moving(calm, system, model, parts or {})
    with contextlib.suppress(KeyboardInterrupt):
        result = _through(plan, system, begin, record, progress, watch, moving)
    if store is not None:
        record.close()
    info = {"wall_time": clock.perf_counter() - started, **info}
    trajectory = _trajectory(system, record, result, info, model, parts)
    ended = "stopped by hand" if result is None else result.outcome.name.lower()
    _log.info("%s after %.3g s, t = %.6g s", ended, info["wall_time"], trajectory.time[-1], extra=facts)
    if result is None:
        raise Interrupted(trajectory)
    if result.outcome is not Outcome.FINISHED:
        raise SimulationError(explain(system, result, trajectory), trajectory, too_fast=result.outcome.hasty)
    warn_of_depth(trajectory)
    return trajectory


def _writer(
    system: System,
    begin: State,
    plan: Schedule,
    saves: Saves,
    info: Mapping[str, Any],
    model: Model | None,
    parts: Mapping[str, slice] | None,
    *,
    resumed: bool,
) -> Writer:
    """What writes into the store of a run, which is made if the run is not resumed."""
    assert saves.store is not None
    if not resumed:
        outline = Outline.of(system)
        about = about_run(outline, parts or {}, model, begin.h, begin.origin, saves.only)
        options: dict[str, Any] = {"expected": plan.frames, "only": saves.only, "overwrite": saves.overwrite}
        begin_store(saves.store, outline, about, {"wall_time": 0.0, **info}, **options)
    return Writer(saves.store, system, model, begin.h, begin.origin, only=saves.only)


def _trajectory(
    system: System,
    record: Record,
    result: Result | None,
    info: Mapping[str, Any],
    model: Model | None,
    parts: Mapping[str, slice] | None,
) -> Trajectory:
    """What a run left, in memory or in its store; the result is None if it was stopped by hand."""
    if record.writer is None:
        frames = record.frames(None if result is None else result.state.memory)
        return Trajectory(system=system, frames=frames, info=info, model=model, parts=parts)
    finish(record.writer.path, system, record.writer.outline, info)
    trajectory = Trajectory.open(record.writer.path, model=model)
    trajectory.__dict__["system"] = system  # compiled already
    return trajectory


def _through(
    plan: Schedule,
    system: System,
    begin: State,
    record: Record,
    progress: Callable[[float, float], None] | None,
    watch: Callable[[System, State], None] | None,
    moving: "_Moving | None" = None,
) -> Result:
    """Run all strides of a plan, in calls of bounded time; where rest is looked for, frame by frame."""
    stepper, result = stepper_of(system), Result(Outcome.FINISHED, begin, begin.step)
    for stride, frames in plan.pieces:
        done = 0
        while done < frames and result.outcome is Outcome.FINISHED:
            count = record.most(frames - done) if moving is None else 1
            called = clock.perf_counter()
            keep = functools.partial(record.receive, stride)
            result = stepper.run(system, result.state, stride=stride, saves=count, receive=keep)
            record.called(result.state, clock.perf_counter() - called)
            done += count
            if progress is not None:
                progress((result.state.step - begin.step) / plan.steps, result.state.time)
            if watch is not None:
                watch(system, result.state)
            if moving is not None and result.outcome is Outcome.FINISHED and not moving(result.state):
                return result
    return result


class _Moving:
    """Whether a system still moves, asked at one frame after the other."""

    def __init__(self, calm: Calm, system: System, model: Model | None, parts: Mapping[str, slice]) -> None:
        self.calm, self.about, self.since = calm, (system, model, parts), math.inf

    def __call__(self, state: State) -> bool:
        system, model, parts = self.about
        if residual_speed(system, state, model, parts) > self.calm.tolerance:
            self.since = math.inf
        else:
            self.since = min(self.since, state.time)
        return state.time - self.since < self.calm.time


def _step_size(system: System, state: State, dt: float | None, span: float, *, allow_unstable: bool) -> float:
    """The step asked for, or one from the limit."""
    if dt is not None:
        positive("dt", dt, "s")
        if allow_unstable:
            return dt
    elif state.h > 0.0:
        return state.h  # go on as if the run had never stopped
    limit = system.stable_dt(state, enough=math.inf if dt is None else dt)
    if dt is None:
        if not math.isfinite(limit):
            raise ValueError(f"{name_of(system)} has no step limit under the rule {system.equations.rule}; give dt [s]")
        return min(SAFETY * limit, span)
    if dt > limit:
        raise ValueError(
            f"dt is {dt:.4g} s, over the step limit {limit:.4g} s of the rule {system.equations.rule} for this system; "
            f"give a smaller dt, leave it out, or insist with allow_unstable=True"
        )
    return dt


def span_of(state: State, t_end: float) -> float:
    """Length of a run [s]."""
    span = positive("t_end", t_end, "s") - state.time
    if span <= 0.0:
        raise ValueError(f"t_end is {t_end:g} s, the start is at {state.time:g} s; t_end must be later")
    return span
