"""Shear locking of corner evaluation: a clamped rod against Timoshenko, in statics, in frequencies and in motion.

At a straight rod the strain energy of an element with linear w and θ is, for the rule's quadrature of the shear w′ − θ,
that of an element without locking whose bending stiffness is EI + GA ds²/4 (corners), EI + GA ds²/12 (two Gauss points)
or EI (middle).
"""

import numpy as np
import pytest

import cayley as cy
from reference.straight_rod import (
    STIFFENING,
    frequencies,
    predicted_compliance,
    slender,
    stiffnesses,
    tip_compliance,
)
from verify.problems import assert_order


@pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)
@pytest.mark.parametrize("elements", [5, 10, 20, 40])
def test_static_tip_deflection(rule, elements):
    """Exactly the predicted one."""
    section = slender(0.02)
    ratio = tip_compliance(section, 1.0, elements, rule) / predicted_compliance(section, 1.0, elements, rule)
    assert abs(ratio - 1.0) < 1e-9


def test_the_beam_of_the_paper_is_368_times_too_stiff():
    """Table 1 has ds = 2/11 m and bars of 10 mm: 1 + GA ds²/(4 EI)."""
    rubber = cy.Material(density=1000.0, youngs_modulus=5e6, poisson_ratio=0.35)
    section = cy.Section.rectangle(0.01, 0.01, rubber, shear_correction=1.0)
    nodal, verlet = (tip_compliance(section, 2.0, 11, rule) for rule in (cy.rules.nodal, cy.rules.verlet))
    bending, shear = stiffnesses(section)
    factor = 1.0 + shear * (2.0 / 11) ** 2 / (4.0 * bending)
    assert abs(factor - 368.0) < 1.0
    assert abs(verlet / nodal / factor - 1.0) < 0.02


@pytest.mark.parametrize(
    ("slenderness", "expected"),
    [(0.02, (3.502641, 21.469824, 58.149832)), (0.04, (3.463579, 20.014730, 50.561942))],
)
def test_clamped_free_frequencies(slenderness, expected):
    """Timoshenko's ω √(ρA l⁴/EI), r = √(I/A)/l, ν = 0.3, κ = 5/6: order 2; nodal is off by GA ds²/(8 EI)."""
    section = slender(2.0 * slenderness)
    unit = np.sqrt(section.stiffness[3, 3] / section.mass_per_length)
    exact = np.array(expected) * unit
    for rule, within in ((cy.rules.verlet, 2e-5), (cy.rules.nodal, 4e-3)):
        errors = np.array([frequencies(section, 1.0, n, rule)[:3] / exact - 1.0 for n in (40, 80, 160)])
        assert np.abs(errors[-1]).max() < within
        for mode in range(3):
            assert_order(np.abs(errors[:, mode]), within=0.2)


@pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)
def test_first_frequency_of_a_run(rule):
    """A small bend, let go: the tip swings with the frequency predicted for the stiffness EI + GA ds²/4."""
    section, elements = slender(0.02), 10
    bending, shear = stiffnesses(section)
    shown = bending + shear / elements**2 / STIFFENING[rule.name]
    softened = 1.0 / np.sqrt(1.0 + 3.0 * shown / shear)  # the shear deflection, by the static ratio at the tip
    expected = 3.516015 * np.sqrt(shown / section.mass_per_length) * softened
    rod = cy.Rod(section, length=1.0, elements=elements)
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)])
    start = {rod: {"velocity": lambda s: (0.0, 1e-4 * s**2 * (6.0 - 4.0 * s + s**2), 0.0)}}
    run = cy.simulate(model, 20.0, rule=rule, save_every=2e-3, initial=start)
    tip = run[rod].position.values[:, -1, 1]
    up = np.flatnonzero((tip[:-1] < 0) & (tip[1:] >= 0))
    crossing = run.time[up] - tip[up] * (run.time[up + 1] - run.time[up]) / (tip[up + 1] - tip[up])
    found = 2.0 * np.pi * (len(crossing) - 1) / (crossing[-1] - crossing[0])
    discrete = frequencies(section, 1.0, elements, rule)[0]
    assert abs(found / discrete - 1.0) < 1e-3
    assert abs(found / expected - 1.0) < 0.02
