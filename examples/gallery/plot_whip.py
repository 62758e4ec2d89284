"""The crack of a whip: why the tip of a tapered rod is so much faster than the hand.

A whip tapers from 12 mm to 2 mm. Its handle is turned through 200 degrees in a quarter of a second; the loop runs
out to the tip and grows faster as there is less and less mass to carry the energy.

Insight: sections that change along a rod are a function; damping is that of the material, so the mesh does not ring.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH = 1.5  # m
leather = cy.Material(density=900.0, youngs_modulus=5e7, poisson_ratio=0.4)


def section(s):
    """Radius 6 mm at the handle, 1 mm at the tip."""
    return cy.Section.circle(6e-3 - 5e-3 * s / LENGTH, leather)


def turn(t):
    """Angle of the handle [rad]: 200 degrees in 0.25 s, smoothly."""
    part = min(t / 0.25, 1.0)
    return np.radians(200) * part**3 * (10 - 15 * part + 6 * part**2)


whip = cy.Rod(
    section,
    length=LENGTH,
    elements=60,
    direction=(1, 0, 0),
    normal=(0, 1, 0),
    damping=cy.damping.retardation(1e-3),
    name="whip",
)
handle = cy.supports.turn(whip.start, (0, 1, 0), angle=turn)
run = cy.simulate(cy.Model(whip, supports=[handle]), t_end=0.6, dt=5e-4, rule=cy.rules.midpoint, save_every=2e-3)

# %%
x, v = run[whip].position.values, np.linalg.norm(run[whip].velocity.values, axis=-1)
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.6), layout="constrained", width_ratios=(1.3, 1))
for k in range(0, len(x), 25):
    left.plot(x[k, :, 0], x[k, :, 2], color=plt.cm.viridis(k / len(x)), lw=1.5, label=f"{run.time[k]:.2f} s")
left.set(xlabel="x [m]", ylabel="z [m]", aspect="equal")
left.legend(fontsize=6.5, ncols=2)
for node, name in ((6, "near the handle"), (30, "middle"), (54, "nine tenths"), (60, "tip")):
    right.plot(run.time, v[:, node], label=name)
right.set(xlabel="time [s]", ylabel="speed [m/s]")
right.legend(fontsize=7)
print(f"fastest tip {v[:, -1].max():.0f} m/s, near the handle at most {v[:, 6].max():.1f} m/s")
assert v[:, -1].max() > 5 * v[:, 6].max()
plt.show()
