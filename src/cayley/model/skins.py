"""The surfaces of shapes as triangles, to be drawn."""

from __future__ import annotations

import numpy as np

from cayley.lie import quaternion
from cayley.model.frames import standard_rotation
from cayley.model.shapes import Box, Capsule, Cylinder, Mesh, Obstacle, Plane, Sphere
from cayley.model.validate import Array, Triple

_AROUND, _HALF = 32, 16  # pieces of a circle, and of a half one


def skin(shape: Obstacle) -> Mesh:
    """The surface of a shape in the frame of what carries it; round ones as polyhedra.

    Raises:
        TypeError: a plane, which has no end.
    """
    if isinstance(shape, Mesh):
        return shape
    if isinstance(shape, Box):
        return shape.mesh
    if isinstance(shape, Sphere):
        return _revolved(_arc(shape.radius, -_HALF, _HALF), shape.center, (0.0, 0.0, 1.0))
    if isinstance(shape, Cylinder):
        end = 0.5 * shape.length
        profile = np.array([[-end, 0.0], [-end, shape.radius], [end, shape.radius], [end, 0.0]])
        return _revolved(profile, shape.center, shape.axis)
    if isinstance(shape, Capsule):
        line = np.subtract(shape.end, shape.start)
        length = float(np.linalg.norm(line))
        x, y, z = (line / length).tolist()
        upper = _arc(shape.radius, 0, _HALF) + np.array([length, 0.0])
        return _revolved(np.concatenate([_arc(shape.radius, -_HALF, 0), upper]), shape.start, (x, y, z))
    raise TypeError(f"skin: {shape!r} has no end and no skin")


def patch(plane: Plane) -> tuple[Array, Array, Array]:
    """A plane as its point, and two unit vectors in it, to the right and up seen from outside, shape (3,) each."""
    turn = standard_rotation(plane.label, plane.normal, None)
    return np.array(plane.point), quaternion.rotate(turn, (1.0, 0.0, 0.0)), quaternion.rotate(turn, (0.0, 1.0, 0.0))


def _arc(radius: float, first: int, last: int) -> Array:
    """Points (along the axis, away from it) on a circle, from one end of the axis to the other, shape (k, 2)."""
    angle = 0.5 * np.pi * np.arange(first, last + 1) / _HALF
    away = np.where(np.abs(angle) == 0.5 * np.pi, 0.0, np.cos(angle))
    return radius * np.column_stack([np.sin(angle), away])


def _revolved(profile: Array, center: Triple, axis: Triple) -> Mesh:
    """A surface of revolution.

    Args:
        profile: points (along the axis from the center, away from it); the first and the last are on the axis.
        center: where the axis begins [m].
        axis: its direction, a unit vector.
    """
    angle = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rings = np.concatenate([np.column_stack([away * circle, np.full(_AROUND, along)]) for along, away in profile[1:-1]])
    points = np.concatenate([[[0.0, 0.0, profile[0, 0]]], rings, [[0.0, 0.0, profile[-1, 0]]]])
    here = np.arange(_AROUND)
    there, last = np.roll(here, -1), len(points) - 1
    found = [np.column_stack([0 * here, 1 + there, 1 + here])]
    for k in range(len(profile) - 3):
        a, b = 1 + k * _AROUND, 1 + (k + 1) * _AROUND
        found += [np.column_stack([a + here, a + there, b + there]), np.column_stack([a + here, b + there, b + here])]
    top = last - _AROUND
    found.append(np.column_stack([0 * here + last, top + here, top + there]))
    turn = standard_rotation("skin", axis, None)
    return Mesh(quaternion.rotate(turn, points) + center, np.concatenate(found))
