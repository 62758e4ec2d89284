"""What saved frames say of contacts."""

import warnings
from typing import Any

import numpy as np

from cayley.results.frames import Frames
from cayley.steppers.contacts import TOLD
from cayley.system.system import System


class ContactDepthWarning(UserWarning):
    """Parts sank into each other much deeper than wanted."""


def contact_energy(frames: Frames) -> np.ndarray | float:
    """Energy of contacts [J], that of sticking friction with it, shape (m,); 0 where nothing touches."""
    return 0.0 if frames.contact is None else frames.contact[:, 0]


def contact_forces(system: System, frames: Frames) -> np.ndarray | float:
    """Forces of contacts on the nodes: body moments and forces in space, shape (m, nodes, dofs); 0 without contact."""
    if frames.contact is None:
        return 0.0
    return frames.contact[:, TOLD:].reshape(len(frames.times), system.size, system.layout.dofs)


def forces_on_nodes(run: Any, nodes: slice) -> np.ndarray | None:
    """Forces of contacts on some nodes, in space [N], shape (frames, nodes, 3); None without contact."""
    if run.frames.contact is None:
        return None
    layout = run.outline.layout
    forces = run.frames.contact[:, TOLD:].reshape(len(run.time), -1, layout.dofs)
    found: np.ndarray = forces[:, nodes, layout.dofs_of("x")]
    return found


def warn_of_depth(run: Any) -> None:
    """Warn if parts sank in much deeper than wanted, unless their stiffness was given."""
    if run.frames.contact is None or run.model is None or run.model.contact is None:
        return
    if run.model.contact.stiffness is not None:
        return
    deepest, wanted = float(run.frames.contact[:, 6].max()), run.model.contact.deepest
    if deepest > wanted:
        warnings.warn(
            f"parts sank {deepest:.2g} radii into each other, over the impact_depth of {wanted:g}; leave dt out or "
            "give a smaller dt, with which contacts are stiffer, or give the Contact a stiffness [N/m], or a larger "
            "impact_depth if that is good enough",
            ContactDepthWarning,
            stacklevel=5,
        )


__all__ = ["ContactDepthWarning", "contact_energy", "contact_forces", "forces_on_nodes", "warn_of_depth"]
