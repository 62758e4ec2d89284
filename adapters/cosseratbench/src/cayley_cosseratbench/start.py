"""How a rod of the suite stands at the start: where its nodes are, and how its sections are turned."""

import cosseratbench.scenario as suite
import numpy as np
from cosseratbench.scenario import parallel_transport

from cayley.discrete.rules import lobatto
from cayley.lie import quaternion

SMOOTH = 0.2
"""Angle between two segments of a centerline up to which it samples a smooth curve; else it has a corner [rad]."""

CUT, CHORD, HUG, MOST = 0.02, 0.03, 0.2, 9
"""Distance of a chord from the curve it is of, in radii, at the start, from which on an element is cut where rods touch
rods, that of its pieces at most, that where rods touch obstacles, on which nodes rest; and most pieces."""


def node_frames(spec: suite.Rod, elements: int, degree: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Positions and rotations of the nodes of equal elements, those inside an element at its Lobatto points.

    Positions are the suite's, linear along its centerline; d3 is the tangent, d1 the suite's director of the pieces on
    either side, made perpendicular to it.

    Args:
        spec: the rod.
        elements: their number.
        degree: of the elements.

    Returns: positions [m], shape (elements · degree + 1, 3), unit quaternions wxyz, shape (elements · degree + 1, 4).
    """
    line = np.asarray(spec.centerline, dtype=float)
    inside = (np.arange(elements)[:, None] + lobatto(degree)[:-1]).reshape(-1)
    at = spec.length / elements * np.append(inside, elements)
    arc = _arc(spec, line)
    nodes = np.stack([np.interp(at, arc, line[:, axis]) for axis in range(3)], axis=1)
    directors = parallel_transport(nodes, np.asarray(spec.normal, dtype=float))
    slopes, sizes = np.diff(nodes, axis=0) / np.diff(at)[:, None], np.diff(at)[:, None]
    middle = sizes[1:] * slopes[:-1] + sizes[:-1] * slopes[1:]  # of the parabola through three nodes
    d3 = _units(np.vstack([_end_tangent(line), middle, -_end_tangent(line[::-1])]))
    d1 = np.vstack([directors[:1], directors[1:] + directors[:-1], directors[-1:]])
    d1 = _units(d1 - np.sum(d1 * d3, axis=1, keepdims=True) * d3)
    frames = np.stack([d1, np.cross(d3, d1), d3], axis=2)
    return nodes, np.asarray(quaternion.from_matrix(frames), dtype=float)


def _arc(spec: suite.Rod, line: np.ndarray) -> np.ndarray:
    """Unstretched distance along the rod to each point of its centerline [m]."""
    if spec.rest_arc_length is not None:
        return np.asarray(spec.rest_arc_length, dtype=float)
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])


def _end_tangent(line: np.ndarray) -> np.ndarray:
    """Direction at the first point of a polyline; of the parabola through three points if they sample a smooth curve.

    A clamp would keep the tilt of a first segment for good.
    """
    first = line[1] - line[0]
    if len(line) < 3:
        return first
    second = line[2] - line[1]
    sizes = np.linalg.norm(first), np.linalg.norm(second)
    slopes = first / sizes[0], second / sizes[1]
    if np.linalg.norm(slopes[1] - slopes[0]) > SMOOTH:
        return first
    return slopes[0] - (slopes[1] - slopes[0]) * sizes[0] / (sizes[0] + sizes[1])


def pieces(spec: suite.Rod, count: int, *, obstacles: bool) -> int:
    """Into how many elements one of the suite is cut, an odd number, so that chords are near the curve they are of.

    The middle of an element stays the middle of one; of p pieces the chord is off by 1/p² of what it was.

    Args:
        spec: the rod.
        count: number of the suite's elements.
        obstacles: whether there are any.
    """
    nodes, middles = spec.nodes(count), spec.nodes(2 * count)[1::2]
    off = float(np.linalg.norm(middles - 0.5 * (nodes[1:] + nodes[:-1]), axis=1).max()) / spec.radius
    whole, near = (HUG, HUG) if obstacles else (CUT, CHORD)
    if off <= whole:
        return 1
    return next(p for p in range(3, MOST + 2, 2) if off <= near * p**2 or p >= MOST)


def element_directors(positions: np.ndarray, rotations: np.ndarray) -> np.ndarray:
    """The suite's directors of elements: d1 of their two nodes, made perpendicular to the element.

    Args:
        positions: of nodes [m], shape (frames, n + 1, 3).
        rotations: of nodes, wxyz, shape (frames, n + 1, 4).

    Returns: unit vectors, shape (frames, n, 3).
    """
    d1 = np.asarray(quaternion.rotate(rotations, np.broadcast_to((1.0, 0.0, 0.0), positions.shape)), dtype=float)
    along = _units(np.diff(positions, axis=1))
    both = d1[:, 1:] + d1[:, :-1]
    return _units(both - np.sum(both * along, axis=-1, keepdims=True) * along)


def _units(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
