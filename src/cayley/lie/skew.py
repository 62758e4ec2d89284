"""Vectors of R³ as skew matrices of so(3), and back."""

import numpy as np
from numpy.typing import ArrayLike

from cayley.lie.arrays import Mats, Vecs, as_mats, as_vecs, join, split


def hat(v: ArrayLike) -> Mats:
    """Skew matrix of a vector.

    hat(v) u = v × u

    Args:
        v: vectors, shape (..., 3).

    Returns: matrices, shape (..., 3, 3).
    """
    x, y, z = split(as_vecs(v))
    o = np.zeros_like(x)
    return join([o, -z, y, z, o, -x, -y, x, o], (3, 3))


def vee(a: ArrayLike) -> Vecs:
    """Axial vector of the skew part of a matrix, the inverse of hat.

    v = ½ (A₃₂ - A₂₃, A₁₃ - A₃₁, A₂₁ - A₁₂)

    Args:
        a: matrices, shape (..., 3, 3); a symmetric part is ignored.

    Returns: vectors, shape (..., 3).
    """
    a = as_mats(a)
    return join([(a[..., i, k, None] - a[..., k, i, None]) / 2 for i, k in ((2, 1), (0, 2), (1, 0))])
