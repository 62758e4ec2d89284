"""Symbols of the nodes of an element and what its terms read, and their numbers at a saved frame."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from cayley.density.expression import Expression, symbols, to_sx, wrap
from cayley.discrete.places import constants_at, placed
from cayley.system.system import System

Inputs = Callable[[np.ndarray, np.ndarray, float], np.ndarray]
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


def element_inputs(system: System, nodes: np.ndarray) -> Inputs:
    """Numbers for the symbols of the elements that begin at some nodes.

    Args:
        system: the system.
        nodes: their first nodes; of a node where no element begins those of its own are right, others without meaning.

    Returns: a function of values of all nodes (nodes, rows), their velocities (nodes, dofs) and the time [s], that
    returns a column for each of the nodes.
    """
    equations, named = system.equations, system.named
    degree, here = equations.rule.degree, system.values_of("here")
    own = [(nodes + k) % system.size for k in range(degree + 1)]
    length = sum((named["length"][k] for k in own[:-1]), start=np.zeros(len(nodes)))
    inverse = 1.0 / np.where(length > 0.0, length, 1.0)
    places = np.column_stack([inverse, here[own[0]], here[own[-1]], named["weight"][nodes], length])
    names = [*equations.density.names, *placed(equations.varying)]
    constants = np.array([system.values_of(name)[nodes] for name in names]).reshape(len(names), len(nodes)).T

    def inputs(values: np.ndarray, velocity: np.ndarray, time: float) -> np.ndarray:
        moving = [array[k] for array in (values, velocity) for k in own]
        return np.column_stack([*moving, places, np.full(len(nodes), time), constants]).T

    return inputs


__all__ = ["ElementSymbols", "element_inputs", "element_starts", "element_symbols"]
