"""Forces in joints, of springs, and in the rods they hold, against Newton's second law."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import joints, loads, rules, springs, supports
from cayley.lie import quaternion
from cayley.steppers.saddle import reactions, saddle_problem
from cayley.system.discretize import discretize

G = np.array([0.0, 0.0, -9.81])
RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
CORD = cy.Section.circle(0.02, RUBBER)
J = np.diag([0.01, 0.02, 0.015])


def parts(kinematics: str = "shearable") -> tuple[cy.Rod, cy.Body]:
    rod = cy.Rod(CORD, length=1.0, direction=(1, 0, 0), elements=6, name="cord", kinematics=kinematics)
    bob = cy.Body(mass=0.5, inertia=J, position=(1.1, 0.05, -0.2), name="bob", ports={"eye": (-0.1, -0.05, 0.2)})
    return rod, bob


def needed(run: cy.Trajectory, bob: cy.Body) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment about the mass center on a body that Newton and Euler ask for, by differences, in space."""
    data = run[bob]
    force = bob.mass * (np.gradient(data.velocity.values, run.time, axis=0) - G)
    spin = quaternion.rotate(data.rotation.values, data.angular_velocity.values @ J)
    return force, np.gradient(spin, run.time, axis=0)


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint, rules.galerkin(time=2)], ids=str)
@pytest.mark.parametrize("kind", ["ball", "weld"])
@pytest.mark.parametrize("kinematics", ["shearable", "inextensible"])
def test_joint_force_moves_the_body(rule, kind, kinematics):
    """The joint drives the body as Newton and Euler ask for; the stress in the rod's end is minus its force."""
    rod, bob = parts(kinematics)
    tie = getattr(joints, kind)(rod.end, bob.port("eye"))
    model = cy.Model(rod, bob, supports=[supports.clamp(rod.start)], joints=[tie], loads=[loads.gravity(G)])
    run = cy.simulate(model, t_end=0.05, dt=1e-3 if rule.implicit else None, rule=rule, save_every=1e-3)
    found, inner = run.joint(tie), slice(2, -2)
    force, moment = needed(run, bob)
    lever = run.port(bob, "eye").position.values - run[bob].position.values
    scale = np.abs(force).max()
    assert_allclose(found.force.values[inner], force[inner], atol=0.03 * scale)
    twist = moment - np.cross(lever, found.force.values)
    assert_allclose(found.moment.values[inner], twist[inner], atol=0.03 * scale)
    if kind == "ball":
        assert_allclose(found.moment, 0.0, atol=1e-10 * scale)
    if rule.degree == 1:
        end = run[rod].isel(node=-1)
        assert_allclose(quaternion.rotate(end.rotation.values, -end.force.values), found.force, atol=1e-9 * scale)
        assert_allclose(quaternion.rotate(end.rotation.values, -end.moment.values), found.moment, atol=1e-9 * scale)


def test_static_weight_on_a_hinge():
    """A body at rest on a hinge: the ground carries its weight, and no moment."""
    _, bob = parts()
    hinge = supports.turn(bob.centre.offset((0, 0, 0.3)), (0, 1, 0))
    run = cy.simulate(cy.Model(bob, supports=[hinge], loads=[loads.gravity(G)]), t_end=0.1, dt=1e-3)
    assert_allclose(run.reaction("hinge").force, np.tile(-0.5 * G, (len(run.time), 1)), atol=1e-12)
    assert_allclose(run.reaction(hinge).moment, 0.0, atol=1e-12)
    assert_allclose(run.joint(hinge).force, np.tile(0.5 * G, (len(run.time), 1)), atol=1e-12)


def test_motor_torque():
    """A rotor turned as prescribed: moment J φ'' of the ground on it, and its opposite on the ground."""
    _, bob = parts()
    motor = supports.turn(bob.centre, (0, 0, 1), angle=lambda t: 0.2 * t**3)
    run = cy.simulate(cy.Model(bob, supports=[motor]), t_end=1.0, dt=1e-3)
    assert_allclose(run.reaction(motor).moment[:, 2], J[2, 2] * 1.2 * run.time, atol=1e-6)
    assert_allclose(run.joint(motor).moment, -run.reaction(motor).moment, atol=1e-12)


def test_spring_in_the_end_of_a_rod():
    """A spring at the end of a rod is in the stress there."""
    rod, _ = parts()
    tie = springs.linear(rod.end, cy.ground.at((1.5, 0, 0)), stiffness=30.0, damping=0.5, length=0.2)
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], springs=[tie])
    run = cy.simulate(model, t_end=0.02, dt=5e-4, rule=rules.midpoint, save_every=1e-3)
    end = run[rod].isel(node=-1)
    way = np.array([1.5, 0, 0]) - end.position.values
    length = np.linalg.norm(way, axis=1)
    rate = -np.einsum("ti,ti->t", end.velocity.values, way) / length
    pull = (30.0 * (length - 0.2) + 0.5 * rate)[:, None] * way / length[:, None]
    assert_allclose(quaternion.rotate(end.rotation.values, end.force.values), pull, atol=1e-9)


def test_kept_in_the_store(tmp_path):
    rod, bob = parts()
    tie = joints.ball(rod.end, bob.port("eye"), name="swivel")
    model = cy.Model(rod, bob, supports=[supports.clamp(rod.start)], joints=[tie], loads=[loads.gravity(G)])
    run = cy.simulate(model, t_end=0.01, dt=1e-3, rule=rules.midpoint, save_every=1e-3)
    run.save(tmp_path / "run")
    opened = cy.Trajectory.open(tmp_path / "run")
    for ask in (lambda r: r.joint("swivel"), lambda r: r.joint(tie), lambda r: r.reaction(model.supports[0])):
        assert ask(opened).identical(ask(run))
    with pytest.raises(KeyError, match="the run has no joint 'hinge'; it has swivel"):
        opened.joint("hinge")


def test_forces_that_are_not_unique_are_no_numbers():
    """Two links whose anchors and body come to stand in one line pull against each other as they like."""
    body = cy.Body(mass=1.0, inertia=[1, 1, 1], position=(0, 0, 0), name="body")
    anchors = [(1.0, 0, 0), (0, 1.0, 0)]
    links = [joints.rigid_link(body.centre, cy.ground.at(place)) for place in anchors]
    system = discretize(cy.Model(body, joints=links), rules.verlet)
    made, columns = saddle_problem(system), system.layout.dofs_of("x")
    values, force, rates = system.reference.copy(), np.zeros((1, 6)), [np.zeros((2, 1))]
    force[0, columns] = (1.0, 2.0, 0.0)
    pulls = reactions(made, values, 0.0, force, rates).forces[0][:, 0, 0, columns]
    assert_allclose(pulls, [(-1.0, 0, 0), (0, -2.0, 0)], atol=1e-14)
    values[0, system.layout.rows_of("x")] = (0.5, 0.5, 0.0)
    assert np.isnan(reactions(made, values, 0.0, force, rates).forces[0]).all()
