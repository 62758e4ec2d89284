"""Ellipse, I-beam, box and polygon: areas by Green's theorem, axes, torsion, shear center, offsets, refusals."""

import math
import sys

import numpy as np
import pytest

from cayley.model import Material, Section
from cayley.model.areas import areas, closed
from cayley.model.formulas import cowper_ellipse, cowper_rectangle, cowper_tube, cowper_walls

RHO, E, NU = 1000.0, 5e6, 0.3
MATERIAL = Material(density=RHO, youngs_modulus=E, poisson_ratio=NU)
G = MATERIAL.shear_modulus
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def ring(count, a=1.0, b=1.0):
    angle = 2.0 * np.pi * np.arange(count) / count
    return np.stack([a * np.cos(angle), b * np.sin(angle)], axis=1)


def turned(points, angle):
    c, s = math.cos(angle), math.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def torsion(section):
    """It, with the skip where it takes finite elements."""
    return section.stiffness[5, 5] / G


@pytest.fixture
def fem():
    pytest.importorskip("skfem", reason="the extra section is not installed")


def test_areas_of_a_triangle_anywhere():
    """I1 = b h³/36, I2 = h b³/36, I12 = −b² h²/72 of a right angle at the origin."""
    found = areas(np.array([[0, 0], [3, 0], [0, 2]]) + 1e3)
    assert found.area == pytest.approx(3.0, rel=1e-12)
    assert found.centroid == pytest.approx((1001.0, 1000.0 + 2.0 / 3.0), rel=1e-14)
    assert found.moments == pytest.approx((3 * 2**3 / 36, 2 * 3**3 / 36, -(3**2) * 2**2 / 72), rel=1e-10)


def test_holes_are_taken_off():
    whole, hole = areas(2.0 * SQUARE), areas(0.5 * SQUARE)
    both = areas(2.0 * SQUARE, [0.5 * SQUARE + 0.25])
    assert both.area == pytest.approx(whole.area - hole.area)
    shift = np.array([0.5, 0.5]) - both.centroid
    expected = (
        whole.moments[0] + whole.area * (1.0 - both.centroid[1]) ** 2 - hole.moments[0] - hole.area * shift[1] ** 2
    )
    assert both.moments[0] == pytest.approx(expected, rel=1e-13)


def test_either_way_around_and_closed():
    np.testing.assert_array_equal(closed("s", "outline", SQUARE[::-1]), SQUARE[::-1][::-1])
    assert len(closed("s", "outline", [*SQUARE, SQUARE[0]])) == 4


def test_polygon_is_the_rectangle():
    polygon = Section.polygon(SQUARE * [0.02, 0.03] + 7.0, MATERIAL, torsion=1e-9)
    rectangle = Section.rectangle(0.02, 0.03, MATERIAL, torsion=1e-9)
    np.testing.assert_allclose(polygon.stiffness, rectangle.stiffness, rtol=1e-11)
    np.testing.assert_allclose(polygon.inertia, rectangle.inertia, rtol=1e-11)
    np.testing.assert_allclose(polygon.outline.max(axis=0), [0.01, 0.015], rtol=1e-11)


def test_polygon_of_many_corners_is_the_ellipse():
    polygon = Section.polygon(ring(2000, 0.02, 0.01), MATERIAL, torsion="polar")
    ellipse = Section.ellipse(0.02, 0.01, MATERIAL)
    np.testing.assert_allclose(np.diag(polygon.stiffness)[2:5], np.diag(ellipse.stiffness)[2:5], rtol=1e-5)
    np.testing.assert_allclose(polygon.inertia, ellipse.inertia, rtol=1e-5, atol=1e-12)
    assert torsion(ellipse) == pytest.approx(math.pi * (0.02 * 0.01) ** 3 / (0.02**2 + 0.01**2), rel=1e-14)


@pytest.mark.parametrize("angle", [0.3, -0.7, 2.0])
def test_turned_polygon_bends_as_the_rectangle_turned(angle):
    rectangle = Section.rectangle(0.02, 0.03, MATERIAL, torsion=1e-9)
    polygon = Section.polygon(turned(SQUARE * [0.02, 0.03], angle), MATERIAL, torsion=1e-9)
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    bend = turn @ rectangle.stiffness[3:5, 3:5] @ turn.T
    np.testing.assert_allclose(polygon.stiffness[3:5, 3:5], bend, rtol=1e-10)
    np.testing.assert_allclose(polygon.inertia[:2, :2], turn @ rectangle.inertia[:2, :2] @ turn.T, rtol=1e-10)


def test_principal_axes_undo_the_turn():
    polygon = Section.polygon(turned(SQUARE * [0.02, 0.03], 0.3), MATERIAL, axes="principal", torsion=1e-9)
    assert polygon.stiffness[3, 4] == 0.0
    assert sorted(np.diag(polygon.stiffness)[3:5]) == pytest.approx(
        sorted(np.diag(Section.rectangle(0.02, 0.03, MATERIAL).stiffness)[3:5]), rel=1e-10
    )


def test_i_beam_and_box_by_parts():
    b, h, t, w = 0.1, 0.2, 0.01, 0.006
    beam = Section.i_beam(width=b, height=h, flange=t, web=w, material=MATERIAL, torsion="thin-wall")
    assert beam.mass_per_length == pytest.approx(RHO * (2 * b * t + (h - 2 * t) * w), rel=1e-13)
    inner = h - 2 * t
    strong, weak = (b * h**3 - (b - w) * inner**3) / 12, (2 * t * b**3 + inner * w**3) / 12
    np.testing.assert_allclose(np.diag(beam.stiffness)[3:5], [E * strong, E * weak], rtol=1e-12)
    box = Section.box(width=b, height=h, flange=t, web=w, material=MATERIAL, torsion="thin-wall")
    strong, weak = (b * h**3 - (b - 2 * w) * inner**3) / 12, (h * b**3 - inner * (b - 2 * w) ** 3) / 12
    np.testing.assert_allclose(np.diag(box.stiffness)[3:5], [E * strong, E * weak], rtol=1e-12)


def test_square_torsion(fem):
    assert torsion(Section.polygon(SQUARE, MATERIAL)) == pytest.approx(0.1405770, rel=2e-5)
    assert torsion(Section.polygon(SQUARE, MATERIAL)) >= 0.1405770


def test_triangle_and_strip_torsion(fem):
    triangle = Section.polygon([(0, 0), (1, 0), (0.5, math.sqrt(3) / 2)], MATERIAL)
    assert torsion(triangle) == pytest.approx(math.sqrt(3) / 80, rel=1e-5)
    strip = Section.rectangle(4.0, 1.0, MATERIAL, torsion="saint-venant")
    assert torsion(Section.polygon(SQUARE * [4, 1], MATERIAL)) == pytest.approx(torsion(strip), rel=5e-5)


def test_tube_torsion_of_a_polygon_with_a_hole(fem):
    found = Section.polygon(ring(240), MATERIAL, holes=[0.8 * ring(240)])
    assert torsion(found) == pytest.approx(math.pi / 2 * (1 - 0.8**4), rel=2e-3)


def test_i_beam_torsion_is_near_that_of_its_walls(fem):
    sizes = {"width": 0.1, "height": 0.2, "flange": 0.008, "web": 0.005, "material": MATERIAL}
    exact, thin = (torsion(Section.i_beam(**sizes, torsion=word)) for word in ("saint-venant", "thin-wall"))
    assert 0.9 * thin < exact < 1.1 * thin
    exact, thin = (torsion(Section.box(**sizes, torsion=word)) for word in ("saint-venant", "thin-wall"))
    assert thin < exact < 1.05 * thin


def test_shear_center_of_a_channel(fem):
    """e = 3 b²t/(6 bt + hw) behind the web, between midlines: shear there does not twist."""
    b, h, t, w = 0.05, 0.1, 0.002, 0.002
    corners = [(0, 0), (b, 0), (b, t), (w, t), (w, h - t), (b, h - t), (b, h), (0, h)]
    section = Section.polygon(corners, MATERIAL)
    c = section.stiffness
    found = c[1, 5] / c[1, 1]  # Γ2 at the shear center is Γ2 + a1 Ω3
    wide, high = b - 0.5 * w, h - t
    behind = 0.5 * w - 3 * wide**2 * t / (6 * wide * t + high * w)
    assert found == pytest.approx(behind - areas(np.array(corners)).centroid[0], rel=0.02)
    assert c[0, 5] == pytest.approx(0.0, abs=1e-3 * abs(c[1, 5]))


def test_torsion_without_scikit_fem_is_one_clear_line(monkeypatch, refused):
    monkeypatch.setitem(sys.modules, "skfem", None)
    refused(
        lambda: Section.polygon(SQUARE, MATERIAL),
        ImportError,
        'Section.polygon: torsion = "saint-venant" needs scikit-fem for this shape; pip install "cayley[section]", or '
        "give torsion as a number [m^4]",
    )


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_cowpers_formulas_agree_where_they_meet(nu):
    assert cowper_ellipse(1.0, nu) == pytest.approx(cowper_tube(0.0, nu))
    assert cowper_walls(0.0, 1.0, nu, closed=False) == pytest.approx(cowper_rectangle(nu))
    assert cowper_walls(1.0, 1.0, nu, closed=True) == pytest.approx(20.0 * (1.0 + nu) / (48.0 + 39.0 * nu))
    assert cowper_ellipse(1e6, nu) == pytest.approx(36.0 * (1.0 + nu) / (40.0 + 37.0 * nu))


def test_words_for_the_shear_correction():
    def kappas(**options):
        return np.diag(Section.rectangle(1.0, 1.0, MATERIAL, **options).stiffness)[:2] / G

    np.testing.assert_allclose(kappas(shear_correction="none"), 1.0)
    np.testing.assert_allclose(kappas(shear_correction="cowper"), 10 * (1 + NU) / (12 + 11 * NU))
    np.testing.assert_allclose(kappas(), 5.0 / 6.0)


STIFF = np.diag([3.0, 4.0, 5.0, 1.0, 2.0, 1.5])
ROTARY = np.diag([0.3, 0.2, 0.5])


def test_mass_beside_the_axis_two_ways():
    """M of ½ v·M v is that of a body whose mass center is at c."""
    c, m = np.array([0.1, -0.2, 0.0]), 2.0
    one = Section.given(stiffness=STIFF, mass_per_length=m, inertia=ROTARY, mass_center=(0.1, -0.2))
    hat = np.array([[0.0, 0.0, c[1]], [0.0, 0.0, -c[0]], [-c[1], c[0], 0.0]])
    mass = np.block([[m * np.eye(3), -m * hat], [m * hat, ROTARY - m * hat @ hat]])
    other = Section.given(stiffness=STIFF, mass=mass)
    for section in (one, other):
        assert section.mass_center == pytest.approx((0.1, -0.2), rel=1e-14)
        np.testing.assert_allclose(section.inertia, mass[3:, 3:], rtol=1e-14)
        np.testing.assert_allclose(section.first_moment, m * c, rtol=1e-14)
    np.testing.assert_allclose(one.outline.mean(axis=0), c[:2], atol=1e-15)


def test_shear_center_shifts_shear_and_twist_only():
    moved = Section.given(stiffness=STIFF, mass_per_length=1.0, inertia=ROTARY, shear_center=(0.3, 0.1)).stiffness
    strain = np.array([0.2, -0.1, 0.3, 0.5, 0.7, -0.4])
    there = strain + np.array([-0.1 * strain[5], 0.3 * strain[5], 0, 0, 0, 0])
    assert strain @ moved @ strain == pytest.approx(there @ STIFF @ there, rel=1e-14)


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (
            lambda: Section.polygon([(0, 0), (1, 1), (1, 0), (0, 1)], MATERIAL),
            ValueError,
            "Section.polygon: outline crosses itself, edge 0 edge 2; give the corners in order",
        ),
        (
            lambda: Section.polygon([(0, 0), (1, 1), (2, 2)], MATERIAL),
            ValueError,
            "Section.polygon: outline has no area; outline must be 3 or more points (y1, y2) [m] around an area, shape "
            "(k, 2)",
        ),
        (
            lambda: Section.polygon(SQUARE, MATERIAL, holes=[SQUARE + 0.5]),
            ValueError,
            "Section.polygon: holes[0] is not inside the outline; give holes that are",
        ),
        (
            lambda: Section.polygon(SQUARE, MATERIAL, holes=[0.5 * SQUARE + 0.1, 0.5 * SQUARE + 0.2]),
            ValueError,
            "Section.polygon: holes[0] and holes[1] overlap; give holes that are apart",
        ),
        (
            lambda: Section.polygon(SQUARE, MATERIAL, shear_correction="cowper", torsion=1.0),
            ValueError,
            "Section.polygon: shear_correction = 'cowper' must be \"none\", a positive, finite number [-], or two of "
            "them",
        ),
        (
            lambda: Section.i_beam(width=0.1, height=0.2, flange=0.1, web=0.01, material=MATERIAL),
            ValueError,
            "Section.i_beam: flange = 0.1 must be below 0.1 m, for there is something between",
        ),
        (
            lambda: Section.given(stiffness=STIFF, mass_per_length=1.0),
            ValueError,
            "Section: mass_per_length or inertia is missing; give both, or mass (6 x 6)",
        ),
        (
            lambda: Section.given(stiffness=STIFF, mass=np.eye(6), inertia=ROTARY),
            ValueError,
            "Section: mass is given beside mass_per_length, inertia or mass_center; give one of the two",
        ),
        (
            lambda: Section(
                stiffness=STIFF, mass_per_length=1.0, inertia=ROTARY, outline=SQUARE, mass_center=(1.0, 0.0)
            ),
            ValueError,
            "Section: inertia = [[0.3, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.5]] must be greater than that of the "
            "mass at mass_center = (1.0, 0.0) (it is about the axis)",
        ),
    ],
)
def test_refusals(refused, call, error, line):
    refused(call, error, line)


def test_a_mass_that_is_no_bodys():
    mass = np.eye(6)
    mass[0, 3] = mass[3, 0] = 0.1
    with pytest.raises(ValueError, match=r"must be that of a body: \(\(m 1, -hat S\), \(hat S, J\)\)"):
        Section.given(stiffness=STIFF, mass=mass)
