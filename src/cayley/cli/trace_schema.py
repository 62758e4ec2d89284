"""The table of a scenario file that says which path of equilibria is followed."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from cayley.cli.schema_base import PORT, Table, rule

_PARAMETER = '"time", "load #K" with its number, the name of a joint or support that moves, or a list of these'


class TraceTable(Table):
    """`[trace]`: see `cayley.trace`."""

    parameter: str | Annotated[list[str], Field(min_length=1)] = Field(description=_PARAMETER)
    range: Annotated[list[float], Field(min_length=2, max_length=2)] = Field(
        [0.0, 1.0], description="two different numbers in brackets"
    )
    rule: str | None = rule()
    begin: float | None = Field(None, description="a number in the range")
    time: float = Field(0.0, description="a number [s]")
    direction: Literal[1, -1] = Field(1, description="1 or -1")
    points: int = Field(200, ge=2, description="a whole number, at least 2")
    step: float = Field(0.03, gt=0, description="a positive number")
    turn: float = Field(0.3, gt=0, description="a positive number [rad]")
    branches: int = Field(0, ge=0, description="a whole number, not negative")
    of: str | None = Field(None, description=PORT)
    axis: Literal["x", "y", "z"] = Field("x", description='"x", "y" or "z"')
