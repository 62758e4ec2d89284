"""The figures of a run, after Figures 3 to 5 of Leitz, Ober-Blöbaum and Leyendecker (2014)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from cayley.report.conserved import Array, load_free
from cayley.report.diagram import branches
from cayley.report.snapshots import deformed, nearest_frames, snapshots
from cayley.report.style import AXES, BLUE, GREEN, INK, MAP, SHADE, VERMILION, WIDTH, Drawing, style

__all__ = [
    "along",
    "balance",
    "branches",
    "deformed",
    "energy",
    "momenta",
    "over_time",
    "resultants",
    "snapshots",
]

_MOST_POINTS = 1500  # of a line: more than the figure has pixels


def energy(run: Any) -> Figure:
    """Kinetic, potential and total energy over the time.

    T, V, E = T + V [J]. The time in which loads other than gravity act is shaded.

    Args:
        run: a Trajectory.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), Figure 3.
    """
    lines = (
        (run.kinetic_energy.values, BLUE, "$T$ kinetic"),
        (run.potential_energy.values, VERMILION, "$V$ potential"),
        (run.energy.values, INK, "$E$ total"),
    )
    return _lines(run, lines, "energy [J]")


def balance(run: Any) -> Figure:
    """The balance of energy over the time: its change, work, loss, and what the steps lose or gain [J].

    Args:
        run: a Trajectory that kept account.

    Raises:
        ValueError: if it kept none.
    """
    own = run.energy_balance
    lines = (
        ((own.energy - own.energy[0]).values, BLUE, "change of energy"),
        (own.work.values, VERMILION, "work"),
        (own.dissipated.values, GREEN, "dissipated"),
        (own.defect.values, INK, "defect"),
    )
    return _lines(run, lines, "energy [J]")


def momenta(run: Any) -> Figure:
    """Linear and angular momentum over the time.

    Γ = ∫ ρ ẋ ds [kg m/s]; Π = ∫ (x × ρẋ + Λ(p) Jω) ds [kg m²/s], about the origin

    Args:
        run: a Trajectory.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), Figure 3.
    """
    time = run.energy["time"].values
    with style():
        figure = Drawing(figsize=(WIDTH, 4.2), layout="constrained")
        for axes, series, symbol, label in zip(
            figure.subplots(2, 1, sharex=True),
            (run.linear_momentum, run.angular_momentum),
            (r"\Gamma", r"\Pi"),
            ("linear\nmomentum [kg m/s]", "angular\nmomentum [kg m²/s]"),
            strict=True,
        ):
            _components(axes, time, series.transpose("time", "axis").values, symbol)
            _over_time(axes, run, label)
        figure.axes[1].set_xlabel("time [s]")
        figure.align_ylabels()
    return figure


def over_time(run: Any, part: Any, quantity: str, node: int | None = None) -> Figure:
    """A field of a part over the time, its components if it is a vector.

    Args:
        run: a Trajectory.
        part: a rod or body, or its name.
        quantity: a variable of `run[part]`, such as "moment".
        node: of a rod, or the number of the element where the field is one of elements; by default the middle one.

    Raises:
        KeyError: no such part or field.
    """
    data = field(run, part, quantity)
    place = next((dim for dim in ("node", "element") if dim in data.dims), None)
    where = ""
    if place:
        chosen = data.sizes[place] // 2 if node is None else node
        data, where = data.isel({place: chosen}), f", {place} {chosen % data.sizes[place]}"
    values = data.values.reshape(len(data["time"]), -1)
    names = component_names(data)
    with style():
        figure = Drawing(figsize=(WIDTH, 2.4), layout="constrained")
        axes = figure.subplots()
        for k, name in enumerate(names):
            _line(axes, data["time"].values, values[:, k], (*AXES, INK)[k], name)
        axes.set_title(f"{data.attrs['long_name']}{where}")
        _over_time(axes, run, labeled(quantity, data))
        axes.set_xlabel("time [s]")
    return figure


def along(run: Any, quantity: str, part: Any = None, times: Sequence[float] | None = None) -> Figure:
    """A field along a rod at some times, a panel for each component.

    Args:
        run: a Trajectory.
        quantity: a variable of `run[rod]`, such as "moment"; one of elements is drawn at their middle.
        part: a rod or its name; the first one by default.
        times: [s], of which the nearest saved ones are drawn; by default four of equal distance.

    Raises:
        KeyError: no such rod or field.
    """
    owner = run.model.name_of(run.model.rods[0]) if part is None else part
    data = field(run, owner, quantity)
    s = run[owner]["s"].values
    if "element" in data.dims:
        s = 0.5 * (s[1:] + s[:-1])
    frames = nearest_frames(data["time"].values, times)
    names = component_names(data)
    values = data.isel(time=frames).values.reshape(len(frames), len(s), -1)
    colors = colormaps[MAP](np.linspace(0.0, 0.85, len(frames)))
    with style():
        figure = Drawing(figsize=(WIDTH, 0.7 + 1.5 * len(names)), layout="constrained")
        grid = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for c, axes in enumerate(grid):
            for k, frame in enumerate(frames):
                axes.plot(s, values[k, :, c], color=colors[k], label=f"$t$ = {float(data['time'][frame]):.3g} s")
            axes.set_ylabel(labeled(names[c], data))
        grid[0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        grid[0].set_title(data.attrs["long_name"])
        grid[-1].set_xlabel("arc length [m]")
        figure.align_ylabels()
    return figure


def resultants(run: Any, rod: Any = None, nodes: Sequence[int] | None = None, *, impulse: bool = False) -> Figure:
    """Stress resultants over the time at some nodes of a rod.

    σ = ∂L/∂x′, in space [N];  Σ = ∂L/∂Ω, about the body axes [N m]

    Args:
        run: a Trajectory.
        rod: a rod or its name; the first one by default.
        nodes: node numbers; by default the first, the middle and the last.
        impulse: the discrete momenta over one step instead, as in the paper's figure [N s, N m s].

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), Figure 5.
    """
    data = run[run.model.name_of(run.model.rods[0]) if rod is None else rod]
    last = data.sizes["node"] - 1
    chosen = default_nodes(last) if nodes is None else tuple(nodes)
    suffix, force, moment = ("_impulse", "N s", "N m s") if impulse else ("", "N", "N m")
    time = data["time"].values
    with style():
        figure = Drawing(figsize=(WIDTH, 0.5 + 1.65 * len(chosen)), layout="constrained")
        grid = figure.subplots(len(chosen), 2, sharex=True, squeeze=False)
        for column, name, symbol, unit in ((0, "sigma", r"\sigma", force), (1, "Sigma", r"\Sigma", moment)):
            values = data[name + suffix].isel(node=list(chosen)).transpose("node", "time", "axis").values
            largest = float(np.abs(values).max())
            for k, node in enumerate(chosen):
                axes = grid[k, column]
                _components(axes, time, values[k], symbol)
                axes.set_ylabel(f"${symbol}$ at node {node % (last + 1)} [{unit}]")
                _shade_loads(axes, run)
                if np.abs(values[k]).max() <= 1e-9 * largest:  # zero up to rounding, and drawn as zero
                    axes.set_ylim(-largest or -1.0, largest or 1.0)
        for axes in grid[-1]:
            axes.set_xlabel("time [s]")
            axes.set_xlim(time[0], time[-1])
        for axes in grid[0]:
            axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.99), ncols=3, borderaxespad=0.0, columnspacing=1.2)
        figure.align_ylabels()
    return figure


def field(run: Any, part: Any, quantity: str) -> Any:
    """A variable of a part.

    Raises:
        KeyError: there is none of this name.
    """
    data = run[part]
    if quantity not in data:
        raise KeyError(f"{data.attrs['name']} has no {quantity!r}; it has {', '.join(map(str, data.data_vars))}")
    return data[quantity]


def component_names(data: Any) -> list[str]:
    """Names of the components of a field."""
    return [str(data.name)] if data.dims[-1] not in ("axis", "wxyz") else data[data.dims[-1]].values.tolist()


def labeled(name: str, data: Any) -> str:
    """A name with the unit of a field."""
    unit = data.attrs["units"]
    return name if unit == "1" else f"{name} [{unit}]"


def default_nodes(last: int) -> tuple[int, ...]:
    """First, middle and last node."""
    return tuple(sorted({0, last // 2, last}))


def _lines(run: Any, lines: Sequence[tuple[Array, str, str]], label: str) -> Figure:
    """One panel over the time."""
    with style():
        figure = Drawing(figsize=(WIDTH, 2.4), layout="constrained")
        axes = figure.subplots()
        for values, color, name in lines:
            _line(axes, run.energy["time"].values, values, color, name)
        _over_time(axes, run, label)
        axes.set_xlabel("time [s]")
    return figure


def _over_time(axes: Axes, run: Any, label: str) -> None:
    """What all panels over the time have."""
    time = run.energy["time"].values
    axes.set_ylabel(label)
    axes.set_xlim(time[0], time[-1])
    _shade_loads(axes, run)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def _components(axes: Axes, time: Array, values: Array, symbol: str) -> None:
    for k, color in enumerate(AXES):
        _line(axes, time, values[:, k], color, f"${symbol}_{k + 1}$")


def _line(axes: Axes, time: Array, values: Array, color: str, label: str) -> None:
    shown = thinned(values)
    axes.plot(time[shown], values[shown], color=color, label=label)


def thinned(values: Array) -> NDArray[np.intp]:
    """Indices of the frames to draw: all, or the least and the greatest of each of many equal pieces.

    So a fast oscillation keeps its envelope, and the figure stays small.
    """
    count = len(values)
    if count <= _MOST_POINTS:
        return np.arange(count)
    edges = np.linspace(0, count, _MOST_POINTS // 2 + 1).astype(int)
    extremes = [start + pick(values[start:stop]) for start, stop in pairwise(edges) for pick in (np.argmin, np.argmax)]
    return np.unique([0, *extremes, count - 1])


def _shade_loads(axes: Axes, run: Any) -> None:
    time = run.energy["time"].values
    window = load_free(run)
    if window.free and not window.frames.all():
        axes.axvspan(time[0], time[window.frames][0], color=SHADE, linewidth=0.0, zorder=0)
