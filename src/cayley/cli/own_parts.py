"""The `[[part]]` tables of a scenario file, and the parts with a Lagrangian of their own that they make."""

from __future__ import annotations

import re
from typing import Any, Literal

from pydantic import Field

from cayley.cli import expressions, problems
from cayley.cli.schema_base import NAME, Name, Table, Vector, vector
from cayley.cli.tie_schema import PortTable, Quaternion, ports_of
from cayley.model import LagrangianPart

_POSITION = ("x", "y", "z", "vx", "vy", "vz")
_ROTATION = ("wx", "wy", "wz", *(f"r{i}{k}" for i in (1, 2, 3) for k in (1, 2, 3)))
_SLOPES = {"position": ("dx", "dy", "dz"), "rotation": ("kx", "ky", "kz")}


class PartTable(Table):
    """`[[part]]`: see `cayley.LagrangianPart`."""

    name: Name = Field("part", description=NAME)
    lagrangian: str = Field(description="an expression in quotes, of what docs/scenario-files.md lists")
    fields: Literal["both", "position", "rotation"] = Field("both", description='"both", "position" or "rotation"')
    constants: dict[str, float] = Field({}, description="a table of names, with a number each")
    length: float | None = Field(None, gt=0, description="a positive number [m], with elements")
    elements: int | None = Field(None, ge=1, description="a whole number from 1, with length")
    position: Vector = vector("m", [0.0, 0.0, 0.0])
    rotation: Quaternion = Field([1.0, 0.0, 0.0, 0.0], description="a unit quaternion, wxyz")
    ports: dict[str, Vector | PortTable] = Field(
        {}, description="a table of names, with three numbers each [m], or a table with position and rotation"
    )


def wrong_lagrangian(table: PartTable) -> tuple[str, str] | None:
    """What is wrong with a table beyond what its part refuses: the key and the problem, or None."""
    known = _names(table)
    for name in table.constants:
        if name in (*known, "pi") or not name.isidentifier():
            return "constants", f"has {problems.shown(name)}; allowed: names other than {', '.join(known)} and pi"
        if name not in re.findall(r"\w+", table.lagrangian):
            return "constants", f"has {problems.shown(name)}, which lagrangian does not use; leave it out"
    if (table.length is None) != (table.elements is None):
        return ("elements" if table.elements is None else "length"), "is missing; allowed: length and elements, or none"
    wrong = expressions.check_fields(table.lagrangian, (*known, *table.constants))
    if wrong:
        allowed = expressions.language((*known, *table.constants))
        return "lagrangian", f"{problems.shown(table.lagrangian)} {wrong}; allowed: {allowed}"
    return None


def own_part(table: PartTable) -> LagrangianPart:
    """The part of a table.

    Raises:
        TypeError: as for LagrangianPart.
        ValueError: as for LagrangianPart.
    """
    from cayley.density import Interval, Lagrangian, Rotation, Vector  # with CasADi behind it, which few files need

    kinds: Any = {"p": Rotation(), "x": Vector(3)}
    left_out = {"position": "p", "rotation": "x"}.get(table.fields)
    made = Lagrangian(
        function=_Written(table),
        fields={name: kind for name, kind in kinds.items() if name != left_out},
        interval=None if table.length is None else "s",
        name=table.name,
    )
    domain = None
    if table.length is not None and table.elements is not None:
        domain = Interval(0.0, table.length, elements=table.elements)
    place: Any = {"position": table.position, "rotation": table.rotation, "ports": ports_of(table)}
    return LagrangianPart(lagrangian=made, constants=table.constants, domain=domain, name=table.name, **place)


class _Written:
    """A Lagrangian that is an expression: a function (q, c) -> L."""

    def __init__(self, table: PartTable) -> None:
        """Parse the expression."""
        names = (*_names(table), *table.constants)
        self.__name__, self._table = table.lagrangian, table
        self._value = expressions.Fields((table.lagrangian,), names, names, vector=False)

    def __call__(self, q: Any, c: Any) -> Any:
        """The value."""
        table, values = self._table, [q.t]
        if table.fields != "rotation":
            values += [*q.x, *q.x_t]
        if table.fields != "position":
            values += [*q.p_t, *q.p.matrix.reshape(-1)]
        if table.length is not None:
            values += [q.s]
            values += [] if table.fields == "rotation" else [*q.x_s]
            values += [] if table.fields == "position" else [*q.p_s]
        return self._value(*values, *(getattr(c, name) for name in table.constants))


def _names(table: PartTable) -> tuple[str, ...]:
    """What the expression may name, besides constants."""
    names: tuple[str, ...] = ("t",)
    names += () if table.fields == "rotation" else _POSITION
    names += () if table.fields == "position" else _ROTATION
    if table.length is not None:
        names += ("s",)
        names += () if table.fields == "rotation" else _SLOPES["position"]
        names += () if table.fields == "position" else _SLOPES["rotation"]
    return names


__all__ = ["PartTable", "own_part", "wrong_lagrangian"]
