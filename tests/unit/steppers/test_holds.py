"""Held components stay as they are, exactly; the others move."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads, supports
from cayley.lie import cayley, quaternion
from unit.system.rods import round_rod

FORMS = ["quaternion", "matrix"]
RULES = [cy.rules.nodal, cy.rules.verlet]


def run(support, rotation, rule, **initial):
    """A rod under weight and moments with node 2 supported, saved at every step."""
    rod = round_rod(5, name="rod", direction=(1, 2, -1))
    acting = [
        loads.gravity((1.0, 2.0, -9.81)),
        loads.line_moment(rod, (0.1, 0.2, 0.05)),
        loads.force(rod.end, (1, 1, 1)),
    ]
    model = cy.Model(rod, supports=[support(rod)], loads=acting)
    start = {"rod": initial} if initial else None
    return cy.simulate(model, 1.6e-3, 2e-5, save_every=2e-5, rule=rule, rotation=rotation, initial=start)["rod"]


@pytest.mark.parametrize("rotation", FORMS)
@pytest.mark.parametrize("rule", RULES, ids=str)
@pytest.mark.parametrize("letters", ["x", "y", "z", "xz", "xyz"])
def test_positions_held_bit_for_bit(letters, rule, rotation):
    data = run(lambda rod: supports.hold(rod.node(2), position=letters), rotation, rule).isel(node=2)
    position, velocity = data.position.values, data.velocity.values
    for axis, letter in enumerate("xyz"):
        if letter in letters:
            assert np.array_equal(position[:, axis], np.full(len(position), position[0, axis]))
            assert not np.any(velocity[:, axis])
        else:
            assert abs(position[-1, axis] - position[0, axis]) > 1e-7


@pytest.mark.parametrize("rotation", FORMS)
@pytest.mark.parametrize("rule", RULES, ids=str)
def test_rotation_held_bit_for_bit(rule, rotation):
    data = run(lambda rod: supports.hold(rod.node(2), rotation="xyz"), rotation, rule).isel(node=2)
    assert np.array_equal(data.rotation.values, np.broadcast_to(data.rotation.values[0], data.rotation.shape))
    assert not np.any(data.angular_velocity.values)
    assert np.ptp(data.position.values, axis=0).min() > 1e-7


def increments(p: np.ndarray) -> np.ndarray:
    """Cayley vectors of the steps, in the body frame."""
    return cayley.cay_inv(quaternion.multiply(quaternion.conjugate(p[:-1]), p[1:]))


@pytest.mark.parametrize("rotation", FORMS)
@pytest.mark.parametrize("rule", RULES, ids=str)
@pytest.mark.parametrize("letters", ["x", "y", "z", "xy", "yz"])
def test_components_of_the_rotation_held(letters, rule, rotation):
    """No step turns about a held body axis; two held ones make a hinge whose axis stays in space."""
    data = run(lambda rod: supports.hold(rod.node(2), rotation=letters), rotation, rule).isel(node=2)
    f = increments(data.rotation.values)
    for axis, letter in enumerate("xyz"):
        if letter in letters:
            assert np.abs(f[:, axis]).max() < 5e-16
            assert not np.any(data.angular_velocity.values[:, axis])
        else:
            assert np.abs(f[:, axis]).max() > 1e-6
    if len(letters) == 2:
        (free,) = set("xyz") - set(letters)
        hinge = quaternion.to_matrix(data.rotation.values)[..., "xyz".index(free)]
        assert_allclose(hinge, np.broadcast_to(hinge[0], hinge.shape), atol=1e-14)


def test_neighbors_of_a_held_node_are_free():
    data = run(lambda rod: supports.clamp(rod.node(2)), "quaternion", cy.rules.verlet)
    moved = np.abs(data.position.values[-1] - data.position.values[0]).max(axis=1)
    assert moved[2] == 0.0
    assert np.delete(moved, 2).min() > 1e-7


def test_velocity_given_to_a_held_node_is_dropped():
    data = run(lambda rod: supports.clamp(rod.node(2)), "quaternion", cy.rules.verlet, velocity=(1, 2, 3)).isel(node=2)
    assert not np.any(data.velocity.values)
    assert np.ptp(data.position.values, axis=0).max() == 0.0


@pytest.mark.parametrize("place", ["start", "end", 3])
def test_held_nodes_of_a_density(place):
    constants = dict(mass=0.1, stiffness=20.0, gravity=np.array([0.5, 1.0, -9.81]))
    domain = cy.Interval(0.0, 1.0, elements=6)
    system = cy.compile(
        cy.densities.string, rule=cy.rules.verlet, domain=domain, constants=constants, held={"x": place}
    )
    run = cy.integrate(system, {"x_t": (1.0, 0.0, 0.0)}, 0.2)
    x = run.data["x"].values
    node = {"start": 0, "end": 6}.get(place, place)
    moved = np.abs(x - x[0]).max(axis=(0, 2))
    assert moved[node] == 0.0
    assert np.delete(moved, node).min() > 0.01
