"""Bifurcation diagrams: paths of equilibria, solid where they are stable."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from cayley.model import Port
from cayley.report.conserved import Array
from cayley.report.style import BLUE, GREEN, INK, MUTED, VERMILION, WIDTH, style

_COLORS = (BLUE, VERMILION, GREEN, INK)
_MARKS = {"limit": ("s", "limit point"), "bifurcation": ("o", "bifurcation point")}


def branches(
    paths: Any, quantity: tuple[Any, str] | Callable[[Any], Any] | None = None, *, label: str | None = None
) -> Figure:
    """The parameter over a quantity along paths of equilibria: solid stable, dashed unstable, critical points marked.

    Args:
        paths: a Path of cy.trace, or several, such as one with its branches.
        quantity: (a port or body, "x", "y" or "z"), its displacement [m] along that axis from the first point of the
            first path; or a function of a path that returns a number for each of its points; without it, the largest
            displacement of any node from there.
        label: of the quantity.

    Raises:
        ValueError: there are no paths, or the quantity is none.
    """
    given = list(paths) if isinstance(paths, list | tuple) else [paths]
    if not given:
        raise ValueError("branches: paths is empty; give a path of cy.trace, or several")
    values, name = _values(given, quantity)
    with style():
        figure = Figure(figsize=(0.7 * WIDTH, 3.6), layout="constrained")
        axes = figure.add_subplot()
        for k, (path, own) in enumerate(zip(given, values, strict=True)):
            _draw(axes, path, own, _COLORS[k % len(_COLORS)])
        for kind, (mark, text) in _MARKS.items():
            where = [(path, own, one) for path, own in zip(given, values, strict=True) for one in path.critical]
            shown = [(own[one.point], one.parameter) for _, own, one in where if one.kind == kind]
            if shown:
                look: dict[str, Any] = {"marker": mark, "ms": 4.5, "mfc": "white", "mec": INK, "ls": "none"}
                axes.plot(*np.transpose(shown), label=text, zorder=3, **look)
        for dashes, text in (("-", "stable"), ("--", "unstable")):
            axes.plot([], [], color=MUTED, linestyle=dashes, label=text)
        unit = "" if given[0].unit == "-" else f" [{given[0].unit}]"
        axes.set_ylabel(f"{given[0].name}{unit}")
        axes.set_xlabel(label or name)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _draw(axes: Any, path: Any, values: Array, color: str) -> None:
    """Lines from critical point to critical point, between which stability is the same."""
    edges = [0, *(one.point for one in path.critical), len(path) - 1]
    for first, last in itertools.pairwise(edges):
        if last > first:
            inside = min(first + 1, last - 1) if last - first > 1 else first
            stable = path.unstable[inside] == 0
            own = slice(first, last + 1)
            axes.plot(values[own], path.parameter[own], color=color, linestyle="-" if stable else "--")


def _values(paths: Sequence[Any], quantity: Any) -> tuple[list[Array], str]:
    """The quantity at every point of every path, and what to call it."""
    if quantity is None:
        states = [np.stack([path.state(k).values for k in range(len(path))]) for path in paths]
        rows = paths[0].frames.outline.layout.rows_of("x")
        shifts = [np.linalg.norm(own[..., rows] - states[0][0][:, rows], axis=-1).max(axis=1) for own in states]
        return shifts, "largest displacement [m]"
    if callable(quantity):
        found = [np.asarray(quantity(path), dtype=float) for path in paths]
        for path, own in zip(paths, found, strict=True):
            if own.shape != (len(path),):
                raise ValueError(f"branches: quantity returns shape {own.shape}; return one number for each point")
        return found, getattr(quantity, "__name__", "quantity").strip("<>")
    if not (isinstance(quantity, tuple) and len(quantity) == 2 and quantity[1] in ("x", "y", "z")):
        raise ValueError(f'branches: quantity is {quantity!r}; give (a port or body, "x", "y" or "z") or a function')
    place, axis = quantity
    data = [path.port(place) if isinstance(place, Port) else path[place] for path in paths]
    if "node" in data[0].dims:
        raise ValueError("branches: quantity is of a rod; give one of its ports, such as rod.end")
    called = str(place) if isinstance(place, Port | str) else paths[0].model.name_of(place)
    along = [own.position.sel(axis=axis).values for own in data]
    return [own - along[0][0] for own in along], f"displacement of {called} along {axis} [m]"
