"""Sections and rods from the tables of a scenario file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cayley.cli import expressions, schema
from cayley.cli.force_build import damping_of
from cayley.model import Material, Rod, Section

_OF_CURVES = ("normal", "twist")
_OF_ALL = ("kinematics", "stretched", "residual_bending", "name")


def make_section(table: Any, materials: Mapping[str, Material]) -> Section:
    """The section that a table describes.

    Raises:
        TypeError: as for Section.
        ValueError: as for Section.
        ImportError: its torsion needs scikit-fem, which is not installed.
    """
    values = table.model_dump(exclude={"shape", "material"}, exclude_none=True)
    if table.shape == "given":
        for key in {"stiffness", "inertia", "mass"} & set(values):
            rows = values[key]
            values[key] = rows if any(isinstance(row, list) for row in rows) else np.diag(rows)
        return Section.given(**values)
    made: Section = getattr(Section, table.shape)(material=materials[table.material], **values)
    return made


def make_rod(
    table: schema.RodTable,
    sections: Mapping[str, Section],
    tables: Mapping[str, Any],
    materials: Mapping[str, Material],
) -> Rod:
    """The rod that a table describes.

    Args:
        table: of the rod; its sections are among
        sections: made of
        tables: those of the sections.
        materials: by their names.

    Raises:
        TypeError: as for Rod.
        ValueError: as for Rod, or keys that do not go together.
    """
    names = table.section
    section: Any = sections[names] if isinstance(names, str) else [sections[name] for name in names]
    rod = _placed(table, section)
    if table.damping is not None:
        rod = replace(rod, damping=damping_of(table.damping))
    if table.tip_section is None:
        return rod
    if not isinstance(names, str):
        raise ValueError("Rod: tip_section is given beside a list of sections; allowed: one of the two")
    between = _between(tables[names], tables[table.tip_section], materials)
    length = rod.length
    return replace(rod, section=lambda s: between(s / length))


def _placed(table: schema.RodTable, section: Any) -> Rod:
    """The rod with the shape that its keys describe."""
    given = table.model_dump(include={*_OF_CURVES, *_OF_ALL, "spacing", "elements"}, exclude_none=True)
    common = {key: given[key] for key in (*_OF_ALL, "elements")} | {"normal": given.get("normal")}
    spaced = common | {"spacing": given.get("spacing")}
    if table.curve is not None and table.points is not None:
        raise ValueError("Rod: curve and points are both given; allowed: one of the two")
    beside = sorted({"length", "origin", "direction"} & table.model_fields_set)
    if beside and (table.curve is not None or table.points is not None):
        raise ValueError(f"Rod: {beside[0]} is given beside a curve, which says it; leave it out")
    if table.curve is not None:
        curve = expressions.Expressions(tuple(table.curve))
        return Rod.along(section, curve, span=(table.span[0], table.span[1]), twist=table.twist, **spaced)
    if table.points is not None and table.path == "spline":
        return Rod.through(section, table.points, twist=table.twist, **spaced)
    if table.points is not None:
        if table.spacing is not None:
            raise ValueError("Rod: spacing is given beside lines, whose points are nodes; leave it out")
        return Rod.polyline(section, table.points, twist=table.twist, **common)
    length = float(table.length or 0.0)
    if not table.twist:
        straight: dict[str, Any] = table.model_dump(include={"origin", "direction"})
        return Rod(section, length=length, **straight, **spaced)
    start, way = np.array(table.origin), np.array(table.direction)
    way = way / np.linalg.norm(way)
    return Rod.along(section, lambda s: start + s * way, span=(0.0, length), twist=table.twist, **spaced)


def _between(root: Any, tip: Any, materials: Mapping[str, Material]) -> Callable[[float], Section]:
    """Sections between two tables of one shape: a function of the part of the length, 0 at the root and 1 at the tip.

    Raises:
        ValueError: the shapes, or what is no number in them, differ.
    """
    first, last = root.model_dump(), tip.model_dump()
    for key, value in first.items():
        other = last.get(key)
        same_shape = _is_number(value) and _is_number(other) and np.shape(value) == np.shape(other)
        if key not in last or not (value == other or same_shape):
            raise ValueError(f"Rod: tip_section has another {key} than section; allowed: other numbers only")

    def at(part: float) -> Section:
        values = dict(first)
        for key, value in first.items():
            if value != last[key]:
                values[key] = ((1.0 - part) * np.array(value) + part * np.array(last[key])).tolist()
        return make_section(type(root)(**values), materials)

    return at


def _is_number(value: Any) -> bool:
    return np.asarray(value, dtype=object).size > 0 and not isinstance(value, (str, bool)) and value is not None
