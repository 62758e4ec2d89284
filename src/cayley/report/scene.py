"""What the player shows: parts in space over frames, what colors them, and graphs over the time; plain arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cayley.report.conserved import Array

BYTES = 12_000_000
"""Of the frames of a scene before they are packed: about as many as a file of 12 MB holds, which browsers open fast."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """What can color parts, or be plotted along a rod.

    Attributes:
        label: its name on the page.
        unit: its unit; "1" for none.
        values: at the nodes of a part, shape (m, n), or of a vector, shape (m, n, 3).
        axes: how the components of a vector are called.
    """

    label: str
    unit: str
    values: Array
    axes: tuple[str, str, str] = ("e₁", "e₂", "e₃")


@dataclass(frozen=True, slots=True, kw_only=True)
class Strand:
    """A rod, or a chain with a Lagrangian of its own.

    Attributes:
        name: of the part.
        position: of its nodes [m], shape (m, n, 3).
        rotation: of its cross-sections, unit quaternions, wxyz, shape (m, n, 4).
        outlines: of its cross-section in the plane of e1 and e2 [m], the same everywhere, shape (1, k, 2), or of each
            node, shape (n, k, 2); counter-clockwise.
        s: arc length of the nodes [m], shape (n,).
        quantities: by a short name.
    """

    name: str
    position: Array
    rotation: Array
    outlines: Array
    s: Array
    quantities: Mapping[str, Quantity] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """A rigid body, drawn as a box, or a point mass or part with a Lagrangian of its own, drawn as a ball.

    Attributes:
        name: of the part.
        position: of its mass center [m], shape (m, 1, 3).
        rotation: unit quaternions, wxyz, shape (m, 1, 4).
        sides: of the box [m], shape (3,); None: a ball.
        turn: of the box against the body, unit quaternion, wxyz, shape (4,).
        ports: shifts from the mass center in the body's frame [m], by name.
        shaped: whether skins are drawn instead of the box.
        quantities: by a short name.
    """

    name: str
    position: Array
    rotation: Array
    sides: Array | None = None
    turn: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)
    ports: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    shaped: bool = False
    quantities: Mapping[str, Quantity] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Skin:
    """The surface of an obstacle.

    Attributes:
        name: of the obstacle.
        part: number of the part that carries it among those of the scene; None: fixed in space.
        vertices: in the frame of the part, or in space [m], shape (n, 3).
        triangles: indices of vertices, counter-clockwise seen from outside, shape (m, 3).
        sheer: whether one sees through it, as it is solid all around.
    """

    name: str
    part: int | None
    vertices: Array
    triangles: NDArray[np.int64]
    sheer: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Flat:
    """A plane, drawn as far as the room.

    Attributes:
        name: of the obstacle.
        part: number of the part that carries it among those of the scene; None: fixed in space.
        point: of the plane, in the frame of the part or in space [m].
        normal: out of what is solid, a unit vector.
    """

    name: str
    part: int | None
    point: tuple[float, ...]
    normal: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A place on a part, or at rest in space.

    Attributes:
        part: number of the part among those of the scene; None: the ground.
        node: of the part.
        shift: from the node, in its frame, or of a place on the ground in space [m].
    """

    part: int | None
    node: int = 0
    shift: tuple[float, ...] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A sign at a place.

    Attributes:
        kind: "support" or "joint".
        name: what it is.
        place: where it is.
    """

    kind: str
    name: str
    place: Place


@dataclass(frozen=True, slots=True, kw_only=True)
class Link:
    """A line between two places, such as a spring.

    Attributes:
        name: what it is.
        first: one end.
        second: the other.
    """

    name: str
    first: Place
    second: Place


@dataclass(frozen=True, slots=True, kw_only=True)
class Graph:
    """Lines over the time.

    Attributes:
        title: of the plot.
        unit: of its values.
        names: of the lines.
        values: shape (m, lines).
    """

    title: str
    unit: str
    names: tuple[str, ...]
    values: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """All that the player shows at once.

    Attributes:
        name: in the list of scenes, where there are several.
        time: of the frames [s], rising, shape (m,).
        parts: what moves.
        marks: signs on the parts.
        links: lines between them.
        solids: obstacles.
        graphs: lines over the time.
        up: the direction that is up in the picture, a unit vector along an axis.
        shade: from when to when loads act [s]; None: nothing is shaded.
        note: what else there is to say about the frames.
        period: whether the frames are one period of a motion, which is played at once, again and again.

    Raises:
        ValueError: arrays that do not fit together.
    """

    name: str
    time: Array
    parts: tuple[Strand | Block, ...]
    marks: tuple[Mark, ...] = ()
    links: tuple[Link, ...] = ()
    solids: tuple[Skin | Flat, ...] = ()
    graphs: tuple[Graph, ...] = ()
    up: tuple[int, int, int] = (0, 0, 1)
    shade: tuple[float, float] | None = None
    note: str = ""
    period: bool = False

    def __post_init__(self) -> None:
        """Check the shapes."""
        for part in self.parts:
            count = part.position.shape[1] if part.position.ndim == 3 else 0
            self._fits(f"position of {part.name}", part.position, (count, 3))
            self._fits(f"rotation of {part.name}", part.rotation, (count, 4))
            for quantity in part.quantities.values():
                kind = (count, 3) if quantity.values.ndim == 3 else (count,)
                self._fits(f"{quantity.label} of {part.name}", quantity.values, kind)
        for graph in self.graphs:
            self._fits(graph.title, graph.values, (len(graph.names),))

    def _fits(self, what: str, values: Array, wanted: tuple[int, ...]) -> None:
        right = (len(self.time), *wanted)
        if np.shape(values) != right:
            raise ValueError(f"Scene: {what} has shape {np.shape(values)}, but must have {right}")
