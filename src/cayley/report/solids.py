"""Obstacles in the snapshots: what is seen of shapes, filled and with their edges, and planes as far as the room."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from cayley.lie import quaternion
from cayley.model import Mesh, Plane
from cayley.model.skins import patch, skin
from cayley.model.triangles import Flags, Ints
from cayley.report.conserved import Array
from cayley.report.style import INK, MUTED, SOLID
from cayley.report.view import TOWARD, seen

_CREASE = np.cos(np.radians(40.0))  # an edge that turns by more is drawn; those of round shapes turn by less
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_FLAT, _BODY, _STEP = (
    0.5,
    1.5,
    0.4,
)  # orders of drawing: planes, the grid (1), shapes with the nearest last, shadows (2)
_NEAR = 0.05  # of the size of what moves: a floor that much above its lowest point is still below it


@dataclass(frozen=True, slots=True)
class Solid:
    """A shape at some frames.

    Attributes:
        mesh: its surface in the frame of what carries it; None: a plane.
        plane: its point and the two directions in it, of a plane.
        fixed: whether it is fixed in space.
        center: of what carries it [m], shape (frames, 3).
        turn: of what carries it, unit quaternions, wxyz, shape (frames, 4).
    """

    mesh: Mesh | None
    plane: tuple[Array, Array, Array] | None
    fixed: bool
    center: Array
    turn: Array

    def points(self, k: int) -> Array:
        """Vertices in space at a frame [m], shape (n, 3); of a plane its point."""
        own = self.mesh.vertices if self.mesh is not None else self._plane[0][None]
        found: Array = self.center[k] + quaternion.rotate(self.turn[k], own)
        return found

    @property
    def _plane(self) -> tuple[Array, Array, Array]:
        assert self.plane is not None
        return self.plane

    def flat(self, k: int) -> tuple[Array, Array, Array]:
        """Of a plane: point, and two directions in it, in space at a frame, shape (3,) each."""
        point, right, up = self._plane
        q = self.turn[k]
        return self.center[k] + quaternion.rotate(q, point), quaternion.rotate(q, right), quaternion.rotate(q, up)

    def draw(self, axes: Axes, k: int, low: Array, high: Array) -> None:
        """Draw it at a frame; a plane as far as the room, from low to high [m], shape (3,) each."""
        size = float(np.linalg.norm(high - low))
        if self.mesh is None:
            point, right, up = self.flat(k)
            along = np.stack([right, up])
            foot = point + along.T @ (along @ (0.5 * (low + high) - point))
            sides = np.abs(along) @ (0.5 * (high - low))
            corners = foot + (_CORNERS * sides) @ along
            faces, edges = corners[None], np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
        else:
            points = self.points(k)
            front = quaternion.rotate(self.turn[k], self.mesh.normals) @ TOWARD > 0.0
            faces, edges = points[self.mesh.triangles[front]], points[drawn_edges(self.mesh, front)]
        color, width = (MUTED, 0.7) if self.fixed else (INK, 1.0)
        above = _FLAT if self.mesh is None else _BODY + _STEP * np.tanh(self.points(k).mean(axis=0) @ TOWARD / size)
        filled = PolyCollection(list(seen(faces)), facecolors=SOLID, zorder=above)
        if self.mesh is None:
            filled.set(alpha=0.55)
        else:
            filled.set(edgecolor=SOLID, linewidth=0.3)  # no seams between triangles
        axes.add_collection(filled)
        axes.add_collection(LineCollection(list(seen(edges)), colors=color, linewidths=width, zorder=above))


def solids(run: Any, frames: list[int]) -> list[Solid]:
    """All obstacles of a run, at some frames."""
    found = []
    still = np.tile(np.zeros(3), (len(frames), 1)), np.tile(quaternion.identity(), (len(frames), 1))
    for shape in run.model.obstacles:
        center, turn = still
        if shape.on is not None:
            data = run[run.model.name_of(shape.on)].isel(time=frames)
            center, turn = data["position"].values, data["rotation"].values
        flat = isinstance(shape, Plane)
        mesh, plane = (None, patch(shape)) if flat else (skin(shape), None)
        found.append(Solid(mesh, plane, shape.on is None, center, turn))
    return found


def drawn_edges(mesh: Mesh, front: Flags) -> Ints:
    """Edges of which one triangle is seen, and that are sharp, on the border or where the surface turns away.

    Args:
        mesh: the surface.
        front: of each triangle, whether its outer side is seen, shape (m,).

    Returns: ends, indices of vertices, shape (k, 2).
    """
    count = len(mesh.edges)
    sides, owners = mesh.triangle_edges.reshape(-1), np.repeat(np.arange(len(mesh.triangles)), 3)
    seen_by = np.bincount(sides, weights=front[owners].astype(float), minlength=count)
    border = np.bincount(sides, minlength=count) == 1
    total = np.stack([np.bincount(sides, weights=mesh.normals[owners, i], minlength=count) for i in range(3)], axis=1)
    cosine = 0.5 * np.einsum("ek,ek->e", total, total) - 1.0  # of two unit vectors, from the length of their sum
    chosen = (seen_by > 0.0) & (border | (seen_by == 1.0) | (cosine < _CREASE))
    found: Ints = mesh.edges[chosen]
    return found


def floor_of(found: list[Solid], low: Array, high: Array) -> float | None:
    """Height of a fixed plane that is horizontal, faces upward and lies below what moves, not too far; or None.

    Args:
        found: obstacles.
        low: least coordinates of what moves [m], shape (3,).
        high: greatest ones.
    """
    size = float((high - low).max())
    heights = [np.nan]
    for solid in found:
        if solid.plane is not None and solid.fixed:
            point, right, up = solid.plane
            if np.cross(right, up)[2] > 1.0 - 1e-9:
                heights.append(float(point[2]))
    within = [z for z in heights if low[2] - 2.0 * size <= z <= low[2] + _NEAR * size]
    return max(within, default=None)


def around(found: list[Solid], low: Array, high: Array) -> Array:
    """Points of fixed shapes that the room is to hold: no farther from what moves than its size, shape (n, 3)."""
    size = float((high - low).max()) or np.inf
    own = [solid.points(0) for solid in found if solid.mesh is not None and solid.fixed]
    points: Array = np.concatenate([np.zeros((0, 3)), *own])
    return np.clip(points, low - size, high + size)


def moving(found: list[Solid]) -> list[Array]:
    """Points of the shapes on bodies, at all frames [m], shape (n, 3) each."""
    carried = [solid for solid in found if solid.mesh is not None and not solid.fixed]
    return [solid.points(k) for solid in carried for k in range(len(solid.center))]
