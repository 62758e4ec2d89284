"""Surfaces of triangles: their edges, which of them stick out, and which triangle answers for which edge and corner."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cayley.model import validate
from cayley.model.validate import Array

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

FLAT = 1e-9
"""Sine of the angle between two triangles that counts as none."""


class Surface(NamedTuple):
    """What follows from the vertices and triangles of a mesh; all arrays are read-only.

    Attributes:
        normals: outward unit normal of each triangle [-], shape (m, 3).
        edges: vertices of each edge, the smaller index first, shape (e, 2).
        triangle_edges: edge from corner k to corner k + 1 of each triangle, shape (m, 3).
        convex: of each edge, whether it is on the border, sticks out or is flat; not so where it is a valley; (e,).
        flat: of each edge, whether its two triangles lie in one plane, shape (e,).
        owns_edge: whether the triangle answers for that edge of it: exactly one for a convex one, none else; (m, 3).
        owns_vertex: whether the triangle answers for that corner of it: exactly one for each vertex; (m, 3).
        closed: whether every edge has two triangles.
    """

    normals: Array
    edges: Ints
    triangle_edges: Ints
    convex: Flags
    flat: Flags
    owns_edge: Flags
    owns_vertex: Flags
    closed: bool


def checked_triangles(owner: str, value: Any, vertices: int) -> Ints:
    """Corners of triangles, read-only, shape (m, 3).

    Raises:
        TypeError: not whole numbers.
        ValueError: another shape, or a vertex that there is not.
    """
    right = "whole numbers, three vertices for each triangle, shape (m, 3)"
    try:
        given = np.asarray(value)
    except ValueError:  # rows of unequal length
        raise ValueError(validate.wrong(owner, "triangles", value, right)) from None
    if given.size and given.dtype.kind not in "iu":
        raise TypeError(validate.wrong(owner, "triangles", value, right))
    if given.ndim != 2 or given.shape[1] != 3 or not len(given):
        raise ValueError(validate.wrong(owner, "triangles", value, right))
    outside = np.flatnonzero(((given < 0) | (given >= vertices)).any(axis=1))
    if outside.size:
        k = int(outside[0])
        raise ValueError(
            f"{owner}: triangle {k} is {tuple(given[k].tolist())}, but vertices go from 0 to {vertices - 1}"
        )
    found = np.array(given, dtype=np.int64, order="C")
    found.setflags(write=False)
    return found


def surface(owner: str, vertices: Array, triangles: Ints) -> Surface:
    """Edges, normals and owners of a mesh.

    Of two triangles at an edge, nA · (oB − a) > 0 says that it is a valley: a on the edge, oB the other corner of B.

    Args:
        owner: the mesh, for messages.
        vertices: positions [m], shape (n, 3).
        triangles: their corners, counter-clockwise seen from outside, shape (m, 3).

    Raises:
        ValueError: a triangle without area; an edge of more than two triangles, or along which two run the same way.
    """
    normals = _normals(owner, vertices, triangles)
    ways = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, first, inverse, counts = np.unique(
        np.sort(ways, axis=1), axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    inverse = inverse.reshape(-1)  # its shape depends on the version of NumPy
    order = np.argsort(inverse, kind="stable")
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    if counts.max() > 2:
        k = int(np.argmax(counts > 2))
        at = ", ".join(str(side // 3) for side in order[starts[k] : starts[k] + counts[k]])
        edge = tuple(edges[k].tolist())
        raise ValueError(f"{owner}: edge {edge} is in triangles {at}, but at most two may meet in an edge")
    inner = np.flatnonzero(counts == 2)
    one, two = order[starts[inner]], order[starts[inner] + 1]
    same = np.flatnonzero((ways[one] == ways[two]).all(axis=1))
    if same.size:
        k = int(same[0])
        raise ValueError(
            f"{owner}: triangles {one[k] // 3} and {two[k] // 3} run the same way along edge "
            f"{tuple(edges[inner[k]].tolist())}; reverse one of them: all must be counter-clockwise seen from outside"
        )
    bend = np.full(len(edges), -1.0)
    bend[inner] = _bend(vertices, triangles, normals[one // 3], ways[two], two)
    flat, convex = np.abs(bend) <= FLAT, bend <= FLAT
    flat[inner] &= np.einsum("ek,ek->e", normals[one // 3], normals[two // 3]) > 0.0  # not folded over
    owns_edge, owns_vertex = np.zeros((2, triangles.size), dtype=bool)
    owns_edge[first[convex]] = True
    owns_vertex[np.unique(triangles, return_index=True)[1]] = True
    return Surface(
        normals=validate.frozen(normals),
        edges=_frozen(edges.astype(np.int64)),
        triangle_edges=_frozen(inverse.reshape(-1, 3).astype(np.int64)),
        convex=_frozen(convex),
        flat=_frozen(flat),
        owns_edge=_frozen(owns_edge.reshape(-1, 3)),
        owns_vertex=_frozen(owns_vertex.reshape(-1, 3)),
        closed=len(inner) == len(edges),
    )


def volume(vertices: Array, triangles: Ints) -> float:
    """Volume inside a closed surface [m^3], Σ a · (b × c)/6; negative if clockwise seen from outside."""
    a, b, c = np.moveaxis(vertices[triangles] - vertices.mean(axis=0), 1, 0)
    return float(np.einsum("mk,mk->", a, np.cross(b, c)) / 6.0)


def _bend(vertices: Array, triangles: Ints, normals: Array, ends: Ints, sides: Ints) -> Array:
    """Sine of the angle by which the second triangle at an edge rises above the plane of the first one.

    Args:
        vertices: of the mesh.
        triangles: of the mesh.
        normals: of the first triangle at each edge.
        ends: of each edge.
        sides: 3 times the second triangle, plus the corner where the edge begins in it.
    """
    a, b = vertices[ends[:, 0]], vertices[ends[:, 1]]
    away = vertices[triangles[sides // 3, (sides + 2) % 3]] - a
    height = np.linalg.norm(np.cross(b - a, away), axis=1) / np.linalg.norm(b - a, axis=1)
    found: Array = np.einsum("ek,ek->e", normals, away) / height
    return found


def _frozen(values: Any) -> Any:
    values.setflags(write=False)
    return values


def _normals(owner: str, vertices: Array, triangles: Ints) -> Array:
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    with np.errstate(over="ignore", invalid="ignore"):  # of sizes that nothing has
        twice = np.cross(b - a, c - a)
        area = np.linalg.norm(twice, axis=1)
        longest = np.maximum.reduce([np.einsum("mk,mk->m", side, side) for side in (b - a, c - b, a - c)])
        thin = np.flatnonzero(~(area > 1e-12 * longest) | ~np.isfinite(area))
    if thin.size:
        k = int(thin[0])
        raise ValueError(
            f"{owner}: triangle {k} {tuple(triangles[k].tolist())} has no area that is finite; leave it out"
        )
    found: Array = twice / area[:, None]
    return found
