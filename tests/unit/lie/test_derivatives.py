"""Trivialized derivatives against central differences, their inverses, and CasADi's differentiation."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.lie import cayley, exponential, quaternion, rotation

MAPS = {
    "cay": (cayley.cay, cayley.matrix, cayley.dcay, cayley.dcay_inv),
    "exp": (exponential.exp, rotation.exp, exponential.dexp, exponential.dexp_inv),
}
SIZES = [0.0, 1e-9, 1e-4, 0.3, 1.999, 2.001, 3.1]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", MAPS)
def test_left_trivialized_in_the_body(name, size, rng):
    to_quaternion, to_matrix, derivative, _ = MAPS[name]
    v = size * np.array([2, -1, 2]) / 3
    dv, h = rng.normal(size=3), 1e-5
    expected = derivative(v) @ dv
    dp = (to_quaternion(v + h * dv) - to_quaternion(v - h * dv)) / (2 * h)
    dr = (to_matrix(v + h * dv) - to_matrix(v - h * dv)) / (2 * h)
    assert_allclose(quaternion.body_rate(to_quaternion(v), dp), expected, atol=1e-9)
    assert_allclose(rotation.body_rate(to_matrix(v), dr), expected, atol=1e-9)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", MAPS)
def test_inverse_of_the_derivative(name, size, rng):
    *_, derivative, inverse = MAPS[name]
    axes = rng.normal(size=(2, 5, 3))
    v = size * axes / np.linalg.norm(axes, axis=-1, keepdims=True)
    assert_allclose(derivative(v) @ inverse(v), np.broadcast_to(np.eye(3), (2, 5, 3, 3)), atol=5e-15)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", MAPS)
def test_differentiated_by_casadi(name, size, derivatives):
    """CasADi's own derivative, through every branch, gives the same and is finite at zero, to second order."""
    to_quaternion, _, derivative, _ = MAPS[name]
    v = size * np.array([2, -1, 2]) / 3
    first, second = derivatives(to_quaternion, v)
    left = np.array([quaternion.body_rate(to_quaternion(v), column) for column in first.T]).T
    assert_allclose(left, derivative(v), atol=2e-15)
    h = 1e-5
    for k, step in enumerate(h * np.eye(3)):
        ahead, behind = (derivatives(to_quaternion, v + s * step)[0] for s in (1, -1))
        assert_allclose(second[:, k].reshape(first.shape, order="F"), (ahead - behind) / (2 * h), atol=1e-9)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("sign", [1, -1])
def test_log_differentiated_by_casadi(size, sign, derivatives):
    """From η = log p, dη = dexp(η)⁻¹ 2 Im(p̄ dp): also of -p, and at p = 1."""
    eta = size * np.array([2, -1, 2]) / 3
    p = sign * exponential.exp(eta)
    first, second = derivatives(exponential.log, p)
    tangents = np.array([quaternion.tangent(p, axis) for axis in np.eye(3)]).T
    assert_allclose(first @ tangents, exponential.dexp_inv(eta), atol=2e-14)
    assert np.isfinite(second).all()


def test_matrix_gradient(rng):
    r, eta, g, h = rotation.exp(rng.normal(size=3)), rng.normal(size=3), rng.normal(size=(3, 3)), 1e-6
    ahead, behind = (np.sum(g * rotation.compose(r, rotation.exp(s * h * eta))) for s in (1, -1))
    assert rotation.left_gradient(r, g) @ eta == pytest.approx((ahead - behind) / (2 * h), abs=1e-8)
    assert_allclose(rotation.body_rate(r, rotation.tangent(r, eta)), eta, atol=1e-15)
