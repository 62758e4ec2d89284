"""Assemblies of rods and bodies that the verification tests share, and how they start."""

import numpy as np

import cayley as cy
from cayley import joints, loads, springs, supports
from cayley.lie import quaternion
from cayley.model import damping

RUBBER = cy.Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.5)
THICK = cy.Section.circle(0.05, RUBBER)
"""So thick that a few hundred steps a second resolve all modes of a few elements."""
WEIGHT = loads.gravity((1.0, -2.0, -9.81))
AXIS = np.array((0.2, 1.0, 0.1)) / np.linalg.norm((0.2, 1.0, 0.1))
EYE = np.array((0.1, 0.05, -0.2))
TURN = quaternion.from_rotation_vector((0.3, -0.2, 0.5))


def pair(**more):
    """Two rods at an angle, and a body turned any way at the end of the second."""
    a = cy.Rod(THICK, length=1.0, elements=4, direction=(1, 0, 0), name="a", **more)
    b = cy.Rod(THICK, length=0.8, elements=3, origin=(1, 0, 0), direction=(0, 1, 0.2), name="b", **more)
    place = np.array(b.end.place[0]) - quaternion.rotate(TURN, EYE)
    ports = {"eye": EYE}
    bob = cy.Body(mass=2.0, inertia=[0.05, 0.06, 0.09], rotation=TURN, position=place, ports=ports, name="bob")
    return a, b, bob


def free():
    """Two rods welded, a body in a ball joint and another on a hinge; nothing holds them and nothing acts."""
    a, b, bob = pair()
    wheel = cy.Body(
        mass=1.5, inertia=[0.03, 0.03, 0.05], position=(-0.3, 0, 0), ports={"hub": (0.3, 0, 0)}, name="wheel"
    )
    ties = [
        joints.weld(a.end, b.start),
        joints.ball(b.end, bob.port("eye")),
        joints.hinge(a.start, wheel.port("hub"), axis=AXIS),
    ]
    return cy.Model(a, b, bob, wheel, joints=ties)


def flight(model, velocity=(0.3, -0.2, 0.5), spin=(1.0, -3.0, 4.0)):
    """Start of a rigid motion of all parts: velocity [m/s] at the origin and spin [rad/s], both in space."""
    return {part: _rigid(part, np.asarray(velocity), np.asarray(spin)) for part in model.parts}


def tumbling(model):
    """A flight in which the body in the ball joint and the wheel on the hinge turn on their own, too."""
    start = flight(model)
    bob, wheel = model.bodies
    own = np.array((2.0, 5.0, -3.0))
    start[bob]["angular_velocity"] = start[bob]["angular_velocity"] + own
    start[bob]["velocity"] = start[bob]["velocity"] - quaternion.rotate(TURN, np.cross(own, EYE))
    start[wheel]["angular_velocity"] = start[wheel]["angular_velocity"] + 8.0 * AXIS
    start[wheel]["velocity"] = start[wheel]["velocity"] - np.cross(8.0 * AXIS, (0.3, 0.0, 0.0))
    return start


def shaken(model, size=1.0):
    """Random velocities of all nodes, of about a size [m/s], brought to agree with the joints when the run starts.

    All vibrations are there from the start. After a smooth start they grow slowly, for the motion feeds them, and with
    them the small difference between the energy and what a symplectic rule conserves.
    """
    rng, start = np.random.default_rng(1), {}
    for part in model.parts:
        count = part.node_count
        velocity, spin = size * rng.normal(size=(count, 3)), 4.0 * size * rng.normal(size=(count, 3))
        if count == 1:
            start[part] = {"momentum": part.mass * velocity[0], "angular_momentum": spin[0] @ part.inertia}
        else:
            section = part.section
            start[part] = {"momentum": section.mass_per_length * velocity, "angular_momentum": spin @ section.inertia}
    return start


def driven():
    """A root that is turned and shaken, a body on a motor at the end: three prescribed motions in space."""
    a, b, bob = pair()
    root = supports.drive(
        a.start,
        position=lambda t: (0.05 * np.sin(9.0 * t) ** 2, 0.0, 0.1 * t**2),
        rotation=lambda t: (0.0, 0.5 * t**2, 1.5 * (1.0 - np.cos(6.0 * t))),
    )
    motor = joints.hinge(b.end, bob.port("eye"), axis=AXIS, angle=lambda t: 3.0 * t**2)
    return cy.Model(a, b, bob, supports=[root], joints=[joints.weld(a.end, b.start), motor], loads=[WEIGHT])


def followed():
    """A clamped frame, pushed by forces and moments that turn with it, and by one that does not."""
    a, b, bob = pair()
    pushes = [
        WEIGHT,
        loads.force(bob.centre, lambda t: (6.0, 3.0 * np.sin(20.0 * t), 2.0), frame="body"),
        loads.moment(b.node(1), (0.3, 1.0, 0.4), frame="body"),
        loads.moment(a.end, lambda t: (0.0, 4.0 * t, 1.0)),
        loads.force(a.node(2), (0.0, 5.0, 1.0), frame="body"),
    ]
    ties = [joints.weld(a.end, b.start), joints.universal(b.end, bob.port("eye"), axis=(0, 1, 0), other=(0, 0, 1))]
    return cy.Model(a, b, bob, supports=[supports.clamp(a.start)], joints=ties, loads=pushes)


def damped():
    """A frame of viscous rods on a hinge; springs and dampers of every kind between its parts and to the ground."""
    a, b, bob = pair(damping=damping.retardation(1e-3) + damping.mass_proportional(0.5))
    eye = bob.port("eye")
    ties = [
        springs.linear(a.node(2), eye, stiffness=200.0, damping=8.0, length=0.7),
        springs.linear(bob.centre, cy.ground.at((1.0, 1.5, 0.5)), stiffness=60.0, damping=3.0),
        springs.rotational(b.end, eye, axis=AXIS, stiffness=4.0, damping=0.3),
        springs.bushing(a.end, b.start, stiffness=[800, 900, 700, 9, 8, 7], damping=[4, 5, 6, 0.1, 0.2, 0.15]),
        springs.rotational(a.start, axis=AXIS, stiffness=5.0, damping=0.5),
    ]
    held = [supports.turn(a.start, AXIS)]
    return cy.Model(a, b, bob, supports=held, joints=[joints.ball(b.end, eye)], springs=ties, loads=[WEIGHT])


def _rigid(part, velocity, spin):
    places, turns = (np.array(each) for each in zip(*(part.place(k) for k in range(part.node_count)), strict=True))
    own = quaternion.inverse_rotate(turns, np.broadcast_to(spin, places.shape))
    return {"velocity": velocity + np.cross(spin, places), "angular_velocity": np.asarray(own, dtype=float)}


def gap(run, joint):
    """Largest distance of the two points of a joint over the frames [m]."""
    first = run.port(joint.first).position.values
    second = run.port(joint.second).position.values if len(joint.ports) > 1 else joint.points[1]
    return np.linalg.norm(first - second, axis=-1).max()
