"""LU factorization of banded matrices with row pivots."""

from numba import njit

_options = {"cache": True, "nogil": True, "error_model": "numpy"}

SINGULAR = 1e-14
"""A pivot this small, in a matrix whose rows and columns have a largest entry of about 1, ends the factorization."""


@njit(**_options)
def factorize_band(band, reach, lower, pivots, scales) -> int:  # type: ignore[no-untyped-def]
    """LU in place; rows and columns are scaled first, so that pivots compare forces with constraints.

    Args:
        band: entry (i, j) at [i, j − i + reach], |i − j| <= reach, shape (n, 3 reach + 1); replaced by U, whose fill
            takes the last columns.
        reach: number of diagonals on either side.
        lower: multipliers of each column, shape (n, reach); filled here.
        pivots: row exchanged with row k, shape (n,); filled here.
        scales: factors of rows and columns, shape (2, n); filled here.

    Returns: the row of a vanishing pivot, or −1.

    Source: Golub, Van Loan (2013), Matrix Computations, section 4.3.
    """
    n = band.shape[0]
    _scale(band, reach, scales)
    for k in range(n):
        end, wide = min(n, k + reach + 1), min(n, k + 2 * reach + 1)
        best, most = k, abs(band[k, reach])
        for i in range(k + 1, end):
            value = abs(band[i, k - i + reach])
            if value > most:
                best, most = i, value
        if not most > SINGULAR:
            return k
        pivots[k] = best
        if best != k:
            for j in range(k, wide):
                a, b = j - k + reach, j - best + reach
                band[k, a], band[best, b] = band[best, b], band[k, a]
        inverse = 1.0 / band[k, reach]
        for i in range(k + 1, end):
            factor = band[i, k - i + reach] * inverse
            lower[k, i - k - 1] = factor
            if factor != 0.0:
                shift = k - i
                for j in range(reach + 1, reach + wide - k):
                    band[i, j + shift] -= factor * band[k, j]
    return -1


@njit(**_options)
def _scale(band, reach, scales) -> None:  # type: ignore[no-untyped-def]
    """Divide columns, then rows, by their largest entry."""
    n = band.shape[0]
    scales[:] = 0.0
    for i in range(n):
        for j in range(max(0, i - reach), min(n, i + reach + 1)):
            scales[1, j] = max(scales[1, j], abs(band[i, j - i + reach]))
    for j in range(n):
        scales[1, j] = 1.0 / scales[1, j] if scales[1, j] > 0.0 else 1.0
    for i in range(n):
        for j in range(max(0, i - reach), min(n, i + reach + 1)):
            band[i, j - i + reach] *= scales[1, j]
            scales[0, i] = max(scales[0, i], abs(band[i, j - i + reach]))
        scales[0, i] = 1.0 / scales[0, i] if scales[0, i] > 0.0 else 1.0
        for j in range(max(0, i - reach), min(n, i + reach + 1)):
            band[i, j - i + reach] *= scales[0, i]


@njit(**_options)
def solve_band(band, reach, lower, pivots, scales, right) -> None:  # type: ignore[no-untyped-def]
    """Solve A x = b in place with the result of factorize_band."""
    n = band.shape[0]
    for i in range(n):
        right[i] *= scales[0, i]
    for k in range(n):
        if pivots[k] != k:
            right[k], right[pivots[k]] = right[pivots[k]], right[k]
        for i in range(k + 1, min(n, k + reach + 1)):
            right[i] -= lower[k, i - k - 1] * right[k]
    for i in range(n - 1, -1, -1):
        total = right[i]
        for j in range(i + 1, min(n, i + 2 * reach + 1)):
            total -= band[i, j - i + reach] * right[j]
        right[i] = total / band[i, reach]
    for i in range(n):
        right[i] *= scales[1, i]
