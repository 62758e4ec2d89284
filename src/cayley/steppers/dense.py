"""Small dense linear algebra for drivers: LU with row pivots."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
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


@njit(cache=True, nogil=True, error_model="numpy")
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
