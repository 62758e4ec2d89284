"""Expressions of time: values for numbers, arrays and symbols, and what is refused."""

import math

import casadi as ca
import numpy as np
import pytest

from cayley.cli.expressions import Expressions, check
from cayley.density.expression import symbols, to_sx

TORQUE = Expressions(("1.5*sin(pi*t/2)*cos(pi*t/4)", "1.5*sin(pi*t/2)*sin(pi*t/4)", 0))


def torque(t):
    return 1.5 * np.sin(np.pi * t / 2) * np.array([np.cos(np.pi * t / 4), np.sin(np.pi * t / 4), 0.0 * t])


@pytest.mark.parametrize("t", [0, 0.3, 1.0, np.float64(1.7)])
def test_number(t):
    value = TORQUE(t)
    assert value.shape == (3,)
    assert value.dtype == np.float64
    np.testing.assert_allclose(value, torque(t), atol=1e-15)


def test_array():
    times = np.linspace(0.0, 2.0, 7)
    np.testing.assert_allclose(TORQUE(times), torque(times), atol=1e-15)


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("2", lambda t: 2.0 + 0 * t),
        ("-t + +2", lambda t: 2.0 - t),
        ("2*t**2/4 - 1e-3", lambda t: 0.5 * t**2 - 1e-3),
        ("tan(t) + exp(-t) + sqrt(t)", lambda t: np.tan(t) + np.exp(-t) + np.sqrt(t)),
        ("abs(t - 1)", lambda t: np.abs(t - 1)),
        ("min(t, 1, 2 - t)", lambda t: np.minimum(np.minimum(t, 1), 2 - t)),
        ("max(t, cos(pi*t))", lambda t: np.maximum(t, np.cos(np.pi * t))),
    ],
)
def test_functions_on_numbers_arrays_and_symbols(source, expected):
    times = np.linspace(0.1, 1.9, 5)
    vector = Expressions((source, 0.0, "t"))
    np.testing.assert_allclose(vector(times)[0], expected(times), rtol=1e-14)
    np.testing.assert_allclose([vector(float(t))[0] for t in times], expected(times), rtol=1e-14)
    t = symbols("t")
    compiled = ca.Function("vector", [to_sx(t)], [to_sx(vector(t))])
    np.testing.assert_allclose(np.array(compiled(times[None, :]))[0], expected(times), rtol=1e-14)


def test_symbol_gives_an_array_of_symbols():
    value = TORQUE(symbols("t"))
    assert value.shape == (3,)
    assert value.dtype == object


def test_name_shows_the_source():
    assert TORQUE.__name__ == "(1.5*sin(pi*t/2)*cos(pi*t/4), 1.5*sin(pi*t/2)*sin(pi*t/4), 0)"


@pytest.mark.parametrize("source", ["1/t", "sqrt(t - 1)", "exp(1000) + t", "(t - 1)**0.5", "0/0"])
def test_no_value_is_nan_and_no_error(source):
    value = Expressions((source, 0, 0))(0.0)
    assert not (np.isreal(value[0]) and np.isfinite(value[0]))


@pytest.mark.parametrize(
    ("source", "problem"),
    [
        ("", "is no expression"),
        ("1 +", "is no expression"),
        ("a = 3", "is no expression"),
        ("1; 2", "is no expression"),
        ("(" * 300 + "t", "is no expression"),
        ("t^2", "uses ^, but a power is written **"),
        ("t @ t", "uses an operator that is not allowed"),
        ("sine(t)", 'uses the unknown function "sine"'),
        ("2*x", 'uses the unknown name "x"'),
        ("sin", 'lacks the "(" of "sin"'),
        ("sin()", 'calls "sin" with the wrong number of arguments'),
        ("min(t)", 'calls "min" with the wrong number of arguments'),
        ("sin(x=t)", 'calls "sin" with the wrong number of arguments'),
        ("t.real", "uses something that is not allowed"),
        ("t[0]", "uses something that is not allowed"),
        ("'a'*3", "uses something that is not allowed"),
        ("t if t else 1", "uses something that is not allowed"),
        ("t < 1", "uses something that is not allowed"),
        ("True", "uses something that is not allowed"),
        ("1j*t", "uses something that is not allowed"),
        ("lambda: 1", "uses something that is not allowed"),
        ("__import__('os').system('true')", "uses something that is not allowed"),
        ("abs(*t)", "uses something that is not allowed"),
        ("t" + "+t" * 500, "is longer than 1000 characters"),
        ("-" * 900 + "t", "has more than 100 levels"),
        ("1" + "0" * 400, "has a number that is out of range"),
        ("9**9**9**9", "is no finite number at t = 0 s"),
        ("1/t", "is no finite number at t = 0 s"),
        ("sqrt(1 - t)", "is no finite number at t = 2 s"),
        ("(-1)**0.5", "is no finite number at t = 0 s"),
    ],
)
def test_what_is_wrong(source, problem):
    assert check(source, (0.0, 2.0)) == problem


def test_right():
    assert check("1.5*sin(pi*t/2)", (0.0, 2.0)) is None
    assert math.isclose(Expressions(("2*t",))(1.5)[0], 3.0)
