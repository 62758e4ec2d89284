"""Eigenvalues s and vectors v of (s² M + s (C + G) + K) v + Aᵀ λ = 0, A v = 0, those nearest to zero."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.sparse import block_diag, csc_array

from cayley.vibration.krylov import all_of, largest
from cayley.vibration.linear import Factors, Linear

DENSE = 240
"""Up to so many degrees of freedom all eigenvalues are found by a dense matrix."""
BLOCK, LARGEST_BLOCK = 8, 64
"""Number of vectors of a Krylov space that are multiplied together, and most that are tried."""
ROUNDS, NEAR, BELOW = 20, 0.3, 0.6
"""Most shifts on the way down to the lowest square of a frequency, the part of a shift from which on it has arrived,
and where the next one is: below, for it may be that of an unstable motion, and the shifted matrix singular there."""
STILL = 100.0 * np.finfo(float).eps
"""A motion whose energy is this part of what its stiffnesses have one by one has none: it is free."""
BESIDE, TRIES = 1.0625, 3
"""Next shift where one is an eigenvalue, and how often."""
FAINT = 1e-6
"""So small a part of the shift is zero: a free motion is a double eigenvalue s = 0, split by a root of rounding."""
APART, SPARE = 1e-6, 4
"""Relative distance of eigenvalues between which one can count, and how many more are found so that there are such."""


@dataclass(frozen=True, slots=True)
class Pairs:
    """Eigenvalues by rising size, those with a negative imaginary part left out.

    Args:
        values: s [1/s], complex, shape (k,).
        vectors: with vᴴ M v = 1, real where there is neither damping nor spin, in columns, shape (n, k).
        checked: whether a count by inertia says that none is missing.
    """

    values: np.ndarray
    vectors: np.ndarray
    checked: bool


def eigenpairs(linear: Linear, count: int) -> Pairs:
    """The eigenvalues nearest to zero.

    Args:
        linear: the matrices.
        count: how many; a pair of complex conjugates counts as one.
    """
    if linear.motions <= 0:
        return Pairs(np.zeros(0, dtype=complex), np.zeros((linear.size, 0)), checked=True)
    return _real(linear, count) if linear.conservative else _complex(linear, count)


def _real(linear: Linear, count: int, *, check: bool = True) -> Pairs:
    """K v + Aᵀ λ = ω² M v, A v = 0, by shift and inversion: ν = 1/(ω² + σ), counted by the inertia of K ± ω² M."""
    count = min(count, linear.motions)
    root, factors = _regular(linear, np.sqrt(_lowest(linear)))
    scale = root**2
    up, down = _roots(linear)

    def apply(y: np.ndarray) -> np.ndarray:
        return up.T @ factors.solve(up @ y)

    block = BLOCK
    while True:
        if linear.size <= DENSE:
            nu, y = all_of(apply, linear.size, symmetric=True)
            nu, y = nu[: linear.motions], y[:, : linear.motions]
        else:
            nu, y = largest(apply, linear.size, min(count + SPARE, linear.motions), block, symmetric=True)
        squares, vectors = 1.0 / nu - scale, down.T @ y
        order = np.argsort(np.abs(squares), kind="stable")
        squares, vectors = squares[order], vectors[:, order]
        known = _counted(linear, squares, count) if check else None
        if known is not False or block >= LARGEST_BLOCK or linear.size <= DENSE:
            break
        block *= 2
    squares, vectors = squares[:count], vectors[:, :count]
    squares[np.abs(squares) <= np.maximum(_rounding(linear, vectors), STILL * scale)] = 0.0
    order = np.argsort(np.abs(squares), kind="stable")
    return Pairs(np.sqrt(0.0 - squares[order] + 0j), vectors[:, order], checked=bool(known))


def _complex(linear: Linear, count: int) -> Pairs:
    """With w = s v a problem of first order, by shift and inversion: ν = 1/(s − σ), σ > 0.

    P(σ) = σ² M + σ (C + G) + K,   v ← −P⁻¹ (M w + (C + G + σ M) v),   w ← v + σ v'
    """
    middle, free = _middle(linear, count)
    sigma, factors = _regular(linear, middle)
    rates = linear.rates
    up, down = _roots(linear)
    within = down @ rates @ down.T  # in the coordinates y = Lᵀ v, with M = L Lᵀ

    def apply(z: np.ndarray) -> np.ndarray:
        v, w = np.split(z, 2)  # w over σ, so that both are of one size
        right = sigma * (w + v) + within @ v
        found = -(up.T @ factors.solve(up @ right))
        return np.concatenate([found, v / sigma + found])

    size = 2 * linear.size
    if size <= DENSE:
        nu, z = all_of(apply, size, symmetric=False)
        nu, z = nu[: 2 * linear.motions], z[:, : 2 * linear.motions]
    else:
        wanted = min(2 * count + BLOCK, 2 * linear.motions)
        nu, z = largest(apply, size, wanted, max(BLOCK, free + 2), symmetric=False)
    values = sigma + 1.0 / nu
    vectors = down.T @ z[: linear.size]
    vectors = vectors / np.sqrt(np.einsum("ij,ij->j", vectors.conj(), linear.mass @ vectors).real)
    values[np.abs(values) ** 2 <= np.maximum(_rounding(linear, vectors), (FAINT * sigma) ** 2)] = 0.0
    values.real[np.abs(values.real) <= FAINT**2 * np.abs(values)] = 0.0
    values, vectors = _halved(values, vectors)
    order = np.argsort(np.abs(values), kind="stable")[:count]
    return Pairs(values[order], _turned(vectors[:, order]), checked=False)


def _halved(values: np.ndarray, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """One of each pair of complex conjugates, and of each double zero."""
    kept = values.imag > 0.0
    kept |= (values.imag == 0.0) & (values.real != 0.0)
    zeros = np.flatnonzero(values == 0.0)
    kept[zeros[_independent(vectors[:, zeros])]] = True
    return values[kept], vectors[:, kept]


def _independent(vectors: np.ndarray) -> np.ndarray:
    """Which columns are not, nearly, combinations of those before."""
    kept: list[int] = []
    for k, column in enumerate(vectors.T):
        rest = column
        if kept:
            rest = column - vectors[:, kept] @ np.linalg.lstsq(vectors[:, kept], column)[0]
        if np.linalg.norm(rest) > 1e-3 * np.linalg.norm(column):
            kept.append(k)
    return np.array(kept, dtype=int)


def _turned(vectors: np.ndarray) -> np.ndarray:
    """Vectors times a unit number that makes the largest entry of each real and positive."""
    largest_of = np.take_along_axis(vectors, np.argmax(np.abs(vectors), axis=0)[None], axis=0)
    return vectors * (np.abs(largest_of) / largest_of)


def _lowest(linear: Linear) -> float:
    """A bit less than the square of the lowest frequency that is not zero [1/s²].

    Inverse iteration of a few vectors, shifted from above to where it arrives; so none is magnified out of proportion.
    """
    up, down = _roots(linear)
    stiffness = 0.5 * (linear.stiffness + linear.stiffness.T)
    ratios = np.abs(stiffness.diagonal() / linear.mass.diagonal()).max(initial=0.0)
    rates = np.abs(linear.rates.diagonal() / linear.mass.diagonal()).max(initial=0.0)
    shift = next((float(scale) for scale in (ratios, rates**2) if scale > 0.0), 1.0)
    y = np.random.default_rng(1).standard_normal((linear.size, min(2 * BLOCK, linear.motions)))
    for _ in range(ROUNDS):
        factors = _regular(linear, np.sqrt(shift))[1]
        for _ in range(2):
            y = np.linalg.qr(up.T @ factors.solve(up @ y))[0]
        v = down.T @ y
        squares, small = np.linalg.eigh(v.T @ (stiffness @ v))
        squares = np.abs(squares)
        moving = squares[squares > 10.0 * np.maximum(_rounding(linear, v @ small), STILL * squares.max())]
        if not len(moving):
            break
        arrived = moving.min() > NEAR * shift
        shift = BELOW * float(moving.min())
        if arrived:
            break
    return shift


def _regular(linear: Linear, s: float) -> tuple[float, Factors]:
    """A number near s [1/s] that is no eigenvalue, and the factors there."""
    for _ in range(TRIES):
        try:
            return s, linear.factorized(s)
        except RuntimeError:  # an unstable motion that grows just like exp(s t)
            s *= BESIDE
    return s, linear.factorized(s)


def _middle(linear: Linear, count: int) -> tuple[float, int]:
    """About the frequency halfway up to the last one wanted [rad/s], and how many are zero, without C, G and skew K."""
    stiffness = csc_array(0.5 * (linear.stiffness + linear.stiffness.T))
    nothing = csc_array(linear.mass.shape)
    alone = replace(linear, damping=nothing, gyroscopic=nothing, stiffness=stiffness)
    lowest = np.sqrt(_lowest(linear))
    found = np.abs(_real(alone, count, check=False).values)
    return max(0.5 * float(found.max(initial=0.0)), lowest), int((found == 0.0).sum())


def _rounding(linear: Linear, vectors: np.ndarray) -> np.ndarray:
    """Squares of frequencies that are rounding errors of Σ vᵢ Kᵢⱼ vⱼ, for each column [1/s²]."""
    size = np.abs(vectors)
    return STILL * np.einsum("ij,ij->j", size, abs(linear.stiffness) @ size)


def _roots(linear: Linear) -> tuple[csc_array, csc_array]:
    """L with L Lᵀ = M, and its inverse; M has one block a node."""
    node = linear.dofs[:, 0]
    edges = np.flatnonzero(np.diff(node, prepend=-1, append=-1))
    blocks = [linear.mass[a:b, a:b].toarray() for a, b in pairwise(edges)]
    roots = [np.linalg.cholesky(block) for block in blocks]
    return csc_array(block_diag(roots)), csc_array(block_diag([np.linalg.inv(root) for root in roots]))


def _counted(linear: Linear, squares: np.ndarray, count: int) -> bool | None:
    """Whether no eigenvalue is missing below the next one after count, by inertia; None where that cannot be said."""
    sizes = np.abs(squares)
    for k in range(count, len(sizes)):
        low, high = sizes[k - 1], sizes[k]
        if high > (1.0 + APART) * low and high > 0.0:
            middle = 0.5 * (low + high)
            still = linear.about.still
            return still.unstable(inertia=-middle) - still.unstable(inertia=middle) == k
    if len(sizes) >= linear.motions:
        return True
    return None
