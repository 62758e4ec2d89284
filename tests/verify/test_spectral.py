"""The explicit rule of high order in space: against verlet, against galerkin, orders, momenta, step limit."""

import numpy as np
import pytest

import cayley as cy
from cayley import loads, supports
from verify.problems import assert_order, bend, fitted, in_flight, thick_rod
from verify.test_galerkin_space import pendulum, positions, refined

spectral, galerkin = cy.rules.spectral, cy.rules.galerkin


def block(elements, degree, *, dt=1e-5):
    """A clamped rubber block of 0.4 m by 1 m, bent by a radian: quarters of it, ten times in 6 ms."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(0.2, rubber, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    model = cy.Model(rod, supports=[supports.clamp(rod.start)])
    start = {rod: bend(refined(rod, degree), 3.0)}
    run = cy.simulate(model, 6e-3, dt, rule=spectral(space=degree), save_every=6e-4, initial=start)
    return positions(run)[1:, :: elements * degree // 4]


@pytest.fixture(scope="module")
def exact_block():
    """With the same step, whose error is that of every mesh."""
    return block(48, 4)


@pytest.mark.parametrize(("degree", "meshes"), [(1, (16, 24, 32, 64)), (2, (20, 24, 32, 48)), (3, (20, 24, 28, 32))])
def test_order_in_space(degree, meshes, exact_block):
    errors = np.array([np.linalg.norm(block(n, degree) - exact_block) for n in meshes])
    observed = fitted(1.0 / np.array(meshes), errors)
    assert abs(observed - 2 * degree) < 0.3, (observed, errors)


@pytest.mark.parametrize("degree", [2, 4])
def test_order_in_time(degree):
    exact = block(4, degree, dt=6e-4 / 1024)
    assert_order([np.linalg.norm(block(4, degree, dt=6e-4 / steps) - exact) for steps in (16, 32, 64, 128)])


def busy():
    """Two rods of different sections and lengths, supports of every kind, loads at nodes and along a rod."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    a = cy.Rod(cy.Section.circle(0.05, rubber), length=1.0, direction=(1, 0, 0), elements=4, name="a")
    b = cy.Rod(cy.Section.circle(0.08, rubber), length=0.6, direction=(0, 1, 1), elements=2, name="b")
    held = [supports.clamp(a.start), supports.hold(a.node(2), position="y"), supports.pin(b.end)]
    acting = [
        loads.gravity((1.0, -2.0, -9.81)),
        loads.force(a.end, lambda t: np.array([0.0, 400.0 * np.sin(60.0 * t), 100.0])),
        loads.force(a.node(1), (0.0, 60.0, 80.0), frame="body"),
        loads.moment(b.start, (20.0, 10.0, 40.0)),
        loads.line_force(b, (0.0, 20.0, 600.0), frame="body"),
    ]
    return cy.Model(a, b, supports=held, loads=acting)


@pytest.mark.parametrize("degree", [2, 4])
def test_limit_is_that_of_the_galerkin_rule(degree):
    """Both rules are one discretization in space: with finer steps they meet, with order 2."""
    model, t_end = busy(), 0.02
    exact = cy.simulate(model, t_end, 1e-4, rule=galerkin(time=3, space=degree), save_every=t_end)
    errors = []
    for steps in (300, 600, 1200, 2400):
        run = cy.simulate(model, t_end, t_end / steps, rule=spectral(space=degree), save_every=t_end)
        errors.append(np.abs(run.frames.values[-1] - exact.frames.values[-1]).max())
    assert_order(errors)
    assert np.ptp(exact.frames.values, axis=0).max() > 0.05
    for name in ("a", "b"):
        for quantity in ("force", "moment", "strain"):
            one, other = (each[name][quantity].values[-1] for each in (run, exact))
            np.testing.assert_allclose(one, other, rtol=0, atol=2e-2 * np.abs(other).max())
    np.testing.assert_allclose(
        run.energy.values, exact.energy.values, rtol=0, atol=1e-3 * np.ptp(exact.kinetic_energy.values)
    )


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
def test_degree_one_is_verlet(rotation):
    """Bit for bit."""
    runs = [
        cy.simulate(busy(), 0.01, 2e-5, rule=rule, rotation=rotation, save_every=1e-3)
        for rule in (spectral(space=1), cy.rules.verlet)
    ]
    assert np.array_equal(runs[0].frames.values, runs[1].frames.values)
    assert np.array_equal(runs[0].frames.momenta, runs[1].frames.momenta)
    assert np.array_equal(runs[0].energy.values, runs[1].energy.values)


@pytest.mark.parametrize("degree", [2, 4])
def test_matrices_give_the_same(degree):
    one, other = (
        cy.simulate(busy(), 0.01, 2e-5, rule=spectral(space=degree), rotation=form, save_every=1e-3)
        for form in ("quaternion", "matrix")
    )
    for name in ("a", "b"):
        for quantity in ("position", "velocity", "force", "moment", "strain"):
            a, b = (run[name][quantity].values for run in (one, other))
            np.testing.assert_allclose(a, b, rtol=0, atol=1e-9 * np.abs(a).max())


@pytest.mark.slow
@pytest.mark.parametrize(("degree", "rotation"), [(2, "quaternion"), (2, "matrix"), (5, "quaternion")])
def test_momentum_maps(degree, rotation):
    """A free rod, bent, thrown and spinning: all six momenta to round-off over 1e5 steps, and the energy bounded."""
    rod, model = thick_rod(4, clamped=False)
    fine = refined(rod, degree)
    start = {rod: in_flight(fine, bend(fine, 1.5), velocity=(0.3, -0.2, 0.5), spin=(1.0, 5.0, -8.0))}
    rule, steps, dt = spectral(space=degree), 100_000, 5e-5
    run = cy.simulate(model, steps * dt, dt, rule=rule, save_every=0.05, initial=start, rotation=rotation)
    assert run.steps == steps
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        drift = np.abs(momentum - momentum[0]).max() / np.linalg.norm(momentum[0])
        assert drift < 1e-12, drift
    energy = run.energy.values
    assert np.ptp(energy) < 1e-5 * abs(energy[0])


@pytest.mark.parametrize("degree", [2, 5])
def test_step_limit(degree):
    """Just below it noise stays, just above it grows without end."""
    rod, model = thick_rod(5)
    noise = np.random.default_rng(3).normal(size=(5 * degree + 1, 3))
    start = {rod: {"velocity": 1e-6 * noise, "angular_velocity": 1e-5 * noise[::-1]}}
    rule = spectral(space=degree)
    limit = cy.simulate(model, 1e-3, rule=rule).system.stable_dt()

    def moved(dt, steps):
        run = cy.simulate(model, steps * dt, dt, rule=rule, initial=start, save_every=dt * steps, allow_unstable=True)
        return np.abs(run.frames.momenta[-1]).max() / np.abs(run.frames.momenta[0]).max()

    assert moved(0.999 * limit, 20_000) < 10.0
    with pytest.raises(cy.SimulationError):
        moved(1.02 * limit, 2000)
    with pytest.raises(ValueError, match="over the step limit"):
        cy.simulate(model, 1e-2, 1.02 * limit, rule=rule)


def test_going_on():
    """A run that stops and goes on is the run that never stopped."""
    model, dt, rule = busy(), 2e-5, spectral(space=4)
    whole = cy.simulate(model, 0.02, dt, rule=rule, save_every=5e-3)
    half = cy.simulate(model, 0.01, dt, rule=rule, save_every=5e-3)
    rest = cy.integrate(half.system, half.state, 0.02, save_every=5e-3)
    assert np.array_equal(rest.frames.values[-1], whole.frames.values[-1])
    assert np.array_equal(rest.frames.momenta[-1], whole.frames.momenta[-1])


def test_lagrangian_without_interval_is_refused():
    @cy.lagrangian(x=cy.Vector(1))
    def spring(q, c):
        return 0.5 * q.x_t @ q.x_t - 0.5 * c.k * q.x @ q.x

    with pytest.raises(ValueError, match=r"has no interval, .*; leave out space=2$"):
        cy.compile(spring, rule=spectral(space=2), constants={"k": 1.0})


@pytest.mark.parametrize(("degree", "elements", "error"), [(3, 3, 2e-3), (4, 7, 3e-5), (6, 2, 4e-5)])
def test_tip_of_the_rubber_pendulum(degree, elements, error):
    """After 1 s, against the converged value of the benchmarks, with the largest safe step."""
    _, model = pendulum(elements)
    run = cy.simulate(model, 1.0, rule=spectral(space=degree), save_every=1.0)
    distance = np.linalg.norm(positions(run)[-1, -1] - (-0.9400951, 0.0, -0.0991011))
    assert 0.5 * error < distance < error
    assert run.dt > 1e-4


@pytest.mark.parametrize("degree", [1, 2, 5])
def test_structure_is_told(degree):
    _, model = thick_rod(3)
    system = cy.simulate(model, 1e-3, rule=spectral(space=degree)).system
    assert "p[0], p[1], p[2] by Newton; x[0] explicit" in str(system)
    assert "error <= bound" in str(system.kernels)


def test_vectors_are_no_wider_than_needed():
    """Two elements of several nodes and the cell that closes them: three of four lanes."""
    for elements in (1, 2, 3, 12):
        system = cy.simulate(thick_rod(elements)[1], 1e-4, rule=spectral(space=2)).system
        widest = cy.simulate(thick_rod(elements)[1], 1e-4).system.kernels.lanes
        needed = max(2, 2 ** int(np.ceil(np.log2(system.cells))))
        assert system.kernels.lanes == min(widest, needed)


@cy.lagrangian(x=cy.Vector(2), s=cy.Interval)
def tapered(q, c):
    """A chain of springs whose stiffness and mass rise to the fourfold along it."""
    stretch = cy.dot(q.x_s, q.x_s)
    taper = (1.0 + q.s) ** 2
    return 0.5 * taper * cy.dot(q.x_t, q.x_t) - 0.5 * c.k * taper * (1.0 + 0.1 * stretch) * stretch


def test_densities_that_depend_on_the_place():
    """The coordinate at a point is that of the point: order 4 with elements of degree 2, and the energy is kept."""

    def final(elements, degree):
        system = cy.compile(
            tapered,
            rule=spectral(space=degree),
            domain=cy.Interval(0.0, 1.0, elements=elements),
            constants={"k": 4.0},
            held={"x": ("start", "end")},
        )
        s = system.nodes[:, None]
        x = np.hstack([s, 0.3 * np.sin(np.pi * s) ** 4])
        run = cy.integrate(system, {"x": x}, t_end=0.2, dt=2e-4, save_every=0.02)
        assert np.ptp(run.energy.values) < 1e-5 * run.energy.values[0]
        return run.frames.values[1:, :: elements * degree // 4]

    exact = final(32, 4)
    meshes = (12, 16, 24, 32)
    errors = [np.linalg.norm(final(n, 2) - exact) for n in meshes]
    assert abs(fitted(1.0 / np.array(meshes), errors) - 4.0) < 0.4, errors
