"""Curved and twisted references: the axis of a rod and the frames of its sections, sampled in every element."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev as series
from numpy.typing import NDArray

from cayley.lie import quaternion
from cayley.model import validate
from cayley.model.frames import standard_rotation
from cayley.model.samples import basis, chebyshev
from cayley.model.validate import Array

SAMPLES = 13
"""Points in every element: polynomials of degree 12 follow an arc of 90 degrees to 2e-15 of its radius."""
PIECES = 8
"""Least number of pieces in which a curve is measured, each by a polynomial through SAMPLES points; else one for every
element. More would cost digits of the derivative."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Shape:
    """Where the axis and the sections of a rod are without stress, at the Chebyshev points of every element.

    Attributes:
        position: of the axis [m], shape (elements, SAMPLES, 3), read-only.
        rotation: of the sections, unit quaternions wxyz whose sign does not jump, shape (elements, SAMPLES, 4),
            read-only.

    Raises:
        ValueError: another shape, or a quaternion that has not length 1.
    """

    position: Array
    rotation: Array

    def __post_init__(self) -> None:
        """Check and freeze the arrays."""
        for name, width in (("position", 3), ("rotation", 4)):
            right = f"finite numbers of shape (elements, {SAMPLES}, {width})"
            array = validate.array("Shape", name, getattr(self, name), (-1, SAMPLES, width), right)
            object.__setattr__(self, name, validate.frozen(array))
        if len(self.position) != len(self.rotation):
            raise ValueError(f"Shape: position has {len(self.position)} elements and rotation {len(self.rotation)}")
        worst = float(np.abs(np.linalg.norm(self.rotation, axis=-1) - 1.0).max(initial=0.0))
        if worst > 1e-9:
            raise ValueError(f"Shape: rotation has a quaternion whose length is off by {worst:.2g}; give unit ones")

    def at(self, places: Array) -> tuple[Array, Array]:
        """Positions and rotations at places in [0, 1] of every element, shapes (elements, places, 3) and (..., 4)."""
        table = basis(SAMPLES, places)
        position = np.einsum("pk,ekr->epr", table, self.position)
        rotation = np.einsum("pk,ekr->epr", table, self.rotation)
        return position, rotation / np.linalg.norm(rotation, axis=-1, keepdims=True)


def along(
    curve: Callable[[float], Any],
    span: tuple[float, float],
    shares: Array,
    *,
    tangent: Callable[[float], Any] | None = None,
    normal: Any = None,
    twist: float | Callable[[float], float] = 0.0,
    frames: Callable[[float], Any] | None = None,
) -> tuple[Shape, float]:
    """The shape of a rod whose axis is a curve, and its length.

    Args:
        curve: position r(u) [m]; u need not be the arc length.
        span: the u of the first and of the last node.
        shares: lengths of the elements as parts of the whole, shape (elements,), of sum 1.
        tangent: r'(u), of any length but zero; None: of the curve itself if it is a spline of SciPy (`derivative`), or
            of polynomials through its points.
        normal: of the section's e1 axis at the first node; None: as of a straight rod.
        twist: turn of the sections about the axis against frames without twist [rad]: that of the last one, growing
            evenly from zero, or a function of the arc length s.
        frames: function of s that gives the frame, a unit quaternion wxyz or a matrix (3, 3), instead of both.

    Raises:
        TypeError: something is no function, or does not return numbers.
        ValueError: the curve stands still somewhere, or gives no 3 finite numbers.
    """
    measured = _Measured(_checked("curve", curve, (3,)), span, tangent, max(PIECES, len(shares)))
    ends = np.concatenate([[0.0], np.cumsum(shares)])
    ends *= measured.length / ends[-1]
    stations = ends[:-1, None] + np.diff(ends)[:, None] * chebyshev(SAMPLES)[None, :-1]
    s = np.append(stations.reshape(-1), ends[-1])
    u = measured.parameters(s)
    position = np.array([measured.curve(float(v)) for v in u])
    if frames is None:
        turned = framed(position, measured.tangents(u), normal)
        turned = _twisted(turned, s, twist)
    else:
        turned = np.array([_quaternion(frames, float(v)) for v in s])
    return _shape(position, continuous(turned)), float(measured.length)


def polyline(
    points: Any, elements: int, *, normal: Any = None, twist: float | Callable[[float], float] = 0.0
) -> tuple[Shape, Array]:
    """The shape of a rod along straight lines between points, and the lengths of its elements.

    The points are nodes; between two of them elements have the same length. Sections stand across the lines, and at a
    corner across the line that halves its angle: the frame turns within the two elements beside it.

    Args:
        points: positions [m], shape (k, 3), k >= 2.
        elements: their number, at least one between two points.
        normal: as of `along`.
        twist: as of `along`.

    Raises:
        ValueError: too few points or elements, a point twice in a row, or a line that goes straight back.
    """
    right = "2 or more points (x, y, z) [m], shape (k, 3)"
    corners = validate.array("Rod", "points", points, (-1, 3), right)
    if len(corners) < 2:
        raise ValueError(validate.wrong("Rod", "points", points, right))
    lines = np.diff(corners, axis=0)
    lengths = np.linalg.norm(lines, axis=1)
    if lengths.min() <= 1e-12 * lengths.max():
        raise ValueError(f"Rod: points {int(lengths.argmin())} and the next are one; give each corner once")
    if elements < len(lines):
        raise ValueError(f"Rod: elements = {elements} must be at least {len(lines)}, one between two points")
    ways = lines / lengths[:, None]
    if (bent := np.sum(ways[1:] * ways[:-1], axis=1)).min(initial=1.0) < -1.0 + 1e-9:
        raise ValueError(f"Rod: at point {int(bent.argmin()) + 1} the line goes straight back; put a point between")
    counts = _shared(lengths, elements)
    sizes = np.repeat(lengths / counts, counts)
    nodes = [corners[:1]]
    for a, line, count in zip(corners[:-1], lines, counts, strict=True):
        nodes.append(a + line * (np.arange(1, count + 1) / count)[:, None])
    position = np.concatenate(nodes)
    left = np.repeat(ways, counts, axis=0)
    tangents = np.concatenate([left[:1], left[1:] + left[:-1], left[-1:]])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    s = np.concatenate([[0.0], np.cumsum(sizes)])
    turned = continuous(_twisted(framed(position, tangents, normal), s, twist))
    part = chebyshev(SAMPLES)[None, :, None]
    inside = [(1.0 - part) * nodes[:-1, None] + part * nodes[1:, None] for nodes in (position, turned)]
    inside[1] /= np.linalg.norm(inside[1], axis=-1, keepdims=True)
    return Shape(position=inside[0], rotation=inside[1]), sizes


def framed(position: Array, tangent: Array, normal: Any) -> Array:
    """Frames along points that turn about the tangent as little as possible (rotation-minimizing).

    Two reflections take each frame to the next: one in the plane halfway between the points, one that brings the
    tangent right. The error falls with the fourth power of the distance of the points.

    Args:
        position: of the points, shape (n, 3).
        tangent: unit vectors, shape (n, 3).
        normal: of e1 at the first point, as of Rod; None: the smallest rotation that brings e3 onto the tangent.

    Returns: unit quaternions, d3 the tangent, shape (n, 4).

    Source: Wang, Juettler, Zheng, Liu (2008), Computation of rotation minimizing frames, table I.
    """
    d1 = np.empty_like(tangent)
    d1[0] = _first_normal(tangent[0], normal)
    for k in range(len(position) - 1):
        way = position[k + 1] - position[k]
        reflected = d1[k] - (2.0 * (way @ d1[k]) / (way @ way)) * way
        before = tangent[k] - (2.0 * (way @ tangent[k]) / (way @ way)) * way
        turn = tangent[k + 1] - before
        own = reflected - (2.0 * (turn @ reflected) / (turn @ turn)) * turn
        own -= (own @ tangent[k + 1]) * tangent[k + 1]
        d1[k + 1] = own / np.linalg.norm(own)
    matrices = np.stack([d1, np.cross(tangent, d1), tangent], axis=-1)
    return np.asarray(quaternion.from_matrix(matrices), dtype=float)


def continuous(turned: Array) -> Array:
    """The same rotations with signs of the quaternions that do not jump, shape (n, 4)."""
    same = np.sum(turned[1:] * turned[:-1], axis=1) >= 0.0
    signs = np.concatenate([[1.0], np.cumprod(np.where(same, 1.0, -1.0))])
    return turned * signs[:, None]


class _Measured:
    """A curve with its arc length."""

    def __init__(self, curve: Callable[[float], Array], span: Any, tangent: Any, pieces: int) -> None:
        """Measure it: s(u) = ∫ ‖r'‖ du, a polynomial in each of its pieces."""
        pair = validate.array("Rod", "span", span, (2,), "2 different numbers, the u of the first and the last node")
        if pair[0] == pair[1]:
            raise ValueError(validate.wrong("Rod", "span", span, "2 different numbers"))
        self.curve = curve
        self.edges = np.linspace(pair[0], pair[1], pieces + 1)
        points = 2.0 * chebyshev(SAMPLES) - 1.0
        u = self.edges[:-1, None] + np.diff(self.edges)[:, None] * chebyshev(SAMPLES)
        self._way = self._derivative(u, points, tangent)
        speed = np.linalg.norm(np.stack([self._way(v) for v in u]), axis=-1)
        if not speed.min() > 1e-9 * speed.max():
            where = u.reshape(-1)[int(speed.argmin())]
            raise ValueError(f"Rod: curve stands still at {where:g}; give one whose derivative is zero nowhere")
        half = 0.5 * np.abs(np.diff(self.edges))
        grown = [series.chebint(half[k] * series.chebfit(points, speed[k], SAMPLES - 1)) for k in range(pieces)]
        self._grown = np.array(grown).T
        self._grown[0] -= series.chebval(-1.0, self._grown)
        self._starts = np.concatenate([[0.0], np.cumsum(series.chebval(1.0, self._grown))])
        self.length = float(self._starts[-1])

    def tangents(self, u: Array) -> Array:
        """Unit tangents, in the direction of the rod, shape (n, 3)."""
        way = self._way(u) * np.sign(self.edges[-1] - self.edges[0])
        return np.asarray(way / np.linalg.norm(way, axis=1, keepdims=True), dtype=float)

    def parameters(self, s: Array) -> Array:
        """The u at arc lengths s, by Newton's method in the piece where each is."""
        piece = np.clip(np.searchsorted(self._starts, s, side="right") - 1, 0, len(self.edges) - 2)
        grown = self._grown[:, piece]
        slope = series.chebder(grown)
        missing = s - self._starts[piece]
        x = 2.0 * missing / (self._starts[piece + 1] - self._starts[piece]) - 1.0
        for _ in range(50):  # from the linear guess; the length grows everywhere, so a few do
            step = (series.chebval(x, grown, tensor=False) - missing) / series.chebval(x, slope, tensor=False)
            x = np.clip(x - step, -1.0, 1.0)
            if np.abs(step).max() < 4.0 * np.finfo(float).eps:
                break
        found: Array = self.edges[piece] + (0.5 * x + 0.5) * np.diff(self.edges)[piece]
        return found

    def _derivative(self, u: Array, points: Array, given: Any) -> Callable[[Array], Array]:
        """r'(u) as a function of many u."""
        if given is None and callable(getattr(self.curve, "derivative", None)):
            given = self.curve.derivative()  # type: ignore[attr-defined]
        if given is not None:
            one = _checked("tangent", given, (3,))
            return lambda v: np.array([one(float(each)) for each in v])
        values = [np.array([self.curve(float(v)) for v in row]) for row in u]
        fits = [series.chebder(series.chebfit(points, row, SAMPLES - 1)) for row in values]
        slopes = np.array(fits) * (2.0 / np.diff(self.edges))[:, None, None]
        rising = np.sign(self.edges[-1] - self.edges[0])

        def derivative(v: Array) -> Array:
            piece = np.clip(np.searchsorted(rising * self.edges, rising * v, side="right") - 1, 0, len(self.edges) - 2)
            x = 2.0 * (v - self.edges[piece]) / np.diff(self.edges)[piece] - 1.0
            table = np.polynomial.chebyshev.chebvander(x, slopes.shape[1] - 1)
            return np.asarray(np.einsum("nk,nkr->nr", table, slopes[piece]), dtype=float)

        return derivative


class _checked:
    """A function of one number whose values are checked."""

    def __init__(self, name: str, function: Any, shape: tuple[int, ...]) -> None:
        if not callable(function):
            raise TypeError(validate.wrong("Rod", name, function, "a function of one number"))
        self._name, self._function, self._shape = name, function, shape
        if callable(getattr(function, "derivative", None)):
            self.derivative = function.derivative

    def __call__(self, u: float) -> Array:
        right = f"finite numbers of shape {self._shape}"
        return validate.array("Rod", f"{self._name}({u:g})", self._function(u), self._shape, right)


def _first_normal(tangent: Array, normal: Any) -> Array:
    """d1 across a tangent: along a normal, or of the smallest rotation that brings e3 onto it."""
    direction = validate.direction("Rod", "direction", tangent.tolist())
    given = None if normal is None else validate.direction("Rod", "normal", normal)
    return np.asarray(quaternion.rotate(standard_rotation("Rod", direction, given), (1.0, 0.0, 0.0)), dtype=float)


def _twisted(turned: Array, s: Array, twist: Any) -> Array:
    """Frames turned about their third axis."""
    if callable(twist):
        angle = np.array([validate.number("Rod", f"twist({v:g})", twist(float(v)), "rad") for v in s])
    else:
        angle = validate.number("Rod", "twist", twist, "rad") * s / s[-1]
    if not angle.any():
        return turned
    nothing = np.zeros_like(angle)
    about = np.stack([np.cos(0.5 * angle), nothing, nothing, np.sin(0.5 * angle)], axis=-1)
    return np.asarray(quaternion.multiply(turned, about), dtype=float)


def _quaternion(frames: Any, s: float) -> Array:
    """The frame at s as a unit quaternion."""
    name = f"frames({s:g})"
    if not callable(frames):
        raise TypeError(validate.wrong("Rod", "frames", frames, "a function of s [m]"))
    given = np.asarray(frames(s))
    if given.shape == (3, 3):
        matrix = validate.array("Rod", name, given, (3, 3), "a rotation matrix")
        if np.abs(matrix.T @ matrix - np.eye(3)).max() > 1e-9 or np.linalg.det(matrix) < 0.0:
            raise ValueError(validate.wrong("Rod", name, given.tolist(), "a rotation matrix"))
        return np.asarray(quaternion.from_matrix(matrix), dtype=float)
    right = "a unit quaternion wxyz or a rotation matrix (3, 3)"
    p = validate.array("Rod", name, given, (4,), right)
    if abs(np.linalg.norm(p) - 1.0) > 1e-9:
        raise ValueError(validate.wrong("Rod", name, given.tolist(), right))
    return p


def _shape(position: Array, turned: Array) -> Shape:
    """Samples of all elements, from points of which neighbors share the one between them."""
    step = SAMPLES - 1
    rows = step * np.arange((len(position) - 1) // step)[:, None] + np.arange(SAMPLES)
    return Shape(position=position[rows], rotation=turned[rows])


def _shared(lengths: Array, elements: int) -> NDArray[np.int64]:
    """How many elements each line gets: one, and the rest where elements are longest."""
    counts = np.ones(len(lengths), dtype=np.int64)
    for _ in range(elements - len(lengths)):
        counts[int(np.argmax(lengths / counts))] += 1
    return counts


__all__ = ["SAMPLES", "Shape", "along", "continuous", "framed", "polyline"]
