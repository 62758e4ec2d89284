"""Stiffness of contacts, and what it asks of a step."""

import math

import numpy as np

from cayley.system.contact_arrays import Touching
from cayley.system.legendre import momenta_of
from cayley.system.system import System

PART = 0.1
"""k h²/m of contacts in steps h: of the limit 4 that a step of an explicit rule has, the rod is left most."""
SHARED = 6.0
"""Contacts on one node that are reckoned with,"""
CORNERS = 16.0
"""and on a body with corners: four at each of two faces, twice where those of two bodies meet."""
SOFT = 0.5
"""Part of the wanted depth in which the stiffness sets in."""


def inverse_masses(system: System) -> tuple[np.ndarray, np.ndarray]:
    """1/m that answers at points [1/kg], shape (points,), and on solids, shape (solids,).

    1/m + |o|²/J for a point at o from the mass center, J the least moment of inertia; 0 where the node is held.
    """
    if "contact masses" not in system.plans:
        system.plans["contact masses"] = _inverse_masses(system)
    found: tuple[np.ndarray, np.ndarray] = system.plans["contact masses"]
    return found


def _inverse_masses(system: System) -> tuple[np.ndarray, np.ndarray]:
    assert system.contact is not None
    arrays, layout = system.contact.arrays, system.layout
    places, turns = layout.dofs_of("x"), layout.dofs_of("p")

    def inertia(dof: int) -> np.ndarray:
        velocity = np.zeros((system.size, layout.dofs))
        velocity[:, dof] = 1.0
        return momenta_of(system, system.reference, velocity, 0.0)[:, dof]

    def inverse(dofs: slice, free: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore"):
            each = np.array([np.where(system.free[:, k], 1.0 / inertia(k), 0.0) for k in range(dofs.start, dofs.stop)])
        return np.append(np.where(free, each.max(axis=0), 0.0), 0.0)  # the ground behind

    mass = inverse(slice(places.start, places.start + 1), np.ones(system.size, dtype=bool))
    mass[:-1] = np.where(system.free[:, places].any(axis=1), np.maximum(mass[:-1], 0.0), 0.0)
    held = system.free[:, places].any(axis=1) & ~system.free[:, places.start]
    if held.any():
        mass = np.maximum(mass, inverse(places, np.ones(system.size, dtype=bool)))
    far, bound = np.linalg.norm(arrays["offset"], axis=1), np.where(np.isinf(arrays["bound"]), 0.0, arrays["bound"])
    turn = np.zeros(system.size + 1)
    if np.any(far > 0.0) or np.any(arrays["carrier"] < system.size):
        turn = inverse(turns, np.ones(system.size, dtype=bool))
        turn[~np.isfinite(turn)] = 0.0
    at_points = mass[arrays["node"]] + far**2 * turn[arrays["node"]]
    on_solids = mass[arrays["carrier"]] + bound**2 * turn[arrays["carrier"]]
    return at_points, on_solids


def least_stiffness(touching: Touching) -> float:
    """K [N/m] with which the expected load presses no deeper than wanted: that of all weight shared by the segments.

    N = W/√n,    k = N/((1 − SOFT/2) depth), of n segments: those of a heap carry the ones above.
    """
    if touching.contact.stiffness is not None:
        return touching.contact.stiffness
    load = touching.weight / math.sqrt(touching.movers)
    return load / ((1.0 - 0.5 * SOFT) * touching.contact.penetration * touching.unit)


def stiffness(system: System, h: float) -> tuple[float, float]:
    """k/m [1/s²] and least k [N/m] of contacts in steps h [s]: as stiff as a step takes, and as the load wants."""
    assert system.contact is not None
    given = system.contact.contact.stiffness is not None
    return 0.0 if given else PART / h**2, least_stiffness(system.contact)


def with_contact(system: System, limit: float) -> float:
    """The step limit of an explicit rule that leaves room for contacts of the least stiffness [s].

    h = 2/√(ω² + SHARED k/m), or CORNERS
    """
    assert system.contact is not None
    points, solids = inverse_masses(system)
    answering = float(max(points.max(initial=0.0), solids.max(initial=0.0)))
    shared = SHARED if system.contact.arrays["round"].all() else CORNERS
    square = shared * least_stiffness(system.contact) * answering + (4.0 / limit**2 if limit > 0.0 else math.inf)
    return 2.0 / math.sqrt(square) if square > 0.0 else math.inf
