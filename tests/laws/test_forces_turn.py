"""Damping and loads along rods prefer no frame: a turned, shifted problem has the same answer, turned and shifted."""

import numpy as np
import pytest
from hypothesis import given, settings

import cayley as cy
from cayley import damping, loads
from cayley.lie import quaternion
from laws.test_frame_indifference import SECTION, shifts, turns

LAW = settings(deadline=None, max_examples=8, derandomize=True)


def run(rule, turn, shift):
    """A damped rod in a stream with gravity, lift, tendon, muscle, pressure and friction of its own."""

    def space(v):
        return np.asarray(quaternion.rotate(turn, np.asarray(v, dtype=float)), dtype=float)

    rod = cy.Rod(
        SECTION,
        length=1.0,
        elements=4,
        origin=shift,
        direction=space((0.6, 0, 0.8)),
        normal=space((0, 1, 0)),
        damping=damping.rayleigh((0.1, 3.0), (0.1, 30.0)) + damping.viscous(1e-3 * np.arange(1.0, 7.0)),
        name="rod",
    )
    acting = [
        loads.gravity(space((1.0, -2.0, -9.81))),
        loads.drag(rod, density=500.0, diameter=0.06, tangential=0.3, velocity=space((1.0, 2.0, -0.5))),
        loads.buoyancy(rod, density=500.0, area=0.0024),
        loads.tendon(rod, lambda t: 200.0 * t, offset=lambda s: np.stack([0.02 * s, 0.01 + 0 * s, 0 * s])),
        loads.imposed_strain(rod, (0.01, 0, 0.02, 0.3, -0.2, 0.5), amount=lambda s, t: t * (1 + s)),
        loads.pressure(rod, 30.0, axis="d2"),
        loads.distributed(rod, space((3.0, 1.0, 2.0)), moment=True),
        loads.density(rod, lambda q, c: [(-c.k * cy.norm(q.p_t) * q.p_t, q.p)], k=0.01),
    ]
    start = {"rod": {"velocity": space((0.5, -1.0, 2.0)), "angular_velocity": (2.0, -3.0, 1.0)}}
    return cy.simulate(cy.Model(rod, loads=acting), 0.05, 1e-4, rule=rule, save_every=0.025, initial=start)


@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.screw], ids=str)
def test_a_turned_problem_has_a_turned_answer(rule):
    still = run(rule, quaternion.identity(), np.zeros(3))
    assert np.abs(still["rod"].position.values[-1] - still["rod"].position.values[0]).max() > 0.02

    @LAW
    @given(turns(), shifts())
    def law(turn, shift):
        other = run(rule, turn, shift)
        place = np.asarray(quaternion.rotate(turn, still["rod"].position.values), dtype=float) + shift
        np.testing.assert_allclose(other["rod"].position.values, place, atol=1e-10)
        np.testing.assert_allclose(other["rod"].strain.values, still["rod"].strain.values, atol=1e-9)
        np.testing.assert_allclose(other.dissipated.values, still.dissipated.values, rtol=1e-9, atol=1e-10)
        np.testing.assert_allclose(other.work.values, still.work.values, rtol=1e-9, atol=1e-10)

    law()
