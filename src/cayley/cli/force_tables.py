"""The tables of damping and of loads along rods in a scenario file."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field

from cayley.cli.expressions import language
from cayley.cli.schema_base import Table, Until

_FUNCTION = "or an expression in quotes ({})"
_ST = _FUNCTION.format(language(("s", "t")))
_MOTION = ("s", "t", "x", "y", "z", "vx", "vy", "vz", "wx", "wy", "wz")
_STRAIN = ("s", "t", *(f"e{k}" for k in range(1, 7)), *(f"de{k}" for k in range(1, 7)))
DENSITY_NAMES = {"position": _MOTION, "rotation": _MOTION, "strain": _STRAIN}
"""What expressions of forces of one's own may name, by what they work on."""

Number = float | str
Three = Annotated[list[Number], Field(min_length=3, max_length=3)]
Two = Annotated[list[float], Field(min_length=2, max_length=2)]


def _positive(unit: str, default: Any = ...) -> Any:
    return Field(default, gt=0, description=f"a positive number [{unit}]")


def _not_negative(unit: str, default: Any = ...) -> Any:
    return Field(default, ge=0, description=f"a number, not negative [{unit}]")


class DampingTable(Table):
    """`damping` of a `[[rod]]`: see `cayley.damping`; what is given adds up."""

    retardation: float | list[float] | None = Field(None, description="a number, or six of them, not negative [s]")
    decay: float | None = _not_negative("1/s", None)
    viscosity: list[float | list[float]] | None = Field(
        None, description="6 rows of 6 numbers, or the 6 numbers of the diagonal [N s, N m^2 s]"
    )
    ratio: float | None = _positive("-, with frequency", None)
    frequency: float | None = _positive("Hz, with ratio", None)
    rayleigh: Annotated[list[Two], Field(min_length=2, max_length=2)] | None = Field(
        None, description="two pairs [ratio, frequency in Hz] in brackets"
    )


class AlongRod(Table):
    """What tables of loads along rods share."""

    rod: str = Field(description="the name of a rod")
    start: float = Field(0.0, description="a number [s]")
    until: Until = Field(math.inf, description="a number [s]")


class DistributedTable(AlongRod):
    """`[[load]]` with kind = "distributed", in N/m or N m/m."""

    kind: Literal["distributed"]
    value: Three = Field(description=f"three numbers, {_ST}")
    moment: bool = Field(False, description="true or false")
    frame: Literal["space", "body"] = Field("space", description='"space" or "body"')


class PressureTable(AlongRod):
    """`[[load]]` with kind = "pressure"."""

    kind: Literal["pressure"]
    value: Number = Field(description=f"a number [N/m], {_ST}")
    axis: Literal["d1", "d2"] = Field("d1", description='"d1" or "d2"')


class DragTable(AlongRod):
    """`[[load]]` with kind = "drag"."""

    kind: Literal["drag"]
    density: float = _positive("kg/m^3")
    diameter: float = _positive("m")
    normal: float = _not_negative("-", 1.2)
    tangential: float = _not_negative("-", 0.0)
    velocity: Three = Field(
        [0.0, 0.0, 0.0], description=f"three numbers [m/s], {_FUNCTION.format(language(('x', 'y', 'z', 't')))}"
    )


class BuoyancyTable(AlongRod):
    """`[[load]]` with kind = "buoyancy"."""

    kind: Literal["buoyancy"]
    density: float = _positive("kg/m^3")
    area: float = _positive("m^2")


class ImposedStrainTable(AlongRod):
    """`[[load]]` with kind = "imposed_strain"."""

    kind: Literal["imposed_strain"]
    strain: list[float] = Field(min_length=6, max_length=6, description="six numbers in brackets [-, 1/m]")
    amount: Number = Field(1.0, description=f"a number [-], {_ST}")


class TemperatureTable(AlongRod):
    """`[[load]]` with kind = "temperature"."""

    kind: Literal["temperature"]
    change: Number = Field(description=f"a number [K], {_ST}")
    expansion: float = Field(description="a number [1/K]")


class TendonTable(AlongRod):
    """`[[load]]` with kind = "tendon"."""

    kind: Literal["tendon"]
    tension: Number = Field(description=f"a number [N], {_FUNCTION.format(language(('t',)))}")
    offset: Three = Field(description=f"three numbers [m], {_FUNCTION.format(language(('s',)))}")


class DensityTable(AlongRod):
    """`[[load]]` with kind = "density": forces of one's own, per length."""

    kind: Literal["density"]
    on: Literal["position", "rotation", "strain"] = Field(description='"position", "rotation" or "strain"')
    force: list[Number] = Field(
        description="three numbers or expressions in quotes, six for strain, of what docs/scenario-files.md lists"
    )


FORCE_TABLES: dict[str, type[Table]] = {
    "distributed": DistributedTable,
    "pressure": PressureTable,
    "drag": DragTable,
    "buoyancy": BuoyancyTable,
    "imposed_strain": ImposedStrainTable,
    "temperature": TemperatureTable,
    "tendon": TendonTable,
    "density": DensityTable,
}

__all__ = ["DENSITY_NAMES", "FORCE_TABLES", "AlongRod", "DampingTable"]
