"""Runs against modes: a small displacement along a mode rings at its frequency, to the order of the rule."""

import numpy as np
import pytest

import cayley as cy
from cayley import joints, loads, supports

STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
BAR = cy.Section.rectangle(width=0.02, height=0.03, material=STEEL)
GRAVITY = loads.gravity((0, 0, -9.81))


def rung(signal, times):
    """ω_h of x_(n+1) + x_(n−1) = 2 cos(ω_h h) x_n, by least squares; h between frames."""
    h = times[1] - times[0]
    middle, around = signal[1:-1], signal[2:] + signal[:-2]
    return np.arccos(0.5 * (middle @ around) / (middle @ middle)) / h


def cantilever(weight):
    rod = cy.Rod(BAR, length=1.0, direction=(1, 0, 0), elements=4, name="beam")
    return cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[GRAVITY] if weight else [])


@pytest.mark.parametrize(("rule", "discrete"), [(cy.rules.midpoint, np.arctan), (cy.rules.verlet, np.arcsin)], ids=str)
def test_a_bent_beam_rings_at_its_modes(rule, discrete):
    """ω_h = (2/h) arctan(ω h/2) of midpoint and (2/h) arcsin(ω h/2) of verlet, both ω + O(h²)."""
    model = cantilever(weight=True)
    rest = cy.equilibrium(model, rule=rule)
    modes = cy.modes(model, about=rest, count=4)
    for k in (0, 3):
        omega = float(modes.angular_frequency[k])
        h = 0.1 / omega if rule is cy.rules.midpoint else None
        run = cy.simulate(model, start=modes.state(k, 1e-6, 0.3), t_end=2.0 * np.pi / omega, dt=h, rule=rule)
        signal = (run["beam"].position.isel(node=-1) - rest["beam"].position.isel(node=-1)).values
        largest = signal[:, np.argmax(np.abs(signal).max(axis=0))]
        expected = 2.0 / run.dt * discrete(0.5 * omega * run.dt)
        assert np.abs(largest).max() == pytest.approx(1e-6, rel=0.02)
        assert rung(largest, run.time) == pytest.approx(expected, rel=3e-6)
        if h:
            assert abs(expected / omega - 1.0) > 1e-4  # so the rule's own error is what was tested


def test_a_turning_beam_rings_at_its_modes():
    """A beam driven at its root: seen from the frame that turns with it, its tip moves with the gyroscopic mode."""
    spin = 60.0
    held = cantilever(weight=False)
    rod = held.rods[0]
    modes = cy.modes(held, count=2, spin=spin)
    hinge = joints.hinge(rod.start, cy.ground, axis=(0, 0, 1), angle=lambda t: spin * t, name="hub")
    driven = held.replace(supports=[], joints=[hinge])
    for k in range(2):
        omega = float(modes.angular_frequency[k])
        h = 0.02 / omega
        run = cy.simulate(driven, start=modes.state(k, 1e-3), t_end=2.0 * np.pi / omega, dt=h, rule=cy.rules.midpoint)
        tip, angle = run["beam"].position.isel(node=-1).values, spin * run.time
        turned = np.stack([np.cos(angle) * tip[:, 1] - np.sin(angle) * tip[:, 0], tip[:, 2]])
        signal = turned[np.argmax(np.abs(turned).max(axis=1))]
        assert np.abs(signal).max() == pytest.approx(1e-3, rel=0.02)
        assert rung(signal, run.time) == pytest.approx(omega, rel=3e-4)


@pytest.mark.parametrize("rule", [cy.rules.midpoint, cy.rules.verlet], ids=str)
def test_a_run_from_an_equilibrium_stays_there_for_ever(rule):
    bob = cy.Body(mass=1.0, inertia=[0.1, 0.1, 0.05], position=(0, 0, -0.5), ports={"pivot": (0, 0, 0.5)}, name="bob")
    model = cy.Model(bob, joints=[joints.ball(bob.port("pivot"), cy.ground)], loads=[GRAVITY])
    rest = cy.equilibrium(model, rule=rule)
    run = cy.simulate(model, start=rest, t_end=100.0, dt=1e-3, rule=rule, save_every=1.0)
    assert run.steps == 100_000
    assert np.abs(run[bob].position.values - rest[bob].position.values).max() < 1e-12
