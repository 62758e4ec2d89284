"""The continuous Euler-Lagrange equations, and the discrete ones as their limit."""

import casadi as ca
import numpy as np
import pytest

import cayley as cy
from cayley.density import library, trace
from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.continuous import euler_lagrange_residual
from cayley.discrete.element import element_forces
from cayley.discrete.equations import derive
from cayley.discrete.node import corner_inertia, node_load
from cayley.lie import quaternion
from verify.problems import TOP, assert_order, heavy_top

ROD = {
    "mass": 2.0,
    "inertia": np.diag([0.1, 0.2, 0.35]),
    "stiffness": np.diag([100.0, 110.0, 200.0, 3.0, 4.0, 5.0]),
    "gravity": np.array([0.3, 0.2, -9.8]),
}


def position(s, t):
    return np.array([0.3 * np.sin(2 * s - t), 0.2 * t * np.cos(s), s + 0.1 * np.sin(s * t)])


def rotation(s, t):
    p = np.array([1.0 + 0.2 * s * t, 0.4 * np.sin(s + 2 * t), 0.3 * np.cos(s - t), 0.2 * s - 0.5 * t])
    return p / np.sqrt(p @ p)


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), y=cy.Vector(2), s=cy.Interval)
def tangled(q, c):
    """Nothing of nature: every term couples fields, velocities, slopes, place and time where a rule allows it."""
    spin = q.p.rotate(q.p_t)
    mass = c.mass * (1.0 + 0.3 * np.sin(q.s) + 0.2 * np.exp(-q.t) + 0.1 * cy.dot(q.x, q.x))
    kinetic = 0.5 * mass * cy.dot(q.x_t, q.x_t) + 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) * (1.0 + q.y[0] ** 2)
    kinetic = kinetic + 0.5 * cy.dot(q.y_t, q.y_t) * (2.0 + np.cos(q.y[1])) + 0.1 * cy.dot(spin, q.x_t)
    gyroscopic = 0.3 * q.x[0] * q.x_t[1] + 0.2 * cy.dot(cy.E1, q.p.rotate(q.p_t)) * q.y[1]
    strain = q.p.inverse_rotate(q.x_s) - (1.0 + 0.1 * q.s) * cy.E3
    stored = 0.5 * c.stiffness * cy.dot(strain, strain) * (1.0 + q.x[2] ** 2) + 0.3 * cy.dot(q.p_s, q.p_s) ** 2
    stored = stored + 0.4 * cy.dot(q.p.rotate(q.p_s), q.x_s) * q.y_s[0] + 0.2 * np.sqrt(1.0 + cy.dot(q.y_s, q.y_s))
    load = 0.7 * np.sin(q.y[0] * q.x[1]) * np.cos(q.t) + c.weight * cy.dot(cy.E3, q.p.rotate(cy.E1)) * q.s
    return kinetic + gyroscopic - stored - load


CASES = {
    "rod": (library.rod, ROD, {"x": position, "p": rotation}),
    "tangled": (
        tangled,
        {"mass": 1.5, "inertia": np.diag([0.5, 0.6, 0.7]) + 0.05, "stiffness": 3.0, "weight": 0.8},
        {"x": position, "p": rotation, "y": lambda s, t: np.array([np.cos(s + t), 0.5 * s * np.sin(3 * t)])},
    ),
}


def test_rod_matches_its_closed_form():
    """Section 6.1 of the paper, signs corrected, with derivatives taken without the library's kinematics."""
    s, t = ca.SX.sym("s"), ca.SX.sym("t")
    x = ca.vertcat(0.3 * ca.sin(2 * s - t), 0.2 * t * ca.cos(s), s + 0.1 * ca.sin(s * t))
    w, u = 1.0 + 0.2 * s * t, ca.vertcat(0.4 * ca.sin(s + 2 * t), 0.3 * ca.cos(s - t), 0.2 * s - 0.5 * t)
    length = ca.sqrt(w**2 + ca.sumsqr(u))
    w, u = w / length, u / length
    turn = ca.SX.eye(3) + 2 * w * ca.skew(u) + 2 * ca.skew(u) @ ca.skew(u)

    def d(value, by):
        return ca.reshape(ca.jacobian(ca.vec(value), by), value.shape)

    def vee(m):
        return ca.vertcat(m[2, 1], m[0, 2], m[1, 0])

    omega, curvature = vee(turn.T @ d(turn, t)), vee(turn.T @ d(turn, s))
    m, inertia, gravity = ROD["mass"], ROD["inertia"], ROD["gravity"]
    c1, c2 = ROD["stiffness"][:3, :3], ROD["stiffness"][3:, 3:]
    tangent = turn.T @ d(x, s)
    strain = tangent - ca.DM([0, 0, 1])
    torque = ca.cross(tangent, c1 @ strain) - ca.cross(omega, inertia @ omega) - inertia @ d(omega, t)
    torque += ca.cross(curvature, c2 @ curvature) + c2 @ d(curvature, s)
    stretching = d(turn, s).T @ d(x, s) + turn.T @ d(d(x, s), s)
    force = m * d(d(x, t), t) - m * gravity - turn @ ca.cross(curvature, c1 @ strain) - turn @ c1 @ stretching
    closed = ca.Function("closed", [s, t], [force, -torque])

    places, times = np.linspace(0.0, 2.0, 7)[:, None], np.linspace(0.1, 1.0, 5)
    found = euler_lagrange_residual(library.rod, ROD, {"x": position, "p": rotation}, places, times)
    for i, k in np.ndindex(7, 5):
        expected = closed(places[i, 0], times[k])
        np.testing.assert_allclose(found["x"][i, k], np.array(expected[0])[:, 0], rtol=1e-11, atol=1e-10)
        np.testing.assert_allclose(found["p"][i, k], np.array(expected[1])[:, 0], rtol=1e-11, atol=1e-10)


def test_a_solution_has_no_residual():
    """A standing wave of a stretched string, and a heavy top asleep, its axis e2 upright."""
    tension, mass = 3.0, 0.5
    speed = np.sqrt(tension / mass)

    @cy.lagrangian(y=cy.Vector(1), s=cy.Interval)
    def wave(q, c):
        return 0.5 * c.mass * q.y_t[0] ** 2 - 0.5 * c.tension * q.y_s[0] ** 2

    def standing(s, t):
        return np.array([np.sin(2 * s) * np.cos(2 * speed * t)])

    points = np.linspace(0, 3, 11)
    found = euler_lagrange_residual(wave, {"mass": mass, "tension": tension}, {"y": standing}, points, points)
    assert np.abs(found["y"]).max() < 1e-13

    def sleeping(t):
        return quaternion.multiply(np.array([1.0, 1.0, 0.0, 0.0]), np.array([np.cos(3 * t), 0.0, np.sin(3 * t), 0.0]))

    found = euler_lagrange_residual(heavy_top, TOP, {"p": sleeping}, None, points)
    assert found["p"].shape == (11, 3)
    assert np.abs(found["p"]).max() < 1e-12


def test_misuse_is_told():
    fields = {"x": position, "p": rotation}
    with pytest.raises(ValueError, match=r"fields are x; give p, x"):
        euler_lagrange_residual(library.rod, ROD, {"x": position}, 0.0, 0.0)
    with pytest.raises(ValueError, match=r"function of p returns shape \(3,\); give \(4,\)"):
        euler_lagrange_residual(library.rod, ROD, fields | {"p": position}, 0.0, 0.0)
    with pytest.raises(ValueError, match="give s just for a density on an interval"):
        euler_lagrange_residual(library.rod, ROD, fields, None, 0.0)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("rotation_form", ["quaternion", "matrix"])
@pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)
def test_discrete_equations_converge_to_the_continuous_ones(case, rotation_form, rule):
    """The left side of the paper's eq. 6 over h ds tends to minus the residual, with order 2 in (h, ds) together."""
    lagrangian, constants, fields = CASES[case]
    places, times = np.array([0.5, 0.8, 1.3]), np.array([0.7, 0.2, 0.9])
    exact = euler_lagrange_residual(lagrangian, constants, fields, places, times)
    exact = np.concatenate([exact[name] for name in lagrangian.fields], axis=1)
    discrete = DiscreteResidual(lagrangian, constants, fields, rule, rotation_form)
    errors = []
    for step in 0.02 * 0.5 ** np.arange(4):
        found = np.array([discrete(s, t, 0.7 * step, step) for s, t in zip(places, times, strict=True)])
        errors.append(np.abs(found + exact).max())
    assert_order(errors)


class DiscreteResidual:
    """(D_(a,j) of the action's sum) / (h ds) for nodal samples of smooth fields."""

    def __init__(self, lagrangian, constants, fields, rule, rotation_form):
        self.fields = fields
        density = trace(lagrangian, constants)
        self.layout = derive(density, rule, rotation=rotation_form).layout
        node, following = (symbols(n, self.layout.rows) for n in ("q", "following"))
        unknown = symbols("u", self.layout.dofs)
        place = {n: wrap(ca.SX.sym(n)) for n in ("h", "t", "t_next", "inverse", "here")}
        inertia = corner_inertia(density, self.layout, node, unknown, place)
        before = inertia.before / inertia.scale
        both = [to_sx(e) for e in (node, unknown, *place.values())]
        self._inertia = ca.Function(
            "inertia", [*both, density.parameters], [to_sx(before), to_sx(inertia.total - before)]
        )
        ends = place | {"left": place["here"], "right": place["here"] + 1.0 / place["inverse"]}
        forces = element_forces(density, rule.strain, self.layout, (node, following), ends)
        load = node_load(density, self.layout, node, place)
        inputs = [to_sx(e) for e in (node, following, *place.values())]
        self._forces = ca.Function("forces", [*inputs, density.parameters], [to_sx(f) for f in (*forces, load)])
        self._values = density.values

    def __call__(self, s, t, h, ds):
        """At the node s and the time t, shape (dofs,)."""
        now = self._sample(s, t)

        def place(here, time):
            return h, time, time + h, 1.0 / ds, here

        after = self._inertia(now, self._increment(s, t, h), *place(s, t), self._values)[0]
        before = self._inertia(self._sample(s, t - h), self._increment(s, t - h, h), *place(s, t - h), self._values)[1]
        element = self._forces(self._sample(s - ds, t), now, *place(s - ds, t), self._values)
        following = self._forces(now, self._sample(s + ds, t), *place(s, t), self._values)
        force = element[1] + following[0] + following[2]  # per length, times ds, over the node's weight ds
        return np.array(force + (after + before) / h)[:, 0]

    def _sample(self, s, t):
        values = []
        for name in self.layout.fields:
            value = np.asarray(self.fields[name](s, t), dtype=float)
            turns = name in self.layout.rotations
            values.append(self.layout.representation.from_quaternion(value) if turns else value)
        return np.concatenate(values)

    def _increment(self, s, t, h):
        values = []
        for name in self.layout.fields:
            a, b = (np.asarray(self.fields[name](s, time), dtype=float) for time in (t, t + h))
            if name in self.layout.rotations:
                relative = quaternion.relative(a, b)
                values.append(relative[1:] / relative[0])
            else:
                values.append(b - a)
        return np.concatenate(values)
