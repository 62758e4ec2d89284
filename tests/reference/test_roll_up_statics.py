"""Rods rolled up, unrolled and wound to helices by end moments: shapes of constant strain, exact on any mesh.

Elements of `screw` have constant strain, so nothing but Newton's tolerance is left of any error.
"""

import numpy as np
import pytest

import cayley as cy
from cayley import loads
from reference.cantilevers import CUBIC, given, places, published, rest, straight

MESHES = (3, 4, 5, 10, 20)


def arc(length, turns, s):
    """Points of a rod that began along x and turns up, in units of its length: (x, 0, z)."""
    curvature = 2.0 * np.pi * turns / length
    return np.stack([np.sin(curvature * s), 0.0 * s, 1.0 - np.cos(curvature * s)], axis=1) / curvature


def rolled(section, length, elements, turns, **options):
    """Nodes under the moment 2π EI/l times the turns, about −y, and those of the arc; and the equilibrium."""
    rod = straight(section, length, elements)
    moment = 2.0 * np.pi * turns * section.stiffness[3, 3] / length
    found = rest(rod, loads.moment(rod.end, (0.0, -moment, 0.0)), **options)
    return found[rod].position.values, arc(length, turns, np.linspace(0.0, length, elements + 1)), found


@pytest.mark.parametrize("elements", MESHES)
def test_circle_of_beamdyn(elements):
    """Wang et al. (2017): u = (−10, 0, 0); one Legendre element of 3, 6, 9, 12 nodes: −15.6, −11, −10.06, −10.0000."""
    section = published([1770e3, 1770e3, 1770e3, 8.16e3, 86.9e3, 215e3])
    found, exact, _ = rolled(section, 10.0, elements, 1.0)
    np.testing.assert_allclose(found, exact, atol=1e-9 * 10.0)
    np.testing.assert_allclose(found[-1], 0.0, atol=1e-9 * 10.0)


@pytest.mark.parametrize("turns", [0.2, 0.4, 0.6, 0.8, 0.9, 1.0])
def test_moments_of_gxbeam(turns):
    """GXBeam's list λ = 0.4 to 2 of M = λ π EI/l, whose own tolerance with 16 elements is 5e-2."""
    section = given([1.5e7, 1.5e7, 30e6, 30e6 / 12, 30e6 / 12, 1.5e7 / 6])
    found, exact, _ = rolled(section, 12.0, 16, turns)
    np.testing.assert_allclose(found, exact, atol=1e-9 * 12.0)


def test_nodes_of_code_aster():
    """SSNL103, 5 elements: u(0.4) = −0.30645, u(0.6) = −0.69355, u(1) = −1; published −0.30, −0.70, −1.00.

    The document's two digits are not those of the exact circle.
    """
    found, _, _ = rolled(given([200.0, 200.0, 400.0, 2.0, 2.0, 1.6]), 1.0, 5, 1.0)
    moved = found[:, 0] - np.linspace(0.0, 1.0, 6)
    np.testing.assert_allclose(moved[[2, 3, 5]], (-0.30645, -0.69355, -1.0), atol=1e-5)
    np.testing.assert_allclose(moved[[2, 3, 5]], (-0.30, -0.70, -1.00), atol=7e-3)


def test_double_circle_of_simo_and_vu_quoc():
    """Simo and Vu-Quoc (1986), example 7.1: M = 8π winds l = 1, EI = 2 twice, 5 elements."""
    found, exact, _ = rolled(given([200.0, 200.0, 400.0, 2.0, 2.0, 1.6]), 1.0, 5, 2.0)
    np.testing.assert_allclose(found, exact, atol=1e-9)


@pytest.mark.parametrize("slenderness", [10.0, 1e2, 1e3, 1e4])
@pytest.mark.parametrize("elements", MESHES)
def test_circle_in_few_load_steps(elements, slenderness):
    """At most 10 load steps, whatever the mesh and l √(A/I); the tip to 1e-9, or what rounding of EA leaves of it."""
    axial = slenderness**2
    found, _, equilibrium = rolled(given([0.4 * axial, 0.4 * axial, axial, 1.0, 1.0, 0.8]), 1.0, elements, 1.0)
    assert np.abs(found[-1]).max() < 1e-9 + 1e-16 * axial
    assert equilibrium.load_steps <= 10
    assert equilibrium.iterations <= 40
    assert equilibrium.free_motions == []


@pytest.mark.parametrize(("rule", "elements", "within"), [(cy.rules.screw, 5, 1e-9), (CUBIC, 10, 2e-6)], ids=str)
@pytest.mark.parametrize(("moment", "exact"), [(10.0, (0.0, 20.0 / np.pi)), (20.0, (10.0, 0.0))])
def test_unrolling(moment, exact, rule, elements, within):
    """Ibrahimbegovic (1995): a closed circle, unrolled; ten elements of 3 nodes: (−0.004, 6.364), (9.998, 0.017)."""
    radius = 5.0 / np.pi
    circle = lambda u: (radius * np.sin(u), radius * (1.0 - np.cos(u)), 0.0)  # noqa: E731
    section = given([600.0, 600.0, 1200.0, 100.0, 100.0, 100.0])
    rod = cy.Rod.along(section, circle, span=(0.0, 2.0 * np.pi), elements=elements)
    found = places(rod, loads.moment(rod.end, (0.0, 0.0, -moment * np.pi)), rule=rule)
    np.testing.assert_allclose(found[-1], (*exact, 0.0), atol=10.0 * within)


@pytest.mark.parametrize(("slenderness", "elements"), [(1e1, 10), (1e2, 10), (1e3, 10), (1e4, 64)])
def test_helix(slenderness, elements):
    """Herrmann et al. (2025): a straight rod of diameter l/ρ, wound to two coils by a moment that turns with its tip.

    With ρ = 1e4, EA l²/EI is 1.6e9, and rounding keeps Newton's method from converging where EA Δs²/EI > 1e7.
    """
    radius, height, coils = 10.0, 50.0, 2
    rise = height / (2.0 * np.pi * radius * coils)
    stretch = np.sqrt(1.0 + rise**2)
    length, angle = 2.0 * np.pi * radius * coils * stretch, 2.0 * np.pi * coils
    diameter = length / slenderness
    area, bending = np.pi * diameter**2 / 4.0, np.pi * diameter**4 / 64.0  # E = 1, G = 1/2: torsion is as stiff
    section = given([0.5 * area, 0.5 * area, area, bending, bending, bending])
    direction = np.array([1.0, 0.0, rise]) / stretch
    rod = cy.Rod(section, length=length, elements=elements, direction=direction, normal=(0, 1, 0))
    moment = radius * angle**2 / length**2 * bending * np.array([0.0, 1.0, rise])
    a = np.linspace(0.0, angle, elements + 1)
    exact = radius * np.stack([np.sin(a), 1.0 - np.cos(a), rise * a], axis=1)
    found = places(rod, loads.moment(rod.end, moment, frame="body"))
    np.testing.assert_allclose(found, exact, atol=1e-10 * length)
