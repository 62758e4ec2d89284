"""Damping together with joints and with constrained rods, explicit: the predictor knows of the multipliers."""

import numpy as np
import pytest

import cayley as cy
from cayley import damping, joints, loads, supports
from verify.problems import assert_order

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
SECTION = cy.Section.circle(0.05, RUBBER)
GRAVITY = loads.gravity((0, 0, -9.81))


def welded():
    """A damped arm and a post on its end."""
    arm = cy.Rod(SECTION, length=1.0, direction=(1, 0, 0), elements=4, damping=damping.retardation(2e-3), name="arm")
    post = cy.Rod(SECTION, length=0.5, origin=(1, 0, 0), direction=(0, 0, 1), elements=2, name="post")
    held = [supports.clamp(arm.start)]
    return cy.Model(arm, post, supports=held, joints=[joints.weld(arm.end, post.start)], loads=[GRAVITY])


def unshearable():
    """A damped Kirchhoff rod with a tendon and a load that depends on time."""
    given = damping.retardation(2e-3) + damping.mass_proportional(1.0)
    arm = cy.Rod(
        SECTION, length=1.0, direction=(1, 0, 0), elements=4, damping=given, kinematics="unshearable", name="arm"
    )
    acting = [
        GRAVITY,
        loads.tendon(arm, lambda t: 10.0 * t, offset=(0.02, 0, 0)),
        loads.force(arm.end, lambda t: np.array([0.0, 3.0 * np.sin(9.0 * t), 0.0])),
    ]
    return cy.Model(arm, supports=[supports.clamp(arm.start)], loads=acting)


@pytest.mark.parametrize("model", [welded(), unshearable()], ids=["welded", "unshearable"])
def test_order_of_motion_and_balance(model):
    steps = [8e-5, 4e-5, 2e-5]
    runs = [cy.simulate(model, 0.2, h, save_every=0.05, allow_unstable=True) for h in [*steps, 2.5e-6]]
    exact = runs.pop()["arm"].position.values
    assert_order([np.abs(run["arm"].position.values - exact).max() for run in runs])
    assert_order([float(abs(run.energy_balance.defect).max()) for run in runs])
    assert float(runs[-1].dissipated[-1]) > 0.05
