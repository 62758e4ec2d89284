"""Stiffness and inertia of each shape against the formulas and against integrals over the area."""

import math

import mpmath
import numpy as np
import pytest

from cayley.model import Material, Section

RHO, E, NU = 1000.0, 5e6, 0.35
G = E / (2 * (1 + NU))
MATERIAL = Material(density=RHO, youngs_modulus=E, poisson_ratio=NU)
EYE6, EYE3 = np.eye(6), np.eye(3)


def test_rectangle_of_the_paper():
    section = Section.rectangle(0.01, 0.01, MATERIAL, shear_correction=1.0)
    area, moment = 1e-4, 1e-8 / 12
    expected = [G * area, G * area, E * area, E * moment, E * moment, G * 2 * moment]
    np.testing.assert_allclose(section.stiffness, np.diag(expected), rtol=1e-14)
    np.testing.assert_allclose(section.inertia, RHO * moment * np.diag([1, 1, 2]), rtol=1e-14)
    assert section.mass_per_length == pytest.approx(0.1, rel=1e-14)


def test_rectangle_has_its_width_along_e1():
    width, height = 0.02, 0.05
    section = Section.rectangle(width, height, MATERIAL)
    y1, y2 = _midpoints(width), _midpoints(height)
    cell = width * height / (y1.size * y2.size)
    about_e1 = float((y2**2).sum()) * y1.size * cell
    about_e2 = float((y1**2).sum()) * y2.size * cell
    area = width * height
    bend = [section.stiffness[3, 3] / E, section.stiffness[4, 4] / E]
    np.testing.assert_allclose(bend, [about_e1, about_e2], rtol=1e-5)
    np.testing.assert_allclose(np.diag(section.inertia) / RHO, [about_e1, about_e2, about_e1 + about_e2], rtol=1e-5)
    np.testing.assert_allclose(np.diag(section.stiffness)[:3], [5 / 6 * G * area, 5 / 6 * G * area, E * area])
    assert np.ptp(section.outline, axis=0).tolist() == [width, height]


def _midpoints(extent, n=400):
    return ((np.arange(n) + 0.5) / n - 0.5) * extent


def _torsion(section):
    return section.stiffness[5, 5] / G


@pytest.mark.parametrize("ratio", [1.0, 1.0001, 1.5, 2.0, 10.0, 1000.0, 1e6])
def test_saint_venant_torsion_against_the_series(ratio):
    with mpmath.workdps(30):
        total = mpmath.nsum(
            lambda k: mpmath.tanh((2 * k + 1) * mpmath.pi * ratio / 2) / (2 * k + 1) ** 5, [0, mpmath.inf]
        )
        exact = float(ratio * (mpmath.mpf(1) / 3 - 64 / mpmath.pi**5 / ratio * total))
    for width, height in ((ratio, 1.0), (1.0, ratio)):
        section = Section.rectangle(width, height, MATERIAL, torsion="saint-venant")
        assert _torsion(section) == pytest.approx(exact, rel=1e-12)


def test_saint_venant_torsion_of_known_shapes():
    square = Section.rectangle(1.0, 1.0, MATERIAL, torsion="saint-venant")
    assert _torsion(square) == pytest.approx(0.1405770149, abs=1e-10)
    strip = Section.rectangle(1.0, 1e-4, MATERIAL, torsion="saint-venant")
    assert _torsion(strip) == pytest.approx(1e-12 / 3 * (1 - 0.63025e-4), rel=1e-8)


def test_torsion_choices():
    polar = 0.02 * 0.05 * (0.02**2 + 0.05**2) / 12
    assert _torsion(Section.rectangle(0.02, 0.05, MATERIAL)) == pytest.approx(polar, rel=1e-14)
    assert _torsion(Section.rectangle(0.02, 0.05, MATERIAL, torsion="polar")) == pytest.approx(polar, rel=1e-14)
    assert _torsion(Section.rectangle(0.02, 0.05, MATERIAL, torsion=3e-8)) == pytest.approx(3e-8, rel=1e-14)


def test_circle():
    section = Section.circle(0.005, MATERIAL)
    area, moment = math.pi * 0.005**2, math.pi * 0.005**4 / 4
    kappa = 6 * (1 + NU) / (7 + 6 * NU)
    expected = [kappa * G * area, kappa * G * area, E * area, E * moment, E * moment, 2 * G * moment]
    np.testing.assert_allclose(section.stiffness, np.diag(expected), rtol=1e-14)
    np.testing.assert_allclose(section.inertia, RHO * moment * np.diag([1, 1, 2]), rtol=1e-14)
    assert section.mass_per_length == pytest.approx(RHO * area, rel=1e-14)
    np.testing.assert_allclose(np.linalg.norm(section.outline, axis=1), 0.005)
    assert _signed_area(section.outline) > 0


def _signed_area(outline):
    x, y = outline.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def test_tube():
    outer, inner = 0.02, 0.018
    section = Section.tube(outer_radius=outer, thickness=outer - inner, material=MATERIAL)
    area, moment = math.pi * (outer**2 - inner**2), math.pi * (outer**4 - inner**4) / 4
    np.testing.assert_allclose(
        np.diag(section.stiffness)[2:], [E * area, E * moment, E * moment, 2 * G * moment], rtol=1e-12
    )
    np.testing.assert_allclose(section.inertia, RHO * moment * np.diag([1, 1, 2]), rtol=1e-12)


def test_tube_shear_correction_ends_in_thin_ring_and_circle():
    def kappa(section):
        return section.stiffness[0, 0] / section.stiffness[2, 2] * E / G

    thin = Section.tube(outer_radius=1.0, thickness=1e-6, material=MATERIAL)
    assert kappa(thin) == pytest.approx(2 * (1 + NU) / (4 + 3 * NU), rel=1e-10)
    thick = Section.tube(outer_radius=1.0, thickness=1.0 - 1e-6, material=MATERIAL)
    assert kappa(thick) == pytest.approx(kappa(Section.circle(1.0, MATERIAL)), rel=1e-10)


@pytest.mark.parametrize("value", [(0.8, 0.9), [0.8, 0.9], np.array([0.8, 0.9])])
def test_shear_correction_for_each_axis(value):
    section = Section.circle(1.0, MATERIAL, shear_correction=value)
    np.testing.assert_allclose(np.diag(section.stiffness)[:2], [0.8 * G * math.pi, 0.9 * G * math.pi])


def test_given_keeps_coupling_and_is_drawn_with_the_same_moments():
    stiffness = np.diag([3.0, 4.0, 5.0, 1.0, 2.0, 1.5])
    stiffness[2, 3] = stiffness[3, 2] = 0.5
    section = Section.given(stiffness=stiffness.tolist(), mass_per_length=2.0, inertia=np.diag([0.3, 0.2, 0.5]))
    np.testing.assert_array_equal(section.stiffness, stiffness)
    half_width, half_height = section.outline.max(axis=0)
    assert 2.0 * half_height**2 / 4 == pytest.approx(0.3)
    assert 2.0 * half_width**2 / 4 == pytest.approx(0.2)


def test_arrays_are_read_only_and_no_longer_the_users():
    stiffness = EYE6.copy()
    section = Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=EYE3)
    stiffness[0, 0] = 7.0
    assert section.stiffness[0, 0] == 1.0
    for values in (section.stiffness, section.inertia, section.outline):
        with pytest.raises(ValueError, match="read-only"):
            values[0, 0] = 1.0


def test_asymmetry_at_round_off_is_removed():
    stiffness = EYE6 * 1e9
    stiffness[0, 1] = 1e-3
    section = Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=EYE3)
    np.testing.assert_array_equal(section.stiffness, section.stiffness.T)


def test_definite_across_units():
    """A steel wire has EA/EI = 4e6: that is no reason to call the bending stiffness zero."""
    stiffness = np.diag([1e12, 1e12, 1e12, 1e-6, 1e-6, 1e-6])
    assert Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=EYE3).stiffness[3, 3] == 1e-6


def test_repr_is_one_line():
    assert repr(Section.circle(0.01, MATERIAL)) == "Section('circle of radius 0.01 m', mass_per_length=0.314159)"


def _changed(size, entries):
    matrix = np.eye(size)
    for place, value in entries.items():
        matrix[place] = value
    return matrix


STIFFNESS = (
    "a symmetric, positive definite 6 x 6 matrix (shear 1, shear 2, axial, bend 1, bend 2, twist [N, N m, N m^2])"
)
INERTIA = "a symmetric, positive definite 3 x 3 matrix (about e1, e2, e3 [kg m])"


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (
            lambda: Section.rectangle(-0.01, 0.01, MATERIAL),
            ValueError,
            "Section.rectangle: width = -0.01 must be a positive, finite number [m]",
        ),
        (
            lambda: Section.rectangle(0.01, math.nan, MATERIAL),
            ValueError,
            "Section.rectangle: height = nan must be a positive, finite number [m]",
        ),
        (
            lambda: Section.rectangle(0.01, 0.01, MATERIAL, torsion="exact"),
            ValueError,
            'Section.rectangle: torsion = \'exact\' must be "polar", "saint-venant" or a number [m^4]',
        ),
        (
            lambda: Section.rectangle(0.01, 0.01, MATERIAL, torsion=0),
            ValueError,
            "Section.rectangle: torsion = 0 must be a positive, finite number [m^4]",
        ),
        (
            lambda: Section.rectangle(0.01, 0.01, 7850.0),
            TypeError,
            "Section.rectangle: material = 7850.0 must be a Material",
        ),
        (
            lambda: Section.circle(0.01, None),
            TypeError,
            "Section.circle: material = None must be a Material",
        ),
        (
            lambda: Section.circle(0.0, MATERIAL),
            ValueError,
            "Section.circle: radius = 0.0 must be a positive, finite number [m]",
        ),
        (
            lambda: Section.circle(0.1, MATERIAL, shear_correction=-1),
            ValueError,
            "Section.circle: shear_correction = -1 must be a positive, finite number [-]",
        ),
        (
            lambda: Section.circle(0.1, MATERIAL, shear_correction=(1.0, 0.0)),
            ValueError,
            "Section.circle: shear_correction = (1.0, 0.0) must be a positive, finite number [-], or two of them",
        ),
        (
            lambda: Section.circle(0.1, MATERIAL, shear_correction=(1.0, 1.0, 1.0)),
            ValueError,
            "Section.circle: shear_correction = (1.0, 1.0, 1.0) must be a positive, finite number [-], or two of them",
        ),
        (
            lambda: Section.tube(outer_radius=0.1, thickness=0.1, material=MATERIAL),
            ValueError,
            "Section.tube: thickness = 0.1 must be below outer_radius = 0.1 m (a solid bar is Section.circle)",
        ),
        (
            lambda: Section.given(stiffness=EYE6, mass_per_length=0, inertia=EYE3),
            ValueError,
            "Section: mass_per_length = 0 must be a positive, finite number [kg/m]",
        ),
        (
            lambda: Section.given(stiffness=np.eye(2), mass_per_length=1, inertia=EYE3),
            ValueError,
            f"Section: stiffness = array([[1., 0.], [0., 1.]]) must be {STIFFNESS}",
        ),
        (
            lambda: Section.given(stiffness="stiff", mass_per_length=1, inertia=EYE3),
            TypeError,
            f"Section: stiffness = 'stiff' must be {STIFFNESS}",
        ),
        (
            lambda: Section.given(stiffness=_changed(6, {(0, 1): 0.1}), mass_per_length=1, inertia=EYE3),
            ValueError,
            f"Section: stiffness[0, 1] = 0.1 and stiffness[1, 0] = 0 differ, but stiffness must be {STIFFNESS}",
        ),
        (
            lambda: Section.given(stiffness=_changed(6, {(5, 5): 0}), mass_per_length=1, inertia=EYE3),
            ValueError,
            f"Section: stiffness[5, 5] = 0, but stiffness must be {STIFFNESS}",
        ),
        (
            lambda: Section.given(stiffness=_changed(6, {(0, 1): 2, (1, 0): 2}), mass_per_length=1, inertia=EYE3),
            ValueError,
            f"Section: stiffness has the scaled eigenvalue -1, but must be {STIFFNESS}",
        ),
        (
            lambda: Section.given(stiffness=EYE6, mass_per_length=1, inertia=[[1, 0, 0], [0, 1], [0, 0, 1]]),
            ValueError,
            f"Section: inertia = [[1, 0, 0], [0, 1], [0, 0, 1]] must be {INERTIA}",
        ),
        (
            lambda: Section.given(stiffness=EYE6, mass_per_length=1, inertia=np.diag([1, 1, math.nan])),
            ValueError,
            f"Section: inertia = array([[ 1., 0., 0.], [ 0., 1., 0.], [ 0., 0., nan]]) must be {INERTIA}",
        ),
    ],
)
def test_refusals(refused, call, error, line):
    refused(call, error, line)
