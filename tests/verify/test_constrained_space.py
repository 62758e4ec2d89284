"""Rods without shear or stretch with elements of higher degree: order in space, constraints, momenta, forces."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import damping, loads, rules, supports
from cayley.lie import quaternion
from cayley.steppers.saddle import largest_violation
from unit.system.rods import round_rod, rubber
from verify.test_constrained import KINDS

IMPLICIT, EXPLICIT = rules.galerkin(time=2, space=2), rules.spectral(space=2)


def pushed(elements: int, degree: int) -> np.ndarray:
    """Positions at the quarters of a clamped block, ten times in 0.04 s, while a force at its end rises smoothly."""
    rod = cy.Rod(
        cy.Section.circle(0.1, rubber()),
        length=1.0,
        direction=(1, 0, 0),
        normal=(0, 1, 0),
        elements=elements,
        kinematics="inextensible",
    )
    push = loads.force(rod.end, lambda t: (0.0, 0.0, 2700.0 * np.sin(12.5 * np.pi * t) ** 4))
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[push])
    run = cy.simulate(model, 0.04, 2e-3, rule=rules.galerkin(time=2, space=degree), save_every=4e-3)
    return run[rod].position.values[1:, :: elements * degree // 4]


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    return pushed(16, 4)


@pytest.mark.parametrize(("degree", "meshes"), [(2, (4, 8, 16)), (3, (4, 8))], ids=["2", "3"])
def test_order_in_space(degree, meshes, exact):
    """Order 2m, as without constraints."""
    errors = np.array([np.linalg.norm(pushed(n, degree) - exact) for n in meshes])
    assert_allclose(np.log2(errors[:-1] / errors[1:]), 2 * degree, atol=0.2)


@pytest.mark.parametrize("kinematics", KINDS)
@pytest.mark.parametrize(("rule", "h"), [(IMPLICIT, 2e-3), (EXPLICIT, 1e-4)], ids=str)
def test_constraint_momenta_and_energy(kinematics, rule, h):
    """In free flight after a kick at one end the constraint and six momenta hold to round-off; energy stays."""
    rod = round_rod(6, kinematics=kinematics, name="rod")
    momenta = {"momentum": np.zeros((13, 3)), "angular_momentum": np.tile((0.0, 0.0, 1e-4), (13, 1))}
    momenta["momentum"][-1] = (0.3, 1.0, 0.5)
    run = cy.simulate(cy.Model(rod), 0.4, h, rule=rule, initial={"rod": momenta}, save_every=0.01)
    assert max(largest_violation(run.system, values) for values in run.frames.values) < 1e-12
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.abs(momentum).max()
    assert np.ptp(run.energy.values) < 5e-3 * run.energy.values[0]


@pytest.mark.parametrize("kinematics", KINDS)
def test_cantilever_comes_to_rest_under_a_force(kinematics):
    """Force P everywhere, moment lever × P at every node: statics, by multipliers and stiffness together."""
    rod = round_rod(4, length=0.5, kinematics=kinematics, damping=damping.mass_proportional(10.0))
    push = np.array([0.0, 0.0, 0.2])
    slowly = loads.force(rod.end, lambda t: push * np.sin(0.5 * np.pi * min(t, 1.0)) ** 4)
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[slowly])
    run = cy.simulate(model, 5.0, 0.02, rule=rules.galerkin(time=1, space=3), save_every=1.0)
    rest = run[rod].isel(time=-1)
    force, moment = (quaternion.rotate(rest.rotation.values, rest[name].values) for name in ("force", "moment"))
    lever = rest.position.values[-1] - rest.position.values
    assert np.ptp(rest.position.values[:, 2]) > 0.1  # bent by far
    assert_allclose(force, np.tile(push, (len(force), 1)), atol=1e-4)
    assert_allclose(moment, np.cross(lever, push), atol=1e-5)
    assert_allclose(run.reaction(rod.start).force.values[-1], -push, atol=1e-4)
    assert_allclose(run.reaction(rod.start).moment.values[-1], -np.cross(lever[0], push), atol=1e-5)


@pytest.mark.parametrize("rule", [IMPLICIT, EXPLICIT], ids=str)
def test_hanging_rod(rule):
    """The axial force at a frame is the weight below."""
    rod = round_rod(6, direction=(0, 0, -1), normal=(1, 0, 0), kinematics="inextensible")
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[loads.gravity((0, 0, -9.81))])
    run = cy.simulate(model, 0.05, 1e-4 if rule is EXPLICIT else 1e-2, rule=rule)
    weight = rod.mass * 9.81 * (1.0 - run[rod].s.values)
    assert_allclose(run[rod].force.values[-1, :, 2], weight, atol=1e-9)
    assert_allclose(run.reaction(rod.start).force.values[-1], (0, 0, rod.mass * 9.81), atol=1e-9)


def test_going_on(tmp_path):
    """A run that is stored, opened and gone on with is the run that never stopped, bit for bit."""
    rod = round_rod(4, kinematics="inextensible")
    model = cy.Model(rod, supports=[supports.pin(rod.start)], loads=[loads.gravity((0, 0, -9.81))])
    whole = cy.simulate(model, 0.1, 1e-3, rule=IMPLICIT, save_every=0.02)
    cy.simulate(model, 0.04, 1e-3, rule=IMPLICIT, save_every=0.02).save(tmp_path / "run")
    first = cy.Trajectory.open(tmp_path / "run")
    second = cy.integrate(first.system, first.state, 0.1, save_every=0.02)
    assert np.array_equal(second.frames.values[-1], whole.frames.values[-1])
    assert np.array_equal(second.frames.momenta[-1], whole.frames.momenta[-1])
