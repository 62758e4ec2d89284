"""Forces of supports at saved frames: what keeps held degrees of freedom from moving."""

import numpy as np

from cayley.results.frames import Frames
from cayley.results.inertia import NodeInertia
from cayley.system.system import System


def held_nodes(system: System) -> np.ndarray:
    """Nodes with a held degree of freedom, in rising order."""
    return np.flatnonzero(~system.free.all(axis=1))


def support_forces(system: System, frames: Frames, velocity: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """What holds the nodes, from Newton's second law for them.

    R = (M v̇ + b − F)_held,   where the free components of v̇ follow from (M v̇ + b − F)_free = 0

    Args:
        system: the system.
        frames: its saved states.
        velocity: ω and ẋ, shape (m, nodes, dofs).
        forces: all other forces on the nodes, with those of joints, shape (m, nodes, dofs).

    Returns: body moments and forces in space on the nodes of held_nodes, zero where free, shape (m, held, dofs).
    """
    nodes = held_nodes(system)
    found = np.zeros((len(frames.times), len(nodes), system.layout.dofs))
    if not len(nodes):
        return found
    inertia, free = NodeInertia(system, nodes), system.free[nodes].astype(float)
    both, fixed = free[:, :, None] * free[:, None, :], np.eye(system.layout.dofs) * (1.0 - free[:, None, :])
    masses = np.zeros((*found.shape, found.shape[2]))
    for k, time in enumerate(frames.times):
        found[k], masses[k] = inertia(frames.values[k], velocity[k], float(time))
    missing = found - forces[:, nodes]
    acceleration = -np.linalg.solve(masses * both + fixed, (free * missing)[..., None])
    return np.asarray((1.0 - free) * (missing + (masses @ acceleration)[..., 0]))


__all__ = ["held_nodes", "support_forces"]
