"""Rods, straight or curved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any

import numpy as np

from cayley.lie import quaternion
from cayley.model import curve as curves
from cayley.model import validate
from cayley.model.curve import Shape
from cayley.model.damping import Damping
from cayley.model.frames import standard_rotation
from cayley.model.part import Part, checked_name
from cayley.model.port import Port
from cayley.model.section import Section
from cayley.model.stations import Stations, stations
from cayley.model.validate import Array, Triple

KINEMATICS = ("shearable", "unshearable", "inextensible")
"""What strains a rod has: all six; stretch, bending and twist; bending and twist."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Rod(Part):
    """A rod, straight or with a curved or twisted shape that is free of stress, made by `along`, `through`, `polyline`.

    x(s) = origin + s d3,  0 <= s <= length;  Λ(p) eᵢ = dᵢ        (straight)

    d3 is the direction, d1 the normal made perpendicular to it, d2 = d3 × d1. Without a normal the frame is the
    reference frame turned by the smallest rotation that brings e3 onto the direction: about e3 × d3, or by π about e1
    if the direction is -e3. Two rods are equal only if they are the same object.

    Attributes:
        section: its cross-section; one for each element, in a list; or a function of the arc length s [m] that returns
            one, all of one kind. Kept as Stations where it is not the same everywhere.
        length: unstressed length [m].
        elements: number n of elements, which have n + 1 nodes.
        spacing: lengths of the elements, in any unit, for their sum is brought to the length; None: all the same.
        shape: the axis and the frames without stress, of a rod that is not straight; then origin and direction are
            those of its first node, and there is no normal.
        residual_bending: give the shear of an element what a beam bends between its ends more than a straight line,
            1/GA* = 1/GA + ds²/(12 EI): a straight rod is then exact at nodes that forces bend, and coarse slender rods
            take longer explicit steps; shear strains have that bending with them.
        stretched: how many times as long as without stress the rod is at the start, all of it about the first node.
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

    section: Section | Stations | Sequence[Section] | Callable[[float], Section]
    _: KW_ONLY
    length: float
    elements: int
    origin: Triple = (0.0, 0.0, 0.0)
    direction: Triple = (0.0, 0.0, 1.0)
    normal: Triple | None = None
    kinematics: str = "shearable"
    spacing: tuple[float, ...] | None = None
    shape: Shape | None = None
    stretched: float = 1.0
    residual_bending: bool = False
    damping: Damping | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        checked_name("Rod", self.name)
        owner = self.label
        if self.kinematics not in KINEMATICS:
            right = " or ".join(f'"{word}"' for word in KINEMATICS)
            raise ValueError(validate.wrong(owner, "kinematics", self.kinematics, right))
        if self.damping is not None and not isinstance(self.damping, Damping):
            right = "made by cayley.damping, such as damping.retardation(1e-3), or None"
            raise TypeError(validate.wrong(owner, "damping", self.damping, right))
        normal = None if self.normal is None else validate.direction(owner, "normal", self.normal)
        direction = validate.direction(owner, "direction", self.direction)
        standard_rotation(owner, direction, normal, self.normal)
        object.__setattr__(self, "length", validate.positive(owner, "length", self.length, "m"))
        object.__setattr__(self, "elements", validate.count(owner, "elements", self.elements))
        object.__setattr__(self, "origin", validate.vector(owner, "origin", self.origin, "m"))
        object.__setattr__(self, "direction", direction)
        object.__setattr__(self, "normal", normal)
        object.__setattr__(self, "stretched", validate.positive(owner, "stretched", self.stretched, "-"))
        if not isinstance(self.residual_bending, bool):
            raise TypeError(validate.wrong(owner, "residual_bending", self.residual_bending, "True or False"))
        if self.residual_bending and self.kinematics != "shearable":
            right = f'False, for a rod that is "{self.kinematics}" has no shear to take it'
            raise ValueError(validate.wrong(owner, "residual_bending", True, right))
        if self.spacing is not None:
            right = f"{self.elements} positive numbers, one an element"
            shares = validate.array(owner, "spacing", self.spacing, (self.elements,), right)
            if shares.min() <= 0.0:
                raise ValueError(validate.wrong(owner, "spacing", self.spacing, right))
            object.__setattr__(self, "spacing", tuple(shares.tolist()))
        if self.shape is not None:
            self._place(owner, self.shape)
        object.__setattr__(self, "section", stations(owner, self.section, self.nodes))

    def _place(self, owner: str, shape: Shape) -> None:
        """Check a shape and take over where it begins."""
        if not isinstance(shape, Shape):
            raise TypeError(validate.wrong(owner, "shape", shape, "a Shape, such as Rod.along makes"))
        if len(shape.position) != self.elements:
            raise ValueError(f"{owner}: shape has {len(shape.position)} elements, but the rod {self.elements}")
        if self.normal is not None:
            raise ValueError(validate.wrong(owner, "normal", self.normal, "left out, for the shape has frames"))
        x, y, z = shape.position[0, 0].tolist()
        d = quaternion.rotate(shape.rotation[0, 0], (0.0, 0.0, 1.0)).tolist()
        object.__setattr__(self, "origin", (x, y, z))
        object.__setattr__(self, "direction", validate.direction(owner, "direction", d))

    def __repr__(self) -> str:
        """Name, length and elements, in one line."""
        name = f"name={self.name!r}, " if self.name else ""
        return f"Rod({name}length={self.length:g}, elements={self.elements}, section={self.stations.name!r})"

    @classmethod
    def along(
        cls,
        section: Any,
        curve: Callable[[float], Any],
        *,
        elements: int,
        span: tuple[float, float] = (0.0, 1.0),
        tangent: Callable[[float], Any] | None = None,
        normal: Any = None,
        twist: float | Callable[[float], float] = 0.0,
        frames: Callable[[float], Any] | None = None,
        **others: Any,
    ) -> Rod:
        """A rod whose axis, free of stress, is a curve; frames turn about it as little as possible, plus the twist.

        Args:
            section: as of Rod.
            curve: position r(u) [m] from the first u of the span to the last; u need not be the arc length.
            elements: their number.
            span: u of the first and of the last node.
            tangent: r'(u); None: found from the curve.
            normal: of e1 at the first node; None: as of a straight rod in the direction there.
            twist: of the last section against a frame without twist [rad], growing evenly along the rod, or a function
                of the arc length s.
            frames: function of s that gives the frame, unit quaternion wxyz or matrix (3, 3), instead of both.
            **others: kinematics, spacing, stretched and name, as of Rod.

        Raises:
            TypeError: something has the wrong type.
            ValueError: something is out of range, or the curve stands still somewhere.
        """
        count = validate.count("Rod", "elements", elements)
        shares = np.ones(count) if others.get("spacing") is None else np.asarray(others["spacing"], dtype=float)
        shape, length = curves.along(curve, span, shares, tangent=tangent, normal=normal, twist=twist, frames=frames)
        return cls(section, length=length, elements=count, shape=shape, **others)

    @classmethod
    def through(cls, section: Any, points: Any, *, elements: int, **others: Any) -> Rod:
        """A rod along the cubic spline through points, with natural ends, in the lengths of the chords.

        Args:
            section: as of Rod.
            points: positions [m], shape (k, 3), k >= 2.
            elements: their number; they have the same length, so the points need not be nodes.
            **others: normal, twist, frames, kinematics, spacing, stretched and name, as of `along`.

        Raises:
            TypeError: something has the wrong type.
            ValueError: something is out of range, or a point twice in a row.
        """
        from scipy.interpolate import CubicSpline

        right = "2 or more points (x, y, z) [m], shape (k, 3), none twice in a row"
        places = validate.array("Rod", "points", points, (-1, 3), right)
        chords = np.linalg.norm(np.diff(places, axis=0), axis=1)
        if len(places) < 2 or chords.min() <= 0.0:
            raise ValueError(validate.wrong("Rod", "points", points, right))
        u = np.concatenate([[0.0], np.cumsum(chords)])
        spline = CubicSpline(u, places, bc_type="natural")
        return cls.along(section, spline, elements=elements, span=(0.0, float(u[-1])), **others)

    @classmethod
    def polyline(
        cls,
        section: Any,
        points: Any,
        *,
        elements: int,
        normal: Any = None,
        twist: float | Callable[[float], float] = 0.0,
        **others: Any,
    ) -> Rod:
        """A rod along straight lines between points, which are nodes; at a corner the section halves its angle.

        Args:
            section: as of Rod.
            points: positions [m], shape (k, 3), k >= 2.
            elements: their number, at least one between two points, where they have the same length.
            normal: as of `along`.
            twist: as of `along`.
            **others: kinematics, stretched and name, as of Rod.

        Raises:
            TypeError: something has the wrong type.
            ValueError: something is out of range, a point twice in a row, or a line that goes straight back.
        """
        count = validate.count("Rod", "elements", elements)
        shape, sizes = curves.polyline(points, count, normal=normal, twist=twist)
        return cls(
            section, length=float(sizes.sum()), elements=count, spacing=tuple(sizes.tolist()), shape=shape, **others
        )

    @property
    def noun(self) -> str:
        """The word "rod"."""
        return "rod"

    @property
    def node_count(self) -> int:
        """Number n + 1 of nodes."""
        return self.elements + 1

    def place(self, node: int) -> tuple[Array, Array]:
        """Position [m], shape (3,), and rotation, wxyz, shape (4,), of a node before any motion."""
        return self.positions[node], self.rotations[node]

    def node_name(self, node: int) -> str:
        """How a user gets at a node: "start", "end" or "node(3)"."""
        return {0: "start", self.elements: "end"}.get(node, f"node({node})")

    @property
    def mass(self) -> float:
        """The mass of the whole rod [kg]."""
        section = self.stations
        if isinstance(section, Section):
            return section.mass_per_length * self.length
        at, weights = np.polynomial.legendre.leggauss(3)  # exact for the degree 4 of what stations interpolate
        density = section.at("mass_per_length", 0.5 + 0.5 * at) @ (0.5 * weights)
        return float(density @ self.element_lengths)

    @property
    def stations(self) -> Section | Stations:
        """The section, as Stations where it is not the same everywhere."""
        assert isinstance(self.section, (Section, Stations))  # what __post_init__ makes of all that may be given
        return self.section

    @property
    def sections(self) -> tuple[Section, ...]:
        """The section of each element, where it changes that of the station nearest to its middle."""
        section = self.stations
        if isinstance(section, Section):
            return (section,) * self.elements
        return tuple(own[len(own) // 2] for own in section.sections)

    @property
    def nodes(self) -> Array:
        """Arc length s of each node [m], shape (n + 1,)."""
        if self.spacing is None:
            return np.linspace(0.0, self.length, self.elements + 1)
        grown = np.concatenate([[0.0], np.cumsum(self.spacing)])
        return self.length * (grown / grown[-1])

    @property
    def element_lengths(self) -> Array:
        """Unstressed length of each element [m], shape (n,)."""
        return np.full(self.elements, self.element_length) if self.spacing is None else np.diff(self.nodes)

    @property
    def element_length(self) -> float:
        """Unstressed length of an element [m], their mean where they differ."""
        return self.length / self.elements

    @property
    def positions(self) -> Array:
        """Position of each node at the start, before any motion [m], shape (n + 1, 3)."""
        return self.stretch(self.reference(np.array([0.0, 1.0]))[0])

    @property
    def rotations(self) -> Array:
        """Rotation p of each node before any motion, unit quaternions [-], wxyz, shape (n + 1, 4)."""
        return self.reference(np.array([0.0, 1.0]))[1]

    @property
    def rotation(self) -> Array:
        """Rotation p of the first node before any motion, of a straight rod that of all, wxyz [-], shape (4,)."""
        if self.shape is not None:
            return np.array(self.shape.rotation[0, 0])
        return standard_rotation(self.label, self.direction, self.normal)

    def frame(self, s: float = 0.0) -> Array:
        """Λ = (d1, d2, d3), the section's axes as columns, before any motion, at arc length s [-], shape (3, 3).

        Args:
            s: arc length of the reference from the first node [m].

        Raises:
            TypeError: s is not a number.
            ValueError: s is outside the rod.
        """
        place = validate.number(self.label, "s", s, "m")
        if not 0.0 <= place <= self.length:
            raise ValueError(validate.wrong(self.label, "s", s, f"from 0 to {self.length:g} m"))
        nodes = self.nodes
        e = min(int(np.searchsorted(nodes, place, side="right")) - 1, self.elements - 1)
        turned = self.rotation
        if self.shape is not None:
            turned = self.shape.at(np.array([(place - nodes[e]) / (nodes[e + 1] - nodes[e])]))[1][e, 0]
        return np.asarray(quaternion.to_matrix(turned), dtype=float)

    def reference(self, places: Array) -> tuple[Array, Array]:
        """Where the rod is without stress: its nodes, and more of them in every element.

        Args:
            places: of the nodes in an element, from 0 to 1, both included, shape (m + 1,).

        Returns: positions [m] and rotations (unit quaternions), shapes (n m + 1, 3) and (n m + 1, 4).
        """
        if self.shape is not None:
            found = self.shape.at(places)
            parts = [np.concatenate([v[:, :-1].reshape(-1, v.shape[-1]), v[-1, -1:]]) for v in found]
            return parts[0], parts[1]
        nodes = self.nodes
        inner = nodes[:-1, None] + np.diff(nodes)[:, None] * places[None, :-1]
        s = np.append(inner.reshape(-1), nodes[-1])
        return np.array(self.origin) + np.outer(s, self.direction), np.tile(self.rotation, (len(s), 1))

    def stretch(self, positions: Array) -> Array:
        """Positions at the start from those without stress."""
        if self.stretched == 1.0:
            return positions
        stretched: Array = self.stretched * positions + (1.0 - self.stretched) * np.array(self.origin)
        return stretched

    @property
    def start(self) -> Port:
        """The first node, at the origin."""
        return Port(self, 0)

    @property
    def end(self) -> Port:
        """The last node."""
        return Port(self, self.elements)

    def node(self, k: int) -> Port:
        """A node by its number.

        Args:
            k: from 0 to n, or from -1 back to -(n + 1).

        Raises:
            TypeError: k is not a whole number.
            ValueError: there is no such node.
        """
        return Port(self, k)

    def at(self, s: float) -> Port:
        """The node at an arc length; nothing is moved to the next node silently.

        Args:
            s: arc length of the reference from the first node [m].

        Raises:
            TypeError: s is not a number.
            ValueError: s is outside the rod or between two nodes.
        """
        nodes = self.nodes
        place = validate.number(self.label, "s", s, "m")
        k = int(np.abs(nodes - place).argmin())
        if abs(place - nodes[k]) > 1e-6 * self.element_lengths.min():
            below = min(max(int(np.searchsorted(nodes, place, side="right")) - 1, 0), self.elements - 1)
            near = " or ".join(f"{nodes[j]:g} m (node {j})" for j in (below, below + 1))
            raise ValueError(validate.wrong(self.label, "s", s, f"at a node, such as {near}"))
        return Port(self, k)
