"""Figures of modes: shapes, Campbell diagrams and frequency responses."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from cayley.lie import quaternion
from cayley.report.bodies import body_shape
from cayley.report.style import BLUE, GRID, INK, MUTED, SHADOW, VERMILION, WIDTH, style
from cayley.report.swing import extent, swing
from cayley.report.view import seen

__all__ = ["campbell", "mode_shapes", "response"]

_RIB = 0.04  # length of the ribs that show how sections turn, over the extent
_COLUMNS = 3
_MOST = 12
_MOST_ORDERS = 6


def mode_shapes(modes: Any, count: int = 6) -> Figure:
    """The lowest modes at one end of their motion, over the equilibrium in gray and the other end in a lighter color.

    Args:
        modes: Modes.
        count: how many, at most 12.
    """
    shown = min(count, _MOST, len(modes))
    rib = _RIB * extent(modes.about)
    rest = _lines(modes.about.frame, 0, rib)
    runs = [swing(modes, k, 2) for k in range(shown)]
    drawn = [[(rest, SHADOW, 1.0), (_lines(run, 1, rib), GRID, 1.0), (_lines(run, 0, rib), BLUE, 1.6)] for run in runs]
    flat = np.concatenate([ends.reshape(-1, 2) for one in drawn for lines, _, _ in one for ends, _ in lines])
    low, high = flat.min(axis=0), flat.max(axis=0)
    low, high = low - 0.05 * np.ptp(flat, axis=0).max(), high + 0.05 * np.ptp(flat, axis=0).max()
    rows = -(-shown // _COLUMNS)
    tall = min(3.2, max(1.0, WIDTH / _COLUMNS * (high[1] - low[1]) / (high[0] - low[0])))
    with style():
        figure = Figure(figsize=(WIDTH, (tall + 0.3) * rows), layout="constrained")
        grid = figure.subplots(rows, min(_COLUMNS, shown), squeeze=False)
        for axes in grid.flat:
            axes.set_axis_off()
        for k in range(shown):
            axes = grid[k // _COLUMNS, k % _COLUMNS]
            for lines, color, width in drawn[k]:
                for ends, part in lines:
                    found = LineCollection(ends, colors=color, linewidths=part * width, capstyle="round")
                    axes.add_collection(found)
            axes.set_title(f"{k}: {float(modes.frequency[k]):.4g} Hz", color=INK)
            axes.set_xlim(low[0], high[0])
            axes.set_ylim(low[1], high[1])
            axes.set_aspect("equal")
    return figure


def campbell(diagram: Any, orders: int = 4) -> Figure:
    """Frequencies over the speed of turning, with the lines k × speed: 1P, 2P, ...

    Args:
        diagram: a Campbell, from cy.campbell.
        orders: how many lines, at most 6.
    """
    speed, curves = diagram.speed / (2.0 * np.pi), diagram.frequency.values
    with style():
        figure = Figure(figsize=(WIDTH, 4.2), layout="constrained")
        axes = figure.subplots()
        top = 1.08 * float(curves.max(initial=0.0)) or 1.0
        for k in range(1, min(orders, _MOST_ORDERS) + 1):
            axes.plot(speed, k * np.abs(speed), color=MUTED, linewidth=0.7, linestyle=(0, (4, 3)))
            at = min(speed[-1], top / k)
            inside = at < speed[-1]
            axes.annotate(
                f"{k}P", (at, k * at), xytext=(-2, -9) if inside else (3, -3), textcoords="offset points", color=MUTED
            )
        for k, curve in enumerate(curves.T):
            axes.plot(speed, curve, color=BLUE, linewidth=1.4)
            axes.annotate(
                f"{k}", (speed[-1], curve[-1]), xytext=(18, -3), textcoords="offset points", color=BLUE, clip_on=False
            )
        unstable = diagram.eigenvalue.real > 0.0
        if unstable.any():
            rows, columns = np.nonzero(unstable)
            axes.plot(speed[rows], curves[rows, columns], "o", color=VERMILION, markersize=4, label="unstable")
            axes.legend(loc="upper left")
        axes.set_xlim(speed[0], speed[-1])
        axes.set_ylim(0.0, top)
        axes.set_xlabel("speed [turns/s]")
        axes.set_ylabel("frequency in the turning frame [Hz]")
    return figure


def response(answer: Any, axis: str = "z") -> Figure:
    """Amplitude and phase of a displacement over the frequency.

    Args:
        answer: a Dataset of a port or body from cy.frequency_response.
        axis: "x", "y" or "z".
    """
    values = answer["displacement"].sel(axis=axis).values
    hertz = answer["frequency"].values
    with style():
        figure = Figure(figsize=(WIDTH, 4.2), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        upper.semilogy(hertz, np.abs(values), color=BLUE)
        upper.set_ylabel(f"amplitude along {axis} [m]")
        lower.plot(hertz, np.degrees(np.angle(values)), color=BLUE)
        lower.set_yticks([-180, -90, 0, 90, 180])
        lower.set_ylabel("phase [°]")
        lower.set_xlabel("frequency [Hz]")
        lower.set_xlim(hertz[0], hertz[-1])
    return figure


def _lines(run: Any, frame: int, rib: float) -> list[tuple[Any, float]]:
    """Lines in the picture that show a run at a frame, ends of shape (n, 2, 2), with their relative widths."""
    found = []
    for rod in run.model.rods:
        data = run[rod]
        place, turn = data["position"].values[frame], data["rotation"].values[frame]
        tips = place + np.asarray(quaternion.rotate(turn, np.array([rib, 0.0, 0.0])), dtype=float)
        found += [(np.stack([place[:-1], place[1:]], axis=1), 1.0), (np.stack([place, tips], axis=1), 0.5)]
    for part in (*run.model.bodies, *run.model.own_parts):
        shape = body_shape(run, part, [frame])
        dot = np.stack([shape.center, shape.center], axis=1)  # all there is of a point mass
        found.append((np.concatenate([shape.edges[0], shape.arms[0], dot]), 0.6))
    return [(seen(ends), width) for ends, width in found]
