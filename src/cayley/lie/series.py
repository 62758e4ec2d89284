"""The scalar functions behind exp, log and their derivatives, accurate and smooth through zero.

All take the square of an angle (or of a tangent), so that no root has to be differentiated at zero, and change
from a power series to the closed form where that has lost no digits yet. Both sides agree to round-off at the
switch. Against 50-digit arithmetic the relative error stays below 5e-16 for 1e-12 <= θ <= π (measured; of the
cosine, which has a zero at π, the absolute error).
"""

from math import factorial

from cayley.lie import branch
from cayley.lie.arrays import Array

NEAR = 4.0
"""θ² [rad²] below which a series in θ² is summed: from θ = 2 on, no closed form here cancels."""
_TERMS = range(12)
"""Terms of those series; the first one left out is below 1e-18 of the sum at θ = 2."""
_COSINE = [(-1) ** k / (4**k * factorial(2 * k)) for k in _TERMS]
_SINE = [(-1) ** k / (2 * 4**k * factorial(2 * k + 1)) for k in _TERMS]
_THIRD = [(-1) ** k / factorial(2 * k + 3) for k in _TERMS]
_COTANGENT = [(-1) ** k * (2 * k + 2) / (4**k * factorial(2 * k + 3)) for k in _TERMS]

NEAR_TANGENT = 1 / 32
"""tan² below which the series of the inverse tangent is summed; its first term left out is below 2e-18."""
_DEFECT = [(-1) ** k / (2 * k + 3) for k in range(13)]
_ARCTAN = [(-1) ** k / (2 * k + 1) for k in range(11)]


def cosine(t: Array) -> Array:
    """cos(θ/2) of t = θ²."""
    return branch.switch(t, NEAR, lambda t: _horner(_COSINE, t), lambda t: branch.cos(branch.sqrt(t) / 2))


def sine_ratio(t: Array) -> Array:
    """sin(θ/2) / θ of t = θ²; 1/2 at zero."""

    def far(t: Array) -> Array:
        angle = branch.sqrt(t)
        return branch.sin(angle / 2) / angle

    return branch.switch(t, NEAR, lambda t: _horner(_SINE, t), far)


def third_ratio(t: Array) -> Array:
    """(θ - sin θ) / θ³ of t = θ²; 1/6 at zero."""

    def far(t: Array) -> Array:
        angle = branch.sqrt(t)
        return (angle - branch.sin(angle)) / (angle * t)

    return branch.switch(t, NEAR, lambda t: _horner(_THIRD, t), far)


def cotangent_ratio(t: Array) -> Array:
    """(1 - (θ/2) cot(θ/2)) / θ² of t = θ² < (2π)²; 1/12 at zero.

    With x = θ/2 this is (sin x - x cos x) / x³ over 4 sin(x) / x, both of them entire: the quotient keeps its
    digits where a series of its own would converge slowly.
    """

    def far(t: Array) -> Array:
        x = branch.sqrt(t) / 2
        return (branch.sin(x) - x * branch.cos(x)) / (x * t / 4)

    return branch.switch(t, NEAR, lambda t: _horner(_COTANGENT, t), far) / (8 * sine_ratio(t))


def arctan_ratio(u: Array) -> Array:
    """arctan(y) / y of u = y²; 1 at zero."""

    def far(u: Array) -> Array:
        y = branch.sqrt(u)
        return branch.arctan(y) / y

    return branch.switch(u, NEAR_TANGENT, lambda u: _horner(_ARCTAN, u), far)


def arctan_defect(u: Array) -> Array:
    """(1 - arctan(y) / y) / y² of u = y² <= 1; 1/3 at zero.

    One formula for all arguments, so that symbols stay small under differentiation: the angle is halved twice, and the
    series of what is left summed. With s = √(1 + u), B(u) = (1 + 2 B(u/(1 + s)²)/(1 + s))/(1 + s)².
    """
    halved, sides = u, []
    for _ in range(2):
        side = 1 + branch.sqrt(1 + halved)
        sides.append(side)
        halved = halved / (side * side)
    found = _horner(_DEFECT, halved)
    for side in reversed(sides):
        found = (1 + 2 * found / side) / (side * side)
    return found


def _horner(coefficients: list[float], t: Array) -> Array:
    total = 0 * t + coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        total = total * t + coefficient
    return total
