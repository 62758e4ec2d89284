"""Supports: components of a node's motion that are held for good, guides along any axis, and prescribed motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cayley.model import validate
from cayley.model.joints import Joint
from cayley.model.port import Port, ground
from cayley.model.validate import AXES, Mask

__all__ = ["Support", "clamp", "drive", "guide", "hold", "pin", "roll", "slide", "turn"]

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
            right = "a node of a rod, such as rod.start, rod.end or rod.node(k), or body.centre"
            raise TypeError(validate.wrong("Support", "port", self.port, right))
        owner = f"support at {self.port}"
        object.__setattr__(self, "held_position", validate.components(owner, "position", self.held_position))
        object.__setattr__(self, "held_rotation", validate.components(owner, "rotation", self.held_rotation))
        if not self.port.at_node and self.held_position + self.held_rotation != _ALL + _ALL:
            raise ValueError(
                f"{owner}: a place off the node can be clamped, but not held by components; hold the node, or use "
                "supports.pin, guide, roll, slide or turn"
            )
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


def pin(port: Port) -> Support | Joint:
    """Hold the position of a node or port; it may still turn.

    Args:
        port: such as rod.start, or body.port("eye"), which then is a ball joint to the ground.

    Raises:
        TypeError: port is not a port.
    """
    if isinstance(port, Port) and not port.at_node:
        return Joint(kind="ball", first=port, second=ground)
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


def slide(port: Port, axis: Any, *, displacement: Any = None, name: str = "") -> Joint:
    """Let a port move along an axis in space, without turning: a slider to the ground.

    Args:
        port: such as rod.start.
        axis: to move along, in space.
        displacement: along the axis [m], if it is prescribed: a function of the time [s], a Table, or (times, values);
            zero at the start.
        name: in listings and results.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: the axis is zero, or the displacement not zero at the start.
    """
    return Joint(kind="slider", first=port, second=ground, axis=axis, displacement=displacement, name=name)


def turn(port: Port, axis: Any, *, angle: Any = None, name: str = "") -> Joint:
    """Let a port turn about an axis in space, and do nothing else: a hinge to the ground.

    Arguments and errors as for `slide`, with an angle [rad] instead of a displacement.
    """
    return Joint(kind="hinge", first=port, second=ground, axis=axis, angle=angle, name=name)


def guide(port: Port, axis: Any, *, name: str = "") -> Joint:
    """Keep a port on a line in space; it may turn. Arguments and errors as for `slide`."""
    return Joint(kind="guide", first=port, second=ground, axis=axis, name=name)


def roll(port: Port, normal: Any, *, name: str = "") -> Joint:
    """Keep a port in a plane in space; it may turn. The normal is that of the plane; errors as for `slide`."""
    return Joint(kind="roller", first=port, second=ground, axis=normal, name=name)


def drive(port: Port, *, position: Any = None, rotation: Any = None, along: Any = None, name: str = "") -> Joint:
    """Move a port as prescribed; what is not given stays free, or with ``along`` all but the way along an axis is held.

    x(t) = x(0) + position(t),   p(t) = exp(rotation(t)) p(0)

    Args:
        port: such as rod.start.
        position: displacement in space [m], (3,): a function of the time [s], a Table, or (times, values); zero at the
            start.
        rotation: rotation vector in space [rad], (3,), likewise.
        along: an axis in space along which the port slides freely, as in a sleeve that is moved and turned; what
            position says along it is without effect, and without position or rotation it does not shift or turn.
        name: in listings and results.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: nothing is given, it is not zero at the start, or the axis is zero.
    """
    if along is not None:
        return Joint(
            kind="sleeve", first=port, second=ground, axis=along, position=position, rotation=rotation, name=name
        )
    if position is None and rotation is None:
        raise ValueError(f"drive of {port}: nothing is prescribed; give position or rotation, or hold the node")
    return Joint(kind="drive", first=port, second=ground, position=position, rotation=rotation, name=name)


def letters(mask: Mask) -> str:
    """The components as letters: "xz" for (True, False, True)."""
    return "".join(axis for axis, held in zip(AXES, mask, strict=True) if held)
