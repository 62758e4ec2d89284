"""Symbolic arrays: NumPy arrays whose entries are CasADi scalars, so that a density is written in plain NumPy."""

import functools
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np


class Expression(np.ndarray):
    """An object array of CasADi ``SX`` scalars on which NumPy's functions work.

    Arithmetic, ``@``, indexing and most of NumPy follow from the object dtype; the functions that compare or
    select (which an object array would send to ``bool``) are routed to CasADi here.
    """

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        """Apply a NumPy ufunc entry by entry."""
        plain = [_plain(value) for value in inputs]
        if method == "__call__" and ufunc in _UFUNCS:
            return wrap(np.frompyfunc(_UFUNCS[ufunc], ufunc.nin, 1)(*plain))
        if options.get("out") is not None:
            options["out"] = tuple(_plain(value) for value in options["out"])
        try:
            return wrap(getattr(ufunc, method)(*plain, **options))
        except (TypeError, AttributeError) as error:
            raise TypeError(f"numpy.{ufunc.__name__} does not work on symbols ({error})") from error

    def __array_function__(self, func: Callable, types: Any, args: Any, kwargs: Any) -> Any:
        """Apply a NumPy function, with replacements for those that would need numbers."""
        function = _FUNCTIONS.get(func, func)
        return wrap(function(*(_plain(value) for value in args), **{k: _plain(v) for k, v in kwargs.items()}))

    def __getitem__(self, key: Any) -> "Expression":
        """Index; a single entry stays an Expression (of shape ())."""
        return wrap(super().__getitem__(key))

    def __iter__(self) -> Any:
        """Iterate over the first axis."""
        return (self[i] for i in range(len(self)))

    def __bool__(self) -> bool:
        """Refuse: a symbol has no truth value."""
        raise TypeError("a Lagrangian cannot branch on a symbol: use cy.where(condition, a, b) instead of 'if'")

    def __float__(self) -> float:
        """Refuse: a symbol has no numeric value (math.sin and the like need numpy.sin here)."""
        raise TypeError("a symbol has no numeric value: use NumPy's functions (np.sin, ...), not those of math")

    def __repr__(self) -> str:
        """Print the entries."""
        return f"Expression({self.tolist()})"


def wrap(value: Any) -> Any:
    """Return object arrays and CasADi scalars as Expression, anything else as it is."""
    if isinstance(value, ca.SX):
        array = np.empty((), dtype=object)
        array[()] = value
        return array.view(Expression)
    if isinstance(value, np.ndarray) and value.dtype == object:
        if any(isinstance(entry, Expression) for entry in value.flat):
            value = np.frompyfunc(_entry, 1, 1)(value) if value.ndim else value
        return value.view(Expression)
    return value


def from_sx(value: ca.SX) -> Expression:
    """Turn a CasADi column or matrix into an Expression of shape (n,) or (n, m)."""
    rows, columns = value.shape
    array = np.empty((rows, columns), dtype=object)
    for i in range(rows):
        for k in range(columns):
            array[i, k] = value[i, k]
    return wrap(array[:, 0] if columns == 1 else array)


def to_sx(value: Any) -> ca.SX:
    """Turn numbers, arrays and Expressions into a dense CasADi column (or matrix, for two axes)."""
    array = np.asarray(_plain(wrap(value)))
    if array.ndim == 2:
        return ca.vertcat(*[ca.horzcat(*[ca.SX(e) for e in row]) for row in array])
    return ca.vertcat(*[ca.SX(e) for e in array.reshape(-1)])


def symbols(name: str, *shape: int) -> Expression:
    """Return an Expression of fresh symbols, called name, name_0, name_0_1, ..."""
    array = np.empty(shape, dtype=object)
    for index in np.ndindex(*shape):
        array[index] = ca.SX.sym("_".join([name, *map(str, index)]))
    return array.view(Expression)


def zeros(size: int) -> Expression:
    """Return an Expression of zeros, shape (size,)."""
    array = np.empty(size, dtype=object)
    for i in range(size):
        array[i] = ca.SX(0)
    return array.view(Expression)


def dot(a: Any, b: Any) -> Any:
    """Return the scalar product of two vectors.

    a·b = Σ aᵢ bᵢ

    Args:
        a: numbers or expressions, shape (n,), in any unit.
        b: the same, shape (n,).
    """
    return np.dot(a, b)


def cross(a: Any, b: Any) -> Any:
    """Return the vector product of two vectors.

    a × b = (a₂ b₃ − a₃ b₂, a₃ b₁ − a₁ b₃, a₁ b₂ − a₂ b₁)

    Args:
        a: numbers or expressions, shape (3,), in any unit.
        b: the same, shape (3,).

    Returns: an expression, shape (3,).
    """
    a, b = (wrap(np.asarray(v)) for v in (a, b))
    entries = [a[i] * b[k] - a[k] * b[i] for i, k in ((1, 2), (2, 0), (0, 1))]
    return wrap(np.array([_entry(e) for e in entries]))


def norm(a: Any) -> Any:
    """Return the Euclidean length of a vector.

    ‖a‖ = √(a·a)

    Args:
        a: numbers or expressions, shape (n,), in any unit; its derivative is infinite where a is zero.
    """
    return np.sqrt(np.dot(a, a))


def where(condition: Any, a: Any, b: Any) -> Any:
    """Return a where the condition holds, else b: what Python's `if` is for numbers.

    Args:
        condition: a comparison of expressions.
        a: numbers or expressions, where it holds.
        b: the same, elsewhere; both are evaluated always, so both must be finite.
    """
    return np.where(condition, a, b)


def _plain(value: Any) -> Any:
    """Strip the Expression class (also inside lists and tuples), so NumPy's own code runs."""
    if isinstance(value, Expression):
        return value.view(np.ndarray)
    if isinstance(value, list | tuple):
        return type(value)(_plain(v) for v in value)
    return value


def _entry(value: Any) -> Any:
    return value.view(np.ndarray).item() if isinstance(value, Expression) else value


def _select(condition: Any, a: Any, b: Any) -> Any:
    return np.frompyfunc(lambda c, x, y: ca.if_else(ca.SX(c), x, y), 3, 1)(condition, a, b)


def _length(x: Any, ord: Any = None, axis: int | None = None, keepdims: bool = False) -> Any:
    if ord not in (None, 2, "fro"):
        raise TypeError("numpy.linalg.norm of symbols: only the Euclidean norm (ord=None or 2)")
    return np.sqrt(wrap(np.sum(x * x, axis=axis, keepdims=keepdims)))


def _determinant(a: Any) -> Any:
    return ca.det(to_sx(a))


def _inverse(a: Any) -> Any:
    return from_sx(ca.inv(to_sx(a)))


def _clip(a: Any, a_min: Any = None, a_max: Any = None) -> Any:
    low = wrap(a) if a_min is None else np.maximum(wrap(a), a_min)
    return low if a_max is None else np.minimum(wrap(low), a_max)


def _extreme(choose: Callable) -> Callable:
    def reduce(a: Any, axis: int | None = None) -> Any:
        array = np.asarray(a)
        return np.frompyfunc(choose, 2, 1).reduce(array.reshape(-1) if axis is None else array, axis=axis or 0)

    return reduce


_UFUNCS: dict[np.ufunc, Callable] = {
    np.arctan2: ca.atan2,
    np.maximum: ca.fmax,
    np.minimum: ca.fmin,
    np.fmax: ca.fmax,
    np.fmin: ca.fmin,
    np.absolute: ca.fabs,
    np.fabs: ca.fabs,
    np.sign: ca.sign,
    np.hypot: ca.hypot,
    np.log2: lambda x: ca.log(x) / np.log(2.0),
    np.exp2: lambda x: ca.exp(x * np.log(2.0)),
    np.cbrt: lambda x: ca.sign(x) * ca.fabs(x) ** (1 / 3),
    np.conjugate: lambda x: x,
    np.isfinite: lambda x: True,
    np.less: lambda a, b: ca.SX(a) < b,
    np.less_equal: lambda a, b: ca.SX(a) <= b,
    np.greater: lambda a, b: ca.SX(a) > b,
    np.greater_equal: lambda a, b: ca.SX(a) >= b,
    np.equal: lambda a, b: ca.SX(a) == b,
    np.not_equal: lambda a, b: ca.SX(a) != b,
    np.fmod: ca.fmod,
    np.degrees: lambda x: x * (180.0 / np.pi),
    np.rad2deg: lambda x: x * (180.0 / np.pi),
    np.radians: lambda x: x * (np.pi / 180.0),
    np.deg2rad: lambda x: x * (np.pi / 180.0),
    np.bitwise_and: ca.logic_and,
    np.bitwise_or: ca.logic_or,
    np.invert: ca.logic_not,
    np.logical_and: ca.logic_and,
    np.logical_or: ca.logic_or,
    np.logical_not: ca.logic_not,
}

# An array that NumPy built from Expressions (np.array([q.x[0], 1.0])) calls these on its entries.
_ENTRYWISE = (
    *(np.sin, np.cos, np.tan, np.arcsin, np.arccos, np.arctan, np.sinh, np.cosh, np.tanh, np.arcsinh, np.arccosh),
    *(np.arctanh, np.exp, np.log, np.log10, np.sqrt, np.expm1, np.log1p, np.floor, np.ceil, np.arctan2, np.hypot),
)
for _ufunc in _ENTRYWISE:
    setattr(
        Expression, _ufunc.__name__, functools.partialmethod(lambda self, ufunc, *other: ufunc(self, *other), _ufunc)
    )

_FUNCTIONS: dict[Callable, Callable] = {
    np.where: _select,
    np.linalg.norm: _length,
    np.linalg.det: _determinant,
    np.linalg.inv: _inverse,
    np.clip: _clip,
    np.max: _extreme(ca.fmax),
    np.min: _extreme(ca.fmin),
}
