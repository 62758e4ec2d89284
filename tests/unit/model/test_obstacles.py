"""Shapes that are touched: what they keep and refuse, and the topology of meshes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cayley.lie import quaternion
from cayley.model import Body, Box, Capsule, Cylinder, Mesh, Plane, PointMass, Sphere

TURN = quaternion.from_rotation_vector([0.3, -0.2, 0.9])
SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
ROOF = np.array([[0.0, 0, 0], [0, 1, 0], [-1, 0.5, -0.5], [1, 0.5, -0.5]])  # two triangles at the ridge 0-1


def test_values():
    body = Body(mass=1.0, inertia=[1, 1, 1], position=(1, 2, 3), name="drum")
    assert Plane(normal=(0, 0, 5)).normal == (0.0, 0.0, 1.0)
    assert Cylinder(0.1, 2, axis=(0, 3, 4)).axis == pytest.approx((0.0, 0.6, 0.8))
    assert Box((1, 2, 3), rotation=quaternion.to_matrix(TURN)).rotation == pytest.approx(tuple(TURN))
    ball = Sphere(0.5, (1, 0, 0), on=body, friction=1, name="ball")
    assert (ball.radius, ball.center, ball.friction) == (0.5, (1.0, 0.0, 0.0), 1.0)
    assert_array_equal(ball.place[0], [1.0, 2.0, 3.0])
    assert repr(ball) == "Sphere 'ball'(radius 0.5 m, center (1, 0, 0), on Body 'drum')"
    assert repr(Capsule((0, 0, 0), (0, 0, 1), 0.1)) == "Capsule(radius 0.1 m, from (0, 0, 0) to (0, 0, 1))"
    assert Sphere(1.0) != Sphere(1.0)
    with pytest.raises(AttributeError):
        ball.radius = 1.0


def test_a_box_as_a_mesh():
    """Closed, oriented outward: 12 edges stick out, 6 diagonals are flat, and each has one owner."""
    box = Box((1, 2, 3), center=(5, 0, 1), rotation=TURN, friction=0.2, name="block")
    mesh = box.mesh
    assert (mesh.friction, mesh.name, mesh.closed) == (0.2, "block", True)
    assert mesh.volume == pytest.approx(6.0)
    assert mesh.edges.shape == (18, 2)
    assert mesh.convex.all()
    assert mesh.flat.sum() == 6
    middle = mesh.vertices[mesh.triangles].mean(axis=1)
    assert (np.einsum("mk,mk->m", mesh.normals, middle - np.array(box.center)) > 0.4).all()
    assert_array_equal(np.bincount(mesh.triangle_edges[mesh.owns_edge], minlength=18), 1)
    assert_array_equal(np.bincount(mesh.triangles[mesh.owns_vertex], minlength=8), 1)
    ends = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2)
    assert_array_equal(np.sort(ends, axis=2), mesh.edges[mesh.triangle_edges])
    with pytest.raises(ValueError, match="read-only"):
        mesh.convex[0] = False


@pytest.mark.parametrize(("height", "convex"), [(-0.5, True), (0.0, True), (0.5, False)])
def test_valleys_have_no_owner(height, convex):
    """The ridge of a roof sticks out, a flat one counts as such, a gutter is a valley; the border sticks out."""
    points = ROOF.copy()
    points[2:, 2] = height
    mesh = Mesh(points, [[0, 1, 2], [1, 0, 3]])
    ridge = mesh.edges.tolist().index([0, 1])
    assert mesh.convex[ridge] == convex
    assert mesh.convex.sum() == 4 + convex
    assert mesh.flat.tolist() == [height == 0.0 and k == ridge for k in range(5)]
    assert (mesh.triangle_edges[mesh.owns_edge] == ridge).sum() == convex
    assert not mesh.closed
    assert mesh.normals[0, 2] > 0.5


def test_a_sheet_of_two_sides_has_sharp_edges():
    sheet = Mesh(SQUARE[:3], [[0, 1, 2], [2, 1, 0]])
    assert sheet.closed
    assert sheet.convex.all()
    assert not sheet.flat.any()


def test_turned_inside_out():
    box = Box((1, 1, 1)).mesh
    assert Mesh(box.vertices, box.triangles[:, ::-1]).volume == pytest.approx(-1.0)


@pytest.mark.parametrize("ending", ["stl", "obj"])
def test_files(tmp_path, ending):
    """What another program wrote: corners shared again, millimeters, turned and moved."""
    meshio = pytest.importorskip("meshio")
    box, path = Box((1, 2, 3)).mesh, tmp_path / f"box.{ending}"
    with np.errstate(invalid="ignore"):  # the normal of a triangle that has a corner twice
        meshio.write_points_cells(path, 1e3 * box.vertices, [("triangle", np.vstack([box.triangles, [[0, 0, 1]]]))])
    mesh = Mesh.read(path, name="block").placed(scale=1e-3, center=(1, 0, 0), rotation=TURN)
    assert (len(mesh.vertices), len(mesh.triangles), mesh.closed, mesh.name) == (8, 12, True, "block")
    assert mesh.volume == pytest.approx(6.0)
    assert_allclose(mesh.vertices.mean(axis=0), [1, 0, 0], atol=1e-9)
    assert_allclose(mesh.normals, quaternion.rotate(TURN, box.normals), atol=1e-6)


def test_broken_files(tmp_path):
    pytest.importorskip("meshio")
    path = tmp_path / "broken.stl"
    with pytest.raises(FileNotFoundError, match="there is no file"):
        Mesh.read(path)
    path.write_bytes(bytes(range(200)))
    with pytest.raises(ValueError, match="is no file of a mesh that can be read, such as STL"):
        Mesh.read(path)


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (lambda: Sphere(0), ValueError, "Sphere: radius = 0 must be a positive, finite number [m]"),
        (lambda: Capsule((0, 0, 1), (0, 0, 1), 0.1, name="pin"), ValueError, "start and end are both (0, 0, 1)"),
        (lambda: Cylinder(0.1, -1), ValueError, "Cylinder: length = -1 must be a positive, finite number [m]"),
        (lambda: Box((1, 0, 1)), ValueError, "Box: size = (1, 0, 1) must be 3 positive, finite numbers [m]"),
        (lambda: Plane(normal=(0, 0, 0)), ValueError, "Plane: normal = (0, 0, 0) must be a vector other than zero"),
        (lambda: Plane(friction=-0.1), ValueError, "Plane: friction = -0.1 must be a number from 0 [-], or None"),
        (lambda: Plane(on=PointMass(mass=1.0)), TypeError, "Plane: on = PointMass(mass=1) must be a Body, or None"),
        (lambda: Plane(name="a/b"), ValueError, "Plane: name = 'a/b' must be a text without \"/\""),
        (lambda: Mesh(SQUARE[:2], [[0, 1, 2]]), ValueError, "triangle 0 is (0, 1, 2), but vertices go from 0 to 1"),
        (lambda: Mesh(SQUARE, [[0.0, 1.0, 2.0]]), TypeError, "must be whole numbers, three vertices for each"),
        (lambda: Mesh(SQUARE, [[0, 1, 2], [0, 1]]), ValueError, "must be whole numbers, three vertices for each"),
        (lambda: Mesh(SQUARE, []), ValueError, "must be whole numbers, three vertices for each"),
        (lambda: Mesh(SQUARE * np.nan, [[0, 1, 2]]), ValueError, "must be positions (x, y, z), finite [m]"),
        (
            lambda: Mesh(SQUARE, [[0, 1, 2], [0, 1, 1]]),
            ValueError,
            "triangle 1 (0, 1, 1) has no area that is finite; leave it out",
        ),
        (lambda: Mesh(1e200 * SQUARE, [[0, 1, 2]]), ValueError, "triangle 0 (0, 1, 2) has no area that is finite"),
        (lambda: Box((1, 1, 1), rotation=(1e200, 0, 0, 0)), ValueError, "must be a unit quaternion (w, x, y, z)"),
        (
            lambda: Mesh(SQUARE, [[0, 1, 2], [0, 3, 2]], name="lid"),
            ValueError,
            "Mesh 'lid': triangles 0 and 1 run the same way along edge (0, 2); reverse one of them",
        ),
        (
            lambda: Mesh(np.vstack([SQUARE, [[0, 0, 1]]]), [[0, 1, 2], [0, 2, 3], [2, 0, 4]]),
            ValueError,
            "Mesh: edge (0, 2) is in triangles 0, 1, 2, but at most two may meet in an edge",
        ),
    ],
)
def test_refusals(call, error, line):
    with pytest.raises(error) as caught:
        call()
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)
