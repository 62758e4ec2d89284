"""Residual bending flexibility: what it must be exact for, and what it leaves as it is."""

import numpy as np
import pytest

import cayley as cy

STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
SECTION = cy.Section.rectangle(0.02, 0.01, STEEL)


def deflection(elements, spacing=None, *, rule=cy.rules.midpoint, residual_bending=True):
    """Of the tip of a cantilever under a small force, and by Timoshenko."""
    rod = cy.Rod(SECTION, length=1.0, elements=elements, spacing=spacing, residual_bending=residual_bending)
    force = 1e-3
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[cy.loads.force(rod.end, (force, 0, 0))])
    tip = cy.equilibrium(model, rule=rule)[rod].position.values[-1, 0]
    stiffness = np.diag(SECTION.stiffness)
    return tip, force / 3.0 / stiffness[4] + force / stiffness[0]


@pytest.mark.parametrize("spacing", [None, (1.0, 2.0, 0.5)])
def test_a_straight_cantilever_is_exact_at_its_nodes(spacing):
    elements = 3 if spacing else 1
    tip, exact = deflection(elements, spacing)
    assert tip == pytest.approx(exact, rel=1e-7)
    without, _ = deflection(elements, spacing, residual_bending=False)
    assert abs(without / exact - 1.0) > 0.02


def test_the_limit_is_the_same_and_the_step_longer():
    limits, tips = [], []
    for residual_bending in (False, True):
        rod = cy.Rod(
            cy.Section.circle(5e-3, cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)),
            length=1.0, elements=24, direction=(1, 0, 0), normal=(0, 1, 0), residual_bending=residual_bending,
        )  # fmt: skip
        model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
        run = cy.simulate(model, 0.5, save_every=0.5)
        limits.append(run.dt), tips.append(run[rod].position.values[-1, -1])
    assert limits[1] > 2.5 * limits[0]
    assert np.linalg.norm(tips[1] - tips[0]) < 5e-3


def test_what_it_does_not_go_with_is_told():
    with pytest.raises(ValueError, match=r"residual_bending .*unshearable"):
        cy.Rod(SECTION, length=1.0, elements=4, kinematics="unshearable", residual_bending=True)
    with pytest.raises(TypeError, match="residual_bending"):
        cy.Rod(SECTION, length=1.0, elements=4, residual_bending=1)
    rod = cy.Rod(SECTION, length=1.0, elements=4, residual_bending=True)
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
    with pytest.raises(ValueError, match=r"residual_bending, but elements of degree 2"):
        cy.simulate(model, 0.1, 0.01, rule=cy.rules.galerkin(time=1, space=2))
