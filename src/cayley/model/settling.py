"""Damping that brings a model to rest, of a rate that fits its slowest motion."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from cayley.model import validate
from cayley.model.loads import Gravity
from cayley.model.model import Model
from cayley.model.rod import Rod
from cayley.model.rod_loads import Decay

__all__ = ["settling", "slowest_frequency"]

TOUCHING = 0.5
"""Part of critical damping that contacts are given at least."""
CANTILEVER = 3.516
"""ω L² √(m/EI) of the first mode of a cantilever."""
EASE, EASED = 100.0, 0.3
"""How much more damping there is at first, and for how long, in 1/α."""


def settling(model: Model, rate: float | None = None) -> Model:
    """The model with damping −α m ẋ, −α J ω on all its rods, and contacts that do not bounce.

    Args:
        model: the model.
        rate: α [1/s]; None: twice the slowest frequency, critical for that motion, and EASE times as much until
            EASED/α where nothing is driven: what is not quite at rest at the start does not make waves.

    Raises:
        ValueError: no rods, or a rate that is not positive.
    """
    if not model.rods:
        raise ValueError("settling damps rods, and the model has none; give its bodies dampers, such as springs.linear")
    alpha = 2.0 * slowest_frequency(model) if rate is None else validate.positive("settling", "rate", rate, "1/s")
    more = [Decay(rod=rod, rate=alpha) for rod in model.rods]
    if rate is None and not any(joint.driven for joint in model.connections):
        more += [Decay(rod=rod, rate=EASE * alpha, until=EASED / alpha) for rod in model.rods]
    contact = model.contact
    if contact is not None and contact.damping < TOUCHING:
        contact = replace(contact, damping=TOUCHING)
    return model.replace(loads=(*model.loads, *more), contact=contact)


def slowest_frequency(model: Model) -> float:
    """Estimate of the slowest angular frequency [rad/s]: of a cantilever, or of a pendulum where that is faster.

    ω = min over rods of max(3.516 √(EI/m)/L², √(g/L)), with L the length of all rods that are tied together.

    Raises:
        ValueError: no rods.
    """
    g = np.linalg.norm(sum((load.at(0.0) for load in model.loads if isinstance(load, Gravity)), start=np.zeros(3)))
    return min(
        max(CANTILEVER * math.sqrt(_softness(rod)) / length**2, math.sqrt(float(g) / length))
        for rod, length in zip(model.rods, _tied_lengths(model), strict=True)
    )


def _softness(rod: Rod) -> float:
    """Least EI/m of a rod [m⁴/s²]."""
    return min(
        float(np.linalg.eigvalsh(section.stiffness[3:5, 3:5])[0]) / section.mass_per_length
        for section in dict.fromkeys(rod.sections)
    )


def _tied_lengths(model: Model) -> list[float]:
    """For each rod the length of all rods that it hangs together with by joints and springs [m]."""
    parts = list(model.parts)
    group = {id(part): k for k, part in enumerate(parts)}
    for tie in model.ties:
        joined = {group[id(port.part)] for port in tie.ports}
        group = {part: min(joined) if k in joined else k for part, k in group.items()}
    lengths: dict[int, float] = {}
    for rod in model.rods:
        lengths[group[id(rod)]] = lengths.get(group[id(rod)], 0.0) + rod.length
    return [lengths[group[id(rod)]] for rod in model.rods]
