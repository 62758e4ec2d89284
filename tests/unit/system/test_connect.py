"""Joints and springs of a model as data of a system: closed at the start, and moving as prescribed."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import joints, rules, springs, supports
from cayley.discrete.joint import COUNTS, evaluator, joint_program
from cayley.discrete.spring import spring_program
from cayley.lie import quaternion
from cayley.system.couplings import GROUND, joint_inputs
from cayley.system.discretize import discretize
from cayley.system.redundancy import ground_values

STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
TUBE = cy.Section.tube(outer_radius=0.02, thickness=0.002, material=STEEL)
ARM = cy.Rod(TUBE, length=1.0, origin=(0, 0, 2), direction=(1, 0, 0.3), elements=3, name="arm")
TURN = quaternion.from_rotation_vector([0.5, -0.3, 0.8])
PLACE = np.array(ARM.end.place[0])
BOB = cy.Body(
    mass=2.0,
    inertia=[0.01, 0.01, 0.02],
    rotation=TURN,
    position=PLACE - quaternion.rotate(TURN, (0.1, 0.2, 0.3)),
    ports={"eye": ((0.1, 0.2, 0.3), quaternion.from_rotation_vector([0.1, 0.2, 0.3]))},
    name="bob",
)
EYE = BOB.port("eye")
AXIS = np.array([0.3, -1.0, 0.5])
AXIS /= np.linalg.norm(AXIS)
TWO = {
    "weld": joints.weld(ARM.end, EYE),
    "ball": joints.ball(ARM.end, EYE),
    "hinge": joints.hinge(ARM.end, EYE, axis=AXIS),
    "universal": joints.universal(ARM.end, EYE, axis=(0, 1, 0), other=(1, 0, 0)),
    "slider": joints.slider(
        ARM.end, EYE.offset(quaternion.rotate(quaternion.conjugate(EYE.place[1]), AXIS)), axis=AXIS
    ),
    "cylindrical": joints.cylindrical(ARM.end, EYE, axis=AXIS),
    "planar": joints.planar(ARM.end, EYE, normal=AXIS),
    "link": joints.rigid_link(ARM.start, EYE),
}


def angle(t: float) -> float:
    return 0.7 * t


def moved(t: float) -> np.ndarray:
    return np.array([t, -2.0 * t, 0.5 * t * t])


def violation(system, values: np.ndarray, time: float = 0.0) -> np.ndarray:
    """g of all joints."""
    found = []
    for joint in system.joints:
        program = joint_program(joint.kind, system.layout, grounded=joint.grounded, what="slope")
        inputs = joint_inputs(joint, values, ground_values(system.layout), time)
        found.append(evaluator(program)(inputs)[0, : joint.count])
    return np.concatenate(found)


@pytest.mark.parametrize("kind", TWO)
@pytest.mark.parametrize("rule", [rules.verlet, rules.spectral(space=3)], ids=str)
def test_closed_at_the_start(kind, rule):
    """Between the nodes meant, whatever the degree; named, and zero at the reference."""
    system = discretize(cy.Model(BOB, ARM, joints=[TWO[kind]]), rule)
    joint = system.joints[0]
    assert (joint.kind, joint.name) == (kind, kind)
    assert joint.count == COUNTS[kind]
    start = 1 if kind == "link" else 1 + 3 * rule.degree
    assert (joint.first, joint.second) == (start, 0)
    assert_allclose(violation(system, system.reference), 0.0, atol=1e-13)
    if kind == "link":
        assert joint.parameters[14] == TWO["link"].length


@pytest.mark.parametrize(
    ("guide", "kind"),
    [
        (supports.pin(EYE), "ball"),
        (supports.slide(EYE, AXIS), "slider"),
        (supports.turn(EYE, AXIS), "hinge"),
        (supports.guide(EYE, AXIS), "guide"),
        (supports.roll(EYE, AXIS), "roller"),
        (supports.turn(EYE, AXIS, angle=angle), "weld"),
        (supports.slide(EYE, AXIS, displacement=angle), "weld"),
        (supports.drive(EYE, position=moved), "ball"),
        (supports.drive(EYE, rotation=moved), "orientation"),
        (supports.drive(EYE, position=moved, rotation=moved), "weld"),
        (supports.drive(EYE, position=moved, rotation=moved, along=AXIS), "slider"),
        (supports.drive(EYE, rotation=moved, along=AXIS), "slider"),
        (joints.cylindrical(EYE, axis=AXIS, angle=angle), "slider"),
        (joints.cylindrical(EYE, axis=AXIS, displacement=angle), "hinge"),
        (joints.cylindrical(EYE, axis=AXIS, displacement=angle, angle=angle), "weld"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_motion_seen_from_the_ground(guide, kind):
    """At t = 2 s a joint to the ground is closed where its motion puts the port, and not where it was."""
    system = discretize(cy.Model(BOB, supports=[guide]), rules.verlet)
    assert system.joints[0].kind == kind
    assert system.joints[0].second == GROUND
    time = 2.0
    turn, step = np.zeros(3), np.zeros(3)
    if "angle" in guide.driven:
        turn += 1.4 * AXIS
    if "displacement" in guide.driven:
        step += 1.4 * AXIS
    if "position" in guide.driven:
        step += moved(time)
    if "rotation" in guide.driven:
        turn += moved(time)
    p = quaternion.multiply(quaternion.from_rotation_vector(turn), TURN)
    x = PLACE + step - quaternion.rotate(p, EYE.shift)
    values = np.concatenate([p, x])[None]
    assert_allclose(violation(system, values, time), 0.0, atol=1e-13)
    assert_allclose(violation(system, system.reference), 0.0, atol=1e-13)
    if guide.kind == "sleeve":
        along = values + np.concatenate([np.zeros(4), 0.3 * AXIS])
        assert_allclose(violation(system, along, time), 0.0, atol=1e-13)
    if guide.driven:
        assert np.abs(violation(system, system.reference, time)).max() > 0.1


def test_motion_between_two_parts():
    """The angle and the displacement are those of the second part, seen from the first."""
    values = discretize(cy.Model(ARM, BOB, joints=[TWO["hinge"]]), rules.verlet).reference.copy()
    q = quaternion.from_rotation_vector(1.4 * AXIS)
    p = quaternion.multiply(q, TURN)
    turned = values.copy()
    turned[-1] = np.concatenate([p, PLACE - quaternion.rotate(p, EYE.shift)])
    hinge = joints.hinge(ARM.end, EYE, axis=AXIS, angle=angle)
    system = discretize(cy.Model(ARM, BOB, joints=[hinge]), rules.verlet)
    assert_allclose(violation(system, turned, 2.0), 0.0, atol=1e-13)
    pushed = values.copy()
    pushed[-1, 4:] += 1.4 * AXIS
    ram = joints.slider(ARM.end, EYE, axis=AXIS, displacement=([0.0, 2.0], [0.0, 1.4]))
    system = discretize(cy.Model(ARM, BOB, joints=[ram]), rules.verlet)
    assert_allclose(violation(system, pushed, 2.0), 0.0, atol=1e-13)
    link = joints.rigid_link(ARM.start, EYE, displacement=angle)
    system = discretize(cy.Model(ARM, BOB, joints=[link]), rules.verlet)
    along = (PLACE - ARM.start.place[0]) / link.length
    longer = values.copy()
    longer[-1, 4:] += 1.4 * along
    assert_allclose(violation(system, longer, 2.0), 0.0, atol=1e-13)


def test_springs():
    """Unstressed at the start unless a length or an angle says otherwise."""
    ties = [
        springs.linear(ARM.start, EYE, stiffness=10.0),
        springs.rotational(ARM.end, EYE, axis=AXIS, stiffness=3.0, angle=0.2),
        springs.bushing(ARM.end, EYE, stiffness=[1, 2, 3, 4, 5, 6], damping=np.eye(6)),
        springs.linear(EYE, cy.ground.at((0, 0, 0)), stiffness=2.0, length=0.5),
    ]
    system = discretize(cy.Model(ARM, BOB, springs=ties), rules.verlet)
    assert [spring.name for spring in system.springs] == ["linear", "rotational", "bushing", "linear2"]
    found = []
    for spring in system.springs:
        program = spring_program(spring.kind, system.layout, grounded=spring.grounded)
        other = ground_values(system.layout) if spring.grounded else system.reference[spring.second]
        inputs = np.concatenate([system.reference[spring.first], other, spring.parameters])
        found.append(evaluator(program)(inputs)[0, 0])
    assert_allclose(found, [0.0, 0.5 * 3.0 * 0.04, 0.0, (np.linalg.norm(PLACE) - 0.5) ** 2], atol=1e-13)


def test_redundant_joints_are_refused():
    model = cy.Model(ARM, BOB, joints=[TWO["weld"], joints.ball(ARM.end, BOB.centre.offset(EYE.shift), name="again")])
    with pytest.raises(ValueError, match="1 joint is redundant at the start") as caught:
        discretize(model, rules.verlet)
    assert "again: along e1, along e2, along e3 follow from weld" in str(caught.value)
    held = cy.Model(BOB, supports=[supports.clamp(BOB.centre), supports.roll(EYE, AXIS)])
    with pytest.raises(ValueError, match="roller: along e3 follows from supports"):
        discretize(held, rules.verlet)
