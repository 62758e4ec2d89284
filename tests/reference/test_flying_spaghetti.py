"""Flying spaghetti (Simo and Vu-Quoc 1988): invariants that follow from the data alone."""

import numpy as np
import pytest

import cayley as cy


def triangle(t):
    """0 at 0 s, 200 at 2.5 s, 0 from 5 s on."""
    return 200.0 * max(0.0, 1.0 - abs(t - 2.5) / 2.5)


def noodle():
    """A free rod of length 10 from (6, 0, 0) to (0, 8, 0), pushed and turned at its first end for 5 s."""
    stiffness = np.diag([1e4, 1e4, 1e4, 500.0, 500.0, 500.0])
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=np.diag([10.0, 10.0, 10.0]))
    rod = cy.Rod(section, length=10.0, elements=16, origin=(6, 0, 0), direction=(-0.6, 0.8, 0), normal=(0, 0, 1))
    push = cy.loads.force(rod.start, lambda t: (triangle(t) / 10.0, 0.0, 0.0))
    turn = cy.loads.moment(rod.start, lambda t: (0.0, -0.5 * triangle(t), -triangle(t)))
    return rod, cy.Model(rod, loads=[push, turn])


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)
def test_invariants(rule, rotation):
    """Mass 10, impulse 50: from 5 s on the center moves with exactly 5 e_x, from 12.5 m; then all momenta are kept."""
    rod, model = noodle()
    run = cy.simulate(model, 15.0, 2.5e-3, rule=rule, save_every=0.05, rotation=rotation)
    weight = np.full(17, 10.0 / 16.0)
    weight[[0, -1]] *= 0.5
    center = (run[rod].position.values * weight[:, None]).sum(axis=1) / 10.0
    after = run.time >= 5.0 - 1e-9
    expected = np.array([3.0, 4.0, 0.0]) + np.outer(12.5 + 5.0 * (run.time[after] - 5.0), [1.0, 0.0, 0.0])
    np.testing.assert_allclose(center[after], expected, rtol=0, atol=1e-10)
    np.testing.assert_allclose(
        run.linear_momentum.values[after], np.tile([50.0, 0.0, 0.0], (after.sum(), 1)), atol=1e-10
    )
    spin = run.angular_momentum.values[after]
    assert np.abs(spin - spin[0]).max() < 1e-12 * np.linalg.norm(spin[0])
    energy = run.energy.values[after]
    assert np.ptp(energy) < 1e-5 * energy.mean()
