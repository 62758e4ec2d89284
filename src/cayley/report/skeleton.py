"""What is drawn of a mode: points of rods and bodies with their displacements, and lines between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.lie import quaternion
from cayley.report.bodies import body_shape
from cayley.report.conserved import Array

RIB, SHOWN = 0.04, 0.12
"""Length of the ribs that show how sections turn, and largest displacement drawn, over the extent."""
ROD, TICK, BODY = 0, 1, 2
"""Kinds of lines."""


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Points at rest, how modes move them, and lines between them.

    Args:
        points: at the equilibrium [m], shape (n, 3).
        moves: displacements that look large enough, complex [m], shape (modes, n, 3).
        lines: ends among the points and the kind, shape (k, 3).
    """

    points: Array
    moves: Array
    lines: Array

    @classmethod
    def of(cls, modes: Any) -> Skeleton:
        """Of the shapes of Modes."""
        rest, model = modes.about, modes.model
        places = np.concatenate([np.atleast_2d(rest[part]["position"].values) for part in model.names])
        extent = float(np.ptp(places, axis=0).max()) or 1.0
        points: list[Array] = []
        moves: list[Array] = []
        lines: list[tuple[int, int, int]] = []
        for part, name in zip(model.parts, model.names, strict=True):
            first = sum(len(p) for p in points)
            shape, data = modes[name], rest[name]
            place, turn = data["position"].values, data["rotation"].values
            if part.node_count > 1:
                off = np.zeros((len(place), 2, 3))
                off[:, 1, 0] = RIB * extent
                lines += [(first + 2 * k, first + 2 * k + 2, ROD) for k in range(len(place) - 1)]
                lines += [(first + 2 * k, first + 2 * k + 1, TICK) for k in range(len(place))]
            else:
                off, pairs = _box(modes, part)
                lines += [(first + a, first + b, BODY) for a, b in pairs]
                place, turn = place[None], turn[None]
                shape = shape.expand_dims("node", axis=1)
            points.append((place[:, None] + _rotated(turn[:, None], off)).reshape(-1, 3))
            swung = np.cross(shape["rotation"].values[:, :, None], off)
            shift = shape["displacement"].values[:, :, None] + _rotated(turn[:, None], swung)
            moves.append(shift.reshape(len(modes), -1, 3))
        found = np.concatenate(moves, axis=1).astype(complex)
        largest = np.linalg.norm(found, axis=-1).max(axis=1, initial=0.0)
        found *= (SHOWN * extent / np.where(largest > 0.0, largest, 1.0))[:, None, None]
        return cls(np.concatenate(points), found, np.array(lines, dtype=int).reshape(-1, 3))


def _box(modes: Any, body: Any) -> tuple[Array, list[tuple[int, int]]]:
    """Points of a body in its own frame, shape (1, n, 3), and lines between them: its box, and arms to its ports."""
    shape = body_shape(modes.about.frame, body, [0])
    data = modes.about[modes.model.name_of(body)]
    ends = np.concatenate([shape.edges[0], shape.arms[0]]).reshape(-1, 3) - shape.center[0]
    if not len(ends):
        return np.zeros((1, 1, 3)), []
    own = np.asarray(quaternion.inverse_rotate(data["rotation"].values, ends), dtype=float)
    return own[None], [(k, k + 1) for k in range(0, len(own), 2)]


def _rotated(p: Array, v: Array) -> Array:
    if np.iscomplexobj(v):
        return _rotated(p, v.real) + 1j * _rotated(p, v.imag)
    return np.asarray(quaternion.rotate(p, v), dtype=float)
