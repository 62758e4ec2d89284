"""Rigid bodies beside rods: the motion of the 0-D rigid body under every family of rules, totals, ports, restart."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cayley as cy
from cayley import loads, rules, supports
from cayley.lie import quaternion

INERTIA = np.array([[0.02, 0.001, 0.0], [0.001, 0.03, 0.002], [0.0, 0.002, 0.045]])
GRAVITY = (0.3, 0.0, -9.81)
RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
CORD = cy.Section.circle(0.01, RUBBER)
SPIN, SPEED = (3.0, 10.0, -4.0), (0.3, 0.0, 1.0)
START = (1.0, 0.0, 1.7)
ALL = [
    rules.verlet,
    rules.nodal,
    rules.screw,
    rules.spectral(space=3),
    rules.midpoint,
    rules.galerkin(time=2),
    rules.galerkin(time=2, space=2),
]


def bob(**more) -> cy.Body:
    return cy.Body(mass=2.0, inertia=INERTIA, position=START, name="bob", ports={"eye": (0, 0, 0.3)}, **more)


def rod(**more) -> cy.Rod:
    return cy.Rod(CORD, length=1.0, elements=4, direction=(1, 0, 0), **more)


def alone(rule: cy.rules.Rule, dt: float) -> cy.Trajectory:
    """The same body as a Lagrangian of its own."""
    if rule.degree > 1:  # what it does in time; without an interval there is nothing else
        rule = rules.galerkin(time=2) if rule.implicit else rules.verlet
    constants = {"mass": 2.0, "inertia": INERTIA, "gravity": GRAVITY}
    system = cy.compile(cy.densities.rigid_body, rule=rule, constants=constants)
    return cy.integrate(system, {"x": START, "p_t": SPIN, "x_t": SPEED}, t_end=0.05, dt=dt)


@pytest.mark.parametrize("rule", ALL, ids=str)
@pytest.mark.parametrize("order", ["first", "last", "without a rod"])
def test_moves_as_the_rigid_body(rule, order):
    """Among rods and other bodies, before and after them, a free body does the steps it does alone."""
    body, beside = bob(), [rod(), cy.Body(mass=1.0, inertia=[1, 1, 1]), cy.PointMass(mass=3.0, position=(0, 1, 2))]
    parts = {"first": [body, *beside], "last": [*beside, body], "without a rod": [beside[1], body, beside[2]]}[order]
    held = [supports.pin(beside[0].start)] if beside[0] in parts else []
    model = cy.Model(*parts, supports=held, loads=[loads.gravity(GRAVITY)])
    run = cy.simulate(
        model, t_end=0.05, dt=2e-4, rule=rule, initial={body: {"velocity": SPEED, "angular_velocity": SPIN}}
    )
    known = alone(rule, 2e-4)
    assert run.dt == known.dt
    assert_allclose(run[body].position, known.data.x, atol=1e-12)
    assert_allclose(run[body].rotation, known.data.p, atol=1e-12)
    assert_allclose(run[body].velocity, known.data.x_t, atol=1e-11)
    assert_allclose(run[body].angular_velocity, known.data.p_t, atol=1e-10)
    assert_allclose(run[body].energy, known.energy, rtol=1e-11)
    falling = run["mass"]
    fall = np.array([0, 1, 2]) + 0.5 * np.outer(run.time**2, GRAVITY)
    assert_allclose(falling.position, fall, atol=1e-12)
    assert_allclose(falling.rotation, np.tile([1.0, 0, 0, 0], (len(run.time), 1)))


def test_totals_include_bodies():
    body, beam = bob(), rod()
    model = cy.Model(beam, body, loads=[loads.gravity((0, 0, -9.81))])
    run = cy.simulate(model, t_end=0.02, initial={body: {"velocity": SPEED, "angular_velocity": SPIN}})
    spin = quaternion.rotate(run[body].rotation, run[body].angular_velocity.values @ INERTIA)
    about = np.cross(run[body].position, 2.0 * run[body].velocity) + spin
    without = cy.simulate(cy.Model(rod(), loads=model.loads), t_end=0.02, dt=run.dt)
    assert_allclose(run.angular_momentum - without.angular_momentum, about, atol=1e-11)
    assert_allclose(run.linear_momentum - without.linear_momentum, 2.0 * run[body].velocity, atol=1e-11)
    assert_allclose(run.energy - without.energy, run[body].energy, atol=1e-10)


def test_step_limit_is_that_of_the_rod():
    alone = cy.simulate(cy.Model(rod()), t_end=1e-3).dt
    assert_allclose(cy.simulate(cy.Model(rod(), bob()), t_end=1e-3).dt, alone, rtol=1e-9)
    with pytest.raises(ValueError, match="has no step limit under the rule verlet; give dt"):
        cy.simulate(cy.Model(bob()), t_end=1e-3)


def test_accuracy_counts_the_turning_of_bodies():
    """A spinning body at rest: the step is chosen for its rotation, though no node moves."""
    body = bob()
    run = cy.simulate(cy.Model(body), t_end=1.0, accuracy=1e-4, initial={body: {"angular_velocity": SPIN}})
    fine = cy.simulate(
        cy.Model(body),
        t_end=1.0,
        dt=run.dt / 20,
        rule=rules.galerkin(time=3),
        initial={body: {"angular_velocity": SPIN}},
    )
    apart = 2.0 * np.abs(run[body].rotation[-1] - fine[body].rotation[-1]).max()
    assert apart < 1e-4


def test_ports_in_results():
    """P = x + Λ o, and its velocity is the derivative."""
    body = bob()
    run = cy.simulate(cy.Model(body, rod(name="beam")), t_end=0.05, dt=1e-5, initial={body: {"angular_velocity": SPIN}})
    eye, data = run.port(body, "eye"), run[body]
    assert_allclose(eye.position, data.position + quaternion.rotate(data.rotation.values, (0, 0, 0.3)), atol=1e-14)
    slope = np.gradient(eye.position.values, run.time, axis=0)[1:-1]
    assert_allclose(eye.velocity[1:-1], slope, atol=2e-4)
    turned = body.port("eye").offset((0.1, 0, 0), quaternion.from_rotation_vector((0.2, 0, 0)))
    frame = run.port(turned)
    assert_allclose(
        quaternion.rotate(frame.rotation.values, frame.angular_velocity.values),
        quaternion.rotate(data.rotation.values, data.angular_velocity.values),
        atol=1e-12,
    )
    assert_array_equal(run.port("beam", "end").position, run["beam"].position.isel(node=-1))
    assert_array_equal(run.port("bob", "centre").position, data.position)
    for wrong, name in ((body, "ear"), ("beam", "middle"), ("tail", "end")):
        with pytest.raises(KeyError, match=r"it has|must be one of"):
            run.port(wrong, name)


def test_goes_on_from_a_store(tmp_path):
    """Saved and opened, a run with a body continues as if it had never stopped; its parts are found again."""
    body, beam = bob(), rod()
    model = cy.Model(beam, body, loads=[loads.gravity(GRAVITY), loads.force(body.centre, lambda t: (t, 0, 0))])
    initial = {body: {"angular_velocity": SPIN}}
    whole = cy.simulate(model, t_end=0.02, dt=1e-5, save_every=0.01, initial=initial)
    half = cy.simulate(model, t_end=0.01, dt=1e-5, save_every=0.01, initial=initial)
    half.save(tmp_path / "run")
    opened = cy.Trajectory.open(tmp_path / "run", model=model)
    on = cy.integrate(opened.system, opened.state, t_end=0.02, save_every=0.01)
    assert_array_equal(on.frames.values[-1], whole.frames.values[-1])
    again = cy.Trajectory.open(tmp_path / "run")
    assert str(again.model) == str(model)
    assert_array_equal(again[body].position, half[body].position)
    assert_array_equal(again["bob"].energy, half[body].energy)
    assert_array_equal(again.port(body, "eye").position, half.port(body, "eye").position)


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("frame", ["space", "body"])
@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint, rules.galerkin(time=2)], ids=str)
def test_force_off_the_center(rule, frame, rotation):
    """A force on a port turns the body by o × ΛᵀF: the angular momentum grows by P × F."""
    body, pull = bob(), np.array([0.3, -0.2, 0.5])
    eye = body.port("eye")
    options = {"t_end": 0.2, "dt": 1e-3, "save_every": 1e-2, "rotation": rotation, "rule": rule}
    run = cy.simulate(cy.Model(body, loads=[loads.force(eye, pull, frame=frame)]), **options)
    data = run[body]
    turned = quaternion.rotate(data.rotation.values, np.array(eye.shift))
    force = quaternion.rotate(data.rotation.values, pull) if frame == "body" else np.tile(pull, (len(run.time), 1))
    spin = np.gradient(run.angular_momentum.values, run.time, axis=0, edge_order=2)
    assert_allclose(spin, np.cross(data.position.values + turned, force), atol=2e-4)
    assert np.linalg.norm(data.angular_velocity[-1]) > 0.5
    if frame == "body":
        moment = np.cross(eye.shift, pull)
        both = [loads.force(body.centre, pull, frame=frame), loads.moment(body.centre, moment, frame=frame)]
        again = cy.simulate(cy.Model(body, loads=both), **options)
        assert_allclose(again[body].rotation, data.rotation, atol=1e-13)
        assert_allclose(again[body].position, data.position, atol=1e-13)


def test_force_off_the_center_of_a_hinged_body():
    """Beside joints, too: a door pushed at its edge, J_hinge φ'' = arm F, with a force that turns with it."""
    body = bob()
    door = supports.turn(body.centre.offset((0, -0.5, 0)), (0, 0, 1))
    push = loads.force(body.centre.offset((0, 0.5, 0)), (0.2, 0, 0), frame="body")
    about = INERTIA[2, 2] + 2.0 * 0.25
    for rule in (rules.verlet, rules.midpoint):
        model = cy.Model(body, supports=[door], loads=[push])
        run = cy.simulate(model, t_end=1.0, dt=1e-3, rule=rule)
        assert_allclose(run[body].angular_velocity[:, 2], -0.2 * run.time / about, atol=1e-6)


def test_constant_force_off_the_center_is_conservative():
    """E − F·P stays: the work of a dead force is its force times the way of the port."""
    body, pull = bob(), np.array([0.3, -0.2, 0.5])
    model = cy.Model(rod(), body, loads=[loads.force(body.port("eye"), pull)])
    run = cy.simulate(model, t_end=0.5, initial={body: {"angular_velocity": SPIN}}, save_every=0.01)
    way = run.port(body, "eye").position.values @ pull
    defect = run.energy.values - way
    assert np.ptp(defect) < 1e-5 * np.ptp(way)
