"""Bodies, ports, joints and springs of a model as plain numbers and words, and back."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from cayley.model import Body, LagrangianPart, Model, Part, PointMass, Port, ground
from cayley.model.joints import Joint
from cayley.model.motion import Table
from cayley.model.port import HERE, UNTURNED
from cayley.model.springs import Spring
from cayley.results.own_record import own_from, own_record

_NUMBERS = ("axis", "other", "length")


def parts_record(model: Model) -> dict[str, Any]:
    """Bodies, point masses, parts with a Lagrangian of their own, and the order of all; nothing for a model of rods."""
    if len(model.rods) == len(model.parts):
        return {}
    found: dict[str, Any] = {"bodies": [part_record(body) for body in model.bodies]}
    if model.own_parts:
        found["parts"] = [part_record(part) for part in model.own_parts]
    return found | {"order": [_word(part) for part in model.parts]}


def parts_from(record: Mapping[str, Any], rods: Sequence[Part]) -> list[Part]:
    """All parts in their order."""
    left: dict[str, Iterator[Part]] = {
        "rod": iter(rods),
        "body": map(_body_from, record.get("bodies", ())),
        "part": map(own_from, record.get("parts", ())),
    }
    return [next(left[word]) for word in record.get("order", ["rod"] * len(rods))]


def part_record(part: Part) -> dict[str, Any]:
    """A body, point mass or part with a Lagrangian of its own."""
    if isinstance(part, LagrangianPart):
        return own_record(part)
    assert isinstance(part, Body | PointMass)
    shared = {"name": part.name, "mass": part.mass, "position": list(part.position)}
    if isinstance(part, PointMass):
        return shared
    return shared | {
        "inertia": np.asarray(part.inertia).tolist(),
        "rotation": list(part.rotation),
        "ports": {name: [list(shift), list(turn)] for name, (shift, turn) in part.ports.items()},
    }


def _word(part: Part) -> str:
    """What a record calls the kind of a part."""
    return "part" if isinstance(part, LagrangianPart) else "body" if isinstance(part, Body | PointMass) else "rod"


def port_record(port: Port, model: Model) -> dict[str, Any]:
    """A port: kind and number of its part, node, and where it stands off the node."""
    kind = _word(port.part)
    same = [part for part in model.parts if _word(part) == kind]
    number = next(k for k, part in enumerate(same) if part is port.part)
    found: dict[str, Any] = {kind: number, "node": port.node}
    if port.shift != HERE or port.turn != UNTURNED:
        found |= {"shift": list(port.shift), "turn": list(port.turn)}
    return found | ({"name": port.name} if port.name else {})


def port_from(record: Mapping[str, Any], parts: Sequence[Part]) -> Port:
    """A port of its record, on one of the parts of a model."""
    kind = next(word for word in ("rod", "body", "part") if word in record)
    part = [part for part in parts if _word(part) == kind][record[kind]]
    options = {key: tuple(record[key]) for key in ("shift", "turn") if key in record}
    return Port(part, record["node"], name=record.get("name", ""), **options)


def ties_record(model: Model) -> dict[str, Any]:
    """Guides, joints and springs; nothing where there are none."""
    found: dict[str, Any] = {}
    for name, joints in (("guides", model.guides), ("joints", model.joints)):
        if joints:
            found[name] = [_joint_record(joint, model) for joint in joints]
    if model.springs:
        found["springs"] = [_spring_record(spring, model) for spring in model.springs]
    return found


def ties_from(
    record: Mapping[str, Any], parts: Sequence[Part], functions: Mapping[str, Callable[[float], Any]]
) -> dict[str, list[Any]]:
    """Guides, joints and springs of a record.

    Args:
        record: made by ties_record.
        parts: all parts of the model.
        functions: prescribed motions that are functions, by "name of the joint/quantity".
    """

    def side(given: Mapping[str, Any]) -> Any:
        if "ground" in given:
            return ground if given["ground"] is None else ground.at(given["ground"])
        return port_from(given, parts)

    def joint(given: Mapping[str, Any]) -> Joint:
        rest = {key: value for key, value in given.items() if key not in ("first", "second", "motion", "label")}
        motion = {q: _motion_from(m, f"{given['label']}/{q}", functions) for q, m in given.get("motion", {}).items()}
        return Joint(first=side(given["first"]), second=side(given["second"]), **rest, **motion)

    def spring(given: Mapping[str, Any]) -> Spring:
        rest = {key: value for key, value in given.items() if key not in ("first", "second")}
        return Spring(first=side(given["first"]), second=side(given["second"]), **rest)

    return {
        "guides": [joint(given) for given in record.get("guides", ())],
        "joints": [joint(given) for given in record.get("joints", ())],
        "springs": [spring(given) for given in record.get("springs", ())],
    }


def driven_functions(model: Model) -> Iterator[tuple[str, str, Joint]]:
    """Prescribed motions that are functions of the time: name of the joint, quantity and joint."""
    for joint, name in zip(model.connections, model.connection_names, strict=True):
        for quantity in joint.driven:
            if not isinstance(getattr(joint, quantity), Table):
                yield name, quantity, joint


def recorded_functions(record: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """The same of a record: name of the joint, quantity, and name of the function."""
    for given in (*record.get("guides", ()), *record.get("joints", ())):
        for quantity, motion in given.get("motion", {}).items():
            if "function" in motion:
                yield given["label"], quantity, motion["function"]


def _side_record(side: Any, model: Model) -> dict[str, Any]:
    if isinstance(side, Port):
        return port_record(side, model)
    return {"ground": None if side.position is None else list(side.position)}


def _joint_record(joint: Joint, model: Model) -> dict[str, Any]:
    label = dict(zip(map(id, model.connections), model.connection_names, strict=True))[id(joint)]
    found: dict[str, Any] = {"kind": joint.kind, "name": joint.name, "label": label}
    found |= {word: _side_record(getattr(joint, word), model) for word in ("first", "second")}
    for word in _NUMBERS:
        value = getattr(joint, word)
        if value is not None:
            found[word] = list(value) if isinstance(value, tuple) else value
    if joint.driven:
        found["motion"] = {quantity: _motion_record(getattr(joint, quantity)) for quantity in joint.driven}
    return found


def _spring_record(spring: Spring, model: Model) -> dict[str, Any]:
    def plain(value: Any) -> Any:
        return value.tolist() if isinstance(value, np.ndarray) else value

    return {
        "kind": spring.kind,
        "name": spring.name,
        **{word: _side_record(getattr(spring, word), model) for word in ("first", "second")},
        "stiffness": plain(spring.stiffness),
        "damping": plain(spring.damping),
        "length": spring.length,
        "angle": spring.angle,
        "axis": None if spring.axis is None else list(spring.axis),
    }


def _motion_record(motion: Any) -> dict[str, Any]:
    if isinstance(motion, Table):
        numbers = {"times": motion.times.tolist(), "values": motion.values.tolist()}
        return numbers | {"interpolation": motion.interpolation}
    return {"function": str(getattr(motion, "__name__", type(motion).__name__))}


def _motion_from(record: Mapping[str, Any], key: str, functions: Mapping[str, Callable[[float], Any]]) -> Any:
    if "function" in record:
        return functions[key]
    return Table(np.array(record["times"]), np.array(record["values"]), record["interpolation"])


def _body_from(record: Mapping[str, Any]) -> Body | PointMass:
    return Body(**record) if "inertia" in record else PointMass(**record)
