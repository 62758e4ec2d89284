"""Implicit rules: order in time, known motions at long steps, momenta and energy."""

import numpy as np
import pytest

import cayley as cy
from cayley.discrete.rules import Rule, gauss
from cayley.lie import quaternion
from reference.test_paper import beam
from verify.problems import (
    TOP,
    TOP_START,
    assert_order,
    bend,
    frame_distance,
    free_body,
    heavy_top,
    in_flight,
    rotation_distance,
    slopes,
    thick_rod,
    turned_around,
)
from verify.test_order import jacobi, product

midpoint, nodal_midpoint, galerkin = cy.rules.midpoint, cy.rules.nodal_midpoint, cy.rules.galerkin
RULES = [midpoint, nodal_midpoint, galerkin(time=2), galerkin(time=3), galerkin(time=4)]
ALL = [*RULES, galerkin(time=1, space=2), galerkin(time=2, space=2), galerkin(time=2, space=3)]
each_rule = pytest.mark.parametrize("rule", RULES, ids=str)


def assert_order_over(counts, errors, order):
    """As assert_order, for numbers of steps that do not double."""
    observed = slopes(errors, np.array(counts)[1:] / np.array(counts)[:-1])
    assert np.all(np.abs(observed - order) < 0.2), (errors, observed)


def top_at_the_end(rule, steps):
    system = cy.compile(heavy_top, rule=rule, constants=TOP)
    return cy.integrate(system, TOP_START, t_end=0.5, dt=0.5 / steps, save_every=0.5).data["p"].values[-1]


TOP_STEPS = {2: (1000, 2000, 4000, 8000), 4: (100, 200, 400, 800), 6: (50, 100, 200, 400), 8: (40, 56, 80, 112)}


@each_rule
def test_order_of_the_heavy_top(rule):
    """Order 2r, against twelve times as many steps of order ten."""
    exact = top_at_the_end(galerkin(time=5), 500)
    steps = TOP_STEPS[rule.order]
    assert_order_over(steps, [rotation_distance(top_at_the_end(rule, n), exact) for n in steps], rule.order)


def test_the_top_of_order_eight():
    """At h = 5 ms, nearly a radian a step, 1e-8 off, and the quaternion's length kept without any normalization."""
    exact = top_at_the_end(galerkin(time=5), 500)
    found = top_at_the_end(galerkin(time=4), 100)
    assert rotation_distance(found, exact) < 2e-8
    assert abs(np.linalg.norm(found) - 1.0) < 5e-15


BODY_STEPS = {2: (100, 200, 400, 800), 4: (20, 40, 80, 160), 6: (12, 24, 48, 96), 8: (11, 16, 23, 32)}


@each_rule
def test_order_of_the_free_body(rule):
    """Against Jacobi's elliptic functions."""
    inertia, start = np.array([1.0, 2.0, 3.0]), np.array([0.3, 0.2, 1.0])
    _, seen, first = jacobi(inertia, start, 10.0)
    exact = product(quaternion.conjugate(first), seen, first)
    system = cy.compile(free_body, rule=rule, constants={"inertia": np.diag(inertia)})
    errors = []
    for steps in BODY_STEPS[rule.order]:
        run = cy.integrate(system, {"p": (1, 0, 0, 0), "p_t": start}, t_end=10.0, dt=10.0 / steps, save_every=10.0)
        errors.append(rotation_distance(run.data["p"].values[-1], exact))
    assert_order_over(BODY_STEPS[rule.order], errors, rule.order)


ROD_STEPS = {2: (1600, 3200, 6400, 12800), 4: (100, 200, 400, 800), 6: (60, 90, 135, 200), 8: (40, 56, 80, 113)}


def thrown(elements=4, curvature=8.0):
    """A thick rubber rod, bent, thrown and spinning."""
    rod, model = thick_rod(elements, clamped=False)
    return rod, model, {rod: in_flight(rod, bend(rod, curvature), velocity=(0.3, -0.2, 0.5), spin=(1.0, 5.0, -8.0))}


@each_rule
def test_order_of_a_rod_in_flight(rule):
    """Positions and rotations together, against order ten with the same terms in space."""
    rod, model, start = thrown()

    def end(rule, steps):
        return cy.simulate(model, 0.05, 0.05 / steps, rule=rule, save_every=0.05, initial=start)

    exact = end(Rule("reference", time=gauss(5), strain=rule.strain, order=10), 200)
    steps = ROD_STEPS[rule.order]
    assert_order_over(steps, [np.hypot(*frame_distance(end(rule, n), exact, rod)) for n in steps], rule.order)


def test_midpoint_is_galerkin_of_degree_one():
    """Bit for bit, with supports and loads of every kind."""
    rod, model = thick_rod(5)
    acting = [
        cy.loads.gravity((1.0, -2.0, -9.81)),
        cy.loads.moment(rod.end, lambda t: np.array([3.0 * np.sin(90.0 * t), 1.0, -2.0]), frame="body"),
        cy.loads.force(rod.node(3), (1.0, 4.0, -2.0), frame="body", until=0.0312),
    ]
    model = model.replace(loads=acting)
    start = {rod: bend(rod, 2.0)}
    one, other = (
        cy.simulate(model, 0.1, 1e-3, rule=rule, save_every=1e-2, initial=start)
        for rule in (midpoint, galerkin(time=1))
    )
    assert np.array_equal(one.frames.values, other.frames.values)
    assert np.array_equal(one.frames.momenta, other.frames.momenta)
    assert (midpoint.time, midpoint.strain) == (galerkin(time=1).time, galerkin(time=1).strain)


def hanging_by_its_end(radius, material, elements):
    """A rod of 1 m, horizontal, pinned at the origin, let go from rest."""
    section = cy.Section.circle(radius, material, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    gravity = cy.loads.gravity((0.0, 0.0, -9.81))
    return rod, cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[gravity])


def test_rubber_pendulum_at_a_hundred_times_the_explicit_step():
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    rod, model = hanging_by_its_end(5e-3, rubber, 20)
    run = cy.simulate(model, 1.0, 2.5e-3, rule=midpoint, save_every=1.0)
    assert abs(run[rod].position.values[-1, -1, 2] + 0.11013) < 1e-5


def test_steel_wire():
    """The explicit limit is 6e-7 s; 2 ms will do."""
    steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
    rod, model = hanging_by_its_end(1e-3, steel, 10)
    run = cy.simulate(model, 0.75, 2e-3, rule=midpoint, save_every=0.75)
    np.testing.assert_allclose(run[rod].position.values[-1, -1], (-0.9410, 0.0, -0.338), atol=5e-4)


def test_the_paper_at_its_own_step():
    """Table 1 at h = 4e-4 s with corners in space and the middle in time moves as the paper's rule does at 1e-4 s."""
    rod, model = beam()
    by_nodes = cy.simulate(model, 3.0, 1e-4, rule=cy.rules.nodal, save_every=0.05)
    run = cy.simulate(model, 3.0, 4e-4, rule=nodal_midpoint, save_every=0.05)
    assert run.dt == pytest.approx(4e-4)
    apart = np.linalg.norm(run[rod].position.values - by_nodes[rod].position.values, axis=-1)
    assert apart.max() < 1e-2
    assert np.ptp(run[rod].position.values[:, -1], axis=0).min() > 1.0


def of_all_degrees(rule):
    """A free rod, straight at first and with a smooth motion of every kind, on any nodes."""
    rod, model = thick_rod(4, clamped=False)
    start = {
        "velocity": lambda s: (0.3 + s**2, -0.2 + np.sin(3.0 * s), 0.9 - s),
        "angular_velocity": lambda s: (1.0 + s, 4.0 * np.cos(2.0 * s), -3.0),
    }
    return model, {rod: start}


@pytest.mark.parametrize("rule", ALL, ids=str)
def test_all_six_momenta_are_kept(rule):
    """Noether: interpolation of quaternions commutes with a rotation of all of them."""
    model, start = of_all_degrees(rule)
    run = cy.simulate(model, 0.5, 1e-3, rule=rule, save_every=0.05, initial=start)
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum[0]).min() > 0.03
        assert np.abs(momentum - momentum[0]).max() < 1e-10 * np.linalg.norm(momentum[0])


@pytest.mark.parametrize("rule", ALL, ids=str)
def test_time_reversal_returns_to_the_start(rule):
    """Forward, momenta reversed, the same number of steps again, with gravity and a force in the body frame."""
    model, start = of_all_degrees(rule)
    (rod,) = model.rods
    push = cy.loads.force(rod.end, (20.0, 5.0, -9.0), frame="body")
    model = model.replace(loads=[cy.loads.gravity((1.0, -2.0, -9.81)), push])
    there = cy.simulate(model, 0.1, 1e-3, rule=rule, save_every=0.1, initial=start)
    back = cy.integrate(there.system, turned_around(there.state), 0.1, 1e-3, save_every=0.1)
    assert np.abs(there.frames.values[-1] - there.frames.values[0]).max() > 0.1
    np.testing.assert_allclose(back.frames.values[-1], there.frames.values[0], rtol=0, atol=1e-10)
    np.testing.assert_allclose(-back.frames.momenta[-1], there.frames.momenta[0], rtol=0, atol=1e-9)


@pytest.mark.parametrize(("rule", "dt", "steps"), [(midpoint, 2e-4, 50_000), (galerkin(time=2), 1e-3, 20_000)], ids=str)
def test_energy_does_not_drift(rule, dt, steps):
    """A straight line through the energy of a bent, spinning rod rises by less than a twentieth of its ripple."""
    rod, model = thick_rod(2, clamped=False)
    spin = {"velocity": (0.0, 0.0, 0.0), "spin": (0.3, 1.0, -2.0)}
    start = {rod: in_flight(rod, bend(rod, 1.0), **spin)}
    run = cy.simulate(model, steps * dt, dt, rule=rule, save_every=steps * dt / 1000, initial=start)
    energy = run.energy.values
    ripple = np.ptp(energy)
    assert 1e-9 * energy[0] < ripple < 1e-3 * energy[0]
    assert abs(np.polyfit(run.time, energy, 1)[0] * run.time[-1]) < 0.05 * ripple
    assert np.ptp(energy[:100]) > 0.3 * ripple


@each_rule
def test_energy_ripple_falls_with_the_order_of_the_rule(rule):
    """Of the heavy top, seen at the same times."""
    system = cy.compile(heavy_top, rule=rule, constants=TOP)
    base = {2: 500, 4: 100, 6: 50, 8: 40}[rule.order]
    ripples = []
    for steps in (base, 2 * base, 4 * base):
        run = cy.integrate(system, TOP_START, t_end=0.25, dt=0.25 / steps, save_every=0.25 / base)
        ripples.append(np.ptp(run.energy.values) / run.kinetic_energy.values[0])
    if rule.order == 8:
        ripples = ripples[:2]
    assert_order(ripples, order=rule.order, within=0.35, floor=1e-14)
