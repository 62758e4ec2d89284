"""Saint-Venant torsion of any section by finite elements: torsion constant and shear center (needs scikit-fem)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cayley.model.areas import areas, inside
from cayley.model.validate import Array

FINEST = 3
"""How often the mesh is made twice as fine when it does not follow the outline."""
MOST = 4e6
"""Points of the lattice from which a mesh is cut: for thinner walls it takes too long."""
SYMMETRIC = 1e-3
"""A shear center closer to the centroid than this part of √A is that of a symmetric section, and the mesh at fault."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Torsion:
    """What the warping of a section says.

    Attributes:
        constant: torsion constant It [m^4].
        shear_center: from the centroid [m].
    """

    constant: float
    shear_center: tuple[float, float]


def torsion(owner: str, outline: Array, holes: Sequence[Array] = ()) -> Torsion:
    """Torsion constant and shear center of a polygon with holes, about its centroid at the origin.

    The warping function ω, of quadratic triangles, makes ½ ∫ |∇ω − (y2, −y1)|² dA least, and then
    It = ∫ (y1² + y2²) dA − ∫ |∇ω|² dA,   a = the point about which ∫ ω y1 dA = ∫ ω y2 dA = 0.

    It is above the exact value, by 1e-4 of it or less for convex sections and 1e-2 or less with reentrant corners.

    Args:
        owner: the object, for messages.
        outline: counter-clockwise, shape (k, 2) [m].
        holes: counter-clockwise, inside it.

    Raises:
        ImportError: scikit-fem is not installed.
        ValueError: no mesh follows the outline (walls of very different thickness).

    Source: Timoshenko and Goodier, Theory of Elasticity, art. 107; shear center: Trefftz (1935).
    """
    fem, helpers = _library(owner)
    found = areas(outline, holes)
    size = min(0.06 * np.sqrt(found.area), 0.34 * thinnest((outline, *holes)))
    mesh = None
    for _ in range(FINEST):
        if np.prod(np.ptp(outline, axis=0) / size) > MOST:
            break
        points, triangles = _mesh(outline, holes, size)
        if abs(_covered(points, triangles) - found.area) < 1e-9 * found.area:
            mesh = fem.MeshTri(np.ascontiguousarray(points.T), np.ascontiguousarray(triangles.T))
            break
        size *= 0.5
    if mesh is None:
        raise ValueError(
            f'{owner}: torsion = "saint-venant" found no mesh of the section; give torsion as a number [m^4]'
        )
    basis = fem.Basis(mesh, fem.ElementTriP2())
    stiffness = fem.BilinearForm(lambda u, v, _: helpers.dot(u.grad, v.grad)).assemble(basis)
    push = fem.LinearForm(lambda v, w: w.x[1] * v.grad[0] - w.x[0] * v.grad[1]).assemble(basis)
    warping = fem.solve(*fem.condense(stiffness, push, D=np.array([0])))
    over = [fem.LinearForm(lambda v, w, k=k: w.x[k] * v).assemble(basis) for k in range(2)]
    i1, i2, i12 = found.moments
    s1, s2 = (float(part @ warping) for part in over)  # ∫ ω y is free of the constant in ω, for ∫ y = 0
    a1, a2 = np.linalg.solve([[i1, -i12], [i12, -i2]], [-s2, -s1]).tolist()
    centered = np.hypot(a1, a2) < SYMMETRIC * np.sqrt(found.area)
    constant = i1 + i2 - float(push @ warping)
    return Torsion(constant=constant, shear_center=(0.0, 0.0) if centered else (a1, a2))


def thinnest(rings: Sequence[Array]) -> float:
    """Thickness of the thinnest wall [m]: the least distance from the middle of an edge to an edge that faces it."""
    starts = np.concatenate(rings)
    ends = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    ways = ends - starts
    normals = np.stack([ways[:, 1], -ways[:, 0]], axis=1) / np.linalg.norm(ways, axis=1, keepdims=True)
    for k, ring in enumerate(rings):  # out of the material: the other way at a hole
        first = sum(len(other) for other in rings[:k])
        normals[first : first + len(ring)] *= 1.0 if k == 0 else -1.0
    faces = normals @ normals.T < -0.2
    least = np.inf
    for part in (0.05, 0.5, 0.95):
        away = (starts + part * ways)[:, None] - starts[None]
        along = np.clip((away * ways).sum(axis=2) / (ways * ways).sum(axis=1), 0.0, 1.0)
        distance = np.linalg.norm(away - along[..., None] * ways, axis=2)
        least = min(least, float(distance[faces].min(initial=np.inf)))
    return least


def _library(owner: str) -> tuple[Any, Any]:
    """The modules skfem and skfem.helpers.

    Raises:
        ImportError: they are not installed.
    """
    try:
        import skfem
        from skfem import helpers
    except ImportError:
        raise ImportError(
            f'{owner}: torsion = "saint-venant" needs scikit-fem for this shape; pip install "cayley[section]", or '
            "give torsion as a number [m^4]"
        ) from None
    return skfem, helpers


def _mesh(outline: Array, holes: Sequence[Array], size: float) -> tuple[Array, Any]:
    """Triangles of about a size: points on the edges, a lattice between them, Delaunay, and those inside."""
    from scipy.spatial import Delaunay, KDTree

    rings = [_divided(ring, size) for ring in (outline, *holes)]
    edge = np.concatenate(rings)
    low, high = outline.min(axis=0), outline.max(axis=0)
    steps = [np.arange(a + 0.5 * h, b, h) for a, b, h in zip(low, high, (size, 0.866 * size), strict=True)]
    x, y = np.meshgrid(*steps)
    x[1::2] += 0.5 * size
    lattice = np.stack([x.reshape(-1), y.reshape(-1)], axis=1)
    kept = _within(lattice, outline, holes)
    kept &= KDTree(edge).query(lattice)[0] > 0.6 * size  # so that every piece of an edge is one of a triangle
    points = np.concatenate([edge, lattice[kept]])
    triangles = Delaunay(points).simplices
    corners = points[triangles]
    keep = _within(corners.mean(axis=1), outline, holes)
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    keep &= np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) > 1e-6 * size * size  # slivers on an edge
    used, numbers = np.unique(triangles[keep], return_inverse=True)
    return points[used], numbers.reshape(-1, 3)


def _divided(ring: Array, size: float) -> Array:
    """A closed polygon with points at most a size apart on its edges."""
    ends = np.roll(ring, -1, axis=0)
    parts = []
    for a, b in zip(ring, ends, strict=True):
        count = max(1, int(np.ceil(np.linalg.norm(b - a) / size)))
        parts.append(a + (b - a) * (np.arange(count) / count)[:, None])
    return np.concatenate(parts)


def _within(points: Array, outline: Array, holes: Sequence[Array]) -> NDArray[np.bool_]:
    found = inside(points, outline)
    for hole in holes:
        found &= ~inside(points, hole)
    return found


def _covered(points: Array, triangles: Any) -> float:
    """Area of all triangles."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    first, second = b - a, c - a
    return float(0.5 * np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]).sum())


__all__ = ["Torsion", "torsion"]
