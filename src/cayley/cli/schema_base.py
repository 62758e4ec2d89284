"""What the tables of a scenario file share: the base of all, and fields that many have."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

NAME = 'a text without "/" and other than empty'
PORT = "ROD.start, ROD.end, ROD.node K, BODY.centre or BODY.PORT, with the name of a rod or body"

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Until = Annotated[float, Field(allow_inf_nan=True)]
Name = Annotated[str, Field(pattern=r"^[^/]+$")]


class Table(BaseModel):
    """What all tables share: no unknown keys, no silent conversions, no infinite numbers."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, regex_engine="python-re")


def positive(unit: str) -> Any:
    """A required positive number."""
    return Field(gt=0, description=f"a positive number [{unit}]")


def rule() -> Any:
    """A rule by its name; left out: None."""
    return Field(
        None,
        pattern=r"^(nodal|verlet|screw|midpoint|nodal_midpoint|screw_midpoint|spectral\(space=[1-8]\)"
        r"|galerkin\(time=[1-8](, space=[1-8])?\))$",
        description='"nodal", "verlet", "screw", "midpoint", "nodal_midpoint", "screw_midpoint", '
        '"spectral(space=4)" or "galerkin(time=2, space=2)" with degrees 1 to 8',
    )


def vector(unit: str, default: Any = ...) -> Any:
    """Three numbers."""
    return Field(default, description=f"three numbers in brackets [{unit}]")
