"""What saved frames say of contacts."""

import numpy as np

from cayley.results.frames import Frames
from cayley.steppers.contacts import TOLD
from cayley.system.system import System


def contact_energy(frames: Frames) -> np.ndarray | float:
    """Energy of contacts [J], that of sticking friction with it, shape (m,); 0 where nothing touches."""
    return 0.0 if frames.contact is None else frames.contact[:, 0]


def contact_forces(system: System, frames: Frames) -> np.ndarray | float:
    """Forces of contacts on the nodes: body moments and forces in space, shape (m, nodes, dofs); 0 without contact."""
    if frames.contact is None:
        return 0.0
    return frames.contact[:, TOLD:].reshape(len(frames.times), system.size, system.layout.dofs)
