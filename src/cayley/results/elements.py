"""Symbols of the nodes of an element and what its terms read, and their numbers at a saved frame."""

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from cayley.density.expression import Expression, symbols, to_sx, wrap
from cayley.discrete.places import constants_at, placed
from cayley.system.system import System

_NAMES = ("inverse", "left", "right", "weight", "length", "t")


@dataclass(frozen=True, slots=True)
class ElementSymbols:
    """Symbols of an element, or of its first node alone.

    Args:
        ends: values of its nodes, degree + 1 of shape (rows,).
        rates: their velocities, ω and ẋ, of shape (dofs,).
        place: "inverse" 1/length, "length", coordinates "left", "right" of its ends, of its first node "here" and
            "weight", "t", and the constants that its strain points have "at points".
        inputs: all of these in the order of element_inputs.
    """

    ends: list[Expression]
    rates: list[Expression]
    place: dict[str, Any]
    inputs: ca.SX


def element_symbols(system: System) -> ElementSymbols:
    """Symbols of an element of a system."""
    equations, layout = system.equations, system.layout
    nodes = range(equations.rule.degree + 1)
    ends = [symbols(f"q{k}", layout.rows) for k in nodes]
    rates = [symbols(f"v{k}", layout.dofs) for k in nodes]
    names = {n: wrap(ca.SX.sym(n)) for n in _NAMES}
    extra = {n: ca.SX.sym(n) for n in placed(equations.varying)}
    place: dict[str, Any] = names | {"here": names["left"]}
    place["at points"] = [constants_at(extra, k) for k in range(len(equations.rule.strain.at))]
    columns = [*ends, *rates, *names.values(), equations.density.parameters, *extra.values()]
    return ElementSymbols(ends, rates, place, ca.vertcat(*[to_sx(e) for e in columns]))


def element_starts(system: System) -> np.ndarray:
    """First nodes of all elements."""
    degree, first, found = system.equations.rule.degree, 0, []
    for count in system.chains:
        found.append(first + np.arange(0, count - 1, degree))
        first += count
    return np.concatenate(found)


def element_inputs(system: System, values: np.ndarray, velocity: np.ndarray, time: float) -> np.ndarray:
    """Numbers for the symbols, a column for each node as the first of an element.

    Args:
        system: the system.
        values: of all nodes, shape (nodes, rows).
        velocity: shape (nodes, dofs).
        time: the time [s].

    Returns: shape (inputs, nodes); of a node where no element begins those of its own are right, others without
    meaning.
    """
    equations, named = system.equations, system.named
    degree, here = equations.rule.degree, system.values_of("here")
    spaces = named.get("length", np.zeros(system.size))
    length = sum((np.roll(spaces, -k) for k in range(degree)), start=np.zeros(system.size))
    inverse = 1.0 / np.where(length > 0.0, length, 1.0)
    own = [inverse, here, np.roll(here, -degree), named["weight"], length, np.full(system.size, time)]
    constants = [system.values_of(name) for name in equations.density.names]
    extra = [named[name] for name in placed(equations.varying)]
    shifted = [np.roll(array, -k, axis=0) for array in (values, velocity) for k in range(degree + 1)]
    return np.column_stack([*shifted, *own, *constants, *extra]).T


__all__ = ["ElementSymbols", "element_inputs", "element_starts", "element_symbols"]
