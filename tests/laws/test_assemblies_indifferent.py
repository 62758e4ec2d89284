"""Assemblies are indifferent to where and how they stand: random ones, turned and shifted with all that acts there."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cayley as cy
from cayley import joints, loads, rules, springs, supports
from cayley.lie import quaternion
from laws.test_frame_indifference import shifts, turns
from verify.assemblies import RUBBER

LAW = settings(deadline=None, max_examples=3, derandomize=True)
STEPS, STEP = 20, 1e-3
HERE = (np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3))
SECTION = cy.Section.circle(0.05, RUBBER)
JOINTS = ["weld", "ball", "hinge", "universal", "slider", "cylindrical", "planar", "link", "motor", "spring"]
GROUNDS = ["clamp", "pin", "turn", "slide", "roll", "drive", "bushing", "none"]


@st.composite
def assemblies(draw):
    """Draw kinds of parts and of joints of a chain, what holds it, and a seed for all numbers."""
    kinds = draw(st.permutations(["rod"] * draw(st.integers(1, 3)) + ["body"] * draw(st.integers(0, 2))))
    ties = [draw(st.sampled_from(JOINTS)) for _ in kinds[1:]]
    return kinds, ties, draw(st.sampled_from(GROUNDS)), draw(st.integers(0, 1000))


class Frame:
    """Vectors, points and rotations of a drawing, after all of it is turned and then shifted."""

    def __init__(self, turn, shift):
        self.turn, self.shift = turn, shift

    def vector(self, v):
        return np.asarray(quaternion.rotate(self.turn, np.asarray(v, dtype=float)), dtype=float)

    def point(self, v):
        return self.shift + self.vector(v)

    def rotation(self, p):
        return np.asarray(quaternion.multiply(self.turn, p), dtype=float)


def chain(drawn, frame):
    """A chain of rods and bodies, each joined to the end of the one before; the first to the ground."""
    kinds, ties, ground, seed = drawn
    rng, at, parts, ends = np.random.default_rng(seed), np.zeros(3), [], []
    for k, kind in enumerate(kinds):
        direction, length = unit(rng), 0.4 + 0.5 * rng.random()
        if kind == "rod":
            normal = np.cross(direction, unit(rng))
            place = {"origin": frame.point(at), "direction": frame.vector(direction), "normal": frame.vector(normal)}
            part = cy.Rod(SECTION, length=length, elements=2, name=f"part{k}", **place)
            ends.append((part.start, part.end))
        else:
            p = quaternion.from_rotation_vector(rng.normal(size=3))
            arm = quaternion.inverse_rotate(p, 0.5 * length * direction)
            place = {"position": frame.point(at + 0.5 * length * direction), "rotation": frame.rotation(p)}
            ports = {"near": -arm, "far": arm}
            part = cy.Body(mass=2.0, inertia=[0.05, 0.06, 0.09], name=f"part{k}", ports=ports, **place)
            ends.append((part.port("near"), part.port("far")))
        parts.append(part)
        at = at + length * direction
    found = {"supports": [], "joints": [], "springs": []}
    axes = [unit(rng) for _ in ties]
    for k, (word, axis) in enumerate(zip(ties, axes, strict=True)):
        tie(found, word, ends[k][1], ends[k + 1][0], frame.vector(axis), frame.vector(np.cross(axis, unit(rng))))
    hold(found, ground, ends[0][0], frame, unit(rng))
    pull = frame.vector(rng.normal(size=3))
    acting = [
        loads.gravity(frame.vector((1.0, 2.0, -9.0))),
        loads.moment(node_of(ends[-1][1]), lambda t: (1.0 + 9.0 * t) * pull),
        loads.force(node_of(ends[-1][1]), (2.0, -1.0, 3.0), frame="body"),
    ]
    return cy.Model(*parts, **found, loads=acting)


def node_of(port):
    """The node that a port moves with, as a port."""
    part = port.part
    return part.centre if isinstance(part, cy.Body) else part.node(port.node)


def unit(rng):
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def tie(found, word, a, b, axis, other):
    """Join two ports."""
    made = {
        "weld": joints.weld,
        "ball": joints.ball,
        "hinge": partial(joints.hinge, axis=axis),
        "universal": partial(joints.universal, axis=axis, other=other),
        "slider": partial(joints.slider, axis=axis),
        "cylindrical": partial(joints.cylindrical, axis=axis),
        "planar": partial(joints.planar, normal=axis),
        "link": lambda a, b: joints.rigid_link(a.offset((0.1, 0.2, 0.0)), b),
        "motor": partial(joints.hinge, axis=axis, angle=lambda t: 30.0 * t**2),
    }
    if word == "spring":
        found["springs"] += [
            springs.bushing(a, b, stiffness=[300, 200, 250, 5, 4, 6], damping=[2, 3, 2, 0.1, 0.1, 0.2]),
            springs.linear(a.offset((0.0, 0.1, 0.2)), b, stiffness=80.0, damping=1.0, length=0.1),
        ]
    else:
        found["joints"].append(made[word](a, b))


def hold(found, word, port, frame, direction):
    """Hold a port."""
    axis = frame.vector(direction)
    made = {
        "clamp": supports.clamp,
        "pin": supports.pin,
        "turn": partial(supports.turn, axis=axis),
        "slide": partial(supports.slide, axis=axis, displacement=lambda t: 5.0 * t**2),
        "roll": partial(supports.roll, normal=axis),
        "drive": partial(supports.drive, position=lambda t: 5.0 * t**2 * axis, rotation=lambda t: 20.0 * t**2 * axis),
    }
    if word == "bushing":
        found["springs"].append(springs.bushing(port, stiffness=[300, 300, 300, 5, 5, 5], axis=axis))
        return
    if word != "none":
        found["supports"].append(made[word](port))


def motion(drawn, frame, rule):
    model = chain(drawn, frame)
    spin = np.array((1.0, -2.0, 3.0))
    start = {}
    if drawn[2] == "none":
        for part in model.parts:
            places = np.array([part.place(k)[0] for k in range(part.node_count)])
            rotations = np.array([part.place(k)[1] for k in range(part.node_count)])
            about, own = frame.vector(spin), np.asarray(quaternion.inverse_rotate(rotations, frame.vector(spin)))
            start[part] = {"velocity": np.cross(about, places - frame.shift), "angular_velocity": own}
    run = cy.simulate(model, STEPS * STEP, STEP, rule=rule, initial=start, save_every=STEPS * STEP)
    return run.frames.values[-1, :, 4:], run.frames.values[-1, :, :4]


@LAW
@given(drawn=assemblies(), turn=turns(), shift=shifts())
@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint, rules.galerkin(time=2)], ids=str)
def test_no_frame_is_preferred(rule, drawn, turn, shift):
    x, p = motion(drawn, Frame(*HERE), rule)
    y, q = motion(drawn, Frame(turn, shift), rule)
    scale = 1.0 + np.abs(shift).max()
    np.testing.assert_allclose(y, shift + quaternion.rotate(turn, x), rtol=0, atol=1e-9 * scale)
    turned = np.asarray(quaternion.multiply(turn, p))
    np.testing.assert_allclose(np.abs(np.sum(turned * q, axis=1)), 1.0, rtol=0, atol=1e-9 * scale)
