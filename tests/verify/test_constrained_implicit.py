"""Constrained rods under implicit rules: constraints, momenta, order, small steps, wires, supports, restart."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads, rules, supports
from cayley.steppers import implicit_run
from cayley.steppers.outcome import Outcome
from cayley.steppers.saddle import largest_violation
from cayley.system.discretize import discretize
from cayley.system.system import State
from unit.system.rods import round_rod
from verify.test_constrained import KINDS, WEIGHT, chain, free, pendulum

RULES = (rules.midpoint, rules.screw_midpoint, rules.galerkin(time=2))


def worst(run: cy.Trajectory) -> float:
    """Largest violation of a constraint in any frame."""
    return max(largest_violation(run.system, values) for values in run.frames.values)


def wire(elements: int = 10) -> cy.Model:
    """A steel wire without stretch, pinned at its start, under its weight."""
    steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
    section = cy.Section.circle(1e-3, steel)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), elements=elements, kinematics="inextensible")
    return cy.Model(rod, supports=[supports.pin(rod.start)], loads=[WEIGHT])


@pytest.mark.parametrize("kinematics", KINDS)
@pytest.mark.parametrize(("rule", "h"), [(RULES[0], 1e-3), (RULES[1], 1e-3), (RULES[2], 2e-3)], ids=str)
def test_constraint_momenta_and_energy(kinematics, rule, h):
    """In free flight the constraint and six momenta hold to round-off; energy stays."""
    model, initial = free(kinematics)
    run = cy.simulate(model, 1.0, h, rule=rule, initial=initial, save_every=0.01)
    assert worst(run) < 1e-12
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.abs(momentum).max()
    assert np.ptp(run.energy.values) < 5e-3 * run.energy.values[0]


@pytest.mark.parametrize("kinematics", KINDS)
def test_1e4_steps(kinematics):
    """Nothing drifts: momenta to 1e-10, energy neither."""
    model, initial = free(kinematics)
    run = cy.simulate(model, 10.0, 1e-3, rule=rules.midpoint, initial=initial, save_every=0.05)
    assert worst(run) < 1e-12
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-10 * np.abs(momentum).max()
    energy = run.energy.values
    assert abs(energy[-50:].mean() - energy[:50].mean()) < 1e-3 * energy[0]


def orders(rule: rules.Rule, kinematics: str, steps: tuple[float, ...], fine: float) -> np.ndarray:
    """Observed orders of the end of a falling pendulum."""
    ends = [cy.simulate(pendulum(kinematics, 6), 0.4, h, rule=rule, save_every=0.4).frames.values[-1] for h in steps]
    best = cy.simulate(pendulum(kinematics, 6), 0.4, fine, rule=rule, save_every=0.4).frames.values[-1]
    errors = np.array([np.abs(end - best).max() for end in ends])
    return np.log2(errors[:-1] / errors[1:])


@pytest.mark.parametrize("kinematics", KINDS)
@pytest.mark.parametrize("rule", RULES[:2], ids=str)
def test_order_two(kinematics, rule):
    """Second order where the bending waves are resolved."""
    assert_allclose(orders(rule, kinematics, (8e-4, 4e-4, 2e-4, 1e-4), 2.5e-5), 2.0, atol=0.2)


@pytest.mark.parametrize("kinematics", KINDS)
def test_order_four(kinematics):
    """Two control times a step: fourth order."""
    assert_allclose(orders(rules.galerkin(time=2), kinematics, (4e-3, 2e-3, 1e-3, 5e-4), 1.25e-4), 4.0, atol=0.2)


@pytest.mark.parametrize("kinematics", KINDS)
def test_order_six(kinematics):
    """Three: sixth."""
    assert_allclose(orders(rules.galerkin(time=3), kinematics, (1e-2, 5e-3, 2.5e-3), 5e-4), 6.0, atol=0.5)


@pytest.mark.parametrize("kinematics", KINDS)
@pytest.mark.parametrize(("rule", "explicit"), [(rules.midpoint, rules.verlet), (rules.screw_midpoint, rules.screw)])
def test_limit_of_small_steps(kinematics, rule, explicit):
    """Implicit and explicit rules with the same strains come together like h²."""
    apart = []
    for h in (4e-4, 2e-4):
        ends = [
            cy.simulate(pendulum(kinematics, 6), 0.3, h, rule=r, save_every=0.3).frames.values[-1]
            for r in (rule, explicit)
        ]
        apart.append(np.abs(ends[0] - ends[1]).max())
    assert_allclose(apart[0] / apart[1], 4.0, rtol=0.2)


@pytest.mark.parametrize("rule", [rules.midpoint, rules.galerkin(time=2), rules.galerkin(time=3)], ids=str)
def test_steel_wire(rule):
    """A step 500 times the explicit one: the wire swings like a rigid bar."""
    run = cy.simulate(wire(), 0.75, 1e-2, rule=rule, save_every=0.05)
    assert worst(run) < 1e-12
    assert np.ptp(run.energy.values) < 1e-3 * run.kinetic_energy.values.max()
    tip = run.frames.values[-1, -1, -3:]
    exact = cy.simulate(wire(), 0.75, rule=rules.verlet, save_every=0.05).frames.values[-1, -1, -3:]
    assert_allclose(tip, exact, atol=2e-3)


@pytest.mark.parametrize("rule", RULES, ids=str)
@pytest.mark.parametrize("support", [supports.pin, supports.clamp])
def test_held_at_both_ends(rule, support):
    """A rod that may stretch hangs between two supports."""
    rod = round_rod(12, kinematics="unshearable")
    model = cy.Model(rod, supports=[support(rod.start), support(rod.end)], loads=[WEIGHT])
    run = cy.simulate(model, 0.2, 1e-3, rule=rule, save_every=0.01)
    assert worst(run) < 1e-12
    assert np.ptp(run.energy.values) < 1e-2 * run.kinetic_energy.values.max()
    ends = run.frames.values[:, [0, -1], -3:]
    assert np.array_equal(ends, ends[:1].repeat(len(ends), 0))


def test_chain_between_two_walls():
    """An inextensible chain that hangs swings, every link of its length: its ends stay, nothing is redundant."""
    system = cy.compile(
        chain,
        rule=rules.galerkin(time=2),
        domain=cy.Interval(0.0, 1.0, elements=8),
        constants={"mass": 1.0, "weight": 9.81},
        held={"x": ["start", "end"]},
    )
    angle = np.pi / 3 * (1.0 - 2.0 * (np.arange(8) + 0.5) / 8)
    links = np.stack([np.cos(angle), np.sin(angle) * np.sin(0.7), -np.sin(angle) * np.cos(0.7)], axis=1) / 8
    run = cy.integrate(system, {"x": np.vstack([np.zeros(3), links.cumsum(axis=0)])}, 0.5, 2e-3)
    assert_allclose(np.linalg.norm(np.diff(run.frames.values, axis=1), axis=2), 1 / 8, atol=1e-14)
    assert np.ptp(run.energy.values) < 1e-6 * run.kinetic_energy.values.max()
    assert np.ptp(run.frames.values[:, :, 1]) > 0.1


def test_redundant():
    """A straight rod without stretch between two supports: one line; a run that begins so stops, without NaN."""
    rod = round_rod(12, kinematics="inextensible")
    both = cy.Model(rod, supports=[supports.pin(rod.start), supports.pin(rod.end)], loads=[WEIGHT])
    for rule in RULES:
        with pytest.raises(ValueError, match="hold less or give another kinematics"):
            cy.simulate(both, 0.1, 1e-3, rule=rule)
        system = discretize(both, rule)
        still = State(values=system.reference, momenta=np.zeros((system.size, system.layout.dofs)), h=1e-3)
        frames: list[tuple[np.ndarray, ...]] = []
        result = implicit_run.run(
            system, still, stride=1, saves=3, receive=lambda *frame, kept=frames: kept.append(frame)
        )
        assert result.outcome is Outcome.REDUNDANT
        assert not frames


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_going_on(rule, tmp_path):
    """A run that is stored, opened and gone on with is the run that never stopped, bit for bit."""
    model = pendulum("inextensible")
    whole = cy.simulate(model, 0.2, 1e-3, rule=rule, save_every=0.02)
    cy.simulate(model, 0.1, 1e-3, rule=rule, save_every=0.02).save(tmp_path / "run")
    first = cy.Trajectory.open(tmp_path / "run")
    second = cy.integrate(first.system, first.state, 0.2, save_every=0.02)
    assert np.array_equal(second.frames.values[-1], whole.frames.values[-1])
    assert np.array_equal(second.frames.momenta[-1], whole.frames.momenta[-1])


def test_hanging_rod():
    """The axial force at a frame is the weight below."""
    rod = round_rod(20, direction=(0, 0, -1), normal=(1, 0, 0), kinematics="inextensible")
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[loads.gravity((0, 0, -9.81))])
    run = cy.simulate(model, 0.1, 1e-2, rule=rules.midpoint)
    assert_allclose(run[rod].force.values[-1, :, 2], rod.mass * 9.81 * (1.0 - rod.nodes), atol=1e-9)


def test_accuracy():
    """For a thin wire, whose explicit steps are short, the implicit rule is taken."""
    run = cy.simulate(wire(40), 2.0, accuracy=1e-2)
    assert run.rule == "midpoint"
    assert run.error_estimate < 1e-2


def test_tension():
    """Under screw_midpoint the tension of a thin wire bounds the step by the radius, h < √3 r √(ρA/N); a run stops."""
    limit = np.sqrt(3.0) * 1e-3 * np.sqrt(np.pi * 1e-6 * 7850.0 / (3 * 9.81 * np.pi * 1e-6 * 7850.0))
    run = cy.simulate(wire(), 0.6, 0.9 * limit, rule=rules.screw_midpoint, save_every=0.05)
    assert np.ptp(run.energy.values) < 1e-3 * run.kinetic_energy.values.max()
    for factor in (2.0, 8.0, 31.0):
        with pytest.raises(cy.SimulationError, match="take midpoint"):
            cy.simulate(wire(), 0.6, factor * limit, rule=rules.screw_midpoint, save_every=0.05)


def test_refusals():
    """Corners in space: a line that says what would be right."""
    with pytest.raises(ValueError, match="use verlet, screw, spectral, midpoint, screw_midpoint or galerkin"):
        cy.simulate(pendulum("inextensible"), 0.1, 1e-3, rule=rules.nodal_midpoint)
