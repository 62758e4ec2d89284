"""Observed order in the time step, on nonlinear problems, by four points above the round-off."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.special import ellipj, ellipk

import cayley as cy
from cayley.lie import quaternion
from verify.problems import (
    TOP,
    TOP_START,
    assert_order,
    bend,
    frame_distance,
    free_body,
    heavy_top,
    in_flight,
    rotation_distance,
    slopes,
    thick_rod,
)

ROUND_OFF = 1e-11
BOTH_FORMS = pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
BOTH_RULES = pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)


@pytest.fixture(scope="module")
def exact_top():
    """The heavy top at 0.5 s by an explicit Runge-Kutta method of order 8 on Euler's equations."""
    inertia, weight, center = TOP["inertia"], TOP["weight"], TOP["center"]

    def rate(t, y):
        p, w = y[:4], y[4:]
        torque = np.cross(center, quaternion.inverse_rotate(p, np.array([0.0, 0.0, -weight])))
        return np.concatenate([quaternion.tangent(p, w), np.linalg.solve(inertia, torque - np.cross(w, inertia @ w))])

    start = np.concatenate([TOP_START["p"], TOP_START["p_t"]])
    return solve_ivp(rate, (0.0, 0.5), start, method="DOP853", rtol=1e-13, atol=1e-13).y[:4, -1]


@BOTH_FORMS
@BOTH_RULES
def test_heavy_top(rule, rotation, exact_top):
    """The fast top of Bruels, Cardona and Arnold (2012)."""
    system = cy.compile(heavy_top, rule=rule, constants=TOP, rotation=rotation)
    errors = []
    for steps in (1000, 2000, 4000, 8000):
        run = cy.integrate(system, TOP_START, t_end=0.5, dt=0.5 / steps, save_every=0.5)
        errors.append(rotation_distance(run.data["p"].values[-1], exact_top))
    assert_order(errors, floor=ROUND_OFF)


def jacobi(inertia, start, t):
    """Angular velocity and rotation of a free body by elliptic functions, for L² > 2 T I2 and w2(0) > 0.

    ω = (a1 cn, a2 sn, a3 dn)(λ t + u0); the rotation from the Euler angles 3-1-3 about the angular momentum, whose
    first, ψ̇ = L (I1 ω1² + I2 ω2²)/(I1² ω1² + I2² ω2²), is a quadrature.

    Source: Landau and Lifshitz, Mechanics, section 37.
    """
    i1, i2, i3 = inertia
    twice, square = inertia @ start**2, inertia**2 @ start**2
    a = np.sqrt(
        [
            (twice * i3 - square) / (i1 * (i3 - i1)),
            (twice * i3 - square) / (i2 * (i3 - i2)),
            (square - twice * i1) / (i3 * (i3 - i1)),
        ]
    )
    rate = np.sqrt((i3 - i2) * (square - twice * i1) / (i1 * i2 * i3))
    m = (i2 - i1) * (twice * i3 - square) / ((i3 - i2) * (square - twice * i1))
    phase = quad(lambda x: 1 / np.sqrt((1 - x**2) * (1 - m * x**2)), 0.0, start[1] / a[1], epsabs=1e-14)[0]
    assert 0.0 < phase < ellipk(m)

    def omega(time):
        sn, cn, dn, _ = ellipj(rate * time + phase, m)
        return a * (cn, sn, dn)

    def turn(time, first):
        momentum = inertia * omega(time)
        axis = momentum / np.sqrt(square)
        about, tilt = np.arctan2(axis[0], axis[1]), np.arccos(axis[2])
        return product(about_axis(2, first), about_axis(0, tilt), about_axis(2, about))

    def precession(time):
        w = omega(time)
        return np.sqrt(square) * (i1 * w[0] ** 2 + i2 * w[1] ** 2) / (i1**2 * w[0] ** 2 + i2**2 * w[1] ** 2)

    angle = quad(precession, 0.0, t, epsabs=1e-12, epsrel=1e-12, limit=400)[0]
    return omega(t), product(turn(t, angle), quaternion.conjugate(turn(0.0, 0.0))), turn(0.0, 0.0)


def about_axis(axis, angle):
    return quaternion.from_rotation_vector(angle * np.eye(3)[axis])


def product(*factors):
    total = factors[0]
    for factor in factors[1:]:
        total = quaternion.multiply(total, factor)
    return total


@BOTH_FORMS
@BOTH_RULES
def test_free_asymmetric_body(rule, rotation):
    """Jacobi's solution; ω at 10 s by the Legendre transform of the momenta."""
    inertia, start = np.array([1.0, 2.0, 3.0]), np.array([0.3, 0.2, 1.0])
    omega, seen, first = jacobi(inertia, start, 10.0)
    exact = product(quaternion.conjugate(first), seen, first)
    np.testing.assert_allclose(omega, (-0.1571329690, -0.3245138365, 0.9890552344), atol=1e-9)
    assert rotation_distance(exact, np.array((0.40477379, -0.09287666, 0.068864, -0.90707764))) < 2e-8
    system = cy.compile(free_body, rule=rule, constants={"inertia": np.diag(inertia)}, rotation=rotation)
    errors = []
    for steps in (100, 200, 400, 800):
        run = cy.integrate(system, {"p": (1, 0, 0, 0), "p_t": start}, t_end=10.0, dt=10.0 / steps, save_every=10.0)
        last = run.data.isel(time=-1)
        errors.append((rotation_distance(last["p"].values, exact), np.linalg.norm(last["p_t"].values - omega)))
    for kind in zip(*errors, strict=True):
        assert_order(np.array(kind), floor=ROUND_OFF)


@BOTH_FORMS
@BOTH_RULES
@pytest.mark.parametrize("flying", [False, True], ids=["clamped", "flying"])
def test_rod_in_time(rule, rotation, flying):
    """A thick rubber rod of 10 elements, bent at the start; reference by an eighth of the finest step."""
    rod, model = thick_rod(10, clamped=not flying)
    start = bend(rod, 8.0)
    if flying:
        start = in_flight(rod, start, velocity=(0.3, -0.2, 0.5), spin=(1.0, 5.0, -8.0))
    runs = [
        cy.simulate(model, 0.1, 0.1 / n, rule=rule, save_every=0.1, initial={rod: start}, rotation=rotation)
        for n in (2000, 4000, 8000, 16000, 128000)
    ]
    errors = np.array([frame_distance(run, runs[-1], rod) for run in runs[:-1]])
    for kind in errors.T:
        assert_order(kind, floor=ROUND_OFF)


@BOTH_FORMS
@BOTH_RULES
def test_rod_in_time_and_space_together(rule, rotation):
    """The step proportional to the mesh, both halved three times; reference by a mesh four times the finest."""
    positions = []
    for n in (20, 40, 80, 160, 640):
        rod, model = thick_rod(n)
        start = {rod: bend(rod, 4.0)}
        run = cy.simulate(model, 0.01, 1e-3 / n, rule=rule, save_every=0.01, initial=start, rotation=rotation)
        positions.append(run[rod].position.values[-1, :: n // 20])
    errors = [np.linalg.norm(found - positions[-1]) for found in positions[:-1]]
    assert_order(errors, floor=ROUND_OFF)


def test_rubber_pendulum_in_space():
    """The benchmark of the library: four meshes, step of the explicit limit; order from successive differences."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(5e-3, rubber, shear_correction=27 / 28)
    heights = []
    for n in (20, 40, 80, 160):
        rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=n)
        gravity = cy.loads.gravity((0, 0, -9.81))
        model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[gravity])
        run = cy.simulate(model, 1.0, 2.5e-5, save_every=1.0)
        heights.append(run[rod].position.values[-1, -1, 2])
    np.testing.assert_allclose(heights, (-0.109372, -0.101812, -0.099783, -0.099273), atol=2e-5)
    observed = slopes(np.diff(heights))
    assert abs(observed[-1] - 2.0) < 0.2, observed
