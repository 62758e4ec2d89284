"""A cable in a current: how far a tether drifts, and which drag matters.

A tether hangs from a ship in a current that fades with the depth, with a weight at its end. It starts straight down
and drifts until drag, buoyancy and weight agree.

Insight: a load along a rod is a function of place and time, written in NumPy and compiled with the equations.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH, DIAMETER, WATER = 20.0, 0.03, 1025.0  # m, m, kg/m³
AREA = 0.25 * np.pi * DIAMETER**2

rubber = cy.Material(density=1400.0, youngs_modulus=2e7, poisson_ratio=0.45)
section = cy.Section.circle(0.5 * DIAMETER, rubber)
cable = cy.Rod(
    section,
    length=LENGTH,
    elements=16,
    direction=(0, 0, -1),
    normal=(1, 0, 0),
    damping=cy.damping.retardation(0.05),
    name="cable",
)
anchor = cy.PointMass(mass=8.0, position=(0, 0, -LENGTH), name="anchor")


def current(x, t):
    """Flow of the water [m/s]: 0.6 m/s at the surface, less below."""
    return np.stack([0.6 * np.exp(x[2] / 8.0), 0 * t, 0 * t])


model = cy.Model(
    cable,
    anchor,
    supports=[cy.supports.pin(cable.start)],
    joints=[cy.joints.ball(cable.end, anchor.centre)],
    loads=[
        cy.loads.gravity((0, 0, -9.81)),
        cy.loads.buoyancy(cable, density=WATER, area=AREA),
        cy.loads.drag(cable, density=WATER, diameter=DIAMETER, normal=1.2, tangential=0.02, velocity=current),
    ],
)
run = cy.simulate(model, t_end=30.0, dt=0.05, rule=cy.rules.midpoint, save_every=0.5)

# %%
# At the end the support carries all weight in water, and the drag of the whole cable.
places = run[cable].position.values
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.8), layout="constrained", width_ratios=(1.2, 1))
for k in (0, 4, 8, 12, 20, 60):
    left.plot(places[k, :, 0], places[k, :, 2], color=plt.cm.viridis(k / 66), label=f"{run.time[k]:g} s")
left.quiver(-1.2 * np.ones(9), -np.linspace(0, 20, 9), 2 * np.exp(-np.linspace(0, 20, 9) / 8), 0, color="0.6", scale=12)
left.set(xlabel="x [m]", ylabel="z [m]", title="the tether drifts", xlim=(-1.5, 1.6))
left.legend(fontsize=7, loc="lower right")
force = run.reaction(cable.start).force.values
right.plot(run.time, -force[:, 0], label="drag [N]")
right.plot(run.time, force[:, 2], label="weight carried [N]")
right.set(xlabel="time [s]", title="at the ship")
right.legend()
wet = (model.mass - WATER * AREA * LENGTH) * 9.81
print(f"carried {force[-1, 2]:.1f} N, weight in water {wet:.1f} N; the anchor drifts by {places[-1, -1, 0]:.2f} m")
assert abs(force[-1, 2] / wet - 1) < 0.2
plt.show()
