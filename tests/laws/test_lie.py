"""The laws of the rotation group, for any rotation, near the identity and for p and -p."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cayley.lie import cayley, exponential, quaternion, rotation

LAW = settings(deadline=None, max_examples=60, derandomize=True)
TIGHT = {"rtol": 0, "atol": 4e-15}


@st.composite
def rotation_vectors(draw, longest=3.1):
    """Draw a rotation vector, its length even on a log scale from 1e-12 [rad], or zero."""
    axis = np.array([draw(st.floats(-1, 1)) for _ in range(3)])
    if np.linalg.norm(axis) < 1e-3:
        return np.zeros(3)
    return 10 ** draw(st.floats(-12, np.log10(longest))) * axis / np.linalg.norm(axis)


@st.composite
def unit_quaternions(draw):
    """Draw p or -p of any rotation, also close to the identity and to half turns."""
    sign = draw(st.sampled_from([1.0, -1.0]))
    start = draw(st.sampled_from(np.vstack([np.eye(4), [[0.5, 0.5, -0.5, 0.5]]]).tolist()))
    return sign * quaternion.multiply(start, exponential.exp(draw(rotation_vectors())))


@st.composite
def vectors(draw):
    """Draw a vector with components up to 10."""
    return np.array([draw(st.floats(-10, 10)) for _ in range(3)])


@LAW
@given(unit_quaternions(), unit_quaternions(), unit_quaternions())
def test_group_of_quaternions(p, q, r):
    multiply, conjugate, one = quaternion.multiply, quaternion.conjugate, quaternion.identity()
    assert_allclose(multiply(multiply(p, q), r), multiply(p, multiply(q, r)), **TIGHT)
    assert_allclose(multiply(p, one), p, rtol=0, atol=0)
    assert_allclose(multiply(one, p), p, rtol=0, atol=0)
    assert_allclose(multiply(p, conjugate(p)), one, **TIGHT)
    assert_allclose(conjugate(multiply(p, q)), multiply(conjugate(q), conjugate(p)), **TIGHT)
    assert_allclose(quaternion.norm(multiply(p, q)), 1, **TIGHT)
    assert_allclose(quaternion.relative(multiply(r, p), multiply(r, q)), quaternion.relative(p, q), **TIGHT)


@LAW
@given(unit_quaternions(), unit_quaternions(), vectors(), vectors())
def test_action_on_vectors(p, q, u, v):
    rotate, size = quaternion.rotate, 1 + np.linalg.norm(u) * np.linalg.norm(v)
    assert_allclose(rotate(quaternion.multiply(p, q), v), rotate(p, rotate(q, v)), rtol=0, atol=1e-13)
    assert_allclose(quaternion.inverse_rotate(p, rotate(p, v)), v, rtol=0, atol=1e-13)
    assert_allclose(rotate(-p, v), rotate(p, v), rtol=0, atol=0)
    assert_allclose(rotate(p, u) @ rotate(p, v), u @ v, rtol=0, atol=1e-14 * size)
    assert_allclose(np.cross(rotate(p, u), rotate(p, v)), rotate(p, np.cross(u, v)), rtol=0, atol=1e-14 * size)


@LAW
@given(unit_quaternions(), unit_quaternions(), vectors())
def test_matrices_represent_quaternions(p, q, v):
    matrix = quaternion.to_matrix
    assert_allclose(matrix(quaternion.multiply(p, q)), rotation.compose(matrix(p), matrix(q)), **TIGHT)
    assert_allclose(matrix(quaternion.relative(p, q)), rotation.relative(matrix(p), matrix(q)), **TIGHT)
    assert_allclose(rotation.rotate(matrix(p), v), quaternion.rotate(p, v), rtol=0, atol=1e-13)
    assert_allclose(matrix(-p), matrix(p), rtol=0, atol=0)
    assert rotation.orthogonality_defect(matrix(p)) < 5e-15
    assert_allclose(np.linalg.det(matrix(p)), 1, **TIGHT)
    back = quaternion.from_matrix(matrix(p))
    assert back[0] >= 0
    assert_allclose(min(np.abs(back - p).max(), np.abs(back + p).max()), 0, **TIGHT)


@LAW
@given(unit_quaternions())
def test_exponential_and_logarithm(p):
    eta = exponential.log(p)
    assert np.linalg.norm(eta) <= np.pi * (1 + 1e-15)
    again = exponential.exp(eta)
    assert_allclose(again, p if again @ p > 0 else -p, **TIGHT)
    if abs(p[0]) > 1e-12:
        assert_allclose(exponential.log(-p), eta, **TIGHT)
        assert_allclose(exponential.log(quaternion.conjugate(p)), -eta, **TIGHT)
    assert_allclose(exponential.log(3 * p), eta, **TIGHT)


@LAW
@given(rotation_vectors())
def test_logarithm_keeps_small_rotations(eta):
    """The error is relative to the rotation, however small."""
    bound = 2e-15 * np.linalg.norm(eta)
    assert np.linalg.norm(exponential.log(exponential.exp(eta)) - eta) <= bound
    assert np.linalg.norm(rotation.log(rotation.exp(eta)) - eta) <= bound
    assert_allclose(rotation.exp(eta), quaternion.to_matrix(exponential.exp(eta)), **TIGHT)


@LAW
@given(rotation_vectors(), unit_quaternions())
def test_adjoint(eta, p):
    """Conjugation rotates the vector: p exp(η) p̄ = exp(Λ(p) η); the same for Cay."""
    for function in (exponential.exp, cayley.cay):
        left = quaternion.multiply(quaternion.multiply(p, function(eta)), quaternion.conjugate(p))
        assert_allclose(left, function(quaternion.rotate(p, eta)), **TIGHT)


@LAW
@given(rotation_vectors(), rotation_vectors(1.5), rotation_vectors(0.6))
def test_cayley_map(f, a, b):
    p = cayley.cay(f)
    bound = 2e-15 * np.linalg.norm(f)
    assert_allclose(quaternion.norm(p), 1, **TIGHT)
    assert np.linalg.norm(cayley.cay_inv(p) - f) <= bound
    assert np.linalg.norm(cayley.cay_inv(-p) - f) <= bound
    assert np.linalg.norm(cayley.matrix_inv(cayley.matrix(f)) - f) <= 20 * bound
    assert_allclose(cayley.cay(-f), quaternion.conjugate(p), rtol=0, atol=0)
    assert_allclose(cayley.matrix(f), quaternion.to_matrix(p), **TIGHT)
    assert_allclose(cayley.cay(cayley.compose(a, b)), quaternion.multiply(cayley.cay(a), cayley.cay(b)), **TIGHT)
    root = cayley.cay(cayley.half(f))
    assert_allclose(quaternion.multiply(root, root), p, **TIGHT)


@LAW
@given(rotation_vectors(), vectors())
def test_derivatives_turn_with_the_rotation(v, u):
    """The derivative seen from space is the transpose: d(-v) = d(v)ᵀ = R d(v), and d(v) v lies along v."""
    for derivative, matrix in ((exponential.dexp, rotation.exp), (cayley.dcay, cayley.matrix)):
        assert_allclose(derivative(-v), derivative(v).T, **TIGHT)
        assert_allclose(matrix(v) @ derivative(v), derivative(v).T, **TIGHT)
        assert_allclose(np.cross(v, derivative(v) @ v), 0, atol=1e-14 * (1 + v @ v))
    assert_allclose(exponential.dexp(v) @ v, v, **TIGHT)
    assert_allclose(rotation.vee(rotation.hat(u)), u, rtol=0, atol=0)
    assert_allclose(rotation.hat(u) @ v, np.cross(u, v), atol=1e-14)
