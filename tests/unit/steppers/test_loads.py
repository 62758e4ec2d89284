"""Loads in space and body frame: what they add to the momenta, exactly, and when they act."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads
from cayley.lie import quaternion
from unit.system.rods import round_rod

H, STEPS = 2e-5, 100
FORCE, MOMENT = np.array([0.3, -0.2, 0.5]), np.array([0.02, 0.03, -0.01])


def simulate(acting, *, rotation="quaternion", rule=cy.rules.verlet, every=1):
    """A free, tumbling rod, saved at every step."""
    rod = round_rod(4, name="rod", direction=(1, 2, -1))
    model = cy.Model(rod, loads=[load(rod) for load in acting])
    start = {"rod": {"velocity": lambda s: (1.0, -2.0, s), "angular_velocity": (0.0, 30.0, -20.0)}}
    return cy.simulate(model, STEPS * H, H, save_every=every * H, initial=start, rotation=rotation, rule=rule)


def impulses(run, vector, *, node, frame):
    """What steps hand over at a node: Σ weight × vector in space, and its moment about the origin."""
    data = run["rod"].isel(node=node)
    given = np.broadcast_to(vector, (STEPS + 1, 3))
    space = quaternion.rotate(data.rotation.values, given) if frame == "body" else given
    weights = np.full(STEPS + 1, H)
    weights[[0, -1]] *= 0.5
    return weights @ space, weights @ np.cross(data.position.values, space)


def gained(run) -> tuple[np.ndarray, np.ndarray]:
    linear, angular = run.linear_momentum.values, run.angular_momentum.values
    return linear[-1] - linear[0], angular[-1] - angular[0]


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)
@pytest.mark.parametrize("frame", ["space", "body"])
@pytest.mark.parametrize("node", [0, 3, -1])
def test_force(node, frame, rule, rotation):
    run = simulate([lambda rod: loads.force(rod.node(node % 5), FORCE, frame=frame)], rotation=rotation, rule=rule)
    linear, angular = impulses(run, FORCE, node=node, frame=frame)
    assert_allclose(gained(run)[0], linear, atol=1e-13)
    assert_allclose(gained(run)[1], angular, atol=1e-13)
    assert np.abs(linear).max() > 1e-4


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)
@pytest.mark.parametrize("frame", ["space", "body"])
def test_moment(frame, rule, rotation):
    run = simulate([lambda rod: loads.moment(rod.node(1), MOMENT, frame=frame)], rotation=rotation, rule=rule)
    angular, _ = impulses(run, MOMENT, node=1, frame=frame)
    assert_allclose(gained(run)[0], 0.0, atol=1e-13)
    assert_allclose(gained(run)[1], angular, atol=1e-13)


@pytest.mark.parametrize("frame", ["space", "body"])
def test_line_loads(frame):
    """Nodes take their part of the length, the ends half of it."""
    acting = [
        lambda rod: loads.line_force(rod, FORCE, frame=frame),
        lambda rod: loads.line_moment(rod, MOMENT, frame=frame),
    ]
    run = simulate(acting)
    linear, angular = np.zeros(3), np.zeros(3)
    for node, weight in enumerate((0.125, 0.25, 0.25, 0.25, 0.125)):
        force, moment = impulses(run, weight * FORCE, node=node, frame=frame)
        linear, angular = linear + force, angular + moment
        angular = angular + impulses(run, weight * MOMENT, node=node, frame=frame)[0]
    assert_allclose(gained(run)[0], linear, atol=1e-13)
    assert_allclose(gained(run)[1], angular, atol=1e-13)


def test_frames_differ():
    """The body turns by a few degrees, so the two frames must not give the same."""
    found = [
        gained(simulate([lambda rod, frame=frame: loads.force(rod.end, FORCE, frame=frame)]))[0]
        for frame in ("space", "body")
    ]
    assert np.abs(found[0] - found[1]).max() > 1e-5


def test_function_of_time():
    """Trapezoid sums of the function at the steps; one that branches is taken as well as one that is traced."""
    linear = {}
    for name, value in {
        "traced": lambda t: FORCE * np.sin(2e3 * t),
        "branching": lambda t: FORCE * np.sin(2e3 * t) if t >= 0.0 else FORCE,
    }.items():
        linear[name], _ = gained(simulate([lambda rod, value=value: loads.force(rod.end, value)], every=10))
    times = H * np.arange(STEPS + 1)
    expected = FORCE * np.trapezoid(np.sin(2e3 * times), times)
    assert_allclose(linear["traced"], expected, atol=1e-15)
    assert_allclose(linear["branching"], expected, atol=1e-15)


@pytest.mark.parametrize(("start", "until"), [(0.0, 7.3), (3.2, 3.9), (10.0, 20.0), (11.5, 60.25), (2.0, 1e9)])
@pytest.mark.parametrize("every", [1, 25])
def test_window(start, until, every):
    """A constant force between two times gives its impulse to the last bit, wherever steps and saves fall."""
    force = [lambda rod: loads.force(rod.end, FORCE, start=start * H, until=until * H)]
    linear, _ = gained(simulate(force, every=every))
    assert_allclose(linear, FORCE * (min(until, STEPS) - start) * H, atol=1e-15)


def test_loads_add_up():
    def one(rod):
        return loads.force(rod.end, FORCE)

    def other(rod):
        return loads.force(rod.end, -FORCE, frame="space")

    run = simulate([one, other])
    free = simulate([])
    assert_allclose(run["rod"].position.values, free["rod"].position.values, atol=1e-15)
    assert_allclose(gained(run)[0], 0.0, atol=1e-15)
