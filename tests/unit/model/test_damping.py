"""Damping objects: what they hold, their sums, and what they refuse."""

import numpy as np
import pytest

from cayley.model import Material, Model, Rod, Section, damping
from cayley.model.damping import Damping

STEEL = Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
SECTION = Section.circle(0.01, STEEL)


def test_ratio_is_met_at_its_frequency():
    given = damping.ratio(0.02, frequency=5.0)
    assert given.ratio_at(5.0) == pytest.approx(0.02)
    assert given.ratio_at(10.0) == pytest.approx(0.04)


def test_rayleigh_meets_both():
    given = damping.rayleigh((0.03, 2.0), (0.05, 20.0))
    assert given.ratio_at(2.0) == pytest.approx(0.03)
    assert given.ratio_at(20.0) == pytest.approx(0.05)
    assert given.ratio_at(6.0) < 0.03


def test_sum_of_parts():
    total = damping.retardation(1e-3) + damping.mass_proportional(2.0) + damping.viscous([1, 2, 3, 4, 5, 6])
    assert total.retardation == (1e-3,) * 6
    assert total.decay == 2.0
    np.testing.assert_array_equal(total.viscosity, np.diag([1, 2, 3, 4, 5, 6]))
    assert str(total) == "retardation 0.001 s, viscosity given, decay 2 1/s"


def test_times_of_single_strains_do_not_add_up():
    single = damping.retardation([1e-3, 0, 0, 0, 0, 0])
    with pytest.raises(ValueError, match="do not add up"):
        single + damping.retardation(1e-3)
    assert (single + damping.mass_proportional(1.0)).retardation == single.retardation


def test_model_lists_it():
    rod = Rod(SECTION, length=1.0, elements=2, damping=damping.retardation(1e-3))
    assert "radius 0.01 m, retardation 0.001 s" in str(Model(rod))


@pytest.mark.parametrize(
    ("make", "error", "told"),
    [
        (lambda: damping.retardation(-1.0), ValueError, "retardation"),
        (lambda: damping.retardation([1.0, 2.0]), ValueError, "6 numbers"),
        (lambda: damping.mass_proportional(float("nan")), ValueError, "decay"),
        (lambda: damping.mass_proportional(-1.0), ValueError, "not negative"),
        (lambda: damping.ratio(0.02, frequency=0.0), ValueError, "frequency"),
        (lambda: damping.rayleigh((0.1, 2.0), (0.1, 2.0)), ValueError, "another frequency"),
        (lambda: damping.rayleigh((0.01, 2.0), (0.5, 20.0)), ValueError, "must not be negative"),
        (lambda: damping.viscous(-np.eye(6)), ValueError, "positive semidefinite"),
        (lambda: damping.viscous(np.eye(3)), ValueError, "6 x 6"),
        (lambda: Rod(SECTION, length=1.0, elements=2, damping=0.1), TypeError, "made by cayley.damping"),
        (lambda: Damping(retardation="x"), TypeError, "retardation"),
    ],
)
def test_refusals(make, error, told):
    with pytest.raises(error, match=told):
        make()
