"""Forces where steps do not resolve how fast stretching is damped: they keep to the motion, and do not ring."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import damping, joints, loads, rules, springs, supports

STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
TUBE = cy.Section.tube(outer_radius=0.02, thickness=0.002, material=STEEL)
G = (0.0, 0.0, -9.81)


def bent(dt: float, rule: rules.Rule, t_end: float = 0.08, **options: Any) -> cy.Trajectory:
    """A weight that falls into a ball joint at the end of a clamped arm; stretching decays in 1e-8 s."""
    arm = cy.Rod(TUBE, length=1.0, direction=(1, 0, 0), elements=3, name="arm", damping=damping.retardation(5e-3))
    bob = cy.Body(mass=2.0, inertia=[0.01, 0.01, 0.01], position=(1, 0, -0.3), name="bob", ports={"eye": (0, 0, 0.3)})
    ball = joints.ball(arm.end, bob.port("eye"), name="ball")
    model = cy.Model(arm, bob, supports=[supports.clamp(arm.start)], joints=[ball], loads=[loads.gravity(G)])
    return cy.simulate(model, t_end, dt, rule=rule, save_every=0.02, **options)


def forces(run: cy.Trajectory) -> np.ndarray:
    """Of the joint, of the clamp and in the end of the arm, shape (frames, 3)."""
    found = run.joint("ball").force, run.reaction("arm", "start").force, run["arm"].isel(node=-1).force
    return np.column_stack([found[0][:, 2], found[1][:, 2], found[2][:, 0]])


@pytest.mark.parametrize("rule", [rules.midpoint, rules.galerkin(time=2)], ids=str)
def test_forces_of_long_steps_are_those_of_short_ones(rule):
    """Steps 4e5 times as long as what decays: errors of some percent that fall with the square of the step."""
    fine, short, long = (forces(bent(dt, rule))[1:] for dt in (2.5e-4, 1e-3, 2e-3))
    scale = np.abs(fine).max()
    assert_allclose(short, fine, atol=0.01 * scale)
    assert np.abs(long - fine).max() > 2.5 * np.abs(short - fine).max()


def test_a_run_that_goes_on_tells_the_same_forces(tmp_path):
    """What the last steps said is part of the state, and what frames say is in the store."""
    whole, half = bent(4e-3, rules.midpoint), bent(4e-3, rules.midpoint, t_end=0.04)
    half.save(tmp_path / "half")
    opened = cy.Trajectory.open(tmp_path / "half")
    assert np.array_equal(forces(opened), forces(half))
    rest = cy.integrate(opened.system, opened.state, t_end=0.08, save_every=0.02)
    assert np.array_equal(rest.observed.reactions[1:], whole.observed.reactions[3:])
    assert np.isnan(rest.frames.rates[0]).all()  # before three steps of this run
    assert np.isfinite(rest.frames.rates[1:]).all()
    written = bent(4e-3, rules.midpoint, store=tmp_path / "written")  # while it runs
    assert np.array_equal(forces(written), forces(whole))
    assert np.array_equal(written.frames.rates, whole.frames.rates, equal_nan=True)


@pytest.mark.parametrize(("damped", "resolved"), [(10.0, True), (1e7, False)])
def test_damper_that_holds_a_weight(damped, resolved):
    """The clamp above carries what spring and damper carry; by the law of the damper where steps resolve its decay."""
    top = cy.Body(mass=1.0, inertia=[1, 1, 1], name="top")
    bob = cy.Body(mass=2.0, inertia=[1, 1, 1], position=(0, 0, -1), name="bob")
    tie = springs.linear(bob.centre, top.centre, stiffness=100.0, damping=damped, length=0.9)
    model = cy.Model(top, bob, supports=[supports.clamp(top.centre)], springs=[tie], loads=[loads.gravity(G)])
    run = cy.simulate(model, 0.04, 2e-3, rule=rules.midpoint, save_every=2e-3)
    speed, way = (run["bob"][name].values[:, 2] for name in ("velocity", "position"))
    pull = run.reaction("top", "centre").force.values[:, 2] - 9.81
    by_law = 100.0 * (-way - 0.9) - damped * speed
    assert np.allclose(pull, by_law, rtol=1e-12) == resolved
    if not resolved:
        assert_allclose(pull[3:], 19.62, rtol=1e-3)
        assert np.ptp(by_law[3:]) > 15.0  # the velocity of the momenta changes from frame to frame


def test_a_killed_run_goes_on_with_the_same_forces(tmp_path):
    """What the last steps said at frames that stand in the journal only is read from there."""

    def kill(done: float, time: float) -> None:
        raise RuntimeError("killed")

    whole = bent(4e-3, rules.midpoint)
    with pytest.raises(RuntimeError, match="killed"):
        bent(4e-3, rules.midpoint, store=tmp_path / "killed", progress=kill)
    resumed = cy.resume(tmp_path / "killed")
    assert np.array_equal(forces(resumed), forces(whole))
    assert np.array_equal(resumed.frames.rates, whole.frames.rates, equal_nan=True)
