"""Curved, twisted, composite and tapered cantilevers against published and exact displacements of their tips.

Values: 45-degree bend, Bathe and Bolourchi (1979), with the constants that explain the scatter of the literature solved
by shooting; composite beam and twisted beam, Wang et al. (2017) as in kynema's regression tests; taper, by hand.
"""

import numpy as np
import pytest
from scipy.linalg import eigh

import cayley as cy
from cayley.discrete import rules
from reference.statics import Discrete

STEPS = np.linspace(0.1, 1.0, 10)


def tip(rod, rule, force, shares=(1.0,)):
    """Position of the tip of a clamped rod under a dead force there."""
    discrete = Discrete(cy.Model(rod, supports=[cy.supports.clamp(rod.start)]), rules.by_name(rule))
    load = np.zeros((discrete.system.size, discrete.layout.dofs))
    load[-1, discrete.layout.dofs_of("x")] = force
    return discrete.settled(shares=shares, more=load.reshape(-1))[-1, discrete.layout.rows_of("x")]


def given(stiffness):
    return cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=np.eye(3))


def bend(torsion, elements):
    """An eighth of a circle of radius 100, a unit square with E = 1e7 and ν = 0."""
    section = given(np.diag([5e6, 5e6, 1e7, 1e7 / 12, 1e7 / 12, 5e6 * torsion]))
    arc = lambda u: (100.0 * np.sin(u), 100.0 * (1.0 - np.cos(u)), 0.0)  # noqa: E731
    return cy.Rod.along(section, arc, span=(0.0, np.pi / 4), elements=elements)


BEND = {1 / 6: (47.15043857, 15.68480053, 53.47485879), 0.141: (46.89676960, 15.56032540, 53.60485846)}


@pytest.mark.parametrize("torsion", BEND)
def test_bend_of_45_degrees(torsion):
    exact = np.array(BEND[torsion])
    np.testing.assert_allclose(tip(bend(torsion, 2), "spectral(space=6)", (0, 0, 600.0), STEPS), exact, atol=1e-6)
    coarse, fine = (tip(bend(torsion, n), "verlet", (0, 0, 600.0), STEPS) for n in (8, 16))
    assert np.abs(coarse - exact).max() < 0.25
    np.testing.assert_allclose((4.0 * fine - coarse) / 3.0, exact, atol=3e-3)


def test_bend_starts_where_it_should():
    np.testing.assert_allclose(bend(1 / 6, 8).positions[-1], (70.71067812, 29.28932188, 0.0), atol=1e-8)
    assert bend(1 / 6, 8).length == pytest.approx(25.0 * np.pi, rel=1e-13)


def composite():
    """Stiffness with coupled torsion and bending; published order axial, shear 2, shear 3, torsion, bend 2, bend 3."""
    c = np.diag([1368.17e3, 88.56e3, 38.78e3, 0.0, 0.0, 0.0])
    c[3:, 3:] = 1e3 * np.array([[16.96, 17.61, -0.351], [17.61, 59.12, -0.370], [-0.351, -0.370, 141.47]])
    ours = [1, 2, 0, 4, 5, 3]
    return given(c[np.ix_(ours, ours)])


def test_composite_beam():
    exact = (10.0 - 9.02726627566299e-2, -6.47488486259036e-2, 1.22973648292371)
    rod = cy.Rod(composite(), length=10.0, elements=4, direction=(1, 0, 0), normal=(0, 1, 0))
    np.testing.assert_allclose(tip(rod, "spectral(space=4)", (0, 0, 150.0), STEPS), exact, atol=1e-9)


def twisted(elements):
    """Straight, the sections turning by a right angle."""
    c = np.diag([8.2604167e9, 8.2604167e9, 2.5e10, 5.20833e8, 1.30208333e8, 1.41872656e8])
    line = lambda u: (u, 0.0, 0.0)  # noqa: E731
    return cy.Rod.along(given(c), line, span=(0.0, 10.0), elements=elements, normal=(0, 1, 0), twist=np.pi / 2)


def test_twisted_beam():
    exact = np.array([10.0 - 1.14152599953942, -1.71805334646388, -3.59321324026952])
    force = (0, 0, -4e6)
    np.testing.assert_allclose(tip(twisted(2), "spectral(space=8)", force, STEPS), exact, atol=1e-9)
    for rule in ("verlet", "screw"):
        coarse, fine = (tip(twisted(n), rule, force, STEPS) for n in (16, 32))
        np.testing.assert_allclose((4.0 * fine - coarse) / 3.0, exact, atol=1e-4)


@pytest.mark.parametrize(("rule", "elements", "atol"), [("spectral(space=4)", 4, 1e-7), ("verlet", 64, 1e-3)])
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
    assert tip(rod, rule, (0, 0, force))[2] == pytest.approx(sag, rel=atol)


def test_weight_beside_the_axis_twists():
    """Torque m g c per length: the tip turns by m g c l²/(2 G It)."""
    c6 = np.diag([1e6, 1e6, 1e6, 1e4, 1e4, 1e4])
    section = cy.Section.given(stiffness=c6, mass_per_length=2.0, inertia=np.eye(3), mass_center=(0.1, 0.0))
    rod = cy.Rod(section, length=2.0, elements=8, direction=(1, 0, 0), normal=(0, 1, 0))
    gravity = cy.loads.gravity((0, 0, -1e-3))
    discrete = Discrete(cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[gravity]), rules.verlet)
    p = discrete.settled()[-1, discrete.layout.rows_of("p")]
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
    discrete = Discrete(cy.Model(rod, supports=[cy.supports.clamp(rod.start)]), rules.verlet)
    stiffness = discrete.strained(discrete.system.reference)[1].toarray()
    masses = np.diag(discrete.node_terms()[1])
    lowest = np.sqrt(eigh(stiffness, masses, eigvals_only=True, subset_by_index=[0, 1]))
    exact = ritz(r) * np.sqrt(root.stiffness[3, 3] / root.mass_per_length)
    np.testing.assert_allclose(lowest, exact, rtol=1e-3)
    assert ritz(1.0) == pytest.approx(1.875104068711961**2, rel=1e-9)
