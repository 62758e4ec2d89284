"""Stop, save, open, go on: the second half of a run is the same, bit for bit.

A run is saved with its model and its last state. Opened in another process, it goes on as if it had never stopped.

Insight: the state of a variational integrator is positions and momenta. There is no history and no starting step.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
rod = cy.Rod(cy.Section.circle(5e-3, rubber), length=1.0, elements=20, direction=(1, 0, 0), name="rod")
model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])

whole = cy.simulate(model, t_end=1.0, save_every=0.01)
first = cy.simulate(model, t_end=0.5, save_every=0.01)

# %%
# The store is a folder. What is opened has its system and its last state in it.
with tempfile.TemporaryDirectory() as folder:
    first.save(Path(folder) / "half.zarr")
    opened = cy.Trajectory.open(Path(folder) / "half.zarr")
second = cy.integrate(opened.system, opened.state, t_end=1.0, save_every=0.01)

# %%
figure, axes = plt.subplots(figsize=(7.4, 3.0), layout="constrained")
for run, style, name in ((whole, "k-", "in one go"), (first, "o", "first half"), (second, "s", "second half")):
    axes.plot(run.time, run.data["x"].values[:, -1, 2], style, ms=3, lw=0.8, label=name)
axes.set(xlabel="time [s]", ylabel="height of the tip [m]")
axes.legend()
same = np.array_equal(second.data["x"].values[-1], whole.data["x"].values[-1])
print("the end is the same, bit for bit:", same)
assert same
plt.show()
