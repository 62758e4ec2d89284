"""The scene of a run holds what the run says."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cayley.lie import quaternion
from cayley.model import Body, Material, Model, Rod, Section, loads
from cayley.report import stage
from cayley.report.scene import Block, Graph, Scene
from cayley.report.stage import node_outlines, scene, upward

RUBBER = Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.4)


def test_parts(crane):
    mast, boom, weight = scene(crane).parts
    assert_array_equal(mast.position, crane["mast"].position.values)
    assert_array_equal(boom.quantities["moment"].values, crane["boom"].moment.values)
    assert_allclose(boom.quantities["speed"].values, np.linalg.norm(crane["boom"].velocity, axis=-1))
    curvature = crane["mast"].curvature.values
    assert_allclose(mast.quantities["curvature"].values[:, 3], 0.5 * (curvature[:, 2] + curvature[:, 3]))
    assert_array_equal(weight.position[:, 0], crane["weight"].position.values)


def test_kinetic_energy_along_the_rods_adds_up(crane):
    shown = scene(crane)
    total = crane["weight"].kinetic_energy.values.copy()
    for rod in shown.parts[:2]:
        share = np.diff(np.concatenate([rod.s[:1], 0.5 * (rod.s[1:] + rod.s[:-1]), rod.s[-1:]]))
        total += rod.quantities["kinetic"].values @ share
    assert_allclose(total, crane.kinetic_energy.values, rtol=1e-9, atol=1e-12)


def test_marks_and_links(crane):
    shown = scene(crane)
    assert [(mark.kind, mark.place.part, mark.place.node) for mark in shown.marks] == [
        ("support", 0, 0),
        ("joint", 0, 6),
        ("joint", 1, 6),
    ]
    assert (shown.links[0].first.part, shown.links[0].first.node) == (1, 3)
    assert [graph.title for graph in shown.graphs][-1] == "Energy balance"
    assert shown.shade == pytest.approx((0.0, 0.2), abs=0.03)


def test_the_box_of_a_body_is_turned_as_its_inertia():
    body = Body(mass=1.0, inertia=[[2.0, 0.3, 0.1], [0.3, 2.2, 0.2], [0.1, 0.2, 1.5]])
    sides, axes = stage.box_sides(body)
    data = {
        name: _Series(np.zeros((1, width)))
        for name, width in (("position", 3), ("rotation", 4), ("velocity", 3), ("angular_velocity", 3))
    }
    block = stage._block(body, "b", data)
    turned = np.stack([quaternion.rotate(block.turn, e) for e in np.eye(3)], axis=1)
    assert_allclose(np.abs(np.sum(turned * axes, axis=0)), 1.0, atol=1e-12)
    assert_array_equal(block.sides, sides)


class _Series:
    def __init__(self, values):
        self.values = values


def test_outlines():
    """One for all, one for each node of a taper, and means at steps; at inner nodes of an element too."""
    plain = Rod(Section.circle(0.1, RUBBER), length=1.0, elements=2)
    assert node_outlines(plain).shape[0] == 1
    taper = Rod(lambda s: Section.rectangle(0.1 + s, 0.1, RUBBER), length=1.0, elements=2)
    assert_allclose(node_outlines(taper)[:, :, 0].max(axis=1), [0.05, 0.3, 0.55], rtol=1e-12)
    assert_allclose(node_outlines(taper, 2)[:, :, 0].max(axis=1), [0.05, 0.175, 0.3, 0.425, 0.55], rtol=1e-12)
    steps = Rod([Section.rectangle(w, 0.1, RUBBER) for w in (0.2, 0.4)], length=1.0, elements=2)
    assert_allclose(node_outlines(steps)[:, :, 0].max(axis=1), [0.1, 0.15, 0.2], rtol=1e-12)


@pytest.mark.parametrize(
    ("gravity", "up"),
    [((0, 0, -9.81), (0, 0, 1)), ((0, 9.81, 0), (0, -1, 0)), ((0, 0, 0), (0, 0, 1)), ((-3, 0, 1), (1, 0, 0))],
)
def test_up_is_against_gravity(gravity, up):
    rod = Rod(Section.circle(0.1, RUBBER), length=1.0, elements=2)
    assert upward(Model(rod, loads=[loads.gravity(gravity)])) == up


def test_long_runs_are_thinned(crane, monkeypatch):
    monkeypatch.setattr(stage, "BYTES", 20_000)
    shown = scene(crane)
    assert 1 < len(shown.time) < 51
    assert "saved frames is shown" in shown.note
    assert_array_equal(shown.graphs[0].values[:, 2], crane.energy.values[:: round(51 / len(shown.time))])


def test_arrays_that_do_not_fit_are_refused():
    time = np.arange(3.0)
    with pytest.raises(ValueError, match=r"rotation of a has shape \(2, 1, 4\), but must have \(3, 1, 4\)"):
        Scene(name="", time=time, parts=(Block(name="a", position=np.zeros((3, 1, 3)), rotation=np.zeros((2, 1, 4))),))
    with pytest.raises(ValueError, match=r"E has shape \(3, 1\), but must have \(3, 2\)"):
        Scene(
            name="",
            time=time,
            parts=(),
            graphs=(Graph(title="E", unit="J", names=("a", "b"), values=np.zeros((3, 1))),),
        )
