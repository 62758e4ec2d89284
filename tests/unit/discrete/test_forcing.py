"""Non-conservative forces at points of the embedding space: Jacobians, power, and what they do on known motions."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.density import trace
from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.equations import derive
from cayley.discrete.forcing import element_forcing
from cayley.discrete.node import tangent
from cayley.discrete.rules import MIDDLE, galerkin, midpoint, nodal_midpoint, screw_midpoint
from cayley.lie import quaternion

E3 = np.array([0.0, 0.0, 1.0])
KNOWN = {"t": 0.4, "here": 0.6, "inverse": 2.5}


def many_forces(q, c):
    strain = np.concatenate([q.p.inverse_rotate(q.x_s) - E3, q.p_s])
    across = q.x_t - cy.dot(q.x_t, q.x_s) * q.x_s
    return [
        (-c.damping @ cy.rate(strain), strain),
        (-cy.norm(across) * across, q.x),
        (-c.k * q.x_t + q.p.rotate(E3) * np.sin(q.t), q.x),
        (-c.k * q.p_t + cy.cross(E3, q.p.inverse_rotate(q.x)), q.p),
    ]


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), s=cy.Interval, pose=("p", "x"), force=many_forces)
def dragged(q, c):
    return 0.5 * c.k * (cy.dot(q.x_t, q.x_t) + cy.dot(q.p_t, q.p_t)) - 0.5 * cy.dot(q.x_s, q.x_s)


CONSTANTS = {"k": 0.7, "damping": np.diag([1.0, 2.0, 3.0, 0.4, 0.5, 0.6])}
RULES = [midpoint, nodal_midpoint, screw_midpoint, galerkin(time=2, space=2)]


class Point:
    """A force program as a function of (u, u̇)."""

    def __init__(self, rule, name):
        self.equations = derive(trace(dragged, CONSTANTS), rule)
        program, self.layout = self.equations.program(name), self.equations.layout
        rows = [symbol for symbol, _, _ in program.lanes]
        self.size = self.layout.rows * (1 if name.startswith("node") else 2)
        outputs = ca.vertcat(*[value for _, value in program.stores])
        self.function = ca.Function("point", [ca.vertcat(*program.uniforms, *rows)], [outputs])
        known = KNOWN | dict(zip(self.equations.density.names, self.equations.density.values, strict=True))
        self.uniforms = [known[s.name()] for s in program.uniforms]
        self.rest = [known[s.name()] for s in rows[2 * self.size :]]

    def __call__(self, u):
        found = np.array(self.function(np.concatenate([self.uniforms, u, self.rest])))[:, 0]
        n = self.size
        return found[:n], found[n], found[n + 1], found[n + 2 :].reshape(-1, 2 * n)

    def start(self):
        u = np.random.default_rng(5).normal(size=2 * self.size)
        p = self.layout.rows_of("p")
        u[p] /= 1.1 * np.linalg.norm(u[p])
        if self.size > self.layout.rows:  # two ends not far from each other
            other = slice(p.start + self.layout.rows, p.stop + self.layout.rows)
            u[other] = u[p] + 0.1 * u[other]
        return u


@pytest.mark.parametrize("name", ["force_point", "node_force_point"])
@pytest.mark.parametrize("rule", RULES, ids=str)
def test_jacobian_by_differences(rule, name):
    point = Point(rule, name)
    u = point.start()
    f, work, loss, jacobian = point(u)
    steps = 1e-6 * np.eye(len(u))
    differences = np.column_stack([(point(u + e)[0] - point(u - e)[0]) / 2e-6 for e in steps])
    assert_allclose(jacobian, differences, atol=2e-7 * np.abs(jacobian).max())
    assert np.abs(jacobian).max() > 0.1
    assert_allclose(work - loss, f @ u[point.size :], rtol=1e-12)


@pytest.mark.parametrize("name", ["force_point", "node_force_point"])
def test_light_program_gives_the_same_forces(name):
    full, light = Point(midpoint, name), Point(midpoint, name + "_force")
    u = full.start()
    for one, other in zip(full(u)[:3], light(u)[:3], strict=True):
        assert_allclose(one, other, rtol=1e-13, atol=1e-14)
    assert light(u)[3].size == 0


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_rigid_rotation_meets_no_strain_damping(rule):
    """A motion of the whole rod leaves strains as they are, so only forces without slopes remain."""

    @cy.lagrangian(
        p=cy.Rotation(),
        x=cy.Vector(3),
        s=cy.Interval,
        pose=("p", "x"),
        force=lambda q, c: [(-cy.rate(q.p.inverse_rotate(q.x_s)), q.p.inverse_rotate(q.x_s)), (-cy.rate(q.p_s), q.p_s)],
    )
    def damped(q, c):
        return 0.5 * c.k * (cy.dot(q.x_t, q.x_t) + cy.dot(q.p_t, q.p_t)) - 0.5 * cy.dot(q.x_s, q.x_s)

    point = Point.__new__(Point)
    equations = derive(trace(damped, {"k": 0.7}), rule)
    program, layout = equations.program("force_point"), equations.layout
    rows = [symbol for symbol, _, _ in program.lanes]
    outputs = ca.vertcat(*[value for _, value in program.stores])
    function = ca.Function("point", [ca.vertcat(*program.uniforms, *rows)], [outputs])
    point.layout, point.size = layout, 2 * layout.rows
    u = point.start()[: point.size].reshape(2, -1)
    turn = np.array([0.3, -0.2, 0.5])  # in space: ẋ = w × x, ṗ = ½ w p
    rate = np.zeros_like(u)
    for k in range(2):
        x, p = u[k, layout.rows_of("x")], u[k, layout.rows_of("p")]
        rate[k, layout.rows_of("x")] = np.cross(turn, x)
        rate[k, layout.rows_of("p")] = 0.5 * quaternion.multiply(np.append(0.0, turn), p)
    known = KNOWN | {"c.k": 0.7}
    given = [known[s.name()] for s in program.uniforms]
    f = np.array(function([*given, *u.ravel(), *rate.ravel(), *(known[s.name()] for s in rows[2 * point.size :])]))
    assert np.abs(f[: point.size]).max() < 1e-13


@pytest.mark.parametrize("kind", ["still", "moving"])
def test_force_point_contracted_is_the_force_of_an_explicit_element(kind):
    """f·δ(z, z′) with z = ½(a + b), z′ = (b − a)/ds and δq = T(q) η gives the forces on the nodes of an element."""
    point = Point(midpoint, "force_point_force")
    density, layout = point.equations.density, point.layout
    ends = Point(screw_midpoint, "force_point_force").start()[: point.size].reshape(2, -1)
    for q in ends:
        q[layout.rows_of("p")] /= np.linalg.norm(q[layout.rows_of("p")])
    rates = np.random.default_rng(2).normal(size=(2, layout.dofs))
    symbols_of = [[symbols(f"{n}{k}", size) for k in range(2)] for n, size in (("q", layout.rows), ("v", layout.dofs))]
    place = {"inverse": KNOWN["inverse"], "t": KNOWN["t"], "left": KNOWN["here"] - 0.2, "right": KNOWN["here"] + 0.2}
    found = [
        sum(to_sx(f) for f in pair)
        for pair in zip(
            *[element_forcing(density, MIDDLE, layout, *symbols_of, place, k) for k in ("still", "moving")], strict=True
        )
    ]
    if kind == "still":
        rates *= 0.0  # the forces at rest
    inputs = ca.vertcat(*[to_sx(s) for several in symbols_of for s in several], density.parameters)
    explicit = ca.Function("f", [inputs], [ca.densify(ca.vertcat(*found))])
    numbers = np.array(explicit(np.concatenate([ends.ravel(), rates.ravel(), density.values])))[:, 0]
    tangents = [np.array(ca.Function("T", [], [tangent(layout, wrap(q))])()["o0"]) for q in ends]
    moving = np.stack([t @ v for t, v in zip(tangents, rates, strict=True)])

    def embedded(a, b):
        return np.concatenate([0.5 * (a + b), KNOWN["inverse"] * (b - a)])

    f = point(np.concatenate([embedded(*ends), embedded(*moving)]))[0].reshape(2, -1)
    pulled = [t.T @ (0.5 * f[0] + sign * KNOWN["inverse"] * f[1]) for t, sign in zip(tangents, (-1, 1), strict=True)]
    assert_allclose(np.concatenate(pulled), numbers, atol=1e-12)


@pytest.mark.parametrize("name", ["force_point", "node_force_point"])
def test_jacobian_of_drag_is_finite_at_rest(name):
    point = Point(midpoint, name)
    u = point.start()
    u[point.size :] = 0.0
    f, _, _, jacobian = point(u)
    assert np.isfinite(f).all()
    assert np.isfinite(jacobian).all()
