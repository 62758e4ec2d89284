"""Sweep: the same pendulum in twelve stiffnesses, from a string to a stick.

A sweep is a loop. The equations are compiled once, for the density and the rule stay the same, and taken from the
cache for every other stiffness; each run takes milliseconds.

Insight: bending stiffness matters where the rod bends under its own weight, at E I ≈ m g ℓ³, and nowhere else.
"""

import time

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy


def swing(modulus):
    """The first second of a rubber rod, let go from the horizontal; its lowest tip and its place at the end."""
    rubber = cy.Material(density=1100.0, youngs_modulus=modulus, poisson_ratio=0.5)
    section = cy.Section.circle(5e-3, rubber)
    rod = cy.Rod(section, length=1.0, elements=20, direction=(1, 0, 0), normal=(0, 1, 0))
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
    run = cy.simulate(model, t_end=0.75, dt=2e-3, rule=cy.rules.midpoint, save_every=0.05)
    group = section.stiffness[3, 3] / (section.mass_per_length * 9.81)  # EI/(m g ℓ³), ℓ = 1 m
    return group, run[rod].position.values


moduli = np.geomspace(3e5, 3e9, 12)
began = time.perf_counter()
found = [swing(modulus) for modulus in moduli]
print(f"{len(moduli)} runs in {time.perf_counter() - began:.1f} s, the compilation in it")
groups = np.array([group for group, _ in found])

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.6), layout="constrained")
for k, (_, places) in enumerate(found):
    color = plt.cm.viridis(k / len(found))
    left.plot(places[6, :, 0], places[6, :, 2], color=color, lw=1.5)
left.set(xlabel="x [m]", ylabel="z [m]", aspect="equal", title="at 0.3 s, from soft (dark) to stiff")
chords = [np.linalg.norm(places[:, -1], axis=1).min() for _, places in found]
right.semilogx(groups, chords, "o-")
right.set(xlabel="EI/(m g ℓ³)", ylabel="shortest distance of the ends [m]", title="how much it bends on its way")
assert chords[-1] > 0.999
assert chords[0] < 0.97
plt.show()
