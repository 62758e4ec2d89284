"""The Cayley map, to unit quaternions and to SO(3), and its left-trivialized derivative.

A Cayley vector f = tan(θ/2) n holds the axis n and the angle θ of a rotation; it is the unknown of a step. No
circular function, no series, no switch; only half turns are out of reach. Tangent vectors are taken in the body
frame: with p = Cay f, dp = ½ p (dcay(f) df).
"""

import numpy as np
from numpy.typing import ArrayLike

from cayley.lie import branch
from cayley.lie.arrays import Mats, Quats, Vecs, as_mats, as_quats, as_vecs, cross, dot, join
from cayley.lie.skew import hat, vee


def cay(f: ArrayLike) -> Quats:
    """Unit quaternion of a Cayley vector.

    Cay f = (1 + f) / ‖1 + f‖

    Args:
        f: Cayley vectors [-], shape (..., 3).

    Returns: unit quaternions with w > 0, wxyz, shape (..., 4).
    """
    f = as_vecs(f)
    scale = 1 / branch.sqrt(1 + dot(f, f))
    return join([scale, scale * f])


def cay_inv(p: ArrayLike) -> Vecs:
    """Cayley vector of a quaternion; the length and sign of p do not matter.

    f = Im p / Re p

    Args:
        p: quaternions, wxyz, shape (..., 4), with w ≠ 0: a half turn has no Cayley vector.

    Returns: Cayley vectors [-], shape (..., 3).
    """
    p = as_quats(p)
    return p[..., 1:] / p[..., :1]


def matrix(f: ArrayLike) -> Mats:
    """Rotation matrix of a Cayley vector, the Cayley map of so(3).

    R = (I - hat f)⁻¹ (I + hat f) = I + 2 (hat f + hat f²) / (1 + f·f) = Λ(Cay f)

    Args:
        f: Cayley vectors [-], shape (..., 3).

    Returns: rotation matrices, shape (..., 3, 3).
    """
    f = as_vecs(f)
    skew = hat(f)
    return np.eye(3) + (2 / (1 + dot(f, f)))[..., None] * (skew + skew @ skew)


def matrix_inv(r: ArrayLike) -> Vecs:
    """Cayley vector of a rotation matrix.

    hat f = (R - Rᵀ) / (1 + tr R)

    Args:
        r: rotation matrices, shape (..., 3, 3), not half turns (there 1 + tr R = 0).

    Returns: Cayley vectors [-], shape (..., 3).
    """
    r = as_mats(r)
    trace = r[..., 0, 0, None] + r[..., 1, 1, None] + r[..., 2, 2, None]
    return 2 * vee(r) / (1 + trace)


def dcay(f: ArrayLike) -> Mats:
    """Left-trivialized derivative of the Cayley map: it takes df to the body tangent.

    dcay(f) = 2 (I - hat f) / (1 + f·f),   p̄ dp = ½ dcay(f) df,   Rᵀ dR = hat(dcay(f) df)

    It follows from (1 - f) df = f·df + (df - f × df), of which the norm of 1 + f changes the real part only.

    Args:
        f: Cayley vectors [-], shape (..., 3).

    Returns: matrices, shape (..., 3, 3).
    """
    f = as_vecs(f)
    return (2 / (1 + dot(f, f)))[..., None] * (np.eye(3) - hat(f))


def dcay_inv(f: ArrayLike) -> Mats:
    """Inverse of dcay, which is never singular.

    dcay(f)⁻¹ = ½ (I + hat f + f fᵀ)

    Args:
        f: Cayley vectors [-], shape (..., 3).

    Returns: matrices, shape (..., 3, 3).
    """
    f = as_vecs(f)
    return (np.eye(3) + hat(f) + f[..., :, None] * f[..., None, :]) / 2


def compose(f: ArrayLike, g: ArrayLike) -> Vecs:
    """Cayley vector of the product Cay(f) Cay(g); that of the inverse of Cay f is -f.

    (f + g + f × g) / (1 - f·g)

    Args:
        f: Cayley vectors [-], shape (..., 3).
        g: Cayley vectors [-], shape (..., 3), with f·g ≠ 1 (the product would be a half turn).

    Returns: Cayley vectors [-], shape (..., 3).
    """
    f, g = as_vecs(f), as_vecs(g)
    return (f + g + cross(f, g)) / (1 - dot(f, g))


def half(f: ArrayLike) -> Vecs:
    """Cayley vector of half the rotation: Cay(half(f))² = Cay f.

    f / (1 + √(1 + f·f))

    Args:
        f: Cayley vectors [-], shape (..., 3).

    Returns: Cayley vectors [-], shape (..., 3), shorter than 1.
    """
    f = as_vecs(f)
    return f / (1 + branch.sqrt(1 + dot(f, f)))
