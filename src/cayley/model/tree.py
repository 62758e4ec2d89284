"""The listing of a model: what `print(model)` shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cayley.model.body import PointMass
from cayley.model.lagrangian_part import LagrangianPart
from cayley.model.loads import Gravity
from cayley.model.part import Part
from cayley.model.rod import Rod

if TYPE_CHECKING:
    from cayley.model.contact import Contact
    from cayley.model.model import Model


def tree(model: Model) -> list[str]:
    """Lines of the listing: counts, parts, supports, joints, springs, loads, obstacles, contact, and what looks odd."""
    rods = model.rods
    masses = sum(isinstance(part, PointMass) for part in model.parts)
    own = len(model.own_parts)
    bodies = len(model.parts) - len(rods) - masses - own
    counts = [(len(rods), "rod"), (bodies, "body"), (masses, "mass"), (own, "part")]
    elements = sum(rod.elements for rod in rods)
    nodes = sum(part.node_count for part in model.parts)
    told = [_counted(number, noun) for number, noun in counts if number]
    told += [_counted(elements, "element")] if rods else []
    lines = [f"Model: {', '.join(told)}, {_counted(nodes, 'node')}, {model.mass:g} kg", "  parts"]
    lines += [f"    {name}: {_size(part)}" for part, name in zip(model.parts, model.names, strict=True)]
    lines += _section(
        "supports",
        [f"{s.kind} at {s.port.called(model.name_of(s.port.part))}" for s in model.supports]
        + [model.described(guide) for guide in model.guides],
    )
    lines += _section("joints", [model.described(joint) for joint in model.joints])
    lines += _section("springs", [model.described(spring) for spring in model.springs])
    lines += _section(
        "loads",
        [str(load) if isinstance(load, Gravity) else load.described(model.name_of(load.part)) for load in model.loads],
    )
    lines += _section("obstacles", _obstacles(model))
    lines += _section("contact", [] if model.contact is None else _contact(model, model.contact))
    return lines + _section("warnings", list(model.warnings))


def _obstacles(model: Model) -> list[str]:
    found = []
    for name, obstacle in zip(model.obstacle_names, model.obstacles, strict=True):
        carrier = "" if obstacle.on is None else f", on {model.name_of(obstacle.on)}"
        friction = "" if obstacle.friction is None else f", friction {obstacle.friction:g}"
        kind = "" if name == obstacle.kind else f"{obstacle.kind}, "
        found.append(f"{name}: {kind}{obstacle.geometry}{carrier}{friction}")
    return found


def _contact(model: Model, contact: Contact) -> list[str]:
    called = dict(zip(map(id, model.obstacles), model.obstacle_names, strict=True))
    called |= dict(zip(map(id, model.parts), model.names, strict=True))
    lines = [str(contact)]
    lines += [f"radius of {model.name_of(rod)}: {radius:g} m" for rod, radius in contact.radii.items()]
    return lines + [f"{called[id(one)]} never touches {called[id(two)]}" for one, two in contact.without]


def _size(part: Part) -> str:
    if isinstance(part, Rod):
        damped = "" if part.damping is None else f", {part.damping}"
        return (
            f"{part.length:g} m, {_counted(part.elements, 'element')}, {part.stations.name}{damped}, {part.mass:g} kg"
        )
    if isinstance(part, LagrangianPart):
        size = "" if part.domain is None else f", {_counted(part.domain.elements, 'element')}"
        return f"Lagrangian {part.lagrangian.name}{size}"
    return f"{'point mass' if isinstance(part, PointMass) else 'rigid body'}, {part.mass:g} kg"


def _section(heading: str, lines: list[str]) -> list[str]:
    return [f"  {heading}", *(f"    {line}" for line in lines)] if lines else []


def _counted(number: int, noun: str) -> str:
    plural = {"body": "bodies", "mass": "masses"}.get(noun, f"{noun}s")
    return f"{number} {noun if number == 1 else plural}"
