"""Straight rods and the ports on them to which supports and loads attach."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass

import numpy as np

from cayley.model import validate
from cayley.model.damping import Damping
from cayley.model.section import Section
from cayley.model.validate import Array, Triple

KINEMATICS = ("shearable", "unshearable", "inextensible")
"""What strains a rod has: all six; stretch, bending and twist; bending and twist."""
_ROUND_OFF = 8.0 * float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Rod:
    """A straight, unstressed rod of one section, cut into elements of equal length.

    x(s) = origin + s d3,  0 <= s <= length;  Λ(p) eᵢ = dᵢ

    d3 is the direction, d1 the normal made perpendicular to it, d2 = d3 × d1. Without a normal the frame is the
    reference frame turned by the smallest rotation that brings e3 onto the direction: about e3 × d3, or by π about e1
    if the direction is -e3. Two rods are equal only if they are the same object.

    Attributes:
        section: its cross-section.
        length: unstressed length [m].
        elements: number n of elements, which have n + 1 nodes.
        origin: position of the first node [m].
        direction: of the axis, from the first node to the last; given with any length, kept as a unit vector.
        normal: of the section's e1 axis, of any length and any direction but the rod's own; None: as above.
        kinematics: "shearable" (Simo-Reissner), "unshearable" (Kirchhoff: sections stay perpendicular to the axis) or
            "inextensible" (Kirchhoff, and the axis keeps its length).
        damping: made by `damping.retardation`, `damping.ratio`, ...; None: no damping at all.
        name: in listings and results; empty: the model numbers the rod.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range, or the normal parallel to the direction.
    """

    section: Section
    _: KW_ONLY
    length: float
    elements: int
    origin: Triple = (0.0, 0.0, 0.0)
    direction: Triple = (0.0, 0.0, 1.0)
    normal: Triple | None = None
    kinematics: str = "shearable"
    damping: Damping | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        right = 'a text without "/"'  # it becomes the name of a group in the store
        if not isinstance(self.name, str):
            raise TypeError(validate.wrong("Rod", "name", self.name, right))
        if "/" in self.name:
            raise ValueError(validate.wrong("Rod", "name", self.name, right))
        owner = self.label
        if not isinstance(self.section, Section):
            raise TypeError(validate.wrong(owner, "section", self.section, "a Section"))
        if self.kinematics not in KINEMATICS:
            right = " or ".join(f'"{word}"' for word in KINEMATICS)
            raise ValueError(validate.wrong(owner, "kinematics", self.kinematics, right))
        if self.damping is not None and not isinstance(self.damping, Damping):
            right = "made by cayley.damping, such as damping.retardation(1e-3), or None"
            raise TypeError(validate.wrong(owner, "damping", self.damping, right))
        normal = None if self.normal is None else validate.direction(owner, "normal", self.normal)
        direction = validate.direction(owner, "direction", self.direction)
        if normal is not None and math.sqrt(sum(c * c for c in np.cross(direction, normal).tolist())) < 1e-8:
            right = f"at an angle to direction = {self.direction!r}, but is parallel to it"
            raise ValueError(validate.wrong(owner, "normal", self.normal, right))
        object.__setattr__(self, "length", validate.positive(owner, "length", self.length, "m"))
        object.__setattr__(self, "elements", validate.count(owner, "elements", self.elements))
        object.__setattr__(self, "origin", validate.vector(owner, "origin", self.origin, "m"))
        object.__setattr__(self, "direction", direction)
        object.__setattr__(self, "normal", normal)

    def __repr__(self) -> str:
        """Name, length and elements, in one line."""
        name = f"name={self.name!r}, " if self.name else ""
        return f"Rod({name}length={self.length:g}, elements={self.elements}, section={self.section.name!r})"

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"Rod {self.name!r}" if self.name else "Rod"

    @property
    def mass(self) -> float:
        """The mass of the whole rod [kg]."""
        return self.section.mass_per_length * self.length

    @property
    def nodes(self) -> Array:
        """Arc length s of each node [m], shape (n + 1,)."""
        return np.linspace(0.0, self.length, self.elements + 1)

    @property
    def element_length(self) -> float:
        """Unstressed length of an element [m]."""
        return self.length / self.elements

    @property
    def positions(self) -> Array:
        """Position of each node before any motion [m], shape (n + 1, 3)."""
        positions: Array = np.array(self.origin) + np.outer(self.nodes, self.direction)
        return positions

    @property
    def rotation(self) -> Array:
        """Rotation p of all nodes before any motion, unit quaternion [-], wxyz, shape (4,)."""
        w, x, y, _ = _smallest_rotation(self.direction)
        if self.normal is None:
            return np.array([w, x, y, 0.0])
        # then turn about e3 until e1 points along the part of the normal perpendicular to the axis
        n1, n2, _ = (np.array(self.normal) @ _matrix((w, x, y, 0.0))).tolist()
        half = 0.5 * math.atan2(n2, n1)
        c, s = math.cos(half), math.sin(half)
        return np.array([w * c, x * c + y * s, y * c - x * s, w * s])

    @property
    def frame(self) -> Array:
        """Λ = (d1, d2, d3), the section's axes as columns, before any motion [-], shape (3, 3)."""
        w, x, y, z = self.rotation.tolist()
        return _matrix((w, x, y, z))

    @property
    def start(self) -> Port:
        """The first node, at the origin."""
        return Port(self, 0)

    @property
    def end(self) -> Port:
        """The last node."""
        return Port(self, self.elements)

    def node(self, k: int) -> Port:
        """Node k, from 0 to n, or from -1 back to -(n + 1).

        Raises:
            TypeError: k is not a whole number.
            ValueError: there is no such node.
        """
        return Port(self, k)

    def at(self, s: float) -> Port:
        """The node at arc length s [m]; nothing is moved to the next node silently.

        Raises:
            TypeError: s is not a number.
            ValueError: s is outside the rod or between two nodes.
        """
        place = validate.number(self.label, "s", s, "m") / self.element_length
        k = round(place)
        if not 0 <= k <= self.elements or abs(place - k) > 1e-6:
            below = min(max(math.floor(place), 0), self.elements - 1)
            near = " or ".join(f"{j * self.element_length:g} m (node {j})" for j in (below, below + 1))
            raise ValueError(validate.wrong(self.label, "s", s, f"at a node, such as {near}"))
        return Port(self, k)


@dataclass(frozen=True, slots=True)
class Port:
    """A node of a part, to which supports and loads attach.

    Attributes:
        part: the rod.
        node: index of the node, from 0; a negative one counts from the end.

    Raises:
        TypeError: the part is not a rod, or the node not a whole number.
        ValueError: there is no such node.
    """

    part: Rod
    node: int

    def __post_init__(self) -> None:
        """Check the node and count it from the start."""
        if not isinstance(self.part, Rod):
            raise TypeError(validate.wrong("Port", "part", self.part, "a Rod"))
        count = self.part.elements + 1
        right = f"from 0 to {count - 1}, or from -1 back to {-count}"
        k = validate.integer(self.part.label, "node", self.node, "a whole number " + right)
        if not -count <= k < count:
            raise ValueError(validate.wrong(self.part.label, "node", k, right))
        object.__setattr__(self, "node", k % count)

    def __str__(self) -> str:
        """As a user writes it: `mast.start`, `mast.node(3)`, `mast.end`."""
        return self.called(self.part.name or "rod")

    def called(self, name: str) -> str:
        """As a user writes it if the part has that name."""
        ends = {0: "start", self.part.elements: "end"}
        return f"{name}.{ends.get(self.node, f'node({self.node})')}"


def _smallest_rotation(d: Triple) -> tuple[float, float, float, float]:
    """The quaternion of the smallest rotation from e3 to the unit vector d; about e1 if d = -e3.

    p = (cos θ/2, sin θ/2 (-d₂, d₁, 0)/sin θ),  θ = atan2(‖(d₁, d₂)‖, d₃)
    """
    sine = math.hypot(d[0], d[1])
    if sine < _ROUND_OFF:  # so that (sin π, 0, cos π) is -e3
        return (1.0, 0.0, 0.0, 0.0) if d[2] > 0.0 else (0.0, 1.0, 0.0, 0.0)
    half = 0.5 * math.atan2(sine, d[2])
    factor = math.sin(half) / sine
    return (math.cos(half), -d[1] * factor, d[0] * factor, 0.0)


def _matrix(p: tuple[float, float, float, float]) -> Array:
    """Λ(p), the rotation matrix of a unit quaternion, shape (3, 3)."""
    w, x, y, z = p
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )
