"""Shapes that rods and bodies touch: solids fixed in space, or carried by a body."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from cayley.lie import quaternion
from cayley.model import mesh_file, validate
from cayley.model import triangles as surfaces
from cayley.model.body import Body
from cayley.model.part import checked_name
from cayley.model.port import UNTURNED, Quad, unit_quaternion
from cayley.model.triangles import Flags, Ints, Surface
from cayley.model.validate import Array, Triple

ORIGIN: Triple = (0.0, 0.0, 0.0)
E3: Triple = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Obstacle(ABC):
    """A solid that rods and other solids touch; its geometry is in the frame of what carries it.

    Two are equal only if they are the same object.

    Attributes:
        on: the body that carries it: its geometry is in the body frame, from the mass center; None: fixed in space.
        friction: Coulomb coefficient [-]; None: that of the Contact.
        name: in listings; empty: the model numbers it.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range.
    """

    kind: ClassVar[str]
    on: Body | None = None
    friction: float | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        checked_name(type(self).__name__, self.name)
        if self.on is not None and not isinstance(self.on, Body):
            raise TypeError(validate.wrong(self.label, "on", self.on, "a Body, or None for a shape fixed in space"))
        if self.friction is not None:
            friction = validate.number(self.label, "friction", self.friction, "-")
            if friction < 0.0:
                raise ValueError(validate.wrong(self.label, "friction", self.friction, "a number from 0 [-], or None"))
            object.__setattr__(self, "friction", friction)
        self._check()

    @abstractmethod
    def _check(self) -> None:
        """Check what this kind of shape has of its own."""

    @property
    @abstractmethod
    def geometry(self) -> str:
        """Its geometry in a few words."""

    @property
    def label(self) -> str:
        """What messages call it."""
        kind = type(self).__name__
        return f"{kind} {self.name!r}" if self.name else kind

    @property
    def place(self) -> tuple[Array, Array]:
        """The frame of its geometry at the start: position [m], shape (3,), and rotation, wxyz, shape (4,)."""
        return (np.zeros(3), quaternion.identity()) if self.on is None else self.on.place(0)

    def __repr__(self) -> str:
        """Name and geometry, in one line."""
        carrier = "" if self.on is None else f", on {self.on.label}"
        return f"{self.label}({self.geometry}{carrier})"

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Plane(Obstacle):
    """A half-space: solid is all below the plane through a point, on the side opposite to its normal.

    Attributes:
        point: of the plane [m].
        normal: out of the solid, of any length; kept as a unit vector.

    Example:
        >>> Plane(name="floor", friction=0.3)
        Plane 'floor'(through (0, 0, 0), normal (0, 0, 1))
    """

    kind: ClassVar[str] = "plane"
    point: Triple = ORIGIN
    normal: Triple = E3

    def _check(self) -> None:
        self._set(
            point=validate.vector(self.label, "point", self.point, "m"),
            normal=validate.direction(self.label, "normal", self.normal),
        )

    @property
    def geometry(self) -> str:
        """Point and normal."""
        return f"through {_shown(self.point)}, normal {_shown(self.normal)}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sphere(Obstacle):
    """A ball.

    Attributes:
        radius: [m].
        center: [m].
    """

    kind: ClassVar[str] = "sphere"
    radius: float
    center: Triple = ORIGIN

    def _check(self) -> None:
        self._set(
            radius=validate.positive(self.label, "radius", self.radius, "m"),
            center=validate.vector(self.label, "center", self.center, "m"),
        )

    @property
    def geometry(self) -> str:
        """Radius and center."""
        return f"radius {self.radius:g} m, center {_shown(self.center)}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Capsule(Obstacle):
    """All within a radius of a straight line between two points: a cylinder with round ends.

    Attributes:
        start: of the line [m].
        end: of the line [m].
        radius: [m].
    """

    kind: ClassVar[str] = "capsule"
    start: Triple
    end: Triple
    radius: float

    def _check(self) -> None:
        start, end = (validate.vector(self.label, word, getattr(self, word), "m") for word in ("start", "end"))
        if start == end:
            raise ValueError(f"{self.label}: start and end are both {_shown(start)}; a ball is a Sphere")
        self._set(start=start, end=end, radius=validate.positive(self.label, "radius", self.radius, "m"))

    @property
    def geometry(self) -> str:
        """Radius and ends."""
        return f"radius {self.radius:g} m, from {_shown(self.start)} to {_shown(self.end)}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Cylinder(Obstacle):
    """A round cylinder with flat ends.

    Attributes:
        radius: [m].
        length: along its axis [m].
        center: [m].
        axis: of any length; kept as a unit vector.
    """

    kind: ClassVar[str] = "cylinder"
    radius: float
    length: float
    center: Triple = ORIGIN
    axis: Triple = E3

    def _check(self) -> None:
        self._set(
            radius=validate.positive(self.label, "radius", self.radius, "m"),
            length=validate.positive(self.label, "length", self.length, "m"),
            center=validate.vector(self.label, "center", self.center, "m"),
            axis=validate.direction(self.label, "axis", self.axis),
        )

    @property
    def geometry(self) -> str:
        """Radius, length, center and axis."""
        sizes = f"radius {self.radius:g} m, length {self.length:g} m"
        return f"{sizes}, center {_shown(self.center)}, axis {_shown(self.axis)}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Box(Obstacle):
    """A box.

    Attributes:
        size: its three edge lengths [m].
        center: [m].
        rotation: of its edges against the frame: a unit quaternion (wxyz) or a rotation matrix; kept as a quaternion.
    """

    kind: ClassVar[str] = "box"
    size: Triple
    center: Triple = ORIGIN
    rotation: Quad = UNTURNED

    def _check(self) -> None:
        size = validate.vector(self.label, "size", self.size, "m")
        if min(size) <= 0.0:
            raise ValueError(validate.wrong(self.label, "size", self.size, "3 positive, finite numbers [m]"))
        self._set(
            size=size,
            center=validate.vector(self.label, "center", self.center, "m"),
            rotation=unit_quaternion(self.label, "rotation", self.rotation),
        )

    @property
    def geometry(self) -> str:
        """Edge lengths and center."""
        return f"{' x '.join(f'{c:g}' for c in self.size)} m, center {_shown(self.center)}"

    @property
    def mesh(self) -> Mesh:
        """The same box as 12 triangles."""
        corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
        return Mesh(
            quaternion.rotate(self.rotation, corners * self.size) + self.center,
            _BOX_TRIANGLES,
            on=self.on,
            friction=self.friction,
            name=self.name,
        )


_BOX_TRIANGLES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5]),
        *([0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6]),
        *([0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Mesh(Obstacle):
    """A surface of triangles, counter-clockwise seen from outside; solid is the other side.

    It may be open; then it is touched on its outer side only. What follows from the triangles is found once.

    Attributes:
        vertices: positions [m], shape (n, 3), read-only.
        triangles: their corners, indices of vertices, shape (m, 3), read-only.
        surface: edges, normals and owners, which are attributes of the mesh, too.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a vertex that is not finite, or that there is not; a triangle without area; an edge of more than two
            triangles; two triangles that run the same way along their edge.
    """

    kind: ClassVar[str] = "mesh"
    vertices: Any
    triangles: Any
    surface: Surface = field(init=False)

    def _check(self) -> None:
        right = "positions (x, y, z), finite [m], shape (n, 3)"
        vertices = validate.frozen(validate.array(self.label, "vertices", self.vertices, (-1, 3), right))
        triangles = surfaces.checked_triangles(self.label, self.triangles, len(vertices))
        self._set(vertices=vertices, triangles=triangles, surface=surfaces.surface(self.label, vertices, triangles))

    @classmethod
    def read(cls, path: Any, **others: Any) -> Mesh:
        """A mesh from a file: STL, OBJ, PLY and all others that meshio reads; triangles and quadrilaterals.

        Args:
            path: the file; its ending says the format.
            **others: on, friction and name, as of Mesh.

        Raises:
            ImportError: meshio is not installed.
            FileNotFoundError: there is no such file.
            ValueError: the file has no triangles, or no format that meshio reads; else as for Mesh.
        """
        return cls(*mesh_file.read(path), **others)

    def placed(self, *, scale: float = 1.0, center: Any = ORIGIN, rotation: Any = UNTURNED) -> Mesh:
        """The same mesh of another size, elsewhere and turned.

        x = center + Λ(rotation) scale · vertex

        Args:
            scale: 1e-3 for a file in millimeters.
            center: where its origin comes to lie [m].
            rotation: a unit quaternion (wxyz) or a rotation matrix.

        Raises:
            TypeError: something has the wrong type.
            ValueError: something is out of range.
        """
        factor = validate.positive(self.label, "scale", scale, "-")
        shift = validate.vector(self.label, "center", center, "m")
        turn = unit_quaternion(self.label, "rotation", rotation)
        return replace(self, vertices=quaternion.rotate(turn, factor * self.vertices) + shift)

    @property
    def geometry(self) -> str:
        """Numbers of vertices and triangles."""
        closed, count = "closed" if self.closed else "open", len(self.triangles)
        return f"{closed}, {len(self.vertices)} vertices, {count} {'triangle' if count == 1 else 'triangles'}"

    @property
    def normals(self) -> Array:
        """Outward unit normal of each triangle [-], shape (m, 3)."""
        return self.surface.normals

    @property
    def edges(self) -> Ints:
        """Vertices of each edge, the smaller index first, shape (e, 2)."""
        return self.surface.edges

    @property
    def triangle_edges(self) -> Ints:
        """Edge from corner k to corner k + 1 of each triangle, shape (m, 3)."""
        return self.surface.triangle_edges

    @property
    def convex(self) -> Flags:
        """Of each edge, whether it is on the border, sticks out or is flat: not so in a valley, shape (e,)."""
        return self.surface.convex

    @property
    def flat(self) -> Flags:
        """Of each edge, whether its two triangles lie in one plane, shape (e,)."""
        return self.surface.flat

    @property
    def owns_edge(self) -> Flags:
        """Whether a triangle answers for its edge k: one does for each convex edge, none for a valley, shape (m, 3)."""
        return self.surface.owns_edge

    @property
    def owns_vertex(self) -> Flags:
        """Whether a triangle answers for its corner k: exactly one does for each vertex, shape (m, 3)."""
        return self.surface.owns_vertex

    @property
    def closed(self) -> bool:
        """Whether every edge has two triangles."""
        return self.surface.closed

    @property
    def volume(self) -> float:
        """Volume inside, if it is closed [m^3]; negative if it is solid all around, as a tank seen from within."""
        return surfaces.volume(self.vertices, self.triangles)


def _shown(values: Triple) -> str:
    return f"({', '.join(f'{c:g}' for c in values)})"
