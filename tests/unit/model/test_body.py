"""Bodies, point masses and ports."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cayley.lie import quaternion
from cayley.model import Body, Part, PointMass, Port, ground
from cayley.model.port import Ground

TURN = quaternion.from_rotation_vector([0.3, -0.2, 0.9])
SHIFT = (0.1, -0.2, 0.3)


def make(**changed) -> Body:
    given = {"mass": 2.0, "inertia": [0.01, 0.02, 0.025], "position": (1, 0, 2), "rotation": TURN, "name": "bob"}
    return Body(**(given | changed))


def test_values():
    body = make(ports={"eye": SHIFT, "foot": (SHIFT, quaternion.to_matrix(TURN))})
    assert isinstance(body, Part)
    assert_array_equal(body.inertia, np.diag([0.01, 0.02, 0.025]))
    assert body.position == (1.0, 0.0, 2.0)
    assert body.ports["eye"] == (SHIFT, (1.0, 0.0, 0.0, 0.0))
    assert_allclose(body.ports["foot"][1], TURN, atol=1e-15)
    assert repr(body) == "Body(name='bob', mass=2, ports=['eye', 'foot'])"
    assert body.node_count == 1
    with pytest.raises(ValueError, match="read-only"):
        body.inertia[0, 0] = 1.0
    assert make() != make()


def test_ports():
    """P = x + Λ(p) shift, F = p turn; a port of a port adds up."""
    body = make(ports={"eye": SHIFT, "foot": (SHIFT, TURN)})
    eye, foot = body.port("eye"), body.port("foot")
    assert (str(eye), str(body.centre)) == ("bob.eye", "bob.centre")
    position, frame = eye.place
    assert_allclose(position, np.array(body.position) + quaternion.rotate(TURN, SHIFT), atol=1e-15)
    assert_allclose(frame, TURN)
    assert_allclose(foot.place[1], quaternion.multiply(TURN, TURN), atol=1e-15)
    further = foot.offset((0, 0, 1.0), TURN)
    assert_allclose(further.place[0], foot.place[0] + quaternion.rotate(foot.place[1], (0, 0, 1.0)), atol=1e-15)
    assert_allclose(further.place[1], quaternion.multiply(foot.place[1], TURN), atol=1e-15)
    assert further.name == ""
    assert body.port("centre") == body.centre == Port(body, 0) == Port(body, -1)
    assert not eye.at_node
    assert body.centre.at_node


def test_ground():
    assert str(ground) == "ground"
    assert ground.at((0, 1, 2)) == Ground((0.0, 1.0, 2.0))
    assert str(ground.at((0, 1, 2))) == "ground (0, 1, 2)"


def test_point_mass():
    point = PointMass(mass=3, position=(0, 1, 0), name="weight")
    assert str(point.centre) == "weight.centre"
    assert_array_equal(point.place(0)[0], [0.0, 1.0, 0.0])
    assert_array_equal(point.place(0)[1], [1.0, 0.0, 0.0, 0.0])
    assert repr(point) == "PointMass(name='weight', mass=3)"


QUATERNION = "a unit quaternion (w, x, y, z) or a 3 x 3 rotation matrix"


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (lambda: make(mass=0), ValueError, "Body 'bob': mass = 0 must be a positive, finite number [kg]"),
        (
            lambda: make(inertia=[1.0, 0.0, 1.0]),
            ValueError,
            "Body 'bob': inertia[1, 1] = 0, but inertia must be a symmetric, positive definite 3 x 3 matrix (about e1, "
            "e2, e3 [kg m^2])",
        ),
        (lambda: make(rotation=(1, 1, 0, 0)), ValueError, f"Body 'bob': rotation = (1, 1, 0, 0) must be {QUATERNION}"),
        (lambda: make(rotation=-np.eye(3)), ValueError, None),
        (
            lambda: make(position=(1, 2)),
            ValueError,
            "Body 'bob': position = (1, 2) must be 3 finite numbers (x, y, z) [m]",
        ),
        (
            lambda: make(ports={"the eye": SHIFT}),
            ValueError,
            "Body 'bob': name of a port = 'the eye' must be a name of letters, digits and \"_\", other than \"centre\"",
        ),
        (
            lambda: make(ports=[SHIFT]),
            TypeError,
            "Body 'bob': ports = [(0.1, -0.2, 0.3)] must be a dictionary such as {\"eye\": (0, 0, 0.3)}",
        ),
        (
            lambda: make(ports={"eye": SHIFT}).port("ear"),
            ValueError,
            "Body 'bob': port = 'ear' must be one of centre, eye",
        ),
        (lambda: make(name="a/b"), ValueError, "Body: name = 'a/b' must be a text without \"/\""),
        (lambda: make(name=3), TypeError, 'Body: name = 3 must be a text without "/"'),
        (lambda: PointMass(mass=-1.0), ValueError, "PointMass: mass = -1.0 must be a positive, finite number [kg]"),
        (lambda: Port(make(), 1), ValueError, "Body 'bob': node = 1 must be from 0 to 0, or from -1 back to -1"),
        (lambda: make().centre.offset((1, 2)), ValueError, None),
    ],
)
def test_refusals(call, error, line):
    with pytest.raises(error) as caught:
        call()
    assert "\n" not in str(caught.value)
    if line is not None:
        assert str(caught.value) == line
