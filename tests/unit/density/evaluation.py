"""Evaluate expressions and Lagrangians on numbers, and differentiate on the group by central differences."""

from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from cayley.density.expression import Expression, symbols, to_sx
from cayley.density.fields import Rotation
from cayley.density.lagrangian import Lagrangian
from cayley.lie import exponential, quaternion


def evaluate(function: Callable, *values: np.ndarray) -> np.ndarray:
    """Build the function's expression on symbols, then evaluate it with CasADi at the values."""
    arguments = [symbols(f"v{i}", *np.shape(value)) for i, value in enumerate(values)]
    result = function(*arguments)
    assert isinstance(result, Expression)
    columns = [to_sx(a.reshape(-1)) for a in arguments]
    compiled = ca.Function("f", columns, [ca.densify(to_sx(result.reshape(-1)))])
    return np.array(compiled(*[np.reshape(v, -1) for v in values])).reshape(result.shape)


def numbers(outputs: Sequence[Any], inputs: Sequence[Any], values: Sequence[Any]) -> list[np.ndarray]:
    """Evaluate expressions at values of their inputs; columns come back flat."""
    columns = [to_sx(np.reshape(np.asarray(v, dtype=object), -1)) if not isinstance(v, ca.SX) else v for v in inputs]
    compiled = ca.Function("f", columns, [ca.densify(to_sx(o) if not isinstance(o, ca.SX) else o) for o in outputs])
    found = compiled.call([ca.DM(np.reshape(v, -1)) for v in values])
    return [np.array(f).reshape(-1) if f.shape[1] == 1 else np.array(f) for f in found]


def turned(p: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """A rotation moved by a body rotation vector: p exp(η/2)."""
    return quaternion.multiply(p, exponential.exp(eta))


def slopes(function: Callable[[np.ndarray], Any], size: int, *, step: float = 1e-5) -> np.ndarray:
    """Derivatives of a function of a vector at zero, by central differences; one row for each entry of the result."""
    columns = [(function(step * e) - function(-step * e)) / (2.0 * step) for e in np.eye(size)]
    return np.stack(columns, axis=-1)


def unit_quaternions(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Random rotations, uniformly distributed."""
    p = rng.normal(size=(*shape, 4))
    return p / np.linalg.norm(p, axis=-1, keepdims=True)


class Turn:
    """A rotation in numbers, with what the body of a Lagrangian may ask of it."""

    def __init__(self, p: np.ndarray) -> None:
        self.p = p
        self.matrix = quaternion.to_matrix(p)
        self.T = self.matrix.T

    def rotate(self, v: np.ndarray) -> np.ndarray:
        return self.matrix @ v

    def inverse_rotate(self, v: np.ndarray) -> np.ndarray:
        return self.matrix.T @ v

    def __matmul__(self, other: np.ndarray) -> np.ndarray:
        return self.matrix @ other

    def __getitem__(self, key: Any) -> np.ndarray:
        return self.matrix[key]

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        return self.matrix


def random_point(lagrangian: Lagrangian, rng: np.random.Generator) -> dict[str, Any]:
    """Random values for everything a Lagrangian may ask q for; rotations as quaternions."""
    point: dict[str, Any] = {}
    for name in lagrangian.names:
        field = lagrangian.fields.get(name) or lagrangian.fields.get(name.rsplit("_", 1)[0])
        if name in ("t", lagrangian.interval):
            point[name] = float(rng.uniform(0.2, 0.8))
        elif isinstance(field, Rotation) and name in lagrangian.fields:
            point[name] = unit_quaternions(rng)
        else:
            point[name] = rng.normal(size=field.size)
    return point


def value_of(lagrangian: Lagrangian, point: Mapping[str, Any], constants: Mapping[str, Any]) -> float:
    """Call the user's function on numbers: nothing of the library but the algebra of quaternions takes part."""
    turns = [name for name, field in lagrangian.fields.items() if isinstance(field, Rotation)]
    q = SimpleNamespace(**{k: Turn(v) if k in turns else v for k, v in point.items()})
    given = {**lagrangian.defaults, **constants}
    c = SimpleNamespace(**{k: np.asarray(v, dtype=float) for k, v in given.items()})
    return np.asarray(lagrangian.function(q, c), dtype=float).item()


def moved(lagrangian: Lagrangian, point: Mapping[str, Any], name: str, by: np.ndarray) -> dict[str, Any]:
    """The point with one slot moved: rotations in their body frame, everything else by addition."""
    turns = isinstance(lagrangian.fields.get(name), Rotation)
    return dict(point) | {name: turned(point[name], by) if turns else point[name] + by}
