"""How rods and shapes touch: friction, stiffness, and who does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.model import validate
from cayley.model.part import Part
from cayley.model.rod import Rod
from cayley.model.section import Section
from cayley.model.shapes import Mesh, Obstacle

if TYPE_CHECKING:
    from cayley.model.model import Model

Partner = Part | Obstacle
DEEP = 10.0
"""Depth of impacts over that wanted under loads, where none is given."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contact:
    """Contact of rods with themselves, with each other and with shapes, and of shapes on bodies.

    Attributes:
        friction: Coulomb coefficient [-] among rods, and of shapes that give none; where two differ the larger applies.
        penetration: depth wanted at most under the loads the library expects, in radii of the thinner partner [-].
        impact_depth: depth at most where parts hit each other, in radii [-]: steps that the library chooses keep to it,
            with others a run warns; None: ten times the penetration.
        damping: fraction of the critical damping of the motion normal to a contact [-]; 0: none, and then, without
            friction, energy is kept.
        self_contact: whether rods touch themselves; or a list of those that do.
        stiffness: of all contacts [N/m]; None: chosen from masses, step and load.
        radii: radius of rods [m] whose section is no circle or tube, or instead of theirs.
        without: pairs that never touch, each a part or a shape; a part stands for all shapes on it, a pair of the same
            rod for its contact with itself.
        allow_overlap: parts that overlap at the start are pushed apart gently; else they are an error.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range.

    Example:
        >>> print(Contact(friction=0.3, self_contact=False))
        friction 0.3, penetration 0.01 radii, damping 0.05, no self-contact
    """

    friction: float = 0.0
    penetration: float = 0.01
    impact_depth: float | None = None
    damping: float = 0.05
    self_contact: bool | Sequence[Rod] = True
    stiffness: float | None = None
    radii: Mapping[Rod, float] = field(default_factory=dict)
    without: Sequence[tuple[Partner, Partner]] = ()
    allow_overlap: bool = False

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        self._between("friction", 0.0, np.inf, "a number from 0 [-]")
        self._between("damping", 0.0, 1.0, "a number from 0 to 1, the critical damping [-]")
        depth = validate.positive("Contact", "penetration", self.penetration, "radii")
        if depth >= 1.0:
            raise ValueError(validate.wrong("Contact", "penetration", depth, "below 1 (radii of the thinner partner)"))
        for name, unit in (("stiffness", "N/m"), ("impact_depth", "radii")):
            if getattr(self, name) is not None:
                self._set(name, validate.positive("Contact", name, getattr(self, name), unit))
        if not isinstance(self.allow_overlap, bool):
            raise TypeError(validate.wrong("Contact", "allow_overlap", self.allow_overlap, "True or False"))
        self._set("penetration", depth)
        self._set("self_contact", _selves(self.self_contact))
        self._set("radii", _radii(self.radii))
        self._set("without", _pairs(self.without))

    def __str__(self) -> str:
        """What is said without names of parts, in one line."""
        words = [f"friction {self.friction:g}", f"penetration {self.penetration:g} radii", f"damping {self.damping:g}"]
        words += [] if self.stiffness is None else [f"stiffness {self.stiffness:g} N/m"]
        if isinstance(self.self_contact, bool):
            words += [] if self.self_contact else ["no self-contact"]
        else:
            words.append(f"self-contact of {len(self.self_contact)} {'rod' if len(self.self_contact) == 1 else 'rods'}")
        return ", ".join(words + (["overlap at the start allowed"] if self.allow_overlap else []))

    @property
    def deepest(self) -> float:
        """Depth at most where parts hit each other, in radii [-]."""
        return DEEP * self.penetration if self.impact_depth is None else self.impact_depth

    def touches_itself(self, rod: Rod) -> bool:
        """Whether a rod may touch itself."""
        if any(first is rod and second is rod for first, second in self.without):
            return False
        if isinstance(self.self_contact, bool):
            return self.self_contact
        return any(other is rod for other in self.self_contact)

    def excludes(self, first: Partner, second: Partner) -> bool:
        """Whether two never touch: rods or shapes; a shape is excluded with the body that carries it, too."""
        return any(
            (_covers(one, first) and _covers(two, second)) or (_covers(one, second) and _covers(two, first))
            for one, two in self.without
        )

    def _between(self, name: str, least: float, most: float, right: str) -> None:
        value = validate.number("Contact", name, getattr(self, name), "-")
        if not least <= value <= most:
            raise ValueError(validate.wrong("Contact", name, value, right))
        self._set(name, value)

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)


def check_contact(model: Model) -> None:
    """Refuse what does not belong to the model, and rods without a radius.

    Raises:
        ValueError: an obstacle twice, or on a body that is not in the model; a rod or a shape of the Contact that is
            not in the model; with contact, a rod that is not round and has no radius.
    """
    known, shapes = {id(part) for part in model.parts}, set[int]()
    for obstacle in model.obstacles:
        if id(obstacle) in shapes:
            raise ValueError(f"Model: {obstacle.label} is given twice among the obstacles; give each shape once")
        shapes.add(id(obstacle))
        if obstacle.on is not None and id(obstacle.on) not in known:
            what = f"{obstacle.label} is on {obstacle.on.label}"
            raise ValueError(_stranger(what, model.names))
    names = (*model.names, *model.obstacle_names)
    if model.contact is None:
        return
    selves = () if isinstance(model.contact.self_contact, bool) else model.contact.self_contact
    listed: list[tuple[str, Any]] = [("self_contact", rod) for rod in selves]
    listed += [("radii", rod) for rod in model.contact.radii]
    listed += [("without", side) for pair in model.contact.without for side in pair]
    for word, member in listed:
        if id(member) not in known | shapes:
            raise ValueError(_stranger(f"{word} of the Contact has {member.label}", names))
    for rod in model.rods:
        contact_radius(model, rod)


def odd_contact(model: Model) -> tuple[str, ...]:
    """What is legal but looks odd, a line each: rods that taper, closed meshes turned inside out."""
    odd = []
    given = {} if model.contact is None else model.contact.radii
    for rod in model.rods if model.contact is not None else ():
        radii = [section.radius for section in _sections(rod) if section.radius is not None]
        if rod not in given and min(radii) < max(radii):
            least, most = min(radii), max(radii)
            odd.append(
                f"{model.name_of(rod)} touches with its largest radius, {most:g} m, everywhere; least is {least:g} m"
            )
    for name, obstacle in zip(model.obstacle_names, model.obstacles, strict=True):
        if isinstance(obstacle, Mesh) and obstacle.closed and obstacle.volume < 0.0:
            odd.append(
                f"{name} is closed and its triangles are clockwise seen from outside, so it is solid all around it"
            )
    return tuple(odd)


def contact_radius(model: Model, rod: Rod) -> float:
    """Radius with which a rod touches [m]: that given in the radii, else that of its round section, where largest.

    Raises:
        ValueError: the section is not round and no radius is given.
    """
    given = {} if model.contact is None else model.contact.radii
    radius = given[rod] if rod in given else round_radius(rod)
    if radius is None:
        name, size = model.name_of(rod), outer_radius(rod)
        raise ValueError(
            f"Model: {name} has no round section ({rod.stations.name}), so contact needs its radius: give "
            f"Contact(radii={{{name}: {size:.3g}}}) (that of the circle around the section) or another"
        )
    return radius


def round_radius(rod: Rod) -> float | None:
    """Outer radius of a rod of round sections [m], where largest; None: a section is not round."""
    own = _sections(rod)
    radii = [section.radius for section in own if section.radius is not None]
    return max(radii) if len(radii) == len(own) else None


def outer_radius(rod: Rod) -> float:
    """Radius of the circle about the axis that holds all its sections [m]."""
    return max(float(np.linalg.norm(section.outline, axis=1).max()) for section in _sections(rod))


def _stranger(what: str, names: Sequence[str]) -> str:
    return f"Model: {what}, which is not in the model; add it (the model has {', '.join(names)})"


def _sections(rod: Rod) -> list[Section]:
    given = rod.stations
    return [given] if isinstance(given, Section) else [section for own in given.sections for section in own]


def _covers(listed: Partner, asked: Partner) -> bool:
    return listed is asked or (isinstance(asked, Obstacle) and asked.on is not None and listed is asked.on)


def _selves(value: Any) -> bool | tuple[Rod, ...]:
    right = "True, False or a list of rods that may touch themselves"
    if isinstance(value, bool):
        return value
    if not isinstance(value, (list, tuple)) or not all(isinstance(rod, Rod) for rod in value):
        raise TypeError(validate.wrong("Contact", "self_contact", value, right))
    return tuple(value)


def _radii(value: Any) -> dict[Rod, float]:
    right = "a dictionary {rod: radius [m]}"
    if not isinstance(value, Mapping) or not all(isinstance(rod, Rod) for rod in value):
        raise TypeError(validate.wrong("Contact", "radii", value, right))
    return {rod: validate.positive("Contact", f"radii[{rod.label}]", radius, "m") for rod, radius in value.items()}


def _pairs(value: Any) -> tuple[tuple[Partner, Partner], ...]:
    right = "a list of pairs of parts or shapes, such as [(rod, floor)]"
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise TypeError(validate.wrong("Contact", "without", value, right))
    found = []
    for pair in value:
        fits = isinstance(pair, (list, tuple)) and len(pair) == 2
        if not fits or not all(isinstance(side, (Part, Obstacle)) for side in pair):
            raise TypeError(validate.wrong("Contact", "without", value, right))
        if pair[0] is pair[1] and not isinstance(pair[0], Rod):
            raise ValueError(f"Contact: without has {pair[0].label} twice in a pair; only a rod can touch itself")
        found.append((pair[0], pair[1]))
    return tuple(found)
