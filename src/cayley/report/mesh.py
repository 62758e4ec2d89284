"""The surface of a rod from the outlines of its cross-sections: normals around it, triangles that close its ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cayley.report.conserved import Array

_SHARP = np.cos(np.radians(40.0))  # a corner that turns by more is an edge; the polygons of circles turn by less


@dataclass(frozen=True, slots=True)
class Ring:
    """How vertices go around a cross-section: two at every sharp corner, so that faces are flat, else one.

    Attributes:
        points: which points of the outline they are, in pairs, one pair for each face, shape (k, 2).
        normals: outward, of the two vertices of each face, at each cross-section, shape (1 or n, k, 2, 2).
        caps: triangles of the points of the outline, counter-clockwise, shape (k - 2, 3).
    """

    points: list[tuple[int, int]]
    normals: Array
    caps: list[tuple[int, int, int]]


def ring(outlines: Array) -> Ring:
    """The vertices around the cross-sections of a rod.

    Args:
        outlines: shape (1, k, 2) or (n, k, 2), counter-clockwise.
    """
    following = np.roll(outlines, -1, axis=1)
    edges = following - outlines
    face = np.stack([edges[..., 1], -edges[..., 0]], axis=-1)
    face /= np.maximum(np.linalg.norm(face, axis=-1, keepdims=True), 1e-300)
    before = np.roll(face, 1, axis=1)
    smooth = before + face
    smooth /= np.maximum(np.linalg.norm(smooth, axis=-1, keepdims=True), 1e-300)
    sharp = np.any(np.sum(before * face, axis=-1) < _SHARP, axis=0)
    corner = np.where(sharp[None, :, None, None], np.stack([before, face], axis=2), smooth[:, :, None])
    count = outlines.shape[1]
    points = [(k, (k + 1) % count) for k in range(count)]
    normals = np.stack([corner[:, :, 1], np.roll(corner[:, :, 0], -1, axis=1)], axis=2)
    return Ring(points, normals, triangles(outlines[0]))


def triangles(outline: Array) -> list[tuple[int, int, int]]:
    """A polygon without holes as triangles: corners that stick out and hold no other point are cut off one by one.

    Args:
        outline: its corners, counter-clockwise, shape (k, 2).

    Source: Meisters (1975), Polygons have ears.
    """
    left = list(range(len(outline)))
    found = []
    while len(left) > 3:
        ear = next((i for i in range(len(left)) if _is_ear(outline, left, i)), 0)
        found.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    return [*found, (left[0], left[1], left[2])]


def _is_ear(outline: Array, left: list[int], i: int) -> bool:
    a, b, c = (outline[left[k % len(left)]] for k in (i - 1, i, i + 1))
    if _area(a, b, c) <= 0.0:
        return False
    others = [outline[k] for k in left if k not in (left[i - 1], left[i], left[(i + 1) % len(left)])]
    return not any(min(_area(a, b, p), _area(b, c, p), _area(c, a, p)) >= 0.0 for p in others)


def _area(a: Array, b: Array, c: Array) -> float:
    """Twice the area of a triangle, positive if counter-clockwise."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
