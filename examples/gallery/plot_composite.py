"""A composite beam
================

A cantilever whose section couples bending and torsion bends aside and twists under a force straight up (Wang et al.
2017, BeamDyn).
"""

# %%
# Stiffness is published in the order axial, shear 2, shear 3, torsion, bending 2, bending 3; ours is shear, shear,
# axial, bending, bending, torsion.

import numpy as np

import cayley as cy
from cayley.report import figures

published = np.diag([1368.17e3, 88.56e3, 38.78e3, 0.0, 0.0, 0.0])
published[3:, 3:] = 1e3 * np.array([[16.96, 17.61, -0.351], [17.61, 59.12, -0.370], [-0.351, -0.370, 141.47]])
ours = [1, 2, 0, 4, 5, 3]
section = cy.Section.given(stiffness=published[np.ix_(ours, ours)], mass_per_length=1.0, inertia=np.eye(3))
rod = cy.Rod(section, length=10.0, elements=4, direction=(1, 0, 0), normal=(0, 1, 0))
model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[cy.loads.force(rod.end, (0, 0, 150.0))])
rest = cy.equilibrium(model, rule=cy.rules.galerkin(time=1, space=6))

# %%

tip = rest[rod].position.values[-1] - (10.0, 0.0, 0.0)
exact = np.array([-9.02726627566299e-2, -6.47488486259036e-2, 1.22973648292371])
print("tip displacement [m]")
print("published, BeamDyn            ", *exact)
print("ours, 4 elements of degree 6  ", *tip)
assert np.abs(tip - exact).max() < 1e-10

# %%

figure = figures.deformed(rest)
