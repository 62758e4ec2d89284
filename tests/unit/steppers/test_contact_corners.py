"""Where rods cross at a node they touch as in the middle of an element: once, and nothing pushes off along a rod."""

import numpy as np
import pytest

import cayley as cy
from cayley.steppers.contacts import TOLD, at_start, view
from cayley.system.discretize import discretize

SECTION = cy.Section.circle(5e-3, cy.Material(density=1000.0, youngs_modulus=1e9, poisson_ratio=0.5))
BEND = 0.05


def pushed(elements, off):
    """Contacts, and the force across over that up, on a straight rod pressed up into an arc, off its middle."""
    upper = cy.Rod.along(
        SECTION, lambda u: (0.0, BEND * np.sin(u), BEND * np.cos(u) - BEND), span=(-1.0, 1.0), elements=elements
    )
    height = -0.01 - BEND / elements**2 / 2 + 1e-4
    lower = cy.Rod(SECTION, length=0.2, direction=(1, 0, 0), origin=(-0.1, off, height), elements=7, name="lower")
    contact = cy.Contact(self_contact=False, stiffness=1e3)
    system = discretize(cy.Model(upper, lower, contact=contact), cy.rules.verlet)
    force = at_start(system, system.reference, 1.0)[TOLD:].reshape(system.size, -1)[elements + 1 :]
    across, up = force[:, system.layout.dofs_of("x")].sum(axis=0)[1:]
    return len(view(system, system.reference, 1.0)), across / abs(up)


@pytest.mark.parametrize("elements", [20, 21], ids=["at a node", "between nodes"])
@pytest.mark.parametrize("off", [1e-6, 1e-5, 1e-4])
def test_the_hollow_of_an_arc_holds_what_is_pressed_into_it(elements, off):
    count, across = pushed(elements, off)
    assert count == 1
    assert across == pytest.approx(-off / (BEND - 0.01), rel=0.5)
