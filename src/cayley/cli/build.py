"""From the tables of a scenario file to a model, with every problem told by the place in the file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from cayley.cli import expressions, force_build, problems, schema
from cayley.cli.force_tables import AlongRod
from cayley.cli.schema import Place
from cayley.model import Material, Model, Port, Rod, Section, loads, supports
from cayley.model.joints import Joint
from cayley.model.loads import Load
from cayley.model.supports import Support

_PORT = re.compile(r"(?P<rod>.+)\.(?:(?P<end>start|end)|node *\(?(?P<node>-?\d+)\)?)")
_PROBES = 5  # times at which an expression is tried


class BuildError(ValueError):
    """Tables that make no model; `found` has a line for each problem."""

    def __init__(self, found: list[str]) -> None:
        """Hold the lines."""
        self.found = found
        super().__init__("\n".join(found))


def build(tables: schema.ScenarioTables) -> Model:
    """The model that the tables describe.

    Raises:
        BuildError: they do not fit together.
    """
    found = _Found()
    materials: dict[str, Material] = {}
    for name, material in tables.material.items():
        with found.at("material", name):
            materials[name] = Material(**material.model_dump())
    sections: dict[str, Section] = {}
    for name, section in tables.section.items():
        if not isinstance(section, schema.GivenTable) and section.material not in tables.material:
            found.add(("section", name, "material"), problems.unlike(section.material, tables.material))
        elif isinstance(section, schema.GivenTable) or section.material in materials:
            with found.at("section", name):
                sections[name] = _section(section, materials)
    rods = _rods(tables, sections, found)
    found.stop()
    held = _supports(tables, rods, found)
    acting = _loads(tables, rods, found)
    _check_initial(tables, rods, found)
    _check_report(tables, found)
    if tables.run.dt is not None and tables.run.accuracy is not None:
        found.add(("run", "accuracy"), "is given beside dt; allowed: one of the two")
    found.stop()
    with found.at():
        return Model(*rods.values(), supports=held, loads=acting)
    raise BuildError(found.lines)


class _Found:
    """Problems found so far."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def add(self, place: Place, text: str) -> None:
        self.lines.append(f"{problems.path(place)}: {text}" if place else text)

    @contextmanager
    def at(self, *place: str | int) -> Iterator[None]:
        """Turn a refusal of the model into a problem; it begins with the name of an object, which the place tells."""
        try:
            yield
        except (TypeError, ValueError) as error:
            owner, _, text = str(error).partition(": ")
            self.add(place, text if place and text else f"{owner}: {text}")

    def stop(self) -> None:
        if self.lines:
            raise BuildError(self.lines)


def _section(table: Any, materials: Mapping[str, Material]) -> Section:
    values = table.model_dump(exclude={"shape", "material"}, exclude_none=True)
    if table.shape == "given":
        for key in ("stiffness", "inertia"):
            rows = values[key]
            values[key] = rows if any(isinstance(row, list) for row in rows) else np.diag(rows)
        return Section.given(**values)
    made: Section = getattr(Section, table.shape)(material=materials[table.material], **values)
    return made


def _rods(tables: schema.ScenarioTables, sections: Mapping[str, Section], found: _Found) -> dict[str, Rod]:
    rods: dict[str, Rod] = {}
    names = [table.name for table in tables.rod]
    for k, table in enumerate(tables.rod):
        if table.name in names[:k]:
            found.add(("rod", k, "name"), f"is {problems.shown(table.name)} again; allowed: a name of its own")
        elif table.section not in tables.section:
            found.add(("rod", k, "section"), problems.unlike(table.section, tables.section))
        elif table.section in sections:
            with found.at("rod", k):
                values = table.model_dump(exclude={"section", "damping"})
                rods[table.name] = Rod(sections[table.section], damping=force_build.damping_of(table.damping), **values)
    return rods


def _supports(tables: schema.ScenarioTables, rods: Mapping[str, Rod], found: _Found) -> list[Support | Joint]:
    held: list[Support | Joint] = []
    for k, table in enumerate(tables.support):
        port = _port(table.at, rods, ("support", k, "at"), found)
        if port is not None:
            with found.at("support", k):
                if isinstance(table, schema.HoldTable):
                    held.append(supports.hold(port, position=table.position, rotation=table.rotation))
                else:
                    held.append({"pin": supports.pin, "clamp": supports.clamp}[table.kind](port))
    return held


def _loads(tables: schema.ScenarioTables, rods: Mapping[str, Rod], found: _Found) -> list[Load]:
    acting: list[Load] = []
    for k, table in enumerate(tables.load):
        if isinstance(table, schema.GravityTable):
            with found.at("load", k):
                acting.append(loads.gravity(table.acceleration))
            continue
        if isinstance(table, AlongRod):
            rod = _rod(table.rod, rods, ("load", k, "rod"), found)
            wrong = force_build.wrong_parts(table)
            for place, part, text in wrong:
                found.add(("load", k, *place), f"{problems.shown(part)} {text}")
            if rod is not None and not wrong:
                with found.at("load", k):
                    acting.append(force_build.rod_load(table, rod))
            continue
        target: Port | Rod | None
        if isinstance(table, schema.PointLoadTable):
            target = _port(table.at, rods, ("load", k, "at"), found)
        else:
            target = _rod(table.rod, rods, ("load", k, "rod"), found)
        good = _check_expressions(table, tables.run.t_end, ("load", k, "value"), found)
        if target is not None and good:
            with found.at("load", k):
                timing = {"frame": table.frame, "start": table.start, "until": table.until}
                acting.append(getattr(loads, table.kind)(target, _value(table.value), **timing))
    return acting


def _value(given: list[float | str]) -> Any:
    """A constant, or a function of the time as soon as one component is an expression."""
    return expressions.Expressions(tuple(given)) if any(isinstance(part, str) for part in given) else given


def _check_expressions(table: Any, t_end: float, place: Place, found: _Found) -> bool:
    last = min(table.until, max(t_end, table.start))
    times = np.linspace(table.start, last, _PROBES).tolist()
    good = True
    for k, part in enumerate(table.value):
        wrong = expressions.check(part, times) if isinstance(part, str) else None
        if wrong:
            found.add((*place, k), f"{problems.shown(part)} {wrong}; allowed: {expressions.LANGUAGE}")
            good = False
    return good


def _check_initial(tables: schema.ScenarioTables, rods: Mapping[str, Rod], found: _Found) -> None:
    names = [table.rod for table in tables.initial]
    for k, table in enumerate(tables.initial):
        _rod(table.rod, rods, ("initial", k, "rod"), found)
        if table.rod in names[:k]:
            found.add(
                ("initial", k, "rod"), f"is {problems.shown(table.rod)} again; allowed: one [[initial]] for a rod"
            )
        for rate, momentum in (("velocity", "momentum"), ("angular_velocity", "angular_momentum")):
            if getattr(table, rate) is not None and getattr(table, momentum) is not None:
                found.add(("initial", k, momentum), f"is given beside {rate}; allowed: one of the two")


def _check_report(tables: schema.ScenarioTables, found: _Found) -> None:
    wanted, t_end = tables.report or schema.ReportTable(), tables.run.t_end
    for t in wanted.snapshots or ():
        if not 0.0 <= t <= t_end:
            found.add(("report", "snapshots"), f"holds {t:g}; allowed: from 0 to t_end = {t_end:g} s")
    most = max(table.elements for table in tables.rod)
    for node in wanted.nodes or ():
        if not -most - 1 <= node <= most:
            found.add(("report", "nodes"), f"holds {node}; allowed: from 0 to {most}, or from -1 back to {-most - 1}")


def _rod(name: str, rods: Mapping[str, Rod], place: Place, found: _Found) -> Rod | None:
    if name not in rods:
        found.add(place, problems.unlike(name, rods))
    return rods.get(name)


def _port(text: str, rods: Mapping[str, Rod], place: Place, found: _Found) -> Port | None:
    """The node that a text such as `mast.end` or `mast.node 3` names."""
    match = _PORT.fullmatch(text)
    if match is None or match["rod"] not in rods:
        ends = [f"{name}.{end}" for name in rods for end in ("start", "end", "node K")]
        found.add(place, problems.unlike(text, ends))
        return None
    rod = rods[match["rod"]]
    if match["end"]:
        return rod.start if match["end"] == "start" else rod.end
    with found.at(*place):
        return rod.node(int(match["node"]))
    return None
