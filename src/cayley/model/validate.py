"""Checks shared by the model: every refusal is one line with the object, the parameter, the value and what is right."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Triple = tuple[float, float, float]
Mask = tuple[bool, bool, bool]

AXES = "xyz"


def wrong(owner: str, name: str, value: object, right: str) -> str:
    """The line all refusals share: `Rod: length = -2.0 must be a positive, finite number [m]`."""
    text = " ".join(repr(value).split())
    shown = text if len(text) <= 80 else text[:77] + "..."
    return f"{owner}: {name} = {shown} must be {right}"


def number(owner: str, name: str, value: Any, unit: str) -> float:
    """A finite number.

    Raises:
        TypeError: not a real number (a truth value is none).
        ValueError: infinite or NaN.
    """
    right = f"a finite number [{unit}]"
    result = _real(owner, name, value, right)
    if not math.isfinite(result):
        raise ValueError(wrong(owner, name, value, right))
    return result


def positive(owner: str, name: str, value: Any, unit: str) -> float:
    """A finite number above zero.

    Raises:
        TypeError: not a real number.
        ValueError: zero, negative, infinite or NaN.
    """
    right = f"a positive, finite number [{unit}]"
    result = _real(owner, name, value, right)
    if not 0.0 < result < math.inf:
        raise ValueError(wrong(owner, name, value, right))
    return result


def count(owner: str, name: str, value: Any) -> int:
    """A whole number from 1.

    Raises:
        TypeError: not a whole number (2.0 is none).
        ValueError: below 1.
    """
    result = integer(owner, name, value, "a whole number, at least 1")
    if result < 1:
        raise ValueError(wrong(owner, name, value, "a whole number, at least 1"))
    return result


def integer(owner: str, name: str, value: Any, right: str) -> int:
    """A whole number; `right` says in the message which ones are wanted.

    Raises:
        TypeError: not a whole number.
    """
    if not isinstance(value, bool):
        try:
            return operator.index(value)
        except TypeError:
            pass
    raise TypeError(wrong(owner, name, value, right))


def vector(owner: str, name: str, value: Any, unit: str) -> Triple:
    """Three finite numbers, as a tuple.

    Raises:
        TypeError: not a sequence of real numbers.
        ValueError: not three of them, or one is infinite or NaN.
    """
    x, y, z = array(owner, name, value, (3,), f"3 finite numbers (x, y, z) [{unit}]").tolist()
    return (x, y, z)


def direction(owner: str, name: str, value: Any) -> Triple:
    """A unit vector along three given numbers, of any length but zero.

    Raises:
        TypeError: not a sequence of real numbers.
        ValueError: not three of them, zero, infinite or NaN.
    """
    given = np.array(vector(owner, name, value, "-"))
    largest = float(np.abs(given).max())
    if largest == 0.0:
        raise ValueError(wrong(owner, name, value, "a vector other than zero (it need not have length 1)"))
    if abs(math.hypot(*given.tolist()) - 1.0) < 4.0 * np.finfo(float).eps:
        return (float(given[0]), float(given[1]), float(given[2]))  # kept bit for bit, as when read from a store
    scaled = given / largest  # first by the largest component, so that the squares neither overflow nor vanish
    x, y, z = (scaled / np.linalg.norm(scaled)).tolist()
    return (x, y, z)


def array(owner: str, name: str, value: Any, shape: tuple[int, ...], right: str) -> Array:
    """A finite float64 array of the given shape; a dimension of -1 may have any length.

    Raises:
        TypeError: not made of real numbers.
        ValueError: another shape, or infinite or NaN somewhere.
    """
    try:
        given = np.asarray(value)
    except ValueError:  # rows of unequal length
        raise ValueError(wrong(owner, name, value, right)) from None
    if given.dtype.kind not in "iuf":
        raise TypeError(wrong(owner, name, value, right))
    fits = given.ndim == len(shape) and all(want in (-1, have) for want, have in zip(shape, given.shape, strict=True))
    if not fits or not np.isfinite(given).all():
        raise ValueError(wrong(owner, name, value, right))
    return np.array(given, dtype=np.float64, order="C")


def positive_definite(owner: str, name: str, value: Any, size: int, meaning: str) -> Array:
    """A symmetric positive definite matrix, read-only; symmetric up to round-off, and made exactly so.

    Entries of different units stand side by side, so both tests look at D^(-1/2) A D^(-1/2) with D = diag(A).

    Args:
        owner: the object, for the message.
        name: the parameter, for the message.
        value: what was given.
        size: rows and columns.
        meaning: order and units of the rows, for the message.

    Raises:
        TypeError: not made of real numbers.
        ValueError: another shape, infinite or NaN somewhere, not symmetric, or not positive definite.
    """
    right = f"a symmetric, positive definite {size} x {size} matrix ({meaning})"
    given = array(owner, name, value, (size, size), right)
    diagonal = np.diagonal(given)
    if diagonal.min() <= 0.0:
        k = int(diagonal.argmin())
        raise ValueError(f"{owner}: {name}[{k}, {k}] = {diagonal[k]:g}, but {name} must be {right}")
    scaled = given / np.sqrt(diagonal)[:, None] / np.sqrt(diagonal)
    i, j = np.unravel_index(int(np.abs(scaled - scaled.T).argmax()), given.shape)
    if abs(scaled[i, j] - scaled[j, i]) > 1e-9:
        entries = f"{name}[{i}, {j}] = {given[i, j]:g} and {name}[{j}, {i}] = {given[j, i]:g}"
        raise ValueError(f"{owner}: {entries} differ, but {name} must be {right}")
    smallest = float(np.linalg.eigvalsh(0.5 * (scaled + scaled.T))[0])
    if smallest < 1e-12:
        raise ValueError(f"{owner}: {name} has the scaled eigenvalue {smallest:.3g}, but must be {right}")
    return frozen(0.5 * given + 0.5 * given.T)


def frozen(values: Array) -> Array:
    """The same array, made read-only."""
    values.setflags(write=False)
    return values


def option(owner: str, name: str, value: Any, allowed: Iterable[str]) -> str:
    """One of a few words.

    Raises:
        ValueError: another word.
    """
    words = tuple(allowed)
    if not isinstance(value, str) or value not in words:
        raise ValueError(wrong(owner, name, value, " or ".join(f'"{word}"' for word in words)))
    return value


def components(owner: str, name: str, value: Any) -> Mask:
    """Which of three components are meant: letters out of "xyz", or three truth values.

    Raises:
        TypeError: neither a text nor a sequence.
        ValueError: other letters, a letter twice, or other entries than three truth values.
    """
    right = 'letters out of "xyz", each once (such as "xz"), or three truth values'
    if isinstance(value, str):
        if set(value) - set(AXES) or len(set(value)) != len(value):
            raise ValueError(wrong(owner, name, value, right))
        return ("x" in value, "y" in value, "z" in value)
    if not isinstance(value, (tuple, list, np.ndarray)):
        raise TypeError(wrong(owner, name, value, right))
    if len(value) != 3 or not all(isinstance(entry, (bool, np.bool_)) for entry in value):
        raise ValueError(wrong(owner, name, value, right))
    x, y, z = (bool(entry) for entry in value)
    return (x, y, z)


def _real(owner: str, name: str, value: Any, right: str) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(wrong(owner, name, value, right))
    return float(value)
