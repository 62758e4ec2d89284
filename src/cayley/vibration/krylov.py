"""Eigenvalues of largest size of an operator, by a block Krylov space.

Blocks, because round rods and free bodies have eigenvalues that are the same several times, of which a single vector
sees one; and from fixed vectors, so that a result is the same every time.
"""

from collections.abc import Callable

import numpy as np
from scipy.linalg import qr

TOLERANCE = 1e-10
"""Largest residual of an eigenvector, over its eigenvalue."""
GROWTH = 1.25
"""How much a space grows until one looks again whether it is large enough."""
GONE = 1e-13
"""Part of its length that a direction must keep beside those there are; less is rounding."""

Operator = Callable[[np.ndarray], np.ndarray]


def largest(apply: Operator, size: int, wanted: int, block: int, *, symmetric: bool) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues ν of largest size, F x = ν x, by falling size.

    V ← [V, F V_last] orthonormal, H = Vᵀ F V; eigenvalues of H, until what F V has outside of V is negligible for as
    many as are wanted.

    Args:
        apply: F, of vectors in columns.
        size: of a vector.
        wanted: how many eigenvalues.
        block: number of vectors that are multiplied together: an eigenvalue is found at least so many times.
        symmetric: whether F is.

    Returns: values, at least as many as wanted or all there are, and vectors in columns.

    Raises:
        RuntimeError: if they do not converge.

    Source: Y. Saad, Numerical methods for large eigenvalue problems (2011), section 6.5.
    """
    most = min(size, 12 * (wanted + block))
    nothing = np.zeros((size, 0))
    start = apply(np.random.default_rng(1).standard_normal((size, min(block, size))))  # in the range of F
    basis, images, fresh, next_look = nothing, nothing, _orthonormal(apply(start), nothing), wanted
    while True:
        image = apply(fresh)
        basis, images = np.hstack([basis, fresh]), np.hstack([images, image])
        fresh = _orthonormal(image, basis)
        full = basis.shape[1] + fresh.shape[1] > most or not fresh.shape[1]
        if basis.shape[1] < next_look and not full:
            continue
        next_look = int(GROWTH * basis.shape[1])
        projected = basis.T @ images
        values, small = _eigen(projected, symmetric=symmetric)
        outside = (images - basis @ projected) @ small
        good = np.linalg.norm(outside, axis=0) <= TOLERANCE * np.abs(values)
        reached = len(good) if good.all() else int(np.argmin(good))
        if reached >= wanted:
            return values[:reached], basis @ small[:, :reached]
        if not fresh.shape[1]:  # the space is invariant
            return values, basis @ small
        if full:
            raise RuntimeError(
                f"only {reached} of {wanted} modes converged in a Krylov space of {basis.shape[1]}; ask for fewer"
            )


def all_of(apply: Operator, size: int, *, symmetric: bool) -> tuple[np.ndarray, np.ndarray]:
    """The same, all of them, by a dense matrix."""
    values, vectors = _eigen(apply(np.eye(size)), symmetric=symmetric)
    kept = np.abs(values) > GONE * np.abs(values).max(initial=0.0)
    return values[kept], vectors[:, kept]


def _eigen(matrix: np.ndarray, *, symmetric: bool) -> tuple[np.ndarray, np.ndarray]:
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T)) if symmetric else np.linalg.eig(matrix)
    order = np.argsort(-np.abs(values), kind="stable")
    return values[order], vectors[:, order]


def _orthonormal(x: np.ndarray, basis: np.ndarray) -> np.ndarray:
    """Columns of x, without what lies in the basis, orthonormal; directions that are rounding are left out."""
    length = np.linalg.norm(x, axis=0)
    x = x[:, length > 0.0] / length[length > 0.0]
    for _ in range(2):
        x = x - basis @ (basis.T @ x)
        x, r, _ = qr(x, mode="economic", pivoting=True)
        x = x[:, np.abs(np.diag(r)) > GONE]
    return x
