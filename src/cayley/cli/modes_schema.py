"""The table of a scenario file that says which modes are wanted."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from cayley.cli.schema_base import Table, Vector, rule, vector


class ModesTable(Table):
    """`[modes]`: see `cayley.modes` and `cayley.campbell`."""

    count: int = Field(10, ge=1, description="a whole number, at least 1")
    about: Literal["rest", "reference"] = Field("rest", description='"rest" or "reference"')
    rule: str | None = rule()
    spin: Vector | None = vector("rad/s", None)
    speeds: Annotated[list[float], Field(min_length=2)] | None = Field(
        None, description="two or more speeds in brackets [rad/s]"
    )
