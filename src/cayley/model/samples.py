"""Polynomials through Chebyshev points: how what varies along an element is kept, as numbers."""

from __future__ import annotations

from functools import cache

import numpy as np

from cayley.model.validate import Array, frozen


@cache
def chebyshev(count: int) -> Array:
    """The Chebyshev points of [0, 1] with both ends, uₖ = ½ (1 − cos(kπ/(count − 1))); one point: its middle."""
    if count == 1:
        return frozen(np.array([0.5]))
    points = 0.5 - 0.5 * np.cos(np.pi * np.arange(count) / (count - 1))
    points[-1] = 1.0
    return frozen(points)


def basis(count: int, at: Array) -> Array:
    """Values at some places of the Lagrange polynomials through the Chebyshev points.

    ℓₖ(u) = (wₖ/(u − uₖ)) / Σⱼ wⱼ/(u − uⱼ),   wₖ = (−1)ᵏ, half of it at the ends

    Args:
        count: number of points.
        at: places in [0, 1], shape (m,).

    Returns: shape (m, count); at a point itself exactly 1 and 0.

    Source: Berrut and Trefethen (2004), Barycentric Lagrange interpolation, eq. 5.4.
    """
    if count == 1:
        return np.ones((len(at), 1))
    weights = (-1.0) ** np.arange(count)
    weights[[0, -1]] *= 0.5
    away = np.asarray(at, dtype=float)[:, None] - chebyshev(count)
    hit = away == 0.0
    at_point = hit.any(axis=1, keepdims=True)
    found = weights / np.where(at_point, 1.0, away)
    total = np.where(at_point, 1.0, found.sum(axis=1, keepdims=True))
    return np.where(at_point, hit.astype(float), found / total)


__all__ = ["basis", "chebyshev"]
