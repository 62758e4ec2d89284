"""Ports: places on parts to which supports, joints, springs and loads attach; and the ground."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace
from typing import Any

import numpy as np

from cayley.lie import quaternion
from cayley.model import validate
from cayley.model.part import Part
from cayley.model.validate import Array, Triple

__all__ = ["Ground", "Port", "Quad", "ground", "unit_quaternion"]

Quad = tuple[float, float, float, float]
UNTURNED: Quad = (1.0, 0.0, 0.0, 0.0)
HERE: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Port:
    """A place on a part, and a frame there; it moves rigidly with one node.

    P = x + Λ(p) shift,   F = p turn,   with x, p the position and rotation of the node

    Attributes:
        part: the rod or body.
        node: index of the node, from 0; a negative one counts from the end.
        shift: from the node, in its body frame [m].
        turn: of the port's frame against the node's, unit quaternion, wxyz.
        name: of a body's port.

    Raises:
        TypeError: the part is not a rod or body, or the node not a whole number.
        ValueError: there is no such node.
    """

    part: Part
    node: int
    _: KW_ONLY
    shift: Triple = HERE
    turn: Quad = UNTURNED
    name: str = ""

    def __post_init__(self) -> None:
        """Check the node and count it from the start."""
        if not isinstance(self.part, Part):
            raise TypeError(validate.wrong("Port", "part", self.part, "a Rod or a Body"))
        count = self.part.node_count
        right = f"from 0 to {count - 1}, or from -1 back to {-count}"
        k = validate.integer(self.part.label, "node", self.node, "a whole number " + right)
        if not -count <= k < count:
            raise ValueError(validate.wrong(self.part.label, "node", k, right))
        object.__setattr__(self, "node", k % count)
        object.__setattr__(self, "shift", validate.vector(self.part.label, "shift", self.shift, "m"))
        object.__setattr__(self, "turn", unit_quaternion(self.part.label, "turn", self.turn))

    def __str__(self) -> str:
        """As a user writes it: `mast.start`, `mast.node(3)`, `bob.eye`."""
        return self.called(self.part.name or self.part.noun)

    def called(self, name: str) -> str:
        """As a user writes it if the part has that name."""
        if self.name:
            return f"{name}.{self.name}"
        shown = "" if self.shift == HERE else f" + ({', '.join(f'{c:g}' for c in self.shift)})"
        return f"{name}.{self.part.node_name(self.node)}{shown}"

    @property
    def at_node(self) -> bool:
        """Whether it is at the node itself."""
        return self.shift == HERE

    @property
    def place(self) -> tuple[Array, Array]:
        """Position P [m], shape (3,), and frame F, wxyz, shape (4,), before any motion."""
        x, p = self.part.place(self.node)
        position: Array = x + quaternion.rotate(p, self.shift)
        return position, quaternion.multiply(p, self.turn)

    def offset(self, shift: Any = HERE, rotation: Any = UNTURNED) -> Port:
        """A port that stands off from this one.

        Args:
            shift: from here, in the frame of this port [m], shape (3,).
            rotation: of the new frame against this one: a unit quaternion (wxyz) or a rotation matrix.

        Raises:
            TypeError: not numbers.
            ValueError: not three of them, or no rotation.
        """
        step = validate.vector(str(self), "shift", shift, "m")
        turn = unit_quaternion(str(self), "rotation", rotation)
        x, y, z = (np.array(self.shift) + quaternion.rotate(self.turn, step)).tolist()
        w, i, j, k = quaternion.multiply(self.turn, turn).tolist()
        return replace(self, shift=(x, y, z), turn=(w, i, j, k), name="")


@dataclass(frozen=True, slots=True)
class Ground:
    """What does not move, as the second side of a joint or spring.

    Attributes:
        position: of a point of it, in space [m]; None: where the other side is at the start.
    """

    position: Triple | None = None

    def __post_init__(self) -> None:
        """Check the position."""
        if self.position is not None:
            object.__setattr__(self, "position", validate.vector("ground", "position", self.position, "m"))

    def __str__(self) -> str:
        """The word, and the point if one is given."""
        return "ground" if self.position is None else f"ground ({', '.join(f'{c:g}' for c in self.position)})"

    def at(self, position: Any) -> Ground:
        """A point of the ground, in space [m], shape (3,).

        Raises:
            TypeError: not numbers.
            ValueError: not three finite ones.
        """
        return Ground(position)


ground = Ground()
"""What does not move."""


def unit_quaternion(owner: str, name: str, value: Any) -> Quad:
    """A rotation as a unit quaternion, from one or from a rotation matrix.

    Raises:
        TypeError: not made of numbers.
        ValueError: neither four numbers of length 1 nor a rotation matrix.
    """
    right = "a unit quaternion (w, x, y, z) or a 3 x 3 rotation matrix"
    if np.shape(value) == (3, 3):
        matrix = validate.array(owner, name, value, (3, 3), right)
        if np.abs(matrix @ matrix.T - np.eye(3)).max() > 1e-6 or np.linalg.det(matrix) < 0.0:
            raise ValueError(validate.wrong(owner, name, value, right))
        given = quaternion.from_matrix(matrix)
    else:
        given = validate.array(owner, name, value, (4,), right)
    with np.errstate(over="ignore"):
        length = float(np.linalg.norm(given))
    if abs(length - 1.0) > 1e-6:
        raise ValueError(validate.wrong(owner, name, value, right))
    # kept bit for bit, as when read from a store
    scaled = given if abs(length - 1.0) < 4.0 * np.finfo(float).eps else given / length
    w, x, y, z = scaled.tolist()
    return (w, x, y, z)
