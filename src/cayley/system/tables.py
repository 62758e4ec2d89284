"""Loads that depend on time alone, evaluated for many steps at once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx
from cayley.model.loads import LineLoad, PointLoad

INSTANT = 1e-9
"""Time that a load must act around a single instant to count in full there [s]."""


@dataclass(frozen=True, slots=True)
class TimeTable:
    """Values of loads at the times of steps, or (h = 0) at instants.

    A load acts on a node with the part of the step around it, [t − h/2, t + h/2], that lies in its window: so a
    constant force gives its exact impulse whatever the step. One that starts with the run acts from its first moment.

    Args:
        loads: the loads, three columns each.
        functions: their values, as functions of an array of times.
    """

    loads: Sequence[PointLoad | LineLoad]
    functions: Sequence[Callable[[np.ndarray], np.ndarray]]

    def at_stages(self, times: np.ndarray, h: float, origin: float) -> np.ndarray:
        """Values at the stages of steps, shape (steps, stages) -> (steps, stages, 3 × loads).

        A load counts with the part of the step that lies in its window.
        """
        steps, stages = times.shape
        found = np.zeros((steps, stages, 3 * len(self.loads)))
        begin = times.mean(axis=1) - 0.5 * h
        for k, (load, function) in enumerate(zip(self.loads, self.functions, strict=True)):
            start = -np.inf if load.start <= origin else load.start
            outside = np.maximum(start - begin, 0.0) + np.maximum(begin + h - load.until, 0.0)
            part = np.clip(1.0 - outside / h, 0.0, 1.0)  # 1 inside, though h may be close to rounding errors of begin
            part[part < 1e-9] = 0.0
            on = np.flatnonzero(part)
            if len(on):
                values = function(np.clip(times[on].reshape(-1), load.start, load.until))
                found[on, :, 3 * k : 3 * k + 3] = part[on, None, None] * values.reshape(len(on), stages, 3)
        return found

    def __call__(self, times: np.ndarray, h: float, origin: float) -> np.ndarray:
        """Values at times [s], shape (m, 3 × loads)."""
        h = h or INSTANT
        found = np.zeros((len(times), 3 * len(self.loads)))
        first = np.where(times > origin + 1e-6 * h, times - 0.5 * h, times)  # the run begins with half a step
        for k, (load, function) in enumerate(zip(self.loads, self.functions, strict=True)):
            start = -np.inf if load.start <= origin else load.start
            outside = np.maximum(start - first, 0.0) + np.maximum(times + 0.5 * h - load.until, 0.0)
            part = np.clip(1.0 - outside / (times + 0.5 * h - first), 0.0, 1.0)
            part[part < 1e-9] = 0.0  # a window that ends on a step, up to rounding
            on = np.flatnonzero(part)
            if len(on):
                inner = np.clip(times[on], load.start, load.until)
                found[on, 3 * k : 3 * k + 3] = part[on, None] * function(inner)
        return found


def time_table(loads: Sequence[PointLoad | LineLoad]) -> TimeTable:
    """Prepare loads for evaluation at many times."""
    return TimeTable(tuple(loads), tuple(_function(load) for load in loads))


def _function(load: PointLoad | LineLoad) -> Callable[[np.ndarray], np.ndarray]:
    if not callable(load.value):
        constant = np.asarray(load.value, dtype=float)
        return lambda times: np.broadcast_to(constant, (len(times), 3))
    one_by_one = _one_by_one(load)
    traced = _traced(load.value)
    if traced is None:
        return one_by_one
    last = load.until if np.isfinite(load.until) else load.start + 1.0
    probes = np.linspace(load.start, last, 7)[:-1]
    expected = one_by_one(probes)
    if not np.allclose(traced(probes), expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max(initial=0.0)):
        return one_by_one
    return traced


def _one_by_one(load: PointLoad | LineLoad) -> Callable[[np.ndarray], np.ndarray]:
    return lambda times: np.array([load.value_at(float(t)) for t in times]).reshape(-1, 3)


def _traced(value: Callable[[Any], Any]) -> Callable[[np.ndarray], np.ndarray] | None:
    """The function as an expression of time, or None where it can't be one (it branches, reads a table, ...)."""
    t = symbols("t")
    try:
        expression = ca.densify(to_sx(value(t)))
        if expression.numel() != 3 or any(s.name() != "t" for s in ca.symvar(expression)):
            return None
        function = ca.Function("load", [to_sx(t)], [expression])
    except Exception:  # whatever a user's function does with a symbol, calling it with numbers is the way out
        return None
    return lambda times: np.array(function(times[None, :])).T
