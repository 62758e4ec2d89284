r"""A rod wound to a helix
======================

A moment that turns with the tip winds a straight rod to a helix of two coils, whatever its slenderness (Herrmann et al.
2025): bending and twist are constant, so the exact shape is known. Elements that lock would miss it the more the more
slender the rod.
"""

# %%
# A circular section of diameter l/ρ with E = 1 and G = 1/2, so that torsion is as stiff as bending.

import numpy as np

import cayley as cy
from cayley.report import figures

RADIUS, HEIGHT, COILS = 10.0, 50.0, 2
rise = HEIGHT / (2.0 * np.pi * RADIUS * COILS)
stretch = np.sqrt(1.0 + rise**2)
length, angle = 2.0 * np.pi * RADIUS * COILS * stretch, 2.0 * np.pi * COILS


def wound(slenderness, elements):
    """The equilibrium, and the largest distance of a node from the helix over the length."""
    diameter = length / slenderness
    area, bending = np.pi * diameter**2 / 4.0, np.pi * diameter**4 / 64.0
    stiffness = np.diag([0.5 * area, 0.5 * area, area, bending, bending, bending])
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=np.eye(3))
    direction = np.array([1.0, 0.0, rise]) / stretch
    rod = cy.Rod(section, length=length, elements=elements, direction=direction, normal=(0, 1, 0))
    moment = RADIUS * angle**2 / length**2 * bending * np.array([0.0, 1.0, rise])
    load = cy.loads.moment(rod.end, moment, frame="body")
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[load])
    rest = cy.equilibrium(model, rule=cy.rules.screw)
    a = np.linspace(0.0, angle, elements + 1)
    exact = RADIUS * np.stack([np.sin(a), 1.0 - np.cos(a), rise * a], axis=1)
    return rest, np.abs(rest[rod].position.values - exact).max() / length


# %%

print("published: the helix itself; ours: largest distance of a node from it over l, elements of screw")
print("l/d     elements                       distance               load steps")
for slenderness, elements in ((1e1, 10), (1e2, 10), (1e3, 10), (1e4, 64)):
    rest, error = wound(slenderness, elements)
    print(f"{slenderness:<7g} {elements:8} {error:30.1e} {rest.load_steps:24}")
    assert error < 1e-10

# %%

figure = figures.deformed(rest)
