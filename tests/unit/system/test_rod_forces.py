"""Forces of models: the density only knows what is used, rods share fragments, and misuse is told by the load."""

import math

import numpy as np
import pytest

import cayley as cy
from cayley import damping, loads
from cayley.discrete.rules import verlet
from cayley.system.discretize import discretize

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
SECTION = cy.Section.circle(0.05, RUBBER)


def rod(name="arm", **more):
    return cy.Rod(SECTION, length=1.0, elements=3, name=name, **more)


def signature(*rods, acting=()):
    return discretize(cy.Model(*rods, loads=list(acting)), verlet).equations.signature


def test_a_model_without_forces_has_the_equations_it_had():
    plain = signature(rod())
    assert "forced" not in plain.splitlines()[0]
    assert signature(rod(damping=damping.retardation(1e-3))) != plain
    assert signature(rod(), acting=[loads.gravity((0, 0, 0))]) == plain


def test_rods_share_fragments_with_constants_of_their_own():
    one, other = rod("one", damping=damping.retardation(1e-3)), rod("other", damping=damping.retardation(2e-3))
    system = discretize(cy.Model(one, other), verlet)
    names = [name for name in system.equations.density.names if "retardation" in name]
    assert names == [f"c.retardation0_roots[{k}]" for k in range(6)]
    np.testing.assert_allclose(system.named[names[0]] ** 2, np.repeat([1e-3, 2e-3], 4))


def test_a_rod_without_a_force_has_zeros():
    one, other = rod("one"), rod("other")
    system = discretize(cy.Model(one, other, loads=[loads.drag(other, density=1.0, diameter=0.1)]), verlet)
    np.testing.assert_allclose(system.named["c.drag0_normal"], np.repeat([0.0, 0.5 * 0.1 * 1.2], 4))


def test_two_loads_of_a_kind_add_up():
    arm = rod()
    twice = [loads.buoyancy(arm, density=1.0, area=0.1), loads.buoyancy(arm, density=2.0, area=0.1)]
    run = cy.simulate(cy.Model(arm, loads=[loads.gravity((0, 0, -1.0)), *twice]), 0.01)
    expected = 0.01 * (0.3 - arm.section.mass_per_length) / arm.section.mass_per_length
    np.testing.assert_allclose(run[arm].velocity.values[-1][:, 2], expected, rtol=1e-9)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda r: loads.tendon(r, lambda t: math.sin(t), offset=(0.01, 0, 0)), "tendon on arm: its tension does not"),
        (lambda r: loads.distributed(r, lambda s, t: (0, 0, 1) if t < 1 else (0, 0, 0)), "write it with NumPy"),
        (lambda r: loads.distributed(r, lambda s, t: (0, 1)), r"returns shape \(2,\); it must return 3 numbers"),
        (lambda r: loads.density(r, lambda q, c: [(c.k * q.x_t, q.x)], kk=1.0), "unknown constant c.k, there are kk"),
        (lambda r: loads.density(r, lambda q, c: [(q.x_t, q.x)], m=1.0), "the constant m is given but"),
        (lambda r: loads.density(r, lambda q, c: [(q.x_tt, q.x)]), "density on arm: .* did you mean x_t"),
        (lambda r: loads.density(r, lambda q, c: q.t), "does not return pairs"),
    ],
)
def test_misuse_is_told_by_the_load(make, told):
    arm = rod()
    with pytest.raises(ValueError, match=told):
        discretize(cy.Model(arm, loads=[make(arm)]), verlet)
