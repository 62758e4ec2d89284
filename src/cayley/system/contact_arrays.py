"""What touches, as arrays: segments with a radius between points of nodes, and solids; see native/contact.h."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cayley.discrete.layout import Layout
from cayley.lie import quaternion
from cayley.model import Model, Rod
from cayley.model.contact import Contact, contact_radius
from cayley.model.loads import Gravity
from cayley.model.shapes import Box, Capsule, Cylinder, Mesh, Obstacle, Plane, Sphere
from cayley.system.redundancy import ground_values

PLANE, CYLINDER, BOX, TRIANGLE = range(4)
SIZE = 18
"""Numbers that say the size of a solid."""
RIM = 16
"""Corners that stand for the rim of a cylinder where it touches other solids."""
FIXED = -1
"""What is fixed in space does not touch what is."""
NEAR_JOINT = 1.5
"""Sums of radii from a joint within which what it joins does not touch."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Touching:
    """What touches in a system; nodes are those of the system, the ground stands behind them.

    Args:
        contact: how.
        weight: of all that moves [N].
        unit: smallest radius there is, or a small part of the smallest shape [m].
        names: of the owners: rods, then shapes.
        arrays: fields of struct contacts that do not change.
        movers: how many segments can move, for the load on each.
        deepest: depth at which a run of an explicit rule ends, in radii of the thinner partner [-].
    """

    contact: Contact
    weight: float
    unit: float
    names: tuple[str, ...]
    arrays: dict[str, np.ndarray] = field(repr=False)
    movers: int
    deepest: float = math.inf

    @property
    def segments(self) -> int:
        """Number of segments."""
        return len(self.arrays["radius"])

    def owner_of(self, item: int) -> str:
        """Name of the rod or shape of a segment, or of a solid behind the segments."""
        count = self.segments
        owner = self.arrays["owner"][item] if item < count else self.arrays["possessor"][item - count]
        return self.names[int(owner)]

    def described(self, first: int, second: int) -> str:
        """Two partners in words."""
        return f"{self._place(first)} and {self._place(second)}"

    def _place(self, item: int) -> str:
        element = item < self.segments and self.arrays["reach"][item] >= 0 and self.arrays["along"][item] >= 0
        return f"element {int(self.arrays['along'][item])} of {self.owner_of(item)}" if element else self.owner_of(item)


@dataclass(slots=True)
class _Draft:
    """Points, segments and solids on the way to arrays."""

    ground: int
    node: list[np.ndarray] = field(default_factory=list)
    offset: list[np.ndarray] = field(default_factory=list)
    segments: dict[str, list[np.ndarray]] = field(default_factory=dict)
    solids: dict[str, list[Any]] = field(default_factory=dict)
    points: int = 0

    def add_points(self, nodes: np.ndarray, offsets: np.ndarray) -> int:
        """Add points; returns the number of the first."""
        first, self.points = self.points, self.points + len(nodes)
        self.node.append(np.asarray(nodes, dtype=np.int64))
        self.offset.append(np.asarray(offsets, dtype=float).reshape(len(nodes), 3))
        return first

    def add_segments(self, ends: np.ndarray, owner: int, *, tail: np.ndarray, **more: Any) -> None:
        """Add segments between points."""
        count = len(ends)
        given = {"radius": 0.0, "length": 0.0, "along": -1, "reach": 0, "round": 1} | more
        beyond = given.pop("beyond", np.full((count, 2), -1))
        columns = {"ends": ends, "beyond": beyond, "owner": np.full(count, owner), "tail": tail}
        columns |= {name: np.broadcast_to(value, (count,)) for name, value in given.items()}
        for name, values in columns.items():
            self.segments.setdefault(name, []).append(np.asarray(values))

    def add_solid(
        self, kind: int, node: int, owner: int, frame: np.ndarray, size: Sequence[float] | np.ndarray, bound: float
    ) -> None:
        """Add a solid."""
        filled = np.zeros(SIZE)
        filled[: len(size)] = size
        own = {"kind": kind, "carrier": node, "possessor": owner, "frame": frame, "size": filled, "bound": bound}
        for name, value in own.items():
            self.solids.setdefault(name, []).append(value)


def touching(model: Model, spans: Sequence[slice], reference: np.ndarray, layout: Layout) -> Touching | None:
    """What touches in a model, or None without contact.

    Args:
        model: the model.
        spans: nodes of its parts.
        reference: values of all nodes at rest, shape (nodes, rows).
        layout: of the values of a node.
    """
    if model.contact is None:
        return None
    draft, contact = _Draft(ground=len(reference)), model.contact
    by_part = {id(part): nodes for part, nodes in zip(model.parts, spans, strict=True)}
    place, turn = layout.rows_of("x"), layout.rows_of("p")
    places = reference[:, place]
    for owner, rod in enumerate(model.rods):
        _add_rod(draft, owner, by_part[id(rod)], places, contact_radius(model, rod), itself=contact.touches_itself(rod))
    edged = any(shape.on is not None and isinstance(shape, Box | Cylinder | Mesh) for shape in model.obstacles)
    for owner, shape in enumerate(model.obstacles, len(model.rods)):
        node = draft.ground if shape.on is None else by_part[id(shape.on)].start
        _add_shape(draft, owner, node, shape, edged=edged)
    arrays = _arrays(draft) | _owners(model)
    known = np.vstack([reference, ground_values(layout)])[arrays["node"]]
    at = known[:, place] + quaternion.rotate(known[:, turn], arrays["offset"])
    arrays["tied"] = _tied(model, arrays, by_part, at[arrays["ends"]])
    movers = int(np.count_nonzero(arrays["node"][arrays["ends"][:, 0]] < draft.ground))
    gravity = sum((np.asarray(g.acceleration) for g in model.loads if isinstance(g, Gravity)), start=np.zeros(3))
    return Touching(
        contact=contact,
        weight=float(np.linalg.norm(gravity)) * model.mass,
        unit=_unit(arrays, model.obstacles),
        names=(*(model.name_of(rod) for rod in model.rods), *model.obstacle_names),
        arrays=arrays,
        movers=max(movers, 1),
    )


def _add_rod(draft: _Draft, owner: int, nodes: slice, places: np.ndarray, radius: float, *, itself: bool) -> None:
    """A segment between neighboring nodes; those nearer than half a turn of the rod's radius do not touch."""
    numbers = np.arange(nodes.start, nodes.stop)
    first = draft.add_points(numbers, np.zeros((len(numbers), 3)))
    count = len(numbers) - 1
    ends = first + np.column_stack([np.arange(count), np.arange(1, count + 1)])
    lengths = np.linalg.norm(np.diff(places[nodes], axis=0), axis=1)
    reach = 1 + int(np.ceil(0.8 * np.pi * radius / lengths.min())) if itself else 0
    tail = np.ones(count, dtype=np.int64)
    tail[-1] = 3
    beyond = ends + np.array([-1, 1])
    beyond[0, 0] = beyond[-1, 1] = -1
    draft.add_segments(
        ends, owner, radius=radius, length=lengths, along=np.arange(count), reach=reach, tail=tail, beyond=beyond
    )


def _add_shape(draft: _Draft, owner: int, node: int, shape: Obstacle, *, edged: bool) -> None:
    """Spheres and capsules are segments; others are solids, with their edges where solids may touch each other."""
    if isinstance(shape, Sphere | Capsule):
        ends = [shape.center] if isinstance(shape, Sphere) else [shape.start, shape.end]
        first = draft.add_points(np.full(len(ends), node), np.array(ends))
        pair = np.array([[first, first + len(ends) - 1]])
        draft.add_segments(pair, owner, radius=shape.radius, tail=np.array([2 * len(ends) - 1]))
        return
    edges: tuple[np.ndarray, np.ndarray] | None = None
    if isinstance(shape, Plane):
        draft.add_solid(PLANE, node, owner, _frame(shape.point, _turn_to(shape.normal)), (), np.inf)
    elif isinstance(shape, Cylinder):
        turn, half = _turn_to(shape.axis), 0.5 * shape.length
        reach = float(np.linalg.norm(shape.center)) + float(np.hypot(shape.radius, half))
        draft.add_solid(CYLINDER, node, owner, _frame(shape.center, turn), (shape.radius, half), reach)
        edges = _rims(shape, turn)
    elif isinstance(shape, Box):
        halves = 0.5 * np.array(shape.size)
        reach = float(np.linalg.norm(shape.center) + np.linalg.norm(halves))
        draft.add_solid(BOX, node, owner, _frame(shape.center, np.array(shape.rotation)), halves, reach)
        edges = shape.mesh.vertices, shape.mesh.edges[shape.mesh.convex & ~shape.mesh.flat]
    elif isinstance(shape, Mesh):
        reach = float(np.linalg.norm(shape.vertices, axis=1).max())
        own = zip(shape.triangles, shape.normals, shape.owns_edge, shape.owns_vertex, strict=True)
        for corners, normal, edge, corner in own:
            size = np.concatenate([shape.vertices[corners].reshape(-1), normal, edge, corner])
            draft.add_solid(TRIANGLE, node, owner, _frame((0.0, 0.0, 0.0), np.array([1.0, 0, 0, 0])), size, reach)
        edges = shape.vertices, shape.edges[shape.convex & ~shape.flat]
    if edges is not None and edged:
        _add_edges(draft, owner, node, *edges)


def _add_edges(draft: _Draft, owner: int, node: int, corners: np.ndarray, edges: np.ndarray) -> None:
    """Edges of a solid, which touch other solids; each corner touches with one of them."""
    first = draft.add_points(np.full(len(corners), node), corners)
    known, tail = set[int](), []
    for pair in edges:
        fresh = [int(corner) not in known for corner in pair]
        tail.append(fresh[0] + 2 * fresh[1])
        known.update(int(corner) for corner in pair)
    draft.add_segments(first + edges, owner, tail=np.array(tail, dtype=np.int64), round=0)


def _rims(shape: Cylinder, turn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners and edges of both rims."""
    angle = 2.0 * np.pi * np.arange(RIM) / RIM
    circle = shape.radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(RIM)])
    shift = np.array([0.0, 0.0, 0.5 * shape.length])
    corners = quaternion.rotate(turn, np.concatenate([circle - shift, circle + shift])) + np.array(shape.center)
    around = np.column_stack([np.arange(RIM), np.roll(np.arange(RIM), -1)])
    return corners, np.concatenate([around, around + RIM])


def _frame(place: Sequence[float], turn: np.ndarray) -> np.ndarray:
    return np.concatenate([np.asarray(place, dtype=float), turn])


def _turn_to(axis: Sequence[float]) -> np.ndarray:
    """A rotation that takes e3 to a unit vector."""
    x, y, z = axis
    if z < -1.0 + 1e-12:
        return np.array([0.0, 1.0, 0.0, 0.0])
    found = np.array([1.0 + z, -y, x, 0.0])
    return found / np.linalg.norm(found)


def _arrays(draft: _Draft) -> dict[str, np.ndarray]:
    """The arrays of points, segments and solids."""
    whole = ("ends", "beyond", "owner", "along", "reach", "round", "tail", "kind", "carrier", "possessor")
    found: dict[str, np.ndarray] = {
        "node": np.concatenate([*draft.node, np.zeros(0, dtype=np.int64)]),
        "offset": np.concatenate([*draft.offset, np.zeros((0, 3))]),
    }
    for name in ("ends", "beyond", "radius", "length", "owner", "along", "reach", "round", "tail"):
        empty = np.zeros((0, 2) if name in ("ends", "beyond") else 0)
        found[name] = np.concatenate([*draft.segments.get(name, []), empty])
    for name, shape in (
        ("kind", ()),
        ("carrier", ()),
        ("possessor", ()),
        ("frame", (7,)),
        ("size", (SIZE,)),
        ("bound", ()),
    ):
        found[name] = np.array(draft.solids.get(name, []), dtype=float).reshape(-1, *shape)
    return {
        name: np.ascontiguousarray(values, dtype=np.int64 if name in whole or name == "node" else float)
        for name, values in found.items()
    }


def _owners(model: Model) -> dict[str, np.ndarray]:
    """Friction of owners, and which of them do not touch."""
    assert model.contact is not None
    contact, rods = model.contact, model.rods
    owners: list[Any] = [*rods, *model.obstacles]
    rough = [contact.friction] * len(rods)
    rough += [contact.friction if shape.friction is None else shape.friction for shape in model.obstacles]
    numbers = {id(body): len(owners) + k for k, body in enumerate(model.bodies)}
    together = [*range(len(rods)), *(FIXED if s.on is None else numbers[id(s.on)] for s in model.obstacles)]
    joined = [tuple(port.part for port in joint.ports) for joint in model.joints]
    pairs = [
        *contact.without,
        *(pair for pair in joined if len(pair) == 2 and not any(isinstance(p, Rod) for p in pair)),
    ]
    apart = set()
    for one, two in pairs:
        for a, b in itertools.product(_covered(one, owners), _covered(two, owners)):
            if a != b:
                apart.add(min(a, b) * len(owners) + max(a, b))
    return {
        "rough": np.array(rough, dtype=float),
        "together": np.array(together, dtype=np.int64),
        "apart": np.array(sorted(apart), dtype=np.int64),
    }


def _covered(partner: Any, owners: Sequence[Any]) -> list[int]:
    """Owners that a part or shape stands for."""
    return [k for k, own in enumerate(owners) if own is partner or getattr(own, "on", None) is partner]


def _tied(model: Model, arrays: dict[str, np.ndarray], by_part: dict[int, slice], at: np.ndarray) -> np.ndarray:
    """Pairs of segments, or of segments and solids, that a joint holds together, so near that they must overlap."""
    count, found = len(arrays["radius"]), set[int]()
    both = count + len(arrays["kind"])
    for joint in model.joints:
        if len(joint.ports) != 2:
            continue
        here = joint.ports[0].place[0]
        near = []
        for port in joint.ports:
            nodes = by_part[id(port.part)]
            own = np.isin(arrays["node"][arrays["ends"][:, 0]], np.arange(nodes.start, nodes.stop))
            near.append([(int(k), float(_distance(here, *at[k]))) for k in np.flatnonzero(own)])
        for (a, far), (b, other) in itertools.product(*near):
            if max(far, other) <= NEAR_JOINT * (arrays["radius"][a] + arrays["radius"][b]):
                found.add(min(a, b) * both + max(a, b))
        for beside, port in zip(near, reversed(joint.ports), strict=True):
            carried = np.flatnonzero(np.isin(arrays["carrier"], [by_part[id(port.part)].start]))
            for (a, far), solid in itertools.product(beside, carried):
                if far <= NEAR_JOINT * arrays["radius"][a]:
                    found.add(a * both + count + int(solid))
    return np.array(sorted(found), dtype=np.int64)


def _distance(place: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    way = end - start
    square = float(way @ way)
    part = 0.0 if square == 0.0 else min(1.0, max(0.0, float((place - start) @ way) / square))
    return float(np.linalg.norm(start + part * way - place))


def _unit(arrays: dict[str, np.ndarray], shapes: Sequence[Obstacle]) -> float:
    """What lengths are small against."""
    moving = arrays["radius"][arrays["radius"] > 0.0]
    if moving.size:
        return float(moving.min())
    sizes = [min(shape.size) for shape in shapes if isinstance(shape, Box)]
    sizes += [min(shape.radius, shape.length) for shape in shapes if isinstance(shape, Cylinder)]
    sizes += [float(np.ptp(shape.vertices, axis=0).max()) for shape in shapes if isinstance(shape, Mesh)]
    return 0.1 * min(sizes, default=1.0)


__all__ = ["Touching", "touching"]
