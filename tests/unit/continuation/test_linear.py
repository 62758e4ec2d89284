"""cy.buckling: factors, modes, refusals."""

import numpy as np
import pytest

import cayley as cy
from cayley import loads, supports

SECTION = cy.Section.given(
    stiffness=np.diag([1e5, 1e5, 1e5, 2.0, 1.0, 1.0]), mass_per_length=1.0, inertia=np.diag([1e-3, 1e-3, 2e-3])
)


def column(elements=8, beside=0.0):
    rod = cy.Rod(SECTION, length=1.0, direction=(0, 0, 1), elements=elements, name="rod")
    load, other = loads.force(rod.end, (0, 0, -1.0)), loads.force(rod.end, (0, 0, -beside))
    return cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[load, other]), load


def test_factors_rise_and_have_their_planes():
    """Few unknowns are solved at once, many by Lanczos iteration: both with the second factor twice the first."""
    for elements, near in ((4, 3e-2), (24, 1e-3)):
        model, load = column(elements)
        found = cy.buckling(model, load, count=3)
        assert found.factors[0] == pytest.approx(np.pi**2 / 4, rel=near)
        assert found.factors[1] == pytest.approx(2.0 * found.factors[0], rel=1e-3)
        first, second = (np.abs(mode["rod"].displacement.values).max(axis=0) for mode in found.modes[:2])
        assert first == pytest.approx([1, 0, 0], abs=1e-6)
        assert second == pytest.approx([0, 1, 0], abs=1e-6)


def test_other_loads_are_there_already():
    model, load = column()
    alone = cy.buckling(model, load).factors[0]
    model, load = column(beside=1.0)
    assert cy.buckling(model, load).factors[0] == pytest.approx(alone - 1.0, rel=1e-3)


def test_a_load_that_pulls_has_no_factor_but_a_negative_one():
    rod = cy.Rod(SECTION, length=1.0, direction=(0, 0, 1), elements=4, name="rod")
    load = loads.force(rod.end, (0, 0, 1.0))
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[load])
    assert np.all(cy.buckling(model, load, count=2).factors > 1e3)


def test_arguments_are_refused():
    model, load = column()
    with pytest.raises(TypeError, match="buckling: 'column' is no Model"):
        cy.buckling("column", load)
    with pytest.raises(ValueError, match="count = 0 must be"):
        cy.buckling(model, load, count=0)
    with pytest.raises(ValueError, match="about = nan must be a finite number"):
        cy.buckling(model, load, about=float("nan"))
