"""Sections that change along a rod."""

import numpy as np
import pytest

from cayley.model import Material, Rod, Section
from cayley.model.samples import basis, chebyshev
from cayley.model.stations import PER_ELEMENT, Stations

MATERIAL = Material(density=1000.0, youngs_modulus=1e7, poisson_ratio=0.3)
THIN, THICK = Section.circle(0.01, MATERIAL), Section.circle(0.02, MATERIAL)


def cone(s):
    return Section.circle(0.02 - 0.005 * s, MATERIAL)


@pytest.mark.parametrize("count", [1, 2, 5, 13])
def test_polynomials_through_chebyshev_points_are_exact(count):
    at = np.array([0.0, 0.1, 0.5, 0.77, 1.0, *chebyshev(count)])
    for degree in range(count):
        np.testing.assert_allclose(basis(count, at) @ chebyshev(count) ** degree, at**degree, atol=1e-14)
    np.testing.assert_array_equal(basis(count, chebyshev(count)), np.eye(count))


def test_one_section_stays_one():
    assert Rod(THIN, length=1.0, elements=2).section is THIN
    assert Rod([THIN, THIN], length=1.0, elements=2).section is THIN


def test_one_for_each_element():
    rod = Rod([THIN, THICK, THIN], length=3.0, elements=3)
    assert rod.sections == (THIN, THICK, THIN)
    assert rod.mass == pytest.approx(2.0 * THIN.mass_per_length + THICK.mass_per_length, rel=1e-15)
    assert "circle of radius 0.01 m" in repr(rod)


def test_a_function_is_exact_between_its_stations():
    rod = Rod(cone, length=2.0, elements=3)
    places = np.array([0.13, 0.5, 0.9])
    found = rod.stations.at("stiffness", places)
    for e in range(3):
        for k, u in enumerate(places):
            exact = cone(2.0 / 3.0 * (e + u)).stiffness
            np.testing.assert_allclose(found[e, k], exact, rtol=1e-12, atol=1e-12)
    exact = 1000.0 * np.pi * (0.02**3 - 0.01**3) / (3.0 * 0.005)
    assert rod.mass == pytest.approx(exact, rel=1e-13)


def test_a_function_is_asked_once_at_each_station():
    asked = []

    def counted(s):
        asked.append(s)
        return cone(s)

    Rod(counted, length=2.0, elements=3)
    assert len(asked) == len(set(asked)) == 3 * (PER_ELEMENT - 1) + 1
    assert (min(asked), max(asked)) == (0.0, 2.0)


SQUARE = Section.rectangle(0.01, 0.01, MATERIAL)


@pytest.mark.parametrize(
    ("given", "error", "line"),
    [
        ([THIN], ValueError, "Rod: section has 1 sections, but must have 2, one an element"),
        (
            [THIN, SQUARE],
            ValueError,
            "Rod: the outlines of its sections have 4 and 32 points; give sections of one shape",
        ),
        (lambda s: s, TypeError, "Rod: section of element 0 = 0.0 must be a Section"),
        (
            Stations(((THIN,), (THICK,), (THIN,))),
            ValueError,
            "Rod: section has stations for 3 elements, but must have one for each of the 2 elements",
        ),
    ],
)
def test_refusals(refused, given, error, line):
    refused(lambda: Rod(given, length=1.0, elements=2), error, line)
