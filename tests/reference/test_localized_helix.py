"""The localized helix into which a long twisted rod buckles, against the homoclinic solution."""

import numpy as np
import pytest

import cayley as cy
from cayley import joints, supports
from cayley.lie import quaternion

BEND, TWIST, LENGTH, TURNS = 1.345, 0.789, 100.0, 27
STRETCH = 1e3
"""Stiffness in shear and stretch, of which the closed form has none [N]."""


def test_a_twisted_rod_buckles_into_a_localized_helix():
    """cos φ = 1 − (r²/2t)/cosh²(π r (s/L − ½)), r² = 4t − m², m = M L/2πB, t = T L²/4π²B; slack L r/πt.

    80 elements of degree 3. Source: G. H. M. van der Heijden and J. M. T. Thompson, Nonlinear Dynamics 21 (2000);
    data of the example HelicalBucklingCase of PyElastica.
    """
    stiffness = np.diag([STRETCH] * 3 + [BEND, BEND, TWIST])
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=np.diag([0.1, 0.1, 0.2]))
    rod = cy.Rod(section, length=LENGTH, direction=(0, 0, 1), elements=80, name="rod")
    angle = 2.0 * np.pi * TURNS

    def rotation(s):
        half = 0.5 * angle * s / LENGTH
        return np.cos(half), 0.0, 0.0, np.sin(half)

    chuck = joints.cylindrical(
        rod.end,
        cy.ground,
        axis=(0, 0, 1),
        angle=lambda t: angle * min(t / 0.01, 1.0),
        displacement=lambda t: 0.1 * min(t / 0.01, 1.0) - max(t - 0.02, 0.0),
    )
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], joints=[chuck])
    rule = cy.rules.galerkin(time=1, space=3)
    begin = {rod: {"rotation": rotation, "position": lambda s: (0.0, 0.0, s * (1.0 + 0.1 / LENGTH))}}
    straight = cy.trace(model, chuck, range=(0.015, 0.087), initial=begin, rule=rule, step=0.2)
    first = straight.bifurcations[0]
    assert first.change == 2
    slack = straight.branch(first, range=(0.015, 3.1), step=2.0, turn=2.0, points=45)
    moment, tension = -slack.joint(chuck).moment.values[-1, 2], -slack.joint(chuck).force.values[-1, 2]
    m, t = abs(moment) * LENGTH / (2.0 * np.pi * BEND), abs(tension) * LENGTH**2 / (4.0 * np.pi**2 * BEND)
    r = np.sqrt(4.0 * t - m**2)
    axis = np.asarray(quaternion.rotate(slack[rod].rotation.values[-1], np.array([0.0, 0.0, 1.0])))[:, 2]
    s = slack[rod].s.values / LENGTH - 0.5
    assert axis.min() < 0.95
    assert np.abs(axis - (1.0 - r**2 / (2.0 * t) / np.cosh(np.pi * r * s) ** 2)).max() < 1e-2
    end = slack[rod].position.values[-1, -1, 2] - abs(tension) * LENGTH / STRETCH
    assert LENGTH - end == pytest.approx(LENGTH * r / (np.pi * t), rel=1e-2)
    assert np.all(slack.unstable[1:] == 0)
