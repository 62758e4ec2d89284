"""Arrays with components on the last axis: check, take apart, put together, multiply.

Components are kept as slices of length one, (..., 1), never as scalars: so the same expressions broadcast over
any batch and stay arrays when the entries are symbols.
"""

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[Any]
"""Numbers (float64) or symbols (object)."""
Scalars: TypeAlias = NDArray[Any]
"""One number for each member of the batch, shape (...)."""
Vecs: TypeAlias = NDArray[Any]
"""Vectors, shape (..., 3)."""
Quats: TypeAlias = NDArray[Any]
"""Quaternions (w, x, y, z), shape (..., 4)."""
Mats: TypeAlias = NDArray[Any]
"""Matrices, shape (..., 3, 3)."""


def as_vecs(values: ArrayLike) -> Vecs:
    """Return vectors as an array of float64 or of symbols; ValueError unless the shape is (..., 3)."""
    return _checked(values, (3,), "a vector (x, y, z) has shape (..., 3)")


def as_quats(values: ArrayLike) -> Quats:
    """Return quaternions as an array of float64 or of symbols; ValueError unless the shape is (..., 4)."""
    return _checked(values, (4,), "a quaternion (w, x, y, z) has shape (..., 4)")


def as_mats(values: ArrayLike) -> Mats:
    """Return matrices as an array of float64 or of symbols; ValueError unless the shape is (..., 3, 3)."""
    return _checked(values, (3, 3), "a rotation matrix has shape (..., 3, 3)")


def split(values: Array) -> list[Array]:
    """Return the components on the last axis, each of shape (..., 1)."""
    return [values[..., i : i + 1] for i in range(values.shape[-1])]


def join(components: Sequence[Array], shape: tuple[int, ...] = (-1,)) -> Array:
    """Put components of shape (..., k) side by side on the last axis, then give that axis the shape asked for."""
    batch = np.broadcast_shapes(*(c.shape[:-1] for c in components))
    together = np.concatenate([np.broadcast_to(c, (*batch, c.shape[-1]), subok=True) for c in components], axis=-1)
    return together if shape == (-1,) else together.reshape(*batch, *shape)


def dot(a: Array, b: Array) -> Array:
    """Scalar product a · b of the last axes, shape (..., 1)."""
    first, *rest = (x * y for x, y in zip(split(a), split(b), strict=True))
    return sum(rest, start=first)


def cross(a: Vecs, b: Vecs) -> Vecs:
    """Vector product a × b, shape (..., 3)."""
    (a1, a2, a3), (b1, b2, b3) = split(a), split(b)
    return join([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def apply(matrices: Mats, vectors: Vecs) -> Vecs:
    """Product of matrices (..., 3, 3) and vectors (..., 3), shape (..., 3)."""
    return (matrices @ vectors[..., None])[..., 0]


def transpose(matrices: Mats) -> Mats:
    """Swap the last two axes."""
    return matrices.swapaxes(-1, -2)


def _checked(values: ArrayLike, shape: tuple[int, ...], expected: str) -> Array:
    array = np.asanyarray(values)
    if array.dtype != object:
        array = array.astype(np.float64, casting="same_kind", copy=False)
    if array.shape[-len(shape) :] != shape:
        raise ValueError(f"shape {array.shape} given; {expected}, components last")
    return array
