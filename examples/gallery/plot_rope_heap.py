"""A rope dropped on the floor
===========================

A rope is let go over a floor, comes down, folds and lies on itself: contact with the floor and with itself, friction
that sticks, and a balance of energy that closes.
"""

# %%
# A bow seeds how it folds. The material damps itself a little (Kelvin-Voigt), and contacts do not bounce. The step is a
# tenth of what the library would take, so that contacts are 100 times as stiff: it lands at 2 m/s.

import numpy as np

import cayley as cy
from cayley.report import figures

rubber = cy.Material(density=1000.0, youngs_modulus=1e6, poisson_ratio=0.5)
rope = cy.Rod.through(
    cy.Section.circle(0.004, rubber),
    [(0.0, 0.0, 0.05), (0.012, 0.004, 0.25), (-0.008, 0.01, 0.45), (0.004, -0.006, 0.65)],
    elements=60,
    name="rope",
    damping=cy.damping.retardation(2e-4),
)
model = cy.Model(
    rope,
    obstacles=[cy.Plane(friction=0.5, name="floor")],
    contact=cy.Contact(friction=0.3, damping=0.3, penetration=0.02),
    loads=[cy.loads.gravity((0, 0, -9.81))],
)
run = cy.simulate(model, 0.6, dt=2e-5, save_every=0.01, balance=True)
print(run.contacts.isel(time=-1))
print(run.contacts_at(-1)[["first", "second", "depth", "force"]])

# %%
# Energy, with what friction and damping took: their sum changes by the ripple of the rule alone.

balance = run.energy_balance
print(f"dissipated {float(balance.dissipated[-1]):.4f} J, defect {float(np.abs(balance.defect).max()):.1e} J")
assert float(np.abs(balance.defect).max()) < 0.02 * float(balance.dissipated[-1])
assert float(run.contacts.deepest[-1]) < 0.1

figure = run.plot.snapshots()
figures.balance(run)
