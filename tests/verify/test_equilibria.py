"""Newton's method for equilibria: its order, and that it fails on no rod, thick or slender, under no load."""

import numpy as np
import pytest

import cayley as cy
from cayley import loads, supports
from cayley.statics.newton import newton
from cayley.steppers.still import Still
from cayley.system.discretize import discretize
from reference.cantilevers import CUBIC, SCREW, given, straight

LOADS = {
    "force": lambda rod, f: loads.force(rod.end, f),
    "follower force": lambda rod, f: loads.force(rod.end, f, frame="body"),
    "moment": lambda rod, f: loads.moment(rod.end, f),
    "follower moment": lambda rod, f: loads.moment(rod.end, f, frame="body"),
    "force on a clamped rod": lambda rod, f: loads.force(rod.node(4), 5.0 * np.asarray(f)),
}
"""By name, from a vector in EI/l² or EI/l."""
MOST_CORRECTIONS = 150
"""More than in any of some thousand rods like these (found: 40 in the middle, 110 at most)."""


def loaded(slenderness, kind, vector, anisotropy=1.0):
    """A rod of l = EI = 1 and l √(A/I) under one load."""
    axial = slenderness**2
    rod = straight(given([0.4 * axial, 0.4 * axial, axial, 1.0, anisotropy, 0.8]), 1.0, 8)
    held = [rod.start, rod.end] if "clamped" in kind else [rod.start]
    return cy.Model(rod, supports=[supports.clamp(at) for at in held], loads=[LOADS[kind](rod, vector)])


@pytest.mark.parametrize("kind", LOADS)
@pytest.mark.parametrize("rule", [SCREW, CUBIC], ids=str)
def test_order_of_newtons_method(rule, kind):
    """At least 1.9, of the distance from the equilibrium after two to five corrections, where shear is soft, too."""
    model = loaded(5.0, kind, (0.6, -0.9, 0.5))
    system = discretize(model, rule)
    values = []
    for most in (1, 2, 3, 4, 5, 40):
        still = Still.at(system, system.reference)
        newton(still, most=most)
        values.append(still.values)
    errors = np.array([np.abs(v - values[-1]).max() for v in values[:-1]])
    errors = errors[errors > 1e-13]
    assert len(errors) >= 3, errors
    assert errors[-1] < 1e-5
    assert np.log(errors[-1] / errors[-2]) / np.log(errors[-2] / errors[-3]) > 1.9, errors


@pytest.mark.parametrize("kind", LOADS)
@pytest.mark.parametrize("slenderness", [10.0, 1e2, 1e3, 1e4])
def test_no_rod_fails(slenderness, kind):
    """Loads of 1 to 10 EI/l² or EI/l of any direction, sections of any stiffness: as quick for a wire as for a bar."""
    draw = np.random.default_rng(int(slenderness))
    for _ in range(3):
        direction = draw.standard_normal(3)
        vector = draw.uniform(1.0, 10.0) * direction / np.linalg.norm(direction)
        model = loaded(slenderness, kind, vector, draw.uniform(1.0, 3.0))
        for rule in (SCREW, CUBIC):
            rest = cy.equilibrium(model, rule=rule, relax=False)
            assert rest.solution.how == "newton"
            assert rest.iterations < MOST_CORRECTIONS, (vector, rest)
            assert rest.free_motions == []


def test_large_steps_find_the_same_as_small_ones():
    """A moment of 8 EI/l in space: from the equilibria of a quarter, a half, ... of it, and at once."""
    vector = 8.0 * np.array([0.48, -0.6, 0.64])
    rest = None
    for share in np.linspace(0.05, 1.0, 20):
        rest = cy.equilibrium(loaded(100.0, "moment", share * vector, 2.0), rule=SCREW, start=rest)
    at_once = cy.equilibrium(loaded(100.0, "moment", vector, 2.0), rule=SCREW)
    assert rest is not None
    np.testing.assert_allclose(at_once["rod"].position.values, rest["rod"].position.values, atol=1e-9)
