"""What a run should conserve, and how well it did; needs no Matplotlib."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cayley.discrete.rules import by_name
from cayley.model import Model
from cayley.model.loads import Gravity

Array = NDArray[np.float64]
Flags = tuple[bool, bool, bool]


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the table.

    Attributes:
        quantity: what was measured.
        value: the number, as text.
        unit: of the number.
        note: what else there is to say; empty if nothing.
    """

    quantity: str
    value: str
    unit: str
    note: str = ""


@dataclass(frozen=True, slots=True)
class Window:
    """The part of a run in which no load but gravity acts.

    Attributes:
        frames: which saved frames are in it, shape (m,); all of them if there is no such part.
        text: how the table calls it.
        free: whether there is such a part.
    """

    frames: NDArray[np.bool_]
    text: str
    free: bool


def conservation(run: Any) -> list[Row]:
    """The figures of conservation and of speed of a run.

    Energy: mean, ripple (max - min) and drift (slope of the line of least squares times the length of the window);
    momenta: spread (max - min) of each component that a symmetry of the model preserves.

    Args:
        run: a Trajectory.

    Returns: the rows of the table, energies in J, momenta in kg m/s and kg m²/s.
    """
    window = load_free(run)
    rows = _energy_rows(run, window) + _balance_rows(run)
    rows += _momentum_rows(run, window) if run.only is None else []
    defect = quaternion_defect(run)
    if defect is not None:
        rows.append(Row("quaternion length, largest error", f"{defect:.1e}", "", "all frames"))
    return rows + _speed_rows(run)


def load_free(run: Any) -> Window:
    """The part of a run after the last load has ended."""
    time = run.energy["time"].values
    loads = [] if run.model is None else [load for load in run.model.loads if not isinstance(load, Gravity)]
    if run.model is not None and _works_always(run.model):
        return Window(np.ones(len(time), dtype=bool), "whole run, a drive, damper or contact works", False)
    if run.model is None and run.accounted:
        return Window(np.ones(len(time), dtype=bool), "whole run, forces act", False)
    end = max((load.until for load in loads), default=-np.inf)
    # the last impulse of a load is spread over half a step on either side
    frames = time >= end + run.dt
    if not loads:
        return Window(frames, f"t = {time[0]:g} to {time[-1]:g} s", True)
    if np.count_nonzero(frames) < 3:
        return Window(np.ones(len(time), dtype=bool), "whole run, loads act", False)
    return Window(frames, f"t = {end:g} to {time[-1]:g} s, no loads", True)


def saved_parts(run: Any) -> list[str]:
    """Names of the parts of a run of a model: those that were saved, where it saved some only."""
    names: list[str] = list(run.model.names)
    return names if run.only is None else [name for name in names if name in run._parts]


def quaternion_defect(run: Any) -> float | None:
    """Largest | ‖p‖ - 1 | of all rotations at all frames; None without rotations."""
    if run.model is None:
        rotations = [
            values for values in run.data.data_vars.values() if "wxyz" in values.dims and "_" not in values.name
        ]
    else:
        rotations = [run[name].rotation for name in saved_parts(run)]
    lengths = [np.linalg.norm(values.transpose(..., "wxyz").values, axis=-1) for values in rotations]
    return max((float(np.abs(length - 1.0).max()) for length in lengths), default=None)


def preserved(model: Model) -> tuple[Flags, Flags]:
    """Which components of linear and of angular momentum (about the origin) the supports and gravity leave alone.

    A component of linear momentum stays if no support holds that component and gravity has none. One of angular
    momentum, about the axis e through the origin, stays if gravity is along e and no support turns about e: a held
    position does not if its force passes through the axis or is parallel to it. Loads are not looked at. A joint or
    spring of two parts, or their contact, leaves all alone; one to the ground, an obstacle fixed in space, and a
    Lagrangian of one's own, is taken to leave nothing.
    """
    fixed = any(tie.grounded for tie in model.ties) or any(obstacle.on is None for obstacle in model.obstacles)
    if model.own_parts or fixed:
        return (False, False, False), (False, False, False)
    gravity = sum((np.array(load.acceleration) for load in model.loads if isinstance(load, Gravity)), start=np.zeros(3))
    linear, angular = [], []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        linear.append(gravity[i] == 0.0 and not any(support.held_position[i] for support in model.supports))
        stays = gravity[j] == 0.0 and gravity[k] == 0.0
        for support in model.supports:
            place = support.port.part.place(support.port.node)[0]
            # force F at x has the moment x_j F_k - x_k F_j about e_i
            lever = (support.held_position[k] and abs(place[j]) > 1e-12) or (
                support.held_position[j] and abs(place[k]) > 1e-12
            )
            stays = stays and not lever and not any(support.held_rotation)
        angular.append(bool(stays))
    return _flags(linear), _flags(angular)


def _works_always(model: Model) -> bool:
    """Whether joints are driven or springs, rods, contacts or Lagrangians of one's own damped, all the time."""
    if model.contact is not None and (model.contact.damping or _rubs(model)):
        return True
    if any(rod.damping is not None for rod in model.rods) or any(part.lagrangian.force for part in model.own_parts):
        return True
    return any(joint.driven for joint in model.connections) or any(np.any(spring.damping) for spring in model.springs)


def _rubs(model: Model) -> bool:
    """Whether there is friction anywhere."""
    assert model.contact is not None
    return any((model.contact.friction, *(obstacle.friction for obstacle in model.obstacles)))


def _flags(values: list[Any]) -> Flags:
    return (bool(values[0]), bool(values[1]), bool(values[2]))


def _energy_rows(run: Any, window: Window) -> list[Row]:
    if not window.free:
        return [Row("energy and momenta", "not judged", "", "loads, drives, damping or contact act to the end")]
    time, energy = run.energy["time"].values[window.frames], run.energy.values[window.frames]
    largest = float(run.kinetic_energy.values.max())

    def relative(value: float) -> str:
        return f"{abs(value) / largest:.1e} of max T" if largest > 0.0 else ""

    ripple = float(np.ptp(energy))
    slope = float(np.polyfit(time - time.mean(), energy, 1)[0]) if len(time) > 1 else 0.0
    drift = slope * float(np.ptp(time))
    return [
        Row("energy, mean", f"{energy.mean():.6g}", "J", window.text),
        Row("energy, ripple (max - min)", f"{ripple:.1e}", "J", relative(ripple)),
        Row("energy, drift", f"{drift:+.1e}", "J", relative(drift)),
    ]


def _balance_rows(run: Any) -> list[Row]:
    """Work and loss, and what is left of the balance of energy, where a run kept account."""
    if not run.accounted:
        return []
    defect = np.abs(run.energy_balance.defect.values).max()
    largest = float(run.kinetic_energy.values.max())
    relative = f"{defect / largest:.1e} of max T" if largest > 0.0 else ""
    return [
        Row("work of loads", f"{float(run.work[-1]):.6g}", "J"),
        Row("dissipated", f"{float(run.dissipated[-1]):.6g}", "J"),
        Row("energy balance, largest defect", f"{defect:.1e}", "J", relative),
    ]


def _momentum_rows(run: Any, window: Window) -> list[Row]:
    """A row for each component that should stay; all six where there is no model to tell."""
    every = (True, True, True)
    kept = (every, every) if run.model is None else preserved(run.model)
    if not window.free:
        return []
    rows = []
    for name, unit, series, flags in (
        ("linear momentum", "kg m/s", run.linear_momentum, kept[0]),
        ("angular momentum", "kg m²/s", run.angular_momentum, kept[1]),
    ):
        values = series.transpose("time", "axis").values[window.frames]
        for i, axis in enumerate("xyz"):
            if flags[i]:
                spread = float(np.ptp(values[:, i]))
                rows.append(Row(f"{name} {axis}, spread", f"{spread:.1e}", unit, f"mean {values[:, i].mean():.6g}"))
    return rows or [Row("momenta", "none is conserved", "", "gravity or a support acts on each component")]


def _speed_rows(run: Any) -> list[Row]:
    if run.model is None:
        nodes = int(run.data.sizes.get("node", 1))
    else:
        nodes = sum((part.node_count - 1) * by_name(run.rule).degree + 1 for part in run.model.parts)
    each = run.wall_time / max(run.steps * nodes, 1) * 1e9
    return [
        Row("step", f"{run.dt:.6g}", "s", f"rule {run.rule}"),
        Row("steps", f"{run.steps}", ""),
        Row("time of integration", f"{run.wall_time:.3g}", "s", "without compilation"),
        Row("time per node and step", f"{each:.1f}", "ns", f"{nodes} node{'' if nodes == 1 else 's'}"),
    ]
