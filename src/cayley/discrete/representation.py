"""How a rotation is stored: four rows of a unit quaternion or nine of a matrix; the mechanics is the same for both.

Everything between two frames goes through their relative unit quaternion r = p̄ q = (r₀, v), so the discrete
equations of the two forms agree to round-off; they differ in storage, in composition and in how r is found.
"""

from typing import Any, Protocol

import numpy as np

from cayley.density.expression import Expression, cross, dot, wrap
from cayley.lie import quaternion, skew


class Representation(Protocol):
    """What the discrete mechanics asks of a stored rotation."""

    name: str
    rows: int

    def matrix(self, p: Any) -> Any:
        """Λ(p), shape (3, 3)."""

    def relative(self, p: Any, q: Any) -> tuple[Any, Any]:
        """Real and imaginary part of p̄ q."""

    def middle(self, p: Any, q: Any, r0: Any, half: Any) -> Any:
        """Matrix of the rotation halfway from p to q, where half = v/(1 + r₀) is its Cayley vector seen from p."""

    def compose(self, p: Any, f: Any, cosine: Any) -> Any:
        """Rows of p Cay f, where cosine = 1/√(1 + f·f); written as an increment, so that rounding stays unbiased."""

    def tangent(self, p: Any) -> Any:
        """Derivative of the rows along δp = ½ p η, shape (rows, 3)."""

    def from_quaternion(self, p: np.ndarray) -> np.ndarray:
        """Rows from unit quaternions, shape (..., 4) -> (..., rows)."""

    def to_quaternion(self, rows: np.ndarray) -> np.ndarray:
        """Unit quaternions from rows, shape (..., rows) -> (..., 4)."""


class Quaternion:
    """A rotation as a unit quaternion, scalar first."""

    name = "quaternion"
    rows = 4

    def __repr__(self) -> str:
        """Its name: it is part of the signature of kernels, the same in every process."""
        return self.name

    def matrix(self, p: Any) -> Any:
        """Λ(p) from products of components."""
        return homogeneous(p, 2.0)

    def relative(self, p: Any, q: Any) -> tuple[Any, Any]:
        """Real and imaginary part of p̄ q."""
        r = quaternion.multiply(quaternion.conjugate(p), q)
        return r[0], r[1:]

    def middle(self, p: Any, q: Any, r0: Any, half: Any) -> Any:
        """Λ((p + q)/‖p + q‖), with ‖p + q‖² = 2 (1 + r₀)."""
        return homogeneous(wrap(p + q), 1.0 / (1.0 + r0))

    def compose(self, p: Any, f: Any, cosine: Any) -> Any:
        """P + p (Cay f − 1); the real part of the increment is −f·f c²/(1 + c)."""
        small = -dot(f, f) * cosine * cosine / (1.0 + cosine)
        return p + quaternion.multiply(p, wrap(np.concatenate([[_scalar(small)], cosine * f])))

    def tangent(self, p: Any) -> Any:
        """½ p eᵢ, as columns."""
        return np.stack([0.5 * quaternion.multiply(p, np.array([0.0, *e])) for e in np.eye(3)], axis=1)

    def from_quaternion(self, p: np.ndarray) -> np.ndarray:
        """The quaternion itself."""
        return np.array(p, dtype=float)

    def to_quaternion(self, rows: np.ndarray) -> np.ndarray:
        """The quaternion itself."""
        return np.array(rows, dtype=float)


class Matrix:
    """A rotation as an orthogonal matrix, row by row."""

    name = "matrix"
    rows = 9

    def __repr__(self) -> str:
        """Its name: it is part of the signature of kernels, the same in every process."""
        return self.name

    def matrix(self, p: Any) -> Any:
        """The matrix itself."""
        return p.reshape(3, 3)

    def relative(self, p: Any, q: Any) -> tuple[Any, Any]:
        """From Q = Rₚᵀ R_q: r₀ = ½ √(1 + tr Q), v = vee(Q − Qᵀ)/(4 r₀)."""
        a, b = self.matrix(p), self.matrix(q)
        r0 = 0.5 * np.sqrt(1.0 + sum(dot(a[:, i], b[:, i]) for i in range(3)))
        twice = [_scalar(dot(a[:, k], b[:, i]) - dot(a[:, i], b[:, k])) for i, k in ((1, 2), (2, 0), (0, 1))]
        return r0, wrap(np.array(twice)) * (0.25 / r0)

    def middle(self, p: Any, q: Any, r0: Any, half: Any) -> Any:
        """Rₚ cay(half)."""
        return self.matrix(p) @ (np.eye(3) + _cayley_increment(half, 1.0 / (1.0 + dot(half, half))))

    def compose(self, p: Any, f: Any, cosine: Any) -> Any:
        """R + R (cay f − I), with cay f − I = 2 c² (f̂ + f̂²)."""
        return p + (self.matrix(p) @ _cayley_increment(f, cosine * cosine)).reshape(-1)

    def tangent(self, p: Any) -> Any:
        """R êᵢ, as columns."""
        return np.stack([(self.matrix(p) @ skew.hat(e)).reshape(-1) for e in np.eye(3)], axis=1)

    def from_quaternion(self, p: np.ndarray) -> np.ndarray:
        """Entries of Λ(p)."""
        return quaternion.to_matrix(np.asarray(p, dtype=float)).reshape(*np.shape(p)[:-1], 9)

    def to_quaternion(self, rows: np.ndarray) -> np.ndarray:
        """One of the two quaternions of each matrix, continuous along the second to last axis."""
        p = quaternion.from_matrix(rows.reshape(*rows.shape[:-1], 3, 3))
        return continuous(p)


def continuous(p: np.ndarray) -> np.ndarray:
    """Choose the signs of quaternions so that neighbors along the second to last axis lie in one hemisphere."""
    if p.ndim < 2 or p.shape[-2] < 2:
        return p
    turns = np.sum(p[..., 1:, :] * p[..., :-1, :], axis=-1) < 0
    sign = np.where(np.cumsum(turns, axis=-1) % 2, -1.0, 1.0)
    return np.concatenate([p[..., :1, :], p[..., 1:, :] * sign[..., None]], axis=-2)


REPRESENTATIONS: dict[str, Representation] = {"quaternion": Quaternion(), "matrix": Matrix()}


def homogeneous(p: Any, factor: Any) -> Expression:
    """I + factor (w ŝ + ŝ²) for p = (w, s) of any length: the matrix Λ(p/‖p‖) for factor = 2/‖p‖²."""
    w, x, y, z = p
    scaled = wrap(np.array([_scalar(factor * e) for e in (x, y, z)]))
    a, b, c = scaled
    m = np.empty((3, 3), dtype=object)
    m[0, 0], m[1, 1], m[2, 2] = 1 - (b * y + c * z), 1 - (a * x + c * z), 1 - (a * x + b * y)
    for i, k, even, odd in ((0, 1, a * y, c * w), (1, 2, b * z, a * w), (2, 0, c * x, b * w)):
        m[i, k], m[k, i] = even - odd, even + odd
    return wrap(m)


def _cayley_increment(f: Any, cosine2: Any) -> Expression:
    """2 c² (f̂ + f̂²) = 2 c² (f̂ + f fᵀ − (f·f) I)."""
    hat = np.empty((3, 3), dtype=object)
    hat[:] = 0.0
    for i, k, j in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        hat[i, k], hat[k, i] = _scalar(-f[j]), _scalar(f[j])
    return (wrap(hat) + np.outer(f, f) - dot(f, f) * np.eye(3)) * (2.0 * cosine2)


def _scalar(value: Any) -> Any:
    return value.view(np.ndarray).item() if isinstance(value, Expression) else value


__all__ = ["REPRESENTATIONS", "Matrix", "Quaternion", "Representation", "continuous", "cross"]
