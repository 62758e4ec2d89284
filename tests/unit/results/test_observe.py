"""Energies, momenta, velocities and strains against direct formulas in NumPy, with SciPy's rotations."""

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation as Turn

import cayley as cy

E3 = np.array([0.0, 0.0, 1.0])


def turns(run: Any, rod: Any) -> list[Turn]:
    """Rotations of the nodes at every frame."""
    return [Turn.from_quat(p, scalar_first=True) for p in run[rod].rotation.values]


def element_strains(case: Any, k: int) -> tuple[list[np.ndarray], np.ndarray]:
    """Γ at the quadrature points of the elements (one or two), and Ω, at frame k.

    Ω = (2/ds) sin(θ/2) n at corners, (4/ds) tan(θ/4) n in the middle, for a turn by θ about n from node to node.
    """
    rod = case.rod
    ds = rod.element_length
    turn = turns(case.run, rod)[k]
    a, b = turn[:-1], turn[1:]
    slope = np.diff(case.run[rod].position.values[k], axis=0) / ds
    between = (a.inv() * b).as_rotvec()
    angle = np.linalg.norm(between, axis=1, keepdims=True)
    if case.rule == "nodal":
        return [p.inv().apply(slope) - E3 for p in (a, b)], np.sinc(angle / (2 * np.pi)) * between / ds
    middle = a * Turn.from_rotvec(0.5 * between)
    return [middle.inv().apply(slope) - E3], np.sinc(angle / (4 * np.pi)) / np.cos(angle / 4) * between / ds


def weights(rod: Any) -> np.ndarray:
    inner = np.full(rod.elements + 1, rod.element_length)
    inner[[0, -1]] *= 0.5
    return inner


def test_energies(thrown: Any) -> None:
    run, rod, section = thrown.run, thrown.rod, thrown.rod.section
    data, w = run[rod], weights(thrown.rod)
    for k in (0, 37, -1):
        v, omega = data.velocity.values[k], data.angular_velocity.values[k]
        kinetic = 0.5 * np.sum(w * (section.mass_per_length * np.sum(v * v, axis=1)))
        kinetic += 0.5 * np.einsum("a,ai,ij,aj", w, omega, section.inertia, omega)
        gammas, bend = element_strains(thrown, k)
        strain = 0.0
        for gamma in gammas:
            both = np.concatenate([gamma, bend], axis=1)
            strain += 0.5 * rod.element_length * np.einsum("ei,ij,ej", both, section.stiffness, both) / len(gammas)
        lift = -np.sum(w[:, None] * section.mass_per_length * data.position.values[k] * np.array([0.3, -0.2, -9.81]))
        assert np.isclose(run.kinetic_energy.values[k], kinetic, rtol=1e-12)
        assert np.isclose(run.potential_energy.values[k], strain + lift, rtol=1e-10, atol=1e-12)
        assert np.isclose(run.energy.values[k], kinetic + strain + lift, rtol=1e-12, atol=1e-12)
    assert strain > 1e-3  # by then there is some


def test_momenta(thrown: Any) -> None:
    run, rod, section = thrown.run, thrown.rod, thrown.rod.section
    data, w = run[rod], weights(rod)
    for k in (0, 50, -1):
        v, omega, x = (data[name].values[k] for name in ("velocity", "angular_velocity", "position"))
        momentum = w[:, None] * section.mass_per_length * v
        spin = turns(run, rod)[k].apply(w[:, None] * (omega @ section.inertia))
        assert np.allclose(run.linear_momentum.values[k], momentum.sum(axis=0), rtol=1e-12)
        assert np.allclose(run.angular_momentum.values[k], np.sum(np.cross(x, momentum) + spin, axis=0), rtol=1e-11)


def test_velocity_is_the_mean_of_the_quotients_before_and_after(thrown: Any) -> None:
    """Exact for translations: (ẋ of the step before + of the step after)/2; of second order for rotations."""
    run, rod = thrown.run, thrown.rod
    x, h = run[rod].position.values, run.dt
    assert np.allclose(run[rod].velocity.values[1:-1], (x[2:] - x[:-2]) / (2 * h), atol=1e-10)
    p = turns(run, rod)
    for k in (1, 100, 199):
        central = (p[k - 1].inv() * p[k + 1]).as_rotvec() / (2 * h)
        assert np.allclose(run[rod].angular_velocity.values[k], central, atol=2e-2, rtol=1e-3)


def test_strain_and_curvature(thrown: Any) -> None:
    data = thrown.run[thrown.rod]
    for k in (0, 60, -1):
        gammas, bend = element_strains(thrown, k)
        assert np.allclose(data.curvature.values[k], bend, atol=1e-10)
        if thrown.rule == "verlet":
            assert np.allclose(data.strain.values[k], gammas[0], atol=1e-12)


def test_forms_and_signs_agree(thrown: Any) -> None:
    """force and moment in the body, sigma in space with the other sign, impulses over one step."""
    data, h = thrown.run[thrown.rod], thrown.run.dt
    for k in (10, -1):
        force = turns(thrown.run, thrown.rod)[k].apply(data.force.values[k])
        assert np.allclose(data.sigma.values[k], -force, atol=1e-12 * np.abs(force).max())
    assert np.array_equal(data.Sigma, -data.moment)
    assert np.array_equal(data.sigma_impulse, data.sigma * h)
    assert np.array_equal(data.Sigma_impulse, data.Sigma * h)


def test_circular_arc() -> None:
    """A rod bent to a circle about its first axis has the curvature 1/R, and its chords are shorter than its arcs.

    Its moment is EI/R; under the rule that locks, too large by 1 + GA ds²/(4 EI).
    """
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
    rod = cy.Rod(cy.Section.circle(0.01, rubber), length=1.0, elements=40)
    radius = 0.5
    angle = rod.nodes / radius
    zero = 0.0 * angle
    position = radius * np.stack([zero, np.cos(angle) - 1.0, np.sin(angle)], axis=1)
    rotation = np.stack([np.cos(angle / 2), np.sin(angle / 2), zero, zero], axis=1)
    for rule in (cy.rules.verlet, cy.rules.nodal):
        run = cy.simulate(
            cy.Model(rod), t_end=1e-6, rule=rule, initial={rod: {"position": position, "rotation": rotation}}
        )
        first = run[rod].isel(time=0)
        theta = rod.element_length / radius
        exact = np.array([1.0 / radius, 0.0, 0.0])
        assert np.allclose(first.curvature, exact, atol=theta**2 / radius, rtol=0)
        assert np.abs(first.curvature - exact).max() < theta**2 / 20 / radius  # θ²/48 or θ²/24
        assert np.allclose(first.strain, (0.0, 0.0, np.sin(theta / 2) / (theta / 2) - 1.0), atol=1e-12)
        shear, bending = rod.section.stiffness[1, 1], rod.section.stiffness[3, 3]
        locked = 1.0 + shear * rod.element_length**2 / (4 * bending) if rule is cy.rules.nodal else 1.0
        inner = first.moment.isel(node=slice(1, -1))
        size = bending / radius
        assert np.allclose(inner, (locked * size, 0.0, 0.0), rtol=3e-3, atol=1e-9 * size)


def test_rods_of_a_model_are_told_apart() -> None:
    """Two rods of different sections and lengths in one system do what each does alone."""
    steel = cy.Material(density=7850.0, youngs_modulus=2e9, poisson_ratio=0.3)
    one = cy.Rod(cy.Section.circle(0.02, steel), length=1.0, elements=3, direction=(1, 0, 0), name="one")
    other = cy.Rod(
        cy.Section.rectangle(0.02, 0.05, steel),
        length=0.7,
        elements=9,
        origin=(0, 3, 0),
        direction=(0, 1, 1),
        name="other",
    )
    push = {rod: cy.loads.force(rod.end, (0.0, 30.0, 20.0), frame="body") for rod in (one, other)}

    def swing(*rods: Any) -> Any:
        held = [cy.supports.clamp(rod.start) for rod in rods]
        return cy.simulate(cy.Model(*rods, supports=held, loads=[push[r] for r in rods]), 5e-3, 5e-6, save_every=1e-3)

    both = swing(one, other)
    for rod in (one, other):
        alone = swing(rod)
        for name, values in alone[rod].data_vars.items():
            size = np.abs(values).max()
            assert np.allclose(both[rod][name], values, rtol=0, atol=1e-9 * size + 1e-12), name
    total = sum(swing(rod).energy.values for rod in (one, other))
    assert np.allclose(both.energy, total, rtol=1e-9)
