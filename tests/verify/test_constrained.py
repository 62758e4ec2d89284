"""Rods without shear or stretch: constraints, momenta, energy, order, the limit of stiff rods, forces, restart."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads, rules, supports
from cayley.steppers.saddle import largest_violation
from unit.system.rods import round_rod, rubber

KINDS = ("unshearable", "inextensible")
WEIGHT = loads.gravity((0, 0, -9.81))


def pendulum(kinematics: str, elements: int = 10, **options) -> cy.Model:
    rod = round_rod(elements, kinematics=kinematics, **options)
    return cy.Model(rod, supports=[supports.pin(rod.start)], loads=[WEIGHT])


def free(kinematics: str) -> tuple[cy.Model, dict]:
    """A rod that flies freely, kicked at one end: the momenta of the kick are projected."""
    rod = round_rod(9, kinematics=kinematics, name="rod")
    kick = np.zeros((10, 3))
    kick[-1] = (0.3, 1.0, 0.5)
    spin = np.zeros((10, 3))
    spin[:] = (0.0, 0.0, 1e-4)
    return cy.Model(rod), {"rod": {"momentum": kick, "angular_momentum": spin}}


@pytest.mark.parametrize("kinematics", KINDS)
@pytest.mark.parametrize("rule", [rules.verlet, rules.screw], ids=str)
def test_constraint_momenta_and_energy(kinematics, rule):
    """Over 20 000 steps the constraint and six momenta hold to round-off; energy does not drift."""
    model, initial = free(kinematics)
    run = cy.simulate(model, 2.0, 1e-4, rule=rule, initial=initial, save_every=0.01)
    assert max(largest_violation(run.system, values) for values in run.frames.values) < 1e-12
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.abs(momentum).max() + 1e-14
    energy = run.energy.values
    quarter = len(energy) // 4
    assert np.ptp(energy) < 1e-3 * energy[0]
    assert abs(energy[-quarter:].mean() - energy[:quarter].mean()) < 2e-4 * energy[0]


@pytest.mark.slow
@pytest.mark.parametrize("kinematics", KINDS)
def test_1e5_steps(kinematics):
    """Looked at every 500th step; a step ends only when its constraint is at round-off."""
    model, initial = free(kinematics)
    run = cy.simulate(model, 10.0, 1e-4, initial=initial, save_every=1e-3)
    assert max(largest_violation(run.system, values) for values in run.frames.values[::50]) < 1e-12
    assert np.abs(run.linear_momentum - run.linear_momentum[0]).max() < 1e-12


@pytest.mark.parametrize("kinematics", KINDS)
def test_order_in_time(kinematics):
    """A falling pendulum, four steps against a fine one."""
    ends = []
    for h in (8e-4, 4e-4, 2e-4, 1e-4, 1.25e-5):
        run = cy.simulate(pendulum(kinematics, 6), 0.4, h, save_every=0.4)
        ends.append(run.frames.values[-1])
    errors = [np.abs(end - ends[-1]).max() for end in ends[:-1]]
    assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.2)


@pytest.mark.parametrize("kinematics", KINDS)
def test_energy_ripple(kinematics):
    """The ripple of the energy is proportional to h²."""
    ripple = [np.ptp(cy.simulate(pendulum(kinematics, 6), 0.5, h, save_every=0.02).energy.values) for h in (4e-4, 2e-4)]
    assert_allclose(ripple[0] / ripple[1], 4.0, rtol=0.2)


@pytest.mark.parametrize("kinematics", KINDS)
def test_reversible(kinematics):
    """Back with opposite momenta: where it came from."""
    run = cy.simulate(pendulum(kinematics), 0.2, 2e-4)
    last = run.state
    back = type(last)(values=last.values, momenta=-last.momenta)
    again = cy.integrate(run.system, back, 0.2, 2e-4)
    assert_allclose(again.frames.values[-1], run.frames.values[0], atol=1e-10)


@pytest.mark.parametrize("kinematics", KINDS)
def test_limit_of_stiff_rods(kinematics):
    """Shearable rods with what is constrained made stiffer come nearer, in proportion."""
    section = round_rod(6).section
    end = cy.simulate(pendulum(kinematics, 6), 0.3, 1e-4, save_every=0.3).frames.values[-1]
    apart = []
    for factor in (1e1, 1e2):
        c = np.array(section.stiffness)
        stiff = slice(0, 3 if kinematics == "inextensible" else 2)
        c[stiff, stiff] *= factor
        given = cy.Section.given(stiffness=c, mass_per_length=section.mass_per_length, inertia=section.inertia)
        rod = cy.Rod(given, length=1.0, elements=6, direction=(1, 0, 0), normal=(0, 1, 0))
        model = cy.Model(rod, supports=[supports.pin(rod.start)], loads=[WEIGHT])
        apart.append(np.abs(cy.simulate(model, 0.3, 1e-5, save_every=0.3).frames.values[-1] - end).max())
    assert_allclose(apart[0] / apart[1], 10.0, rtol=0.3)


def test_hanging_rod():
    """The axial force is the weight below."""
    rod = round_rod(20, direction=(0, 0, -1), normal=(1, 0, 0), kinematics="inextensible")
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[WEIGHT])
    run = cy.simulate(model, 0.01, 1e-4)
    assert_allclose(run[rod].force.values[-1, :, 2], rod.mass * 9.81 * (1.0 - rod.nodes), atol=1e-9)


@pytest.mark.parametrize("kinematics", KINDS)
def test_force_of_the_support(kinematics):
    """The force at the pin is what the change of linear momentum says, beside the weight."""
    model = pendulum(kinematics)
    run = cy.simulate(model, 0.2, 1e-4, save_every=1e-4)
    rate = np.gradient(run.linear_momentum.values, run.time, axis=0)
    weight = np.array([0.0, 0.0, -9.81 * model.mass])
    pin = run[model.rods[0]].sigma.values[:, 0]  # -n: the rod pulls at its support with -n
    assert_allclose((rate - weight)[5:-5], pin[5:-5], atol=0.02 * np.abs(pin).max())


@pytest.mark.parametrize("kinematics", KINDS)
def test_cantilever_frequency(kinematics):
    """First bending frequency of Euler and Bernoulli, 3.516015, for a thin rod; no locking."""
    radius, length, k = 0.004, 0.25, 1.8751041
    rod = cy.Rod(cy.Section.circle(radius, rubber()), length=length, elements=20, kinematics=kinematics)
    model = cy.Model(rod, supports=[supports.clamp(rod.start)])
    ratio = (np.cosh(k) + np.cos(k)) / (np.sinh(k) + np.sin(k))

    def mode(s):
        z = k * s / length
        return 1e-4 * (np.cosh(z) - np.cos(z) - ratio * (np.sinh(z) - np.sin(z)))

    initial = {rod: {"momentum": lambda s: (mode(s), 0.0, 0.0)}}
    run = cy.simulate(model, 5.0, rule=rules.verlet, initial=initial, save_every=0.01)
    tip = run[rod].position.values[:, -1, 0]
    signs = np.flatnonzero(tip[1:-1] * tip[2:] < 0) + 1
    zeros = run.time[signs] - tip[signs] * 0.01 / (tip[signs + 1] - tip[signs])
    period = 2.0 * (zeros[-1] - zeros[0]) / (len(zeros) - 1)
    stiffness, mass = rod.section.stiffness[3, 3], rod.section.mass_per_length
    found = 2 * np.pi / period * length**2 * np.sqrt(mass / stiffness)
    assert found == pytest.approx(3.516015, rel=5e-3)


@pytest.mark.parametrize("kinematics", KINDS)
def test_step_limit(kinematics):
    """Far above that of a shearable rod; just below it a run is bounded, well above it is not."""
    model, initial = free(kinematics)
    system = cy.simulate(model, 1e-3, 1e-4).system
    limit = system.stable_dt()
    shearable = cy.simulate(cy.Model(round_rod(9)), 1e-3, 1e-5).system.stable_dt()
    assert limit > 1.5 * shearable
    small = {"rod": {name: 1e-3 * value for name, value in initial["rod"].items()}}
    run = cy.simulate(model, 2000 * limit, 0.99 * limit, initial=small)
    assert run.energy.values.max() < 2.0 * run.energy.values[0]
    with pytest.raises(cy.SimulationError):
        cy.simulate(model, 2000 * limit, 1.2 * limit, initial=small, allow_unstable=True)


@pytest.mark.parametrize("kinematics", KINDS)
def test_going_on(kinematics, tmp_path):
    """A run that is stored, opened and gone on with is the run that never stopped, bit for bit."""
    model = pendulum(kinematics)
    whole = cy.simulate(model, 0.2, 1e-4, save_every=0.02)
    cy.simulate(model, 0.1, 1e-4, save_every=0.02).save(tmp_path / "run")
    first = cy.Trajectory.open(tmp_path / "run")
    second = cy.integrate(first.system, first.state, 0.2, save_every=0.02)
    assert np.array_equal(second.frames.values[-1], whole.frames.values[-1])
    assert np.array_equal(second.frames.momenta[-1], whole.frames.momenta[-1])


def test_accuracy():
    """For soft rods the explicit rule is taken."""
    assert cy.simulate(pendulum("inextensible", 6), 0.2, accuracy=1e-2).rule == "verlet"


@cy.lagrangian(x=cy.Vector(3), s=cy.Interval, constraint=lambda q, c: cy.dot(q.x_s, q.x_s) - 1.0)
def chain(q, c):
    """A chain: it keeps its length and has no other stiffness."""
    return 0.5 * c.mass * cy.dot(q.x_t, q.x_t) - c.mass * c.weight * q.x[2]


def test_a_constraint_of_ones_own():
    """A chain of one link is a pendulum; its energy stays."""
    constants = {"mass": 1.0, "weight": 9.81}
    domain = cy.Interval(0.0, 1.0, elements=8)
    system = cy.compile(chain, rule=rules.verlet, domain=domain, constants=constants, held={"x": "start"})
    x = np.outer(np.linspace(0, 1, 9), (1.0, 0.0, 0.0))
    run = cy.integrate(system, {"x": x}, 0.5, 1e-4)
    lengths = np.linalg.norm(np.diff(run.frames.values, axis=1), axis=2)
    assert_allclose(lengths, 1 / 8, atol=1e-13)
    assert np.ptp(run.energy.values) < 1e-3 * run.kinetic_energy.values.max()


def test_refusals():
    """Every one is a line that says what would be right."""
    model = pendulum("inextensible")
    for rule in (rules.nodal, rules.nodal_midpoint):
        with pytest.raises(ValueError, match="use verlet, screw, spectral, midpoint"):
            cy.simulate(model, 0.1, 1e-4, rule=rule)
    with pytest.raises(ValueError, match="for quaternions only"):
        cy.simulate(model, 0.1, 1e-4, rotation="matrix")
    rod = model.rods[0]
    both = cy.Model(rod, supports=[supports.pin(rod.start), supports.pin(rod.end)])
    with pytest.raises(ValueError, match="hold less or give another kinematics"):
        cy.simulate(both, 0.1, 1e-4)
    with pytest.raises(ValueError, match="violates the constraint of Lagrangian inextensible_rod in the element at s"):
        cy.simulate(cy.Model(rod), 0.1, 1e-4, initial={rod: {"position": lambda s: (1.01 * s, 0, 0)}})
    with pytest.raises(ValueError, match="velocities at the start violate"):
        cy.simulate(cy.Model(rod), 0.1, 1e-4, initial={rod: {"angular_velocity": (1.0, 0, 0)}})
    with pytest.raises(ValueError, match="kinematics = 'stiff' must be"):
        round_rod(3, kinematics="stiff")
    with pytest.raises(TypeError, match="needs an interval"):
        cy.lagrangian(x=cy.Vector(3), constraint=lambda q, c: q.x[0])
