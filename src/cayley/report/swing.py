"""A mode in motion: its period as the frames of a run, displaced far enough to be seen."""

from __future__ import annotations

from typing import Any

import numpy as np

from cayley.report.bodies import body_shape
from cayley.report.conserved import Array
from cayley.results.frames import Frames
from cayley.results.trajectory import Trajectory

SHOWN, TURN = 0.12, 0.5
"""Largest displacement over the extent of the model, and largest rotation [rad]: as far as the first of them."""


def swing(modes: Any, k: int, count: int) -> Trajectory:
    """The equilibrium displaced along a mode, v = Re(a φ e^(iα)), at the phases α = 2π j/count, j = 0 … count.

    Times are those of one period, without decay; of a mode that has none, one second.

    Args:
        modes: Modes.
        k: the mode, from 0.
        count: phases of the period.
    """
    rest, size, hertz = modes.about, shown(modes, k), float(modes.frequency[k])
    back = np.isrealobj(modes.pairs.vectors)  # then it comes back as it went
    phases = [min(j, count - j) if back else j % count for j in range(count + 1)]
    states = {j: modes.state(k, size, 2.0 * np.pi * j / count) for j in sorted(set(phases))}
    times = np.linspace(0.0, 1.0 / hertz if hertz > 0.0 else 1.0, count + 1)
    frames = Frames(
        times=times,
        steps=np.arange(count + 1),
        values=np.stack([states[j].values for j in phases]),
        momenta=np.stack([states[j].momenta for j in phases]),
        origin=0.0,
        h=float(times[1]),
    )
    made, info = rest.frame, {"wall_time": 0.0}
    return Trajectory(frames=frames, info=info, system=made.system, model=made.model, parts=made._parts)


def shown(modes: Any, k: int) -> float:
    """The amplitude of a mode, as Modes.state takes it, that looks large enough [m], or [rad] if it only turns."""
    shift, turn = modes.sizes(k)
    most = [(SHOWN * extent(modes.about), shift), (TURN, turn)]
    return min(limit / size for limit, size in most if size > 0.0) * float(shift or turn)


def extent(rest: Any) -> float:
    """Longest side of the box around all parts of an equilibrium [m]; 1 where all is at one place."""
    model = rest.model
    points = [rest[rod]["position"].values for rod in model.rods]
    points += [body_shape(rest.frame, part, [0]).points for part in (*model.bodies, *model.own_parts)]
    sides: Array = np.ptp(np.concatenate(points), axis=0)
    return float(sides.max()) or 1.0
