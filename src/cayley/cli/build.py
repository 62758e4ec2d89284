"""From the tables of a scenario file to a model, with every problem told by the place in the file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from cayley.cli import expressions, force_build, problems, schema
from cayley.cli.contact_build import contact_of, obstacle_of, wrong_obstacle
from cayley.cli.contact_schema import ContactTable
from cayley.cli.force_tables import AlongRod
from cayley.cli.own_parts import PartTable, own_part, wrong_lagrangian
from cayley.cli.rods import make_rod, make_section
from cayley.cli.schema import Place
from cayley.cli.tie_build import body_of, guide_of, joint_of, motion_problems, port_of, side_of, spring_of
from cayley.cli.tie_schema import BodyTable
from cayley.model import Material, Model, Obstacle, Part, Port, Rod, Section, loads, supports
from cayley.model.check import obstacle_names
from cayley.model.joints import Joint
from cayley.model.loads import Load
from cayley.model.springs import Spring
from cayley.model.supports import Support

_PROBES = 5  # times at which an expression is tried


class BuildError(ValueError):
    """Tables that make no model; `found` has a line for each problem."""

    def __init__(self, found: list[str]) -> None:
        """Hold the lines."""
        self.found = found
        super().__init__("\n".join(found))


def build(tables: schema.ScenarioTables, folder: Path) -> Model:
    """The model that the tables describe; files they name are looked for in the folder.

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
                sections[name] = make_section(section, materials)
    if not tables.rod and not tables.body and not tables.part:
        found.add(("rod",), "is missing; allowed: at least one [[rod]], [[body]] or [[part]] table")
    rods = _rods(tables, sections, materials, found)
    parts: dict[str, Part] = {**rods}
    _add_parts(tables, parts, found)
    found.stop()
    held = _supports(tables, parts, found)
    acting = _loads(tables, rods, parts, found)
    joined: list[Joint] = _ties(tables, "joint", joint_of, parts, found)
    sprung: list[Spring] = _ties(tables, "spring", spring_of, parts, found)
    touching = _contact(tables, parts, folder, found)
    _check_initial(tables, found)
    _check_report(tables, found)
    _check_trace(tables, parts, found)
    _check_saves(tables, parts, found)
    if tables.run is not None and tables.run.dt is not None and tables.run.accuracy is not None:
        found.add(("run", "accuracy"), "is given beside dt; allowed: one of the two")
    found.stop()
    with found.at():
        return Model(*parts.values(), supports=held, joints=joined, springs=sprung, loads=acting, **touching)
    raise BuildError(found.lines)


class _Found:
    """Problems found so far."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def add(self, place: Place, text: str) -> None:
        self.lines.append(f"{problems.path(place)}: {text}" if place else text)

    @contextmanager
    def at(self, *place: str | int, whole: bool = False) -> Iterator[None]:
        """Turn a refusal of the model into a problem; it begins with the name of an object, which the place tells.

        Args:
            *place: in the file.
            whole: the message begins with no such name.
        """
        try:
            yield
        except (TypeError, ValueError, ImportError) as error:
            owner, _, text = str(error).partition(": ")
            if whole:
                text = str(error)
            self.add(place, text if place and text else f"{owner}: {text}")
        except OverflowError:
            self.add(place, "a number is too large or too small to calculate with; allowed: sizes that there are")

    def stop(self) -> None:
        if self.lines:
            raise BuildError(self.lines)


def _rods(
    tables: schema.ScenarioTables, sections: Mapping[str, Section], materials: Mapping[str, Material], found: _Found
) -> dict[str, Rod]:
    rods: dict[str, Rod] = {}
    names = [table.name for table in tables.rod]
    for k, table in enumerate(tables.rod):
        wanted = [table.section] if isinstance(table.section, str) else table.section
        unknown = [(key, name) for key in ("section", "tip_section") for name in _named(table, key, tables.section)]
        if table.name in names[:k]:
            found.add(("rod", k, "name"), f"is {problems.shown(table.name)} again; allowed: a name of its own")
        elif unknown:
            for key, name in unknown:
                found.add(("rod", k, key), problems.unlike(name, tables.section))
        elif table.length is None and table.curve is None and table.points is None:
            found.add(("rod", k, "length"), "is missing; allowed: a positive number [m], or curve or points instead")
        elif not _check_curve(table, ("rod", k, "curve"), found):
            continue
        elif all(name in sections for name in [*wanted, *([table.tip_section] if table.tip_section else [])]):
            with found.at("rod", k):
                rods[table.name] = make_rod(table, sections, tables.section, materials)
    return rods


def _named(table: schema.RodTable, key: str, known: Mapping[str, Any]) -> list[str]:
    """Names of sections in a key that are none."""
    given = getattr(table, key)
    names = [given] if isinstance(given, str) else given or []
    return [name for name in names if name not in known]


def _check_curve(table: schema.RodTable, place: Place, found: _Found) -> bool:
    good, (first, last) = True, table.span
    for j, part in enumerate(table.curve or ()):
        wrong = expressions.check(part, np.linspace(first, last, _PROBES).tolist()) if isinstance(part, str) else None
        if wrong:
            found.add((*place, j), f"{problems.shown(part)} {wrong}; allowed: {expressions.LANGUAGE}")
            good = False
    return good


def _add_parts(tables: schema.ScenarioTables, parts: dict[str, Part], found: _Found) -> None:
    """Add bodies, and parts with a Lagrangian of their own."""
    given: dict[str, Sequence[BodyTable | PartTable]] = {"body": tables.body, "part": tables.part}
    for word, same in given.items():
        for k, table in enumerate(same):
            wrong = wrong_lagrangian(table) if isinstance(table, PartTable) else None
            if table.name in parts:
                found.add((word, k, "name"), f"is {problems.shown(table.name)} again; allowed: a name of its own")
            elif wrong is not None:
                found.add((word, k, wrong[0]), wrong[1])
            else:
                with found.at(word, k):
                    parts[table.name] = own_part(table) if isinstance(table, PartTable) else body_of(table)


def _ties(tables: schema.ScenarioTables, word: str, make: Any, parts: Mapping[str, Part], found: _Found) -> list[Any]:
    """Joints or springs."""
    made = []
    for k, table in enumerate(getattr(tables, word)):
        wrong = motion_problems(table, tables.t_end)
        for key, text in wrong:
            found.add((word, k, key), text)
        sides = []
        for key, of in (("first", port_of if table.first != "ground" else side_of), ("second", side_of)):
            with found.at(word, k, key, whole=True):
                sides.append(of(getattr(table, key), parts))
        if len(sides) == 2 and not wrong:
            with found.at(word, k):
                made.append(make(table, *sides))
    return made


def _contact(tables: schema.ScenarioTables, parts: Mapping[str, Part], folder: Path, found: _Found) -> dict[str, Any]:
    """Obstacles and contact."""
    made: list[Obstacle] = []
    for k, table in enumerate(tables.obstacle):
        wrong = wrong_obstacle(table, parts)
        if wrong is not None:
            found.add(("obstacle", k, wrong[0]), wrong[1])
        elif table.name and table.name in [other.name for other in tables.obstacle[:k]]:
            found.add(("obstacle", k, "name"), f"is {problems.shown(table.name)} again; allowed: a name of its own")
        else:
            with found.at("obstacle", k):
                made.append(obstacle_of(table, parts, folder))
    if len(made) < len(tables.obstacle) or (tables.contact is None and not made):
        return {}
    named = dict(zip(obstacle_names(made), made, strict=True))
    contact, problem = contact_of(tables.contact or ContactTable.model_validate({}), parts, named)
    for place, text in problem:
        found.add(("contact", *place), text)
    return {"obstacles": made, "contact": contact}


def _supports(tables: schema.ScenarioTables, rods: Mapping[str, Part], found: _Found) -> list[Support | Joint]:
    held: list[Support | Joint] = []
    for k, table in enumerate(tables.support):
        port = _port(table.at, rods, ("support", k, "at"), found)
        if port is not None:
            with found.at("support", k):
                if not isinstance(table, (schema.HoldTable, schema.PinTable)):
                    wrong = motion_problems(table, tables.t_end)
                    for key, text in wrong:
                        found.add(("support", k, key), text)
                    if not wrong:
                        held.append(guide_of(table, port))
                elif isinstance(table, schema.HoldTable):
                    held.append(supports.hold(port, position=table.position, rotation=table.rotation))
                else:
                    held.append({"pin": supports.pin, "clamp": supports.clamp}[table.kind](port))
    return held


def _loads(
    tables: schema.ScenarioTables, rods: Mapping[str, Rod], parts: Mapping[str, Part], found: _Found
) -> list[Load]:
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
            target = _port(table.at, parts, ("load", k, "at"), found)
        else:
            target = _rod(table.rod, rods, ("load", k, "rod"), found)
        good = _check_expressions(table, tables.t_end, ("load", k, "value"), found)
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


def _check_initial(tables: schema.ScenarioTables, found: _Found) -> None:
    names = [table.rod or table.body or table.part for table in tables.initial]
    kinds: dict[str, Sequence[Any]] = {"rod": tables.rod, "body": tables.body, "part": tables.part}
    for k, table in enumerate(tables.initial):
        given = [word for word in kinds if getattr(table, word) is not None]
        name = names[k]
        if name is None:
            text = "is missing; allowed: the name of a rod, or body or part with that of a body or part"
            found.add(("initial", k, "rod"), text)
            continue
        word, of_kind = given[0], [own.name for own in kinds[given[0]]]
        if len(given) > 1:
            found.add(("initial", k, given[1]), f"is given beside {word}; allowed: one of the two")
        elif name not in of_kind:
            found.add(("initial", k, word), problems.unlike(name, of_kind))
        if name in names[:k]:
            found.add(("initial", k, word), f"is {problems.shown(name)} again; allowed: one [[initial]] for a {word}")
        for rate, momentum in (("velocity", "momentum"), ("angular_velocity", "angular_momentum")):
            if getattr(table, rate) is not None and getattr(table, momentum) is not None:
                found.add(("initial", k, momentum), f"is given beside {rate}; allowed: one of the two")


def _check_report(tables: schema.ScenarioTables, found: _Found) -> None:
    wanted, t_end = tables.report or schema.ReportTable(), tables.t_end
    for t in wanted.snapshots or ():
        if not 0.0 <= t <= t_end:
            found.add(("report", "snapshots"), f"holds {t:g}; allowed: from 0 to t_end = {t_end:g} s")
    most = max((table.elements for table in tables.rod), default=0)
    for node in wanted.nodes or ():
        if not -most - 1 <= node <= most:
            found.add(("report", "nodes"), f"holds {node}; allowed: from 0 to {most}, or from -1 back to {-most - 1}")


def _check_trace(tables: schema.ScenarioTables, parts: Mapping[str, Part], found: _Found) -> None:
    wanted = tables.trace
    if wanted is None:
        return
    numbered = [f"load #{k + 1}" for k in range(len(tables.load))]
    moving = [getattr(tie, "name", "") for tie in (*tables.support, *tables.joint)]
    known = [*numbered, *(name for name in moving if name)]
    words = wanted.parameter
    if isinstance(words, str):
        known, words = ["time", *known], [words]
    for word in words:
        if word not in known:
            found.add(("trace", "parameter"), problems.unlike(word, known))
    low, high = sorted(wanted.range)
    if low == high:
        found.add(("trace", "range"), f"is {problems.shown(wanted.range)}; allowed: two different numbers in brackets")
    elif wanted.begin is not None and not low <= wanted.begin <= high:
        found.add(("trace", "begin"), f"is {wanted.begin:g}; allowed: a number in the range, {low:g} to {high:g}")
    if wanted.of is not None:
        _port(wanted.of, parts, ("trace", "of"), found)


def _rod(name: str, rods: Mapping[str, Rod], place: Place, found: _Found) -> Rod | None:
    if name not in rods:
        found.add(place, problems.unlike(name, rods))
    return rods.get(name)


def _check_saves(tables: schema.ScenarioTables, parts: Mapping[str, Part], found: _Found) -> None:
    run = tables.run
    if run is None:
        return
    given = [name for name in ("save_every", "save_steps", "save_at") if getattr(run, name) is not None]
    if len(given) > 1:
        found.add(("run", given[1]), f"is given beside {given[0]}; allowed: one of them")
    if run.save_at is not None and any(b <= a for a, b in pairwise([0.0, *run.save_at])):
        found.add(("run", "save_at"), "does not rise from 0; allowed: rising times in brackets [s]")
    for text in run.save_only or ():
        if text not in parts:
            _port(text, parts, ("run", "save_only"), found)


def _port(text: str, parts: Mapping[str, Part], place: Place, found: _Found) -> Port | None:
    """The port that a text such as `mast.end`, `mast.node 3` or `bob.eye` names."""
    try:
        return port_of(text, parts)
    except (TypeError, ValueError) as error:
        owner, _, rest = str(error).partition(": ")
        found.add(place, rest if rest and owner.split(" ")[0] in ("Rod", "Body", "LagrangianPart") else str(error))
    return None
