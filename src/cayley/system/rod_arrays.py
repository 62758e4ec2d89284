"""A rod as arrays over its nodes: coordinates, constants of nodes and of elements, and where it is at the start."""

from dataclasses import dataclass

import numpy as np

from cayley.discrete.rules import Rule
from cayley.model import Rod
from cayley.system.compile import chain_arrays, chain_nodes

CONSTRAINED = {"shearable": 0, "unshearable": 2, "inextensible": 3}
"""How many of the six strains each kinematics constrains, the first ones."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PartArrays:
    """One chain of nodes, or one node alone, as a system has it.

    Constants of inertia are those of a node; constants of strain (stiffness, reference) those of the element at its
    right, which the last node, without one, repeats: what is equal everywhere then stays so.

    Args:
        named: weight, 1/weight, length, here and inverse of every node, shape (nodes,) each (see System).
        constants: constants of the density by name, shape (nodes, *shape of the constant) each.
        position: at the start [m], shape (nodes, 3).
        rotation: at the start, unit quaternions, shape (nodes, 4).
    """

    named: dict[str, np.ndarray]
    constants: dict[str, np.ndarray]
    position: np.ndarray
    rotation: np.ndarray

    @property
    def size(self) -> int:
        """Number of nodes."""
        return len(self.position)


def rod_arrays(rod: Rod, rule: Rule, gravity: np.ndarray) -> PartArrays:
    """The arrays of a rod.

    Args:
        rod: the rod.
        rule: quadrature rule: its degree puts more nodes into every element.
        gravity: acceleration g [m/s²], shape (3,).

    Returns: its PartArrays; constants are mass (), inertia (3, 3), stiffness (6 or fewer, square) and gravity (3,).
    """
    coordinates = chain_nodes(np.asarray(rod.nodes), rule.degree)
    count, section = len(coordinates), rod.section
    constrained = CONSTRAINED[rod.kinematics]
    inverse = np.repeat(1.0 / np.full(rod.elements, rod.element_length), rule.degree)
    constants = {
        "mass": _everywhere(section.mass_per_length, count),
        "inertia": _everywhere(section.inertia, count),
        "stiffness": _everywhere(np.asarray(section.stiffness)[constrained:, constrained:], count),
        "gravity": _everywhere(gravity, count),
    }
    return PartArrays(
        named=chain_arrays(coordinates, rule.degree) | {"inverse": np.append(inverse, inverse[-1])},
        constants=constants,
        position=np.array(rod.origin) + np.outer(coordinates, rod.direction),
        rotation=_everywhere(rod.rotation, count),
    )


def _everywhere(value: object, count: int) -> np.ndarray:
    """The same value at every node, shape (nodes, *shape)."""
    array = np.asarray(value, dtype=float)
    return np.broadcast_to(array, (count, *array.shape)).copy()
