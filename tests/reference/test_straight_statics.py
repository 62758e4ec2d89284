"""Straight cantilevers under dead forces at their tips: elastica, Princeton beam, composite and Timoshenko beams."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from cayley import loads
from reference.cantilevers import CUBIC, MIDPOINT, SEXTIC, given, published, richardson, straight, tip

FORCES = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 16.0)


def elastica(force):
    """(x, w)/l of the tip of Euler's cantilever under a transverse force F l²/EI, by elliptic integrals."""

    def modulus(delta):
        return np.sin(np.pi / 4.0) / np.sin(delta)

    def excess(delta):
        m = modulus(delta) ** 2
        return (ellipk(m) - ellipkinc(delta, m)) ** 2 - force

    delta = brentq(excess, np.pi / 4.0 + 1e-12, np.pi / 2.0 - 1e-12, xtol=1e-15)
    m = modulus(delta) ** 2
    slope = 2.0 * (np.pi / 4.0 - np.arccos(np.sqrt(m)))
    return np.sqrt(2.0 * np.sin(slope) / force), 1.0 - 2.0 / np.sqrt(force) * (ellipe(m) - ellipeinc(delta, m))


def test_elliptic_integrals():
    """Those of the table of Mattiasson (1981), F l²/EI = 1 and 10."""
    np.testing.assert_allclose(elastica(1.0), (1.0 - 0.0564332363, 0.3017207738), atol=1e-9)
    np.testing.assert_allclose(elastica(10.0), (1.0 - 0.5549955978, 0.8106090249), atol=1e-9)


def slender(elements, **options):
    """A rod of l = EI = 1 whose shear and stretch, 1e9, do not show."""
    return straight(given([1e9, 1e9, 1e9, 1.0, 1.0, 1.0]), 1.0, elements, **options)


@pytest.mark.parametrize("force", FORCES)
def test_elastica(force):
    """16 elements of degree 3: 1e-6; GXBeam's tolerance with 16 elements is 1e-3."""
    x, w = elastica(force)
    rod = slender(16)
    found = tip(rod, loads.force(rod.end, (0.0, 0.0, force)), rule=CUBIC)
    np.testing.assert_allclose(found, (x, 0.0, w), atol=1e-6)


@pytest.mark.parametrize("kinematics", ["unshearable", "inextensible"])
@pytest.mark.parametrize("force", [1.0, 5.0, 10.0])
def test_elastica_of_kirchhoff_rods(force, kinematics):
    """Shear, or shear and stretch, ruled out by constraints: two-node elements, 16, 32 and 64, extrapolated."""

    def found(elements):
        rod = slender(elements, kinematics=kinematics)
        return tip(rod, loads.force(rod.end, (0.0, 0.0, force)), rule=MIDPOINT)

    x, w = elastica(force)
    np.testing.assert_allclose(richardson(found, 16), (x, 0.0, w), atol=1e-6)


PRINCETON = {
    0: (-0.00013552, -0.01071276, 0.0),
    15: (-0.00224846, -0.01064358, 0.04219245),
    30: (-0.00768097, -0.01020761, 0.07954738),
    45: (-0.01441182, -0.00897920, 0.10911312),
    60: (-0.02048672, -0.00674204, 0.12995786),
    75: (-0.02458607, -0.00362198, 0.14221817),
    90: (-0.02602148, 0.0, 0.14625236),
}
"""Tip displacements [m] by angle of the load [deg], of an independent shooting solution."""
ANSYS = {
    0: (1.071417630e-2, 0.0),
    15: (1.061328706e-2, 4.208232124e-2),
    30: (1.011169630e-2, 7.939482948e-2),
    45: (8.837226265e-3, 0.108987937),
    60: (6.604665004e-3, 0.129887616),
    75: (3.538889001e-3, 0.142194370),
    90: (0.0, 0.146245978),
}
"""Magnitudes of v, w by ANSYS's beam (Obrezkov et al., Nonlinear Dynamics 109, 2022)."""


@pytest.mark.parametrize("angle", PRINCETON)
def test_princeton_beam(angle):
    """Dowell and Traybar's beam, 8.896 N, 8 elements of degree 3."""
    length, height, width, young = 0.508, 12.3777e-3, 3.2024e-3, 71.7e9
    area, flat, edge = height * width, height * width**3 / 12.0, width * height**3 / 12.0
    shear = young / (2.0 * 1.31)
    forces, torsion = [shear * area, shear * area, young * area], 0.198 * (flat + edge)
    section = given([*forces, young * flat, young * edge, shear * torsion])
    rod = straight(section, length, 8)
    along = np.radians(angle)
    force = 8.896 * np.array([0.0, -np.cos(along), np.sin(along)])
    moved = tip(rod, loads.force(rod.end, force), rule=CUBIC) - (length, 0.0, 0.0)
    np.testing.assert_allclose(moved, PRINCETON[angle], atol=1e-8)
    np.testing.assert_allclose(np.abs(moved[1:]), ANSYS[angle], atol=0.02 * 0.0107)


def test_composite_beam():
    """Wang et al. (2017), bending coupled with torsion: 4 elements of degree 6, to the published digits."""
    c = np.diag([1368.17e3, 88.56e3, 38.78e3, 0.0, 0.0, 0.0])
    c[3:, 3:] = 1e3 * np.array([[16.96, 17.61, -0.351], [17.61, 59.12, -0.370], [-0.351, -0.370, 141.47]])
    rod = straight(published(c), 10.0, 4)
    moved = tip(rod, loads.force(rod.end, (0.0, 0.0, 150.0)), rule=SEXTIC) - (10.0, 0.0, 0.0)
    np.testing.assert_allclose(moved, (-9.02726627566299e-2, -6.47488486259036e-2, 1.22973648292371), atol=1e-10)


def test_timoshenko_beam_of_pyelastica():
    """w = −F s/(κGA) − F l s²/(2 EI) + F s³/(6 EI), linear; the finite rotation makes it 3e-4 less here."""
    length, radius, young, shear, force = 3.0, 0.25, 1e6, 1e4, 15.0
    area, second = np.pi * radius**2, np.pi * radius**4 / 4.0
    section = given([27 / 28 * shear * area] * 2 + [young * area, young * second, young * second, 2.0 * shear * second])
    rod = straight(section, length, 10)
    linear = -force * length / section.stiffness[0, 0] - force * length**3 / (3.0 * young * second)
    found, small = (tip(rod, loads.force(rod.end, (0.0, 0.0, -share * force)), rule=CUBIC)[2] for share in (1.0, 1e-3))
    assert found == pytest.approx(linear, rel=1e-3)
    assert small == pytest.approx(1e-3 * linear, rel=1e-8)
