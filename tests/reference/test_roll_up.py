"""Roll-up of a damped cantilever (Hante, Tumiotto and Arnold 2021): an end moment that bends it to a circle."""

import numpy as np
import pytest

import cayley as cy
from cayley import loads, rules, supports
from cayley.model import damping

BENDING, LENGTH = 500.0, 10.0
MOMENT = 2.0 * np.pi * BENDING / LENGTH
RATE = 0.0871
"""At which the tip comes nearer in the end [1/s]; of the slowest mode of the circle, by a run."""


def roll_up(elements, rule, dt, t_end=160.0):
    """The rod moves in its plane: out of it the closed circle flutters under such a moment from about 70 s on."""
    stiffness, inertia = np.diag([1e4, 1e4, 1e4, *[BENDING] * 3]), np.diag([10.0, 10.0, 10.0])
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=inertia)
    options = {"direction": (1, 0, 0), "normal": (0, 0, 1), "damping": damping.viscous([100.0] * 6)}
    rod = cy.Rod(section, length=LENGTH, elements=elements, **options)
    plane = [supports.hold(rod.node(k), position="y", rotation="xz") for k in range(1, elements + 1)]
    model = cy.Model(rod, supports=[supports.clamp(rod.start), *plane], loads=[loads.moment(rod.end, (0, MOMENT, 0))])
    return rod, cy.simulate(model, t_end, dt, rule=rule, save_every=1.0)


@pytest.mark.parametrize("elements", [3, 4, 8])
@pytest.mark.parametrize(("rule", "dt"), [(rules.screw_midpoint, 2e-2), (rules.screw, 2e-3)], ids=["midpoint", "screw"])
def test_circle_closes(elements, rule, dt):
    """The tip comes to the clamp exponentially, at the same rate for any mesh, and stays there: nothing locks."""
    rod, run = roll_up(elements, rule, dt)
    tip = np.linalg.norm(run[rod].position.values[:, -1], axis=1)
    assert tip[0] == LENGTH
    assert tip[-1] < 1e-6 * LENGTH
    largest = tip[101:161].reshape(6, 10).max(axis=1)  # in stretches of 10 s
    assert np.all(np.diff(largest) < 0.0)
    assert -np.polyfit(10.0 * np.arange(6), np.log(largest), 1)[0] == pytest.approx(RATE, rel=0.1)
    first, last = run[rod].rotation.values[-1, [0, -1]]
    np.testing.assert_allclose(last, -first, rtol=0, atol=1e-6)  # a whole turn
    np.testing.assert_allclose(run[rod].curvature.values[-1, :, 1], -MOMENT / BENDING, rtol=1e-5)  # e2 is -y
    energy = 0.5 * MOMENT**2 / BENDING * LENGTH
    np.testing.assert_allclose(run.energy.values[-1], energy, rtol=1e-6)
    balance = run.energy_balance.isel(time=-1)
    np.testing.assert_allclose(float(balance.work), MOMENT * 2.0 * np.pi, rtol=1e-3)
    np.testing.assert_allclose(float(balance.dissipated), energy, rtol=1e-3)
