"""A model as plain numbers and words, and back."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from cayley.model import Model, Part, Rod, Section
from cayley.model.curve import Shape
from cayley.model.loads import Gravity, LineLoad, Load, PointLoad
from cayley.model.rod_loads import KINDS, RodLoad
from cayley.model.stations import Stations
from cayley.model.supports import Support
from cayley.results.contact_record import contact_from, contact_record
from cayley.results.forces_record import damping_from, damping_record, rod_load_from, rod_load_record
from cayley.results.tie_record import (
    part_record,
    parts_from,
    parts_record,
    port_from,
    port_record,
    ties_from,
    ties_record,
)


def model_record(model: Model) -> dict[str, Any]:
    """A model as a dictionary that JSON can hold; functions of time are there by name only.

    Numbers are those of the model, bit for bit: JSON writes the shortest decimals that read back the same.
    """
    sections: dict[int, Section] = {}
    for rod in model.rods:
        for section in _all_sections(rod.stations):
            sections.setdefault(id(section), section)
    numbers = {identity: k for k, identity in enumerate(sections)}
    return {
        "sections": [
            _section_record(section) | ({} if model.contact is None else {"radius": section.radius})
            for section in sections.values()
        ],
        "rods": [_rod_record(rod) | {"section": _numbered(rod.stations, numbers)} for rod in model.rods],
        "supports": [
            {
                **port_record(support.port, model),
                "position": list(support.held_position),
                "rotation": list(support.held_rotation),
            }
            for support in model.supports
        ],
        "loads": [_load_record(load, model) for load in model.loads],
        **parts_record(model),
        **ties_record(model),
        **contact_record(model),
    }


def model_from(
    record: Mapping[str, Any],
    functions: Sequence[Callable[[float], Any] | None],
    motions: Mapping[str, Callable[[float], Any]] | None = None,
) -> Model:
    """Make a model of its record.

    Args:
        record: made by model_record.
        functions: for every load the function of time it was, or None.
        motions: prescribed motions that were functions of time, by "name of the joint/quantity".
    """
    sections = [Section(**(given | {"name": str(given["name"])})) for given in record["sections"]]
    rods = [_rod_from(given, sections) for given in record["rods"]]
    parts = parts_from(record, rods)
    supports = [Support(port_from(s, parts), tuple(s["position"]), tuple(s["rotation"])) for s in record["supports"]]
    pairs = zip(record["loads"], functions, strict=True)
    loads = [_load_from(given, rods, parts, function) for given, function in pairs]
    ties = ties_from(record, parts, motions or {})
    held, touching = [*supports, *ties["guides"]], contact_from(record, parts)
    return Model(*parts, supports=held, joints=ties["joints"], springs=ties["springs"], loads=loads, **touching)


def name_of(part: Any, model: Model | None) -> str | None:
    """The name of a part in a model, or None: of the part itself, else of the one that equals it in every number.

    An opened run has parts of its own, which a user's parts can only equal.
    """
    if model is None or not isinstance(part, Part):
        return None
    pairs = list(zip(model.parts, model.names, strict=True))
    same = [name for other, name in pairs if other is part]
    if not same:
        own = _whole_record(part)
        same = [name for other, name in pairs if type(other) is type(part) and _whole_record(other) == own]
    return same[0] if len(same) == 1 else None


def _section_record(section: Section) -> dict[str, Any]:
    return {
        "name": section.name,
        "stiffness": section.stiffness.tolist(),
        "mass_per_length": section.mass_per_length,
        "inertia": section.inertia.tolist(),
        "outline": section.outline.tolist(),
        **({"mass_center": list(section.mass_center)} if any(section.mass_center) else {}),
    }


def _all_sections(given: Section | Stations) -> list[Section]:
    return [given] if isinstance(given, Section) else [section for own in given.sections for section in own]


def _numbered(given: Section | Stations, numbers: Mapping[int, int]) -> Any:
    """A section by its number among those of the model; stations as those of every element, with their name."""
    if isinstance(given, Section):
        return numbers[id(given)]
    return {"name": given.name, "stations": [[numbers[id(section)] for section in own] for own in given.sections]}


def _whole_record(part: Part) -> Any:
    if isinstance(part, Rod):
        return _rod_record(part), [_section_record(section) for section in _all_sections(part.stations)]
    return part_record(part)


def _rod_from(record: Mapping[str, Any], sections: Sequence[Section]) -> Rod:
    """Make a rod of its record."""
    given = dict(record)
    section = given["section"]
    if isinstance(section, Mapping):
        rows = tuple(tuple(sections[k] for k in own) for own in section["stations"])
        given["section"] = Stations(rows, str(section["name"]))
    else:
        given["section"] = sections[section]
    if given.get("damping") is not None:
        given["damping"] = damping_from(given["damping"])
    if given.get("shape") is not None:
        given["shape"] = Shape(**{name: np.array(given["shape"][name]) for name in ("position", "rotation")})
    return Rod(**given)


def _rod_record(rod: Rod) -> dict[str, Any]:
    return {
        "name": rod.name,
        "length": rod.length,
        "elements": rod.elements,
        "origin": list(rod.origin),
        "direction": list(rod.direction),
        "normal": None if rod.normal is None else list(rod.normal),
        **({} if rod.kinematics == "shearable" else {"kinematics": rod.kinematics}),
        **({} if rod.spacing is None else {"spacing": list(rod.spacing)}),
        **({} if rod.stretched == 1.0 else {"stretched": rod.stretched}),
        **({"residual_bending": True} if rod.residual_bending else {}),
        **({} if rod.shape is None else {"shape": _shape_record(rod.shape)}),
        **({} if rod.damping is None else {"damping": damping_record(rod.damping)}),
    }


def _shape_record(shape: Shape) -> dict[str, Any]:
    return {"position": shape.position.tolist(), "rotation": shape.rotation.tolist()}


def _index(rod: Rod, model: Model) -> int:
    return next(k for k, other in enumerate(model.rods) if other is rod)


def _load_record(load: Load, model: Model) -> dict[str, Any]:
    if isinstance(load, Gravity):
        return {"kind": "gravity", "acceleration": list(load.acceleration)}
    if isinstance(load, RodLoad):
        return rod_load_record(load, _index(load.rod, model))
    place = port_record(load.port, model) if isinstance(load, PointLoad) else {"rod": _index(load.rod, model)}
    named = getattr(load.value, "__name__", type(load.value).__name__)
    return {
        "kind": load.kind,
        **place,
        "value": {"function": str(named)} if callable(load.value) else list(load.value),
        "frame": load.frame,
        "start": load.start,
        "until": None if load.until == math.inf else load.until,
    }


def _load_from(
    record: Mapping[str, Any], rods: Sequence[Rod], parts: Sequence[Part], function: Callable[[float], Any] | None
) -> Load:
    if record["kind"] == "gravity":
        return Gravity(tuple(record["acceleration"]))
    if record["kind"] in KINDS:
        return rod_load_from(record, list(rods))
    shared = {
        "kind": record["kind"],
        "value": tuple(record["value"]) if function is None else function,
        "frame": record["frame"],
        "start": record["start"],
        "until": math.inf if record["until"] is None else record["until"],
    }
    if "node" in record:
        return PointLoad(port=port_from(record, parts), **shared)
    return LineLoad(rod=rods[record["rod"]], **shared)


__all__ = ["model_from", "model_record", "name_of"]
