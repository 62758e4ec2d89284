"""Quaternion algebra against its definition and against SciPy."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from cayley.lie import exponential, quaternion, rotation

ONE, QI, QJ, QK = np.eye(4)


def test_hamilton_table():
    multiply = quaternion.multiply
    for unit in (QI, QJ, QK):
        assert_allclose(multiply(unit, unit), -ONE)
    assert_allclose(multiply(multiply(QI, QJ), QK), -ONE)
    assert_allclose(multiply(QI, QJ), QK)
    assert_allclose(multiply(QJ, QI), -QK)


def test_rotates_from_body_to_space():
    quarter_about_z = exponential.exp([0.0, 0.0, np.pi / 2])
    assert_allclose(quaternion.rotate(quarter_about_z, [1, 0, 0]), [0, 1, 0], atol=3e-16)
    assert_allclose(quaternion.inverse_rotate(quarter_about_z, [0, 1, 0]), [1, 0, 0], atol=3e-16)


def test_rotate_is_the_sandwich_product(unit, vectors):
    sandwich = quaternion.multiply(quaternion.multiply(unit, quaternion.pure(vectors)), quaternion.conjugate(unit))
    assert_allclose(quaternion.real(sandwich), 0, atol=1e-15)
    assert_allclose(quaternion.rotate(unit, vectors), quaternion.imaginary(sandwich), atol=2e-15)
    assert_allclose(rotation.rotate(quaternion.to_matrix(unit), vectors), quaternion.imaginary(sandwich), atol=2e-15)


def test_agrees_with_scipy(unit, vectors):
    p, q, v = unit.reshape(-1, 4), unit[::-1].reshape(-1, 4), vectors.reshape(-1, 3)
    a, b = quaternion.to_scipy(p), quaternion.to_scipy(q)
    positive = p * np.sign(p[:, :1])
    assert_allclose(quaternion.from_scipy(a), p, atol=1e-15)
    assert_allclose(quaternion.to_matrix(quaternion.multiply(p, q)), (a * b).as_matrix(), atol=2e-15)
    assert_allclose(quaternion.to_matrix(quaternion.relative(p, q)), (a.inv() * b).as_matrix(), atol=2e-15)
    assert_allclose(quaternion.rotate(p, v), a.apply(v), atol=2e-15)
    assert_allclose(quaternion.inverse_rotate(p, v), a.apply(v, inverse=True), atol=2e-15)
    assert_allclose(quaternion.to_matrix(p), a.as_matrix(), atol=1e-15)
    assert_allclose(quaternion.from_matrix(a.as_matrix()), positive, atol=1e-15)
    assert_allclose(quaternion.to_rotation_vector(p), a.as_rotvec(), atol=5e-15)
    assert_allclose(quaternion.to_matrix(exponential.exp(v)), Rotation.from_rotvec(v).as_matrix(), atol=2e-15)


def test_scipy_scalar_is_last():
    assert_allclose(quaternion.to_scipy(QI).as_quat(), [1, 0, 0, 0])
    assert_allclose(quaternion.from_scipy(Rotation.identity()), ONE)


def test_from_matrix_at_half_turns_and_ties():
    for p in [QI, QJ, QK, (QI + QJ) / np.sqrt(2), (ONE + QI + QJ - QK) / 2, (QI - QJ + QK) / np.sqrt(3)]:
        assert_allclose(quaternion.from_matrix(quaternion.to_matrix(p)), p, atol=3e-16)


def test_normalize_and_norm(unit):
    assert_allclose(quaternion.norm(3 * unit), 3, rtol=1e-15)
    assert_allclose(quaternion.normalize(3 * unit), unit, rtol=1e-15)
    assert quaternion.norm(unit).shape == (2, 5)


def test_identity_is_writable_and_batched():
    one = quaternion.identity((2, 3))
    one[0, 0] = QI
    assert one.shape == (2, 3, 4)
    assert_allclose(one[1, 2], ONE)


def test_rates_and_gradients(unit, vectors):
    p, eta, h = unit, vectors, 1e-6
    ahead, behind = (quaternion.multiply(p, exponential.exp(sign * h * eta)) for sign in (1, -1))
    assert_allclose(quaternion.tangent(p, eta), (ahead - behind) / (2 * h), atol=1e-9)
    assert_allclose(quaternion.body_rate(p, quaternion.tangent(p, eta)), eta, atol=2e-15)

    def f(p):
        return p[..., 0] * p[..., 1] ** 2 + np.sin(p[..., 2] * p[..., 3])

    w, x, y, z = np.moveaxis(p, -1, 0)
    partial = np.stack([x**2, 2 * w * x, z * np.cos(y * z), y * np.cos(y * z)], axis=-1)
    slope = np.sum(quaternion.left_gradient(p, partial) * eta, axis=-1)
    assert_allclose(slope, (f(ahead) - f(behind)) / (2 * h), atol=1e-8)


def test_broadcasts_and_accepts_lists(unit, vectors):
    assert quaternion.multiply(unit[:, None], unit).shape == (2, 2, 5, 4)
    assert quaternion.rotate(unit[0, 0], vectors).shape == (2, 5, 3)
    assert quaternion.rotate(unit, [1, 0, 0]).shape == (2, 5, 3)
    assert quaternion.multiply(np.empty((0, 4)), [1, 0, 0, 0]).shape == (0, 4)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: quaternion.multiply([1, 0, 0], ONE), r"shape \(3,\) given; a quaternion"),
        (lambda: quaternion.rotate(ONE, ONE), r"shape \(4,\) given; a vector"),
        (lambda: quaternion.from_matrix(np.eye(4)), r"shape \(4, 4\) given; a rotation matrix"),
        (lambda: exponential.exp(1.0), r"shape \(\) given; a vector"),
    ],
)
def test_wrong_shape_is_told(call, message):
    with pytest.raises(ValueError, match=message):
        call()
