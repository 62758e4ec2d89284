"""The heavy top of Bruels, Cardona and Arnold (2012) as a body in a ball joint, against independent values."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import cayley as cy
from cayley import joints, loads, rules
from cayley.lie import quaternion
from verify.problems import assert_order, rotation_distance

INDEPENDENT = {
    0.2: ((-0.70827915, 0.43878109, 0.5457284, 0.08939975), (0.60555056, 0.59895768, -0.52398303)),
    0.5: ((0.58456062, -0.7006629, 0.38432575, 0.14019308), (-0.7024683, -0.02116518, -0.71140026)),
}
"""Rotation and mass center [m] at a time [s], by DOP853 on Euler's equations, tolerance 1e-12."""
DIGITS = 1e-8
ROUND_OFF = 1e-11
OMEGA = np.array((0.0, 150.0, -4.61538))


def top():
    """The body hangs from the origin, where the tip of its axis is held; its mass center is 1 m away."""
    center = np.array((0.0, 1.0, 0.0))
    moments = [0.234375, 0.46875, 0.234375]
    body = cy.Body(mass=15.0, inertia=moments, position=center, ports={"tip": -center}, name="top")
    model = cy.Model(body, joints=[joints.ball(body.port("tip"))], loads=[loads.gravity((0, 0, -9.81))])
    return body, model, {body: {"angular_velocity": OMEGA, "velocity": np.cross(OMEGA, center)}}


@pytest.fixture(scope="module")
def exact():
    """Rotation and mass center at 0.2 s by an explicit Runge-Kutta method of order 8, in the rotation alone."""
    inertia = np.diag([15.234375, 0.46875, 15.234375])  # about the pivot

    def rate(t, y):
        torque = np.cross((0.0, 1.0, 0.0), quaternion.inverse_rotate(y[:4], np.array([0.0, 0.0, -15.0 * 9.81])))
        spin = np.linalg.solve(inertia, torque - np.cross(y[4:], inertia @ y[4:]))
        return np.concatenate([quaternion.tangent(y[:4], y[4:]), spin])

    start = np.concatenate([(1.0, 0.0, 0.0, 0.0), OMEGA])
    p = solve_ivp(rate, (0.0, 0.2), start, method="DOP853", rtol=1e-13, atol=1e-13).y[:4, -1]
    return p, quaternion.rotate(p, (0.0, 1.0, 0.0))


def errors(rule, t_end, steps, known):
    body, model, start = top()
    turn, center = known
    found = []
    for n in steps:
        data = cy.simulate(model, t_end, t_end / n, rule=rule, initial=start, save_every=t_end)[body].isel(time=-1)
        apart = rotation_distance(data.rotation.values, np.array(turn))
        found.append((apart, np.abs(data.position.values - center).max()))
    return np.array(found)


@pytest.mark.parametrize("t_end", INDEPENDENT)
def test_rotation_and_mass_center(t_end):
    """To all the digits given."""
    assert errors(rules.galerkin(time=4), t_end, [round(t_end / 1e-3)], INDEPENDENT[t_end]).max() < 2.0 * DIGITS


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint, rules.galerkin(time=2)], ids=str)
def test_order(rule, exact):
    steps = [50, 100, 200, 400] if rule.order > 2 else [1000, 2000, 4000, 8000]
    for kind in errors(rule, 0.2, steps, exact).T:
        assert_order(kind, rule.order, floor=ROUND_OFF)
