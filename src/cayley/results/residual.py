"""How fast what was run still moves."""

from collections.abc import Mapping

import numpy as np

from cayley.model import Model, Rod
from cayley.system.legendre import velocities_of
from cayley.system.system import State, System


def residual_speed(system: System, state: State, model: Model | None, parts: Mapping[str, slice]) -> float:
    """Largest speed of a node over the length of its rod, of other nodes over the extent of all [1/s].

    max over nodes of ‖ẋ‖/L, with rotations left out

    Args:
        system: the system.
        state: where it is, with its momenta.
        model: the model it is of, if any.
        parts: nodes of the parts by name.
    """
    layout = system.layout
    moving = [name for name in layout.fields if name not in layout.rotations]
    rates = velocities_of(system, state)
    speed = np.linalg.norm(
        np.hstack([np.zeros((len(rates), 0)), *(rates[:, layout.dofs_of(n)] for n in moving)]), axis=1
    )
    places = np.hstack([np.zeros((len(rates), 0)), *(state.values[:, layout.rows_of(n)] for n in moving)])
    length = np.full(len(speed), float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0)
    for name, part in zip(model.names, model.parts, strict=True) if model is not None else ():
        if isinstance(part, Rod):
            length[parts[name]] = part.length
    return float((speed / length).max(initial=0.0))
