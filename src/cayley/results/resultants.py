"""Stress resultants at the nodes, from the forces of the elements."""

from collections.abc import Mapping

import numpy as np

from cayley.lie import quaternion
from cayley.results.frames import Frames
from cayley.system.system import LoadEntries, System


def resultants(system: System, frames: Frames, forces: Mapping[str, np.ndarray]) -> np.ndarray:
    """Spatial momenta at the nodes: the discrete Legendre transform along the interval, per unit of time.

    σ_aʲ = (1/h) Σ over the two steps at j of D_(a,j) L_d(cells left of a) = −(1/h) Σ D_(a,j) L_d(cells right of a)

    The two are equal by the discrete Euler-Lagrange equations where no load acts at the node alone; else they differ by
    that load, and their mean is taken. At an end there is one of them. Spread loads and the inertia of a node (the
    total force on it; a held one has none) are shared between left and right by weight. With F the forces of the
    elements on the left (l) and right (r) of a node, B the spread and P the point loads, and w = the left part of
    its weight, a free component has

    left: (1 − w) F_l − w (F_r + P),   right: (1 − w)(F_l + P) − w F_r

    so a free end is exactly zero, one with a load has exactly that load, and a held one (F_l + w B, −F_r − (1 − w) B)
    the force on its support.

    Args:
        system: the system, with an interval.
        frames: its saved states.
        forces: "left" and "right", of each element on its left and right node, and "load", of the load terms of the
            density on each node, and "point", of joints and springs on the nodes alone, shape (m, nodes, dofs) each.

    Returns: in the paper's sign (σ = ∂L/∂x′ = −internal force), x in space, rotations in the body frame,
    shape (m, nodes, dofs), in N and N m; times h these are the raw discrete momenta.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 2 and figure 5.
    """
    length, weight = system.named["length"], system.named["weight"]
    before = np.append(0.0, length[:-1])
    share = (0.5 * before / weight)[None, :, None]
    other = 1.0 - share
    from_right, from_left = forces["left"], np.zeros_like(forces["right"])
    from_left[:, 1:] = forces["right"][:, :-1]
    from_left[:, before == 0.0] = 0.0
    spread, point = timed_loads(system, frames)
    spread += forces["load"]
    point += forces["point"]
    free = system.free[None]
    left = np.where(free, other * from_left - share * (from_right + point), from_left + share * spread)
    right = np.where(free, other * (from_left + point) - share * from_right, -from_right - other * spread)
    return np.where(share == 0.0, right, np.where(share == 1.0, left, 0.5 * (left + right)))


def timed_loads(system: System, frames: Frames) -> tuple[np.ndarray, np.ndarray]:
    """Forces of the time-dependent loads on every node: of line loads, and of loads on a node alone.

    Returns: two arrays of shape (m, nodes, dofs).
    """
    shape = (len(frames.times), system.size, system.layout.dofs)
    spread, point = np.zeros(shape), np.zeros(shape)
    loads = system.loads
    if loads is None:
        return spread, point
    table = loads.table(frames.times, frames.h, frames.origin)
    # a rod has two nodes or more: only a line load has several entries that are no moments of others
    several = np.bincount(loads.column[~np.any(loads.lever != 0.0, axis=1)]) > 1
    for e, column in enumerate(loads.column):
        target = spread if several[column] else point
        dofs = slice(loads.dof[e], loads.dof[e] + 3)
        target[:, loads.node[e], dofs] += _turned(system, frames, loads, e, table[:, column : column + 3])
    return spread, point


def _turned(system: System, frames: Frames, loads: LoadEntries, e: int, values: np.ndarray) -> np.ndarray:
    """Values of one load in the frame of the equations, times its factor, shape (m, 3)."""
    vector = loads.scale[e] * values
    if not loads.form[e]:
        return _levered(loads, e, vector)
    representation = system.layout.representation
    rows = frames.values[:, loads.node[e], loads.turn[e] : loads.turn[e] + representation.rows]
    turned = quaternion.inverse_rotate if loads.form[e] == 1 else quaternion.rotate
    return _levered(loads, e, np.asarray(turned(representation.to_quaternion(rows), vector), dtype=float))


def _levered(loads: LoadEntries, e: int, force: np.ndarray) -> np.ndarray:
    """The moment of a force off the node, if the entry is one, else the force."""
    return np.cross(loads.lever[e], force) if loads.lever[e].any() else force


__all__ = ["resultants", "timed_loads"]
