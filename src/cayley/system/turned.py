"""Systems whose rotations are stored as matrices, seen as those of unit quaternions.

Implicit rules interpolate in the embedding space of quaternions, where matrices would need a polar decomposition at
every point, and joints and springs are written for them: where either is, quaternions are stepped and matrices saved.
"""

from dataclasses import replace

import numpy as np

from cayley.codegen.kernels import Kernels
from cayley.discrete.equations import derive
from cayley.discrete.layout import Layout
from cayley.system.system import LoadEntries, System


def embedded(system: System) -> System:
    """The same system with rotations as unit quaternions; the same object for every call."""
    if system.layout.representation.name == "quaternion":
        return system
    if "embedded" not in system.plans:
        equations = system.equations
        made = derive(equations.density, equations.rule, varying=equations.varying, account=equations.forced)
        kernels = Kernels(made, system.kernels.lanes)
        inner = replace(system, equations=made, kernels=kernels, loads=_turned_loads(system, made.layout))
        reference = as_quaternions(system.layout, system.reference)
        system.plans["embedded"] = replace(inner, reference=reference)
    found: System = system.plans["embedded"]
    return found


def as_quaternions(layout: Layout, values: np.ndarray) -> np.ndarray:
    """Values of nodes with quaternions for the rotations of a layout, shape (..., nodes, rows)."""
    parts = [values[..., layout.rows_of(name)] for name in layout.fields]
    for k, name in enumerate(layout.fields):
        if name in layout.rotations:
            parts[k] = layout.representation.to_quaternion(parts[k])
    return np.concatenate(parts, axis=-1)


def from_quaternions(layout: Layout, inner: Layout, values: np.ndarray) -> np.ndarray:
    """The other way round: values by the layout of quaternions ``inner`` as those of a layout."""
    parts = [values[..., inner.rows_of(name)] for name in layout.fields]
    for k, name in enumerate(layout.fields):
        if name in layout.rotations:
            parts[k] = layout.representation.from_quaternion(parts[k])
    return np.concatenate(parts, axis=-1)


def _turned_loads(system: System, layout: Layout) -> LoadEntries | None:
    """Loads with the rows of the other form."""
    if system.loads is None:
        return None
    row = {system.layout.rows_of(name).start: layout.rows_of(name).start for name in layout.rotations}
    return replace(system.loads, turn=np.array([row[int(turn)] for turn in system.loads.turn], dtype=np.int64))


__all__ = ["as_quaternions", "embedded", "from_quaternions"]
