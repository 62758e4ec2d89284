"""Parts whose mechanics is a Lagrangian of one's own."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.lie import quaternion
from cayley.model import validate
from cayley.model.body import CENTRE, checked_ports
from cayley.model.part import Part, checked_name
from cayley.model.port import UNTURNED, Port, Quad, unit_quaternion
from cayley.model.validate import Array, Triple

if TYPE_CHECKING:
    from cayley.density.fields import Interval
    from cayley.density.lagrangian import Lagrangian

_ALLOWED = "fields p = cy.Rotation(), x = cy.Vector(3) or both, and no others"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LagrangianPart(Part):
    """A part with any Lagrangian of position x and rotation p: one node, or a chain of them on an interval.

    L(p, x, ω, ẋ, t) [J],   or on an interval its density L(p, x, Ω, x′, ω, ẋ, s, t) [J/m]

    Supports, joints, springs and point loads attach to its ports as to those of bodies and rods. Of a Lagrangian with
    x alone the rotation is held at the start's, of one with p alone the position. `loads.gravity` does not act on it:
    its weight, like all else about it, is what its Lagrangian says. Two parts are equal only if they are the same
    object.

    Attributes:
        lagrangian: made with `@cy.lagrangian`, of p and x.
        constants: numbers, vectors and matrices by the names c has for them.
        domain: interval and elements of a Lagrangian density; None for a Lagrangian without interval.
        position: x at the start [m]; on an interval of its beginning, from where nodes follow each other along e3 of
            the rotation, or a function of s that returns x.
        rotation: p at the start, body to space: a unit quaternion (wxyz) or a rotation matrix; on an interval also a
            function of s.
        ports: without an interval: name -> (x, y, z) from x in the body frame [m], or ((x, y, z), rotation) with the
            port's own frame.
        name: in listings and results; empty: the model numbers the part.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: the Lagrangian has other fields, the domain is missing or too much, or a value is out of range.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), section 4.
    """

    lagrangian: Lagrangian
    constants: Mapping[str, Any] = field(default_factory=dict)
    domain: Interval | None = None
    position: Triple | Callable[[float], Any] = (0.0, 0.0, 0.0)
    rotation: Quad | Callable[[float], Any] = UNTURNED
    ports: Mapping[str, tuple[Triple, Quad]] = field(default_factory=dict)
    name: str = ""

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        checked_name("LagrangianPart", self.name)
        owner = self.label
        self._check_lagrangian(owner)
        constants = {}
        for name, value in dict(self.constants).items():
            if not isinstance(name, str) or not name.isidentifier():
                raise ValueError(validate.wrong(owner, "constants", name, "named like variables"))
            constants[name] = validate.array(owner, name, value, (-1,) * np.ndim(value), "finite numbers")
        object.__setattr__(self, "constants", constants)
        if not callable(self.position):
            object.__setattr__(self, "position", validate.vector(owner, "position", self.position, "m"))
        if not callable(self.rotation):
            object.__setattr__(self, "rotation", unit_quaternion(owner, "rotation", self.rotation))
        ports = checked_ports(owner, self.ports)
        if self.domain is not None and ports:
            raise ValueError(validate.wrong(owner, "ports", list(ports), "left out: on an interval they are its nodes"))
        object.__setattr__(self, "ports", ports)
        for node in (0, self.node_count - 1):
            self.place(node)

    def _check_lagrangian(self, owner: str) -> None:
        from cayley.density.fields import Interval, Rotation, Vector  # there already when someone has a Lagrangian
        from cayley.density.lagrangian import Lagrangian

        given = self.lagrangian
        if not isinstance(given, Lagrangian):
            raise TypeError(validate.wrong(owner, "lagrangian", given, "a function decorated with @cy.lagrangian(...)"))
        pose = {"p": Rotation(), "x": Vector(3)}
        for name, kind in given.fields.items():
            if pose.get(name) != kind:
                raise ValueError(f"{owner}: {given.name} has the field {name} = {kind}, but must have {_ALLOWED}")
        if given.interval is None and self.domain is not None:
            right = f"left out, for {given.name} has no interval"
            raise ValueError(validate.wrong(owner, "domain", self.domain, right))
        if given.interval is not None and not isinstance(self.domain, Interval):
            right = f"a cy.Interval(start, stop, elements=n), for {given.name} is a density"
            raise ValueError(validate.wrong(owner, "domain", self.domain, right))
        if self.domain is None and (callable(self.position) or callable(self.rotation)):
            raise TypeError(f"{owner}: a position or rotation that is a function of s is for a part on an interval")

    def __repr__(self) -> str:
        """Name and Lagrangian, in one line."""
        name = f"name={self.name!r}, " if self.name else ""
        return f"LagrangianPart({name}lagrangian={self.lagrangian.name})"

    @property
    def noun(self) -> str:
        """The word "part"."""
        return "part"

    @property
    def mass(self) -> float:
        """Not a number: what moves of it is in its Lagrangian."""
        return math.nan

    @property
    def nodes(self) -> Array:
        """Coordinate s of each node [m], shape (node_count,); without an interval one zero."""
        if self.domain is None:
            return np.zeros(1)
        return np.linspace(self.domain.start, self.domain.stop, self.domain.elements + 1)

    @property
    def node_count(self) -> int:
        """One, or on an interval the number of its elements and one more."""
        return 1 if self.domain is None else self.domain.elements + 1

    @property
    def held(self) -> tuple[bool, bool]:
        """Whether the position, and whether the rotation is held, for the Lagrangian does not have it."""
        return "x" not in self.lagrangian.fields, "p" not in self.lagrangian.fields

    @property
    def centre(self) -> Port:
        """The node of a part without an interval."""
        return self.port(CENTRE)

    @property
    def start(self) -> Port:
        """The first node."""
        return Port(self, 0)

    @property
    def end(self) -> Port:
        """The last node."""
        return Port(self, -1)

    def node(self, k: int) -> Port:
        """Node k, from 0, or back from -1.

        Raises:
            TypeError: k is not a whole number.
            ValueError: there is no such node.
        """
        return Port(self, k)

    def port(self, name: str) -> Port:
        """A port by its name: "centre" or one of its own; on an interval "start" or "end".

        Raises:
            ValueError: there is none of that name.
        """
        known = [CENTRE, *self.ports] if self.domain is None else ["start", "end"]
        if name not in known:
            raise ValueError(validate.wrong(self.label, "port", name, f"one of {', '.join(known)}"))
        if name not in self.ports:
            return self.end if name == "end" else self.start
        shift, turn = self.ports[name]
        return Port(self, 0, shift=shift, turn=turn, name=name)

    def place(self, node: int) -> tuple[Array, Array]:
        """Position x [m], shape (3,), and rotation p, wxyz, shape (4,), of a node before any motion."""
        return self.place_at(float(self.nodes[node]))

    def place_at(self, s: float) -> tuple[Array, Array]:
        """Position x [m], shape (3,), and rotation p, wxyz, shape (4,), at the coordinate s, before any motion.

        Raises:
            TypeError: a function of s does not return numbers.
            ValueError: it does not return three finite ones, or no rotation.
        """
        turn = self.rotation(s) if callable(self.rotation) else self.rotation
        rotation = np.array(unit_quaternion(self.label, "rotation", turn))
        if callable(self.position):
            return np.array(validate.vector(self.label, "position", self.position(s), "m")), rotation
        along = s - self.domain.start if self.domain is not None else 0.0
        position: Array = np.array(self.position) + quaternion.rotate(rotation, np.array([0.0, 0.0, along]))
        return position, rotation

    def node_name(self, node: int) -> str:
        """How a user gets at a node: "centre", or "start", "end", "node(3)"."""
        if self.domain is None:
            return CENTRE
        return {0: "start", self.domain.elements: "end"}.get(node, f"node({node})")
