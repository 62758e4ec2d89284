"""Rods that are curved, twisted, stretched or tapered: free of stress where they should be, and their masses exact."""

import numpy as np
import pytest

import cayley as cy
from cayley.discrete import rules
from cayley.lie import quaternion
from cayley.system.discretize import discretize

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
SECTION = cy.Section.rectangle(0.02, 0.03, RUBBER)
RADIUS, PITCH = 0.5, 0.2


def circle(u):
    return RADIUS * np.cos(u), RADIUS * np.sin(u), 0.0


def helix(u):
    return RADIUS * np.cos(u), RADIUS * np.sin(u), PITCH * u


def knotted(**options):
    """A rod with all that a reference can have: curved, twisted, in elements of different length."""
    spacing = (1.0, 2.0, 1.5, 1.0, 3.0, 1.0)
    return cy.Rod.along(SECTION, helix, span=(0.0, 4.0), elements=6, twist=1.0, spacing=spacing, **options)


AT_ONE_POINT = ["verlet", "screw", "midpoint", "screw_midpoint", "galerkin(time=2)"]
EXPLICIT = ["nodal", "spectral(space=2)", "spectral(space=4)"]
SEVERAL_POINTS = ["galerkin(time=2, space=2)", "nodal_midpoint"]


def at_rest(rod, rule):
    """Largest distance that a free rod moves by itself in ten steps, and its largest force and moment."""
    step = {} if not rules.by_name(rule).implicit else {"dt": 2e-3}
    run = cy.simulate(cy.Model(rod), t_end=0.02, rule=rules.by_name(rule), save_every=0.01, **step)
    data = run[rod]
    return [float(np.abs(v).max()) for v in (data.position - data.position[0], data.force, data.moment)]


@pytest.mark.parametrize("rule", [*AT_ONE_POINT, *EXPLICIT, *SEVERAL_POINTS])
@pytest.mark.parametrize("curve", [circle, helix], ids=["circle", "helix"])
def test_a_curved_rod_without_stress_stays_at_rest(curve, rule):
    moved, force, moment = at_rest(cy.Rod.along(SECTION, curve, span=(0.0, 4.0), elements=5), rule)
    assert moved < 5e-14
    stiff = np.diag(SECTION.stiffness)
    assert force < 1e-12 * stiff[:3].max()
    assert moment < 1e-11 * stiff[3:].max() / RADIUS


@pytest.mark.parametrize("rule", [*AT_ONE_POINT, *EXPLICIT, "nodal_midpoint"])
def test_so_does_one_with_twist_and_uneven_elements(rule):
    assert at_rest(knotted(), rule)[0] < 5e-14


@pytest.mark.parametrize("rule", AT_ONE_POINT)
@pytest.mark.parametrize("kinematics", ["unshearable", "inextensible"])
def test_so_does_one_whose_strains_are_constrained(kinematics, rule):
    assert at_rest(knotted(kinematics=kinematics), rule)[0] < 5e-14


def test_so_does_a_polyline_and_a_spline():
    corners = [(0, 0, 0), (0.5, 0, 0), (0.5, 0.5, 0), (0.5, 0.5, 0.7)]
    assert at_rest(cy.Rod.polyline(SECTION, corners, elements=7, twist=0.5), "verlet")[0] < 5e-14
    assert at_rest(cy.Rod.through(SECTION, corners, elements=7), "spectral(space=3)")[0] < 5e-14


def test_corners_implicit_and_explicit_come_together():
    """Like h²: a helix, thinner towards its end, whose corners differ in reference strain."""

    def thinner(s):
        return cy.Section.circle(0.03 - 0.01 * s, RUBBER)

    rod = cy.Rod.along(thinner, helix, span=(0.0, 2.0), elements=3)
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
    apart = []
    for dt in (5e-5, 2.5e-5):
        runs = [
            cy.simulate(model, 0.01, dt, rule=rule, save_every=0.01) for rule in (rules.nodal, rules.nodal_midpoint)
        ]
        apart.append(np.abs(runs[0].frames.values[-1] - runs[1].frames.values[-1]).max())
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.1)


def test_one_that_is_straightened_is_not_at_rest():
    rod = knotted()
    straight = cy.Rod(SECTION, length=rod.length, elements=6)
    start = {rod: {"position": straight.positions, "rotation": straight.rotations}}
    run = cy.simulate(cy.Model(rod), t_end=0.01, rule=rules.verlet, initial=start, save_every=0.01)
    curvature = PITCH / (RADIUS**2 + PITCH**2), RADIUS / (RADIUS**2 + PITCH**2)  # twist and bend of the helix
    bend = np.linalg.norm(run[rod].moment.isel(time=0, node=3)[:2] / np.diag(SECTION.stiffness)[3:5])
    assert bend == pytest.approx(curvature[1], rel=0.02)


@pytest.mark.parametrize("rule", ["verlet", "nodal", "spectral(space=3)", "midpoint"])
def test_a_stretched_start_pulls_with_its_stretch(rule):
    rod = cy.Rod(SECTION, length=1.0, elements=4, stretched=1.1)
    step = {"dt": 1e-4} if rule == "midpoint" else {}
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start), cy.supports.clamp(rod.end)])
    data = cy.simulate(model, t_end=1e-3, rule=rules.by_name(rule), save_every=1e-3, **step)[rod]
    np.testing.assert_allclose(data.position.isel(time=0, node=-1), (0.0, 0.0, 1.1), rtol=1e-14)
    np.testing.assert_allclose(data.force[..., 2], 0.1 * SECTION.stiffness[2, 2], rtol=1e-10)


def cone(s):
    return cy.Section.circle(0.02 - 0.01 * s, RUBBER)


@pytest.mark.parametrize("rule", ["verlet", "nodal", "midpoint"])
def test_mass_and_its_first_moment_are_those_of_the_cone(rule):
    rod = cy.Rod(cone, length=1.0, elements=3, spacing=(1.0, 2.0, 1.5))
    system = discretize(cy.Model(rod), rules.by_name(rule))
    lumped = system.named["weight"] * system.named["c.mass"]
    exact = RUBBER.density * np.pi * np.array([0.02**2 - 0.02 * 0.01 + 0.01**2 / 3, 0.0])
    exact[1] = RUBBER.density * np.pi * (0.02**2 / 2 - 2 * 0.02 * 0.01 / 3 + 0.01**2 / 4)
    np.testing.assert_allclose([lumped.sum(), lumped @ system.nodes], exact, rtol=1e-13)
    assert rod.mass == pytest.approx(exact[0], rel=1e-13)


@pytest.mark.parametrize("rule", ["verlet", "spectral(space=3)"])
def test_sections_by_element_keep_mass_and_first_moment(rule):
    thin, thick = (cy.Section.circle(r, RUBBER) for r in (0.01, 0.02))
    rod = cy.Rod([thin, thick, thin], length=3.0, elements=3)
    system = discretize(cy.Model(rod), rules.by_name(rule))
    by_node = np.broadcast_to(system.named["c.mass"], system.size)
    lumped = system.named["weight"] * by_node
    masses = np.array([section.mass_per_length for section in (thin, thick, thin)])
    assert lumped.sum() == pytest.approx(masses.sum(), rel=1e-14)
    assert lumped @ system.nodes == pytest.approx(masses @ [0.5, 1.5, 2.5], rel=1e-14)


OFF_AXIS = cy.Section.given(
    stiffness=SECTION.stiffness,
    mass_per_length=SECTION.mass_per_length,
    inertia=SECTION.inertia,
    mass_center=(0.01, -0.006),
)


@pytest.mark.parametrize("kinematics", ["shearable", "unshearable", "inextensible"])
@pytest.mark.parametrize("rule", ["verlet", "screw", "midpoint", "galerkin(time=2)"])
def test_a_rod_with_its_mass_beside_the_axis_keeps_the_laws_of_mechanics(rule, kinematics):
    spin, weight = np.array([3.0, 5.0, -2.0]), np.array([0.0, 0.0, -9.81])
    rod = cy.Rod(OFF_AXIS, length=0.5, elements=4, direction=(1, 0, 0), kinematics=kinematics)
    start = {
        "velocity": lambda s: np.cross(spin, (s, 0.0, 0.0)) + np.array([0.1, 0.2, 1.0]),
        "angular_velocity": quaternion.inverse_rotate(rod.rotation, spin),
    }
    step = {"dt": 2e-3} if rules.by_name(rule).implicit else {}
    options = {"rule": rules.by_name(rule), "save_every": 0.02, "initial": {rod: start}} | step
    free = cy.simulate(cy.Model(rod), t_end=0.1, **options)
    for momentum in (free.linear_momentum.values, free.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-14
    energy = free.energy.values
    assert np.ptp(energy) < 2e-4 * energy[0]
    falling = cy.simulate(cy.Model(rod, loads=[cy.loads.gravity(weight)]), t_end=0.1, **options)
    momentum = falling.linear_momentum.values
    np.testing.assert_allclose(momentum - momentum[0], rod.mass * np.outer(falling.time, weight), atol=1e-13)


@pytest.mark.parametrize("kinematics", ["unshearable", "inextensible"])
@pytest.mark.parametrize("rule", ["verlet", "screw", "midpoint"])
def test_a_tapered_rod_with_constraints_swings_as_the_elastic_one(rule, kinematics):
    """Each node has a mass of its own, which the equations of the multipliers must know: energy kept, same motion."""

    def swing(kinematics, rule, **step):
        rod = cy.Rod(cone, length=1.0, elements=6, direction=(1, 0, 0), kinematics=kinematics)
        model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0.0, 0.0, -9.81))])
        run = cy.simulate(model, t_end=0.2, rule=rules.by_name(rule), save_every=0.05, **step)
        return run, run[rod].position.values[-1]

    step = {"dt": 1e-3} if rules.by_name(rule).implicit else {}
    run, last = swing(kinematics, rule, **step)
    energy = run.energy.values
    assert np.ptp(energy) < 1e-4 * run.kinetic_energy.values.max()
    np.testing.assert_allclose(last, swing("shearable", "verlet")[1], atol=2e-3)
