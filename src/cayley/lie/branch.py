"""Roots, circular functions and selection of one source for numbers and for symbols.

NumPy sends ``where`` and comparisons of object arrays to ``bool``, which a symbol does not have; and its ``sqrt``
and ``sin`` need every entry to be a symbol. The functions here work on both kinds and on mixtures of them. CasADi
is imported when the first symbol comes by.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from cayley.lie.arrays import Array


def sqrt(x: Array) -> Array:
    """Square root, entry by entry."""
    return _unary("sqrt", x) if x.dtype == object else np.sqrt(x)


def sin(x: Array) -> Array:
    """Sine, entry by entry."""
    return _unary("sin", x) if x.dtype == object else np.sin(x)


def cos(x: Array) -> Array:
    """Cosine, entry by entry."""
    return _unary("cos", x) if x.dtype == object else np.cos(x)


def arctan(x: Array) -> Array:
    """Inverse tangent, entry by entry."""
    return _unary("arctan", x) if x.dtype == object else np.arctan(x)


def minimum(x: Array, bound: float) -> Array:
    """Lesser of x and the bound, entry by entry."""
    if x.dtype != object:
        return np.minimum(x, bound)
    import casadi

    return np.frompyfunc(lambda value: casadi.fmin(_symbol(value), bound), 1, 1)(x)


def less(a: Array, b: Array | float) -> Array:
    """Tell where a < b: truth values of numbers, conditions of symbols; see `where`."""
    if a.dtype != object and np.asarray(b).dtype != object:
        return np.less(a, b)
    return np.frompyfunc(lambda x, y: _symbol(x) < _symbol(y), 2, 1)(a, b)


def where(condition: Array, a: Array | float, b: Array | float) -> Array:
    """Select a where the condition holds, else b.

    Symbols evaluate both sides, and so do their derivatives, where 0 · ∞ would spoil the selected side: keep the
    argument of the side that is not taken inside its domain, as `switch` does.
    """
    if condition.dtype != object:
        return np.where(condition, a, b)
    import casadi

    select = np.frompyfunc(lambda c, x, y: casadi.if_else(c, _symbol(x), _symbol(y)), 3, 1)
    return select(condition, a, b)


def switch(t: Array, limit: float, near: Callable[[Array], Array], far: Callable[[Array], Array]) -> Array:
    """Evaluate near(t) for t < limit, far(t) elsewhere; neither sees an argument outside its own domain."""
    small = less(t, limit)
    # A selection inside the polynomial would be repeated by CasADi in every term of it; a minimum is not.
    return where(small, near(minimum(t, limit)), far(where(small, limit, t)))


def _unary(name: str, x: Array) -> Array:
    import casadi

    function = getattr(casadi, {"arctan": "atan"}.get(name, name))
    return np.frompyfunc(lambda value: function(_symbol(value)), 1, 1)(x)


def _symbol(value: Any) -> Any:
    import casadi

    return value if isinstance(value, casadi.SX) else casadi.SX(value)
