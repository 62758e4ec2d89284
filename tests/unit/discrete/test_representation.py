"""Quaternions and matrices: two storages of one mechanics."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose

from cayley.density.expression import wrap
from cayley.discrete.representation import REPRESENTATIONS, continuous
from cayley.lie import cayley, quaternion
from unit.density.evaluation import evaluate, slopes, turned, unit_quaternions

RNG = np.random.default_rng(2014)
FORMS = list(REPRESENTATIONS.values())
P, Q = unit_quaternions(RNG, 2)
Q = Q if P @ Q > 0 else -Q  # one hemisphere: only then do both forms give the same r

directions = arrays(float, 3, elements=st.floats(-1.0, 1.0)).filter(lambda v: np.linalg.norm(v) > 0.1)


@pytest.fixture(params=FORMS, ids=lambda form: form.name)
def form(request):
    return request.param


def cosine(f):
    return 1.0 / np.sqrt(1.0 + f @ f)


def test_rows_and_quaternions(form):
    p = unit_quaternions(RNG, 6)
    rows = form.from_quaternion(p)
    assert rows.shape == (6, form.rows)
    for one, row in zip(p, rows, strict=True):
        assert_allclose(evaluate(form.matrix, row), quaternion.to_matrix(one), atol=1e-15)
    back = form.to_quaternion(rows)
    assert_allclose(np.abs(np.sum(back * p, axis=1)), 1.0, rtol=1e-14)


def test_relative(form):
    a, b = form.from_quaternion(P), form.from_quaternion(Q)
    r = quaternion.multiply(quaternion.conjugate(P), Q)
    assert_allclose(evaluate(lambda a, b: form.relative(a, b)[0], a, b), r[0], rtol=1e-14)
    assert_allclose(evaluate(lambda a, b: form.relative(a, b)[1], a, b), r[1:], rtol=1e-13, atol=1e-15)


def test_middle(form):
    def middle(a, b):
        r0, v = form.relative(a, b)
        return form.middle(a, b, r0, v * (1.0 / (1.0 + r0)))

    expected = quaternion.to_matrix((P + Q) / np.linalg.norm(P + Q))
    assert_allclose(evaluate(middle, form.from_quaternion(P), form.from_quaternion(Q)), expected, atol=2e-15)


def test_tangent(form):
    """δ(rows) = tangent η for δp = ½ p η."""
    expected = slopes(lambda eta: form.from_quaternion(turned(P, eta)), 3)
    assert_allclose(evaluate(form.tangent, form.from_quaternion(P)), expected, atol=1e-9)


@given(direction=directions, exponent=st.floats(-12.0, 3.0))
def test_compose_is_the_product_with_cay(direction, exponent):
    f = direction / np.linalg.norm(direction) * 10.0**exponent
    expected = quaternion.multiply(P, cayley.cay(f))
    for form in FORMS:
        rows = np.asarray(form.compose(wrap(form.from_quaternion(P)), wrap(f), cosine(f)), dtype=float)
        assert_allclose(rows, form.from_quaternion(expected), atol=4e-15)


@given(direction=directions, exponent=st.floats(-12.0, 3.0))
def test_compose_keeps_the_norm(direction, exponent):
    f = direction / np.linalg.norm(direction) * 10.0**exponent
    p, r = (np.asarray(form.compose(form.from_quaternion(P), f, cosine(f)), dtype=float) for form in FORMS)
    assert abs(p @ p - P @ P) < 2e-15
    m, before = r.reshape(3, 3), quaternion.to_matrix(P)
    assert np.abs(m.T @ m - before.T @ before).max() < 6e-15


def test_rounding_of_compose_is_unbiased(form):
    """After n increments the norm is off by about √n units of the last place, not n."""
    rng = np.random.default_rng(3)
    rows = form.from_quaternion(P)
    n = 4000
    for f in rng.normal(scale=1e-3, size=(n, 3)):
        rows = np.asarray(form.compose(rows, f, cosine(f)), dtype=float)
    m = np.asarray(form.matrix(rows), dtype=float)
    length = rows @ rows if form.name == "quaternion" else np.trace(m.T @ m) / 3.0
    assert abs(length - 1.0) < 8.0 * np.sqrt(n) * 2.0**-53


def test_continuous_signs():
    p = quaternion.multiply(P, cayley.cay(np.linspace(0.0, 0.9, 8)[:, None] * np.array([0.3, 0.5, -0.4])))
    signs = np.array([1, 1, -1, 1, -1, -1, 1, -1])[:, None]
    assert_allclose(continuous(p * signs), p * signs[0], rtol=0, atol=0)
    batch = np.stack([p * signs, -p])
    assert_allclose(continuous(batch), np.stack([p, -p]), rtol=0, atol=0)
    assert_allclose(continuous(p[:1]), p[:1], rtol=0, atol=0)
