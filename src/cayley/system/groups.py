"""Which parts of a model share a density: rods of one kinematics with all bodies, and parts of one Lagrangian."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.density import library
from cayley.density.lagrangian import Lagrangian
from cayley.model import LagrangianPart, Model, Part, Rod
from cayley.system.own_arrays import posed
from cayley.system.rod_arrays import CONSTRAINED

KINEMATICS = {
    "shearable": library.rod,
    "unshearable": library.unshearable_rod,
    "inextensible": library.inextensible_rod,
}
"""The density of each kinematics."""


@dataclass(frozen=True, slots=True)
class Group:
    """Parts of one density.

    Args:
        lagrangian: theirs, of fields p and x, without forces of loads and damping.
        parts: the parts, in the order of the model.
        constrained: how many of the six strains of rods it constrains, the first ones.
    """

    lagrangian: Lagrangian
    parts: tuple[Part, ...]
    constrained: int = 0


def groups_of(model: Model) -> list[Group]:
    """The densities of a model: nodes are numbered group by group.

    Bodies and point masses, which a density of rods holds as nodes without an element, go with the first rods.
    """
    first = model.rods[0].kinematics if model.rods else "shearable"
    found: dict[Any, list[Part]] = {}
    for part in sorted(model.parts, key=lambda part: isinstance(part, LagrangianPart)):
        if isinstance(part, LagrangianPart):
            key: Any = (id(part.lagrangian), _shapes(part))
        else:
            key = part.kinematics if isinstance(part, Rod) else first
        found.setdefault(key, []).append(part)
    return [_group(key, parts) for key, parts in found.items()]


def _group(key: Any, parts: Sequence[Part]) -> Group:
    part = parts[0]
    if isinstance(part, LagrangianPart):
        return Group(posed(part.lagrangian), tuple(parts))
    return Group(KINEMATICS[key], tuple(parts), CONSTRAINED[key])


def _shapes(part: LagrangianPart) -> tuple[Any, ...]:
    """What constants of parts with one density must agree in: shapes, and a matrix without symmetry as a whole."""
    found: list[Any] = []
    for name, value in sorted(part.constants.items()):
        array = np.asarray(value)
        symmetric = array.ndim != 2 or np.array_equal(array, array.T)
        found.append((name, array.shape, None if symmetric else array.tobytes()))
    return tuple(found)


__all__ = ["Group", "groups_of"]
