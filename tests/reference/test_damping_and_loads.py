"""Damped and loaded rods against closed forms."""

import numpy as np
import pytest

import cayley as cy
from cayley import damping, loads, supports
from cayley.lie import quaternion

E1, E2, E3 = np.eye(3)
RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
SECTION = cy.Section.circle(0.05, RUBBER, shear_correction=27 / 28)
AXIAL, BENDING = SECTION.stiffness[2, 2], SECTION.stiffness[3, 3]
CALMING = damping.rayleigh((0.3, 3.0), (0.5, 10.0))


def rod(elements=8, **more):
    return cy.Rod(SECTION, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements, **more)


def settled(made, load, t_end=6.0):
    """Where a clamped, well damped rod comes to rest."""
    model = cy.Model(made, supports=[supports.clamp(made.start)], loads=[load])
    return cy.simulate(model, t_end, save_every=t_end / 4)


@pytest.mark.parametrize(
    "given",
    [damping.ratio(0.02, frequency=35.0), damping.mass_proportional(4.0), damping.rayleigh((0.03, 20.0), (0.04, 60.0))],
    ids=["retardation", "decay", "rayleigh"],
)
def test_free_decay_of_a_stretching_mode(given):
    """u₁ = sin(πs/2L), ω = (π/2L) √(E/ρ): the amplitude falls with exp(−ζωt), ζ = ½ (α/ω + τω)."""
    elements = 10
    made = rod(elements, damping=given)
    rotation_held = [supports.hold(made.node(k), position="yz", rotation="xyz") for k in range(elements + 1)]
    model = cy.Model(made, supports=[supports.clamp(made.start), *rotation_held])
    ds = 1.0 / elements
    omega = 2.0 / ds * np.sqrt(5e6 / 1100.0) * np.sin(0.25 * np.pi * ds)  # of the lumped chain
    zeta = given.ratio_at(omega / (2 * np.pi))
    t_end = 5 * 2 * np.pi / omega
    shape = np.outer(np.sin(0.5 * np.pi * made.nodes), 1e-5 * E1)
    run = cy.simulate(model, t_end, 2e-5, save_every=t_end / 200, initial={made: {"velocity": shape}})
    turning = omega * np.sqrt(1 - zeta**2)
    exact = 1e-5 / turning * np.exp(-zeta * omega * run.time) * np.sin(turning * run.time)
    found = run[made].position.values[:, -1, 0] - 1.0
    np.testing.assert_allclose(found, exact, atol=2e-4 * np.abs(exact).max())
    assert float(run.dissipated[-1]) == pytest.approx(float(run.energy[0] - run.energy[-1]), rel=1e-3)


def test_terminal_velocity():
    """m g = ½ ρ d C_n v² across the axis."""
    made = rod(4)
    g, fluid, width, coefficient = 9.81, 20.0, 0.1, 1.2
    load = loads.drag(made, density=fluid, diameter=width, normal=coefficient, tangential=0.3)
    model = cy.Model(made, loads=[loads.gravity((0, 0, -g)), load])
    run = cy.simulate(model, 20.0, save_every=10.0)
    velocity = run[made].velocity.values[-1]
    expected = np.sqrt(2.0 * SECTION.mass_per_length * g / (fluid * width * coefficient))
    np.testing.assert_allclose(velocity, np.tile(-expected * E3, (5, 1)), atol=1e-5 * expected)


def test_terminal_velocity_along_the_axis_and_in_a_stream():
    """Along the axis m g = ½ ρ π d C_t u², u the velocity against a fluid that rises."""
    made = cy.Rod(SECTION, length=1.0, direction=(0, 0, 1), elements=4)
    g, fluid, width, coefficient = 9.81, 20.0, 0.1, 0.4
    stream = np.array([0.0, 0.0, 1.5])
    load = loads.drag(made, density=fluid, diameter=width, normal=1.0, tangential=coefficient, velocity=stream)
    run = cy.simulate(cy.Model(made, loads=[loads.gravity((0, 0, -g)), load]), 20.0, save_every=10.0)
    fall = np.sqrt(2.0 * SECTION.mass_per_length * g / (fluid * np.pi * width * coefficient))
    np.testing.assert_allclose(run[made].velocity.values[-1].mean(axis=0), stream - fall * E3, atol=1e-4 * fall)


def test_buoyancy_of_its_own_weight_floats():
    made = rod(4)
    area = np.pi * 0.05**2
    lift = loads.buoyancy(made, density=1100.0, area=area)
    run = cy.simulate(cy.Model(made, loads=[loads.gravity((0, 0, -9.81)), lift]), 1.0)
    assert np.abs(run[made].position.values - run[made].position.values[0]).max() < 1e-12
    other = loads.buoyancy(made, density=550.0, area=area)
    run = cy.simulate(cy.Model(made, loads=[loads.gravity((0, 0, -9.81)), other]), 1.0)
    assert float(run[made].position[-1, 0, 2]) == pytest.approx(-0.5 * 0.5 * 9.81, rel=1e-9)


def test_temperature_stretches_without_stress():
    made = rod(damping=CALMING)
    run = settled(made, loads.temperature(made, 50.0, expansion=2e-4))
    assert run[made].position.values[-1, -1, 0] == pytest.approx(1.01, abs=1e-9)
    assert np.abs(run[made].force.values[-1]).max() < 1e-6 * AXIAL * 0.01
    assert float(run.work[-1]) == pytest.approx(2.0 * float(run.dissipated[-1]), rel=1e-3)


@pytest.mark.parametrize("turn", [None, (0.5, 0.5, 0.5, 0.5)], ids=["as it is", "turned"])
def test_tendon_bends_to_constant_curvature(turn):
    """Offset d e1: moment T d about e2 and thrust T, so curvature T d/EI and stretch −T/EA, whatever the frame."""
    tension, arm = 20.0, 0.03
    if turn is None:
        made = rod(damping=CALMING)
    else:
        axes = np.asarray(quaternion.to_matrix(np.array(turn))) @ np.array([E1, E2]).T
        made = cy.Rod(SECTION, length=1.0, direction=axes[:, 0], normal=axes[:, 1], elements=8, damping=CALMING)
    run = settled(made, loads.tendon(made, tension, offset=(arm, 0, 0)))
    found = run[made].curvature.values[-1]
    np.testing.assert_allclose(np.abs(found[:, 1]), tension * arm / BENDING, rtol=1e-4)
    assert np.abs(found[:, [0, 2]]).max() < 1e-8
    np.testing.assert_allclose(run[made].strain.values[-1][:, 2], -tension / AXIAL, rtol=1e-3)


def test_imposed_curvature_makes_a_circle():
    """Ω⁰ = 2π/L e2: a straight rod closes to a ring, free of stress."""
    stiffness = np.diag([50.0, 50.0, 100.0, 0.5, 0.5, 0.4])
    soft = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=0.02 * np.eye(3))
    made = cy.Rod(soft, length=1.0, direction=(1, 0, 0), elements=16, damping=damping.rayleigh((0.6, 0.1), (0.6, 3.0)))
    load = loads.imposed_strain(made, (0, 0, 0, 0, 2 * np.pi, 0), amount=lambda s, t: 1.0 - np.exp(-2.0 * t))
    run = settled(made, load, t_end=60.0)
    ends = run[made].position.values[-1][[0, -1]]
    assert np.linalg.norm(ends[1] - ends[0]) < 0.02
    np.testing.assert_allclose(run[made].curvature.values[-1][:, 1], 2 * np.pi, rtol=1e-2)


def test_pressure_stays_normal_and_distributed_load_is_its_function():
    """A rod turned upside down is pushed the other way; ∫ f ds of f = 6 s (1 − s) is 1."""
    made = cy.Rod(SECTION, length=1.0, direction=(-1, 0, 0), normal=(0, 1, 0), elements=4)
    push = loads.pressure(made, 3.0, axis="d1")
    spread = loads.distributed(made, lambda s, t: np.stack([0.0 * s, 0.0 * s, 6.0 * s * (1.0 - s)]))
    run = cy.simulate(cy.Model(made, loads=[push, spread]), 1e-3)
    momentum = run.linear_momentum.values[-1] / 1e-3
    assert momentum[1] == pytest.approx(3.0, rel=1e-6)
    assert momentum[2] == pytest.approx(1.0 - 1.0 / 16.0, rel=1e-6)  # by the trapezoidal rule of the nodes


def test_windows_and_several_rods_share_one_sweep():
    one, other = rod(4, name="one", damping=damping.retardation(1e-3)), rod(4, name="other")
    lift = loads.distributed(other, (0.0, 0.0, 2.0), until=0.5)
    run = cy.simulate(cy.Model(one, other, loads=[lift]), 1.0)
    assert np.abs(run[one].velocity.values).max() < 1e-12
    expected = 2.0 * 0.5 / SECTION.mass_per_length
    assert float(run[other].velocity[-1, 2, 2]) == pytest.approx(expected, rel=1e-3)


def test_density_of_ones_own_is_what_the_library_has():
    """Drag written by hand moves as loads.drag does, whose speeds differ by 1e-9 m/s."""
    made = rod(4)

    def by_hand(q, c):
        axis = q.x_s / cy.norm(q.x_s)
        across = q.x_t - cy.dot(q.x_t, axis) * axis
        return [(-c.factor * cy.norm(across) * across, q.x)]

    start = {made: {"velocity": (0.3, 0.0, 1.0)}}
    own = cy.Model(made, loads=[loads.density(made, by_hand, factor=0.5 * 20.0 * 0.1 * 1.2)])
    same = cy.Model(made, loads=[loads.drag(made, density=20.0, diameter=0.1)])
    first, second = (cy.simulate(m, 0.5, initial=start)[made].velocity.values for m in (own, same))
    np.testing.assert_allclose(first, second, atol=1e-8)
    assert first[-1, 0, 2] < 0.99


@pytest.mark.parametrize("elements", [3, 8])
def test_roll_up_closes_to_a_circle_with_any_number_of_elements(elements):
    """A moment 2πEI/L at the end: the tip comes back to the origin, its distance falls exponentially.

    Source: Hante, Tumiotto, Arnold (2021), example roll-up of their code crmS3R3.
    """
    section = cy.Section.given(
        stiffness=np.diag([1e4] * 3 + [500.0] * 3), mass_per_length=1.0, inertia=10.0 * np.eye(3)
    )
    made = cy.Rod(section, length=10.0, elements=elements, damping=damping.viscous([100.0] * 6))
    moment = loads.moment(made.end, (0, 2 * np.pi * 500.0 / 10.0, 0), frame="body")
    model = cy.Model(made, supports=[supports.clamp(made.start)], loads=[moment])
    run = cy.simulate(model, 360.0, 4e-3, rule=cy.rules.screw, save_every=1.0)
    ends = run[made].position.values[:, [0, -1]]
    distance = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    peaks = distance[1:].reshape(6, 60).max(axis=1)  # of a minute each
    assert np.all(peaks[1:] < 0.1 * peaks[:-1])
    assert peaks[-1] < 1e-6 * 10.0
    turned = quaternion.multiply(
        quaternion.conjugate(run[made].rotation.values[-1, 0]), run[made].rotation.values[-1, -1]
    )
    assert abs(turned[0]) == pytest.approx(1.0, abs=1e-9)  # once around


@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.spectral(space=2)], ids=str)
def test_viscous_stress_is_in_the_resultants(rule):
    """A rod stretched at a constant rate ε̇ has the axial force EA (ε + τ ε̇) all along."""
    tau, speed, elements = 0.02, 0.5, 4
    made = rod(elements, damping=damping.retardation(tau))
    stretching = {"velocity": lambda s: speed * s * E1}
    run = cy.simulate(cy.Model(made), 1e-4, 1e-5, rule=rule, save_every=1e-4, initial={made: stretching})
    inner = slice(1, -1)  # the ends are free of stress, but for the inertia of their nodes
    np.testing.assert_allclose(run[made].force.values[0][inner, 2], AXIAL * tau * speed, rtol=1e-12)
    np.testing.assert_allclose(run[made].force.values[0][inner, :2], 0.0, atol=1e-9)
