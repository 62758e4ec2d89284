"""Joints, guides, drives and tables as objects, and what a model says of them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.lie import quaternion
from cayley.model import Body, Material, Model, PointMass, Rod, Section, ground, joints, loads, springs, supports
from cayley.model.motion import Table

STEEL = Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
TUBE = Section.tube(outer_radius=0.02, thickness=0.002, material=STEEL)
MAST = Rod(TUBE, length=2.0, direction=(0, 0, 1), elements=4, name="mast")
ARM = Rod(TUBE, length=1.0, origin=(0, 0, 2), direction=(1, 0, 0), elements=3, name="arm")
BOB = Body(mass=2.0, inertia=[0.01, 0.01, 0.02], position=(1, 0, 1.7), name="bob", ports={"eye": (0, 0, 0.3)})
EYE = BOB.port("eye")


def test_listing():
    """The model of the acceptance script, with everything that can be listed."""
    model = Model(
        MAST,
        ARM,
        BOB,
        PointMass(mass=1.0),
        supports=[supports.clamp(MAST.start), supports.roll(BOB.centre, (0, 0, 2))],
        joints=[
            joints.weld(MAST.end, ARM.start),
            joints.hinge(ARM.end, EYE, axis=(0, 1, 0), angle=([0.0, 1.0], [0.0, 0.5])),
            joints.rigid_link(BOB.centre, ground.at((0, 0, 1.7)), name="stay"),
        ],
        springs=[springs.linear(ARM.end, ground.at((1, 0, 0)), stiffness=10.0, damping=0.5)],
    )
    assert str(model).splitlines() == [
        "Model: 2 rods, 1 body, 1 mass, 7 elements, 11 nodes, 8.62282 kg",
        "  parts",
        "    mast: 2 m, 4 elements, tube of radius 0.02 m, wall 0.002 m, 3.74855 kg",
        "    arm: 1 m, 3 elements, tube of radius 0.02 m, wall 0.002 m, 1.87427 kg",
        "    bob: rigid body, 2 kg",
        "    mass: point mass, 1 kg",
        "  supports",
        "    clamp at mast.start",
        "    roller of bob.centre to ground, axis (0, 0, 1)",
        "  joints",
        "    weld of mast.end and arm.start",
        "    hinge of arm.end and bob.eye, axis (0, 1, 0), angle: table of 2 times, 0 s to 1 s, cubic",
        "    link of bob.centre to ground (0, 0, 1.7), 1 m",
        "  springs",
        "    linear spring of arm.end and ground (1, 0, 0), 10 N/m, 0.5 N s/m, unstressed at 2 m",
        "  warnings",
        "    mass is neither held nor connected to another part; it flies free",
    ]
    assert repr(model) == "Model(mast, arm, bob, mass; supports=2, joints=3, springs=1, loads=0)"
    assert model.connection_names == ("roller", "weld", "hinge", "stay")
    assert model.replace(joints=[]).joints == ()
    assert model.replace(joints=[]).guides == model.guides
    assert model.replace(supports=[]).guides == ()


def test_frames_and_gaps():
    """e3 of the joint frame is the axis; a slider may be apart along it, a plane across its normal."""
    joint = joints.slider(MAST.end, EYE, axis=(2, 0, 0))
    assert_allclose(quaternion.rotate(joint.frame, (0, 0, 1)), (1, 0, 0), atol=1e-15)
    assert_allclose(joint.gap, 0.0, atol=1e-12)
    assert_allclose(joints.cylindrical(MAST.end, EYE, axis=(0, 0, 1)).gap, 1.0)
    assert_allclose(joints.planar(MAST.end, EYE, normal=(0, 0, 1)).gap, 0.0, atol=1e-12)
    assert_allclose(joints.ball(MAST.end, EYE).gap, 1.0)
    assert_allclose(joints.rigid_link(MAST.end, EYE).length, 1.0)
    down = joints.hinge(MAST.end, axis=(0, 0, -1))
    assert_allclose(quaternion.rotate(down.frame, (0, 0, 1)), (0, 0, -1), atol=1e-15)
    cross = joints.universal(ARM.end, EYE, axis=(0, 1, 0), other=(0, 0, 1))
    assert_allclose(quaternion.rotate(cross.frame, (1, 0, 0)), (0, 1, 0), atol=1e-15)
    assert_allclose(quaternion.rotate(cross.frame, (0, 1, 0)), (0, 0, 1), atol=1e-15)


def test_ground_first_is_the_same():
    joint = joints.ball(ground, EYE)
    assert joint.first == EYE
    assert joint.grounded


@pytest.mark.parametrize("interpolation", ["cubic", "linear"])
def test_table(interpolation):
    """Exact at its times, at rest outside, and of a cubic one with continuous rates."""
    table = Table(np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 1.0]), interpolation)
    assert_allclose(table(np.array([-1.0, 0.0, 1.0, 3.0, 9.0])), [0.0, 0.0, 2.0, 1.0, 1.0], atol=1e-14)
    if interpolation == "linear":
        assert_allclose(table(0.25), 0.5)
    else:
        h = 1e-6
        assert_allclose((table(h) - table(0.0)) / h, 0.0, atol=1e-5)
        assert_allclose((table(1.0 + h) - table(1.0)) / h, (table(1.0) - table(1.0 - h)) / h, atol=1e-4)


def test_pin_and_clamp_off_the_node():
    """A pin off the node is a ball joint to the ground, a clamp holds the whole node."""
    assert supports.pin(EYE).kind == "ball"
    assert Model(BOB, supports=[supports.clamp(EYE)]).held(BOB.centre) == ((True,) * 3, (True,) * 3)


def test_warnings_follow_joints():
    model = Model(MAST, ARM, supports=[supports.clamp(MAST.start)])
    assert model.warnings == ("arm is neither held nor connected to another part; it flies free",)
    assert model.replace(joints=[joints.weld(MAST.end, ARM.start)]).warnings == ()


def late(t: float) -> float:
    return 1.0 + t


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (
            lambda: Model(MAST, BOB, joints=[joints.ball(MAST.end, EYE)]),
            ValueError,
            "Model: ball of mast.end and bob.eye has a gap of 1 m at the start: (0, 0, 2) and (1, 0, 2); move a part, "
            "or "
            "give a port there with port.offset(...)",
        ),
        (
            lambda: Model(MAST, BOB, joints=[joints.rigid_link(MAST.end, EYE, length=1.5)]),
            ValueError,
            "Model: link of mast.end and bob.eye is 1.5 m long, but its ends are 1 m apart at the start; leave length "
            "out "
            "or move a part",
        ),
        (
            lambda: Model(ARM, BOB, joints=[joints.ball(ARM.end, EYE), joints.ball(EYE, ARM.end)]),
            ValueError,
            "Model: ball of bob.eye and arm.end says the same as ball of arm.end and bob.eye; leave one out",
        ),
        (
            lambda: Model(ARM, joints=[joints.ball(ARM.end, EYE)]),
            ValueError,
            "Model: ball of arm.end and bob.eye belongs to a body that is not in the model; add it (the model has arm)",
        ),
        (
            lambda: Model(BOB, supports=[supports.pin(BOB.centre)], loads=[loads.force(BOB.centre, (0, 0, 1))]),
            ValueError,
            "Model: force on bob.centre has no effect, for the position it acts on is held there; move it to another "
            "node "
            "or hold less",
        ),
        (
            lambda: Model(ARM, BOB, supports=[joints.ball(ARM.end, EYE)]),
            ValueError,
            "Model: ball of arm.end and bob.eye is no support, for it connects two parts; give it among the joints",
        ),
        (
            lambda: Model(BOB, joints=[joints.ball(EYE, name="b"), joints.ball(BOB.centre, name="b")]),
            ValueError,
            "Model: two joints have the name 'b'; give each a name of its own",
        ),
        (
            lambda: Model(BOB, joints=joints.ball(EYE)),
            TypeError,
            "Model: joints is a Joint, but must be a list, such as joints=[joints.weld(mast.end, arm.start)]",
        ),
        (
            lambda: joints.ball(BOB.centre, EYE),
            ValueError,
            "ball of bob.centre and bob.eye: both sides are the same node, which moves as one; give ports of two nodes",
        ),
        (
            lambda: joints.weld(None, EYE),
            TypeError,
            'weld: first = None must be a port, such as rod.end or body.port("eye")',
        ),
        (
            lambda: joints.hinge(ARM.end, EYE, axis=(0, 0, 0)),
            ValueError,
            "hinge of arm.end and bob.eye: axis = (0, 0, 0) must be a vector other than zero (it need not have length "
            "1)",
        ),
        (
            lambda: joints.universal(ARM.end, EYE, axis=(0, 1, 0), other=(0, 1, 1)),
            ValueError,
            "universal of arm.end and bob.eye: other = (0, 1, 1) must be perpendicular to axis = (0.0, 1.0, 0.0)",
        ),
        (
            lambda: joints.hinge(ARM.end, EYE, axis=(0, 1, 0), angle=late),
            ValueError,
            "hinge of arm.end and bob.eye: angle is 1 rad at t = 0, but must be 0 there: it counts from the start; "
            "subtract its first value",
        ),
        (
            lambda: joints.hinge(ARM.end, EYE, axis=(0, 1, 0), angle=0.5),
            TypeError,
            "hinge of arm.end and bob.eye: angle = 0.5 must be a function of the time [s] that returns a number "
            "[rad], or "
            "(times, values)",
        ),
        (
            lambda: joints.hinge(ARM.end, EYE, axis=(0, 1, 0), angle=([0.0, 0.0], [0.0, 1.0])),
            ValueError,
            "hinge of arm.end and bob.eye: angle: Table: times = [0.0, 0.0] must be at least two rising times [s]",
        ),
        (
            lambda: joints.rigid_link(EYE, ground),
            ValueError,
            "link of bob.eye to ground: length = 0.0 must be a positive, finite number [m]",
        ),
        (
            lambda: supports.drive(EYE),
            ValueError,
            "drive of bob.eye: nothing is prescribed; give position or rotation, or hold the node",
        ),
        (
            lambda: supports.hold(EYE, position="x"),
            ValueError,
            "support at bob.eye: a place off the node can be clamped, but not held by components; hold the node, or "
            "use "
            "supports.pin, guide, roll, slide or turn",
        ),
        (
            lambda: springs.linear(ARM.end, EYE),
            ValueError,
            "linear spring of arm.end and bob.eye: neither stiffness nor damping; give one of them",
        ),
        (
            lambda: springs.linear(MAST.end, EYE, stiffness=-1.0),
            ValueError,
            "linear spring of mast.end and bob.eye: stiffness = -1.0 must be a number from 0",
        ),
        (lambda: springs.bushing(MAST.end, EYE, stiffness=[1, 1, 1, 1, 1, -1]), ValueError, None),
    ],
)
def test_refusals(call, error, line):
    with pytest.raises(error) as caught:
        call()
    assert "\n" not in str(caught.value)
    if line is not None:
        assert str(caught.value) == line
