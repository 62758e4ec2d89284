r"""The heavy top, a body on a ball joint
=====================================

The fast top of Brüls, Cardona and Arnold (2012), 15 kg that spin with 150 rad/s, after 0.2 s and 2 s: beside ours are
what EXUDYN and Kynema print. The script ``heavy_top.py`` writes its Lagrangian down; here it is a body whose tip is
held by a ball joint.
"""

# %%
# The mass center is 1 m from the pivot.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

CENTER, OMEGA = np.array([0.0, 1.0, 0.0]), np.array([0.0, 150.0, -4.61538])
body = cy.Body(mass=15.0, inertia=[0.234375, 0.46875, 0.234375], position=CENTER, ports={"tip": -CENTER}, name="top")
weight = cy.loads.gravity((0, 0, -9.81))
model = cy.Model(body, joints=[cy.joints.ball(body.port("tip"))], loads=[weight])
start = {body: {"angular_velocity": OMEGA, "velocity": np.cross(OMEGA, CENTER)}}


def spun(rule, dt, t_end):
    """The run."""
    return cy.simulate(model, t_end, dt, rule=rule, initial=start, save_every=0.01)


def apart(found, wanted):
    """Largest difference of two unit quaternions, p and -p being the same rotation."""
    return min(np.abs(found - wanted).max(), np.abs(found + wanted).max())


# %%
# The rule ``galerkin(time=4)``, of order 8, takes steps of 1 ms: a fortieth of a turn.

run = spun(cy.rules.galerkin(time=4), 1e-3, 2.0)
rotation, place = run[body].rotation, run[body].position
EXUDYN = {  # rotation at 0.2 s
    "EXUDYN, Runge-Kutta of order 4": (-0.70828, 0.43878, 0.54573, 0.0894),
    "EXUDYN, generalized alpha, 0.1 ms": (-0.70813, 0.43881, 0.54593, 0.089251),
}
early = rotation.sel(time=0.2, method="nearest").values
early = -early * np.sign(early[0])  # p and -p are the same rotation; published are w < 0
print("rotation at 0.2 s: w, x, y, z")
for name, published in EXUDYN.items():
    print(f"{name:34}", " ".join(f"{one:11.6f}" for one in published))
print(f"{'ours, steps of 1 ms':34}", " ".join(f"{one:11.6f}" for one in early))
assert apart(early, np.array(EXUDYN["EXUDYN, Runge-Kutta of order 4"])) < 1e-5
assert apart(early, np.array(EXUDYN["EXUDYN, generalized alpha, 0.1 ms"])) < 2.5e-4

# %%
# Kynema takes steps of 2 µs by the generalized-α method.

MOVED = np.array([-0.150416985652933, -1.724164450779749, -0.673023460701136])
TURNED = np.array([0.122947275600560, -0.491079359219981, 0.350430794926147, -0.787986857972906])
moved = place.values[-1] - CENTER
turned = rotation.values[-1] * np.sign(rotation.values[-1, 0])
print("at 2 s: displacement of the mass center [m], and rotation")
for name, values in (("Kynema, steps of 0.002 ms", (MOVED, TURNED)), ("ours, steps of 1 ms", (moved, turned))):
    print(f"{name:28}", *(" ".join(f"{one:11.7f}" for one in row) + "  " for row in values))
assert np.abs(moved - MOVED).max() < 3e-6
assert apart(turned, TURNED) < 3e-6

# %%
# Halved steps change ours by less than a thousandth of the difference, which is not of our steps.

halved = spun(cy.rules.galerkin(time=4), 5e-4, 2.0)[body].position.values[-1]
print(f"steps of 0.5 ms move the mass center by {np.abs(halved - place.values[-1]).max():.1e} m")
assert np.abs(halved - place.values[-1]).max() < 1e-9

figure, axes = plt.subplots(figsize=(5.0, 4.4), layout="constrained")
axes.plot(place.values[:, 0], place.values[:, 1], lw=1.0)
axes.plot(*place.values[0, :2], "o", color="C2", label="start")
axes.plot(*(MOVED + CENTER)[:2], "o", mfc="none", ms=9, color="C1", label="Kynema at 2 s")
axes.plot(*place.values[-1, :2], ".", color="C1", label="ours at 2 s")
axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title="way of the mass center, from above")
axes.legend()
