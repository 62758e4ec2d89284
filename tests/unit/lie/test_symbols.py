"""The same source on symbols: object arrays of CasADi scalars against numbers."""

import subprocess
import sys

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.density.expression import Expression, symbols
from cayley.lie import cayley, exponential, quaternion, rotation

QUATERNION = [
    *(quaternion.conjugate, quaternion.norm, quaternion.normalize, quaternion.to_matrix, quaternion.real),
    *(quaternion.imaginary, quaternion.to_rotation_vector, exponential.log, cayley.cay_inv),
]
QUATERNIONS = [quaternion.multiply, quaternion.relative, quaternion.body_rate, quaternion.left_gradient]
QUATERNION_VECTOR = [quaternion.rotate, quaternion.inverse_rotate, quaternion.tangent]
VECTOR = [
    *(exponential.exp, exponential.dexp, exponential.dexp_inv, quaternion.from_rotation_vector, rotation.exp),
    *(cayley.cay, cayley.matrix, cayley.dcay, cayley.dcay_inv, cayley.half, quaternion.pure, rotation.hat),
]
MATRIX = [
    *(rotation.inverse, rotation.log, rotation.to_quaternion, rotation.orthogonality_defect, rotation.vee),
    cayley.matrix_inv,
]
MATRICES = [rotation.compose, rotation.relative, rotation.body_rate, rotation.left_gradient]
MATRIX_VECTOR = [rotation.rotate, rotation.inverse_rotate, rotation.tangent]


def agree(evaluate, function, *values):
    expected = function(*values)
    result = evaluate(function, *values)
    assert result.shape == expected.shape
    assert_allclose(result, expected, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("batch", [(), (3,)])
@pytest.mark.parametrize("size", [0.0, 1e-8, 0.5, 2.5])
def test_symbols_agree_with_numbers(batch, size, evaluate, rng):
    v, u = (rng.normal(size=(*batch, 3)) for _ in range(2))
    v = size * v / np.linalg.norm(v, axis=-1, keepdims=True)
    p, q = exponential.exp(v), exponential.exp(u)
    a, b = rotation.exp(v), rotation.exp(u)
    cases = [
        *((f, p) for f in QUATERNION),
        *((f, -p) for f in QUATERNION),
        *((f, p, q) for f in QUATERNIONS),
        *((f, p, u) for f in QUATERNION_VECTOR),
        *((f, v) for f in VECTOR),
        *((f, a) for f in MATRIX),
        *((f, a, b) for f in MATRICES),
        *((f, a, u) for f in MATRIX_VECTOR),
        (cayley.compose, v, u),
    ]
    for function, *values in cases:
        agree(evaluate, function, *values)


@pytest.mark.parametrize("angle", [2.0, 3.0, np.pi])
@pytest.mark.parametrize("axis", np.eye(3))
def test_every_branch_of_from_matrix(angle, axis, evaluate):
    agree(evaluate, quaternion.from_matrix, quaternion.to_matrix(exponential.exp(angle * axis)))


def test_numbers_and_symbols_mix(evaluate, unit, vectors):
    p, v = unit[0, 0], vectors[0, 0]
    agree(evaluate, lambda v: quaternion.rotate(p, v), v)
    agree(evaluate, lambda p: quaternion.rotate(p, [0, 0, 1]), p)
    agree(evaluate, lambda v: rotation.compose(rotation.exp(v), np.eye(3)), v)
    mixed = np.array([1.0, ca.SX.sym("x"), 0.0, 0.0], dtype=object)
    assert quaternion.normalize(mixed).dtype == object
    constant = np.array([0.6, 0.0, 0.8, 0.0], dtype=object)
    assert float(ca.DM(ca.SX(exponential.log(constant)[1]))) == exponential.log(constant.astype(float))[1]


def test_works_on_the_expressions_of_a_density():
    p, v, r = symbols("p", 4), symbols("v", 3), symbols("r", 3, 3)
    calls = [
        *((f, p) for f in QUATERNION),
        *((f, p, p) for f in QUATERNIONS),
        *((f, p, v) for f in QUATERNION_VECTOR),
        *((f, v) for f in VECTOR),
        *((f, r) for f in MATRIX),
        *((f, r, r) for f in MATRICES),
        *((f, r, v) for f in MATRIX_VECTOR),
        (cayley.compose, v, v),
    ]
    for function, *arguments in calls:
        assert isinstance(function(*arguments), Expression)


def test_import_is_light():
    code = "import sys, cayley.lie; print(sorted({'casadi', 'scipy', 'xarray'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
