"""Spin-up of a robot arm (Simo and Vu-Quoc 1988, example 5.1): a rod whose root a motor turns."""

import numpy as np
import pytest

import cayley as cy
from cayley import rules, supports

LENGTH, RAMP, SPEED = 10.0, 15.0, 6.0
STEADY_STRETCH = 5.14317e-4
"""u = tan(b l)/b − l with b = Ω √(ρA/EA): the tip of a rod that turns at Ω [m]; the paper prints 5.14e-4."""


def angle(t: float) -> float:
    """Of the root [rad]; from RAMP [s] on its rate is SPEED [rad/s]."""
    if t > RAMP:
        return SPEED * t - 45.0
    return 0.4 * (0.5 * t**2 + (RAMP / (2.0 * np.pi)) ** 2 * (np.cos(2.0 * np.pi * t / RAMP) - 1.0))


SECTION = cy.Section.given(
    stiffness=np.diag([1e7, 1e7, 2.8e7, 1.4e4, 1.4e4, 1.4e4]),
    mass_per_length=1.2,
    inertia=np.diag([6e-4, 6e-4, 1.2e-3]),
)


def arm_of(elements):
    return cy.Rod(SECTION, length=LENGTH, elements=elements, direction=(1, 0, 0), normal=(0, 1, 0), name="arm")


def test_stretch_at_rest_in_the_turning_frame():
    """8 elements of degree 3; the stretch is that of a linear law of EA, as published, to 1e-4 (found: 1e-9)."""
    arm = arm_of(8)
    model = cy.Model(arm, supports=[supports.clamp(arm.start)])
    rest = cy.equilibrium(model, spin=SPEED, rule=rules.galerkin(time=1, space=3))
    x, y, z = rest[arm].position.values[-1]
    rate = SPEED * np.sqrt(1.2 / 2.8e7)
    assert x - LENGTH == pytest.approx(STEADY_STRETCH, rel=1e-4)
    assert x - LENGTH == pytest.approx(np.tan(rate * LENGTH) / rate - LENGTH, rel=1e-8)
    assert max(abs(y), abs(z)) < 1e-12
    assert rest.stable


def test_steady_stretch():
    """The stretch of the tip along the turning axis, averaged over the time after the ramp."""
    arm = arm_of(16)
    model = cy.Model(arm, supports=[supports.turn(arm.start, (0, 0, 1), angle=angle)])
    run = cy.simulate(model, 20.0, 5e-3, rule=rules.galerkin(time=2), save_every=0.02)
    turned = np.array([angle(t) for t in run.time])
    x, y, z = np.moveaxis(run[arm].position.values[:, -1], -1, 0)
    along, across = x * np.cos(turned) + y * np.sin(turned) - LENGTH, y * np.cos(turned) - x * np.sin(turned)
    after = run.time > RAMP
    np.testing.assert_allclose(along[after].mean(), STEADY_STRETCH, rtol=0.01)
    assert np.abs(along[after] - STEADY_STRETCH).max() < 0.01 * STEADY_STRETCH
    assert -0.6 < across.min() < -0.55  # it lags behind half way, as in the paper's figure
    assert np.abs(across[after]).max() < 0.01
    assert np.abs(z).max() < 1e-9
    root = run[arm].rotation.values[:, 0]
    np.testing.assert_allclose(np.linalg.norm(run[arm].position.values[:, 0], axis=1), 0.0, atol=1e-12)
    assert np.abs(np.linalg.norm(root, axis=1) - 1.0).max() < 1e-12
