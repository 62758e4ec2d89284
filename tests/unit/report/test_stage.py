"""The scene of a run holds what the run says."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cayley as cy
from cayley import joints, springs
from cayley.lie import quaternion
from cayley.model import Body, Material, Model, Rod, Section, loads, supports
from cayley.report import stage, write_report
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


def test_fields_of_a_lagrangian_of_ones_own_stand_in_space():
    """Vectors of three are points with the rotations as their frames, other fields are plotted."""

    @cy.lagrangian(a=cy.Vector(3), b=cy.Vector(3), p=cy.Rotation(), u=cy.Vector(2))
    def pieces(q, c):
        return 0.5 * sum(cy.dot(v, v) for v in (q.a_t, q.b_t, q.p_t, q.u_t))

    system = cy.compile(pieces, rule=cy.rules.verlet)
    start = {"a": (1, 0, 0), "a_t": (0, 2, 0), "b": (0, 1, 0), "u": (0.5, 0.25), "u_t": (1, 0), "p_t": (0, 0, 3)}
    run = cy.integrate(system, start, t_end=1.0, dt=0.1, save_every=0.1)
    shown = scene(run)
    first, second = shown.parts
    assert (first.name, second.name) == ("a, p", "b")
    assert_allclose(first.position[-1, 0], [1, 2, 0], atol=1e-12)
    assert_array_equal(first.rotation[:, 0], run.data.p.values)
    assert_allclose(first.quantities["spin"].values, 3.0)
    assert_allclose(second.position[:, 0], [[0, 1, 0]] * 11, atol=1e-15)
    plotted = next(graph for graph in shown.graphs if graph.title == "Field u")
    assert plotted.names == ("u_1", "u_2")
    assert_allclose(plotted.values[-1], [1.5, 0.25])


def test_fields_on_an_interval():
    """A curve, a rotation without a place along e3, and a number at both ends and in the middle."""

    @cy.lagrangian(w=cy.Vector(3), s=cy.Interval)
    def thread(q, c):
        return 0.5 * cy.dot(q.w_t, q.w_t) - 0.5 * cy.dot(q.w_s, q.w_s)

    @cy.lagrangian(p=cy.Rotation(), u=cy.Vector(1), s=cy.Interval)
    def bar(q, c):
        return 0.5 * cy.dot(q.p_t, q.p_t) - 0.5 * cy.dot(q.p_s, q.p_s) + 0.5 * q.u_t[0] ** 2 - 0.5 * q.u_s[0] ** 2

    domain, rule = cy.Interval(1.0, 3.0, elements=4), cy.rules.verlet
    nodes = np.linspace(1.0, 3.0, 5)
    run = cy.integrate(cy.compile(thread, rule=rule, domain=domain), {"w": np.outer(nodes, [0, 2, 0])}, t_end=0.1)
    (curve,) = scene(run).parts
    assert_array_equal(curve.position, run.data.w.values)
    assert_allclose(curve.s, nodes - 1.0)
    run = cy.integrate(cy.compile(bar, rule=rule, domain=domain), {"u": nodes[:, None] ** 2}, t_end=0.1)
    shown = scene(run)
    assert_allclose(shown.parts[0].position[0], np.outer(nodes, [0, 0, 1]))
    assert shown.graphs[1].names == ("u at s = 1", "u at s = 2", "u at s = 3")
    assert_array_equal(shown.graphs[1].values, run.data.u.values[:, [0, 2, 4], 0])


def test_only_what_was_saved_is_shown(tmp_path):
    section = Section.circle(0.02, RUBBER)
    mast = Rod(section, length=1.0, elements=4, name="mast")
    boom = Rod(section, length=1.0, elements=4, origin=(0, 0, 1), direction=(1, 0, 0), name="boom")
    model = Model(
        mast,
        boom,
        supports=[supports.clamp(mast.start)],
        joints=[joints.ball(mast.end, boom.start)],
        springs=[springs.linear(boom.node(2), mast.node(2), stiffness=60.0)],
    )
    options = {"t_end": 0.01, "store": tmp_path / "run.zarr", "save_only": [boom, mast.node(2)]}
    run = cy.simulate(model, save_every=5e-3, **options)
    shown = scene(run)
    assert [part.name for part in shown.parts] == ["boom", "mast.node(2)"]
    assert [(mark.kind, mark.place.part, mark.place.node) for mark in shown.marks] == [("joint", 0, 0)]
    assert not shown.links
    assert [graph.title for graph in shown.graphs] == ["Energy"]
    assert_array_equal(shown.parts[1].position[:, 0], run.port(mast.node(2)).position.values)
    text = write_report(run, tmp_path / "report.html").read_text(encoding="utf-8")
    assert "What was not saved (save_only) is not shown." in text
    assert "Stress resultants of boom over the time." in text
    assert "of mast over" not in text


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
