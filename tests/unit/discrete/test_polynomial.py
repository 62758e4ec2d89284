"""Forces of elements of higher degree, against the gradient of their energy by automatic differentiation."""

import casadi as ca
import numpy as np
import pytest

from cayley.density import library, trace
from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.embedded import embedded_point
from cayley.discrete.layout import Layout
from cayley.discrete.polynomial import polynomial_forces
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import gauss, lagrange, lobatto

RNG = np.random.default_rng(11)
FULL = RNG.normal(size=(6, 6))
ROD = trace(
    library.rod,
    {
        "mass": 1.0,
        "inertia": np.eye(3) + 0.1,
        "stiffness": FULL @ FULL.T + np.eye(6),
        "gravity": np.array([0, 0, -9.0]),
    },
)
INVERSE = 1.3


def by_hand(nodes: list[np.ndarray], rotation: str) -> np.ndarray:
    """Forces of polynomial_forces on quaternion rows of nodes, shape (m + 1, dofs)."""
    layout = Layout(ROD.lagrangian.fields, REPRESENTATIONS[rotation])
    rows = [symbols(f"n{k}", layout.rows) for k in range(len(nodes))]
    place = {"inverse": wrap(ca.SX(INVERSE)), "t": 0.0, "left": 0.0, "right": 0.0}
    forces = polynomial_forces(ROD, gauss(len(nodes) - 1), layout, rows, place)
    inputs = [ca.vertcat(*[to_sx(r) for r in rows]), ROD.parameters]
    function = ca.Function("forces", inputs, [ca.horzcat(*[to_sx(f) for f in forces])])
    quaternions = Layout(ROD.lagrangian.fields, REPRESENTATIONS["quaternion"])
    given = np.zeros((len(nodes), layout.rows))
    for name in layout.fields:
        own = np.array(nodes)[:, quaternions.rows_of(name)]
        turns = name in layout.rotations
        given[:, layout.rows_of(name)] = layout.representation.from_quaternion(own) if turns else own
    return np.asarray(function(given.reshape(-1), ROD.values)).T


def differentiated(nodes: list[np.ndarray]) -> np.ndarray:
    """−Tᵀ ∂W/∂(rows) of W = Σ weight W(z, z′), shape (m + 1, dofs)."""
    degree, layout = len(nodes) - 1, Layout(ROD.lagrangian.fields, REPRESENTATIONS["quaternion"])
    rows = [symbols(f"n{k}", layout.rows) for k in range(degree + 1)]
    points = gauss(degree)
    energy = ca.SX(0)
    for weight, phi, slope in zip(points.weights, *lagrange(lobatto(degree), points.at), strict=True):
        z, dz = (wrap(sum(f * r for f, r in zip(basis, rows, strict=True))) for basis in (phi, slope * INVERSE))
        energy += weight * ROD.value("strain", embedded_point(layout, z, dz, "s"))
    column = ca.vertcat(*[to_sx(r) for r in rows])
    gradient = ca.Function("gradient", [column, ROD.parameters], [ca.gradient(energy, column)])
    found = np.asarray(gradient(np.concatenate(nodes), ROD.values)).reshape(degree + 1, layout.rows)
    forces = np.zeros((degree + 1, layout.dofs))
    for name in layout.fields:
        own, dofs = layout.rows_of(name), layout.dofs_of(name)
        for k, node in enumerate(nodes):
            turns = name in layout.rotations
            tangent = np.asarray(layout.representation.tangent(node[own]), dtype=float) if turns else np.eye(3)
            forces[k, dofs] = -tangent.T @ found[k, own]
    return forces


def bent(degree: int) -> list[np.ndarray]:
    """Nodes of a bent, twisted, sheared and stretched element, quaternion rows."""
    layout, nodes = Layout(ROD.lagrangian.fields, REPRESENTATIONS["quaternion"]), []
    for at in lobatto(degree):
        p = np.array([1.0, 0.0, 0.0, 0.0]) + 0.2 * RNG.normal(size=4)
        node = np.zeros(layout.rows)
        node[layout.rows_of("p")] = p / np.linalg.norm(p)
        node[layout.rows_of("x")] = 0.2 * RNG.normal(size=3) + [0.0, 0.0, at]
        nodes.append(node)
    return nodes


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("degree", [1, 2, 3, 5, 8])
def test_forces_are_minus_the_gradient(degree, rotation):
    nodes = bent(degree)
    expected = differentiated(nodes)
    np.testing.assert_allclose(by_hand(nodes, rotation), expected, rtol=0, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("degree", [2, 6])
def test_forces_balance(degree):
    forces = by_hand(bent(degree), "quaternion")[
        :, Layout(ROD.lagrangian.fields, REPRESENTATIONS["quaternion"]).dofs_of("x")
    ]
    assert np.abs(forces.sum(axis=0)).max() < 1e-14 * np.abs(forces).max()
