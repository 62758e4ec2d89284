"""The tables of a scenario file for obstacles and contact."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field

from cayley.cli.schema_base import Table, Vector, positive, vector

_UNTURNED = [1.0, 0.0, 0.0, 0.0]
_QUATERNION = "a unit quaternion, wxyz"
_PAIRS = 'pairs of names of parts or obstacles, such as [["rope", "floor"]]'

Name = Annotated[str, Field(pattern=r"^[^/]*$")]
Quaternion = Annotated[list[float], Field(min_length=4, max_length=4)]
Corners = Annotated[list[int], Field(min_length=3, max_length=3)]
Names = Annotated[list[str], Field(min_length=2, max_length=2)]
Radius = Annotated[float, Field(gt=0)]


class ContactTable(Table):
    """`[contact]`: see `cayley.Contact`."""

    friction: float = Field(0.0, ge=0, description="a number from 0 [-]")
    penetration: float = Field(0.01, gt=0, lt=1, description="a number between 0 and 1, of the radius [-]")
    impact_depth: float | None = Field(None, gt=0, description="a positive number, in radii [-]")
    damping: float = Field(0.05, ge=0, le=1, description="a number from 0 to 1 [-]")
    self_contact: bool | list[str] = Field(True, description="true, false or names of rods in brackets")
    stiffness: float | None = Field(None, gt=0, description="a positive number [N/m]")
    radii: dict[str, Radius] = Field({}, description="a table of names of rods, with a positive number each [m]")
    without: list[Names] = Field([], description=_PAIRS)
    allow_overlap: bool = Field(False, description="true or false")


class _ObstacleTable(Table):
    on: str | None = Field(None, description="the name of a body; left out: fixed in space")
    friction: float | None = Field(None, ge=0, description="a number from 0 [-]; left out: that of [contact]")
    name: Name = Field("", description='a text without "/"')


class PlaneTable(_ObstacleTable):
    """`[[obstacle]]` with shape = "plane"."""

    shape: Literal["plane"]
    point: Vector = vector("m", [0.0, 0.0, 0.0])
    normal: Vector = vector("-", [0.0, 0.0, 1.0])


class SphereTable(_ObstacleTable):
    """`[[obstacle]]` with shape = "sphere"."""

    shape: Literal["sphere"]
    radius: float = positive("m")
    center: Vector = vector("m", [0.0, 0.0, 0.0])


class CapsuleTable(_ObstacleTable):
    """`[[obstacle]]` with shape = "capsule"."""

    shape: Literal["capsule"]
    start: Vector = vector("m")
    end: Vector = vector("m")
    radius: float = positive("m")


class CylinderTable(_ObstacleTable):
    """`[[obstacle]]` with shape = "cylinder"."""

    shape: Literal["cylinder"]
    radius: float = positive("m")
    length: float = positive("m")
    center: Vector = vector("m", [0.0, 0.0, 0.0])
    axis: Vector = vector("-", [0.0, 0.0, 1.0])


class BlockTable(_ObstacleTable):
    """`[[obstacle]]` with shape = "box"."""

    shape: Literal["box"]
    size: Annotated[list[Radius], Field(min_length=3, max_length=3)] = Field(
        description="three positive numbers in brackets [m]"
    )
    center: Vector = vector("m", [0.0, 0.0, 0.0])
    rotation: Quaternion = Field(_UNTURNED, description=_QUATERNION)


class MeshTable(_ObstacleTable):
    """`[[obstacle]]` with shape = "mesh": vertices and triangles, or a file."""

    shape: Literal["mesh"]
    vertices: list[Vector] | None = Field(None, description="points, three numbers each [m]")
    triangles: list[Corners] | None = Field(None, description="three indices of vertices each, from 0")
    file: str | None = Field(None, description="the name of a file of triangles, such as STL, in quotes")
    scale: float = Field(1.0, gt=0, description="a positive number, meters in a unit of the file")
    center: Vector = vector("m", [0.0, 0.0, 0.0])
    rotation: Quaternion = Field(_UNTURNED, description=_QUATERNION)


OBSTACLES: dict[str, type[Table]] = {
    "plane": PlaneTable,
    "sphere": SphereTable,
    "capsule": CapsuleTable,
    "cylinder": CylinderTable,
    "box": BlockTable,
    "mesh": MeshTable,
}
AnyObstacle = PlaneTable | SphereTable | CapsuleTable | CylinderTable | BlockTable | MeshTable
ObstacleTable = Annotated[AnyObstacle, Discriminator("shape")]
