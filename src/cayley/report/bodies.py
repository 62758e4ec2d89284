"""Bodies and joints in the snapshots: boxes of the same inertia, lines to the ports, a mark at every joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.lie import quaternion
from cayley.model import Body, LagrangianPart, PointMass
from cayley.report.conserved import Array, saved_parts

_SIGNS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_EDGES = [(i, k) for i in range(8) for k in range(i) if np.abs(_SIGNS[i] - _SIGNS[k]).sum() == 2.0]
_THIN = 0.02  # of the longest side: the least side drawn, for flat bodies and moments no real body has


@dataclass(frozen=True, slots=True)
class Shape:
    """What is drawn of a body, at some frames.

    Attributes:
        edges: lines, ends in space [m], shape (frames, lines, 2, 3).
        arms: lines from the mass center to the ports [m], shape (frames, ports, 2, 3).
        center: the mass center [m], shape (frames, 3).
    """

    edges: Array
    arms: Array
    center: Array

    @property
    def points(self) -> Array:
        """All points [m], shape (n, 3)."""
        return np.concatenate([part.reshape(-1, 3) for part in (self.edges, self.arms, self.center)])


def box_sides(body: Body) -> tuple[Array, Array]:
    """Sides [m] and axes of the box with the mass and inertia of a body.

    aᵢ² = 6 (Iⱼ + Iₖ − Iᵢ)/m,   I the principal moments

    Returns: sides, shape (3,), and the axes in the body frame as columns, shape (3, 3).
    """
    moments, axes = np.linalg.eigh(np.asarray(body.inertia))
    squares = 6.0 * (moments.sum() - 2.0 * moments) / body.mass
    sides = np.sqrt(np.maximum(squares, 0.0))
    return np.maximum(sides, _THIN * sides.max()), axes


def body_shape(run: Any, body: Body | PointMass | LagrangianPart, frames: list[int]) -> Shape:
    """The box of a body and its arms; a point mass has neither, a part of one's own no box, on an interval a line."""
    data = run[body].isel(time=frames)
    center, turn = data["position"].values, data["rotation"].values
    nothing = np.zeros((len(frames), 0, 2, 3))
    if isinstance(body, PointMass):
        return Shape(nothing, nothing, center)
    if isinstance(body, LagrangianPart):
        if body.domain is not None:
            return Shape(np.stack([center[:, :-1], center[:, 1:]], axis=2), nothing, center[:, 0])
        return Shape(nothing, _arms(body, center, turn), center)
    sides, axes = box_sides(body)
    corners = (0.5 * _SIGNS * sides) @ axes.T
    lines = np.array([(corners[i], corners[k]) for i, k in _EDGES])
    return Shape(_placed(lines, center, turn), _arms(body, center, turn), center)


def _arms(body: Body | LagrangianPart, center: Array, turn: Array) -> Array:
    lines = np.array([(np.zeros(3), shift) for shift, _ in body.ports.values()]).reshape(-1, 2, 3)
    return _placed(lines, center, turn)


def _placed(lines: Array, center: Array, turn: Array) -> Array:
    """Lines of the body frame in space, shape (frames, lines, 2, 3)."""
    turned = np.asarray(quaternion.rotate(turn[:, None, None], lines[None]), dtype=float)
    placed: Array = center[:, None, None] + turned
    return placed


def joint_points(run: Any, frames: list[int]) -> Array:
    """Where the joints of parts that were saved are, by their first ports [m], shape (frames, joints, 3)."""
    known = saved_parts(run)
    joints = [joint for joint in run.model.connections if run.model.name_of(joint.first.part) in known]
    found = [run.port(joint.first)["position"].values[frames] for joint in joints]
    return np.stack(found, axis=1) if found else np.zeros((len(frames), 0, 3))
