"""Evaluation of the same function on numbers and on symbols."""

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest


def symbolic(function: Callable, *values: np.ndarray) -> tuple[Any, list[ca.SX]]:
    """Call a function on plain object arrays of fresh symbols shaped like the values; return result and symbols."""
    columns, arrays = [], []
    for i, value in enumerate(values):
        column = ca.SX.sym(f"v{i}", max(value.size, 1))
        array = np.empty(value.size, dtype=object)
        array[:] = [column[k] for k in range(value.size)]
        columns.append(column)
        arrays.append(array.reshape(value.shape))
    return function(*arrays), columns


def evaluate(function: Callable, *values: np.ndarray) -> np.ndarray:
    """Build the function's expression on symbols, then evaluate it with CasADi at the values."""
    result, columns = symbolic(function, *values)
    assert isinstance(result, np.ndarray)
    assert result.dtype == object
    compiled = ca.Function("f", columns, [ca.vertcat(*[ca.SX(e) for e in result.reshape(-1)])])
    return np.array(compiled(*[v.reshape(-1) for v in values])).reshape(result.shape)


def derivatives(function: Callable, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the Jacobian and the Jacobian's Jacobian of a function by CasADi's differentiation."""
    result, (column,) = symbolic(function, value)
    first = ca.jacobian(ca.vertcat(*[ca.SX(e) for e in result.reshape(-1)]), column)
    second = ca.jacobian(ca.vec(first), column)
    a, b = ca.Function("d", [column], [ca.densify(first), ca.densify(second)])(value.reshape(-1))
    return np.array(a), np.array(b)


@pytest.fixture(name="evaluate")
def _evaluate() -> Callable:
    return evaluate


@pytest.fixture(name="derivatives")
def _derivatives() -> Callable:
    return derivatives


@pytest.fixture
def rng() -> np.random.Generator:
    """Return a generator with a fixed seed."""
    return np.random.default_rng(2014)


@pytest.fixture
def unit(rng: np.random.Generator) -> np.ndarray:
    """Return random unit quaternions, shape (2, 5, 4)."""
    p = rng.normal(size=(2, 5, 4))
    return p / np.linalg.norm(p, axis=-1, keepdims=True)


@pytest.fixture
def vectors(rng: np.random.Generator) -> np.ndarray:
    """Return random vectors, shape (2, 5, 3)."""
    return rng.normal(size=(2, 5, 3))
