"""Loads as expressions of the time t, the only ones a scenario file may hold."""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import Any

import numpy as np
import simpleeval


def language(names: Sequence[str]) -> str:
    """What an expression may hold, in a line, if it may name these."""
    return f"{', '.join(names)}, pi, numbers, + - * / ** ( ), and sin cos tan exp sqrt abs min max"


LANGUAGE = language(("t",))
_LONGEST = 1000  # characters of one expression
_DEEPEST = 100  # levels of one expression: each operation lies a level below the one that takes its result


def _function(name: str) -> Callable[[Any], Any]:
    """One of math's functions for a number, which is quick, and NumPy's for an array or a symbol."""
    scalar, ufunc = getattr(math, name), getattr(np, name)
    return lambda x: scalar(x) if type(x) is float else ufunc(x)


_FUNCTIONS = {name: _function(name) for name in ("sin", "cos", "tan", "exp", "sqrt")} | {
    "abs": abs,
    "min": lambda *values: reduce(np.minimum, values),
    "max": lambda *values: reduce(np.maximum, values),
}
_OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
}


@dataclass(frozen=True, slots=True)
class Expressions:
    """A vector whose components are numbers or expressions of the time.

    Called with t [s] it returns an array whose first axis is the component: shape (3,) for a number, (3, n) for n
    times, and an array of symbols for a symbol, so that a load can be compiled.

    Attributes:
        sources: the components as written.

    Raises:
        ValueError: an expression has something in it that is not allowed; the message names it.

    Example:
        >>> turning = Expressions(("2*cos(pi*t)", "2*sin(pi*t)", 0.0))
        >>> turning(0.5).round(12).tolist()
        [0.0, 2.0, 0.0]
    """

    sources: tuple[str | float, ...]
    _components: tuple[Callable[[Any], Any], ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Parse the components."""
        object.__setattr__(self, "_components", tuple(_component(source) for source in self.sources))

    @property
    def __name__(self) -> str:
        """The components in parentheses; a model's listing shows it."""
        shown = (source if isinstance(source, str) else f"{source:g}" for source in self.sources)
        return f"({', '.join(shown)})"

    def __call__(self, t: Any) -> Any:
        """The vector at time t [s]; NaN where an expression has no value, which the load then refuses by name."""
        if isinstance(t, (int, float)):
            time = float(t)
            return np.array([_number(component, time) for component in self._components])
        with np.errstate(all="ignore"):
            return _stacked([component(t) for component in self._components], t)


@dataclass(frozen=True, slots=True)
class Fields:
    """Numbers or expressions of several quantities, as a function of them.

    Attributes:
        sources: the components as written.
        names: what they may name.
        arguments: what the function takes, in order: the names, or a vector "x" for x, y, z.
        vector: whether it returns an array, shape (len(sources),), or one number.

    Raises:
        ValueError: an expression has something in it that is not allowed; the message names it.

    Example:
        >>> wind = Fields(("2*z", 0.0, "sin(t)"), ("x", "y", "z", "t"), ("x", "t"), vector=True)
        >>> wind([0.0, 0.0, 3.0], 0.0).tolist()
        [6.0, 0.0, 0.0]
    """

    sources: tuple[str | float, ...]
    names: tuple[str, ...]
    arguments: tuple[str, ...]
    vector: bool
    _components: tuple[Callable[..., Any], ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Parse the components."""
        object.__setattr__(self, "_components", tuple(_component(source, self.names) for source in self.sources))

    @property
    def __name__(self) -> str:
        """The components in parentheses; a model's listing shows it."""
        shown = (source if isinstance(source, str) else f"{source:g}" for source in self.sources)
        return f"({', '.join(shown)})"

    def __call__(self, *values: Any) -> Any:
        """The value for numbers or symbols."""
        flat: list[Any] = []
        for name, value in zip(self.arguments, values, strict=True):
            flat += list(value) if name == "x" and "y" in self.names and "y" not in self.arguments else [value]
        found = [component(*flat) for component in self._components]
        return np.array(found) if self.vector else found[0]


def check_fields(source: str, names: Sequence[str]) -> str | None:
    """What is wrong with an expression of several quantities, or None."""
    try:
        value = complex(Fields((source,), tuple(names), tuple(names), vector=False)(*([0.5] * len(names))))
    except ValueError as error:
        return str(error)
    except ArithmeticError:
        return None  # 1/(s - 0.5): it may have a value elsewhere
    return None if not value.imag else "is no real number"


def check(source: str, times: Sequence[float]) -> str | None:
    """What is wrong with an expression, or None: it must parse, and give a finite number at each of the times [s]."""
    try:
        vector = Expressions((source,))
    except ValueError as error:
        return str(error)
    for t in times:
        value = complex(vector(t)[0])
        if value.imag or not math.isfinite(value.real):
            return f"is no finite number at t = {t:g} s"
    return None


def _component(source: str | float, variables: Sequence[str] = ("t",)) -> Callable[..., Any]:
    """A function of the time, or other variables, for a number or an expression."""
    if not isinstance(source, str):
        number = float(source)
        return lambda *values: number
    tree = _parsed(source, variables)
    names = dict.fromkeys(variables, 0.0) | {"pi": np.pi}
    evaluator = simpleeval.SimpleEval(operators=_OPERATORS, functions=_FUNCTIONS, names=names)

    def value(*values: Any) -> Any:
        names.update(zip(variables, values, strict=True))
        return evaluator.eval(source, tree)

    return value


def _number(component: Callable[[Any], Any], t: float) -> Any:
    try:
        return component(t)
    except (ArithmeticError, ValueError):  # 1/0, exp(1000), sqrt(-1)
        return math.nan


def _parsed(source: str, variables: Sequence[str]) -> ast.Expr:
    """The tree of an expression.

    It is walked here so that names and operators are refused before the first evaluation; what remains is for
    simpleeval, which knows no attributes, no subscripts and no builtins.
    """
    if len(source) > _LONGEST:
        raise ValueError(f"is longer than {_LONGEST} characters")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            tree = simpleeval.SimpleEval.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError, Warning, simpleeval.InvalidExpression):
        raise ValueError("is no expression") from None
    if not isinstance(tree, ast.Expr):
        raise ValueError("is no expression")
    _refuse_foreign(tree.value, {*variables, "pi"})
    return tree


def _refuse_foreign(node: ast.expr, known: set[str], depth: int = 0) -> None:
    """Raise a ValueError at the first node that is not allowed."""
    if depth > _DEEPEST:  # below what Python's stack holds
        raise ValueError(f"has more than {_DEEPEST} levels")
    match node:
        case ast.BinOp(left=left, op=op, right=right):
            if isinstance(op, ast.BitXor):
                raise ValueError("uses ^, but a power is written **")
            if type(op) not in _OPERATORS:
                raise ValueError("uses an operator that is not allowed")
            operands = [left, right]
        case ast.UnaryOp(op=ast.UAdd() | ast.USub(), operand=operand):
            operands = [operand]
        case ast.Call(func=ast.Name(id=name), args=operands, keywords=keywords):
            if name not in _FUNCTIONS:
                raise ValueError(f'uses the unknown function "{name}"')
            if keywords or (len(operands) < 2 if name in ("min", "max") else len(operands) != 1):
                raise ValueError(f'calls "{name}" with the wrong number of arguments')
        case ast.Name(id=name) if name in known:
            return
        case ast.Name(id=name):
            raise ValueError(
                f'uses the unknown name "{name}"' if name not in _FUNCTIONS else f'lacks the "(" of "{name}"'
            )
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            try:
                node.value = float(number)  # 9**9**9 is then out of range at once, not a number of 10^8 digits
            except OverflowError:
                raise ValueError("has a number that is out of range") from None
            return
        case _:
            raise ValueError("uses something that is not allowed")
    for operand in operands:
        _refuse_foreign(operand, known, depth + 1)


def _stacked(components: list[Any], t: Any) -> Any:
    """The components as one array, those that do not depend on the time made as long as the others."""
    symbolic = any(np.asarray(component).dtype.hasobject for component in components)
    result = np.empty((len(components), *np.shape(t)), dtype=object if symbolic else np.float64)
    for k, component in enumerate(components):
        result[k] = component
    return result
