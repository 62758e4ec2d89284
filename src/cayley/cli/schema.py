"""The tables of a scenario file and what each key may hold; every description is the `allowed: ...` of a message."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field

from cayley.cli import force_tables, tie_schema
from cayley.cli.contact_schema import OBSTACLES, ContactTable, ObstacleTable
from cayley.cli.expressions import LANGUAGE
from cayley.cli.force_tables import FORCE_TABLES, DampingTable
from cayley.cli.modes_schema import ModesTable
from cayley.cli.own_parts import PartTable
from cayley.cli.schema_base import NAME as _NAME
from cayley.cli.schema_base import PORT as _NODE
from cayley.cli.schema_base import Name, Table, Until, Vector
from cayley.cli.schema_base import positive as _positive
from cayley.cli.schema_base import rule as _rule
from cayley.cli.schema_base import vector as _vector
from cayley.cli.statics_schema import StaticsTable
from cayley.cli.tie_schema import BodyTable, JointTable, SpringTable
from cayley.cli.trace_schema import TraceTable

_AXES = 'letters out of "xyz", each once'
_SHEAR = 'a positive number [-], two in brackets, one for each axis of the section, "cowper" or "none"'
_MATERIAL = "the name of a material"
_ROWS = "[N, N, N, N m^2, N m^2, N m^2]"

Axes = Annotated[str, Field(pattern=r"^(?!.*(.).*\1)[xyz]*$")]
Value = Annotated[list[float | str], Field(min_length=3, max_length=3)]
ShearCorrection = Literal["cowper", "none"] | float | Annotated[list[float], Field(min_length=2, max_length=2)]
Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
Outline = Annotated[list[Pair], Field(min_length=3)]


def _rows(name: str, size: int, units: str, default: Any = ...) -> Any:
    text = f"{size} rows of {size} numbers, or the {size} numbers of the diagonal {units}"
    return Field(default, min_length=size, max_length=size, description=text)


class MaterialTable(Table):
    """`[material.NAME]`: see `cayley.Material`."""

    density: float = _positive("kg/m^3")
    youngs_modulus: float = _positive("Pa")
    poisson_ratio: float | None = Field(None, gt=-1, le=0.5, description="a number above -1 and at most 0.5")
    shear_modulus: float | None = Field(None, gt=0, description="a positive number [Pa]")


class RectangleTable(Table):
    """`[section.NAME]` with shape = "rectangle": width along d1, height along d2."""

    shape: Literal["rectangle"]
    material: str = Field(description="the name of a material")
    width: float = _positive("m")
    height: float = _positive("m")
    shear_correction: ShearCorrection | None = Field(None, description=_SHEAR)
    torsion: Literal["polar", "saint-venant"] | float | None = Field(
        None, description='"polar", "saint-venant", or a positive number [m^4]'
    )


class CircleTable(Table):
    """`[section.NAME]` with shape = "circle"."""

    shape: Literal["circle"]
    material: str = Field(description="the name of a material")
    radius: float = _positive("m")
    shear_correction: ShearCorrection | None = Field(None, description=_SHEAR)


class TubeTable(Table):
    """`[section.NAME]` with shape = "tube"."""

    shape: Literal["tube"]
    material: str = Field(description="the name of a material")
    outer_radius: float = _positive("m")
    thickness: float = _positive("m")
    shear_correction: ShearCorrection | None = Field(None, description=_SHEAR)


class EllipseTable(Table):
    """`[section.NAME]` with shape = "ellipse": half axes along d1 and d2."""

    shape: Literal["ellipse"]
    material: str = Field(description=_MATERIAL)
    half_width: float = _positive("m")
    half_height: float = _positive("m")
    shear_correction: ShearCorrection | None = Field(None, description=_SHEAR)


class WallsTable(Table):
    """`[section.NAME]` with shape = "i_beam" or "box": overall width along d1 and height along d2, and two walls."""

    shape: Literal["i_beam", "box"]
    material: str = Field(description=_MATERIAL)
    width: float = _positive("m")
    height: float = _positive("m")
    flange: float = _positive("m")
    web: float = _positive("m")
    shear_correction: ShearCorrection | None = Field(None, description=_SHEAR)
    torsion: Literal["saint-venant", "thin-wall"] | float | None = Field(
        None, description='"saint-venant", "thin-wall", or a positive number [m^4]'
    )


class PolygonTable(Table):
    """`[section.NAME]` with shape = "polygon": corners around it and around each of its holes."""

    shape: Literal["polygon"]
    material: str = Field(description=_MATERIAL)
    outline: Outline = Field(description="3 or more points in brackets, two numbers each [m]")
    holes: list[Outline] = Field([], description="lists of 3 or more points, two numbers each [m]")
    axes: Literal["given", "principal"] = Field("given", description='"given" or "principal"')
    shear_correction: Literal["none"] | float | Pair | None = Field(
        None, description='a positive number [-], two in brackets, one for each axis of the section, or "none"'
    )
    torsion: Literal["saint-venant", "polar"] | float | None = Field(
        None, description='"saint-venant", "polar", or a positive number [m^4]'
    )


class GivenTable(Table):
    """`[section.NAME]` with shape = "given": stiffness and inertia as numbers."""

    shape: Literal["given"]
    stiffness: list[float | list[float]] = _rows("stiffness", 6, _ROWS)
    mass_per_length: float | None = Field(None, gt=0, description="a positive number [kg/m]")
    inertia: list[float | list[float]] | None = _rows("inertia", 3, "[kg m]", None)
    mass: list[float | list[float]] | None = _rows("mass", 6, "[kg/m, kg, kg m]", None)
    mass_center: Pair = Field([0.0, 0.0], description="two numbers in brackets [m]")
    shear_center: Pair = Field([0.0, 0.0], description="two numbers in brackets [m]")


class RodTable(Table):
    """`[[rod]]`: see `cayley.Rod`."""

    name: Name = Field("rod", description=_NAME)
    section: str | list[str] = Field(description="the name of a section, or a list of names, one an element")
    tip_section: str | None = Field(None, description="the name of a section of the same shape")
    length: float | None = Field(None, gt=0, description="a positive number [m]")
    elements: int = Field(ge=1, description="a whole number, at least 1")
    origin: Vector = _vector("m", [0.0, 0.0, 0.0])
    direction: Vector = _vector("-", [0.0, 0.0, 1.0])
    normal: Vector | None = _vector("-", None)
    curve: Value | None = Field(None, description=f"three numbers, or expressions of a parameter t ({LANGUAGE})")
    span: Pair = Field([0.0, 1.0], description="two numbers in brackets, the t of the first and of the last node")
    points: list[Vector] | None = Field(None, min_length=2, description="two or more points, three numbers each [m]")
    path: Literal["lines", "spline"] = Field("lines", description='"lines" or "spline"')
    twist: float = Field(0.0, description="a number [rad]")
    spacing: list[Annotated[float, Field(gt=0)]] | None = Field(
        None, description="positive numbers in brackets, one an element"
    )
    stretched: float = Field(1.0, gt=0, description="a positive number [-]")
    residual_bending: bool = Field(False, description="true or false")
    kinematics: Literal["shearable", "unshearable", "inextensible"] = Field(
        "shearable", description='"shearable", "unshearable" or "inextensible"'
    )
    damping: DampingTable | None = Field(None, description="a table such as { retardation = 1e-3 }")


class PinTable(Table):
    """`[[support]]` with kind = "pin" or "clamp"."""

    kind: Literal["pin", "clamp"]
    at: str = Field(description=_NODE)


class HoldTable(Table):
    """`[[support]]` with kind = "hold": some components, position in space, rotation about the body axes."""

    kind: Literal["hold"]
    at: str = Field(description=_NODE)
    position: Axes = Field("", description=_AXES)
    rotation: Axes = Field("", description=_AXES)


class GravityTable(Table):
    """`[[load]]` with kind = "gravity"."""

    kind: Literal["gravity"]
    acceleration: Vector = _vector("m/s^2")


class _TimedTable(Table):
    value: Value = Field(description=f"three numbers, or expressions of the time in quotes ({LANGUAGE})")
    frame: Literal["space", "body"] = Field("space", description='"space" or "body"')
    start: float = Field(0.0, description="a number [s]")
    until: Until = Field(math.inf, description="a number [s]")


class PointLoadTable(_TimedTable):
    """`[[load]]` with kind = "force" or "moment", in N or N m."""

    kind: Literal["force", "moment"]
    at: str = Field(description=_NODE)


class LineLoadTable(_TimedTable):
    """`[[load]]` with kind = "line_force" or "line_moment", in N/m or N m/m."""

    kind: Literal["line_force", "line_moment"]
    rod: str = Field(description="the name of a rod")


class InitialTable(Table):
    """`[[initial]]`: how a rod or part, the same at all its nodes, or a body moves at the start."""

    rod: str | None = Field(None, description="the name of a rod")
    body: str | None = Field(None, description="the name of a body, instead of a rod")
    part: str | None = Field(None, description="the name of a part with a Lagrangian of its own, instead of a rod")
    velocity: Vector | None = _vector("m/s, in space", None)
    angular_velocity: Vector | None = _vector("rad/s, about the body axes", None)
    momentum: Vector | None = _vector("kg/s, per length, in space; of a body kg m/s", None)
    angular_momentum: Vector | None = _vector("kg m/s, per length, about the body axes; of a body kg m^2/s", None)


class RunTable(Table):
    """`[run]`: see `cayley.simulate`."""

    t_end: float = _positive("s")
    dt: float | None = Field(None, gt=0, description="a positive number [s]; left out: the largest safe step")
    rule: str | None = _rule()
    save_every: float | None = Field(None, gt=0, description="a positive number [s]; left out: t_end/500")
    save_steps: int | None = Field(None, ge=1, description="a whole number of steps, at least 1, instead of save_every")
    save_at: Annotated[list[float], Field(min_length=1)] | None = Field(
        None, description="rising times in brackets [s], instead of save_every"
    )
    save_only: Annotated[list[str], Field(min_length=1)] | None = Field(
        None, description=f"names of parts, or places, in brackets: {_NODE}"
    )
    accuracy: float | None = Field(
        None, gt=1e-12, lt=0.5, description="a number between 1e-12 and 0.5, such as 1e-3, instead of dt"
    )
    rotation: Literal["quaternion", "matrix"] = Field("quaternion", description='"quaternion" or "matrix"')
    settle: bool | Annotated[float, Field(gt=0)] = Field(False, description="true or false, or a positive number [1/s]")
    rest: float | None = Field(None, gt=0, description="a positive number [1/s], with settle")
    balance: bool = Field(False, description="true or false")
    allow_unstable: bool = Field(False, description="true or false")


class ReportTable(Table):
    """`[report]`: what the figures show."""

    snapshots: list[float] | None = Field(default=None, min_length=1, max_length=6, description="one to six times [s]")
    nodes: list[int] | None = Field(default=None, min_length=1, max_length=5, description="one to five node numbers")


class NotesTable(Table):
    """`[notes]`: text for the report."""

    title: str = Field("Notes", description="a text")
    paragraphs: list[str] = Field(description="texts in brackets")


SectionTable = Annotated[
    RectangleTable | CircleTable | TubeTable | EllipseTable | WallsTable | PolygonTable | GivenTable,
    Discriminator("shape"),
]
SupportTable = Annotated[PinTable | HoldTable | tie_schema.AnyGuide, Discriminator("kind")]
RodLoadTable = (
    force_tables.DistributedTable
    | force_tables.PressureTable
    | force_tables.DragTable
    | force_tables.BuoyancyTable
    | force_tables.ImposedStrainTable
    | force_tables.TemperatureTable
    | force_tables.TendonTable
    | force_tables.DensityTable
)
LoadTable = Annotated[GravityTable | PointLoadTable | LineLoadTable | RodLoadTable, Discriminator("kind")]


class ScenarioTables(Table):
    """A whole file."""

    title: str = Field("", description="a text")
    material: dict[str, MaterialTable] = Field({}, description="[material.NAME] tables")
    section: dict[str, SectionTable] = Field({}, description="[section.NAME] tables")
    rod: list[RodTable] = Field([], description="[[rod]] tables")
    body: list[BodyTable] = Field([], description="[[body]] tables")
    part: list[PartTable] = Field([], description="[[part]] tables")
    support: list[SupportTable] = Field([], description="[[support]] tables")
    joint: list[JointTable] = Field([], description="[[joint]] tables")
    spring: list[SpringTable] = Field([], description="[[spring]] tables")
    load: list[LoadTable] = Field([], description="[[load]] tables")
    obstacle: list[ObstacleTable] = Field([], description="[[obstacle]] tables")
    contact: ContactTable | None = Field(None, description="a [contact] table")
    initial: list[InitialTable] = Field([], description="[[initial]] tables")
    modes: ModesTable | None = Field(None, description="a [modes] table")
    trace: TraceTable | None = Field(None, description="a [trace] table with a parameter")
    run: RunTable | None = Field(None, description="a [run] table with t_end")
    statics: StaticsTable | None = Field(None, description="a [statics] table")
    report: ReportTable | None = Field(None, description="a [report] table")
    notes: NotesTable | None = Field(None, description="a [notes] table")

    @property
    def t_end(self) -> float:
        """The last time for which anything is wanted [s]."""
        return max(self.run.t_end if self.run else 0.0, self.statics.time if self.statics else 0.0)


Place = tuple[str | int, ...]

_ONE: dict[str, type[Table]] = {
    "run": RunTable,
    "contact": ContactTable,
    "statics": StaticsTable,
    "modes": ModesTable,
    "trace": TraceTable,
    "report": ReportTable,
    "notes": NotesTable,
}
_MANY: dict[str, type[Table]] = {"material": MaterialTable, "rod": RodTable, "initial": InitialTable}
_MANY |= {"body": BodyTable, "part": PartTable}
_KINDS: dict[str, tuple[str, dict[str, type[Table]]]] = {
    "section": (
        "shape",
        {
            "rectangle": RectangleTable,
            "circle": CircleTable,
            "tube": TubeTable,
            "ellipse": EllipseTable,
            "i_beam": WallsTable,
            "box": WallsTable,
            "polygon": PolygonTable,
            "given": GivenTable,
        },
    ),
    "support": ("kind", {"pin": PinTable, "clamp": PinTable, "hold": HoldTable, **tie_schema.GUIDES}),
    "joint": ("kind", tie_schema.JOINTS),
    "spring": ("kind", tie_schema.SPRINGS),
    "obstacle": ("shape", OBSTACLES),
    "load": (
        "kind",
        {
            "gravity": GravityTable,
            "force": PointLoadTable,
            "moment": PointLoadTable,
            "line_force": LineLoadTable,
            "line_moment": LineLoadTable,
            **FORCE_TABLES,
        },
    ),
}


def discriminator(place: Place) -> tuple[str, list[str]]:
    """The key that decides which other keys a section, support or load has, and what it may be."""
    key, kinds = _KINDS[str(place[0])]
    return key, list(kinds)


def located(loc: Place) -> tuple[Place, type[Table] | None]:
    """The place of a key and the table it belongs to, from pydantic's location of an error.

    Pydantic names the kind of a section, support or load after its place, and goes on into lists. The table is None if
    the place is that of a whole entry.
    """
    top = str(loc[0])
    if len(loc) == 1:
        return loc, ScenarioTables
    if top in _ONE:
        return loc[:2], _ONE[top]
    if len(loc) == 2:
        return loc, None
    if top == "rod" and loc[2] == "damping" and len(loc) > 3:
        return loc[:4], DampingTable
    if top in _MANY:
        return loc[:3], _MANY[top]
    return (*loc[:2], loc[3]), _KINDS[top][1][str(loc[2])]
