"""Shear corrections and torsion constants of sections, and the words by which they are chosen."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from cayley.model import validate

_ZETA_5 = 1.0369277551433699263  # Riemann zeta at 5, for the torsion series

ShearCorrection = str | float | tuple[float, float]


def saint_venant(width: float, height: float) -> float:
    """Torsion constant [m^4] of a rectangle, long side a and short side b.

    It = a b³ (1/3 - 64/π⁵ b/a Σ tanh(nπa/2b)/n⁵),  n = 1, 3, 5, ...

    With tanh z = 1 - 2/(e²ᶻ + 1) the slow part of the sum is (31/32) ζ(5), and the rest falls like e⁻ⁿᵖⁱ: five terms
    leave less than 1e-17.

    Source: Timoshenko and Goodier, Theory of Elasticity, art. 109.
    """
    a, b = max(width, height), min(width, height)
    odd = np.arange(1.0, 10.0, 2.0)
    decay = np.exp(-odd * np.pi * a / b)  # of a falling exponential: a thin strip underflows to zero, never overflows
    total = 31.0 / 32.0 * _ZETA_5 - float(np.sum(2.0 * decay / (1.0 + decay) / odd**5))
    return a * b**3 * (1.0 / 3.0 - 64.0 / math.pi**5 * (b / a) * total)


def cowper_tube(m: float, nu: float) -> float:
    """Shear correction of a tube with m = inner/outer radius (m = 0: circle). Source: Cowper (1966), table 1."""
    q = (1.0 + m * m) ** 2
    return 6.0 * (1.0 + nu) * q / ((7.0 + 6.0 * nu) * q + (20.0 + 12.0 * nu) * m * m)


def cowper_rectangle(nu: float) -> float:
    """Shear correction 10 (1 + ν)/(12 + 11 ν) of a rectangle. Source: Cowper (1966), table 1."""
    return 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)


def cowper_ellipse(n: float, nu: float) -> float:
    """Shear correction of an ellipse with n = half axis along the force/the other one.

    κ = 12 (1 + ν) n² (3 n² + 1) / ((40 + 37 ν) n⁴ + (16 + 10 ν) n² + ν)

    Source: Cowper (1966), table 1.
    """
    s = n * n
    return 12.0 * (1.0 + nu) * s * (3.0 * s + 1.0) / ((40.0 + 37.0 * nu) * s * s + (16.0 + 10.0 * nu) * s + nu)


def cowper_walls(m: float, n: float, nu: float, *, closed: bool) -> float:
    """Shear correction of a thin-walled I (or box), the force along its web (or its two webs).

    κ = 10 (1 + ν)(1 + 3 m)² / (12 + 72 m + 150 m² + 90 m³ + ν (11 + 66 m + 135 m² + 90 m³) + r)
    I:   r = 30 n² (m + m²) + 5 ν n² (8 m + 9 m²)
    box: r = 10 n² ((3 + ν) m + 3 m²)

    Args:
        m: area of the flanges/area of the webs.
        n: width between the midlines/height between the midlines.
        nu: Poisson's ratio.
        closed: a box.

    Source: Cowper (1966), table 1.
    """
    tail = 30.0 * n**2 * (m + m**2) + 5.0 * nu * n**2 * (8.0 * m + 9.0 * m**2)
    if closed:
        tail = 10.0 * n**2 * ((3.0 + nu) * m + 3.0 * m**2)
    body = 12.0 + 72.0 * m + 150.0 * m**2 + 90.0 * m**3 + nu * (11.0 + 66.0 * m + 135.0 * m**2 + 90.0 * m**3)
    return 10.0 * (1.0 + nu) * (1.0 + 3.0 * m) ** 2 / (body + tail)


def shear_pair(owner: str, value: Any, cowper: tuple[float, float] | None) -> tuple[float, float]:
    """The shear corrections along e1 and e2 [-] from what a user gives.

    Args:
        owner: the object, for the message.
        value: one number, one for each axis, "cowper" or "none" (1: the whole area, unreduced).
        cowper: what "cowper" means; None: there is no formula.

    Raises:
        TypeError: a value is not a number.
        ValueError: another word, or a number that is not positive and finite.
    """
    right = "a positive, finite number [-], or two of them"
    if isinstance(value, str):
        words: dict[str, tuple[float, float]] = {"none": (1.0, 1.0)} | ({} if cowper is None else {"cowper": cowper})
        if value not in words:
            names = " or ".join(f'"{word}"' for word in sorted(words))
            raise ValueError(validate.wrong(owner, "shear_correction", value, f"{names}, {right}"))
        return words[value]
    if isinstance(value, (tuple, list, np.ndarray)):
        first, second = validate.array(owner, "shear_correction", value, (2,), right).tolist()
        if min(first, second) <= 0.0:
            raise ValueError(validate.wrong(owner, "shear_correction", value, right))
        return (first, second)
    kappa = validate.positive(owner, "shear_correction", value, "-")
    return (kappa, kappa)


def torsion_constant(owner: str, value: Any, words: Mapping[str, Any]) -> float:
    """The torsion constant [m^4] from what a user gives: a number, or one of some words.

    Args:
        owner: the object, for the message.
        value: the number or the word.
        words: what each word means, a number or a function that finds it.

    Raises:
        TypeError: neither a number nor a word.
        ValueError: another word, or a number that is not positive and finite.
    """
    if not isinstance(value, str):
        return validate.positive(owner, "torsion", value, "m^4")
    if value not in words:
        right = ", ".join(f'"{word}"' for word in words) + " or a number [m^4]"
        raise ValueError(validate.wrong(owner, "torsion", value, right))
    found = words[value]
    return float(found() if callable(found) else found)


__all__ = [
    "ShearCorrection",
    "cowper_ellipse",
    "cowper_rectangle",
    "cowper_tube",
    "cowper_walls",
    "saint_venant",
    "shear_pair",
    "torsion_constant",
]
