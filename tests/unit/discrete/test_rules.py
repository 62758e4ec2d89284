"""Rules are data: points with weights."""

import numpy as np
import pytest

import cayley as cy
from cayley.discrete.rules import (
    CORNERS,
    MIDDLE,
    RULES,
    Points,
    by_name,
    galerkin,
    gauss,
    lobatto,
    lobatto_weights,
    nodal,
    spectral,
    verlet,
)


@pytest.mark.parametrize(
    ("at", "weights"), [((0.0, 1.0), (0.5, 0.4)), ((0.0, 1.0), (1.0,)), ((0.5,), (0.5, 0.5)), ((), ())]
)
def test_weights_must_fit(at, weights):
    with pytest.raises(ValueError, match="Points mine: give as many weights as positions, of sum 1"):
        Points("mine", at, weights, corners=False)


@pytest.mark.parametrize("points", [CORNERS, MIDDLE], ids=lambda p: p.name)
def test_linear_functions_are_integrated_exactly(points):
    """Both are of order 2."""
    assert np.dot(points.weights, np.asarray(points.at)) == pytest.approx(0.5)
    assert sum(points.weights) == pytest.approx(1.0)


def test_the_paper_s_rule_and_the_one_without_locking():
    assert (nodal.time, nodal.strain) == (CORNERS, CORNERS)
    assert (verlet.time, verlet.strain) == (CORNERS, MIDDLE)
    assert nodal.order == verlet.order == 2
    assert cy.rules.verlet is verlet
    assert RULES["nodal"] is nodal
    assert [str(RULES[name]) for name in ("nodal", "verlet")] == ["nodal", "verlet"]


@pytest.mark.parametrize("count", range(1, 6))
def test_gauss_points(count):
    """n points integrate polynomials up to degree 2n - 1 and no further."""
    points = gauss(count)
    assert not points.corners
    for degree in range(2 * count + 1):
        error = abs(np.dot(points.weights, np.asarray(points.at) ** degree) - 1.0 / (degree + 1))
        assert (error < 1e-14) == (degree < 2 * count)


@pytest.mark.parametrize("degree", range(1, 6))
def test_lobatto_points(degree):
    """m + 1 points with both ends integrate polynomials up to degree 2m - 1 and no further."""
    at, weights = lobatto(degree), lobatto_weights(degree)
    assert (at[0], at[-1], len(at)) == (0.0, 1.0, degree + 1)
    for power in range(2 * degree + 1):
        error = abs(np.dot(weights, at**power) - 1.0 / (power + 1))
        assert (error < 1e-13) == (power < 2 * degree)


@pytest.mark.parametrize("degree", [0, 9, 1.0, True, "2"])
def test_degree_of_galerkin_rules(degree):
    with pytest.raises(ValueError, match="give a whole number from 1 to 8"):
        galerkin(time=degree)
    with pytest.raises(ValueError, match="galerkin: space is"):
        galerkin(time=1, space=degree)


@pytest.mark.parametrize("degree", [0, 9, 1.0, True, "2"])
def test_degree_of_spectral_rules(degree):
    with pytest.raises(ValueError, match=r"spectral: space is .*; give a whole number from 1 to 8"):
        spectral(space=degree)


def test_spectral_rules_by_name():
    for degree in (1, 4, 8):
        rule = spectral(space=degree)
        assert by_name(str(rule)) == rule
        assert (rule.implicit, rule.degree, rule.cell, rule.order) == (False, degree, degree, 2)
    with pytest.raises(
        ValueError, match=r"there is no rule 'spectral'; give one of nodal, .* or spectral\(space=...\)"
    ):
        by_name("spectral")
