"""Structure found from sparsity, small inverses, and the steps that solve a node."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import cayley as cy
from cayley.density import trace
from cayley.discrete.equations import derive
from cayley.discrete.program import Assign, Newton
from cayley.discrete.rules import nodal, verlet
from cayley.discrete.solve import Inverse, find_structure, solve_steps
from unit.density.examples import EXAMPLES
from unit.discrete.interpreter import solve


@cy.lagrangian(q=cy.Vector(3))
def spherical(q, c):
    """A particle in spherical coordinates (r, θ, φ)."""
    r, theta, _ = q.q
    u, v, w = q.q_t
    return 0.5 * c.m * (u**2 + r**2 * v**2 + (r * np.sin(theta) * w) ** 2) - c.m * c.g * r * np.cos(theta)


@cy.lagrangian(x=cy.Vector(2))
def diagonal(q, c):
    """Masses that depend on the other coordinate only through the load: nothing couples."""
    return 0.5 * q.x_t @ q.x_t - q.x[0] ** 2 * q.x[1] ** 2


@cy.lagrangian(x=cy.Vector(3))
def triangular(q, c):
    """x₀ moves alone; x₁ in a frame that x₀ moves."""
    u, v, w = q.x_t
    return 0.5 * (u**2 + u**4) + 0.5 * v**2 + 0.5 * w**2


def structure(lagrangian, constants, rule=nodal, rotation="quaternion"):
    blocks = derive(trace(lagrangian, constants), rule, rotation=rotation).blocks
    return sorted((block.unknowns, block.linear) for block in blocks)


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("rule", [nodal, verlet], ids=str)
def test_rod_is_three_explicit_and_three_together(rule, rotation):
    explicit = [((3,), True), ((4,), True), ((5,), True)]
    diagonal_inertia = EXAMPLES["rod"].constants | {"inertia": np.diag([1.0, 2.0, 3.0])}
    for constants in (EXAMPLES["rod"].constants, diagonal_inertia):
        assert structure(EXAMPLES["rod"].lagrangian, constants, rule, rotation) == [((0, 1, 2), False), *explicit]


def test_isotropic_rotation_is_still_solved_together():
    constants = dict(mass=1.0, inertia=np.eye(3), gravity=np.array([0.0, 0.0, -1.0]))
    assert structure(EXAMPLES["rigid_body"].lagrangian, constants)[0] == ((0, 1, 2), False)


def test_string_is_explicit():
    assert structure(*EXAMPLES["string"], verlet) == [((0,), True), ((1,), True), ((2,), True)]


def test_double_pendulum_is_one_newton_block():
    assert structure(*EXAMPLES["double_pendulum"]) == [((0, 1), False)]


def test_spherical_coordinates_are_one_newton_block():
    assert structure(spherical, dict(m=1.0, g=9.81)) == [((0, 1, 2), False)]


def test_loads_do_not_couple():
    assert structure(diagonal, {}) == [((0,), True), ((1,), True)]


def test_each_component_its_own_kind():
    assert structure(triangular, {}) == [((0,), False), ((1,), True), ((2,), True)]


def test_gyroscopic_forces_couple_linearly():
    """ẋ·(B × x) is linear in the unknown increment: coupled, and yet without Newton."""
    constants = EXAMPLES["charge"].constants
    assert structure(EXAMPLES["charge"].lagrangian, constants) == [((0, 1, 2), True)]


def test_structure_in_words():
    text = derive(trace(*EXAMPLES["rod"]), verlet).structure
    assert text.startswith("decoupled nodes; ")
    assert all(part in text for part in ("p[0], p[1], p[2] by Newton", "x[0] explicit", "x[2] explicit"))


def test_singular_pattern_is_refused():
    u = ca.SX.sym("u", 2)
    with pytest.raises(ValueError, match="do not determine every unknown"):
        find_structure(ca.vertcat(u[0] - 1, u[0] ** 2), u)


@given(st.permutations(range(6)), st.permutations(range(6)))
def test_block_triangular_order_whatever_the_numbering(columns, rows):
    """A chain a | b | (c, d) | e | f, each block needing those before it, is found in that order and solved by it."""
    u = ca.SX.sym("u", 6)
    a, b, c, d, e, f = (u[k] for k in columns)
    chain = [
        a - 0.3,
        b * (1 + a**2) - a,
        c + 0.2 * ca.sin(d) - b,
        d + 0.3 * c * c - 0.1,
        e + 0.1 * e**3 - c * d,
        f * (2 + e) - a - b - c - d,
    ]
    residual = ca.vertcat(*[chain[k] for k in rows])
    blocks = find_structure(residual, u)
    expected = [((0,), True), ((1,), True), ((2, 3), False), ((4,), False), ((5,), True)]
    of = list(columns)
    assert [(tuple(sorted(of.index(i) for i in block.unknowns)), block.linear) for block in blocks] == expected
    known: dict[str, float] = {}
    assert solve(solve_steps(residual, u, blocks), known)
    found = np.array(ca.Function("r", [u], [residual])([known[f"u_{k}"] for k in range(6)]))
    assert np.abs(found).max() < 1e-15


@pytest.mark.parametrize("n", range(1, 7))
def test_inverse_against_numpy(n):
    rng = np.random.default_rng(n)
    matrix, b = rng.normal(size=(n, n)) + 3.0 * np.eye(n), rng.normal(size=n)
    m, v = ca.SX.sym("m", n, n), ca.SX.sym("v", n)
    found = np.array(ca.Function("f", [m, v], [Inverse(m)(v)])(matrix, b)).reshape(-1)
    assert_allclose(found, np.linalg.solve(matrix, b), rtol=1e-12)


@pytest.mark.parametrize("n", [2, 3, 5])
def test_inverse_of_a_sparse_matrix(n):
    """Structural zeros stay out of the expressions: a lower triangle."""
    rng = np.random.default_rng(n)
    sparse = ca.SX.sym("m", ca.Sparsity.lower(n))
    matrix = np.tril(rng.normal(size=(n, n))) + 2.0 * np.eye(n)
    b = rng.normal(size=n)
    m = ca.SX.sym("v", n)
    found = np.array(ca.Function("f", [sparse, m], [Inverse(sparse)(m)])(matrix, b)).reshape(-1)
    assert_allclose(found, np.linalg.solve(matrix, b), rtol=1e-12)


def test_linear_equations_take_one_assignment():
    u = ca.SX.sym("u", 3)
    matrix = np.array([[2.0, 1.0, 0.0], [1.0, 3.0, 1.0], [0.0, 1.0, 2.0]])
    residual = matrix @ u - np.array([1.0, 2.0, 3.0])
    steps = solve_steps(residual, u, find_structure(residual, u))
    assert [type(s) for s in steps] == [Assign]
    known: dict[str, float] = {}
    assert solve(steps, known)
    assert_allclose([known[f"u_{k}"] for k in range(3)], np.linalg.solve(matrix, [1.0, 2.0, 3.0]), atol=1e-14)


@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_newton_converges_to_round_off(p, q):
    u = ca.SX.sym("u", 2)
    residual = ca.vertcat(u[0] + 0.2 * ca.sin(u[1]) - p, u[1] + 0.3 * ca.cos(u[0]) * u[0] - q)
    steps = solve_steps(residual, u, find_structure(residual, u))
    assert [type(s) for s in steps] == [Assign, Newton]
    known: dict[str, float] = {}
    assert solve(steps, known)
    left = np.array(ca.Function("r", [u], [residual])([known["u_0"], known["u_1"]]))
    assert np.abs(left).max() < 2e-14


def test_newton_reports_what_has_no_solution():
    u = ca.SX.sym("u", 1)
    residual = u**2 + u + 1
    assert not solve(solve_steps(residual, u, find_structure(residual, u)), {})
