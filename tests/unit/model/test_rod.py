"""Nodes, frames and ports of a rod, and refusals."""

import copy
import math
import pickle

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from cayley.model import Material, Port, Rod, Section

SECTION = Section.circle(0.01, Material(density=1000.0, youngs_modulus=5e6, poisson_ratio=0.35))
COMPONENT = st.floats(-1.0, 1.0)
VECTOR = st.tuples(COMPONENT, COMPONENT, COMPONENT).filter(lambda v: math.hypot(*v) > 1e-3)


def make(**changes):
    return Rod(SECTION, **({"length": 2.0, "elements": 4} | changes))


def test_nodes():
    rod = make(origin=(1, 2, 3), direction=(0, 0, -5))
    assert rod.element_length == 0.5
    assert rod.nodes.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert rod.positions.tolist() == [[1, 2, 3], [1, 2, 2.5], [1, 2, 2], [1, 2, 1.5], [1, 2, 1]]
    assert rod.direction == (0.0, 0.0, -1.0)
    assert rod.mass == 2.0 * SECTION.mass_per_length


def turned(p, v):
    """Λ(p) v by the formula v + 2 r × (r × v + w v)."""
    w, r = p[0], p[1:]
    return v + 2 * np.cross(r, np.cross(r, v) + w * v)


def test_frame_of_the_paper():
    rod = make(direction=(0, 0, -1), normal=(1, 0, 0))
    assert rod.rotation.tolist() == [0.0, 1.0, 0.0, 0.0]
    assert rod.frame().tolist() == np.diag([1.0, -1.0, -1.0]).tolist()


@pytest.mark.parametrize(
    ("direction", "rotation"),
    [
        ((0, 0, 1), (1, 0, 0, 0)),
        ((0, 0, -1), (0, 1, 0, 0)),
        ((math.sin(math.pi), 0, math.cos(math.pi)), (0, 1, 0, 0)),  # -e3 but for round-off
        ((1, 0, 0), (math.sqrt(0.5), 0, math.sqrt(0.5), 0)),
        ((0, 1, 0), (math.sqrt(0.5), -math.sqrt(0.5), 0, 0)),
        ((1e-8, 0, -1), (0.5e-8, 0, 1, 0)),
    ],
)
def test_frame_without_a_normal(direction, rotation):
    np.testing.assert_allclose(make(direction=direction).rotation, rotation, atol=1e-15)


@settings(deadline=None)  # other work on the machine is no failure
@given(direction=VECTOR)
def test_smallest_rotation_turns_about_an_axis_across_both(direction):
    rod = make(direction=direction)
    assert np.linalg.norm(rod.rotation) == pytest.approx(1.0, abs=1e-15)
    assert rod.rotation[3] == 0.0
    assert rod.rotation[0] >= 0.0
    np.testing.assert_allclose(turned(rod.rotation, np.array([0.0, 0.0, 1.0])), rod.direction, atol=5e-15)


@settings(deadline=None)
@given(direction=VECTOR, normal=VECTOR)
def test_frame_with_a_normal(direction, normal):
    across = np.cross(np.cross(direction, normal), direction)
    assume(np.linalg.norm(across) > 1e-4)
    rod = make(direction=direction, normal=normal)
    d1, d2, d3 = rod.frame().T
    np.testing.assert_allclose(d3, direction / np.linalg.norm(direction), atol=5e-15)
    np.testing.assert_allclose(d1, across / np.linalg.norm(across), atol=1e-9)
    np.testing.assert_allclose(d2, np.cross(d3, d1), atol=5e-15)
    for axis, image in zip(np.eye(3), (d1, d2, d3), strict=True):
        np.testing.assert_allclose(turned(rod.rotation, axis), image, atol=5e-15)


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1e160, 1e300])
def test_direction_of_any_length(size):
    np.testing.assert_allclose(make(direction=(3 * size, 0, 4 * size)).direction, (0.6, 0.0, 0.8), atol=1e-15)


def test_ports():
    rod = make(name="mast")
    assert rod.start == Port(rod, 0) == rod.node(0) == rod.at(0.0) == rod.node(-5)
    assert rod.end == Port(rod, 4) == rod.node(-1) == rod.at(2.0) == rod.at(2.0 + 1e-12)
    assert rod.at(1.5).node == rod.node(np.int64(3)).node == 3
    assert [str(rod.node(k)) for k in (0, 1, 4)] == ["mast.start", "mast.node(1)", "mast.end"]
    assert str(make().end) == "rod.end"
    assert rod.start.called("boom") == "boom.start"


def test_every_node_is_found_by_its_arc_length():
    rod = make(length=0.3, elements=997)
    assert [rod.at(s).node for s in rod.nodes] == list(range(998))


def test_identity_not_equality():
    rod, twin = make(), make()
    assert rod != twin
    assert len({rod, twin}) == 2
    assert rod.start != twin.start


def test_copies_keep_ports_and_rods_together():
    rod = make()
    for again, port in (copy.deepcopy((rod, rod.end)), pickle.loads(pickle.dumps((rod, rod.end)))):
        assert port == again.end
        assert again.rotation.tolist() == rod.rotation.tolist()


def test_frozen():
    with pytest.raises(AttributeError):
        make().length = 3.0


def test_repr_is_one_line():
    rod = make(name="mast")
    assert repr(rod) == "Rod(name='mast', length=2, elements=4, section='circle of radius 0.01 m')"
    assert repr(make()) == "Rod(length=2, elements=4, section='circle of radius 0.01 m')"


@pytest.mark.parametrize(
    ("changes", "error", "line"),
    [
        ({"length": -2.0}, ValueError, "Rod: length = -2.0 must be a positive, finite number [m]"),
        ({"length": math.nan}, ValueError, "Rod: length = nan must be a positive, finite number [m]"),
        (
            {"length": -2.0, "name": "mast"},
            ValueError,
            "Rod 'mast': length = -2.0 must be a positive, finite number [m]",
        ),
        ({"elements": 0}, ValueError, "Rod: elements = 0 must be a whole number, at least 1"),
        ({"elements": 4.0}, TypeError, "Rod: elements = 4.0 must be a whole number, at least 1"),
        ({"elements": True}, TypeError, "Rod: elements = True must be a whole number, at least 1"),
        (
            {"direction": (0, 0, 0)},
            ValueError,
            "Rod: direction = (0, 0, 0) must be a vector other than zero (it need not have length 1)",
        ),
        (
            {"direction": (0, 0)},
            ValueError,
            "Rod: direction = (0, 0) must be 3 finite numbers (x, y, z) [-]",
        ),
        (
            {"direction": "z"},
            TypeError,
            "Rod: direction = 'z' must be 3 finite numbers (x, y, z) [-]",
        ),
        (
            {"origin": (0, math.nan, 0)},
            ValueError,
            "Rod: origin = (0, nan, 0) must be 3 finite numbers (x, y, z) [m]",
        ),
        (
            {"normal": (0, 0, -3)},
            ValueError,
            "Rod: normal = (0, 0, -3) must be at an angle to direction = (0.0, 0.0, 1.0), but is parallel to it",
        ),
        (
            {"normal": (0, 0, 0)},
            ValueError,
            "Rod: normal = (0, 0, 0) must be a vector other than zero (it need not have length 1)",
        ),
        ({"name": "a/b"}, ValueError, "Rod: name = 'a/b' must be a text without \"/\""),
        ({"name": 3}, TypeError, 'Rod: name = 3 must be a text without "/"'),
    ],
)
def test_refusals(refused, changes, error, line):
    refused(lambda: make(**changes), error, line)


def test_section_refused(refused):
    refused(
        lambda: Rod(0.1, length=1.0, elements=1),
        TypeError,
        "Rod: section = 0.1 must be a Section, one for each element, or a function of s that returns one",
    )


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (lambda rod: rod.node(5), ValueError, "Rod: node = 5 must be from 0 to 4, or from -1 back to -5"),
        (lambda rod: rod.node(-6), ValueError, "Rod: node = -6 must be from 0 to 4, or from -1 back to -5"),
        (
            lambda rod: rod.node(1.0),
            TypeError,
            "Rod: node = 1.0 must be a whole number from 0 to 4, or from -1 back to -5",
        ),
        (lambda rod: rod.at(0.6), ValueError, "Rod: s = 0.6 must be at a node, such as 0.5 m (node 1) or 1 m (node 2)"),
        (lambda rod: rod.at(2.1), ValueError, "Rod: s = 2.1 must be at a node, such as 1.5 m (node 3) or 2 m (node 4)"),
        (lambda rod: rod.at(-1), ValueError, "Rod: s = -1 must be at a node, such as 0 m (node 0) or 0.5 m (node 1)"),
        (lambda rod: rod.at(math.nan), ValueError, "Rod: s = nan must be a finite number [m]"),
        (lambda rod: Port(SECTION, 0), TypeError, f"Port: part = {SECTION!r} must be a Rod or a Body"),
    ],
)
def test_port_refusals(refused, call, error, line):
    refused(lambda: call(make()), error, line)
