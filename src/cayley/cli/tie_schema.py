"""The tables of a scenario file for bodies, joints, guides, drives and springs."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field

from cayley.cli.expressions import LANGUAGE
from cayley.cli.schema_base import NAME, PORT, Name, Table, Vector, positive, vector

_SIDE = f'{PORT}, "ground" or "ground (x, y, z)"'
_TABLE = "a table with times, values and, if you like, interpolation"
_AXIS = "three numbers in brackets, in space"

Motion = str | dict[str, Any]
VectorMotion = Annotated[list[float | str], Field(min_length=3, max_length=3)] | dict[str, Any]
Quaternion = Annotated[list[float], Field(min_length=4, max_length=4)]
Inertia = Annotated[list[float | list[float]], Field(min_length=3, max_length=3)]


def _motion(unit: str) -> Any:
    return Field(None, description=f"an expression of the time in quotes ({LANGUAGE}) [{unit}], or {_TABLE}")


def _vector_motion(unit: str) -> Any:
    text = f"three numbers or expressions of the time in quotes ({LANGUAGE}) [{unit}], or {_TABLE}"
    return Field(None, description=text)


class PortTable(Table):
    """A port of a body that has a frame of its own."""

    position: Vector = vector("m", [0.0, 0.0, 0.0])
    rotation: Quaternion = Field(description="a unit quaternion, wxyz")


def ports_of(table: Any) -> dict[str, Any]:
    """The ports of the table of a body or part, as the model takes them."""
    return {
        name: port if isinstance(port, list) else (port.position, port.rotation) for name, port in table.ports.items()
    }


class BodyTable(Table):
    """`[[body]]`: see `cayley.Body`; without inertia `cayley.PointMass`."""

    name: Name = Field("body", description=NAME)
    mass: float = positive("kg")
    inertia: Inertia | None = Field(None, description="three numbers, or 3 rows of 3 [kg m^2]; left out: a point mass")
    position: Vector = vector("m", [0.0, 0.0, 0.0])
    rotation: Quaternion = Field([1.0, 0.0, 0.0, 0.0], description="a unit quaternion, wxyz")
    ports: dict[str, Vector | PortTable] = Field(
        {}, description="a table of names, with three numbers each [m], or a table with position and rotation"
    )


class SlideTable(Table):
    """`[[support]]` with kind = "slide"."""

    kind: Literal["slide"]
    at: str = Field(description=PORT)
    axis: Vector = Field(description=_AXIS)
    displacement: Motion | None = _motion("m")
    name: str = Field("", description="a text")


class TurnTable(Table):
    """`[[support]]` with kind = "turn"."""

    kind: Literal["turn"]
    at: str = Field(description=PORT)
    axis: Vector = Field(description=_AXIS)
    angle: Motion | None = _motion("rad")
    name: str = Field("", description="a text")


class GuideTable(Table):
    """`[[support]]` with kind = "guide"."""

    kind: Literal["guide"]
    at: str = Field(description=PORT)
    axis: Vector = Field(description=_AXIS)
    name: str = Field("", description="a text")


class RollTable(Table):
    """`[[support]]` with kind = "roll"."""

    kind: Literal["roll"]
    at: str = Field(description=PORT)
    normal: Vector = Field(description=_AXIS)
    name: str = Field("", description="a text")


class DriveTable(Table):
    """`[[support]]` with kind = "drive"."""

    kind: Literal["drive"]
    at: str = Field(description=PORT)
    position: VectorMotion | None = _vector_motion("m")
    rotation: VectorMotion | None = _vector_motion("rad")
    along: Vector | None = Field(None, description=_AXIS)
    name: str = Field("", description="a text")


class _JointTable(Table):
    first: str = Field(description=PORT)
    second: str = Field("ground", description=_SIDE)
    name: str = Field("", description="a text")


class PlainJointTable(_JointTable):
    """`[[joint]]` with kind = "weld" or "ball"."""

    kind: Literal["weld", "ball"]


class HingeTable(_JointTable):
    """`[[joint]]` with kind = "hinge"."""

    kind: Literal["hinge"]
    axis: Vector = Field(description=_AXIS)
    angle: Motion | None = _motion("rad")


class UniversalTable(_JointTable):
    """`[[joint]]` with kind = "universal"."""

    kind: Literal["universal"]
    axis: Vector = Field(description=_AXIS)
    other: Vector = Field(description=_AXIS)


class SliderTable(_JointTable):
    """`[[joint]]` with kind = "slider"."""

    kind: Literal["slider"]
    axis: Vector = Field(description=_AXIS)
    displacement: Motion | None = _motion("m")


class CylindricalTable(_JointTable):
    """`[[joint]]` with kind = "cylindrical"."""

    kind: Literal["cylindrical"]
    axis: Vector = Field(description=_AXIS)
    angle: Motion | None = _motion("rad")
    displacement: Motion | None = _motion("m")


class PlanarTable(_JointTable):
    """`[[joint]]` with kind = "planar"."""

    kind: Literal["planar"]
    normal: Vector = Field(description=_AXIS)


class LinkTable(_JointTable):
    """`[[joint]]` with kind = "rigid_link"."""

    kind: Literal["rigid_link"]
    length: float | None = Field(None, gt=0, description="a positive number [m]; left out: as at the start")
    displacement: Motion | None = _motion("m")


class LinearSpringTable(_JointTable):
    """`[[spring]]` with kind = "linear"."""

    kind: Literal["linear"]
    stiffness: float = Field(0.0, ge=0, description="a number from 0 [N/m]")
    damping: float = Field(0.0, ge=0, description="a number from 0 [N s/m]")
    length: float | None = Field(None, ge=0, description="a number from 0 [m]; left out: as at the start")


class RotationalSpringTable(_JointTable):
    """`[[spring]]` with kind = "rotational"."""

    kind: Literal["rotational"]
    axis: Vector = Field(description=_AXIS)
    stiffness: float = Field(0.0, ge=0, description="a number from 0 [N m/rad]")
    damping: float = Field(0.0, ge=0, description="a number from 0 [N m s/rad]")
    angle: float = Field(0.0, description="a number [rad]")


class BushingTable(_JointTable):
    """`[[spring]]` with kind = "bushing"."""

    kind: Literal["bushing"]
    stiffness: list[float | list[float]] | None = Field(
        None, min_length=6, max_length=6, description="six numbers, or 6 rows of 6 [N/m, N m/rad]"
    )
    damping: list[float | list[float]] | None = Field(
        None, min_length=6, max_length=6, description="six numbers, or 6 rows of 6 [N s/m, N m s/rad]"
    )
    axis: Vector | None = Field(None, description=_AXIS)


GUIDES: dict[str, type[Table]] = {
    "slide": SlideTable,
    "turn": TurnTable,
    "guide": GuideTable,
    "roll": RollTable,
    "drive": DriveTable,
}
JOINTS: dict[str, type[Table]] = {
    "weld": PlainJointTable,
    "ball": PlainJointTable,
    "hinge": HingeTable,
    "universal": UniversalTable,
    "slider": SliderTable,
    "cylindrical": CylindricalTable,
    "planar": PlanarTable,
    "rigid_link": LinkTable,
}
SPRINGS: dict[str, type[Table]] = {
    "linear": LinearSpringTable,
    "rotational": RotationalSpringTable,
    "bushing": BushingTable,
}
AnyGuide = SlideTable | TurnTable | GuideTable | RollTable | DriveTable
AnyJoint = PlainJointTable | HingeTable | UniversalTable | SliderTable | CylindricalTable | PlanarTable | LinkTable
AnySpring = LinearSpringTable | RotationalSpringTable | BushingTable
JointTable = Annotated[AnyJoint, Discriminator("kind")]
SpringTable = Annotated[AnySpring, Discriminator("kind")]
