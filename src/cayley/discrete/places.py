"""Constants that differ within an element: from strain point to strain point, or between the nodes of a cell.

The value at place k of an element (node k of the cell, or strain point k) has the name NAME@k and stands, like all that
belongs to an element, at its first node; that of place 0 has the plain name.
"""

from collections.abc import Iterable, Mapping
from typing import Any

import casadi as ca

from cayley.density.expression import wrap


def name_at(name: str, place: int) -> str:
    """How the value of a constant at a place of an element is called: "c.mass", "c.mass@1", ..."""
    return name if place == 0 else f"{name}@{place}"


def plain(name: str) -> str:
    """The name without its place."""
    return name.partition("@")[0]


def placed(names: Iterable[str]) -> tuple[str, ...]:
    """Of some names those at a place other than the first."""
    return tuple(sorted(name for name in names if "@" in name))


def constants_at(symbols: Mapping[str, ca.SX], place: int) -> dict[str, Any]:
    """What a point (see Density.gradient) needs for the constants that have values of their own at a place."""
    return {} if place == 0 else {plain(n): wrap(s) for n, s in symbols.items() if n.partition("@")[2] == str(place)}


def constants_of(point: Mapping[str, Any]) -> dict[str, Any]:
    """The constants among the entries of a point or of a place."""
    return {name: value for name, value in point.items() if name.startswith("c.")}
