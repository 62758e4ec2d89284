"""The figures of a run, after Figures 3 to 5 of Leitz, Ober-Blöbaum and Leyendecker (2014)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from cayley.report.conserved import Array, load_free
from cayley.report.diagram import branches
from cayley.report.snapshots import deformed, snapshots
from cayley.report.style import AXES, BLUE, INK, SHADE, VERMILION, WIDTH, style

__all__ = ["branches", "deformed", "energies", "resultants", "snapshots"]

_MOST_POINTS = 1500  # of a line: more than the figure has pixels


def energies(run: Any) -> Figure:
    """Energies, linear and angular momentum over the time.

    T, V, E = T + V [J]; Γ = ∫ ρ ẋ ds [kg m/s]; Π = ∫ (x × ρẋ + Λ(p) Jω) ds [kg m²/s], about the origin

    The time in which loads other than gravity act is shaded.

    Args:
        run: a Trajectory.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), Figure 3.
    """
    time = run.energy["time"].values
    linear, angular = (
        series.transpose("time", "axis").values for series in (run.linear_momentum, run.angular_momentum)
    )
    with style():
        figure = Figure(figsize=(WIDTH, 6.2), layout="constrained")
        top, middle, bottom = figure.subplots(3, 1, sharex=True)
        for values, color, label in (
            (run.kinetic_energy.values, BLUE, "$T$ kinetic"),
            (run.potential_energy.values, VERMILION, "$V$ potential"),
            (run.energy.values, INK, "$E$ total"),
        ):
            _line(top, time, values, color, label)
        _components(middle, time, linear, r"\Gamma")
        _components(bottom, time, angular, r"\Pi")
        for axes, label in (
            (top, "energy [J]"),
            (middle, "linear\nmomentum [kg m/s]"),
            (bottom, "angular\nmomentum [kg m²/s]"),
        ):
            axes.set_ylabel(label)
            _shade_loads(axes, run)
            axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        bottom.set_xlabel("time [s]")
        bottom.set_xlim(time[0], time[-1])
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
        figure = Figure(figsize=(WIDTH, 0.5 + 1.65 * len(chosen)), layout="constrained")
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


def default_nodes(last: int) -> tuple[int, ...]:
    """First, middle and last node."""
    return tuple(sorted({0, last // 2, last}))


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
