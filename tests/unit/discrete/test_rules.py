"""Rules are data: points with weights."""

import numpy as np
import pytest

import cayley as cy
from cayley.discrete.rules import CORNERS, MIDDLE, RULES, Points, nodal, verlet


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
