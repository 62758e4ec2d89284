"""The frame of a section from its direction and normal."""

from __future__ import annotations

import math

import numpy as np

from cayley.model import validate
from cayley.model.validate import Array, Triple

_ROUND_OFF = 8.0 * float(np.finfo(np.float64).eps)


def standard_rotation(owner: str, direction: Triple, normal: Triple | None, shown: object = None) -> Array:
    """The rotation of a section whose e3 is the direction and whose e1 lies along the normal, as Rod says.

    Args:
        owner: the object, for the message.
        direction: unit vector.
        normal: unit vector, or None.
        shown: the normal as it was given, for the message.

    Returns: unit quaternion, shape (4,).

    Raises:
        ValueError: the normal is parallel to the direction.
    """
    w, x, y, _ = _smallest_rotation(direction)
    if normal is None:
        return np.array([w, x, y, 0.0])
    if math.sqrt(sum(c * c for c in np.cross(direction, normal).tolist())) < 1e-8:
        right = f"at an angle to direction = {direction!r}, but is parallel to it"
        raise ValueError(validate.wrong(owner, "normal", normal if shown is None else shown, right))
    # then turn about e3 until e1 points along the part of the normal perpendicular to the axis
    n1, n2, _ = (np.array(normal) @ _matrix(w, x, y)).tolist()
    half = 0.5 * math.atan2(n2, n1)
    c, s = math.cos(half), math.sin(half)
    return np.array([w * c, x * c + y * s, y * c - x * s, w * s])


def _smallest_rotation(d: Triple) -> tuple[float, float, float, float]:
    """The quaternion of the smallest rotation from e3 to the unit vector d; about e1 if d = -e3.

    p = (cos θ/2, sin θ/2 (-d₂, d₁, 0)/sin θ),  θ = atan2(‖(d₁, d₂)‖, d₃)
    """
    sine = math.hypot(d[0], d[1])
    if sine < _ROUND_OFF:  # so that (sin π, 0, cos π) is -e3
        return (1.0, 0.0, 0.0, 0.0) if d[2] > 0.0 else (0.0, 1.0, 0.0, 0.0)
    half = 0.5 * math.atan2(sine, d[2])
    factor = math.sin(half) / sine
    return (math.cos(half), -d[1] * factor, d[0] * factor, 0.0)


def _matrix(w: float, x: float, y: float) -> Array:
    """Λ(p) of the unit quaternion (w, x, y, 0), shape (3, 3)."""
    return np.array(
        [
            [w * w + x * x - y * y, 2.0 * x * y, 2.0 * w * y],
            [2.0 * x * y, w * w - x * x + y * y, -2.0 * w * x],
            [-2.0 * w * y, 2.0 * w * x, w * w - x * x - y * y],
        ]
    )
