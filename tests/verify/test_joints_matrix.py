"""Joints and springs with rotations stored as matrices: the motion, forces and restart of quaternions."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import joints, loads, rules, springs, supports

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
CORD = cy.Section.circle(0.02, RUBBER)


def model() -> cy.Model:
    """A rod that is pinned, on its end a body by a ball joint, with a damped spring to the ground."""
    rod = cy.Rod(CORD, length=1.0, direction=(1, 0, 0), elements=6, name="cord")
    bob = cy.Body(mass=0.5, inertia=[0.01, 0.02, 0.015], position=(1.1, 0.05, -0.2), name="bob")
    ball = joints.ball(rod.end, bob.centre.offset((-0.1, -0.05, 0.2)), name="ball")
    tie = springs.linear(bob.centre, cy.ground.at((1, 0, -1)), stiffness=20.0, damping=0.3)
    hinge = supports.turn(rod.start, (0, 1, 0), name="hinge")
    push = loads.force(bob.centre, (0, 2.0, 0), frame="body")
    return cy.Model(
        rod, bob, supports=[hinge], joints=[ball], springs=[tie], loads=[loads.gravity((0, 0, -9.81)), push]
    )


def run(rotation: str, rule: rules.Rule, t_end: float = 0.1) -> cy.Trajectory:
    step: dict[str, Any] = {"dt": 1e-3} if rule.implicit else {"dt": 5e-5}
    return cy.simulate(model(), t_end, rule=rule, rotation=rotation, save_every=0.02, **step)


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint], ids=str)
def test_matrices_are_as_quaternions(rule, tmp_path):
    """Places, momenta, energies and forces agree to rounding, and a stored run goes on bit for bit."""
    quaternions, matrices = run("quaternion", rule), run("matrix", rule)
    assert matrices.frames.values.shape[2] == 12
    for ask in (
        lambda r: r["cord"].position,
        lambda r: r["bob"].velocity,
        lambda r: r["cord"].force,
        lambda r: r.joint("ball").force,
        lambda r: r.joint("hinge").moment,
        lambda r: r.reaction("hinge").force,
        lambda r: r.energy,
        lambda r: r.energy_balance.dissipated,
    ):
        found, wanted = ask(matrices).values, ask(quaternions).values
        assert_allclose(found, wanted, atol=1e-7 * np.abs(wanted).max())
    half = run("matrix", rule, t_end=0.04)
    half.save(tmp_path / "half")
    opened = cy.Trajectory.open(tmp_path / "half")
    assert opened.joint("ball").identical(half.joint("ball"))
    rest = cy.integrate(opened.system, opened.state, t_end=0.1, save_every=0.02)
    assert np.array_equal(rest.frames.values[-1], matrices.frames.values[-1])


def test_step_limit_knows_springs():
    """The step of an explicit rule is that of quaternions."""
    steps = [cy.simulate(model(), 1e-3, rotation=rotation).dt for rotation in ("quaternion", "matrix")]
    assert steps[1] == pytest.approx(steps[0], rel=1e-6)
