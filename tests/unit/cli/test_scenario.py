"""Scenario files that are right: what model and what run they give."""

import math

import numpy as np
import pytest

from cayley.cli.scenario import load, parse, shipped
from cayley.discrete import rules

REST = """
[section.wire]
shape = "circle"
radius = 0.001
material = "rubber"
shear_correction = 0.9

[section.pipe]
shape = "tube"
outer_radius = 0.02
thickness = 0.002
material = "rubber"

[section.known]
shape = "given"
stiffness = [1e5, 2e5, 3e5, 10, 20, 30]
mass_per_length = 2
inertia = [[1e-3, 0, 0], [0, 2e-3, 0], [0, 0, 3e-3]]

[[rod]]
name = "mast.2"
section = "known"
length = 2
elements = 3
origin = [0, 1, 2]

[[support]]
kind = "clamp"
at = "mast.2.end"

[[support]]
kind = "hold"
at = "mast.2.node 1"
position = "xz"
rotation = "z"

[[load]]
kind = "force"
at = "mast.2.node(-3)"
value = [0, "t", 1]
start = 0.005

[[load]]
kind = "line_force"
rod = "beam"
value = [0, 0, 1]
until = inf

[[load]]
kind = "line_moment"
rod = "beam"
value = [0, 0, "2*t"]

[[initial]]
rod = "beam"
velocity = [0, 1, 0]
angular_momentum = [0, 0, 1e-3]
"""


def parsed(text):
    return parse(text, name="some", file="some.toml")


def test_the_papers_scenario():
    scenario = load("leitz2014")
    model, options = scenario.model(), scenario.options()
    (rod,) = model.rods
    assert (rod.length, rod.elements, rod.direction, rod.normal) == (2.0, 11, (0.0, 0.0, -1.0), (1.0, 0.0, 0.0))
    shear, shear2, axial, bend, bend2, twist = np.diag(rod.section.stiffness)
    modulus = 5e6 / 2.7  # no shear correction, and the polar moment for torsion
    expected = (modulus * 1e-4, modulus * 1e-4, 5e6 * 1e-4, 5e6 * 1e-8 / 12, 5e6 * 1e-8 / 12, modulus * 1e-8 / 6)
    assert (shear, shear2, axial, bend, bend2, twist) == pytest.approx(expected)
    gravity, torque = model.loads
    assert gravity.acceleration == (0.0, 0.0, -9.81)
    assert (torque.kind, torque.frame, torque.start, torque.until) == ("moment", "body", 0.0, 2.0)
    value = 1.5 * math.sin(0.4 * math.pi)
    expected = (value * math.cos(0.2 * math.pi), value * math.sin(0.2 * math.pi), 0.0)
    assert torque.value(0.8) == pytest.approx(expected)
    assert [support.kind for support in model.supports] == ["pin"]
    assert (options["t_end"], options["dt"], options["save_every"]) == (10.0, 1e-4, 0.01)
    assert options["rule"] is rules.nodal
    assert scenario.tables.notes.title == "What the paper leaves open, and what we found"
    assert any("1.34e-4" in text for text in scenario.tables.notes.paragraphs)
    assert any("368" in text for text in scenario.tables.notes.paragraphs)


@pytest.mark.parametrize("name", shipped())
def test_shipped_scenarios_are_right(name):
    scenario = load(name)
    assert scenario.name == name
    assert scenario.title
    assert scenario.model().rods


def test_what_is_left_out(small):
    scenario = parsed(small.replace('rule = "nodal"\nsave_every = 0.001', "").replace('title = "A small one"', ""))
    options = scenario.options()
    assert scenario.title == "some"
    assert options == {
        "t_end": 0.02,
        "dt": None,
        "rule": rules.verlet,
        "save_every": pytest.approx(0.02 / 500),
        "initial": {},
        "rotation": "quaternion",
        "allow_unstable": False,
    }


def test_all_kinds(small):
    scenario = parsed(small + REST)
    model = scenario.model()
    assert model.names == ("beam", "mast.2")
    mast = model.rods[1]
    np.testing.assert_array_equal(np.diag(mast.section.stiffness), [1e5, 2e5, 3e5, 10, 20, 30])
    assert [(s.kind, s.port.node) for s in model.supports[1:]] == [("clamp", 3), ("hold position xz, rotation z", 1)]
    force, line_force, line_moment = model.loads[2:]
    assert (force.kind, force.port.node, force.start, force.until) == ("force", 1, 0.005, math.inf)
    assert force.value(2.0).tolist() == [0.0, 2.0, 1.0]
    assert line_force.value == (0.0, 0.0, 1.0)  # numbers alone stay a constant
    assert line_moment.value(3.0).tolist() == [0.0, 0.0, 6.0]
    assert scenario.options()["initial"] == {"beam": {"velocity": [0, 1, 0], "angular_momentum": [0, 0, 1e-3]}}
