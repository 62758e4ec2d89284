"""Figures of modes: shapes, Campbell diagrams and frequency responses."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from cayley.report.skeleton import BODY, ROD, TICK, Skeleton
from cayley.report.style import BLUE, GRID, INK, MUTED, SHADOW, VERMILION, WIDTH, style

__all__ = ["campbell", "mode_shapes", "response"]

_AZIMUTH, _ELEVATION = np.radians(-60.0), np.radians(18.0)  # of the eye, as in the snapshots
_VIEW = np.array(
    [
        [-np.sin(_AZIMUTH), np.cos(_AZIMUTH), 0.0],
        [-np.sin(_ELEVATION) * np.cos(_AZIMUTH), -np.sin(_ELEVATION) * np.sin(_AZIMUTH), np.cos(_ELEVATION)],
    ]
)
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
    skeleton = Skeleton.of(modes)
    ends = [skeleton.points + skeleton.moves[k].real * sign for k in range(shown) for sign in (-1.0, 1.0)]
    flat = np.concatenate([skeleton.points, *ends]) @ _VIEW.T
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
            for offset, color, width in ((0.0, SHADOW, 1.0), (-1.0, GRID, 1.0), (1.0, BLUE, 1.6)):
                _draw(axes, skeleton, skeleton.points + offset * skeleton.moves[k].real, color, width)
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


def _draw(axes: Any, skeleton: Skeleton, points: Any, color: str, width: float) -> None:
    flat = points @ _VIEW.T
    for kind, part in ((ROD, 1.0), (TICK, 0.5), (BODY, 0.6)):
        chosen = skeleton.lines[skeleton.lines[:, 2] == kind, :2]
        if len(chosen):
            axes.add_collection(LineCollection(flat[chosen], colors=color, linewidths=part * width))
