"""Forces beside the Lagrangian under explicit rules: order 2, the energy balance, and restarts bit for bit."""

import numpy as np
import pytest

import cayley as cy
from verify.problems import assert_order

E1, E2, E3 = np.eye(3)
STIFFNESS = np.diag([30.0, 30.0, 60.0, 0.5, 0.4, 0.3])
CONSTANTS = {
    "mass": 1.0,
    "inertia": np.diag([0.02, 0.02, 0.04]),
    "stiffness": STIFFNESS,
    "damping": 0.004 * STIFFNESS,
    "drag": 0.3,
    "turn": 0.01,
    "follow": 0.4,
}
SPAN = 0.4


def strain(q):
    return np.concatenate([q.p.inverse_rotate(q.x_s) - E3, q.p_s])


def forces(q, c):
    return [
        (-c.damping @ cy.rate(strain(q)), strain(q)),
        (-c.drag * cy.norm(q.x_t) * q.x_t, q.x),
        (-c.turn * q.p_t, q.p),
        (c.follow * (1.0 + np.sin(3.0 * q.t)) * q.p.rotate(E1), q.x),
    ]


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), s=cy.Interval, pose=("p", "x"), force=forces)
def damped(q, c):
    kinetic = 0.5 * c.mass * cy.dot(q.x_t, q.x_t) + 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t)
    return kinetic - 0.5 * cy.dot(strain(q), c.stiffness @ strain(q))


def run(rule, steps, rotation="quaternion", t_end=SPAN, start=None):
    system = cy.compile(
        damped,
        rule=rule,
        domain=cy.Interval(0, 1, elements=4),
        constants=CONSTANTS,
        held={"x": "start", "p": "start"},
        rotation=rotation,
    )
    moving = {"x_t": np.outer(system.nodes**2, 2.0 * E2), "p_t": np.outer(system.nodes, 3.0 * E3)}
    return cy.integrate(system, start or moving, t_end, dt=SPAN / steps, save_every=SPAN / 10, allow_unstable=True)


def defect(trajectory):
    """Energy + loss − work, less its start."""
    work, loss = trajectory.frames.work.sum(axis=1).T
    found = trajectory.energy.values + loss - work
    return np.abs(found - found[0]).max()


@pytest.mark.parametrize(
    ("rule", "rotation"),
    [
        (cy.rules.verlet, "quaternion"),
        (cy.rules.nodal, "quaternion"),
        (cy.rules.screw, "quaternion"),
        (cy.rules.spectral(space=2), "quaternion"),
        (cy.rules.verlet, "matrix"),
    ],
    ids=str,
)
def test_order_of_motion_and_balance(rule, rotation):
    steps = [160, 320, 640, 1280]
    runs = [run(rule, n, rotation) for n in [*steps, 10240]]
    exact = runs.pop().data
    assert_order([np.abs(r.data.x.values - exact.x.values).max() for r in runs])
    assert_order([np.abs(r.data.p_t.values - exact.p_t.values).max() for r in runs])
    assert_order([defect(r) for r in runs])
    work, loss = runs[-1].frames.work[-1].sum(axis=0)
    assert loss > 0.1
    assert work > 0.02


@pytest.mark.parametrize(
    ("rule", "steps", "order"),
    [
        (cy.rules.midpoint, [40, 80, 160], 2),
        (cy.rules.galerkin(time=2), [20, 40, 80], 4),
        (cy.rules.galerkin(time=2, space=2), [20, 40, 80], 4),
        (cy.rules.galerkin(time=3), [20, 40], 6),
    ],
    ids=str,
)
def test_order_of_implicit_rules(rule, steps, order):
    runs = [run(rule, n) for n in [*steps, 640 if order == 2 else 320]]
    exact = runs.pop().data.x.values[-1]
    assert_order([np.abs(r.data.x.values[-1] - exact).max() for r in runs], order=order, within=0.35)
    assert_order([defect(r) for r in runs], order=order, within=0.35)


def test_explicit_and_implicit_rules_have_one_limit():
    """Same nodes, same strains: verlet and Galerkin of degree 2 in time differ by their errors alone."""
    one, other = run(cy.rules.verlet, 20480), run(cy.rules.galerkin(time=2), 320)
    np.testing.assert_allclose(one.data.x.values[-1], other.data.x.values[-1], atol=2e-9)
    np.testing.assert_allclose(one.frames.work[-1].sum(axis=0), other.frames.work[-1].sum(axis=0), atol=2e-9)


@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.midpoint, cy.rules.galerkin(time=2)], ids=str)
def test_restart_is_bit_for_bit(rule):
    whole, half = run(rule, 160), run(rule, 160, t_end=0.5 * SPAN)
    rest = run(rule, 160, start=half.state)
    assert np.array_equal(rest.state.values, whole.state.values)
    assert np.array_equal(rest.state.momenta, whole.state.momenta)
    assert np.array_equal(rest.state.work, whole.state.work)


def test_damped_oscillator_meets_its_closed_form():
    """m ẍ + d ẋ + k x = 0 with ζ = d/(2√(km)) = 0.3."""

    @cy.lagrangian(x=cy.Vector(1), force=lambda q, c: [(-c.d * q.x_t, q.x)])
    def oscillator(q, c):
        return 0.5 * c.m * q.x_t[0] ** 2 - 0.5 * c.k * q.x[0] ** 2

    zeta, omega, t = 0.3, 2.0, 3.0
    system = cy.compile(oscillator, rule=cy.rules.verlet, constants={"m": 1.0, "k": omega**2, "d": 2 * zeta * omega})
    turning = omega * np.sqrt(1 - zeta**2)
    exact = np.exp(-zeta * omega * t) * (np.cos(turning * t) + zeta * omega / turning * np.sin(turning * t))
    found = [cy.integrate(system, {"x": [1.0]}, t, dt=h, save_every=t) for h in (0.05, 0.025, 0.0125, 0.00625)]
    assert_order([abs(float(r.data.x[-1, 0]) - exact) for r in found])


@pytest.mark.parametrize("retardation", [0.001, 0.01, 0.05])
@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.spectral(space=2)], ids=str)
def test_step_limit_is_safe_and_not_much_too_small(rule, retardation):
    """Below the limit all decays; where damping sets it, 3 % above it the motion blows up."""
    numbers = CONSTANTS | {"damping": retardation * STIFFNESS, "drag": 1e-3, "turn": 1e-3, "follow": 1e-9}
    system = cy.compile(
        damped, rule=rule, domain=cy.Interval(0, 1, elements=6), constants=numbers, held={"x": "start", "p": "start"}
    )
    limit = system.stable_dt()
    start = 1e-6 * np.random.default_rng(0).normal(size=(system.size, 3))

    def fastest(factor):
        options = {"dt": factor * limit, "save_every": 100 * limit, "allow_unstable": True}
        return np.abs(cy.integrate(system, {"x_t": start}, 400 * limit, **options).data.x_t.values[-1]).max()

    assert fastest(0.98) < 1e-5
    if retardation == 0.05:
        with pytest.raises(cy.SimulationError):
            fastest(1.03)


@pytest.mark.parametrize(
    ("rule", "steps"),
    [(cy.rules.verlet, [2e-4, 1e-4, 5e-5]), (cy.rules.midpoint, [4e-3, 2e-3, 1e-3])],
    ids=str,
)
def test_balance_of_loads_alone(rule, steps):
    """Work of time-dependent loads, in space and in the body, without any damping; the motion is what it was."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    rod = cy.Rod(cy.Section.circle(0.05, rubber), length=1.0, direction=(1, 0, 0), elements=4)
    acting = [
        cy.loads.gravity((0, 0, -9.81)),
        cy.loads.force(rod.end, lambda t: np.array([0.0, 20.0 * np.sin(9.0 * t), 0.0]), frame="body"),
        cy.loads.moment(rod.end, lambda t: np.array([0.0, 0.3 * t, 1.0])),
    ]
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=acting)
    options = {"save_every": 0.08, "rule": rule, "allow_unstable": True}
    runs = [cy.simulate(model, 0.4, h, balance=True, **options) for h in steps]
    assert_order([float(abs(run.energy_balance.defect).max()) for run in runs])
    assert float(abs(runs[-1].work).max()) > 0.1
    plain = cy.simulate(model, 0.4, steps[-1], **options)
    np.testing.assert_allclose(runs[-1][rod].position.values, plain[rod].position.values, atol=1e-11)
