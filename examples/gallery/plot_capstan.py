"""A rope over a cylinder
======================

A rope hangs over a fixed cylinder, further down on one side. Friction holds it up to an overhang that the capstan
equation tells, with the weight of the rope on the cylinder; beyond it slides, and falls off.
"""

# %%
# With μ the coefficient of friction, R the radius to the middle of the rope and h the length that hangs on the light
# side, it holds up to e^(μπ) h + R (e^(μπ) + 1) 2μ/(1 + μ²) on the other side.

import math

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

RADIUS, ROUND, LIGHT, FRICTION = 0.001, 0.05, 0.15, 0.3
AROUND = ROUND + RADIUS
GROWTH = math.exp(FRICTION * math.pi)
HOLDS = GROWTH * LIGHT + AROUND * 2.0 * FRICTION / (1.0 + FRICTION**2) * (GROWTH + 1.0)
ROPE = cy.Section.circle(RADIUS, cy.Material(density=1000.0, youngs_modulus=3e5, poisson_ratio=0.5))


def draped(rod, light):
    """Positions and rotations of nodes: down on the left, over the cylinder, down on the right."""
    s = np.asarray(rod.nodes) - light
    angle = np.clip(s / AROUND, 0.0, math.pi)
    right = np.maximum(s - math.pi * AROUND, 0.0)
    x = np.stack([-AROUND * np.cos(angle), 0.0 * s, AROUND * np.sin(angle) + np.minimum(s, 0.0) - right], axis=1)
    turn = 0.5 * angle  # from up to down, about e2
    return {"position": x, "rotation": np.stack([np.cos(turn), 0 * s, np.sin(turn), 0 * s], axis=1)}


# %%
# The rope has no tension at the start, stretches and settles: `settle=True` damps it, as what counts is where it rests.

moved, runs = {}, {}
for overhang in (0.6, 0.8, 1.2):
    length = LIGHT + math.pi * AROUND + overhang * HOLDS
    rope = cy.Rod(ROPE, length=length, direction=(0, 0, 1), normal=(1, 0, 0), elements=140, name="rope")
    model = cy.Model(
        rope,
        obstacles=[cy.Cylinder(ROUND, 0.1, axis=(0, 1, 0), friction=FRICTION)],
        contact=cy.Contact(self_contact=False),
        loads=[cy.loads.gravity((0, 0, -9.81))],
    )
    runs[overhang] = cy.simulate(model, 1.4, save_every=0.02, initial={rope: draped(rope, LIGHT)}, settle=True)
    light_end = runs[overhang][rope].position.values[:, 0, 2]
    moved[overhang] = float(light_end[-1] - light_end[-16])
    print(f"overhang {overhang:.2f} of what holds: {1e3 * moved[overhang]:9.4f} mm in the last 0.3 s")
assert max(abs(moved[0.6]), abs(moved[0.8])) < 1e-6
assert float(runs[1.2]["rope"].position.values[:, 0, 2].max()) > 0.02  # up to the cylinder, and off

# %%
# What holds does not creep. Below, the light ends over time; forces of friction stand in ``run.dissipated``.

figure, axes = plt.subplots(figsize=(6, 3.2), layout="constrained")
for overhang, run in runs.items():
    height = run["rope"].position.values[:, 0, 2]
    axes.plot(run.time, height - height[0], label=f"{overhang:g} of what holds")
axes.set(xlabel="time [s]", ylabel="light end, risen [m]")
axes.legend(frameon=False)
