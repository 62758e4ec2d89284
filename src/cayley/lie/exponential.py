"""The exponential map of unit quaternions and its left-trivialized derivative.

A rotation vector η has the direction of the axis and the length θ of the angle [rad]. Tangent vectors are taken in
the body frame: with p = exp η, dp = ½ p (dexp(η) dη).
"""

import numpy as np
from numpy.typing import ArrayLike

from cayley.lie import branch, series
from cayley.lie.arrays import Mats, Quats, Vecs, as_quats, as_vecs, dot, join
from cayley.lie.skew import hat


def exp(eta: ArrayLike) -> Quats:
    """Unit quaternion of a rotation vector.

    exp η = cos(θ/2) + sin(θ/2) η/θ,   θ = ‖η‖

    Args:
        eta: rotation vectors [rad], shape (..., 3), of any length.

    Returns: unit quaternions, wxyz, shape (..., 4).

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), section 2.
    """
    eta = as_vecs(eta)
    square = dot(eta, eta)
    return join([series.cosine(square), series.sine_ratio(square) * eta])


def log(p: ArrayLike) -> Vecs:
    """Rotation vector of a quaternion, at most π long: that of p or of -p, which are one rotation.

    With p = w + v and the sign σ of w:   η = 4 σ arctan(y) v / ‖v‖,   y = ‖v‖ / (‖p‖ + |w|) = tan(θ/4)

    The quarter angle keeps every digit from zero to θ = π. The length of p does not matter.

    Args:
        p: quaternions, wxyz, shape (..., 4), not zero.

    Returns: rotation vectors [rad], shape (..., 3); of a half turn with w = 0, the one along +v.
    """
    p = as_quats(p)
    w, v = p[..., :1], p[..., 1:]
    sign = branch.where(branch.less(w, 0.0), -1.0, 1.0)
    quarter = sign * v / (branch.sqrt(dot(p, p)) + sign * w)
    return 4 * series.arctan_ratio(dot(quarter, quarter)) * quarter


def dexp(eta: ArrayLike) -> Mats:
    """Left-trivialized derivative of the exponential map: it takes dη to the body tangent.

    dexp(η) = I - (1 - cos θ)/θ² hat(η) + (θ - sin θ)/θ³ hat(η)²,   p̄ dp = ½ dexp(η) dη

    Args:
        eta: rotation vectors [rad], shape (..., 3).

    Returns: matrices, shape (..., 3, 3).

    Source: Iserles, Munthe-Kaas, Nørsett, Zanna (2000), Lie-group methods, Acta Numerica 9 (there
        right-trivialized, which is the transpose).
    """
    eta = as_vecs(eta)
    square = dot(eta, eta)
    # (1 - cos θ)/θ² = 2 (sin(θ/2)/θ)² does not cancel.
    sine, third = series.sine_ratio(square)[..., None], series.third_ratio(square)[..., None]
    skew = hat(eta)
    return np.eye(3) - 2 * sine * sine * skew + third * (skew @ skew)


def dexp_inv(eta: ArrayLike) -> Mats:
    """Inverse of dexp.

    dexp(η)⁻¹ = I + ½ hat(η) + (1 - (θ/2) cot(θ/2))/θ² hat(η)²

    Args:
        eta: rotation vectors [rad], shape (..., 3), shorter than 2π, where dexp is singular.

    Returns: matrices, shape (..., 3, 3).

    Source: as for dexp.
    """
    eta = as_vecs(eta)
    skew = hat(eta)
    return np.eye(3) + skew / 2 + series.cotangent_ratio(dot(eta, eta))[..., None] * (skew @ skew)
