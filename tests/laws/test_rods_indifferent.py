"""Curved, tapered, off-axis rods turned and shifted in space move as before, turned and shifted."""

import numpy as np
import pytest
from hypothesis import given, settings

import cayley as cy
from cayley.lie import quaternion
from laws.test_frame_indifference import SECTION, shifts, turns

LAW = settings(deadline=None, max_examples=3, derandomize=True)
OFF = cy.Section.given(
    stiffness=SECTION.stiffness,
    mass_per_length=SECTION.mass_per_length,
    inertia=SECTION.inertia,
    mass_center=(0.01, 0.02),
    shear_center=(-0.01, 0.0),
)


def moved(turn, shift, rule):
    """A clamped helix of sections beside the axis, thinner towards its tip, under its weight."""

    def space(v):
        return np.asarray(quaternion.rotate(turn, np.asarray(v, dtype=float)), dtype=float)

    def section(s):
        c = (1.0 - 0.3 * s) ** 2
        return cy.Section.given(
            stiffness=c * OFF.stiffness,
            mass_per_length=c * OFF.mass_per_length,
            inertia=c * SECTION.inertia,
            mass_center=OFF.mass_center,
        )

    rod = cy.Rod.along(
        section,
        lambda u: shift + space((np.cos(u), np.sin(u), 0.2 * u)),
        elements=4,
        span=(0.0, 1.5),
        normal=space((-1, 0, 0)),
        twist=0.4,
        spacing=(1, 2, 2, 1),
    )
    gravity = cy.loads.gravity(space((0.0, 1.0, -9.81)))
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[gravity])
    return cy.simulate(model, t_end=0.02, rule=rule, save_every=0.01)[rod]


@LAW
@given(turn=turns(), shift=shifts())
@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.spectral(space=2)], ids=str)
def test_no_frame_is_preferred(rule, turn, shift):
    one = np.array([1.0, 0.0, 0.0, 0.0])
    here, there = moved(one, np.zeros(3), rule), moved(turn, shift, rule)
    expected = shift + quaternion.rotate(turn, here.position.values)
    scale = 1.0 + np.abs(shift).max()
    np.testing.assert_allclose(there.position, expected, rtol=0, atol=1e-11 * scale)
    np.testing.assert_allclose(there.moment, here.moment, rtol=0, atol=1e-7 * np.abs(here.moment.values).max() * scale)
