"""Where the energy goes: a cantilever in air and of viscous rubber, pushed for a moment.

Work of the push, energy of the rod, and what its material and the air have taken: they add up, at every time.

Insight: damping is a force in the equations and never a property of the rule, so the balance is a check on the whole
run.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
damping = cy.damping.ratio(0.03, frequency=5.0)
arm = cy.Rod(cy.Section.circle(0.02, rubber), length=0.6, direction=(0, 0, 1), elements=8, damping=damping, name="arm")
push = cy.loads.force(arm.end, lambda t: (3.0 * np.sin(np.pi * t / 0.3), 0, 0), until=0.3)
air = cy.loads.drag(arm, density=1.2, diameter=0.04)
model = cy.Model(arm, supports=[cy.supports.clamp(arm.start)], loads=[push, air])
run = cy.simulate(model, t_end=3.0, save_every=0.01)
balance = run.energy_balance

# %%
figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.4, 4.4), sharex=True, height_ratios=(3, 1), layout="constrained")
top.stackplot(
    run.time,
    run.kinetic_energy.values,
    run.potential_energy.values - float(run.potential_energy[0]),
    balance.dissipated.values,
    labels=("kinetic", "potential", "dissipated"),
    colors=("#0072B2", "#56B4E9", "#E69F00"),
    alpha=0.8,
)
top.plot(run.time, balance.work, "k--", label="work of the push")
top.set(ylabel="energy [J]")
top.legend(loc="lower right", ncols=2, facecolor="w", frameon=True)
bottom.plot(run.time, 1e6 * balance.defect.values)
bottom.set(xlabel="time [s]", ylabel="defect [µJ]")
worst = float(abs(balance.defect).max())
print(f"work {float(balance.work[-1]):.4f} J, dissipated {float(balance.dissipated[-1]):.4f} J, defect {worst:.1e} J")
assert worst < 1e-3 * float(balance.work[-1])
plt.show()
