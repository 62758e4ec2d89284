"""Shear locking: why the place where strains are evaluated matters.

A thin cantilever with a force at its end, ever finer meshes, and the rules that measure strains at the corners of an
element, in its middle, and along a screw motion.

Insight: a rule at the corners bends with EI + GA ds²/4 instead of EI, predicted and found; the others do not lock at
all.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
section = cy.Section.circle(0.01, steel)
shear, bending = section.stiffness[0, 0], section.stiffness[3, 3]
exact = 1 / (3 * bending) + 1 / shear  # Timoshenko, length 1 m, force 1 N
meshes = np.array([2, 4, 8, 16, 32, 64, 128])


def deflection(rule, elements):
    """Of the end, under 1 N."""
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), elements=int(elements))
    push = cy.loads.force(rod.end, (0, 0, 1.0))
    rest = cy.equilibrium(cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[push]), rule=rule)
    return rest[rod].position.values[-1, 2]


figure, axes = plt.subplots(figsize=(6.0, 3.6), layout="constrained")
for rule, mark in ((cy.rules.nodal, "o"), (cy.rules.verlet, "s"), (cy.rules.screw, "x")):
    found = np.array([deflection(rule, n) for n in meshes]) / exact
    axes.loglog(meshes, found, mark, mfc="none", label=str(rule))
    stiffer = bending + (shear * (1 / meshes) ** 2 / 4 if rule == cy.rules.nodal else 0)
    errors = np.abs(found - bending / stiffer)
    print(f"{rule}: deflection over Timoshenko's from {found[0]:.4f} to {found[-1]:.4f}")
    assert errors[2:].max() < 0.01
locked = bending / (bending + shear / meshes**2 / 4)
axes.loglog(meshes, locked, "k-", lw=0.8, label="EI/(EI + GA ds²/4)")
axes.set(xlabel="elements", ylabel="deflection over Timoshenko's", title="steel, 1 m long, 2 cm thick")
axes.legend()
plt.show()
