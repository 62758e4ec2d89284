"""The largest step at which a rule reaches an accuracy, found by trials at falling steps."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from cayley.choice.costs import seconds_per_step
from cayley.choice.pilot import Track, differences, follow, frames_of
from cayley.choice.schedule import schedule
from cayley.discrete.rules import Rule
from cayley.system.system import State, System

SAFETY = 0.5
"""Part of the accuracy that an estimated error may take."""
SHARE = 0.3
"""Part of a run's cost that one trial may take; the window is shortened to that."""
FREE = 2.0
"""Cost of a trial that needs no shortening [s]."""
SHORTEST = 1 / 16
"""Shortest window, as a part of the run."""
STEEPEST = 2.0
"""Largest exponent of time with which errors are extrapolated from the window to the end."""
ORDER = 2
"""Order trusted in estimates: rules of higher order lose some of it where high frequencies are not resolved."""
LARGEST_FALL, SMALLEST_FALL = 8.0, 1.5
"""Factors by which the step may fall from trial to trial."""
FAR = 3.0
"""A longer fall is made in two parts."""
FIRST_FALL, LIMIT_FALL = 2.0, 1.25
"""Factors to the second trial: to look for the right step; to check the step limit, mostly small enough."""
ENOUGH = 1.15
"""Factor by which a step is smaller than expected to do."""
TRUSTED_FALL = 2.0
"""Two steps in a larger ratio tell no more about the smaller one than two in this: their difference may be chance."""
LIMIT_PART = 0.9
"""Part of the step limit of an explicit rule that is taken."""
PATIENCE, PATIENCE_SECONDS = 10.0, 6.0
"""A search ends where a run would cost this many times the cheapest run of the rule, and at least this [s]."""
IDLE, PLATEAU = 0.6, 2
"""A rule is given up after so many trials in turn that leave more than this part of the error estimated before."""
MOVED = 20.0
"""A window in which nothing moves by this many times the accuracy says nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """What is to be run.

    Args:
        begin: makes system and start state for a rule.
        nodes: number of nodes.
        span: length of the run [s].
        save_every: time between saves [s]; no step is longer.
        accuracy: largest wanted position error over the extent.
        loads: time to evaluate the loads once [s].
        busy_after: time from the start by which all loads have begun [s]; a window is longer.
        ties: time that joints, springs and constraints add to a step of a rule [s].
        whole: whether the window of every trial is the whole run.
        limits: upper bounds of the step of some rules [s], known from runs that stopped.
        known: trials made so far, by rule, step and frames.
        stable: step limits found so far [s].
    """

    begin: Callable[[Rule], tuple[System, State]]
    nodes: int
    span: float
    save_every: float
    accuracy: float
    loads: float = 0.0
    busy_after: float = 0.0
    ties: Callable[[Rule], float] = lambda rule: 0.0
    whole: bool = False
    limits: Mapping[Rule, float] = field(default_factory=dict)
    known: dict[tuple[Rule, float, int], Track | None] = field(default_factory=dict, compare=False, repr=False)
    stable: dict[Rule, float] = field(default_factory=dict, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Alternative:
    """A rule, and the step at which it is expected to be accurate enough.

    Args:
        rule: the rule.
        dt: step [s].
        steps: steps of the run.
        cost: expected wall time [s].
        error: expected largest position error over the extent; not a number where it is not known.
        reason: why it is out of the question, if it is.
        excessive: True if the reason is its cost.
    """

    rule: Rule
    dt: float
    steps: int
    cost: float
    error: float = math.nan
    reason: str = ""
    excessive: bool = False


def outlook(task: Task, rule: Rule) -> Alternative:
    """A rule at its largest step: the least that it costs."""
    return alternative(task, rule, first_step(task, rule))


def settle(task: Task, rule: Rule, *, bound: float = math.inf) -> Alternative:
    """Find the largest step with which a rule reaches the accuracy.

    Two trials with steps in the ratio ρ differ by d; as errors shrink at least like h², the smaller step has an error
    of at most d/(ρ² − 1), which is used for ρ up to 2. Steps fall until this error, extrapolated from the window to the
    end of the run, is half of what is wanted.

    Args:
        task: what is to be run.
        rule: the rule.
        bound: cost [s] from which on the rule is of no interest.

    Returns: the Alternative; with a reason if the rule does not get there.

    Source: error estimates by extrapolation, Hairer, Nørsett, Wanner (1993), section II.4.
    """
    wanted = SAFETY * task.accuracy
    h = first_step(task, rule)
    bound = min(bound, max(PATIENCE * outlook(task, rule).cost, PATIENCE_SECONDS))
    before: Track | None = None
    error = math.nan
    frames, failed, idle = 0, True, 0
    while alternative(task, rule, h).cost <= bound:
        track = trial(task, rule, h, frames)
        if track is None:
            before, h = None, 0.5 * h
            continue
        frames = track.frames
        if before is None:
            before, failed = track, False
            limited = not rule.implicit and 2.0 * h < task.span / frames_of(task.nodes)
            h = track.h / (LIMIT_FALL if limited else FIRST_FALL)
            continue
        ratio = before.h / track.h
        last, apart = error, expected_difference(task, before, track)
        error = apart / (min(ratio, TRUSTED_FALL) ** ORDER - 1.0)
        if error <= wanted:  # the step between the two at which the error is what is wanted
            step = min(before.h, track.h * (wanted / error) ** (1.0 / ORDER)) if error > 0.0 else before.h
            return alternative(task, rule, step, error=min(error * (step / track.h) ** ORDER, wanted))
        idle = idle + 1 if error > IDLE * last else 0
        if idle >= PLATEAU:
            told = f"still differs by {apart:.2g} between steps of {before.h:.2g} and {track.h:.2g} s"
            return alternative(task, rule, track.h, error=error, reason=told)
        before, h = track, track.h / _fall(apart / (ratio**ORDER - 1.0) / wanted, rule.order)
    told = f"takes over {bound:.2g} s{', longer steps fail' if failed else ''}"
    return alternative(task, rule, h, error=error, reason=told, excessive=True)


def _fall(excess: float, order: int) -> float:
    """Factor by which the next trial's step is smaller, from an error and what is wanted.

    A long way down ends at twice the step that is expected to do, so that the last two trials are close enough together
    to be trusted.
    """
    if not math.isfinite(excess):
        return LARGEST_FALL
    fall = ENOUGH * excess ** (1.0 / order)
    if fall > FAR:
        fall /= 2.0
    return min(max(fall, SMALLEST_FALL), LARGEST_FALL)


def first_step(task: Task, rule: Rule) -> float:
    """The largest step of a rule that is tried [s]: bound by its limit, and by the frames of the trials."""
    largest = min(task.span / frames_of(task.nodes), task.limits.get(rule, math.inf))
    if rule.implicit:
        return largest
    if rule not in task.stable:
        system, state = task.begin(rule)
        task.stable[rule] = system.stable_dt(state)
    return min(largest, LIMIT_PART * task.stable[rule])


def alternative(task: Task, rule: Rule, h: float, *, error: float = math.nan, **reason: Any) -> Alternative:
    """Step, steps and expected wall time of a whole run, with steps of h at most that meet the saves."""
    plan = schedule(task.span, min(h, task.save_every), task.save_every)
    cost = plan.steps * _per_step(task, rule)
    error *= (plan.h / h) ** ORDER
    return Alternative(rule=rule, dt=plan.h, steps=plan.steps, cost=cost, error=error, **reason)


def trial(task: Task, rule: Rule, h: float, least: int) -> Track | None:
    """Run the window at a step; one in which next to nothing moves is lengthened.

    Args:
        task: what is to be run.
        rule: the rule.
        h: the step [s].
        least: frames of a trial before, which this one is not to be shorter than.

    Returns: the Track, or None if a step was not solved or the motion blew up.
    """
    system, state = task.begin(rule)
    count = frames_of(task.nodes)
    whole = task.span / h * _per_step(task, rule)
    part = 1.0 if task.whole else max(SHARE, FREE / whole, SHORTEST)
    part = max(part, least / count, task.busy_after / task.span + SHORTEST)
    frames = min(count, math.ceil(part * count))
    while True:
        key = (rule, h, frames)
        if key not in task.known:
            task.known[key] = follow(system, state, task.span / count, frames, h)
        track = task.known[key]
        if track is None or frames == count:
            return track
        if track.moved > MOVED * task.accuracy:
            return track
        frames = min(2 * frames, count)


def expected_difference(task: Task, coarse: Track, fine: Track) -> float:
    """Largest distance of a node in two trials, over the extent, extrapolated to the end of the run.

    The exponent of its growth is that of the second half of the window, and at least 1.
    """
    grown = differences(coarse, fine)
    frames, count = len(grown) - 1, frames_of(task.nodes)
    if frames == count:
        return float(grown[-1])
    half = grown[frames // 2]
    power = math.log2(grown[-1] / half) if 0.0 < half < grown[-1] < math.inf else 1.0
    return float(grown[-1]) * (count / frames) ** min(max(power, 1.0), STEEPEST)


def _per_step(task: Task, rule: Rule) -> float:
    """Expected wall time of a step [s]."""
    evaluations = len(rule.time.at) if rule.implicit else 1
    return seconds_per_step(rule, task.nodes) + task.ties(rule) + evaluations * task.loads
