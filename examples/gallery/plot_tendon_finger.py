"""A soft finger: a silicone rod, bent by a tendon beside its axis.

A tendon of tension T at the distance d from the axis bends the rod by the moment T d and presses it by T. So without
weight the finger is an arc with the curvature T d/EI, and its length shrinks by T/EA.

Insight: forces need not have an energy. A tendon is a virtual work, −T δ‖y′‖, compiled with the equations.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

silicone = cy.Material(density=1070.0, youngs_modulus=1e6, poisson_ratio=0.49)
section = cy.Section.circle(0.01, silicone)
finger = cy.Rod(section, length=0.15, direction=(0, 0, 1), normal=(1, 0, 0), elements=16, name="finger")
clamp = cy.supports.clamp(finger.start)
offset = 8e-3  # m, along d1
bending, stretching = section.stiffness[4, 4], section.stiffness[2, 2]

# %%
# Left: equilibria for rising tension, circles, without gravity. Right: a run with weight and damping.
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.6), layout="constrained", width_ratios=(1.2, 1))
errors = []
for tension in (0.0, 2.0, 4.0, 8.0, 12.0):
    pull = cy.loads.tendon(finger, tension, offset=(offset, 0, 0))
    rest = cy.equilibrium(cy.Model(finger, supports=[clamp], loads=[pull]))
    x = rest[finger].position.values
    left.plot(100 * x[:, 0], 100 * x[:, 2], "o-", ms=2.5, color=plt.cm.viridis(tension / 14), label=f"{tension:g} N")
    errors.append(np.abs(rest[finger].curvature.values[:, 1] - tension * offset / bending).max())
left.set(xlabel="x [cm]", ylabel="z [cm]", aspect="equal", title="pulled by the tendon, without weight")
left.legend(title="tension", fontsize=7)

# Pulled in half a second, with the damping of the material: the tip swings in.
soft = cy.Rod(
    section,
    length=0.15,
    direction=(0, 0, 1),
    normal=(1, 0, 0),
    elements=16,
    damping=cy.damping.ratio(0.1, frequency=5.0),
    name="soft",
)
grip = cy.loads.tendon(soft, lambda t: 4.0 * np.sin(np.pi * t) ** 2, offset=(offset, 0, 0))
model = cy.Model(soft, supports=[cy.supports.clamp(soft.start)], loads=[grip, cy.loads.gravity((0, 0, -9.81))])
run = cy.simulate(model, t_end=2.0, dt=2e-3, rule=cy.rules.midpoint, save_every=0.01)
right.plot(run.time, 4.0 * np.sin(np.pi * run.time) ** 2, color="0.6", label="tension [N]")
right.plot(run.time, 100 * run[soft].position.values[:, -1, 0], label="tip, x [cm]")
right.set(xlabel="time [s]", title="gripping twice")
right.legend()
print(f"curvature within {max(errors):.1e} 1/m of T d/EI; balance {float(abs(run.energy_balance.defect[-1])):.1e} J")
assert max(errors) < 1e-6
plt.show()
