"""The scene of a run of a Lagrangian of one's own: its fields as points, curves and frames, or over the time."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest
from typing import Any

import numpy as np

from cayley.report.conserved import Array
from cayley.report.scene import Block, Graph, Quantity, Strand

THIN = 0.005
"""Half of the diagonal of what chains without a cross-section are drawn with, over their length."""
_SQUARE = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
_BAND = np.array([(1.0, 0.2), (-1.0, 0.2), (-1.0, -0.2), (1.0, -0.2)])  # of rotations alone: it shows how they turn
_BOX, _APART = (0.8, 0.5, 0.2), 1.6  # m; of a rotation without a place, and between several
_ARMS = {"e1": (0.6, 0.0, 0.0), "e2": (0.0, 0.6, 0.0), "e3": (0.0, 0.0, 0.6)}


def field_parts(run: Any, frames: slice) -> Iterator[Strand | Block]:
    """Vectors of three components as points or, on an interval, curves, with the rotations as their frames.

    The first rotation stands at the first vector, and so on. One that is left over has no place: it is shown near the
    origin, on an interval along e3.

    Args:
        run: a Trajectory without a model.
        frames: which of them.
    """
    nodes = run.outline.nodes
    for k, (vector, rotation) in enumerate(zip_longest(run._vectors(), run.outline.layout.rotations)):
        shape = (len(run.time[frames]), len(nodes))
        position, turn = np.zeros((*shape, 3)), np.zeros((*shape, 4))
        position[..., 0], position[..., 2], turn[..., 0] = _APART * k, nodes, 1.0
        if vector is not None:
            position = run._values(vector)[frames]
        if rotation is not None:
            turn = run._rotation(rotation)[frames]
        shared: dict[str, Any] = {
            "name": ", ".join(name for name in (vector, rotation) if name is not None),
            "position": position,
            "rotation": turn,
            "quantities": _speeds(run, vector, rotation, frames),
        }
        if run.outline.interval is not None:
            outline = THIN * np.ptp(nodes) * (_SQUARE if vector is not None else 4.0 * _BAND)
            yield Strand(**shared, outlines=outline[None], s=nodes - nodes[0])
        elif vector is None:
            yield Block(**shared, sides=np.array(_BOX), ports=_ARMS)
        else:
            yield Block(**shared)


def field_graphs(run: Any, frames: slice) -> Iterator[Graph]:
    """Fields that have no place in space over the time, on an interval at its first, middle and last node."""
    nodes, layout = run.outline.nodes, run.outline.layout
    chosen = sorted({0, len(nodes) // 2, len(nodes) - 1})
    for name in layout.fields:
        if name in layout.rotations or name in run._vectors():
            continue
        values = run._values(name)[frames][:, chosen]
        width = values.shape[2]
        own = [name] if width == 1 else [f"{name}_{k + 1}" for k in range(width)]
        at = [""] if run.outline.interval is None else [f" at {run.outline.interval} = {nodes[k]:.3g}" for k in chosen]
        names = tuple(f"{one}{place}" for place in at for one in own)
        yield Graph(title=f"Field {name}", unit="1", names=names, values=values.reshape(len(values), -1))


def _speeds(run: Any, vector: str | None, rotation: str | None, frames: slice) -> dict[str, Quantity]:
    """Speed and angular speed at the nodes."""
    found = {}
    for field, key, label, unit in (
        (vector, "speed", "speed", "m/s"),
        (rotation, "spin", "angular speed", "rad/s"),
    ):
        if field is not None:
            rates: Array = run.observed.velocity[frames][..., run.outline.layout.dofs_of(field)]
            found[key] = Quantity(label=label, unit=unit, values=np.linalg.norm(rates, axis=-1))
    return found
