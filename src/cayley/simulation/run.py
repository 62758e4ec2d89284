"""The run from one save to the next: its step, the frames it leaves, and where it stops."""

import functools
import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.choice.pilot import stepper_of
from cayley.choice.schedule import schedule
from cayley.model import Model
from cayley.results.observe import Frames
from cayley.results.trajectory import Trajectory
from cayley.simulation.failure import SimulationError, explain, name_of
from cayley.steppers.outcome import Outcome, Result
from cayley.system.system import State, System

SAFETY = 0.9
"""Part of the step limit that is taken when no step is given."""


def run(
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
    """Run a system from a state, by equal steps that meet the saves.

    Args:
        system: the system.
        state: the start.
        t_end: end of the run [s].
        dt: upper bound of the step [s]; None takes that of the state, or one from the step limit.
        save_every: time between saved frames [s], or None.
        allow_unstable: run even with a step over the limit.
        progress: called with (fraction done, time [s]) now and then.
        model: the model that the system is of, if any.
        parts: nodes of its rods by name.

    Returns: the Trajectory.

    Raises:
        ValueError: if a time or the step does not fit.
        SimulationError: if a step is not solved or the motion blows up.
    """
    span = span_of(state, t_end)
    save_every = spacing_of(save_every, span)
    step = _step_size(system, state, dt, span, allow_unstable=allow_unstable)
    plan = schedule(span, step, save_every)
    begin = state.at_step(plan.h)
    received = [_Block.of(begin)]
    stepper = stepper_of(system)

    def receive(stride: int, values: np.ndarray, momenta: np.ndarray, **more: np.ndarray) -> None:
        numbers = received[-1].steps[-1] + stride * (1 + np.arange(len(values)))
        received.append(_Block(numbers, values, momenta, **more))

    stepper.prepare(system)
    started = clock.perf_counter()
    result = Result(Outcome.FINISHED, begin, begin.step)
    for stride, saves in ((plan.stride, plan.saves), (plan.rest, 1)):
        if stride and saves and result.outcome is Outcome.FINISHED:
            keep = functools.partial(receive, stride)
            result = stepper.run(system, result.state, stride=stride, saves=saves, receive=keep, progress=progress)
    info = {"wall_time": clock.perf_counter() - started, "t_end": t_end, "save_every": save_every}
    frames = _frames(received, begin, result.state.memory)
    trajectory = Trajectory(system=system, frames=frames, info=info, model=model, parts=parts)
    if result.outcome is not Outcome.FINISHED:
        raise SimulationError(explain(system, result, trajectory), trajectory)
    return trajectory


@dataclass(frozen=True, slots=True)
class _Block:
    """Frames received from one call of the driver."""

    steps: np.ndarray
    values: np.ndarray
    momenta: np.ndarray
    work: np.ndarray | None = None
    rates: np.ndarray | None = None

    @classmethod
    def of(cls, state: State) -> "_Block":
        work = None if state.work is None else state.work[None]
        return cls(np.array([state.step]), state.values[None], state.momenta[None], work)


def _frames(blocks: Sequence[_Block], start: State, memory: np.ndarray | None) -> Frames:
    steps = np.concatenate([block.steps for block in blocks])
    return Frames(
        times=start.origin + steps * start.h,
        steps=steps,
        values=np.concatenate([block.values for block in blocks]),
        momenta=np.concatenate([block.momenta for block in blocks]),
        origin=start.origin,
        h=start.h,
        memory=memory,
        work=_of_all(blocks, "work", 0.0),
        rates=_of_all(blocks, "rates", np.nan),
    )


def _of_all(blocks: Sequence[_Block], name: str, otherwise: float) -> np.ndarray | None:
    """What steppers said of their frames, at all frames; of those they did not make, such as the first, otherwise."""
    found = [(len(block.steps), getattr(block, name)) for block in blocks]
    shape = next((given.shape[1:] for _, given in reversed(found) if given is not None), None)
    if shape is None:
        return None
    return np.concatenate([np.full((count, *shape), otherwise) if given is None else given for count, given in found])


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
    span = _positive("t_end", t_end, "s") - state.time
    if span <= 0.0:
        raise ValueError(f"t_end is {t_end:g} s, the start is at {state.time:g} s; t_end must be later")
    return span


def spacing_of(save_every: float | None, span: float) -> float:
    """Time between saves [s]: what is given, within the run, or a hundredth of it."""
    return span / 100.0 if save_every is None else min(_positive("save_every", save_every, "s"), span)


def _positive(name: str, value: Any, unit: str) -> float:
    if (
        isinstance(value, bool)
        or not isinstance(value, int | float | np.floating | np.integer)
        or not math.isfinite(value)
        or value <= 0
    ):
        raise ValueError(f"{name} is {value!r}; give a positive number [{unit}]")
    return float(value)
