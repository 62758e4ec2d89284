"""Derivatives through a chain of maps against those of the composed expression."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.discrete.jet import congruent, jet

X = ca.SX.sym("x", 3)
M = ca.SX.sym("m", 4)
INNER = ca.vertcat(ca.sin(X[0]) * X[1], X[1] * X[2] ** 2, X[0], ca.exp(X[2] - X[0]))
OUTER = ca.vertcat(M[0] * M[1] + M[2] ** 3, M[3] / (2.0 + M[1] ** 2))
WEIGHTS = ca.DM([0.7, -1.3])
AT = np.array([0.3, -0.8, 0.5])


def numbers(*matrices: ca.SX) -> list[np.ndarray]:
    return [np.array(m) for m in ca.Function("f", [X], [ca.densify(m) for m in matrices])(AT)]


@pytest.mark.parametrize("links", [1, 2])
def test_chain_rule(links):
    """Two functions of four of three unknowns; or through another linear link."""
    mixing = ca.DM(np.random.default_rng(1).normal(size=(3, 3)))
    inner, final = (INNER, X) if links == 1 else (ca.substitute([INNER], [X], [mixing @ X])[0], mixing @ X)
    value = ca.substitute([OUTER], [M], [inner])[0]
    found = jet(OUTER, M, inner, weights=ca.SX(WEIGHTS), second=True).through(INNER, X, final)
    if links == 2:
        found = found.through(mixing @ X, X, X)
    weighted = ca.dot(WEIGHTS, value)
    expected = numbers(value, ca.jacobian(value, X), ca.hessian(weighted, X)[0])
    for one, other in zip(numbers(found.values, found.slope, found.curvature), expected, strict=True):
        assert_allclose(one, other, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("rows", [1, 2])
def test_without_the_hessian(rows):
    """One row goes backward, more of them by the Jacobian."""
    found = jet(OUTER[:rows], M, INNER, weights=ca.SX(WEIGHTS)[:rows], second=False).through(INNER, X, X)
    value = ca.substitute([OUTER[:rows]], [M], [INNER])[0]
    assert found.curvature is None
    assert_allclose(*numbers(found.slope, ca.jacobian(value, X)), rtol=1e-13, atol=1e-14)


def test_congruent_keeps_what_is_empty():
    """Jᵀ M J, with an empty column of J and an empty row of M."""
    jacobian = ca.sparsify(ca.DM([[1.0, 0.0, 2.0], [0.0, 0.0, 3.0], [4.0, 0.0, 0.0]]))
    matrix = ca.sparsify(ca.DM([[1.0, 0.0, 5.0], [0.0, 0.0, 0.0], [5.0, 0.0, 2.0]]))
    found = congruent(ca.SX(matrix), ca.SX(jacobian))
    assert found.nnz() == 4
    assert_allclose(np.array(ca.DM(found)), np.array(jacobian).T @ np.array(matrix) @ np.array(jacobian))
