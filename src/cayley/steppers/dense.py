"""Small dense linear algebra for drivers: LU with row pivots, and block elimination along a chain."""

import functools
from collections.abc import Callable

import numpy as np
from numba import njit

_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def factorize(matrix: np.ndarray, pivots: np.ndarray) -> None:
    """LU factorization with row pivots, in place.

    Args:
        matrix: shape (n, n); replaced by L (unit diagonal) and U.
        pivots: row exchanged with row k, shape (n,); filled here.
    """
    n = matrix.shape[0]
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        pivots[k] = best
        if best != k:
            for j in range(n):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
        inverse = 1.0 / matrix[k, k]
        for i in range(k + 1, n):
            factor = matrix[i, k] * inverse
            matrix[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    matrix[i, j] -= factor * matrix[k, j]


@njit(**_options)
def solve_factorized(lu: np.ndarray, pivots: np.ndarray, b: np.ndarray) -> None:
    """Solve A x = b in place with the result of factorize."""
    n = lu.shape[0]
    for k in range(n):
        if pivots[k] != k:
            b[k], b[pivots[k]] = b[pivots[k]], b[k]
    for i in range(n):
        for k in range(i):
            b[i] -= lu[i, k] * b[k]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            b[i] -= lu[i, k] * b[k]
        b[i] /= lu[i, i]


@njit(**_options)
def solve_columns(lu: np.ndarray, pivots: np.ndarray, b: np.ndarray) -> None:
    """Solve A X = B in place, row by row of B, so that the inner loop runs over memory in order."""
    n, width = b.shape
    for k in range(n):
        if pivots[k] != k:
            for j in range(width):
                b[k, j], b[pivots[k], j] = b[pivots[k], j], b[k, j]
    for i in range(n):
        for k in range(i):
            factor = lu[i, k]
            if factor != 0.0:
                for j in range(width):
                    b[i, j] -= factor * b[k, j]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            factor = lu[i, k]
            if factor != 0.0:
                for j in range(width):
                    b[i, j] -= factor * b[k, j]
        inverse = 1.0 / lu[i, i]
        for j in range(width):
            b[i, j] *= inverse


@njit(**_options)
def subtract_product(out: np.ndarray, a: np.ndarray, b: np.ndarray) -> None:
    """Subtract A B from a matrix, skipping zeros of A."""
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            factor = a[i, k]
            if factor != 0.0:
                for j in range(b.shape[1]):
                    out[i, j] -= factor * b[k, j]


@njit(**_options)
def subtract_vector(out: np.ndarray, a: np.ndarray, x: np.ndarray) -> None:
    """Subtract A x from a vector."""
    for i in range(a.shape[0]):
        total = 0.0
        for k in range(a.shape[1]):
            total += a[i, k] * x[k]
        out[i] -= total


@functools.cache
def chain_solver(n: int) -> Callable[..., None]:
    """A solver of block tridiagonal systems whose blocks have n rows: a size known to the compiler unrolls its loops.

    Returns: function (data, lanes, at, first, last, free, upper, right) -> None. The blocks of node a are read from
    data[1 + a // lanes, row, a % lanes], rows ``at`` = (diagonal, upper, lower), those of held components replaced;
    right, shape (nodes, n), is replaced by the solution; upper, shape (nodes, n, n), is room.
    """

    @njit(**_options)
    def solve(data, at, first, last, free, upper, right):  # type: ignore[no-untyped-def]
        lanes = data.shape[2]
        a, b = np.empty((n, n)), np.empty((n, n + 1))
        for k in range(first, last):
            block, lane = 1 + k // lanes, k % lanes
            for i in range(n):
                for j in range(n):
                    a[i, j] = data[block, at[0] + i * n + j, lane]
                    b[i, j] = data[block, at[1] + i * n + j, lane]
                b[i, n] = right[k, i]
            if k > first:
                behind, place = 1 + (k - 1) // lanes, (k - 1) % lanes
                for i in range(n):
                    for m in range(n):
                        factor = data[behind, at[2] + i * n + m, place]
                        for j in range(n):
                            a[i, j] -= factor * upper[k - 1, m, j]
                        b[i, n] -= factor * right[k - 1, m]
            for i in range(n):
                if not free[k, i]:
                    for j in range(n):
                        a[i, j], b[i, j] = 0.0, 0.0
                    a[i, i], b[i, n] = 1.0, 0.0
            for c in range(n):
                best = c
                for i in range(c + 1, n):
                    if abs(a[i, c]) > abs(a[best, c]):
                        best = i
                if best != c:
                    for j in range(n):
                        a[c, j], a[best, j] = a[best, j], a[c, j]
                    for j in range(n + 1):
                        b[c, j], b[best, j] = b[best, j], b[c, j]
                inverse = 1.0 / a[c, c]
                for j in range(n):
                    a[c, j] *= inverse
                for j in range(n + 1):
                    b[c, j] *= inverse
                for i in range(n):
                    if i != c:
                        factor = a[i, c]
                        for j in range(c + 1, n):
                            a[i, j] -= factor * a[c, j]
                        for j in range(n + 1):
                            b[i, j] -= factor * b[c, j]
            for i in range(n):
                for j in range(n):
                    upper[k, i, j] = b[i, j]
                right[k, i] = b[i, n]
        for k in range(last - 2, first - 1, -1):
            for i in range(n):
                total = 0.0
                for j in range(n):
                    total += upper[k, i, j] * right[k + 1, j]
                right[k, i] -= total

    return solve
