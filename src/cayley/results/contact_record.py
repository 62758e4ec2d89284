"""Obstacles and contact of a model as plain numbers and words, and back."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from cayley.model import Box, Capsule, Contact, Cylinder, Mesh, Model, Obstacle, Part, Plane, Sphere
from cayley.model.contact import Partner

_KINDS: dict[str, type[Obstacle]] = {kind.kind: kind for kind in (Plane, Sphere, Capsule, Cylinder, Box, Mesh)}
_SINGLE = ("friction", "penetration", "impact_depth", "damping", "stiffness", "allow_overlap")


def contact_record(model: Model) -> dict[str, Any]:
    """Obstacles and contact; nothing for a model without."""
    if model.contact is None:
        return {}
    contact = model.contact
    selves = contact.self_contact
    return {
        "obstacles": [_obstacle_record(obstacle, model.parts) for obstacle in model.obstacles],
        "contact": {
            **{word: getattr(contact, word) for word in _SINGLE},
            "self_contact": selves if isinstance(selves, bool) else [_number(rod, model) for rod in selves],
            "radii": [[_number(rod, model), radius] for rod, radius in contact.radii.items()],
            "without": [[_number(side, model) for side in pair] for pair in contact.without],
        },
    }


def contact_from(record: Mapping[str, Any], parts: Sequence[Part]) -> dict[str, Any]:
    """The arguments obstacles and contact of a model.

    Args:
        record: of a model.
        parts: all parts of it.
    """
    if record.get("contact") is None:
        return {}
    obstacles = [_obstacle_from(given, parts) for given in record["obstacles"]]
    known: list[Any] = [*parts, *obstacles]
    given = dict(record["contact"])
    if not isinstance(given["self_contact"], bool):
        given["self_contact"] = [known[k] for k in given["self_contact"]]
    given["radii"] = {known[k]: radius for k, radius in given["radii"]}
    given["without"] = [(known[i], known[k]) for i, k in given["without"]]
    return {"obstacles": obstacles, "contact": Contact(**given)}


def _number(member: Partner, model: Model) -> int:
    """Of a part, or behind the parts of an obstacle."""
    return next(k for k, other in enumerate([*model.parts, *model.obstacles]) if other is member)


def _obstacle_record(obstacle: Obstacle, parts: Sequence[Part]) -> dict[str, Any]:
    found: dict[str, Any] = {"kind": obstacle.kind}
    for one in fields(obstacle):
        value = getattr(obstacle, one.name)
        if one.name == "on":
            value = None if value is None else next(k for k, part in enumerate(parts) if part is value)
        if one.init:
            found[one.name] = np.asarray(value).tolist() if isinstance(value, (tuple, np.ndarray)) else value
    return found


def _obstacle_from(record: Mapping[str, Any], parts: Sequence[Part]) -> Obstacle:
    given = {name: value for name, value in record.items() if name != "kind"}
    carrier = given.pop("on")
    return _KINDS[record["kind"]](on=None if carrier is None else parts[carrier], **given)


__all__ = ["contact_from", "contact_record"]
