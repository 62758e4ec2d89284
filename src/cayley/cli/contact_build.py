"""From the tables of a scenario file to obstacles and contact."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Any

from cayley.cli import problems
from cayley.cli.contact_schema import AnyObstacle, ContactTable, MeshTable
from cayley.model import Body, Box, Capsule, Contact, Cylinder, Mesh, Obstacle, Part, Plane, Rod, Sphere
from cayley.model.contact import outer_radius, round_radius

_KINDS: dict[str, Any] = {
    "plane": Plane,
    "sphere": Sphere,
    "capsule": Capsule,
    "cylinder": Cylinder,
    "box": Box,
}


def wrong_obstacle(table: AnyObstacle, parts: Mapping[str, Part]) -> tuple[str, str] | None:
    """What is wrong with a table beyond what its shape refuses: the key and the problem, or None."""
    if table.on is not None and not isinstance(parts.get(table.on), Body):
        if table.on in parts:
            return "on", f"is {problems.shown(table.on)}; allowed: a [[body]] with inertia"
        return "on", problems.unlike(table.on, (name for name, part in parts.items() if isinstance(part, Body)))
    if not isinstance(table, MeshTable):
        return None
    given = [key for key in ("vertices", "triangles") if getattr(table, key) is not None]
    if table.file is None and len(given) < 2:
        return "file", "is missing; allowed: the name of a file, or vertices and triangles"
    if table.file is not None and given:
        return given[0], "is given beside file; allowed: one of the two"
    if table.file is not None and not PurePath(table.file).is_absolute() and ".." in PurePath(table.file).parts:
        return "file", f"is {problems.shown(table.file)}; allowed: a file in or below the folder of the scenario"
    return None


def obstacle_of(table: AnyObstacle, parts: Mapping[str, Part], folder: Path) -> Obstacle:
    """An obstacle of its table; files are looked for in the folder.

    Raises:
        TypeError: as for the shape.
        ValueError: as for the shape.
        ImportError: a file needs meshio, which is not installed.
    """
    given = table.model_dump(exclude={"shape", "on"})
    given["on"] = None if table.on is None else parts[table.on]
    if not isinstance(table, MeshTable):
        made: Obstacle = _KINDS[table.shape](**given)
        return made
    vertices, triangles, file = (given.pop(key) for key in ("vertices", "triangles", "file"))
    placed = {key: given.pop(key) for key in ("scale", "center", "rotation")}
    try:
        mesh = Mesh(vertices, triangles, **given) if file is None else Mesh.read(folder / file, **given)
    except FileNotFoundError as error:
        raise ValueError(str(error)) from None
    return mesh.placed(**placed)


def contact_of(
    table: ContactTable, parts: Mapping[str, Part], obstacles: Mapping[str, Obstacle]
) -> tuple[Contact | None, list[tuple[tuple[str | int, ...], str]]]:
    """The contact of its table, or None and what is wrong: places in it and problems."""
    rods = {name: part for name, part in parts.items() if isinstance(part, Rod)}
    wrong: list[tuple[tuple[str | int, ...], str]] = []
    selves = [] if isinstance(table.self_contact, bool) else table.self_contact
    wrong += [(("self_contact",), problems.unlike(name, rods)) for name in selves if name not in rods]
    wrong += [(("radii", name), f"is no rod; allowed: {', '.join(rods)}") for name in table.radii if name not in rods]
    for name, rod in rods.items():
        if name not in table.radii and round_radius(rod) is None:
            such = f"radii = {{{name} = {outer_radius(rod):.3g}}}"
            wrong.append((("radii",), f"has no {name}, whose section is not round; allowed: such as {such} [m]"))
    both = sorted(set(parts) & set(obstacles))
    for k, pair in enumerate(table.without):
        for name in pair:
            if name in both:
                wrong.append(
                    (("without", k), f"{problems.shown(name)} is a part and an obstacle; name one differently")
                )
            elif name not in parts and name not in obstacles:
                wrong.append((("without", k), problems.unlike(name, [*parts, *obstacles])))
    if wrong:
        return None, wrong
    given = table.model_dump(exclude={"self_contact", "radii", "without"})
    known: dict[str, Any] = {**parts, **obstacles}
    return Contact(
        **given,
        self_contact=table.self_contact if isinstance(table.self_contact, bool) else [rods[name] for name in selves],
        radii={rods[name]: radius for name, radius in table.radii.items()},
        without=[tuple(known[name] for name in pair) for pair in table.without],
    ), []
