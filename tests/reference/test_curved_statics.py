"""Curved, twisted and tapered cantilevers against published and exact displacements of their tips.

Values: 45-degree bend, Bathe and Bolourchi (1979), with the constants that explain the scatter of the literature solved
by shooting; twisted beam, Wang et al. (2017) as in kynema's regression tests; taper, by hand.
"""

import functools

import numpy as np
import pytest
from scipy.linalg import eigh

import cayley as cy
from cayley import loads
from reference.cantilevers import CUBIC, MIDPOINT, SCREW, SEXTIC, given, published, rest, richardson, tip


def bend(torsion, elements, width=1.0):
    """An eighth of a circle of radius 100, a square with E = 1e7 and ν = 0, and the torsion constant over width⁴."""
    c = np.array([5e6, 5e6, 1e7, 1e7 / 12, 1e7 / 12, 5e6 * torsion])
    arc = lambda u: (100.0 * np.sin(u), 100.0 * (1.0 - np.cos(u)), 0.0)  # noqa: E731
    section = given(c * width ** np.array([2, 2, 2, 4, 4, 4]))
    return cy.Rod.along(section, arc, span=(0.0, np.pi / 4), elements=elements)


@functools.cache
def bent(torsion, elements, force, rule, width=1.0):
    """Its tip under a dead force out of its plane, given for a unit square."""
    rod = bend(torsion, elements, width)
    return tip(rod, loads.force(rod.end, (0.0, 0.0, force * width**4)), rule=rule)


BEND = {
    (1 / 6, 300): (58.77912249, 22.24478095, 40.19189167),
    (1 / 6, 450): (52.23855801, 18.50817893, 48.50292734),
    (1 / 6, 600): (47.15043857, 15.68480053, 53.47485879),
    (0.141, 300): (58.54051345, 22.11524022, 40.47479492),
    (0.141, 450): (51.97476247, 18.37204303, 48.70096723),
    (0.141, 600): (46.89676960, 15.56032540, 53.60485846),
}
"""Tips by torsion constant and force; 1/6 is polar, 0.141 Saint-Venant's."""
SIMO_VU_QUOC = {300: (58.84, 22.33, 40.08), 450: (52.32, 18.62, 48.39), 600: (47.23, 15.79, 53.37)}
EXUDYN = {300: (58.60, 22.14, 40.36), 450: (52.05, 18.40, 48.57), 600: (46.98, 15.59, 53.46)}
"""Published tips with 8 linear elements, torsion constants 1/6 and 0.141."""


@pytest.mark.parametrize(("torsion", "force"), BEND)
def test_bend_of_45_degrees(torsion, force):
    """Bathe and Bolourchi (1979): 4 elements of degree 6, and two-node elements alone and extrapolated."""
    exact, peers = np.array(BEND[torsion, force]), (SIMO_VU_QUOC if torsion > 0.15 else EXUDYN)[force]
    np.testing.assert_allclose(bent(torsion, 4, force, SEXTIC), exact, atol=1e-7)
    assert np.abs(bent(torsion, 8, force, MIDPOINT) - exact).max() < 0.23
    assert np.abs(np.array(peers) - exact).max() < 0.16
    if force == 600:
        np.testing.assert_allclose(richardson(lambda n: bent(torsion, n, force, MIDPOINT), 16), exact, atol=1e-4)


@pytest.mark.parametrize(("rule", "elements"), [(MIDPOINT, 16), (SCREW, 16), (CUBIC, 4)], ids=str)
def test_slender_bends(rule, elements):
    """Herrmann et al. (2025): squares of R/ρ, forces in proportion; from ρ = 100 to 10 000 the tip does not move."""
    widths = (1.0, 0.1, 0.01)
    found = np.array([bent(1 / 6, elements, 600.0, rule, width) for width in widths])
    exact = np.array([bent(1 / 6, 4, 600.0, SEXTIC, width) for width in widths])
    assert np.ptp(found, axis=0).max() < 1e-2  # stretch of ρ = 100, which is no error
    assert np.ptp(found[1:], axis=0).max() < 1e-3
    errors = np.abs(found - exact).max(axis=1)
    np.testing.assert_allclose(errors, errors[0], rtol=0.02)


def test_bend_starts_where_it_should():
    np.testing.assert_allclose(bend(1 / 6, 8).positions[-1], (70.71067812, 29.28932188, 0.0), atol=1e-8)
    assert bend(1 / 6, 8).length == pytest.approx(25.0 * np.pi, rel=1e-13)


TWISTED = (10.0 - 1.14152599953942, -1.71805334646388, -3.59321324026952)


@pytest.mark.parametrize(("rule", "elements", "within"), [(SEXTIC, 4, 1e-10), (CUBIC, 16, 1e-7), (SCREW, 0, 1e-6)])
def test_twisted_beam(rule, elements, within):
    """Straight, the sections turning by a right angle; screw with 16, 32 and 64 elements, extrapolated."""
    section = published([2.5e10, 8.2604167e9, 8.2604167e9, 1.41872656e8, 5.20833e8, 1.30208333e8])

    def found(count):
        line = lambda u: (u, 0.0, 0.0)  # noqa: E731
        rod = cy.Rod.along(section, line, span=(0.0, 10.0), elements=count, normal=(0, 1, 0), twist=np.pi / 2)
        return tip(rod, loads.force(rod.end, (0.0, 0.0, -4e6)), rule=rule)

    np.testing.assert_allclose(found(elements) if elements else richardson(found, 16), TWISTED, atol=within)


@pytest.mark.parametrize(("rule", "elements", "atol"), [(SEXTIC, 4, 1e-7), (SCREW, 64, 1e-3)], ids=str)
def test_tip_of_a_cone(rule, elements, atol):
    """w = P l³/(3 E I₀ r) + P l/(κ G A₀ r) for a radius that falls evenly to r times itself."""
    steel, r, length, force = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3), 0.4, 2.0, 1e-3
    root = cy.Section.circle(0.05, steel)
    rod = cy.Rod(
        lambda s: cy.Section.circle(0.05 * (1 - (1 - r) * s / length), steel),
        length=length,
        elements=elements,
        direction=(1, 0, 0),
    )
    sag = force * length**3 / (3.0 * root.stiffness[3, 3] * r) + force * length / (root.stiffness[0, 0] * r)
    assert tip(rod, loads.force(rod.end, (0, 0, force)), rule=rule)[2] == pytest.approx(sag, rel=atol)


def test_weight_beside_the_axis_twists():
    """Torque m g c per length: the tip turns by m g c l²/(2 G It)."""
    c6 = np.diag([1e6, 1e6, 1e6, 1e4, 1e4, 1e4])
    section = cy.Section.given(stiffness=c6, mass_per_length=2.0, inertia=np.eye(3), mass_center=(0.1, 0.0))
    rod = cy.Rod(section, length=2.0, elements=8, direction=(1, 0, 0), normal=(0, 1, 0))
    p = rest(rod, loads.gravity((0, 0, -1e-3)))[rod].rotation.values[-1]
    normal = 2.0 * (p[1] * p[3] - p[0] * p[2])  # z of the turned e1, which began along y
    assert normal == pytest.approx(-2.0 * 1e-3 * 0.1 * 2.0**2 / (2.0 * 1e4), rel=1e-6)


def ritz(r, terms=8):
    """Lowest ω √(ρ A₀ l⁴/(E I₀)) of the slender cone, by Rayleigh and Ritz with x², x³, ... in the exact integrals."""
    x, w = np.polynomial.legendre.leggauss(40)
    x, w = 0.5 + 0.5 * x, 0.5 * w
    taper = 1.0 - (1.0 - r) * x
    powers = np.arange(2, 2 + terms)[:, None]
    shapes, bends = x**powers, powers * (powers - 1) * x ** (powers - 2)
    stiffness, mass = (bends * w * taper**4) @ bends.T, (shapes * w * taper**2) @ shapes.T
    return float(np.sqrt(eigh(stiffness, mass, eigvals_only=True)[0]))


def test_lowest_frequency_of_a_cone():
    steel, r = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3), 0.4
    root = cy.Section.circle(0.005, steel)
    rod = cy.Rod(lambda s: cy.Section.circle(0.005 * (1 - (1 - r) * s), steel), length=1.0, elements=60)
    still = rest(rod).still
    stiffness, masses = (-still.matrix(order).toarray()[np.ix_(still.free, still.free)] for order in (0, 2))
    lowest = np.sqrt(eigh(stiffness, masses, eigvals_only=True, subset_by_index=[0, 1]))
    exact = ritz(r) * np.sqrt(root.stiffness[3, 3] / root.mass_per_length)
    np.testing.assert_allclose(lowest, exact, rtol=1e-3)
    assert ritz(1.0) == pytest.approx(1.875104068711961**2, rel=1e-9)
