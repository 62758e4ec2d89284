"""Obstacles in the report: their surfaces, in the scene and the snapshots; shapes on bodies instead of boxes."""

import json

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from numpy.testing import assert_allclose

import cayley as cy
from cayley.lie import quaternion
from cayley.model.skins import skin
from cayley.report import figures
from cayley.report.conserved import load_free, preserved
from cayley.report.pack import described
from cayley.report.scene import Flat, Skin
from cayley.report.snapshots import Contents
from cayley.report.solids import drawn_edges
from cayley.report.stage import scene
from cayley.report.view import TOWARD, seen

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0


@pytest.fixture(scope="module")
def run():
    """A tumbling body with two shapes, a bare one beside it, a floor and a step."""
    hammer = cy.Body(mass=1.0, inertia=[0.02, 0.02, 0.01], position=(0, 0, 1), name="hammer")
    dice = cy.Body(mass=1.0, inertia=[0.02, 0.02, 0.02], position=(1, 0, 1), name="dice")
    shapes = [
        cy.Plane(name="floor"),
        cy.Box((0.3, 0.1, 0.1), center=(0, 0, 0.2), on=hammer, name="head"),
        cy.Capsule((0, 0, -0.2), (0, 0, 0.1), 0.02, on=hammer),
        cy.Box((0.5, 0.5, 0.2), center=(3, 0, 0.1), name="step"),
    ]
    model = cy.Model(hammer, dice, obstacles=shapes, contact=cy.Contact(friction=0.5))
    return cy.simulate(model, t_end=0.1, dt=1e-3, save_every=0.05, initial={hammer: {"angular_velocity": (3, 0, 9)}})


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (cy.Sphere(0.3, (1, 2, 3)), 4.0 / 3.0 * np.pi * 0.3**3),
        (cy.Cylinder(0.3, 2.0, (1, 2, 3), AXIS), np.pi * 0.3**2 * 2.0),
        (cy.Capsule((1, 2, 3), tuple(np.array([1, 2, 3]) + 2.0 * AXIS), 0.3), np.pi * 0.3**2 * (2.0 + 0.4)),
        (cy.Box((1, 2, 3)), 6.0),
    ],
    ids=lambda value: getattr(value, "kind", ""),
)
def test_skins_are_closed_and_as_large_as_their_shapes(shape, volume):
    mesh = skin(shape)
    assert mesh.closed
    assert mesh.volume == pytest.approx(volume, rel=0.015)
    if shape.kind == "cylinder":
        along = (mesh.vertices - np.array(shape.center)) @ AXIS
        assert_allclose(np.abs(along), 1.0)


def test_scene(run):
    shown = scene(run)
    floor, head, grip, step = shown.solids
    assert isinstance(floor, Flat)
    assert isinstance(head, Skin)
    assert [solid.part for solid in shown.solids] == [None, 0, 0, None]
    assert [solid.name for solid in shown.solids] == ["floor", "head", "capsule", "step"]
    assert [part.shaped for part in shown.parts] == [True, False]
    assert_allclose(head.vertices.mean(axis=0), [0, 0, 0.2], atol=1e-12)
    packed = json.loads(json.dumps(described(shown)))
    assert len(packed["solids"][2]["vertices"]) == 3 * len(grip.vertices)
    assert max(packed["solids"][3]["triangles"]) == len(step.vertices) - 1
    assert packed["solids"][0]["normal"] == [0.0, 0.0, 1.0]


def test_a_tank_is_seen_through():
    box = cy.Box((1, 1, 1)).mesh
    body = cy.Body(mass=1.0, inertia=[1, 1, 1])
    model = cy.Model(body, obstacles=[cy.Mesh(box.vertices, box.triangles[:, ::-1]), box])
    found = scene(cy.simulate(model.replace(contact=cy.Contact(allow_overlap=True)), 1e-3, dt=1e-3)).solids
    assert [solid.sheer for solid in found] == [True, False]


def test_edges_that_are_seen():
    """Of a box from a corner nine edges; of a ball its outline, twice its radius wide."""
    box, ball = cy.Box((1, 1, 1)).mesh, skin(cy.Sphere(0.5))
    assert len(drawn_edges(box, box.normals @ TOWARD > 0.0)) == 9
    edges = drawn_edges(ball, ball.normals @ TOWARD > 0.0)
    assert_allclose(np.linalg.norm(seen(ball.vertices[edges]), axis=-1), 0.5, rtol=0.02)


def test_snapshots(run):
    """The head turns with its body; the floor of the room is the plane, and its shape the room's."""
    shown = Contents.of(run, None, [0, len(run.time) - 1])
    head = shown.solids[1]
    place = run["hammer"].position.values[-1] + quaternion.rotate(run["hammer"].rotation.values[-1], (0, 0, 0.2))
    assert_allclose(head.points(1).mean(axis=0), place, atol=1e-12)
    assert [len(shape.edges[0]) for shape in shown.shapes] == [0, 12]
    room = shown.room()
    assert room.low[2] == 0.0
    assert 1.5 < room.high[0] < 3.3  # some of the step, which is far away
    panel = figures.snapshots(run, times=[0.0]).axes[0]
    filled = [c for c in panel.collections if isinstance(c, PolyCollection)]
    assert len(filled) == 4
    corners = filled[0].get_paths()[0].vertices[:4]
    wanted = [(x, y, 0.0) for x in (room.low[0], room.high[0]) for y in (room.low[1], room.high[1])]
    assert_allclose(sorted(map(tuple, corners)), sorted(map(tuple, seen(np.array(wanted)))), atol=1e-9)


def test_what_contact_leaves(run):
    """Obstacles in space take momentum, bodies that collide keep it; damped or rubbing contact takes energy."""
    model = run.model
    carried = model.replace(obstacles=[shape for shape in model.obstacles if shape.on is not None])
    smooth = cy.Contact(damping=0.0)
    assert not any(preserved(model)[0])
    assert all(preserved(carried)[0])
    for contact, free in ((model.contact, False), (cy.Contact(), False), (smooth, True)):
        told = model.replace(contact=contact)
        other = cy.Trajectory(frames=run.frames, info=run.info, outline=run.outline, observed=run.observed, model=told)
        assert load_free(other).free is free


def test_paraview_files(run, tmp_path):
    """Shapes on bodies as time series, those in space once; a plane as a square as large as the run."""
    meshio = pytest.importorskip("meshio")
    paths = cy.export(run, "vtk", tmp_path)
    names = ["obstacle_floor.vtu", "obstacle_head.pvd", "obstacle_capsule.pvd", "obstacle_step.vtu"]
    assert [path.name for path in paths[2:]] == names
    head = meshio.read(tmp_path / f"obstacle_head_{len(run.time) - 1:06}.vtu")
    place = run["hammer"].position.values[-1] + quaternion.rotate(run["hammer"].rotation.values[-1], (0, 0, 0.2))
    assert_allclose(head.points.mean(axis=0), place, atol=1e-12)
    floor = meshio.read(tmp_path / "obstacle_floor.vtu").points
    assert_allclose(floor[:, 2], 0.0, atol=1e-15)
    assert_allclose(floor[:, :2].mean(axis=0), [0.5, 0.0], atol=0.01)
