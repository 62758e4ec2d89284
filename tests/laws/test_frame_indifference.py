"""No frame is preferred: a problem turned and shifted in space has the same answer, turned and shifted."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cayley as cy
from cayley.lie import quaternion

LAW = settings(deadline=None, max_examples=12, derandomize=True)

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
SECTION = cy.Section.rectangle(0.06, 0.04, RUBBER)


@st.composite
def turns(draw):
    """Draw a rotation, its angle up to and beyond a half turn; p and -p."""
    p = np.array([draw(st.floats(-1, 1)) for _ in range(4)])
    return np.array([0.0, 1.0, 0.0, 0.0]) if np.linalg.norm(p) < 1e-2 else p / np.linalg.norm(p)


@st.composite
def shifts(draw):
    """Draw a shift of up to 10 m."""
    return np.array([draw(st.floats(-10, 10)) for _ in range(3)])


def scene(turn, shift):
    """Two rods of different directions, one clamped and one free; gravity, loads in both frames, velocities."""

    def space(v):
        return np.asarray(quaternion.rotate(turn, np.asarray(v, dtype=float)), dtype=float)

    arm = cy.Rod(
        SECTION, length=1.0, elements=4, origin=shift, direction=space((1, 0, 0)), normal=space((0, 1, 0)), name="arm"
    )
    kite = cy.Rod(
        SECTION,
        length=0.7,
        elements=5,
        origin=shift + space((0.2, 0.5, -1)),
        direction=space((0.6, 0, 0.8)),
        normal=space((0, 1, 0)),
        name="kite",
    )
    model = cy.Model(
        arm,
        kite,
        supports=[cy.supports.clamp(arm.start)],
        loads=[
            cy.loads.gravity(space((1.0, -2.0, -9.81))),
            cy.loads.force(arm.end, space((0.0, 30.0, 10.0)), until=0.01),
            cy.loads.moment(kite.start, lambda t: 3.0 * np.cos(50 * t) * np.array([1.0, 0.5, 0.2]), frame="body"),
            cy.loads.line_moment(arm, space((0.5, 1.0, -0.5)), start=0.005),
            cy.loads.line_force(kite, (2.0, 0.0, 1.0), frame="body"),
        ],
    )
    velocity = {"velocity": space((0.5, -1.0, 2.0)), "angular_velocity": (5.0, -3.0, 8.0)}
    return model, {"kite": velocity}


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)
def test_a_turned_problem_has_a_turned_answer(rule, rotation):
    """To round-off, whatever the rotation and the shift."""

    def run(turn, shift):
        model, start = scene(turn, shift)
        return cy.simulate(model, 0.02, 1e-4, rule=rule, save_every=0.01, initial=start, rotation=rotation)

    still = run(quaternion.identity(), np.zeros(3))
    moved = np.linalg.norm(still["kite"].position.values[-1] - still["kite"].position.values[0], axis=-1)
    assert moved.min() > 0.01

    @LAW
    @given(turns(), shifts())
    def law(turn, shift):
        other = run(turn, shift)
        for name in ("arm", "kite"):
            a, b = still[name], other[name]
            expected = np.asarray(quaternion.rotate(turn, a.position.values), dtype=float) + shift
            np.testing.assert_allclose(b.position.values, expected, rtol=0, atol=1e-11)
            turned = np.asarray(quaternion.multiply(turn, a.rotation.values), dtype=float)
            np.testing.assert_allclose(np.abs((turned * b.rotation.values).sum(axis=-1)), 1.0, rtol=0, atol=1e-12)
            velocity = np.asarray(quaternion.rotate(turn, a.velocity.values), dtype=float)
            np.testing.assert_allclose(b.velocity.values, velocity, rtol=0, atol=1e-9)
            for body in ("angular_velocity", "force", "moment", "strain", "curvature"):
                np.testing.assert_allclose(b[body].values, a[body].values, rtol=1e-9, atol=1e-8, err_msg=body)
        np.testing.assert_allclose(other.kinetic_energy.values, still.kinetic_energy.values, rtol=1e-11)

    law()
