"""Springs and dampers: derivatives, independence of the frame, known energies, and power that is never gained."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.discrete.joint import evaluator
from cayley.discrete.spring import SPRINGS, damper_program, spring_parameter_count, spring_program
from cayley.lie import quaternion
from unit.discrete.test_joint import BOTH, LAYOUT, R, pose, side, trivialized, turn

ALL = pytest.mark.parametrize("kind", SPRINGS)


def definite(rng: np.random.Generator, size: int) -> np.ndarray:
    root = rng.normal(size=(size, size))
    return root @ root.T + 0.1 * np.eye(size)


def parameters(rng: np.random.Generator, kind: str) -> np.ndarray:
    sides = [np.concatenate([rng.normal(size=3), turn(rng)]) for _ in range(2)]
    matrices = [definite(rng, SPRINGS[kind]).reshape(-1) for _ in range(2)]
    return np.concatenate([*sides, *matrices, [0.3]])[: spring_parameter_count(kind)]


def full(upper: np.ndarray, size: int) -> np.ndarray:
    matrix = np.zeros((size, size))
    matrix[np.triu_indices(size)] = upper
    return matrix + np.triu(matrix, 1).T


@BOTH
@ALL
def test_derivatives(kind, grounded):
    rng = np.random.default_rng(1)
    function = evaluator(spring_program(kind, LAYOUT, grounded=grounded))
    nodes = np.concatenate([pose(rng) * np.repeat([1.2, 1.0], [4, 3]), pose(rng) * np.repeat([0.7, 1.0], [4, 3])])
    given = parameters(rng, kind)

    def at(z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        found = function(np.concatenate([z, given]))[0]
        return found[0], found[1 : 1 + 2 * R], found[1 + 2 * R :]

    energy, gradient, upper = at(nodes)
    assert energy > 0.0
    hessian = full(upper, 2 * R)
    for k, step in enumerate(1e-6 * np.eye(2 * R)):
        high, low = at(nodes + step), at(nodes - step)
        assert_allclose((high[0] - low[0]) / 2e-6, gradient[k], atol=2e-7)
        assert_allclose((high[1] - low[1]) / 2e-6, hessian[k], atol=2e-6)


@BOTH
@ALL
def test_damper(kind, grounded):
    """Its Jacobian by central differences; its power −ė·Cė is never positive; a common rigid motion costs nothing."""
    rng = np.random.default_rng(2)
    function = evaluator(damper_program(kind, LAYOUT, grounded=grounded))
    nodes, rates = np.concatenate([pose(rng), pose(rng)]), rng.normal(size=2 * R)
    given = parameters(rng, kind)

    def at(z: np.ndarray) -> np.ndarray:
        return function(np.concatenate([z, given]))[0]

    both = np.concatenate([nodes, rates])
    found = at(both)
    force, jacobian = found[: 2 * R], found[2 * R :].reshape(2 * R, 4 * R)
    assert rates @ force < 0.0
    for k, step in enumerate(1e-6 * np.eye(4 * R)):
        slope = (at(both + step)[: 2 * R] - at(both - step)[: 2 * R]) / 2e-6
        assert_allclose(slope, jacobian[:, k], atol=2e-6)
    omega, velocity = rng.normal(size=3), rng.normal(size=3)
    rigid = []
    for node in (nodes[:R], nodes[R:]):
        spin = 0.5 * quaternion.multiply(np.append(0.0, omega), node[:4])
        rigid.append(np.concatenate([spin, velocity + np.cross(omega, node[4:])]))
    assert_allclose(at(np.concatenate([nodes, *rigid]))[: 2 * R], 0.0, atol=1e-12)


@ALL
def test_independent_of_the_frame(kind):
    """Turned and shifted as a whole, and with −p for p: the same energy; forces and moments add up to nothing."""
    rng = np.random.default_rng(3)
    function = evaluator(spring_program(kind, LAYOUT, grounded=False))
    nodes, given = [pose(rng), pose(rng)], parameters(rng, kind)
    found = function(np.concatenate([*nodes, given]))[0]
    q, shift = turn(rng), 5.0 * rng.normal(size=3)
    moved = [np.concatenate([quaternion.multiply(q, n[:4]), quaternion.rotate(q, n[4:]) + shift]) for n in nodes]
    moved[0][:4] *= -1.0
    assert_allclose(function(np.concatenate([*moved, given]))[0, 0], found[0], rtol=1e-13)
    force = found[1 : 1 + 2 * R] @ trivialized(np.concatenate(nodes))
    assert_allclose(force[3:6] + force[9:12], 0.0, atol=1e-12)
    total = np.zeros(3)
    for node, (moment, pull) in zip(nodes, force.reshape(2, 2, 3), strict=True):
        total += np.cross(node[4:], pull) + quaternion.rotate(node[:4], moment)
    assert_allclose(total, 0.0, atol=1e-11)


@BOTH
def test_linear_energy(grounded):
    rng = np.random.default_rng(4)
    first, second, given = pose(rng), pose(rng), parameters(rng, "linear")
    given[14], given[16] = 3.0, 0.25
    (here, _), (there, _) = side(first, given[:7]), side(second, given[7:14])
    found = evaluator(spring_program("linear", LAYOUT, grounded=grounded))(np.concatenate([first, second, given]))[0, 0]
    assert_allclose(found, 1.5 * (np.linalg.norm(there - here) - 0.25) ** 2, rtol=1e-13)


def test_linear_without_length():
    """A spring of length zero at rest has the derivatives of ½ k Δ·Δ where both ends meet."""
    node = np.array([1.0, 0, 0, 0, 0, 0, 0])
    given = np.concatenate([np.zeros(3), node[:4], np.zeros(3), node[:4], [5.0, 0.0, 0.0]])
    found = evaluator(spring_program("linear", LAYOUT, grounded=False))(np.concatenate([node, node, given]))[0]
    assert_allclose(found[: 1 + 2 * R], 0.0, atol=1e-12)
    assert_allclose(full(found[1 + 2 * R :], 2 * R)[4:7, 4:7], 5.0 * np.eye(3), atol=1e-12)


@BOTH
@pytest.mark.parametrize("angle", [-3.0, -0.5, 0.0, 2.9])
def test_rotational_energy(grounded, angle):
    """½ k (θ − θ₀)² for a turn about e3, whatever the place; seen from the ground, if there is one."""
    frame = np.array([1.0, 0, 0, 0])
    turned = np.concatenate([quaternion.from_rotation_vector([0, 0, angle]), [0.4, 0.1, 2.0]])
    rest = np.concatenate([frame, np.zeros(3)])
    nodes = (turned, rest) if grounded else (rest, turned)
    given = np.concatenate([np.zeros(3), frame, np.zeros(3), frame, [2.0, 0.0, 0.3]])
    found = evaluator(spring_program("rotational", LAYOUT, grounded=grounded))(np.concatenate([*nodes, given]))[0, 0]
    assert_allclose(found, (angle - 0.3) ** 2, rtol=1e-12)


def test_bushing_energy():
    rng = np.random.default_rng(5)
    frame, stiffness = np.array([1.0, 0, 0, 0]), definite(rng, 6)
    moved, turned = rng.normal(size=3), rng.normal(size=3)
    nodes = [np.concatenate([frame, np.zeros(3)]), np.concatenate([quaternion.from_rotation_vector(turned), moved])]
    given = np.concatenate([np.zeros(3), frame, np.zeros(3), frame, stiffness.reshape(-1), np.zeros(36)])
    found = evaluator(spring_program("bushing", LAYOUT, grounded=False))(np.concatenate([*nodes, given]))[0, 0]
    e = np.concatenate([moved, turned])
    assert_allclose(found, 0.5 * e @ stiffness @ e, rtol=1e-12)
