"""Supports: components of a node's motion that are held for good."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cayley.model import validate
from cayley.model.rod import Port
from cayley.model.validate import AXES, Mask

__all__ = ["Support", "clamp", "hold", "pin"]

_ALL: Mask = (True, True, True)
_NONE: Mask = (False, False, False)


@dataclass(frozen=True, slots=True)
class Support:
    """Components of a node that stay as they are at the start; made by `pin`, `clamp` and `hold`.

    Attributes:
        port: the node.
        held_position: which of x, y, z are held, in space.
        held_rotation: which components of the rotation increment are held, about the body axes e1, e2, e3.

    Raises:
        TypeError: the port is not a port, or the components no sequence.
        ValueError: the components are not three truth values or letters, or none is held.
    """

    port: Port
    held_position: Mask
    held_rotation: Mask

    def __post_init__(self) -> None:
        """Check the port and the components."""
        if not isinstance(self.port, Port):
            right = "a node of a rod, such as rod.start, rod.end or rod.node(k)"
            raise TypeError(validate.wrong("Support", "port", self.port, right))
        owner = f"support at {self.port}"
        object.__setattr__(self, "held_position", validate.components(owner, "position", self.held_position))
        object.__setattr__(self, "held_rotation", validate.components(owner, "rotation", self.held_rotation))
        if not any(self.held_position + self.held_rotation):
            raise ValueError(f'{owner}: nothing is held; name components, such as position="xyz" or rotation="xy"')

    def __str__(self) -> str:
        """What is held, and where."""
        return f"{self.kind} at {self.port}"

    @property
    def kind(self) -> str:
        """`pin`, `clamp`, or `hold` with the components."""
        masks = (self.held_position, self.held_rotation)
        if masks == (_ALL, _NONE):
            return "pin"
        if masks == (_ALL, _ALL):
            return "clamp"
        return "hold " + ", ".join(
            f"{word} {letters(mask)}" for word, mask in zip(("position", "rotation"), masks, strict=True) if any(mask)
        )


def pin(port: Port) -> Support:
    """Hold the position of a node; it may still turn.

    Args:
        port: the node, such as rod.start.

    Raises:
        TypeError: port is not a port.
    """
    return Support(port, _ALL, _NONE)


def clamp(port: Port) -> Support:
    """Hold the position and the rotation of a node.

    Args:
        port: the node, such as rod.start.

    Raises:
        TypeError: port is not a port.
    """
    return Support(port, _ALL, _ALL)


def hold(port: Port, *, position: str | Sequence[bool] = "", rotation: str | Sequence[bool] = "") -> Support:
    """Hold some components of a node; what is not named stays free.

    Positions are held along the axes of space, ẋ·eᵢ = 0. Rotations are held about the body's own axes, ω·eᵢ = 0
    for each named i:

    - all three: the rotation is fixed.
    - two: a hinge about the third body axis, which then stays fixed in space too.
    - one: *no spin about eᵢ*. This is a nonholonomic condition: it limits the velocity, not the rotations that can be
      reached, for the body still gets to any rotation by turning about the other two axes in turn. It is no
      universal joint.

    Args:
        port: the node, such as rod.start.
        position: letters out of "xyz", such as "xz", or three truth values.
        rotation: likewise; x, y, z stand for the body axes e1, e2, e3.

    Raises:
        TypeError: port is not a port, or components neither text nor sequence.
        ValueError: unknown components, or none at all.

    Example:
        >>> from cayley.model import Material, Rod, Section
        >>> steel = Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
        >>> rod = Rod(Section.circle(0.01, steel), length=1.0, elements=4)
        >>> print(hold(rod.end, position="xy"))
        hold position xy at rod.end
    """
    held_position = validate.components("hold", "position", position)
    held_rotation = validate.components("hold", "rotation", rotation)
    return Support(port, held_position, held_rotation)


def letters(mask: Mask) -> str:
    """The components as letters: "xz" for (True, False, True)."""
    return "".join(axis for axis, held in zip(AXES, mask, strict=True) if held)
