"""Shapes of rods: places, lengths, frames that do not twist, twist, corners, refusals."""

import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from cayley.lie import quaternion
from cayley.model import Material, Rod, Section
from cayley.model.curve import SAMPLES, Shape, framed

SECTION = Section.circle(0.01, Material(density=1000.0, youngs_modulus=1e7, poisson_ratio=0.3))
RADIUS, PITCH = 2.0, 0.5
SPEED = math.hypot(RADIUS, PITCH)


def helix(u):
    return RADIUS * math.cos(u), RADIUS * math.sin(u), PITCH * u


def on_helix(s):
    u = s / SPEED
    return np.stack([RADIUS * np.cos(u), RADIUS * np.sin(u), PITCH * u], axis=-1)


def along_helix(**options):
    return Rod.along(SECTION, helix, span=(0.0, 6.0), **({"elements": 5} | options))


def axes(rotations):
    return np.moveaxis(quaternion.to_matrix(rotations), -1, 0)


def test_nodes_lie_on_the_curve_at_their_arc_length():
    rod = along_helix()
    assert rod.length == pytest.approx(6.0 * SPEED, rel=1e-14)
    np.testing.assert_allclose(rod.positions, on_helix(rod.nodes), atol=1e-12)
    np.testing.assert_allclose(rod.element_lengths, rod.length / 5)


def test_between_nodes_too():
    rod, places = along_helix(), np.linspace(0.0, 1.0, 7)
    s = (rod.nodes[:-1, None] + np.diff(rod.nodes)[:, None] * places[:-1]).reshape(-1)
    positions, rotations = rod.reference(places)
    np.testing.assert_allclose(positions[:-1], on_helix(s), atol=1e-12)
    u = s / SPEED
    tangent = np.stack([-RADIUS * np.sin(u), RADIUS * np.cos(u), PITCH + 0.0 * u], axis=-1) / SPEED
    np.testing.assert_allclose(axes(rotations)[2][:-1], tangent, atol=1e-11)


def test_spacing_divides_the_length():
    rod = along_helix(spacing=(1, 2, 3, 2, 1))
    np.testing.assert_allclose(rod.element_lengths, rod.length * np.array([1, 2, 3, 2, 1]) / 9, rtol=1e-13)
    np.testing.assert_allclose(rod.positions, on_helix(rod.nodes), atol=1e-12)


@pytest.mark.parametrize("stretch", [lambda u: u**3 + u, lambda u: 6.0 - u], ids=["uneven", "backwards"])
def test_the_parameter_need_not_be_the_arc_length(stretch):
    found = Rod.along(SECTION, lambda u: helix(stretch(u)), span=(0.0, 1.5), elements=4)
    ends = stretch(0.0), stretch(1.5)
    s = SPEED * (ends[0] + np.sign(ends[1] - ends[0]) * found.nodes / SPEED)
    np.testing.assert_allclose(found.positions, on_helix(s), atol=1e-10)
    assert found.length == pytest.approx(SPEED * abs(ends[1] - ends[0]), rel=1e-12)


def test_frames_turn_as_little_as_possible():
    """On a helix they turn against the Frenet frame with the torsion: by −τ s."""
    rod = along_helix(elements=12, normal=(-1, 0, 0))
    torsion = PITCH / SPEED**2
    u = rod.nodes / SPEED
    inward = np.stack([-np.cos(u), -np.sin(u), 0.0 * u], axis=-1)
    d1, d2, _ = axes(rod.rotations)
    np.testing.assert_allclose(
        np.unwrap(np.arctan2((inward * d2).sum(axis=1), (inward * d1).sum(axis=1))), torsion * rod.nodes, atol=1e-6
    )


def test_twist_turns_them_further():
    plain, even, function = (along_helix(twist=twist) for twist in (0.0, 3.0, lambda s: 3.0 * s / (6.0 * SPEED)))
    angle = 3.0 * plain.nodes / plain.length
    d1, d2, _ = axes(plain.rotations)
    turned = np.cos(angle)[:, None] * d1 + np.sin(angle)[:, None] * d2
    for rod in (even, function):
        np.testing.assert_allclose(axes(rod.rotations)[0], turned, atol=1e-12)


def test_given_frames_are_taken():
    frames = {
        "quaternion": lambda s: np.array([math.cos(s), 0.0, 0.0, math.sin(s)]),
        "matrix": lambda s: quaternion.to_matrix([math.cos(s), 0.0, 0.0, math.sin(s)]),
    }
    for function in frames.values():
        rod = Rod.along(SECTION, lambda u: (0.0, 0.0, u), elements=4, span=(0.0, 3.0), frames=function)
        np.testing.assert_allclose(rod.frame(1.3), quaternion.to_matrix(frames["quaternion"](1.3)), atol=1e-9)


def test_a_line_is_a_line():
    rod = Rod.along(SECTION, lambda u: (1.0, 2.0 * u, 0.0), elements=3, normal=(0, 0, 1))
    plain = Rod(SECTION, length=2.0, elements=3, origin=(1, 0, 0), direction=(0, 1, 0), normal=(0, 0, 1))
    np.testing.assert_allclose(rod.positions, plain.positions, atol=1e-14)
    np.testing.assert_allclose(axes(rod.rotations), axes(plain.rotations), atol=1e-12)
    assert rod.origin + rod.direction == pytest.approx(plain.origin + plain.direction)


def test_reflections_keep_the_angle_between_tangent_and_frame():
    rng = np.random.default_rng(5)
    position, tangent = np.cumsum(rng.normal(size=(20, 3)), axis=0), rng.normal(size=(20, 3))
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    np.testing.assert_allclose(axes(framed(position, tangent, None))[2], tangent, atol=1e-13)


def test_spline_passes_through_its_points():
    points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 1)], dtype=float)
    rod = Rod.through(SECTION, points, elements=300)
    away = np.linalg.norm(rod.positions[:, None] - points[None], axis=2).min(axis=0)
    assert away.max() < rod.element_length
    u = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    spline = CubicSpline(u, points, bc_type="natural")
    fine = np.linalg.norm(np.diff(spline(np.linspace(0, u[-1], 20001)), axis=0), axis=1).sum()
    assert rod.length == pytest.approx(fine, rel=1e-7)


def test_polyline_has_its_corners_as_nodes():
    corners = [(0, 0, 0), (1, 0, 0), (1, 2, 0)]
    rod = Rod.polyline(SECTION, corners, elements=7, normal=(0, 0, 1))
    assert rod.length == pytest.approx(3.0, rel=1e-15)
    for corner in corners:
        assert np.linalg.norm(rod.positions - np.array(corner), axis=1).min() < 1e-15
    np.testing.assert_allclose(np.linalg.norm(np.diff(rod.positions, axis=0), axis=1), rod.element_lengths)
    half = np.array([1.0, 1.0, 0.0]) / math.sqrt(2.0)
    np.testing.assert_allclose(axes(rod.rotations)[2], [(1, 0, 0)] * 3 + [half] + [(0, 1, 0)] * 4, atol=1e-15)
    np.testing.assert_allclose(axes(rod.rotations)[0], [(0, 0, 1)] * 8, atol=1e-15)


def test_stretched_about_the_first_node():
    rod = along_helix(stretched=1.25)
    start = on_helix(0.0)
    np.testing.assert_allclose(rod.positions - start, 1.25 * (on_helix(rod.nodes) - start), atol=1e-12)
    assert rod.length == along_helix().length


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (lambda: Rod.along(SECTION, 3, elements=2), TypeError, "Rod: curve = 3 must be a function of one number"),
        (
            lambda: Rod.along(SECTION, lambda u: (u, 0), elements=2),
            ValueError,
            "Rod: curve(0) = (0.0, 0) must be finite numbers of shape (3,)",
        ),
        (
            lambda: Rod.along(SECTION, lambda u: ((u - 0.5) ** 3, 0, 0), elements=2, span=(0, 1)),
            ValueError,
            "Rod: curve stands still at 0.5; give one whose derivative is zero nowhere",
        ),
        (
            lambda: Rod.along(SECTION, helix, elements=2, span=(1, 1)),
            ValueError,
            "Rod: span = (1, 1) must be 2 different numbers",
        ),
        (
            lambda: along_helix(twist=math.inf),
            ValueError,
            "Rod: twist = inf must be a finite number [rad]",
        ),
        (
            lambda: along_helix(frames=lambda s: (1.0, 1.0, 0.0, 0.0)),
            ValueError,
            "Rod: frames(0) = [1.0, 1.0, 0.0, 0.0] must be a unit quaternion wxyz or a rotation matrix (3, 3)",
        ),
        (
            lambda: Rod.polyline(SECTION, [(0, 0, 0), (1, 0, 0), (1, 0, 0)], elements=5),
            ValueError,
            "Rod: points 1 and the next are one; give each corner once",
        ),
        (
            lambda: Rod.polyline(SECTION, [(0, 0, 0), (1, 0, 0), (0, 0, 0)], elements=5),
            ValueError,
            "Rod: at point 1 the line goes straight back; put a point between",
        ),
        (
            lambda: Rod.polyline(SECTION, [(0, 0, 0), (1, 0, 0), (1, 1, 0)], elements=1),
            ValueError,
            "Rod: elements = 1 must be at least 2, one between two points",
        ),
        (
            lambda: Rod(SECTION, length=1.0, elements=3, spacing=(1, 2)),
            ValueError,
            "Rod: spacing = (1, 2) must be 3 positive numbers, one an element",
        ),
        (
            lambda: Rod(SECTION, length=1.0, elements=3, stretched=0),
            ValueError,
            "Rod: stretched = 0 must be a positive, finite number [-]",
        ),
        (
            lambda: Shape(position=np.zeros((1, SAMPLES, 3)), rotation=np.zeros((1, SAMPLES, 4))),
            ValueError,
            "Shape: rotation has a quaternion whose length is off by 1; give unit ones",
        ),
    ],
)
def test_refusals(refused, call, error, line):
    refused(call, error, line)
