"""Rotations as matrices of SO(3), from the body to space: the same operations as on quaternions."""

import numpy as np
from numpy.typing import ArrayLike

from cayley.lie import branch, exponential, quaternion, series
from cayley.lie.arrays import Mats, Quats, Scalars, Vecs, apply, as_mats, as_vecs, dot, transpose
from cayley.lie.skew import hat, vee

__all__ = [
    "body_rate",
    "compose",
    "exp",
    "from_quaternion",
    "hat",
    "identity",
    "inverse",
    "inverse_rotate",
    "left_gradient",
    "log",
    "orthogonality_defect",
    "relative",
    "rotate",
    "tangent",
    "to_quaternion",
    "vee",
]


def identity(shape: tuple[int, ...] = ()) -> Mats:
    """Unit matrices of the batch shape given, shape (*shape, 3, 3)."""
    return np.broadcast_to(np.eye(3), (*shape, 3, 3)).copy()


def compose(a: ArrayLike, b: ArrayLike) -> Mats:
    """Product A B, shape (..., 3, 3): first B, then A, in space; first A, then B, in the body."""
    return as_mats(a) @ as_mats(b)


def inverse(r: ArrayLike) -> Mats:
    """Inverse Rᵀ, shape (..., 3, 3)."""
    return transpose(as_mats(r))


def relative(a: ArrayLike, b: ArrayLike) -> Mats:
    """Rotation from A to B, seen in the body: Aᵀ B, shape (..., 3, 3)."""
    return compose(inverse(a), b)


def rotate(r: ArrayLike, v: ArrayLike) -> Vecs:
    """Rotate a vector from the body frame to the space frame: R v, shape (..., 3)."""
    return apply(as_mats(r), as_vecs(v))


def inverse_rotate(r: ArrayLike, v: ArrayLike) -> Vecs:
    """Rotate a vector from the space frame to the body frame: Rᵀ v, shape (..., 3)."""
    return apply(inverse(r), as_vecs(v))


def exp(eta: ArrayLike) -> Mats:
    """Rotation matrix of a rotation vector (Rodrigues).

    exp(hat η) = I + sin θ/θ hat(η) + (1 - cos θ)/θ² hat(η)²,   θ = ‖η‖

    Args:
        eta: rotation vectors [rad], shape (..., 3), of any length.

    Returns: rotation matrices, shape (..., 3, 3). The derivative, in the body frame, is exponential.dexp.
    """
    eta = as_vecs(eta)
    square = dot(eta, eta)
    # Half angles: sin θ = 2 sin(θ/2) cos(θ/2) and 1 - cos θ = 2 sin²(θ/2), which does not cancel.
    cosine, sine = series.cosine(square)[..., None], series.sine_ratio(square)[..., None]
    skew = hat(eta)
    return np.eye(3) + 2 * sine * (cosine * skew + sine * (skew @ skew))


def log(r: ArrayLike) -> Vecs:
    """Rotation vector of a rotation matrix, at most π long and accurate up to there.

    Args:
        r: rotation matrices, shape (..., 3, 3).

    Returns: rotation vectors [rad], shape (..., 3); of a half turn, one of the two.
    """
    return exponential.log(quaternion.from_matrix(r))


def body_rate(r: ArrayLike, dr: ArrayLike) -> Vecs:
    """Body vector of a tangent: hat ω = Rᵀ Ṙ, hat Ω = Rᵀ R′.

    Args:
        r: rotation matrices, shape (..., 3, 3).
        dr: their derivatives, shape (..., 3, 3).

    Returns: body vectors, shape (..., 3), in the unit of dr [1/s, 1/m or rad].
    """
    return vee(compose(inverse(r), dr))


def tangent(r: ArrayLike, eta: ArrayLike) -> Mats:
    """Tangent of a body vector, the inverse of body_rate: δR = R hat(η).

    Args:
        r: rotation matrices, shape (..., 3, 3).
        eta: body vectors, shape (..., 3).

    Returns: tangents, shape (..., 3, 3), in the unit of eta.
    """
    return compose(r, hat(eta))


def left_gradient(r: ArrayLike, gradient: ArrayLike) -> Vecs:
    """Left-trivialized gradient ∇f of a function of R: with δR = R hat(η), δf = ∇f·η.

    hat ∇f = A - Aᵀ,   A = Rᵀ ∂f/∂R

    Args:
        r: rotation matrices, shape (..., 3, 3).
        gradient: partial derivatives ∂f/∂R, shape (..., 3, 3).

    Returns: body vectors ∇f, shape (..., 3).
    """
    return 2 * vee(compose(inverse(r), gradient))


def orthogonality_defect(r: ArrayLike) -> Scalars:
    """Distance from the orthogonal matrices: the Frobenius norm ‖Rᵀ R - I‖, shape (...)."""
    defect = compose(inverse(r), r) - np.eye(3)
    flat = defect.reshape(*defect.shape[:-2], 9)
    return branch.sqrt(dot(flat, flat))[..., 0]


def from_quaternion(p: ArrayLike) -> Mats:
    """Rotation matrix of a unit quaternion, shape (..., 3, 3); see quaternion.to_matrix."""
    return quaternion.to_matrix(p)


def to_quaternion(r: ArrayLike) -> Quats:
    """Unit quaternion with w ≥ 0 of a rotation matrix, shape (..., 4); see quaternion.from_matrix."""
    return quaternion.from_matrix(r)
