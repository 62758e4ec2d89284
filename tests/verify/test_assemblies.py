"""Assemblies of rods, bodies and joints: what they keep, to what order, and that it is all one how they are written."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cayley as cy
from cayley import joints, rules, springs, supports
from cayley.lie import quaternion
from cayley.steppers.saddle import projected
from cayley.system.system import State
from verify.assemblies import AXIS, RUBBER, THICK, WEIGHT, damped, driven, followed, free, gap, pair, shaken, tumbling
from verify.problems import assert_order, turned_around
from verify.test_structure import local, two_form

STEPS = {rules.verlet: 2e-4, rules.screw: 2e-4, rules.midpoint: 5e-4, rules.galerkin(time=2): 1e-3}
"""A time step [s] for the rules that differ in how they treat joints."""
RULES = pytest.mark.parametrize("rule", STEPS, ids=str)


def last(model, rule, steps, t_end, **options):
    return cy.simulate(model, t_end, t_end / steps, rule=rule, save_every=t_end, **options).frames


# What is kept


@RULES
def test_momenta_energy_and_gaps_of_a_free_assembly(rule):
    """Over 20 000 steps all six momenta of the whole keep to round-off, joints stay closed, energy does not drift."""
    model = free()
    span = 20_000 * STEPS[rule]
    run = cy.simulate(model, span, STEPS[rule], rule=rule, initial=shaken(model), save_every=span / 1000)
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.linalg.norm(momentum[0])
    assert_closed(run, model)
    energy = run.energy.values
    quarter = len(energy) // 4
    assert np.ptp(energy) < 1e-3 * energy[0]
    assert abs(energy[-quarter:].mean() - energy[quarter : 2 * quarter].mean()) < 0.2 * np.ptp(energy)
    assert energy[-quarter:].std() < 1.5 * energy[quarter : 2 * quarter].std()


@RULES
def test_momenta_of_a_tumbling_assembly(rule):
    """The same from a smooth start that bends the rods by their own inertia."""
    model = free()
    run = cy.simulate(model, 5000 * STEPS[rule], STEPS[rule], rule=rule, initial=tumbling(model))
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.linalg.norm(momentum[0])
    assert_closed(run, model)
    assert np.ptp(run.energy.values) < 2e-5 * run.energy.values[0]
    bent = run["a"].curvature.values
    assert np.abs(bent - bent[0]).max() > 1.0


def assert_closed(run, model):
    """Points of joints are together at every frame, and the welded ends keep their relative rotation."""
    assert max(gap(run, joint) for joint in model.joints) < 1e-12
    one, other = (run.port(side).rotation.values for side in model.joints[0].ports)
    relative = quaternion.multiply(quaternion.conjugate(one), other)
    assert np.abs(relative - relative[0]).max() < 1e-12


@RULES
def test_flow_is_symplectic(rule):
    """The two-form of two directions on the constrained phase space is the same after 20 steps.

    Both directions are derivatives by central differences of order 4: of the state after some steps by momenta at their
    beginning, and by the momenta there, each projected so that velocities agree with the joints.
    """
    model, h = free(), STEPS[rule]
    begin = cy.simulate(model, 20 * h, h, rule=rule, initial=shaken(model), save_every=20 * h)
    system, start = begin.system, begin.state
    rng = np.random.default_rng(2)
    pushes = [np.abs(start.momenta).max(axis=0) * rng.normal(size=start.momenta.shape) for _ in range(2)]

    def pushed(state, push):
        state = State(values=state.values, momenta=state.momenta + push)
        return State(values=state.values, momenta=projected(system, state)[0])

    def run(state):
        return cy.integrate(system, state, 20 * h, h, save_every=20 * h).state

    def twice(first, second):
        middle = pushed(run(pushed(start, first * pushes[0])), second * pushes[1])
        return middle, run(middle)

    size, known = 2e-4, twice(0.0, 0.0)
    forms = []
    for k in (0, 1):
        ways = []
        for axis in (0, 1):
            one, two = (
                [local(system, known[k], twice(*(sign * m * size * np.eye(2)[axis]))[k]) for sign in (1, -1)]
                for m in (1, 2)
            )
            ways.append((8 * (one[0] - one[1]) - (two[0] - two[1])) / (12 * size))
        forms.append(ways[0] @ two_form(system, known[k]) @ ways[1])
    assert abs(forms[1] / forms[0] - 1.0) < 1e-8, forms


@RULES
def test_time_reversal(rule):
    """Forward, momenta reversed, the same number of steps again: back where it began."""
    a, b, bob = pair()
    eye = bob.port("eye")
    ties = [joints.weld(a.end, b.start), joints.cylindrical(b.end, eye, axis=AXIS)]
    spring = springs.bushing(b.end, eye, stiffness=[50, 50, 300, 1, 2, 3])
    model = cy.Model(a, b, bob, supports=[supports.turn(a.start, AXIS)], joints=ties, springs=[spring], loads=[WEIGHT])
    h = 2.0 * STEPS[rule]
    there = cy.simulate(model, 400 * h, h, rule=rule, save_every=400 * h)
    back = cy.integrate(there.system, turned_around(there.state), 400 * h, h, save_every=400 * h)
    assert np.abs(there.frames.values[-1] - there.frames.values[0]).max() > 0.1
    assert_allclose(back.frames.values[-1], there.frames.values[0], rtol=0, atol=1e-10)
    assert_allclose(back.frames.momenta[-1], -there.frames.momenta[0], rtol=0, atol=1e-10)


# Order


@pytest.fixture(scope="module")
def limits():
    """Values and momenta after 0.1 s by polynomials of degree 3 in time; rods are those of verlet."""
    rule, found = rules.galerkin(time=3), {}
    for make in (free, driven, followed, damped):
        model = make()
        found[make] = last(model, rule, 800, 0.1, initial=tumbling(model) if make is free else None)
    return found


@pytest.mark.parametrize("make", [free, driven, followed, damped], ids=lambda make: make.__name__)
@pytest.mark.parametrize(
    ("rule", "steps"),
    [(rules.verlet, 400), (rules.midpoint, 400), (rules.galerkin(time=2), 100)],
    ids=["verlet", "midpoint", "galerkin(time=2)"],
)
def test_order(make, rule, steps, limits):
    """With joints; with prescribed motions; with follower loads; with springs and dampers: that of the rule."""
    model = make()
    start = tumbling(model) if make is free else None
    runs = [last(model, rule, steps * 2**k, 0.1, initial=start) for k in range(4)]
    for name in ("values", "momenta"):
        exact = getattr(limits[make], name)[-1]
        assert_order([np.abs(getattr(run, name)[-1] - exact).max() for run in runs], rule.order, floor=1e-13)


@pytest.mark.parametrize("make", [driven, followed], ids=lambda make: make.__name__)  # damped ones compile for long
@pytest.mark.parametrize("rule", [rules.screw, rules.screw_midpoint], ids=str)
def test_order_of_screw_rules(make, rule):
    """Against the finest of the other one of the two, which share their rods."""
    model = make()
    other = rules.screw_midpoint if rule is rules.screw else rules.screw
    fine = [last(model, other, n, 0.1).values[-1] for n in (3200, 6400)]
    exact = fine[1] + (fine[1] - fine[0]) / 3.0
    errors = [np.abs(last(model, rule, n, 0.1).values[-1] - exact).max() for n in (400, 800, 1600, 3200)]
    assert_order(errors, floor=1e-12)


# Restart


@pytest.mark.parametrize("make", [driven, followed, damped], ids=lambda make: make.__name__)
@RULES
def test_continuing_through_the_store_is_never_having_stopped(make, rule, tmp_path):
    """Bit for bit, frames and momenta."""
    model, h = make(), STEPS[rule]
    options = {"dt": h, "rule": rule, "save_every": 20 * h}
    whole = cy.simulate(model, 100 * h, **options)
    cy.simulate(model, 40 * h, **options).save(tmp_path / "run")
    opened = cy.Trajectory.open(tmp_path / "run", model=model)
    on = cy.integrate(opened.system, opened.state, 100 * h, save_every=20 * h)
    assert on.dt == whole.dt
    assert_array_equal(on.frames.values[1:], whole.frames.values[3:])
    assert_array_equal(on.frames.momenta[1:], whole.frames.momenta[3:])


def test_tables_go_on_without_the_model(tmp_path):
    """Motions given as tables are in the store; the opened run needs nothing else to go on."""
    a, b, bob = pair()
    turn = ([0.0, 0.02, 0.05], [0.0, 0.1, -0.2])
    motor = joints.hinge(b.end, bob.port("eye"), axis=AXIS, angle=turn)
    root = supports.slide(a.start, (0, 0, 1), displacement=([0.0, 0.05], [0.0, 0.02]))
    model = cy.Model(a, b, bob, supports=[root], joints=[joints.weld(a.end, b.start), motor], loads=[WEIGHT])
    whole = cy.simulate(model, 0.04, 2e-4, save_every=0.01)
    cy.simulate(model, 0.02, 2e-4, save_every=0.01).save(tmp_path / "run")
    opened = cy.Trajectory.open(tmp_path / "run")
    on = cy.integrate(opened.system, opened.state, 0.04, save_every=0.01)
    assert_array_equal(on.frames.values[1:], whole.frames.values[3:])


# The way a model is written


def written(order, *, reverse=False, swap=False, tie_order=(0, 1)):
    """A clamped frame; parts and joints in any order, the second rod from either end, sides of joints either way."""
    a, b, bob = pair()
    if reverse:
        back = -np.array(b.direction)
        b = cy.Rod(THICK, length=0.8, elements=3, origin=b.end.place[0], direction=back, name="b")
    near, far = (b.end, b.start) if reverse else (b.start, b.end)
    sides = [(a.end, near), (far, bob.port("eye"))]
    if swap:
        sides = [pair[::-1] for pair in sides]
    ties = [joints.weld(*sides[0]), joints.hinge(*sides[1], axis=AXIS)]
    parts = [(a, b, bob)[k] for k in order]
    held = [supports.clamp(a.start)]
    return cy.Model(*parts, supports=held, joints=[ties[k] for k in tie_order], loads=[WEIGHT])


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint, rules.galerkin(time=2)], ids=str)
@pytest.mark.parametrize(
    "how",
    [
        {"order": (2, 1, 0)},
        {"order": (1, 2, 0), "tie_order": (1, 0)},
        {"order": (0, 1, 2), "swap": True},
        {"order": (0, 2, 1), "reverse": True},
    ],
    ids=["backwards", "shuffled", "sides swapped", "rod reversed"],
)
def test_order_of_parts_and_sides_does_not_matter(how, rule):
    """The same motion to round-off."""
    h = 2.0 * STEPS[rule]
    options = {"rule": rule, "save_every": 20 * h}
    one = cy.simulate(written((0, 1, 2)), 200 * h, h, **options)
    other = cy.simulate(written(**how), 200 * h, h, **options)
    flip = slice(None, None, -1 if how.get("reverse") else 1)
    assert_allclose(other["a"].position, one["a"].position, rtol=0, atol=1e-11)
    assert_allclose(other["b"].position[:, flip], one["b"].position, rtol=0, atol=1e-11)
    assert_allclose(other["bob"].rotation, one["bob"].rotation, rtol=0, atol=1e-10)
    assert_allclose(other.energy, one.energy, rtol=1e-9)


# Closed loops


def ring():
    """A square of four rods, welded at its corners and free."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.0)])
    sides = [
        cy.Rod(THICK, length=1.0, elements=3, origin=here, direction=there - here, name=f"side{k}")
        for k, (here, there) in enumerate(zip(corners, np.roll(corners, -1, axis=0), strict=True))
    ]
    ties = [joints.weld(side.end, sides[(k + 1) % 4].start) for k, side in enumerate(sides)]
    return cy.Model(*sides, joints=ties)


@RULES
def test_welded_ring(rule):
    """A closed loop of elastic rods has no redundant constraint; it flies with all that a free body keeps."""
    model = ring()
    kick = {"side0": {"velocity": lambda s: (0.0, 0.0, 3.0 * np.sin(np.pi * s) ** 2), "angular_velocity": (0, 0, 0)}}
    h = STEPS[rule]
    run = cy.simulate(model, 1000 * h, h, rule=rule, initial=kick, save_every=50 * h)
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-12 * np.linalg.norm(momentum[0])
    assert max(gap(run, joint) for joint in model.joints) < 1e-13
    assert np.ptp(run.energy.values) < 2e-3 * run.energy.values[0]


def four_bar(third, fourth):
    """Ground, crank, coupler and rocker in the plane normal to e2; hinges at the first two, others as given."""
    places = np.array([(0, 0, 0), (0, 0, 0.3), (0.8, 0, 0.7), (0.9, 0, 0)])
    bars = []
    for k, name in enumerate(("crank", "coupler", "rocker")):
        middle, arm = 0.5 * (places[k] + places[k + 1]), 0.5 * (places[k + 1] - places[k])
        ports = {"near": -arm, "far": arm}
        bars.append(cy.Body(mass=1.0 + k, inertia=[0.03, 0.02, 0.03], position=middle, ports=ports, name=name))
    crank, coupler, rocker = bars
    ties = [
        joints.hinge(crank.port("near"), axis=(0, 1, 0)),
        joints.hinge(crank.port("far"), coupler.port("near"), axis=(0, 1, 0)),
        third(coupler.port("far"), rocker.port("near")),
        fourth(rocker.port("far")),
    ]
    return cy.Model(*bars, joints=ties, loads=[cy.loads.gravity((0, 0, -9.81))])


def test_redundant_loop_is_told():
    """Four hinges with parallel axes hold a plane mechanism out of its plane three times too often."""
    model = four_bar(lambda a, b: joints.hinge(a, b, axis=(0, 1, 0)), lambda a: joints.hinge(a, axis=(0, 1, 0)))
    with pytest.raises(ValueError, match="redundant at the start, so their forces are not unique") as caught:
        cy.simulate(model, 0.1, 1e-3)
    assert "hinge4: along e3, about e2, about e1 follow from hinge, hinge2, hinge3" in str(caught.value)


@RULES
def test_four_bar_linkage(rule):
    """A loop of two hinges, a ball and a universal joint stays plane and closed, and keeps its energy."""
    model = four_bar(joints.ball, lambda a: joints.universal(a, axis=(0, 1, 0), other=(1, 0, 0)))
    run = cy.simulate(model, 1.0, STEPS[rule], rule=rule, save_every=0.02)
    assert max(gap(run, joint) for joint in model.joints) < 1e-13
    for body in model.bodies:
        assert np.abs(run[body].position.values[:, 1]).max() < 1e-12
    energy = run.energy.values
    kinetic = run.kinetic_energy.values.max()
    assert kinetic > 2.0
    assert np.ptp(energy) < 1e-4 * kinetic


# Forces by hand


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint], ids=str)
def test_weight_goes_through_the_joints(rule):
    """Two rods without stretch and a body hang from each other at rest: each force is the weight below it."""
    down = {"direction": (0, 0, -1), "normal": (1, 0, 0), "kinematics": "inextensible"}
    a = cy.Rod(cy.Section.circle(0.01, RUBBER), length=1.0, elements=5, **down)
    b = cy.Rod(cy.Section.circle(0.008, RUBBER), length=0.6, elements=4, origin=(0, 0, -1), **down)
    bob = cy.Body(mass=3.0, inertia=[0.05, 0.06, 0.09], position=(0, 0, -1.9), ports={"eye": (0, 0, 0.3)})
    ties = [joints.ball(a.end, b.start), joints.ball(b.end, bob.port("eye"))]
    gravity = cy.loads.gravity((0, 0, -9.81))
    model = cy.Model(a, b, bob, supports=[supports.clamp(a.start)], joints=ties, loads=[gravity])
    run = cy.simulate(model, 0.01, 1e-4, rule=rule)
    below = b.mass + bob.mass + a.mass * (1.0 - np.asarray(a.nodes))
    assert_allclose(run[a].force.values[-1, :, 2], 9.81 * below, rtol=1e-9)
    assert_allclose(run[b].force.values[-1, [0, -1], 2], 9.81 * np.array([b.mass + bob.mass, bob.mass]), rtol=1e-9)
    for joint, mass in zip(model.joints, (b.mass + bob.mass, bob.mass), strict=True):
        assert_allclose(np.abs(run.joint(joint).force.isel(time=-1)), (0.0, 0.0, 9.81 * mass), atol=1e-9)
    held = run.reaction(a.start).isel(time=-1)
    assert_allclose(held.force, (0.0, 0.0, 9.81 * model.mass), atol=1e-9)
    assert_allclose(held.moment, 0.0, atol=1e-9)
    assert np.abs(run.frames.values[-1] - run.frames.values[0]).max() < 1e-12
