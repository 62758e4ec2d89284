"""Snapshots of rods in space, colored by the moment in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from cayley.report.bodies import Shape, body_shape, joint_points
from cayley.report.conserved import Array, saved_parts
from cayley.report.solids import Solid, around, floor_of, moving, solids
from cayley.report.style import GRID, INK, MAP, MUTED, SHADOW, WIDTH, Drawing, style
from cayley.report.view import seen

_PIECES = 8  # of an element, so that its color runs from node to node
_GAP = 1.12  # width of a panel per width of its picture
# in inches: margins of the figure, with the color bar on the right, and the lowest and highest panel
_LEFT, _RIGHT, _BOTTOM, _TOP, _LOWEST, _HIGHEST = 0.42, 0.85, 0.4, 0.32, 1.2, 3.4


def deformed(rest: Any) -> Figure:
    """An equilibrium in space, as snapshots draws it, over the reference as gray lines.

    Args:
        rest: an Equilibrium.
    """
    return snapshots(rest.frame, reference=True)


def snapshots(run: Any, rod: Any = None, times: Sequence[float] | None = None, *, reference: bool = False) -> Figure:
    """Rods in space at some times, colored by the magnitude of the moment ‖Σ‖ [N m] in them; bodies as boxes.

    All panels have one scale, the same along all axes, and are seen along parallel lines from the same side. On the
    floor is the rod's shadow. A body is the box of its inertia, or its shapes, with lines to its ports; a diamond is a
    joint; obstacles are gray.

    Args:
        run: a Trajectory.
        rod: a rod, its name, or a list of them; all rods, bodies and joints by default.
        times: [s], of which the nearest saved ones are drawn; by default four of equal distance.
        reference: draw the reference of the rods, too, and no times.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), Figure 4.
    """
    time = run.energy["time"].values
    frames = nearest_frames(time, times)
    shown = Contents.of(run, rod, frames)
    before = [own.positions for own in run.model.rods] if reference else []
    room = shown.room(*before)
    with style():
        plan = _Plan.of(len(frames), *room.extent)
        figure = Drawing(figsize=(WIDTH, plan.height))
        for k, frame in enumerate(frames):
            axes = figure.add_axes(plan.panel(k))
            room.draw(axes, labeled=k == 0, margin=0.5 * (plan.width / plan.inches - room.extent[0]))
            axes.set_title("" if reference else f"$t$ = {time[frame]:.3g} s", loc="center")
            for line in before:
                axes.plot(*seen(line).T, color=MUTED, linewidth=1.2, linestyle=(0, (5, 3)), label="reference")
            shown.draw(axes, k, room)
        if shown.positions:
            color_bar(figure, plan.bar(), shown.scale)
    return figure


def color_bar(figure: Figure, place: tuple[float, float, float, float], scale: Normalize) -> None:
    """The colors of moments, at a place in a figure in parts of it."""
    bar = figure.add_axes(place)
    figure.colorbar(ScalarMappable(scale, MAP), cax=bar, label="moment ‖Σ‖ [N m]")
    bar.grid(False)


@dataclass(frozen=True, slots=True)
class Contents:
    """What is drawn of a run, at some frames.

    Attributes:
        positions: of the nodes of each rod [m], shape (frames, n, 3) each.
        moments: their magnitudes [N m], shape (frames, n) each.
        held: the nodes of each rod whose position is held.
        shapes: of the bodies.
        joints: their places [m], shape (frames, joints, 3).
        scale: of the colors.
        solids: obstacles.
    """

    positions: list[Array]
    moments: list[Array]
    held: list[list[int]]
    shapes: list[Shape]
    joints: Array
    scale: Normalize
    solids: list[Solid]

    @classmethod
    def of(cls, run: Any, rod: Any, frames: list[int]) -> Contents:
        """A rod, its name, or a list of them; None: all rods, bodies and joints."""
        known = saved_parts(run)
        all_rods = [name for part in run.model.rods if (name := run.model.name_of(part)) in known]
        chosen = all_rods if rod is None else list(rod) if isinstance(rod, (list, tuple)) else [rod]
        positions, moments = [], []
        for part in chosen:
            data = run[part][["position", "moment"]].isel(time=frames).transpose("time", "node", "axis")
            positions.append(data["position"].values)
            moments.append(np.linalg.norm(data["moment"].values, axis=-1))
        others = (*run.model.bodies, *run.model.own_parts) if rod is None else ()
        shapes = [body_shape(run, part, frames) for part in others if run.model.name_of(part) in known]
        joints = joint_points(run, frames) if rod is None else np.zeros((len(frames), 0, 3))
        top = max((float(moment.max()) for moment in moments), default=0.0)
        scale = Normalize(0.0, top if top > 0.0 else 1.0)
        obstacles = solids(run, frames) if rod is None else []
        shaped = [any(obstacle.on is part for obstacle in run.model.obstacles) for part in others]
        shapes = [replace(one, edges=one.edges[:, :0]) if own else one for one, own in zip(shapes, shaped, strict=True)]
        return cls(positions, moments, _held(run.model, chosen), shapes, joints, scale, obstacles)

    @property
    def points(self) -> Array:
        """All points of rods and bodies [m], shape (n, 3)."""
        own = [one.reshape(-1, 3) for one in self.positions] + [shape.points for shape in self.shapes]
        return np.concatenate(own + moving(self.solids))

    def room(self, *more: Array) -> Room:
        """The room that holds all of it, and more points."""
        points = np.concatenate([self.points, *more])
        low, high = points.min(axis=0), points.max(axis=0)
        floor = floor_of(self.solids, low, high)
        return Room.around(np.concatenate([points, around(self.solids, low, high)]), floor)

    def draw(self, axes: Axes, k: int, room: Room) -> None:
        """Draw the k-th of the frames."""
        floor = float(room.low[2])
        for solid in self.solids:
            solid.draw(axes, k, room.low, room.high)
        for position, moment, nodes in zip(self.positions, self.moments, self.held, strict=True):
            _draw(axes, position[k], moment[k], self.scale, floor)
            axes.plot(*seen(position[k][nodes]).T, "o", markersize=5.5, mfc="white", mec=INK, mew=1.2, zorder=4)
        for shape in self.shapes:
            _draw_body(axes, shape, k, floor)
        axes.plot(*seen(self.joints[k]).T, "D", markersize=4.5, mfc="white", mec=INK, mew=1.1, zorder=5)


def nearest_frames(time: Array, times: Sequence[float] | None) -> list[int]:
    """The saved frames nearest to the given times, each once."""
    wanted = np.linspace(time[0], time[-1], 4) if times is None else np.asarray(times, dtype=float)
    return sorted({int(np.abs(time - t).argmin()) for t in wanted})


@dataclass(frozen=True, slots=True)
class _Plan:
    """Where the panels stand; lengths in inches.

    Attributes:
        columns: panels in a row.
        rows: of panels.
        inches: of a meter.
        width: of a panel.
        tall: height of a panel.
    """

    columns: int
    rows: int
    inches: float
    width: float
    tall: float

    @classmethod
    def of(cls, count: int, width: float, height: float) -> _Plan:
        """All panels in one row, or in two if they were too low; width and height of what they show in meters."""
        for columns in (count, -(-count // 2)):
            panel = (WIDTH - _LEFT - _RIGHT) / columns
            inches = min(panel / (_GAP * width), _HIGHEST / height)
            if height * inches > _LOWEST:
                break
        return cls(columns, -(-count // columns), inches, panel, height * inches)

    @property
    def height(self) -> float:
        """Height of the figure."""
        return self.rows * (self.tall + _BOTTOM + _TOP)

    def panel(self, k: int) -> tuple[float, float, float, float]:
        """Place of a panel in the figure, in parts of it."""
        row, column = divmod(k, self.columns)
        bottom = (self.rows - 1 - row) * (self.tall + _BOTTOM + _TOP) + _BOTTOM
        left = _LEFT + column * self.width
        return (left / WIDTH, bottom / self.height, self.width / WIDTH, self.tall / self.height)

    def bar(self) -> tuple[float, float, float, float]:
        """Place of the color bar, at the right."""
        long = min(0.8 * self.height, 2.4)
        return (1.0 - 0.72 / WIDTH, 0.5 - 0.5 * long / self.height, 0.1 / WIDTH, long / self.height)


@dataclass(frozen=True, slots=True)
class Room:
    """A box in space whose floor and front edges are drawn.

    Attributes:
        low: its corner with the least coordinates [m], shape (3,).
        high: the opposite corner [m], shape (3,).
        left: left lower corner of the picture [m], shape (2,).
        right: right upper corner of the picture [m], shape (2,).
    """

    low: Array
    high: Array
    left: Array
    right: Array

    @classmethod
    def around(cls, points: Array, floor: float | None = None) -> Room:
        """A box around points, no side of it less than a quarter of the longest; with its floor at a height."""
        low, high = points.min(axis=0), points.max(axis=0)
        longest = max(float((high - low).max()), 1e-9)
        half = 0.5 * np.maximum(high - low, 0.25 * longest) + 0.03 * longest
        (x0, y0, z0), (x1, y1, z1) = 0.5 * (low + high) - half, 0.5 * (low + high) + half
        z0 = z0 if floor is None else floor
        lines = [(x0, y0, z0), (x1, y0, z0), (x0, y1, z0), (x1, y1, z0), (x0, y0, z1)]
        flat = seen(np.concatenate([np.array(lines), points + 0.02 * longest * np.array([0.0, 0.0, 1.0])]))
        return cls(np.array([x0, y0, z0]), np.array([x1, y1, z1]), flat.min(axis=0), flat.max(axis=0))

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height of the picture [m]."""
        width, height = (self.right - self.left).tolist()
        return width, height

    def draw(self, axes: Axes, *, labeled: bool, margin: float) -> None:
        """Grid on the floor, three edges with ticks; `margin` is the empty room on the left and right [m]."""
        axes.set_axis_off()
        axes.set_xlim(self.left[0] - margin, self.right[0] + margin)
        axes.set_ylim(self.left[1], self.right[1])
        (x0, y0, z0), (x1, y1, z1) = self.low, self.high
        ticks = [self._ticks(i) for i in range(3)]
        grid = [[(x, y0, z0), (x, y1, z0)] for x in (x0, *ticks[0], x1)]
        grid += [[(x0, y, z0), (x1, y, z0)] for y in (y0, *ticks[1], y1)]
        axes.add_collection(LineCollection(list(seen(np.array(grid))), colors=GRID, linewidths=0.6, zorder=1.0))
        edges = [[(x0, y0, z0), (x1, y0, z0)], [(x1, y0, z0), (x1, y1, z0)], [(x0, y0, z0), (x0, y0, z1)]]
        axes.add_collection(LineCollection(list(seen(np.array(edges))), colors=MUTED, linewidths=0.7, zorder=1.0))
        if not labeled:
            return
        at = (lambda x: (x, y0, z0), lambda y: (x1, y, z0), lambda z: (x0, y0, z))
        offset, align = ((-3, -3), (4, -3), (-4, 0)), (("right", "top"), ("left", "top"), ("right", "center"))
        for i in range(3):
            for tick in ticks[i]:
                self._label(axes, at[i](tick), f"{tick:g}".replace("-", "\N{MINUS SIGN}"), offset[i], align[i])
        self._label(axes, at[0](0.5 * (x0 + x1)), "$x$ [m]", (-12, -12), ("right", "top"))
        self._label(axes, at[1](0.5 * (y0 + y1)), "$y$ [m]", (12, -12), ("left", "top"))
        self._label(axes, at[2](z1), "$z$ [m]", (0, 4), ("center", "bottom"))

    def _ticks(self, i: int) -> list[float]:
        """Two to four round values on an axis."""
        longest = float(np.max(self.high - self.low))
        step = np.ptp(MaxNLocator(5, steps=[1, 2, 5, 10]).tick_values(0.0, longest)[:2])
        first, last = np.ceil(self.low[i] / step), np.floor(self.high[i] / step)
        return (np.arange(first, last + 0.5) * step + 0.0).round(9).tolist()

    @staticmethod
    def _label(axes: Axes, place: Any, text: str, offset: tuple[int, int], align: tuple[str, str]) -> None:
        axes.annotate(
            text,
            tuple(seen(np.array(place)).tolist()),
            xytext=offset,
            textcoords="offset points",
            ha=align[0],
            va=align[1],
            fontsize=7.0,
            annotation_clip=False,
        )


def _draw(axes: Axes, position: Array, moment: Array, scale: Normalize, floor: float) -> None:
    """A rod: its shadow on the floor, a dark outline, and the color of the moment."""
    nodes = np.arange(len(position))
    fine = np.linspace(0, len(position) - 1, (len(position) - 1) * _PIECES + 1)
    curve = np.column_stack([np.interp(fine, nodes, position[:, i]) for i in range(3)])
    values = np.interp(0.5 * (fine[1:] + fine[:-1]), nodes, moment)
    shadow = position.copy()
    shadow[:, 2] = floor
    axes.plot(*seen(shadow).T, color=SHADOW, linewidth=1.6)
    axes.plot(*seen(np.stack([position[-1], shadow[-1]])).T, color=SHADOW, linewidth=0.7, linestyle=(0, (2, 2)))
    flat = seen(curve)
    axes.plot(*flat.T, color=INK, linewidth=4.4, solid_joinstyle="round", clip_on=False)
    pieces = np.stack([flat[:-1], flat[1:]], axis=1)
    axes.add_collection(
        LineCollection(
            list(pieces), cmap=MAP, norm=scale, array=values, linewidths=3.2, capstyle="round", clip_on=False
        )
    )


def _draw_body(axes: Axes, shape: Shape, k: int, floor: float) -> None:
    """A body: the shadow of its center, its box, and lines to its ports."""
    shadow = shape.center[k].copy()
    shadow[2] = floor
    axes.plot(*seen(shadow[None]).T, "o", color=SHADOW, markersize=4.0)
    axes.plot(*seen(np.stack([shape.center[k], shadow])).T, color=SHADOW, linewidth=0.7, linestyle=(0, (2, 2)))
    axes.add_collection(LineCollection(list(seen(shape.arms[k])), colors=MUTED, linewidths=1.0, clip_on=False))
    axes.add_collection(LineCollection(list(seen(shape.edges[k])), colors=INK, linewidths=1.0, clip_on=False))
    axes.plot(*seen(shape.center[k][None]).T, "o", color=INK, markersize=3.0, clip_on=False)


def _held(model: Any, rods: Sequence[Any]) -> list[list[int]]:
    """The nodes of each rod whose position is held."""
    parts = [dict(zip(model.names, model.parts, strict=True))[rod] if isinstance(rod, str) else rod for rod in rods]
    return [
        sorted({s.port.node for s in model.supports if s.port.part is part and any(s.held_position)}) for part in parts
    ]
