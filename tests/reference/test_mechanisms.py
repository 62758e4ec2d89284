"""Mechanisms of rigid bodies against their equations in minimal coordinates, by a Runge-Kutta method of order 8."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import cayley as cy
from cayley import joints, loads, rules, supports
from cayley.lie import quaternion
from verify.problems import assert_order

GRAVITY = 9.81
WEIGHT = loads.gravity((0, 0, -GRAVITY))
RULES = pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint, rules.galerkin(time=2)], ids=str)
ROUND_OFF = 1e-12


def exact(rate, start, t_end):
    return solve_ivp(rate, (0.0, t_end), start, method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]


def bar(mass, inertia, first, last, name):
    """A bar between two points of the plane normal to e2; its inertia [kg m²] is about that normal."""
    first, last = np.array(first, dtype=float), np.array(last, dtype=float)
    arm = 0.5 * (last - first)
    ports = {"near": -arm, "far": arm}
    moments = [inertia, inertia, inertia]
    return cy.Body(mass=mass, inertia=moments, position=0.5 * (first + last), ports=ports, name=name)


def angle(rotation):
    """Turn about e2 of rotations about it, from -π to π."""
    return 2.0 * np.arctan2(rotation[..., 2], rotation[..., 0])


def double_pendulum():
    """Two bars that hang, turned from the vertical by 1 rad and -0.5 rad, on hinges."""
    lengths, at = (0.7, 0.5), (1.0, -0.5)
    tips = np.cumsum(
        [(0.0, 0.0)] + [(length * np.sin(a), -length * np.cos(a)) for length, a in zip(lengths, at, strict=True)],
        axis=0,
    )
    points = np.insert(tips, 1, 0.0, axis=1)
    upper = bar(2.0, 0.1, points[0], points[1], "upper")
    lower = bar(1.0, 0.03, points[1], points[2], "lower")
    ties = [
        joints.hinge(upper.port("near"), axis=(0, 1, 0)),
        joints.hinge(upper.port("far"), lower.port("near"), axis=(0, 1, 0)),
    ]
    return cy.Model(upper, lower, joints=ties, loads=[WEIGHT])


def double_pendulum_rate(t, y):
    """M(θ) θ̈ = −(forces of the weight and of the centripetal terms), angles from the vertical."""
    (m1, i1, l1), (m2, i2, l2) = (2.0, 0.1, 0.7), (1.0, 0.03, 0.5)
    a, b, u, v = y
    coupling = 0.5 * m2 * l1 * l2
    mass = np.array(
        [[i1 + (0.25 * m1 + m2) * l1**2, coupling * np.cos(a - b)], [coupling * np.cos(a - b), i2 + 0.25 * m2 * l2**2]]
    )
    force = [
        -coupling * v**2 * np.sin(a - b) - GRAVITY * (0.5 * m1 + m2) * l1 * np.sin(a),
        coupling * u**2 * np.sin(a - b) - GRAVITY * 0.5 * m2 * l2 * np.sin(b),
    ]
    return np.concatenate([[u, v], np.linalg.solve(mass, force)])


@RULES
def test_double_pendulum(rule):
    """Angles at 1 s, in the order of the rule; turning about e2 counts from e3 to e1, so against these angles."""
    model, t_end = double_pendulum(), 1.0
    known = exact(double_pendulum_rate, (1.0, -0.5, 0.0, 0.0), t_end)[:2]
    errors = []
    for n in [100, 200, 400, 800] if rule.order > 2 else [500, 1000, 2000, 4000]:
        run = cy.simulate(model, t_end, t_end / n, rule=rule, save_every=t_end)
        turned = np.array([angle(run[body].rotation.values[-1]) for body in model.bodies])
        errors.append(np.abs(np.array([1.0, -0.5]) - turned - known).max())
    assert errors[-1] < 1e-5
    assert_order(errors, rule.order, floor=ROUND_OFF)


CRANK, ROD = 0.2, 0.6
START = 0.7


def crank_slider():
    """A crank in a hinge, a connecting rod, and a block on its end, which rolls on the plane through the crank's axis.

    The block is a point here: a ball joint holds it, and nothing turns it.
    """
    pin = np.array([CRANK * np.cos(START), 0.0, CRANK * np.sin(START)])
    end = np.array([pin[0] + np.sqrt(ROD**2 - pin[2] ** 2), 0.0, 0.0])
    crank, rod = bar(1.0, 0.01, (0, 0, 0), pin, "crank"), bar(0.8, 0.03, pin, end, "rod")
    block = cy.Body(mass=1.5, inertia=[0.01, 0.01, 0.01], position=end, name="block")
    ties = [
        joints.hinge(crank.port("near"), axis=(0, 1, 0)),
        joints.hinge(crank.port("far"), rod.port("near"), axis=(0, 1, 0)),
        joints.ball(rod.port("far"), block.centre),
    ]
    return cy.Model(crank, rod, block, supports=[supports.roll(block.centre, (0, 0, 1))], joints=ties, loads=[WEIGHT])


def crank_slider_rate(t, y):
    """M φ̈ + M'(φ) φ̇²/2 + V'(φ) = 0, φ from e1 to e3; derivatives by complex steps."""

    def mass_and_weight(phi):
        psi = np.arcsin(CRANK * np.sin(phi) / ROD)
        turn = CRANK * np.cos(phi) / (ROD * np.cos(psi))
        center = -CRANK * np.sin(phi) - 0.5 * ROD * np.sin(psi) * turn, 0.5 * CRANK * np.cos(phi)
        slide = -CRANK * np.sin(phi) - ROD * np.sin(psi) * turn
        own = 0.01 + 0.25 * CRANK**2 + 0.8 * (center[0] ** 2 + center[1] ** 2) + 0.03 * turn**2 + 1.5 * slide**2
        return own, GRAVITY * (0.5 * CRANK + 0.8 * 0.5 * CRANK) * np.sin(phi)

    own, _ = mass_and_weight(y[0])
    step = 1e-30
    more, fall = (value.imag / step for value in mass_and_weight(y[0] + 1j * step))
    return np.array([y[1], -(0.5 * more * y[1] ** 2 + fall) / own])


@RULES
def test_crank_slider(rule):
    """The angle of the crank, and where the block is, at 1 s."""
    model, t_end = crank_slider(), 1.0
    phi = exact(crank_slider_rate, (START, 0.0), t_end)[0]
    place = CRANK * np.cos(phi) + np.sqrt(ROD**2 - (CRANK * np.sin(phi)) ** 2)
    assert abs(phi - START) > 1.0
    errors = []
    for n in [100, 200, 400, 800] if rule.order > 2 else [1000, 2000, 4000, 8000]:
        run = cy.simulate(model, t_end, t_end / n, rule=rule, save_every=t_end)
        turned = START - angle(run["crank"].rotation.values[-1])
        apart = np.remainder(turned - phi + np.pi, 2.0 * np.pi) - np.pi
        block = run["block"].position.values[-1]
        errors.append((abs(apart), abs(block[0] - place)))
        assert np.abs(block[1:]).max() < 1e-12
    for kind in np.transpose(errors):
        assert_order(kind, rule.order, floor=ROUND_OFF)


@pytest.mark.parametrize("bend", [0.3, 1.0])
@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint], ids=str)
def test_cardan_joint(rule, bend):
    """Shafts at an angle β: tan θ₂ = cos β tan θ₁ and θ̇₂/θ̇₁ = cos β/(1 − sin²β sin²θ₁), if at the start the axis that
    is fixed in the first shaft is normal to the plane of both.

    The axis fixed in the second shaft is perpendicular to it and to the other one: along u₂ × a₁.
    """
    way, h = 6.0, 1e-3
    second = np.array([np.cos(bend), 0.0, np.sin(bend)])
    moments = [0.02, 0.01, 0.03]
    one = cy.Body(mass=1.0, inertia=moments, position=(-0.5, 0, 0), ports={"fork": (0.5, 0, 0)}, name="one")
    turn = quaternion.from_rotation_vector((0.0, -bend, 0.0))
    ports = {"fork": (-0.5, 0, 0), "far": (0.5, 0, 0)}
    two = cy.Body(mass=1.0, inertia=moments, position=0.5 * second, rotation=turn, ports=ports, name="two")
    other = (-np.sin(bend), 0.0, np.cos(bend))
    model = cy.Model(
        one,
        two,
        supports=[
            supports.turn(one.centre, (1, 0, 0), angle=lambda t: way * t**2),
            supports.guide(two.port("far"), second),
        ],
        joints=[joints.universal(one.port("fork"), two.port("fork"), axis=(0, 1, 0), other=other)],
    )
    run = cy.simulate(model, 1.0, h, rule=rule, save_every=0.01)
    first = way * run.time**2
    relative = quaternion.multiply(quaternion.conjugate(turn), run["two"].rotation.values)
    found = np.unwrap(2.0 * np.arctan2(relative[:, 1], relative[:, 0]))
    assert np.abs(relative[:, 2:]).max() < 1e-12
    known = np.unwrap(np.arctan2(np.cos(bend) * np.sin(first), np.cos(first)))
    np.testing.assert_allclose(found, known, atol=1e-11)
    ratio = np.cos(bend) / (1.0 - np.sin(bend) ** 2 * np.sin(first) ** 2)
    spin = run["two"].angular_velocity.values[:, 0]
    np.testing.assert_allclose(spin[1:], (ratio * 2.0 * way * run.time)[1:], atol=2e-3)
