"""The falling slinky: let go at the top, its lower end stays where it is until the news arrives.

A soft spring hangs at rest and is released. The lower end is in equilibrium with the spring above it, and goes on
hanging in the air until the wave of release has run down. The center of mass falls freely all the while.

Insight: an equilibrium is a start for a run, `simulate(..., start=rest)`, and the model may have lost a support.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

GRAVITY, MASS, STIFFNESS, LENGTH = 9.81, 0.2, 1.0, 0.1  # m/s², kg, N (k ℓ), m
bar = cy.Section.given(
    stiffness=np.diag([10.0, 10.0, STIFFNESS, 1e-3, 1e-3, 1e-3]),
    mass_per_length=MASS / LENGTH,
    inertia=1e-4 * np.eye(3),
)
slinky = cy.Rod(bar, length=LENGTH, elements=40, direction=(0, 0, -1), name="slinky")
weight = cy.loads.gravity((0, 0, -GRAVITY))
hanging = cy.Model(slinky, supports=[cy.supports.clamp(slinky.start)], loads=[weight])
rest = cy.equilibrium(hanging)
arrival = np.sqrt(LENGTH * MASS / STIFFNESS)  # ℓ/√(EA/m): a wave in the material
run = cy.simulate(hanging.replace(supports=[]), t_end=1.2 * arrival, start=rest, save_every=arrival / 100)

# %%
height = run[slinky].position.sel(axis="z").values
weights = np.full(41, 1 / 40)
weights[[0, -1]] *= 0.5
center = height @ weights
figure, axes = plt.subplots(figsize=(7.4, 3.4), layout="constrained")
axes.plot(run.time, height[:, ::4], color="0.75", lw=0.8)
axes.plot(run.time, height[:, 0], label="upper end")
axes.plot(run.time, height[:, -1], label="lower end")
axes.plot(run.time, center, "k--", label="center of mass")
axes.axvline(arrival, color="k", lw=0.6)
axes.annotate("the wave arrives", (arrival, height[0, -1]), (0.55 * arrival, height[0, -1] + 0.012))
axes.set(xlabel="time [s]", ylabel="height [m]")
axes.legend()
fall = np.abs(center - center[0] + 0.5 * GRAVITY * run.time**2).max()
quiet = np.abs(height[run.time < 0.8 * arrival, -1] - height[0, -1]).max()
print(f"center falls freely within {fall:.0e} m; the lower end moves by {quiet:.1e} m until 0.8 of the arrival")
assert fall < 1e-10
assert quiet < 1e-3 * LENGTH
plt.show()
