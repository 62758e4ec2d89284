"""Bodies, joints, guides, drives and springs in scenario files: the model they give, and one line for what is wrong."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import parse
from cayley.lie import quaternion
from cayley.results.record import model_from, model_record

TEXT = """
[material.steel]
density = 7850.0
youngs_modulus = 2e11
poisson_ratio = 0.3

[section.tube]
shape = "tube"
material = "steel"
outer_radius = 0.02
thickness = 0.002

[[rod]]
name = "mast"
section = "tube"
length = 2.0
elements = 4

[[rod]]
name = "arm"
section = "tube"
length = 1.0
elements = 3
origin = [0, 0, 2]
direction = [1, 0, 0]

[[body]]
name = "bob"
mass = 2.0
inertia = [0.01, 0.01, 0.02]
position = [1, 0, 1.7]

[body.ports]
eye = [0, 0, 0.3]
foot = {position = [0, 0, -0.1], rotation = [0, 1, 0, 0]}

[[body]]
name = "weight"
mass = 1.0
position = [0, 0, 3]

[[support]]
kind = "clamp"
at = "mast.start"

[[support]]
kind = "roll"
at = "bob.foot"
normal = [0, 1, 0]

[[support]]
kind = "drive"
at = "weight.centre"
position = [0, "0.1*sin(t)", 0]
name = "shaker"

[[joint]]
kind = "weld"
first = "mast.end"
second = "arm.start"

[[joint]]
kind = "hinge"
first = "arm.end"
second = "bob.eye"
axis = [0, 1, 0]
angle = "0.2*sin(t)"

[[joint]]
kind = "rigid_link"
first = "weight.centre"
second = "ground (0, 0, 4)"
displacement = {times = [0, 1, 2], values = [0, 0.1, 0], interpolation = "linear"}

[[spring]]
kind = "linear"
first = "bob.foot"
second = "mast.node 1 + (0, 0.1, 0)"
stiffness = 100.0
damping = 2.0

[[spring]]
kind = "bushing"
first = "arm.node 1"
stiffness = [1, 2, 3, 4, 5, 6]

[[load]]
kind = "force"
at = "bob.centre"
value = [0, 0.5, 0]
until = 0.1

[[initial]]
body = "bob"
angular_velocity = [1, 0, 0]

[run]
t_end = 1.0
"""


def test_model():
    scenario = parse(TEXT, name="ties", file="ties.toml")
    model = scenario.model()
    bob = model.bodies[0]
    assert str(model).splitlines()[6:] == [
        "  supports",
        "    clamp at mast.start",
        "    roller of bob.foot to ground, axis (0, 1, 0)",
        "    drive of weight.centre to ground, position: function (0, 0.1*sin(t), 0)",
        "  joints",
        "    weld of mast.end and arm.start",
        "    hinge of arm.end and bob.eye, axis (0, 1, 0), angle: function 0.2*sin(t)",
        "    link of weight.centre to ground (0, 0, 4), 1 m, displacement: table of 3 times, 0 s to 2 s, linear",
        "  springs",
        "    linear spring of bob.foot and mast.node(1) + (0, 0.1, 0), 100 N/m, 2 N s/m, unstressed at 1.48997 m",
        "    bushing spring of arm.node(1) and ground, K diagonal (1, 2, 3, 4, 5, 6)",
        "  loads",
        "    force on bob.centre: (0, 0.5, 0) N, space frame, 0 s <= t < 0.1 s",
    ]
    assert bob.ports["foot"] == ((0.0, 0.0, -0.1), (0.0, 1.0, 0.0, 0.0))
    assert scenario.initial() == {"bob": {"angular_velocity": [1.0, 0.0, 0.0]}}
    assert_allclose(model.joints[1].motion("angle", np.array([0.0, 0.5]))[:, 0], [0.0, 0.2 * np.sin(0.5)])
    assert_allclose(model.guides[1].motion("position", np.array([0.5])), [[0.0, 0.1 * np.sin(0.5), 0.0]])


def test_record():
    """All of it comes back from the record of a store, functions as what is given for them."""
    model = parse(TEXT, name="ties", file="ties.toml").model()
    record = model_record(model)
    known = {"hinge/angle": model.joints[1].angle, "shaker/position": model.guides[1].position}
    again = model_from(record, [None], known)
    assert str(again) == str(model)
    assert model_record(again) == record
    turned = cy.Model(*model.parts, joints=[cy.joints.ball(model.bodies[0].port("foot").offset((0, 0, 1)))])
    assert model_record(model_from(model_record(turned), [])) == model_record(turned)


def test_turned_port():
    text = TEXT.replace('second = "arm.start"', 'second = "arm.start + (0, 0, 0) turned (0, 0, 1, 0)"')
    port = parse(text, name="ties", file="ties.toml").model().joints[0].second
    assert_allclose(port.place[1], quaternion.multiply(port.part.place(0)[1], (0, 0, 1, 0)))


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            'first = "arm.end"',
            'first = "arm.tip"',
            'joint #2.first: is "arm.tip" (did you mean "arm.start"?); allowed: mast.start, mast.end, mast.node K, '
            "arm.start, arm.end, arm.node K, bob.centre, bob.eye, bob.foot, weight.centre",
        ),
        (
            'second = "bob.eye"',
            'second = "bob.eyes"',
            'joint #2.second: is "bob.eyes" (did you mean "bob.eye"?); allowed: ',
        ),
        ('"0.2*sin(t)"', '"0.2*sin(w*t)"', 'joint #2.angle: "0.2*sin(w*t)" uses the unknown name "w"; allowed: t, pi'),
        (
            '"0.2*sin(t)"',
            '"0.2*cos(t)"',
            "joint #2: angle is 0.2 rad at t = 0, but must be 0 there: it counts from the",
        ),
        ('"0.2*sin(t)"', "0.2", "joint #2.angle: is 0.2; allowed: an expression of the time in quotes"),
        (
            "times = [0, 1, 2], ",
            "",
            "joint #3: displacement has the keys values, interpolation; allowed: times, values and",
        ),
        ("times = [0, 1, 2]", "times = [0, 1, 1]", "joint #3: times = [0, 1, 1] must be at least two rising times [s]"),
        ("ground (0, 0, 4)", "ground (0, 0)", 'joint #3.second: has "(0, 0)"; allowed: 3 numbers in parentheses'),
        ("ground (0, 0, 4)", "ground (0, 0, 3)", "joint #3: length = 0.0 must be a positive, finite number [m]"),
        (
            "axis = [0, 1, 0]",
            "axes = [0, 1, 0]",
            'joint #2.axes: is no key (did you mean "axis"?); allowed: first, second',
        ),
        ('kind = "weld"', 'kind = "wield"', 'joint #1.kind: is "wield" (did you mean "weld"?); allowed: weld, ball'),
        ('name = "weight"', 'name = "arm"', 'body #2.name: is "arm" again; allowed: a name of its own'),
        ("mass = 1.0", "mass = -1.0", "body #2.mass: is -1.0; allowed: a positive number [kg]"),
        (
            "[0.01, 0.01, 0.02]",
            "[0.01, 0.01]",
            "body #1.inertia: is [0.01, 0.01]; allowed: three numbers, or 3 rows of 3",
        ),
        ('body = "bob"', 'body = "bobby"', 'initial #1.body: is "bobby" (did you mean "bob"?); allowed: bob, weight'),
        (
            'body = "bob"',
            "",
            "initial #1.rod: is missing; allowed: the name of a rod, or body or part with that of a body or part",
        ),
        (
            "origin = [0, 0, 2]",
            "origin = [0, 0, 3]",
            "Model: weld of mast.end and arm.start has a gap of 1 m at the start",
        ),
        ('at = "bob.foot"', 'at = "mast.node 7"', "support #2.at: node = 7 must be from 0 to 4, or from -1 back to -5"),
        ('"0.1*sin(t)"', '"0.1*sin(t"', 'support #3.position: "0.1*sin(t" is no expression; allowed: t, pi'),
        ("stiffness = 100.0", "stiffness = -1.0", "spring #1.stiffness: is -1.0; allowed: a number from 0 [N/m]"),
    ],
)
def test_problems(old, new, line):
    assert old in TEXT
    with pytest.raises(ScenarioError) as caught:
        parse(TEXT.replace(old, new), name="ties", file="ties.toml")
    assert caught.value.problems[0].startswith(f"ties.toml: {line}"), caught.value.problems
