"""A twisted beam
==============

A straight beam whose sections turn by a right angle from the clamp to the tip: a force straight down also pushes it
aside (Wang et al. 2017, BeamDyn).
"""

# %%
# The sections turn by ``twist`` along the rod; the reference, twisted, has no stress.

import numpy as np

import cayley as cy
from cayley.report import figures

stiffness = np.diag([8.2604167e9, 8.2604167e9, 2.5e10, 5.20833e8, 1.30208333e8, 1.41872656e8])
section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=np.eye(3))


def pressed(elements, rule):
    """A rod and its equilibrium under 4 MN at the tip."""
    rod = cy.Rod.along(
        section, lambda u: (u, 0.0, 0.0), span=(0.0, 10.0), elements=elements, normal=(0, 1, 0), twist=np.pi / 2
    )
    force = cy.loads.force(rod.end, (0, 0, -4e6))
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[force])
    return cy.equilibrium(model, rule=rule)["rod"].position.values[-1] - (10.0, 0.0, 0.0), model


# %%

exact = np.array([-1.14152599953942, -1.71805334646388, -3.59321324026952])
cubic, _ = pressed(16, cy.rules.galerkin(time=1, space=3))
tip, model = pressed(4, cy.rules.galerkin(time=1, space=6))
print("tip displacement [m]")
print("published, ANSYS solid          -1.134192 -1.714467 -3.58423")
print("published, BeamDyn             ", *exact)
print("ours, 16 elements of degree 3  ", *cubic)
print("ours, 4 elements of degree 6   ", *tip)
assert np.abs(tip - exact).max() < 1e-10
assert np.abs(cubic - exact).max() < 1e-7

# %%

figure = figures.deformed(cy.equilibrium(model, rule=cy.rules.galerkin(time=1, space=3)))
