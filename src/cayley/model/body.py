"""Rigid bodies and point masses: one node each, at the mass center."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cayley.model import validate
from cayley.model.part import Part, checked_name
from cayley.model.port import UNTURNED, Port, Quad, unit_quaternion
from cayley.model.validate import Array, Triple

CENTRE = "centre"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Body(Part):
    """A rigid body.

    T = ½ m ẋ·ẋ + ½ ω·Jω,   x the mass center, ω the angular velocity about the body's own axes

    Two bodies are equal only if they are the same object.

    Attributes:
        mass: m [kg].
        inertia: J about the mass center, in the body frame [kg m²], shape (3, 3), or its three principal moments.
        position: of the mass center at the start [m].
        rotation: body to space at the start: a unit quaternion (wxyz) or a rotation matrix; kept as a quaternion.
        ports: name -> (x, y, z) from the mass center in the body frame [m], or ((x, y, z), rotation) with the port's
            own frame; kept with the rotation as a quaternion.
        name: in listings and results; empty: the model numbers the body.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range, or the inertia not symmetric and positive definite.

    Example:
        >>> bob = Body(mass=2.0, inertia=[0.01, 0.01, 0.02], position=(0, 0, 1), ports={"eye": (0, 0, 0.3)}, name="bob")
        >>> print(bob.port("eye"), bob.port("eye").place[0])
        bob.eye [0.  0.  1.3]
    """

    mass: float
    inertia: Any
    position: Triple = (0.0, 0.0, 0.0)
    rotation: Quad = UNTURNED
    ports: Mapping[str, tuple[Triple, Quad]] = field(default_factory=dict)
    name: str = ""

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        checked_name("Body", self.name)
        owner = self.label
        given = self.inertia
        if np.ndim(given) == 1:
            moments = validate.array(
                owner, "inertia", given, (3,), "three principal moments or a 3 x 3 matrix [kg m^2]"
            )
            given = np.diag(moments)
        inertia = validate.positive_definite(owner, "inertia", given, 3, "about e1, e2, e3 [kg m^2]")
        object.__setattr__(self, "mass", validate.positive(owner, "mass", self.mass, "kg"))
        object.__setattr__(self, "inertia", inertia)
        object.__setattr__(self, "position", validate.vector(owner, "position", self.position, "m"))
        object.__setattr__(self, "rotation", unit_quaternion(owner, "rotation", self.rotation))
        object.__setattr__(self, "ports", checked_ports(owner, self.ports))

    def __repr__(self) -> str:
        """Name, mass and ports, in one line."""
        name = f"name={self.name!r}, " if self.name else ""
        return f"Body({name}mass={self.mass:g}, ports={list(self.ports)})"

    @property
    def noun(self) -> str:
        """The word "body"."""
        return "body"

    @property
    def node_count(self) -> int:
        """One."""
        return 1

    @property
    def centre(self) -> Port:
        """The mass center."""
        return Port(self, 0)

    def port(self, name: str) -> Port:
        """A port by its name.

        Args:
            name: one of the names in ports, or "centre", the mass center.

        Raises:
            ValueError: there is none of that name.
        """
        if name == CENTRE:
            return self.centre
        if name not in self.ports:
            raise ValueError(validate.wrong(self.label, "port", name, f"one of {', '.join([CENTRE, *self.ports])}"))
        shift, turn = self.ports[name]
        return Port(self, 0, shift=shift, turn=turn, name=name)

    def place(self, node: int) -> tuple[Array, Array]:
        """Position of the mass center [m], shape (3,), and rotation, wxyz, shape (4,), before any motion."""
        return np.array(self.position), np.array(self.rotation)

    def node_name(self, node: int) -> str:
        """The word "centre"."""
        return CENTRE


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PointMass(Part):
    """A point with mass, which does not turn.

    T = ½ m ẋ·ẋ

    Attributes:
        mass: m [kg].
        position: at the start [m].
        name: in listings and results; empty: the model numbers the mass.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range.
    """

    mass: float
    position: Triple = (0.0, 0.0, 0.0)
    name: str = ""

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        checked_name("PointMass", self.name)
        object.__setattr__(self, "mass", validate.positive(self.label, "mass", self.mass, "kg"))
        object.__setattr__(self, "position", validate.vector(self.label, "position", self.position, "m"))

    def __repr__(self) -> str:
        """Name and mass, in one line."""
        name = f"name={self.name!r}, " if self.name else ""
        return f"PointMass({name}mass={self.mass:g})"

    @property
    def noun(self) -> str:
        """The word "mass"."""
        return "mass"

    @property
    def node_count(self) -> int:
        """One."""
        return 1

    @property
    def centre(self) -> Port:
        """The point itself."""
        return Port(self, 0)

    def place(self, node: int) -> tuple[Array, Array]:
        """Position [m], shape (3,), and the rotation 1, shape (4,), before any motion."""
        return np.array(self.position), np.array(UNTURNED)

    def node_name(self, node: int) -> str:
        """The word "centre"."""
        return CENTRE


def checked_ports(owner: str, given: Any) -> dict[str, tuple[Triple, Quad]]:
    """Ports of a node by name, with shift and rotation each.

    Raises:
        TypeError: no dictionary.
        ValueError: a name or a place is none.
    """
    right = 'a dictionary such as {"eye": (0, 0, 0.3)}'
    if not isinstance(given, Mapping):
        raise TypeError(validate.wrong(owner, "ports", given, right))
    found: dict[str, tuple[Triple, Quad]] = {}
    for name, value in given.items():
        if not isinstance(name, str) or not name.isidentifier() or name == CENTRE:
            right = f'a name of letters, digits and "_", other than "{CENTRE}"'
            raise ValueError(validate.wrong(owner, "name of a port", name, right))
        pair = isinstance(value, (tuple, list)) and len(value) == 2
        shift, turn = value if pair else (value, UNTURNED)
        where = f"ports[{name!r}]"
        found[name] = (validate.vector(owner, where, shift, "m"), unit_quaternion(owner, where, turn))
    return found
