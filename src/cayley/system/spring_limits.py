"""Springs and dampers in the linearization that the step limit is about."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx
from cayley.discrete.joint import evaluator
from cayley.discrete.layout import Layout
from cayley.discrete.node import tangent
from cayley.discrete.spring import damper_program, spring_program
from cayley.lie import quaternion, skew
from cayley.system.couplings import Elastic
from cayley.system.redundancy import ground_values
from cayley.system.system import System

if TYPE_CHECKING:
    from scipy.sparse import csc_array

SHORT = 1e-3
"""A linear spring shorter than this part of its unstressed length may point anywhere after a step."""
POINT = 1e-60
"""Nor has one a direction that is shorter than this [m]: derivatives of its length overflow."""
NOTHING = 1e-12
"""Eigenvalues below this part of the largest are round-off."""
DENSE = 400
"""Up to so many columns all eigenvalues are quicker than some."""


def spring_columns(system: System, values: np.ndarray, roots: np.ndarray) -> tuple[csc_array, csc_array]:
    """B and E with B Bᵀ ≥ M^(−½) K M^(−½) and E Eᵀ = M^(−½) D M^(−½), K and D of all springs and dampers.

    K = Tᵀ ∂²V/∂z² T,  D = Tᵀ Gᵀ C G T

    T is the derivative of the nodes' values along their degrees of freedom; its own derivative adds nothing to the
    symmetric part, as V does not change with the length of a quaternion. Negative eigenvalues of a spring's K, such as
    those of a compressed one across its direction, are left out: they only lower frequencies.

    Args:
        system: the system.
        values: where to linearize, shape (nodes, rows).
        roots: M^(−½) of the nodes, zero where held, shape (nodes, dofs, dofs).

    Returns: B and E, shape (nodes × dofs, k) each.

    Raises:
        FloatingPointError: a spring has no finite derivatives, such as a twist about e3 after half a turn about e1.
    """
    stiff, damped = [], []
    for kind, grounded in sorted({(spring.kind, spring.grounded) for spring in system.springs}):
        alike = [spring for spring in system.springs if (spring.kind, spring.grounded) == (kind, grounded)]
        ends = np.array([[s.first, s.second][: 2 - grounded] for s in alike])
        with np.errstate(all="ignore"):  # what is not finite is looked for
            stiffness, damping = _matrices(system.layout, alike, values)
        if not (np.isfinite(stiffness).all() and np.isfinite(damping).all()):
            raise FloatingPointError(f"a {kind} spring has no finite derivatives here")
        stiff.append(_columns(stiffness, ends, roots))
        damped.append(_columns(damping, ends, roots))
    from scipy.sparse import csc_array, hstack

    return csc_array(hstack(stiff)), csc_array(hstack(damped))


def largest(columns: csc_array) -> float:
    """Largest eigenvalue of B Bᵀ, with a margin for what iterations leave."""
    gram = columns.T @ columns
    if gram.shape[0] <= DENSE:
        return float(np.linalg.eigvalsh(gram.toarray()).max(initial=0.0)) * (1.0 + 1e-9)
    start = np.random.default_rng(0).normal(size=gram.shape[0])
    from scipy.sparse.linalg import eigsh

    return float(eigsh(gram, k=1, v0=start, tol=1e-5, return_eigenvectors=False)[0]) * 1.001


def _matrices(layout: Layout, alike: Sequence[Elastic], values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """K and D of springs of one kind, left-trivialized, shape (m, 2 dofs, 2 dofs) each."""
    kind, grounded, rows = alike[0].kind, alike[0].grounded, layout.rows
    first = values[[spring.first for spring in alike]]
    second = np.tile(ground_values(layout), (len(alike), 1)) if grounded else values[[s.second for s in alike]]
    sides, given = np.hstack([first, second]), np.array([spring.parameters for spring in alike])
    turn = _tangents(layout, sides)
    found = evaluator(spring_program(kind, layout, grounded=grounded))(np.hstack([sides, given]))
    hessian = np.zeros((len(alike), 2 * rows, 2 * rows))
    i, k = np.triu_indices(2 * rows)
    hessian[:, i, k] = hessian[:, k, i] = found[:, 1 + 2 * rows :]
    stiffness = _pulled(hessian, turn)
    if kind == "linear":
        directions = _any_direction(layout, sides, given)
        stiffness = np.where(_short(layout, sides, given)[:, None, None], directions, stiffness)
    row = np.hstack([sides, np.zeros_like(sides), given])
    found = evaluator(damper_program(kind, layout, grounded=grounded))(row)
    jacobian = found[:, 2 * rows :].reshape(len(alike), 2 * rows, 4 * rows)
    return stiffness, _pulled(-jacobian[:, :, 2 * rows :], turn)


def _tangents(layout: Layout, sides: np.ndarray) -> np.ndarray:
    """T of both nodes together, (m, 2 rows) -> (m, 2 rows, 2 dofs)."""
    ends = [symbols(name, layout.rows) for name in ("a", "b")]
    turn = ca.densify(ca.diagcat(*[tangent(layout, end) for end in ends]))
    function = ca.Function("tangents", [ca.vertcat(*[to_sx(end) for end in ends])], [ca.vec(turn.T)])
    return np.array(function(sides.T)).T.reshape(len(sides), 2 * layout.rows, 2 * layout.dofs)


def _pulled(matrices: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Symmetric parts of Tᵀ A T."""
    pulled = turn.transpose(0, 2, 1) @ matrices @ turn
    return np.asarray(0.5 * (pulled + pulled.transpose(0, 2, 1)))


def _short(layout: Layout, sides: np.ndarray, given: np.ndarray) -> np.ndarray:
    """Which linear springs have next to no length, shape (m,)."""
    first, second = (_point(layout, sides, given, k) for k in (0, 1))
    return np.asarray(np.linalg.norm(second - first, axis=1) <= np.maximum(SHORT * given[:, 16], POINT))


def _any_direction(layout: Layout, sides: np.ndarray, given: np.ndarray) -> np.ndarray:
    """Of linear springs that are stiff in every direction, K = k Aᵀ A with A = ∂(P_B − P_A), (m, 2 dofs, 2 dofs)."""
    apart = np.zeros((len(sides), 3, 2 * layout.dofs))
    for k, sign in ((0, -1.0), (1, 1.0)):
        p = sides[:, k * layout.rows :][:, layout.rows_of("p")]
        own = apart[:, :, k * layout.dofs : (k + 1) * layout.dofs]
        own[:, :, layout.dofs_of("p")] = -sign * quaternion.to_matrix(p) @ skew.hat(given[:, 7 * k : 7 * k + 3])
        own[:, :, layout.dofs_of("x")] = sign * np.eye(3)
    return np.asarray(given[:, 14, None, None] * (apart.transpose(0, 2, 1) @ apart))


def _point(layout: Layout, sides: np.ndarray, given: np.ndarray, k: int) -> np.ndarray:
    """P = x + Λ(p) o of side k, shape (m, 3)."""
    node = sides[:, k * layout.rows :]
    turned = quaternion.rotate(node[:, layout.rows_of("p")], given[:, 7 * k : 7 * k + 3])
    return np.asarray(node[:, layout.rows_of("x")] + turned)


def _columns(matrices: np.ndarray, ends: np.ndarray, roots: np.ndarray) -> csc_array:
    """√λ v of the positive eigenvalues λ of M^(−½) A M^(−½) of each spring, on the degrees of freedom of all nodes.

    Args:
        matrices: A, shape (m, 2 dofs, 2 dofs).
        ends: the nodes they are about, shape (m, 1 or 2).
        roots: M^(−½) of all nodes, shape (nodes, dofs, dofs).
    """
    count, width = ends.shape
    n, d, _ = roots.shape
    scale = np.zeros((count, width * d, width * d))
    for k in range(width):
        scale[:, k * d : (k + 1) * d, k * d : (k + 1) * d] = roots[ends[:, k]]
    scaled = scale @ matrices[:, : width * d, : width * d] @ scale
    eigenvalues, vectors = np.linalg.eigh(scaled)
    which, what = np.nonzero(eigenvalues > NOTHING * np.abs(eigenvalues).max(axis=1, keepdims=True))
    entries = vectors.transpose(0, 2, 1)[which, what] * np.sqrt(eigenvalues[which, what])[:, None]
    places = (ends[:, :, None] * d + np.arange(d)).reshape(count, -1)[which]
    column = np.broadcast_to(np.arange(len(which))[:, None], entries.shape)
    from scipy.sparse import coo_array, csc_array

    return csc_array(coo_array((entries.ravel(), (places.ravel(), column.ravel())), shape=(n * d, len(which))))


__all__ = ["largest", "spring_columns"]
