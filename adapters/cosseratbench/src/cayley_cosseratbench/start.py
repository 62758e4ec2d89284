"""How a rod of the suite stands at the start: where its nodes are, and how its sections are turned."""

import numpy as np

import cosseratbench.scenario as suite
from cayley.lie import quaternion


def node_frames(spec: suite.Rod, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions and rotations of nodes, evenly spaced along the unstretched rod.

    d3 is the tangent, d1 the suite's director of the elements on either side, made perpendicular to it.

    Args:
        spec: the rod.
        count: number of elements between these nodes.

    Returns: positions [m], shape (count + 1, 3), unit quaternions wxyz, shape (count + 1, 4).
    """
    nodes, directors = spec.nodes(count), spec.directors(count)
    line = np.asarray(spec.centerline, dtype=float)
    inside = nodes[2:] - nodes[:-2]  # of second order: nodes are evenly spaced
    d3 = _units(np.vstack([line[1] - line[0], inside, line[-1] - line[-2]]))
    d1 = np.vstack([directors[:1], directors[1:] + directors[:-1], directors[-1:]])
    d1 = _units(d1 - np.sum(d1 * d3, axis=1, keepdims=True) * d3)
    frames = np.stack([d1, np.cross(d3, d1), d3], axis=2)
    return nodes, np.array([quaternion.from_matrix(frame) for frame in frames])


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
