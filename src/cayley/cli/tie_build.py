"""From the tables of a scenario file to bodies, ports, joints and springs."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from cayley.cli import expressions, problems
from cayley.cli.schema_base import Table
from cayley.cli.tie_schema import ports_of
from cayley.model import Body, LagrangianPart, Part, PointMass, Port, ground, joints, springs, supports
from cayley.model.joints import Joint
from cayley.model.motion import Table as TimeTable
from cayley.model.port import Ground
from cayley.model.springs import Spring

_NUMBERS = r"\(([^()]*)\)"
_PORT = re.compile(
    r"(?P<part>.+)\.(?:node *\(?(?P<node>-?\d+)\)?|(?P<port>\w+))"
    rf"(?: *\+ *(?P<shift>{_NUMBERS}))?(?: *turned *(?P<turn>{_NUMBERS}))?"
)
_GROUND = re.compile(rf"ground(?: *(?P<point>{_NUMBERS}))?")
_MOTIONS = {"angle": 1, "displacement": 1, "position": 3, "rotation": 3}
_TIMES = 5
"""Times at which an expression is tried."""


def body_of(table: Any) -> Body | PointMass:
    """A body of its table; without inertia a point mass.

    Raises:
        TypeError: as for Body.
        ValueError: as for Body; a point mass with a rotation or ports.
    """
    if table.inertia is None:
        if table.ports or table.rotation != [1.0, 0.0, 0.0, 0.0]:
            raise ValueError("body: without inertia it is a point mass, which has neither rotation nor ports")
        return PointMass(mass=table.mass, position=table.position, name=table.name)
    return Body(**table.model_dump(exclude={"ports"}), ports=ports_of(table))


def port_of(text: str, parts: Mapping[str, Part]) -> Port:
    """The port that a text such as `mast.end`, `mast.node 3`, `bob.eye` or `mast.end + (0, 0, 0.1)` names.

    Raises:
        ValueError: there is none; the message is what follows the place in the file.
    """
    match = _PORT.fullmatch(text)
    if match is None or match["part"] not in parts:
        raise ValueError(problems.unlike(text, port_names(parts)))
    part, word = parts[match["part"]], match["port"]
    if match["node"] is not None and hasattr(part, "node") and part.node_count > 1:
        port: Port = part.node(int(match["node"]))
    elif word not in _words(part):
        raise ValueError(problems.unlike(text, port_names(parts)))
    else:
        port = part.port(word) if isinstance(part, Body | LagrangianPart) else getattr(part, word)
    if match["shift"] or match["turn"]:
        shift = _numbers(match["shift"], 3) if match["shift"] else (0.0, 0.0, 0.0)
        turn = _numbers(match["turn"], 4) if match["turn"] else (1.0, 0.0, 0.0, 0.0)
        port = port.offset(shift, turn)
    return port


def port_names(parts: Mapping[str, Part]) -> list[str]:
    """What a port may be called."""
    found: list[str] = []
    for name, part in parts.items():
        words = (*_words(part), "node K") if part.node_count > 1 else _words(part)
        found += [f"{name}.{word}" for word in words]
    return found


def _words(part: Part) -> tuple[str, ...]:
    """Ports of a part that have a name."""
    return ("start", "end") if part.node_count > 1 else ("centre", *getattr(part, "ports", ()))


def guide_of(table: Any, port: Port) -> Joint:
    """A guide or drive of its `[[support]]` table."""
    given = _given(table, "at")
    kind = given.pop("kind")
    made: Joint = getattr(supports, kind)(port, **given)
    return made


def joint_of(table: Any, first: Port, second: Port | Ground) -> Joint:
    """A joint of its table."""
    given = _given(table, "first", "second")
    kind = given.pop("kind")
    made: Joint = getattr(joints, kind)(first, second, **given)
    return made


def spring_of(table: Any, first: Port, second: Port | Ground) -> Spring:
    """A spring of its table."""
    given = table.model_dump(exclude={"kind", "first", "second"}, exclude_none=True)
    made: Spring = getattr(springs, table.kind)(first, second, **given)
    return made


def side_of(text: str, parts: Mapping[str, Part]) -> Port | Ground:
    """A port, or the ground: `ground` or `ground (0, 0, 1)`.

    Raises:
        ValueError: as for port_of.
    """
    match = _GROUND.fullmatch(text)
    if match is None:
        return port_of(text, parts)
    return ground if match["point"] is None else ground.at(_numbers(match["point"], 3))


def motion_problems(table: Table, t_end: float) -> list[tuple[str, str]]:
    """What is wrong with the prescribed motions of a table: the key and the problem."""
    found = []
    for key in _MOTIONS.keys() & type(table).model_fields.keys():
        value = getattr(table, key)
        sources = [value] if isinstance(value, str) else value if isinstance(value, list) else []
        for source in sources:
            times = np.linspace(0.0, t_end, _TIMES).tolist()
            wrong = expressions.check(source, times) if isinstance(source, str) else None
            if wrong:
                found.append((key, f"{problems.shown(source)} {wrong}; allowed: {expressions.LANGUAGE}"))
    return found


class Expression:
    """A number that is an expression of the time, for a joint."""

    def __init__(self, source: str) -> None:
        """Parse the expression."""
        self._vector = expressions.Expressions((source,))
        self.__name__ = source

    def __call__(self, t: Any) -> Any:
        """The value at time t [s]."""
        return self._vector(t)[0]


def _given(table: Any, *places: str) -> dict[str, Any]:
    """The keys of a table but those that name places, motions made functions or tables."""
    given: dict[str, Any] = table.model_dump(exclude=set(places), exclude_none=True)
    for key in _MOTIONS.keys() & given.keys():
        given[key] = _motion(key, given[key])
    return given


def _motion(key: str, value: Any) -> Any:
    if isinstance(value, str):
        return Expression(value)
    if isinstance(value, list):
        return expressions.Expressions(tuple(value))
    wrong = set(value) - {"times", "values", "interpolation"}
    if wrong or not {"times", "values"} <= set(value):
        raise ValueError(f"motion: {key} has the keys {', '.join(value)}; allowed: times, values and interpolation")
    return TimeTable(value["times"], value["values"], value.get("interpolation", "cubic"))


def _numbers(text: str, count: int) -> tuple[float, ...]:
    """Numbers in parentheses."""
    parts = text.strip("()").split(",")
    try:
        found = tuple(float(part) for part in parts)
    except ValueError:
        found = ()
    if len(found) != count:
        raise ValueError(f"has {problems.shown(text)}; allowed: {count} numbers in parentheses")
    return found
