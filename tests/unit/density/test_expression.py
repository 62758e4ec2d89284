"""NumPy's functions on symbols: the same numbers as on numbers."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import cayley as cy
from cayley.density.expression import Expression, from_sx, symbols, to_sx, wrap, zeros
from unit.density.evaluation import evaluate

RNG = np.random.default_rng(2014)
INSIDE = RNG.uniform(0.1, 0.9, 4)  # in the domain of every function
SIGNED = np.array([-1.7, -0.4, 0.3, 2.5])
OTHER = np.array([0.6, -0.4, -1.1, 0.9])  # equal to SIGNED in one entry
V, W = RNG.normal(size=(2, 3))
A, B = RNG.normal(size=(2, 3, 3))

ONE = """arccos arccosh arcsin arcsinh arctan arctanh cbrt cos cosh exp exp2 expm1 log log10 log1p log2 sin sinh sqrt
tan tanh"""
SIGN = "absolute ceil conjugate fabs floor negative positive sign square cbrt exp2 reciprocal logical_not"
ANGLES = "degrees radians rad2deg deg2rad"
TWO = """add arctan2 divide equal fmax fmin fmod greater greater_equal hypot less less_equal logical_and logical_or
maximum minimum multiply not_equal subtract true_divide"""

ARRAYS = {
    "matmul": (lambda a, b, v: a @ b @ v, (A, B, V)),
    "vector @ matrix": (lambda a, v: v @ a, (A, V)),
    "number @": (lambda v: A @ v, (V,)),
    "dot": (np.dot, (A, V)),
    "inner": (np.inner, (V, W)),
    "outer": (np.outer, (V, W)),
    "cross": (np.cross, (V, W)),
    "kron": (np.kron, (V, W)),
    "einsum": (lambda a, v: np.einsum("ij,j->i", a, v), (A, V)),
    "tensordot": (lambda a, v: np.tensordot(a, v, axes=1), (A, V)),
    "det": (np.linalg.det, (A,)),
    "inv": (np.linalg.inv, (A,)),
    "matrix_power": (lambda a: np.linalg.matrix_power(a, 3), (A,)),
    "norm": (np.linalg.norm, (V,)),
    "norm of rows": (lambda a: np.linalg.norm(a, axis=1), (A,)),
    "norm of columns, kept": (lambda a: np.linalg.norm(a, axis=0, keepdims=True), (A,)),
    "norm of a matrix": (np.linalg.norm, (A,)),
    "sum": (np.sum, (A,)),
    "sum of rows": (lambda a: np.sum(a, axis=1), (A,)),
    "mean": (lambda a: np.mean(a, axis=0), (A,)),
    "prod": (np.prod, (V,)),
    "cumsum": (np.cumsum, (V,)),
    "diff": (np.diff, (V,)),
    "trace": (np.trace, (A,)),
    "diag": (np.diag, (A,)),
    "transposed": (lambda a: a.T, (A,)),
    "reshape": (lambda a: np.reshape(a, (9,)), (A,)),
    "flip": (np.flip, (V,)),
    "roll": (lambda v: np.roll(v, 1), (V,)),
    "stack": (lambda v, w: np.stack([v, w], axis=1), (V, W)),
    "concatenate with numbers": (lambda v: np.concatenate([v, np.ones(2)]), (V,)),
    "polyval": (lambda v: np.polyval([1.0, -2.0, 0.5], v), (V,)),
    "clip": (lambda v: np.clip(v, -0.5, 0.5), (SIGNED,)),
    "clip from above": (lambda v: np.clip(v, None, 0.5), (SIGNED,)),
    "clip from below": (lambda v: np.clip(v, -0.5, None), (SIGNED,)),
    "where": (lambda v, w: np.where(v > w, v, w**2), (SIGNED, OTHER)),
    "cy.where": (lambda v, w: cy.where(v <= w, v, 1.0), (SIGNED, OTHER)),
    "cy.cross": (cy.cross, (V, W)),
    "cy.cross with numbers": (lambda v: cy.cross(W, v), (V,)),
    "cy.dot": (cy.dot, (V, W)),
    "cy.norm": (cy.norm, (V,)),
    "&": (lambda v, w: np.where((v > 0) & (w > 0), v, w), (SIGNED, OTHER)),
    "|": (lambda v, w: np.where((v > 0) | (w > 0), v, w), (SIGNED, OTHER)),
    "~": (lambda v, w: np.where(~(v > w), v, w), (SIGNED, OTHER)),
    "max": (np.max, (SIGNED,)),
    "min of rows": (lambda a: np.min(a, axis=1), (A,)),
    "max of columns": (lambda a: np.max(a, axis=0), (A,)),
    "power": (lambda v: v**3 + 2.0**v + INSIDE[:3] ** v, (V,)),
    "roots": (lambda v: v**-0.5 + v**1.5, (INSIDE,)),
    "floor division": (lambda v, w: v // w, (SIGNED, OTHER)),
    "abs": (abs, (SIGNED,)),
    "slice": (lambda a: a[1:, ::2], (A,)),
    "boolean index": (lambda v: v[np.array([True, False, True])], (V,)),
    "iteration": (lambda v: sum(x**2 for x in v), (V,)),
    "in place": (lambda v: _in_place(v), (V,)),
    "built from entries": (lambda v: np.sin(np.stack([v[0], v[2], v[1] * v[0]])), (V,)),
    "outer sum": (np.add.outer, (V, W)),
    "reduce": (lambda v: np.multiply.reduce(v), (V,)),
}


def _in_place(v):
    own = v.copy()
    own += 1.0
    own[1] = 2.0 * v[0]
    own *= v
    return own


@pytest.mark.parametrize("name", ONE.split())
def test_functions_of_one_argument(name):
    function = getattr(np, name)
    values = INSIDE + 1.0 if name == "arccosh" else INSIDE
    assert_allclose(evaluate(function, values), function(values), rtol=1e-14)


@pytest.mark.parametrize("name", [*SIGN.split(), *ANGLES.split()])
def test_functions_that_see_the_sign(name):
    function = getattr(np, name)
    values = np.array([*SIGNED, 0.0]) if name != "reciprocal" else SIGNED
    assert_allclose(evaluate(function, values), function(values), rtol=1e-14)


@pytest.mark.parametrize("name", TWO.split())
def test_functions_of_two_arguments(name):
    function = getattr(np, name)
    assert_allclose(evaluate(function, SIGNED, OTHER), function(SIGNED, OTHER), rtol=1e-14)
    assert_allclose(evaluate(lambda v: function(v, 0.3), SIGNED), function(SIGNED, 0.3), rtol=1e-14)
    assert_allclose(evaluate(lambda v: function(OTHER, v), SIGNED), function(OTHER, SIGNED), rtol=1e-14)


@pytest.mark.parametrize("name", ARRAYS)
def test_functions_of_arrays(name):
    function, values = ARRAYS[name]
    expected = np.asarray(function(*values))
    found = evaluate(function, *values)
    assert found.shape == expected.shape
    assert_allclose(found, expected, rtol=1e-13, atol=1e-15)


@pytest.mark.xfail(strict=True, reason="NumPy asks the bare number for its sine", raises=TypeError)
def test_function_of_an_array_built_from_symbols_and_numbers():
    """np.array([symbol, 1.0]) is a plain array of objects; arithmetic works on it, functions do not."""
    evaluate(lambda v: np.sin(np.array([v[0], 1.0])), V)


@given(st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=4), st.floats(-2.0, 2.0))
def test_selection_takes_the_same_side(values, threshold):
    v = np.array(values)

    def function(x):
        return np.where(x >= threshold, np.maximum(x, 0.5), np.minimum(x, np.sign(x)))

    assert_allclose(evaluate(function, v), function(v), rtol=0, atol=0)


def test_unknown_function_is_named():
    with pytest.raises(TypeError, match=r"^numpy\.spacing does not work on symbols"):
        np.spacing(symbols("x", 2))


def test_only_the_euclidean_norm():
    with pytest.raises(TypeError, match="only the Euclidean norm"):
        np.linalg.norm(symbols("x", 2), 1)


def test_a_symbol_has_no_truth_and_no_value():
    x = symbols("x")
    with pytest.raises(TypeError, match=r"cannot branch on a symbol: use cy\.where"):
        bool(x > 0)
    with pytest.raises(TypeError, match=r"use NumPy's functions \(np\.sin, \.\.\.\)"):
        float(x)


def test_entries_stay_expressions():
    x = symbols("x", 2, 3)
    assert x[1, 2].shape == ()
    assert all(isinstance(part, Expression) for part in (x[0], x[1, 2], x.T, x + 1.0, np.sin(x), *x))
    assert x[1, 2].view(np.ndarray).item().name() == "x_1_2"
    assert repr(symbols("y", 2)) == "Expression([SX(y_0), SX(y_1)])"


def test_columns_and_matrices_go_to_casadi_and_back():
    m = ca.SX.sym("m", 2, 3)
    back = to_sx(from_sx(m))
    assert back.shape == (2, 3)
    assert ca.is_equal(back, m)
    assert from_sx(ca.SX.sym("v", 4)).shape == (4,)
    assert to_sx([1.0, symbols("a"), 2.0]).shape == (3, 1)
    assert all(e.is_zero() for e in zeros(3).view(np.ndarray))
    assert wrap(1.5) == 1.5
