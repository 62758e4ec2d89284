"""Joints: what keeps two parts together, or a part and the ground; all but what is named stays free."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.lie import quaternion
from cayley.model import validate
from cayley.model.motion import Motion, Table, motion, motion_at, shown_motion
from cayley.model.port import Ground, Port, ground
from cayley.model.tie import Side, Tie
from cayley.model.validate import Array, Triple

__all__ = [
    "Joint",
    "Table",
    "ball",
    "cylindrical",
    "hinge",
    "planar",
    "rigid_link",
    "slider",
    "universal",
    "weld",
]

KINDS: dict[str, tuple[str, ...]] = {
    "weld": (),
    "ball": (),
    "hinge": ("angle",),
    "universal": (),
    "slider": ("displacement",),
    "cylindrical": ("angle", "displacement"),
    "planar": (),
    "link": ("displacement",),
    "guide": (),
    "roller": (),
    "drive": ("position", "rotation"),
    "sleeve": ("position", "rotation"),
}
"""What of each kind can be prescribed. Guide, roller, drive and sleeve are supports: the second side is the ground."""
ALONG = ("hinge", "slider", "cylindrical", "planar", "universal", "guide", "roller", "sleeve")
"""Kinds with an axis."""
KEPT: dict[str, tuple[int, ...]] = {"slider": (0, 1), "cylindrical": (0, 1), "guide": (0, 1), "planar": (2,)}
KEPT |= {"sleeve": (0, 1), "roller": (2,), "link": ()}
"""Which components of the distance of the two points, in the joint frame, a kind keeps at zero; of others, all."""
_UNITS = {"angle": (1, "rad"), "displacement": (1, "m"), "position": (3, "m"), "rotation": (3, "rad")}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Joint(Tie):
    """A joint of two ports, or of a port and the ground; made by `weld`, `ball`, `hinge`, ...

    It is as it stands at the start: there the angle and the displacement are zero, and welded parts keep the relative
    rotation they have.

    Attributes:
        kind: a word of KINDS.
        first: a port.
        second: another, or the ground.
        axis: unit vector in space, at the start: what a hinge turns about, a slider or sleeve moves along, the normal
            of a plane; of a universal joint the axis fixed in the first part.
        other: of a universal joint, the axis fixed in the second part, perpendicular to the first one.
        length: of a link [m].
        angle: prescribed turn about the axis [rad].
        displacement: prescribed motion along the axis, or change of the length of a link [m].
        position: prescribed motion of a support in space [m], (3,).
        rotation: prescribed rotation of a support, a rotation vector in space [rad], (3,).
        name: in listings and results; empty: the model numbers the joint.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range or does not fit the kind.
    """

    kind: str
    first: Port
    second: Side
    axis: Triple | None = None
    other: Triple | None = None
    length: float | None = None
    angle: Motion | None = None
    displacement: Motion | None = None
    position: Motion | None = None
    rotation: Motion | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        validate.option("Joint", "kind", self.kind, KINDS)
        if not isinstance(self.name, str) or "/" in self.name:
            raise ValueError(validate.wrong(self.kind, "name", self.name, 'a text without "/"'))
        if isinstance(self.first, Ground) and isinstance(self.second, Port):
            first = self.first
            object.__setattr__(self, "first", self.second)
            object.__setattr__(self, "second", first)
        for word, side, kinds in (("first", self.first, Port), ("second", self.second, (Port, Ground))):
            if not isinstance(side, kinds):
                right = 'a port, such as rod.end or body.port("eye")' + (", or cy.ground" if word == "second" else "")
                raise TypeError(validate.wrong(self.kind, word, side, right))
        if isinstance(self.second, Port) and self._node(self.first) == self._node(self.second):
            raise ValueError(f"{self}: both sides are the same node, which moves as one; give ports of two nodes")
        self._settle_axes()
        for quantity, (size, unit) in _UNITS.items():
            given = motion(str(self), quantity, getattr(self, quantity), size, unit)
            if given is not None and quantity not in KINDS[self.kind]:
                right = ", ".join(KINDS[self.kind]) or "none"
                raise ValueError(f"{self}: {quantity} cannot be prescribed; of a {self.kind}: {right}")
            object.__setattr__(self, quantity, given)
        self._check_start()
        if self.length is not None:
            object.__setattr__(self, "length", validate.positive(str(self), "length", self.length, "m"))
        elif self.kind == "link":
            object.__setattr__(self, "length", validate.positive(str(self), "length", self.distance, "m"))

    def __str__(self) -> str:
        """Kind and sides."""
        return self.called(str(self.first), str(self.second))

    def called(self, first: str, second: str) -> str:
        """Kind and sides, if these have such names."""
        if isinstance(self.second, Ground):
            where = "" if self.second.position is None else f" {str(self.second).removeprefix('ground ')}"
            return f"{self.kind} of {first} to ground{where}"
        return f"{self.kind} of {first} and {second}"

    @property
    def frame(self) -> Array:
        """The joint frame in space at the start, unit quaternion, wxyz, shape (4,).

        e3 is the axis (e1 and e2 the two of a universal joint); without an axis it is the first port's frame, and that
        of space for a joint to the ground.
        """
        if self.axis is not None and self.other is not None:
            columns = [np.array(self.axis), np.array(self.other), np.cross(self.axis, self.other)]
            return quaternion.from_matrix(np.stack(columns, axis=1))
        if self.axis is not None:
            return axis_frame(np.array(self.axis))
        return np.array([1.0, 0.0, 0.0, 0.0]) if self.grounded else self.first.place[1]

    @property
    def gap(self) -> float:
        """By how much the two sides miss each other at the start, where the joint wants them together [m]."""
        if self.kind == "link":
            return abs(self.distance - float(self.length or 0.0))
        first, second = self.points
        apart = quaternion.inverse_rotate(self.frame, second - first)
        kept = list(KEPT.get(self.kind, (0, 1, 2)))
        return float(np.linalg.norm(apart[kept]))

    @property
    def driven(self) -> tuple[str, ...]:
        """What is prescribed."""
        return tuple(quantity for quantity in _UNITS if getattr(self, quantity) is not None)

    def motion(self, quantity: str, times: Array) -> Array:
        """A prescribed quantity at times [s], shape (m, 1) or (m, 3); zero if it is not prescribed."""
        size, given = _UNITS[quantity][0], getattr(self, quantity)
        return np.zeros((len(times), size)) if given is None else motion_at(str(self), quantity, given, times, size)

    def described(self, first: str, second: str) -> str:
        """Kind, sides, axis, length and what is prescribed, in one line."""
        words = [self.called(first, second)]
        if self.axis is not None:
            words.append(f"axis ({', '.join(f'{c:g}' for c in self.axis)})")
        if self.other is not None:
            words.append(f"and ({', '.join(f'{c:g}' for c in self.other)})")
        if self.length is not None:
            words.append(f"{self.length:g} m")
        words += [f"{quantity}: {shown_motion(getattr(self, quantity))}" for quantity in self.driven]
        return ", ".join(words)

    @staticmethod
    def _node(port: Port) -> tuple[int, int]:
        return id(port.part), port.node

    def _settle_axes(self) -> None:
        if (self.axis is not None) != (self.kind in ALONG):
            right = "an axis, a vector in space" if self.kind in ALONG else "None"
            raise ValueError(validate.wrong(str(self), "axis", self.axis, right))
        if self.axis is not None:
            object.__setattr__(self, "axis", validate.direction(str(self), "axis", self.axis))
        if (self.other is not None) != (self.kind == "universal"):
            raise ValueError(validate.wrong(str(self), "other", self.other, "given for a universal joint only"))
        if self.other is not None and self.axis is not None:
            other = validate.direction(str(self), "other", self.other)
            if abs(float(np.dot(self.axis, other))) > 1e-9:
                right = f"perpendicular to axis = {self.axis!r}"
                raise ValueError(validate.wrong(str(self), "other", self.other, right))
            object.__setattr__(self, "other", other)
        if self.kind in ("guide", "roller", "drive", "sleeve") and not self.grounded:
            raise ValueError(f"{self}: a {self.kind} is a support; its second side is the ground")

    def _check_start(self) -> None:
        """Refuse a motion that does not begin where the model stands."""
        for quantity in self.driven:
            if getattr(getattr(self, quantity), "sampled", False):
                continue  # known at the saved frames of a run alone
            at_start = self.motion(quantity, np.zeros(1))[0]
            if np.abs(at_start).max() > 1e-9:
                unit = _UNITS[quantity][1]
                shown = ", ".join(f"{v:g}" for v in at_start)
                raise ValueError(
                    f"{self}: {quantity} is {shown} {unit} at t = 0, but must be 0 there: it counts from the start; "
                    "subtract its first value"
                )


def axis_frame(axis: Array) -> Array:
    """The smallest rotation that brings e3 onto a unit vector; by π about e1 for -e3."""
    if axis[2] < -1.0 + 1e-12:
        return np.array([0.0, 1.0, 0.0, 0.0])
    found: Array = np.array([1.0 + axis[2], -axis[1], axis[0], 0.0])  # 1 − axis e3, of length √(2 (1 + axis·e3))
    return found / np.linalg.norm(found)


def weld(first: Side, second: Side = ground, *, name: str = "") -> Joint:
    """Two ports that move as one.

    Args:
        first: a port, such as mast.end.
        second: another, or the ground, which is the default.
        name: in listings and results.

    Raises:
        TypeError: a side is neither a port nor the ground.
        ValueError: both are the same node.
    """
    return _joint("weld", first, second, name=name)


def ball(first: Side, second: Side = ground, *, name: str = "") -> Joint:
    """Two ports that stay together and turn freely; arguments and errors as for `weld`."""
    return _joint("ball", first, second, name=name)


def hinge(first: Side, second: Side = ground, *, axis: Any, angle: Any = None, name: str = "") -> Joint:
    """Two ports that stay together and turn about one axis; with an angle, as it says (a motor).

    Args:
        first: a port, such as mast.end.
        second: another, or the ground, which is the default.
        axis: to turn about: in space, at the start; of any length.
        angle: of the second part seen from the first [rad], of the part seen from the ground: a function of the time
            [s], a Table, or (times, values); zero at the start.
        name: in listings and results.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: both are the same node, the axis is zero, or the angle not zero at the start.
    """
    return _joint("hinge", first, second, axis=axis, angle=angle, name=name)


def universal(first: Side, second: Side = ground, *, axis: Any, other: Any, name: str = "") -> Joint:
    """Two ports that stay together and turn about two axes that stay perpendicular (Cardan, Hooke).

    Args:
        first: a port.
        second: another, or the ground.
        axis: fixed in the first part; in space, at the start.
        other: fixed in the second part, perpendicular to the first.
        name: in listings and results.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: as for hinge, or the axes are not perpendicular.
    """
    return _joint("universal", first, second, axis=axis, other=other, name=name)


def slider(first: Side, second: Side = ground, *, axis: Any, displacement: Any = None, name: str = "") -> Joint:
    """Two parts that move along one axis without turning; with a displacement, as it says (an actuator).

    Args:
        first: a port.
        second: another, or the ground.
        axis: to move along; in space, at the start.
        displacement: of the second part seen from the first [m]; as the angle of a hinge.
        name: in listings and results.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: as for hinge.
    """
    return _joint("slider", first, second, axis=axis, displacement=displacement, name=name)


def cylindrical(
    first: Side, second: Side = ground, *, axis: Any, angle: Any = None, displacement: Any = None, name: str = ""
) -> Joint:
    """Two parts that move along one axis and turn about it; arguments and errors as for `hinge` and `slider`."""
    return _joint("cylindrical", first, second, axis=axis, angle=angle, displacement=displacement, name=name)


def planar(first: Side, second: Side = ground, *, normal: Any, name: str = "") -> Joint:
    """Two parts that move in a plane and turn about its normal; arguments and errors as for `hinge`."""
    return _joint("planar", first, second, axis=normal, name=name)


def rigid_link(
    first: Side, second: Side, *, length: float | None = None, displacement: Any = None, name: str = ""
) -> Joint:
    """Two ports that keep their distance, as by a massless bar with ball joints; with a displacement, a ram.

    Args:
        first: a port.
        second: another, or a point of the ground, `cy.ground.at((0, 0, 1))`.
        length: of the bar [m]; the distance at the start, which it must be, unless given.
        displacement: change of the length [m]: a function of the time, a Table, or (times, values).
        name: in listings and results.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: both are the same node, or at the same place.
    """
    return _joint("link", first, second, length=length, displacement=displacement, name=name)


def _joint(kind: str, first: Any, second: Any, **options: Any) -> Joint:
    return Joint(kind=kind, first=first, second=second, **options)
