"""Prescribed motion: functions of the time, and tables to be interpolated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.model import validate
from cayley.model.validate import Array

__all__ = ["INTERPOLATIONS", "Motion", "Table", "motion", "shown_motion"]

INTERPOLATIONS = ("cubic", "linear")


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Values at some times, and what lies between them; outside, the first and the last.

    Attributes:
        times: rising [s], shape (m,), at least two.
        values: at these times, shape (m,) or (m, 3).
        interpolation: "cubic" (a spline that rests at its ends: twice differentiable) or "linear".

    Raises:
        TypeError: not numbers.
        ValueError: shapes that do not fit, times that do not rise, or another interpolation.
    """

    times: Array
    values: Array
    interpolation: str = "cubic"

    def __post_init__(self) -> None:
        """Check and freeze the numbers."""
        times = validate.array("Table", "times", self.times, (-1,), "at least two rising times [s]")
        if len(times) < 2 or np.any(np.diff(times) <= 0.0):
            raise ValueError(validate.wrong("Table", "times", self.times, "at least two rising times [s]"))
        width = (-1,) if np.ndim(self.values) == 1 else (-1, 3)
        right = f"{len(times)} numbers, or rows of three, one for each time"
        values = validate.array("Table", "values", self.values, width, right)
        if len(values) != len(times):
            raise ValueError(validate.wrong("Table", "values", self.values, right))
        validate.option("Table", "interpolation", self.interpolation, INTERPOLATIONS)
        object.__setattr__(self, "times", validate.frozen(times))
        object.__setattr__(self, "values", validate.frozen(values))

    def __call__(self, t: Any) -> Array:
        """The values at one time or several [s], shape (..., ) or (..., 3)."""
        from scipy.interpolate import CubicSpline, interp1d  # slow to import, and seldom needed

        at = np.clip(np.asarray(t, dtype=float), self.times[0], self.times[-1])
        if self.interpolation == "linear":
            return np.asarray(interp1d(self.times, self.values, axis=0)(at), dtype=float)
        return np.asarray(CubicSpline(self.times, self.values, axis=0, bc_type="clamped")(at), dtype=float)


Motion = Table | Callable[[float], Any]


def motion(owner: str, name: str, value: Any, size: int, unit: str) -> Motion | None:
    """A prescribed motion as given, or a Table of a pair (times, values); None stays None.

    Args:
        owner: the object, for the message.
        name: the parameter, for the message.
        value: what was given.
        size: 1 for a number at each time, 3 for a vector.
        unit: for the message.

    Raises:
        TypeError: neither a function nor a table.
        ValueError: a table that does not fit.
    """
    if value is None:
        return None
    what = "a number" if size == 1 else "3 numbers"
    right = f"a function of the time [s] that returns {what} [{unit}], or (times, values)"
    if isinstance(value, tuple) and len(value) == 2 and not callable(value):
        try:
            value = Table(*value)
        except (TypeError, ValueError) as error:
            raise type(error)(f"{owner}: {name}: {error}") from None
    if isinstance(value, Table):
        if value.values.ndim != (1 if size == 1 else 2):
            raise ValueError(f"{owner}: {name} is a table of shape {value.values.shape}, but must be {right}")
        return value
    if not callable(value):
        raise TypeError(validate.wrong(owner, name, value, right))
    made: Motion = value
    return made


def motion_at(owner: str, name: str, given: Motion, times: Array, size: int) -> Array:
    """Values of a motion at times [s], shape (m, size).

    Raises:
        TypeError: the function did not return numbers.
        ValueError: not as many as wanted, or not finite ones.
    """
    if isinstance(given, Table):
        return given(times).reshape(len(times), size)
    right = "a finite number" if size == 1 else f"{size} finite numbers"
    found = np.empty((len(times), size))
    for k, t in enumerate(times.tolist()):
        value = given(t)
        shaped = np.reshape(value, (1,)) if size == 1 and np.size(value) == 1 else value
        found[k] = validate.array(owner, f"{name}(t = {t:g} s)", shaped, (size,), right)
    return found


def shown_motion(given: Motion) -> str:
    """What a listing says of it."""
    if isinstance(given, Table):
        return (
            f"table of {len(given.times)} times, {given.times[0]:g} s to {given.times[-1]:g} s, {given.interpolation}"
        )
    return f"function {getattr(given, '__name__', type(given).__name__)}"
