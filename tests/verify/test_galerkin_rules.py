"""The implicit rules: known answers, order, momenta, loads, stiffness, and going on as if never stopped."""

import numpy as np
import pytest

import cayley as cy
from cayley import loads, supports
from verify.problems import TOP, TOP_START, heavy_top

G = (0.0, 0.0, -9.81)


def pendulum(elements, density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5, radius=5e-3):
    """The rubber pendulum, or with other numbers the steel wire."""
    material = cy.Material(density=density, youngs_modulus=youngs_modulus, poisson_ratio=poisson_ratio)
    section = cy.Section.circle(radius, material, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    return rod, cy.Model(rod, supports=[supports.pin(rod.start)], loads=[loads.gravity(G)])


def tip(model, rule, t_end, dt):
    return cy.simulate(model, t_end, dt, rule=rule, save_every=t_end).frames.values[-1, -1, 4:7]


@pytest.mark.parametrize(
    ("elements", "rule", "dt", "expected"),
    [
        (20, cy.rules.midpoint, 2.5e-3, (None, 0.0, -0.11013)),
        (10, cy.rules.galerkin(time=2, space=2), 0.01, (-0.93982504, 0.0, -0.09949865)),
        (20, cy.rules.galerkin(time=2, space=2), 0.005, (-0.94007123, 0.0, -0.09914458)),
        (12, cy.rules.galerkin(time=3, space=3), 0.008, (-0.94009324, 0.0, -0.09909941)),
    ],
    ids=str,
)
def test_rubber_pendulum_meets_an_independent_prototype(elements, rule, dt, expected):
    found = tip(pendulum(elements)[1], rule, 1.0, dt)
    for value, wanted in zip(found, expected, strict=True):
        if wanted is not None:
            assert value == pytest.approx(wanted, abs=5e-6 if rule is cy.rules.midpoint else 2e-8)


@pytest.mark.parametrize("dt", [2e-3, 1e-2])
def test_steel_wire_runs_at_steps_four_orders_above_the_explicit_limit(dt):
    rod, model = pendulum(10, 7850.0, 2e11, 0.3, 1e-3)
    assert cy.simulate(model, 1e-6, rule=cy.rules.verlet).dt < 1e-6
    run = cy.simulate(model, 0.75, dt, rule=cy.rules.midpoint, save_every=0.05)
    assert run[rod].position.isel(time=-1, node=-1).values == pytest.approx((-0.9410, 0.0, -0.338), abs=4e-3)
    assert np.isfinite(run.energy).all()


def test_paper_at_its_own_step():
    """Table 1 at h = 4e-4 s: corners in space and middle in time follow the explicit rule at 1e-4 s for 3 s."""
    rubber = cy.Material(density=1000.0, youngs_modulus=5e6, poisson_ratio=0.35)
    section = cy.Section.rectangle(0.01, 0.01, rubber, shear_correction=1.0)
    rod = cy.Rod(section, length=2.0, direction=(0, 0, -1), normal=(1, 0, 0), elements=11)

    def torque(t):
        return 1.5 * np.sin(np.pi * t / 2) * np.array([np.cos(np.pi * t / 4), np.sin(np.pi * t / 4), 0.0])

    acting = [loads.gravity(G), loads.moment(rod.start, torque, frame="body", until=2.0)]
    model = cy.Model(rod, supports=[supports.pin(rod.start)], loads=acting)
    one = cy.simulate(model, 3.0, 1e-4, rule=cy.rules.nodal, save_every=0.1)
    two = cy.simulate(model, 3.0, 4e-4, rule=cy.rules.nodal_midpoint, save_every=0.1)
    assert np.abs(one[rod].position - two[rod].position).max() < 1e-2


@pytest.mark.parametrize(
    ("rule", "order", "steps"),
    [
        (cy.rules.midpoint, 2, (1000, 2000, 4000, 8000)),
        (cy.rules.galerkin(time=1), 2, (1000, 2000, 4000, 8000)),
        (cy.rules.galerkin(time=2), 4, (200, 300, 400, 600)),
        (cy.rules.galerkin(time=3), 6, (100, 140, 200, 280)),
        (cy.rules.galerkin(time=4), 8, (70, 85, 100, 120)),
    ],
    ids=str,
)
def test_order_in_time_on_the_fast_heavy_top(rule, order, steps):

    def final(chosen, count):
        system = cy.compile(heavy_top, rule=chosen, constants=TOP)
        return cy.integrate(system, TOP_START, 0.5, 0.5 / count, save_every=0.5).frames.values[-1, 0]

    exact = final(cy.rules.galerkin(time=5), 400)
    errors = [min(np.linalg.norm(final(rule, n) - s * exact) for s in (1, -1)) for n in steps]
    observed = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert observed == pytest.approx(order, abs=0.2)
    assert errors[-1] > 1e-11  # above rounding


@pytest.mark.parametrize(
    "rule",
    [cy.rules.midpoint, cy.rules.nodal_midpoint, cy.rules.galerkin(time=2), cy.rules.galerkin(time=2, space=2)],
    ids=str,
)
def test_free_rod_keeps_six_momenta_and_its_energy(rule):
    rod = pendulum(6)[0]
    initial = {rod: {"velocity": lambda s: np.array([s, 1 - s, 0.5]), "angular_velocity": (3.0, 1.0, -2.0)}}
    run = cy.simulate(cy.Model(rod), 2.0, 2e-3, rule=rule, save_every=0.1, initial=initial)
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-10 * np.abs(momentum).max()
    assert np.ptp(run.energy) < 0.05 * float(run.energy[0])
    norm = np.linalg.norm(run.frames.values[..., :4], axis=-1)
    assert np.abs(norm - 1.0).max() < 1e-13


@pytest.mark.parametrize("frame", ["space", "body"])
@pytest.mark.parametrize("rule", [cy.rules.midpoint, cy.rules.galerkin(time=2)], ids=str)
def test_loads_act_as_they_do_explicitly(rule, frame):
    """Forces and moments in either frame, in windows that end inside steps, on two different rods at once."""
    rods = [pendulum(n, radius=r)[0] for n, r in ((4, 0.03), (5, 0.02))]

    def pulse(t):
        return np.array([0.3 * np.sin(5 * t), 0.2, -0.1])

    acting = [loads.force(rods[0].end, (0.5, -0.2, 0.3), frame=frame, start=0.01, until=0.0531)]
    acting += [loads.moment(rods[0].node(2), pulse, frame=frame), loads.line_force(rods[1], pulse, frame=frame)]
    acting += [loads.moment(rods[1].end, (0.02, 0.01, 0.03), frame=frame)]
    held = [supports.clamp(rods[0].start), supports.hold(rods[1].start, position="xz", rotation="z")]
    model = cy.Model(*rods, supports=held, loads=[*acting, loads.gravity(G)])
    fine = cy.simulate(model, 0.1, 2e-6, rule=cy.rules.verlet, save_every=0.1).frames
    one = cy.simulate(model, 0.1, 2e-4, rule=rule, save_every=0.1).frames
    moved = np.abs(fine.values[-1] - fine.values[0]).max()
    assert np.abs(one.values[-1] - fine.values[-1]).max() < 2e-3 * moved


@pytest.mark.parametrize(
    "rule", [cy.rules.midpoint, cy.rules.galerkin(time=2, space=2), cy.rules.screw_midpoint], ids=str
)
def test_continuing_equals_never_having_stopped(rule, tmp_path):
    rod, model = pendulum(5)
    from cayley.system.discretize import discretize
    from cayley.system.legendre import initial_state

    system = discretize(model, rule)
    begin = initial_state(system, system.reference, np.zeros((system.size, 6)))
    whole = cy.integrate(system, begin, 0.2, 5e-3, save_every=0.02)
    half = cy.integrate(system, begin, 0.1, 5e-3, save_every=0.02)
    rest = cy.integrate(system, half.state, 0.2, 5e-3, save_every=0.02)
    np.testing.assert_array_equal(rest.frames.values[-1], whole.frames.values[-1])
    np.testing.assert_array_equal(rest.frames.momenta[-1], whole.frames.momenta[-1])
    run = cy.simulate(model, 0.1, 5e-3, rule=rule, save_every=0.02)
    run.save(tmp_path / "run.zarr")
    opened = cy.Trajectory.open(tmp_path / "run.zarr")
    again = cy.integrate(system, opened.state, 0.2, 5e-3, save_every=0.02)
    np.testing.assert_array_equal(again.frames.values[-1], whole.frames.values[-1])
    assert opened.rule == rule.name
    assert rod.elements == 5


def test_a_step_that_is_not_solved_stops_the_run_with_its_place_and_a_remedy():
    _, model = pendulum(3)
    with pytest.raises(
        cy.SimulationError, match=r"stopped at t = .* \(step \d+\) at node \d.*; give dt below 0.4 s"
    ) as told:
        cy.simulate(model, 40.0, 0.8, rule=cy.rules.galerkin(time=3, space=3), save_every=0.8)
    assert np.isfinite(told.value.partial.frames.values).all()


def test_a_rule_for_elements_needs_an_interval():
    with pytest.raises(ValueError, match=r"heavy_top has no interval, but the rule galerkin.* is one for elements"):
        cy.compile(heavy_top, rule=cy.rules.galerkin(time=1, space=2), constants=TOP)


@pytest.mark.parametrize(
    "degrees", [dict(time=0), dict(time=9), dict(time=2.0), dict(time=1, space=0), dict(time=True)]
)
def test_degrees_are_checked(degrees):
    with pytest.raises(ValueError, match=r"galerkin: .* is .*; give a whole number from 1 to 8"):
        cy.rules.galerkin(**degrees)
