r"""A rod that spins steadily
=========================

Seen from a frame that turns with it, a spinning rod is at rest: ``cy.equilibrium(model, spin=...)`` finds how far it
stretches. The robot arm of Simo and Vu-Quoc (1988) turns at 6 rad/s in the end; by the linear law of its axial
stiffness the tip moves out by :math:`\tan(bl)/b - l`, :math:`b = \Omega\sqrt{\rho A/EA}`.
"""

# %%
# Eight elements of degree 3.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH, AXIAL, MASS = 10.0, 2.8e7, 1.2
section = cy.Section.given(
    stiffness=np.diag([1e7, 1e7, AXIAL, 1.4e4, 1.4e4, 1.4e4]),
    mass_per_length=MASS,
    inertia=np.diag([6e-4, 6e-4, 1.2e-3]),
)
rod = cy.Rod(section, length=LENGTH, elements=8, direction=(1, 0, 0), normal=(0, 1, 0))
model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)])
rule = cy.rules.galerkin(time=1, space=3)

# %%

speeds, stretch = np.linspace(1.0, 60.0, 8), []
for speed in speeds:
    stretch.append(cy.equilibrium(model, spin=speed, rule=rule)[rod].position.values[-1, 0] - LENGTH)
rates = speeds * np.sqrt(MASS / AXIAL)
exact = np.tan(rates * LENGTH) / rates - LENGTH
rest = cy.equilibrium(model, spin=6.0, rule=rule)
found = rest[rod].position.values[-1, 0] - LENGTH

print(rest)
print("stretch at 6 rad/s [m]")
print("published                     5.14e-4 (Simo and Vu-Quoc 1988), exact 5.14317e-4")
print(f"ours, 8 elements of degree 3  {found:.6e}")
assert abs(found / 5.14317e-4 - 1.0) < 1e-4
assert np.abs(np.array(stretch) / exact - 1.0).max() < 1e-5

# %%
# A run from here goes on turning: ``cy.simulate(model, start=rest, ...)`` begins with the velocities of the frame.

figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
axes.plot(speeds, 1e3 * exact, label="tan(bl)/b - l")
axes.plot(speeds, 1e3 * np.array(stretch), "o", mfc="none", label="cy.equilibrium")
axes.set(xlabel="speed [rad/s]", ylabel="stretch of the tip [mm]")
axes.legend()
