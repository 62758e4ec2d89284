"""The 45-degree bend
==================

An eighth of a circle of radius 100, clamped, is bent out of its plane by a dead force at its tip (Bathe and Bolourchi
1979). Axial, bending and torsional strain are all in it.
"""

# %%
# Published tips differ by more than their meshes explain: some take the polar moment 1/6 for the torsion constant of
# the unit square, others Saint-Venant's 0.141. Here are both, by four elements of degree 6.

import numpy as np

import cayley as cy
from cayley.report import figures


def bend(torsion, elements):
    """A unit square with E = 1e7 and no lateral contraction, along the arc."""
    section = cy.Section.given(
        stiffness=np.diag([5e6, 5e6, 1e7, 1e7 / 12, 1e7 / 12, 5e6 * torsion]), mass_per_length=1.0, inertia=np.eye(3)
    )
    return cy.Rod.along(
        section,
        lambda u: (100.0 * np.sin(u), 100.0 * (1.0 - np.cos(u)), 0.0),
        span=(0.0, np.pi / 4),
        elements=elements,
    )


def pulled(rod, rule):
    """The equilibrium under 600 out of the plane."""
    force = cy.loads.force(rod.end, (0, 0, 600.0))
    return cy.equilibrium(cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[force]), rule=rule)


# %%
# Exact are solutions of the continuous equations by shooting.

EXACT = {1 / 6: (47.15043857, 15.68480053, 53.47485879), 0.141: (46.89676960, 15.56032540, 53.60485846)}
PUBLISHED = {
    1 / 6: "Simo and Vu-Quoc (1986), 8 linear elements",
    0.141: "Ibrahimbegovic (1995), 8 elements of 3 nodes",
}
TIPS = {1 / 6: (47.23, 15.79, 53.37), 0.141: (46.897, 15.560, 53.605)}
for torsion, exact in EXACT.items():
    fine = bend(torsion, 4)
    rest = pulled(fine, cy.rules.galerkin(time=1, space=6))
    coarse = bend(torsion, 8)
    tips = {
        PUBLISHED[torsion]: TIPS[torsion],
        "ours, 8 elements of midpoint": pulled(coarse, cy.rules.midpoint)[coarse].position.values[-1],
        "ours, 4 elements of degree 6": rest[fine].position.values[-1],
        "exact": exact,
    }
    print(f"tip at F = 600, torsion constant {torsion:.3f}")
    for name, place in tips.items():
        print(f"  {name:46} {np.round(place, 6)}")
    assert np.abs(tips["ours, 4 elements of degree 6"] - exact).max() < 1e-6
    assert np.abs(tips["ours, 8 elements of midpoint"] - exact).max() < 0.25

# %%
# The bend, colored by the moment in it, over the plane arc.

figure = figures.deformed(rest)
