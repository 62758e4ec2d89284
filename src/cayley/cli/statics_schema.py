"""The table of a scenario file that says which equilibrium is wanted."""

from __future__ import annotations

from pydantic import Field

from cayley.cli.schema_base import Table, Vector, rule


class StaticsTable(Table):
    """`[statics]`: see `cayley.equilibrium`."""

    time: float = Field(0.0, description="a number [s]")
    spin: float | Vector | None = Field(None, description="a number, or three in brackets [rad/s]")
    rule: str | None = rule()
    relax: bool | None = Field(None, description="true or false")
