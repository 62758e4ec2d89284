"""Leitz, Ober-Blöbaum, Leyendecker (2014), Table 1: the scenario, and the time step that cannot run."""

import numpy as np
import pytest

import cayley as cy

DENSITY, SHEAR_MODULUS, SIDE = 1000.0, 5e6 / 2.7, 0.01
CUTOFF = np.sqrt(SHEAR_MODULUS / DENSITY / (SIDE**2 / 12.0))
"""Rotation against shear, √(G/ρ)/(radius of gyration) [1/s]."""


def torque(t):
    return 1.5 * np.sin(np.pi * t / 2) * np.array([np.cos(np.pi * t / 4), np.sin(np.pi * t / 4), 0.0])


def beam(section=None):
    """Table 1, hanging from its first node."""
    rubber = cy.Material(density=DENSITY, youngs_modulus=5e6, poisson_ratio=0.35)
    section = section or cy.Section.rectangle(SIDE, SIDE, rubber, shear_correction=1.0)
    rod = cy.Rod(section, length=2.0, direction=(0, 0, -1), normal=(1, 0, 0), elements=11)
    kick = cy.loads.moment(rod.start, torque, frame="body", until=2.0)
    gravity = cy.loads.gravity((0, 0, -9.81))
    return rod, cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[gravity, kick])


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
def test_scenario(rotation):
    """As in the paper's figure 3: no drift of the energy, angular momentum about e3 kept after the torque."""
    rod, model = beam()
    run = cy.simulate(model, 10.0, 1e-4, rule=cy.rules.nodal, save_every=0.01, rotation=rotation)
    free = run.time > 2.05
    energy, spin = run.energy.values[free], run.angular_momentum.values[free, 2]
    assert abs(energy.mean() - 0.489753) < 2e-6
    assert np.ptp(energy) < 1e-6
    assert abs(spin.mean() + 0.572937) < 2e-6
    assert np.ptp(spin) < 1e-12 * abs(spin.mean())
    assert abs(run.kinetic_energy.values.max() - 2.149) < 2e-3
    assert abs(run.potential_energy.values.min() + 1.964) < 2e-3
    assert abs(run.potential_energy.values.max() - 0.057) < 2e-3
    np.testing.assert_allclose(run[rod].position.values[-1, -1], (-1.399, -0.824, -1.185), atol=2e-3)
    assert np.abs(np.linalg.norm(run[rod].rotation.values, axis=-1) - 1.0).max() < 1e-12


def test_step_limit():
    """With J = ρI the limit is 2/CUTOFF = 1.34e-4 s; the paper's 4e-4 s is refused, and blows up if insisted on."""
    _, model = beam()
    limit = cy.simulate(model, 1e-3, 1e-4, rule=cy.rules.nodal).system.stable_dt()
    assert limit <= 2.0 / CUTOFF
    assert abs(limit - 1.34e-4) < 2e-6
    with pytest.raises(ValueError, match=r"dt is 0\.0004 s, over the step limit 0\.000134"):
        cy.simulate(model, 10.0, 4e-4, rule=cy.rules.nodal)
    with pytest.raises(cy.SimulationError, match=r"stopped at t = 0\.\d+ s .* at node \d+"):
        cy.simulate(model, 10.0, 4e-4, rule=cy.rules.nodal, allow_unstable=True)


def test_paper_step_is_bounded_below_the_limit_and_with_ten_times_the_inertia():
    """1.2e-4 s runs with J = ρI; 4e-4 s runs with J ten times larger, which the paper does not exclude."""
    _, model = beam()
    run = cy.simulate(model, 10.0, 1.2e-4, rule=cy.rules.nodal)
    assert np.ptp(run.energy.values[run.time > 2.05]) < 1e-6
    section = model.rods[0].section
    heavy = cy.Section.given(
        stiffness=section.stiffness, mass_per_length=section.mass_per_length, inertia=10.0 * section.inertia
    )
    _, model = beam(heavy)
    run = cy.simulate(model, 10.0, 4e-4, rule=cy.rules.nodal)
    assert abs(run.system.stable_dt() / 4.25e-4 - 1.0) < 0.01
    assert np.ptp(run.energy.values[run.time > 2.05]) < 1e-5
