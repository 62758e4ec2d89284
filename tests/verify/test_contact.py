"""Contact keeps what it should: momentum, energy, symmetry; and it loses, holds and lets slide as Coulomb says."""

import numpy as np
import pytest

import cayley as cy
from cayley import damping, loads
from cayley.lie import quaternion
from verify.problems import assert_order

RUBBER = cy.Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.49)
GRAVITY = 9.81
TURN = np.array([0.5, 0.1, -0.7, 0.5]) / 1.0


def crossing_rods(radius=0.01, length=0.3, turn=None, shift=(0, 0, 0)):
    """Two rods, the second a little above the first and on its way down, all turned and shifted."""
    p = quaternion.identity() if turn is None else np.asarray(turn)
    made = []
    for name, center, direction in (("a", (0, 0, 0), (1, 0, 0)), ("b", (0.03, 0.02, 2.1 * radius), (0, 1, 0))):
        start = np.array(center) - 0.5 * length * np.array(direction)
        rod = cy.Rod(
            cy.Section.circle(radius, RUBBER),
            length=length,
            origin=tuple(quaternion.rotate(p, start) + np.array(shift)),
            direction=tuple(quaternion.rotate(p, np.array(direction, dtype=float))),
            normal=tuple(quaternion.rotate(p, np.array([0.0, 0.0, 1.0]))),
            elements=6,
            name=name,
        )
        made.append(rod)
    velocity = np.broadcast_to(quaternion.rotate(p, np.array([0.3, 0.2, -1.0])), (7, 3))
    return made, {"b": {"velocity": velocity}}


def impact(dt, turn=None, shift=(0, 0, 0), rule=cy.rules.verlet, **contact):
    rods, initial = crossing_rods(turn=turn, shift=shift)
    model = cy.Model(*rods, contact=cy.Contact(stiffness=500.0, **contact))
    return cy.simulate(model, 0.016, dt=dt, rule=rule, save_every=5e-4, initial=initial)


@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.midpoint], ids=str)
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_an_impact_of_rods_keeps_both_momenta(friction, rule):
    run = impact(4e-5, friction=friction, rule=rule)
    assert run.contacts.number.max() > 0
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-14
    change = np.abs(run["a"].velocity.values[-1, 3]).max()
    assert change > 0.1


def test_without_friction_and_damping_energy_comes_back():
    runs = [impact(4e-5 / n, damping=0.0) for n in (1, 2, 4)]
    assert_order([np.abs(run.energy.values - run.energy.values[0]).max() for run in runs], within=0.35)
    assert np.abs(runs[-1].dissipated.values).max() < 1e-15


def test_the_balance_closes_with_friction_and_damping():
    """The forces that are lost take the way of a step behind it, so to first order; it is a small part of the loss."""
    runs = [impact(4e-5 / n, friction=0.5, damping=0.2) for n in (1, 2, 4)]
    defects = [np.abs(run.energy_balance.defect.values).max() for run in runs]
    assert_order(defects, order=1.0, within=0.35)
    lost = [run.dissipated.values for run in runs]
    assert defects[0] < 1e-3 * lost[0][-1]
    assert abs(lost[0][-1] / lost[2][-1] - 1.0) < 0.01
    assert np.diff(lost[2]).min() > -1e-6  # it only grows, but for what the bristles of friction give back


def test_an_implicit_rule_closes_the_balance_to_second_order():
    runs = [impact(1e-4 / n, rule=cy.rules.midpoint, friction=0.5, damping=0.2) for n in (1, 2, 4)]
    assert_order([np.abs(run.energy_balance.defect.values).max() for run in runs], within=0.35)


@pytest.mark.parametrize(
    ("rule", "dt"), [(cy.rules.midpoint, 1e-3), (cy.rules.verlet, 1e-4)], ids=["midpoint", "verlet"]
)
@pytest.mark.filterwarnings("ignore::cayley.ContactDepthWarning")
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_rods_that_meet_along_each_other(friction, rule, dt):
    """Where they come nearest jumps from end to end as they rock; steps are solved and momenta kept nevertheless."""
    random, section = np.random.default_rng(0), cy.Section.circle(0.005, RUBBER)
    rods, initial = [], {}
    for k in range(3):
        rod = cy.Rod(section, length=0.3, origin=(-0.15, 0.004 * (k % 2), 0.012 * k), direction=(1, 0, 0), elements=15)
        velocity = [*(0.02 * random.standard_normal(2)), 0.3 * (1 - k)]
        initial[rod] = {"velocity": np.broadcast_to(velocity, (16, 3))}
        rods.append(rod)
    model = cy.Model(*rods, contact=cy.Contact(friction=friction))
    run = cy.simulate(model, 0.1, dt=dt, rule=rule, save_every=0.005, initial=initial)
    assert run.contacts.deepest[-1] > 0.01
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-14
    assert np.abs(run.energy_balance.defect.values).max() < 0.2 * run.energy.values[0]


def test_turning_everything_turns_the_answer():
    shift = np.array([0.4, -0.3, 0.7])
    one, other = (impact(4e-5, turn=turn, shift=way, friction=0.5) for turn, way in ((None, (0, 0, 0)), (TURN, shift)))
    for name in ("a", "b"):
        turned = quaternion.rotate(TURN, one[name].position.values) + shift
        np.testing.assert_allclose(other[name].position.values, turned, atol=1e-12)


def down(angle):
    """Normal of an incline and the way down it."""
    return np.array([np.sin(angle), 0.0, np.cos(angle)]), np.array([np.cos(angle), 0.0, -np.sin(angle)])


@pytest.mark.parametrize("part", [0.3, 0.9, 1.1, 2.0])
def test_a_ball_rolls_or_slips_down_an_incline(part):
    """It slips beyond tan = 7/2 mu; rolling it has 5/7 of the acceleration without friction."""
    friction, radius, mass = 0.3, 0.05, 0.4
    angle = np.arctan(part * 3.5 * friction)
    normal, way = down(angle)
    inertia = 0.4 * mass * radius**2 * np.ones(3)
    ball = cy.Body(mass=mass, inertia=inertia, position=tuple(radius * normal), name="ball")
    shapes = [cy.Sphere(radius, on=ball), cy.Plane(normal=tuple(normal))]
    model = cy.Model(
        ball,
        loads=[loads.gravity((0, 0, -GRAVITY))],
        obstacles=shapes,
        contact=cy.Contact(friction=friction, penetration=1e-3),
    )
    run = cy.simulate(model, 1.0, save_every=0.1)
    speed = run[ball].velocity.values @ way
    rolls, slips = 5 / 7 * GRAVITY * np.sin(angle), GRAVITY * (np.sin(angle) - friction * np.cos(angle))
    exact = rolls if part < 1.0 else slips
    assert abs((speed[-1] - speed[4]) / 0.6 / exact - 1.0) < 5e-3
    slip = speed[-1] - radius * np.linalg.norm(run[ball].angular_velocity.values[-1])
    assert abs(slip) < 2e-3 * speed[-1] if part < 1.0 else slip > 0.3


def box_on_incline(angle, t_end):
    normal, way = down(angle)
    turn = (np.cos(0.5 * angle), 0.0, np.sin(0.5 * angle), 0.0)
    box = cy.Body(
        mass=0.4, inertia=[6.7e-4, 1.7e-3, 1.7e-3], position=tuple(0.04995 * normal), rotation=turn, name="box"
    )
    shapes = [cy.Box((0.2, 0.1, 0.1), on=box), cy.Plane(normal=tuple(normal))]
    model = cy.Model(box, loads=[loads.gravity((0, 0, -GRAVITY))], obstacles=shapes, contact=cy.Contact(friction=0.3))
    return cy.simulate(model, t_end, save_every=0.1)[box], way


def test_a_box_on_an_incline_sticks_without_creep_and_slides_beyond():
    held, way = box_on_incline(np.arctan(0.95 * 0.3), 20.0)
    place = held.position.values @ way
    assert place[-1] < 1e-3
    assert np.ptp(place[100:]) < 1e-9
    angle = np.arctan(1.3 * 0.3)
    slid, way = box_on_incline(angle, 1.0)
    speed = slid.velocity.values @ way
    exact = GRAVITY * (np.sin(angle) - 0.3 * np.cos(angle))
    assert abs((speed[-1] - speed[5]) / 0.5 / exact - 1.0) < 5e-3


def stack(sizes, shift):
    """Boxes of 60 mm height on each other, and their shapes."""
    made = [
        cy.Body(
            mass=0.2, inertia=[3e-4, 3e-4, 4e-4], position=(k * shift, 0.5 * k * shift, 0.03 + 0.06 * k), name=f"b{k}"
        )
        for k in range(len(sizes))
    ]
    return made, [cy.Box((size, size, 0.06), on=body) for body, size in zip(made, sizes, strict=True)]


@pytest.mark.parametrize(
    ("sizes", "shift"), [((0.1, 0.1, 0.1), 0.0), ((0.1, 0.1, 0.1), 0.002), ((0.15, 0.1, 0.06), 0.002)]
)
@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.midpoint], ids=str)
def test_stacks_of_boxes_rest(sizes, shift, rule):
    bodies, shapes = stack(sizes, shift)
    model = cy.Model(
        *bodies,
        loads=[loads.gravity((0, 0, -GRAVITY))],
        obstacles=[cy.Plane(), *shapes],
        contact=cy.Contact(friction=0.4),
    )
    run = cy.simulate(model, 2.0, dt=1e-3 if rule.implicit else None, rule=rule, save_every=0.05)
    for k, body in enumerate(bodies):
        place = run[body].position.values
        assert np.abs(place[-1] - place[0]).max() < 5e-4
        assert np.ptp(place[-5:], axis=0).max() < 1e-5, k
        assert run[body].rotation.values[-1, 0] > 1.0 - 1e-6


def test_a_turning_cylinder_drags_a_rod_and_slows_down_by_as_much():
    rod = cy.Rod(
        cy.Section.circle(0.005, RUBBER),
        length=0.2,
        origin=(-0.1, 0, 0.055),
        direction=(1, 0, 0),
        elements=10,
        name="rod",
    )
    drum = cy.Body(mass=1.0, inertia=[1e-3, 1e-3, 1e-3], name="drum")
    drum_shape = cy.Cylinder(0.05, 0.2, axis=(0, 1, 0), on=drum)
    pressed = loads.force(rod.node(5), (0, 0, -0.5))
    model = cy.Model(rod, drum, loads=[pressed], obstacles=[drum_shape], contact=cy.Contact(friction=0.5))
    run = cy.simulate(model, 0.02, save_every=1e-3, initial={drum: {"angular_velocity": (0, 10.0, 0)}})
    moved = run["rod"].velocity.values[-1, :, 0].mean()
    assert moved > 0.05
    assert run["drum"].angular_velocity.values[-1, 1] < 9.9
    momentum = run.linear_momentum.values[:, 0]
    assert np.abs(momentum).max() < 1e-14


@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.midpoint], ids=str)
def test_a_run_goes_on_bit_for_bit(tmp_path, rule):
    rods, initial = crossing_rods()
    floor = cy.Plane(point=(0, 0, -0.0101), friction=0.4)
    model = cy.Model(
        *rods, loads=[loads.gravity((0, 0, -GRAVITY))], obstacles=[floor], contact=cy.Contact(friction=0.5)
    )
    every = 2.0**-10
    options = {"dt": every / 16, "save_every": every, "rule": rule}
    whole = cy.simulate(model, 30 * every, initial=initial, **options)
    cuts = np.flatnonzero(whole.contacts.number.values[:28] >= 2)  # in the middle of it
    for cut in np.random.default_rng(5).choice(cuts, 3, replace=False):
        store = tmp_path / f"run{cut}"
        cy.simulate(model, every * cut, initial=initial, store=store, **options)
        resumed = cy.resume(store, 30 * every)
        for name in ("values", "momenta", "work"):
            assert np.array_equal(getattr(resumed.frames, name), getattr(whole.frames, name)), (cut, name)
        assert np.array_equal(cy.Trajectory.open(store).contacts.energy.values, whole.contacts.energy.values)


def test_a_pile_of_200_rods_comes_down_and_stays_within_its_walls():
    random, radius, length, side = np.random.default_rng(1), 0.004, 0.06, 5
    section = cy.Section.circle(radius, cy.Material(density=1200.0, youngs_modulus=5e6, poisson_ratio=0.4))
    rods = []
    for k in range(200):
        angle, (layer, place) = random.uniform(0.0, np.pi), divmod(k, side**2)
        way = np.array([np.cos(angle), np.sin(angle), 0.1 * random.uniform(-1.0, 1.0)])
        center = 0.07 * (np.array([*divmod(place, side), 0.0]) - (side // 2) * np.array([1, 1, 0]))
        start = center + np.array([0, 0, 0.01 + 0.02 * layer]) - 0.5 * length * way / np.linalg.norm(way)
        rods.append(
            cy.Rod(
                section,
                length=length,
                origin=tuple(start),
                direction=tuple(way),
                elements=1,
                damping=damping.retardation(2e-4),
                name=f"r{k}",
            )
        )
    wall = 0.035 * side + 0.01
    walls = [
        cy.Plane(point=tuple(-wall * np.array(n)), normal=n) for n in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0))
    ]
    model = cy.Model(
        *rods,
        loads=[loads.gravity((0, 0, -GRAVITY))],
        obstacles=[cy.Plane(), *walls],
        contact=cy.Contact(friction=0.4, damping=0.3),
    )
    run = cy.simulate(model, 0.6, save_every=0.03)
    kinetic, places = run.kinetic_energy.values, run.frames.values[-1][:, run.outline.layout.rows_of("x")]
    assert kinetic[-1] < 0.05 * kinetic.max()
    assert run.contacts.number[-1] > 250
    assert run.contacts.deepest[-1] < 0.1
    assert places[:, 2].min() > 0.95 * radius
    assert places[:, 2].max() < 0.06  # from 0.15 m
    assert np.abs(places[:, :2]).max() < wall - 0.95 * radius
    balance = run.energy_balance
    assert np.abs(balance.defect.values).max() < 0.01 * balance.dissipated.values[-1]
