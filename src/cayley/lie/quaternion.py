"""Quaternions: scalar first (w, x, y, z), Hamilton product; unit quaternions rotate from the body to space."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from cayley.lie import branch, exponential
from cayley.lie.arrays import Mats, Quats, Scalars, Vecs, as_mats, as_quats, as_vecs, cross, dot, join, split

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation


def identity(shape: tuple[int, ...] = ()) -> Quats:
    """Quaternions 1 of the batch shape given, shape (*shape, 4)."""
    return np.broadcast_to((1.0, 0.0, 0.0, 0.0), (*shape, 4)).copy()


def multiply(p: ArrayLike, q: ArrayLike) -> Quats:
    """Hamilton product p q.

    (p₀ + u)(q₀ + v) = p₀ q₀ - u·v + p₀ v + q₀ u + u × v

    Args:
        p: quaternions, wxyz, shape (..., 4).
        q: quaternions, wxyz, shape (..., 4).

    Returns: quaternions, wxyz, shape (..., 4).

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), section 2.
    """
    a, b, c, d = split(as_quats(p))
    w, x, y, z = split(as_quats(q))
    return join(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y + c * w + d * x - b * z,
            a * z + d * w + b * y - c * x,
        ]
    )


def conjugate(p: ArrayLike) -> Quats:
    """Conjugate p̄ = Re p - Im p, shape (..., 4); of a unit quaternion, the inverse."""
    p = as_quats(p)
    return join([p[..., :1], -p[..., 1:]])


def relative(p: ArrayLike, q: ArrayLike) -> Quats:
    """Rotation from p to q, seen in the body: p̄ q, shape (..., 4); independent of a common rotation of both."""
    return multiply(conjugate(p), q)


def real(p: ArrayLike) -> Scalars:
    """Real part w, shape (...)."""
    return as_quats(p)[..., 0]


def imaginary(p: ArrayLike) -> Vecs:
    """Imaginary part (x, y, z), shape (..., 3)."""
    return as_quats(p)[..., 1:]


def pure(v: ArrayLike) -> Quats:
    """Purely imaginary quaternion of a vector, shape (..., 4)."""
    v = as_vecs(v)
    return join([np.zeros_like(v[..., :1]), v])


def norm(p: ArrayLike) -> Scalars:
    """Length ‖p‖ = √(p·p), shape (...)."""
    p = as_quats(p)
    return branch.sqrt(dot(p, p))[..., 0]


def normalize(p: ArrayLike) -> Quats:
    """Unit quaternion p / ‖p‖, shape (..., 4), of a quaternion that is not zero."""
    p = as_quats(p)
    return p / branch.sqrt(dot(p, p))


def rotate(p: ArrayLike, v: ArrayLike) -> Vecs:
    """Rotate a vector from the body frame to the space frame.

    Λ(p) v = p v p̄ = v + w (2 u × v) + u × (2 u × v),   p = w + u

    Args:
        p: unit quaternions, wxyz, shape (..., 4).
        v: body vectors, shape (..., 3).

    Returns: space vectors, shape (..., 3).

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), section 2.
    """
    p, v = as_quats(p), as_vecs(v)
    w, u = p[..., :1], p[..., 1:]
    twice = 2 * cross(u, v)
    return v + w * twice + cross(u, twice)


def inverse_rotate(p: ArrayLike, v: ArrayLike) -> Vecs:
    """Rotate a vector from the space frame to the body frame: Λ(p)ᵀ v = p̄ v p; shapes as for rotate."""
    return rotate(conjugate(p), v)


def body_rate(p: ArrayLike, dp: ArrayLike) -> Vecs:
    """Body vector of a tangent: angular velocity of ṗ, curvature and twist of p′.

    ω = 2 Im(p̄ ṗ),   Ω = 2 Im(p̄ p′)

    Args:
        p: unit quaternions, wxyz, shape (..., 4).
        dp: their derivatives, shape (..., 4).

    Returns: body vectors, shape (..., 3), in the unit of dp [1/s, 1/m or rad].
    """
    return 2 * imaginary(relative(p, dp))


def tangent(p: ArrayLike, eta: ArrayLike) -> Quats:
    """Tangent of a body vector, the inverse of body_rate: δp = ½ p η.

    Args:
        p: unit quaternions, wxyz, shape (..., 4).
        eta: body vectors, shape (..., 3).

    Returns: tangents, shape (..., 4), in the unit of eta.
    """
    return multiply(p, pure(eta)) / 2


def left_gradient(p: ArrayLike, gradient: ArrayLike) -> Vecs:
    """Left-trivialized gradient ∇f of a function of p: with δp = ½ p η, δf = ∇f·η.

    ∇f = ½ Im(p̄ ∂f/∂p)

    Args:
        p: unit quaternions, wxyz, shape (..., 4).
        gradient: partial derivatives ∂f/∂p, shape (..., 4).

    Returns: body vectors ∇f, shape (..., 3).

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), section 3.
    """
    return imaginary(relative(p, gradient)) / 2


def to_rotation_vector(p: ArrayLike) -> Vecs:
    """Rotation vector [rad], at most π long, shape (..., 3); see exponential.log."""
    return exponential.log(p)


def from_rotation_vector(eta: ArrayLike) -> Quats:
    """Unit quaternion of a rotation vector [rad], shape (..., 4); see exponential.exp."""
    return exponential.exp(eta)


def to_matrix(p: ArrayLike) -> Mats:
    """Rotation matrix Λ(p) of a unit quaternion.

    Λ(p) = I + 2 w hat(u) + 2 hat(u)²,   p = w + u

    Args:
        p: unit quaternions, wxyz, shape (..., 4).

    Returns: rotation matrices, shape (..., 3, 3).
    """
    w, x, y, z = split(as_quats(p))
    return join(
        [
            *(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            *(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            *(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        ],
        (3, 3),
    )


def from_matrix(r: ArrayLike) -> Quats:
    """Unit quaternion with w ≥ 0 of a rotation matrix; every angle, π included, is as accurate as any other.

    The table 4 p pᵀ is linear in R; its row with the largest diagonal entry, divided by its length, is ±p.

    Args:
        r: rotation matrices, shape (..., 3, 3).

    Returns: unit quaternions, wxyz, shape (..., 4).

    Source: Markley (2008), Unit quaternion from rotation matrix.
    """
    r = as_mats(r)
    (a, b, c), (d, e, f), (g, h, i) = (split(r[..., k, :]) for k in range(3))
    ww, xx, yy, zz = 1 + a + e + i, 1 + a - e - i, 1 - a + e - i, 1 - a - e + i
    wx, wy, wz, xy, xz, yz = h - f, c - g, d - b, b + d, c + g, f + h
    best, largest = join([ww, wx, wy, wz]), ww
    for row, diagonal in (([wx, xx, xy, xz], xx), ([wy, xy, yy, yz], yy), ([wz, xz, yz, zz], zz)):
        larger = branch.less(largest, diagonal)
        best, largest = branch.where(larger, join(row), best), branch.where(larger, diagonal, largest)
    return normalize(branch.where(branch.less(best[..., :1], 0.0), -best, best))


def to_scipy(p: ArrayLike) -> "Rotation":
    """SciPy Rotation of unit quaternions (numbers only), which SciPy stores scalar last."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(np.roll(as_quats(p), -1, axis=-1))


def from_scipy(rotation: "Rotation") -> Quats:
    """Unit quaternions of a SciPy Rotation, scalar first, shape (..., 4)."""
    return np.roll(as_quats(rotation.as_quat()), 1, axis=-1)
