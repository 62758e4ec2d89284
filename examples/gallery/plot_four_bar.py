"""Four-bar linkage: a closed loop with a motor, and the curve that a point of its coupler draws.

Four hinges with parallel axes would hold the plane mechanism out of its plane more often than needed; the library
refuses that and names the joint that says too much. So one hinge is a ball and one a universal joint, and the loop is
exactly closed.

Insight: a loop is no special case. Joints are constraints, and the loop stays closed to round-off.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy
from cayley import joints

ground = np.array([[0.0, 0.0, 0.0], [0.4, 0.0, 0.0]])  # m
points = [ground[0], np.array([0.0, 0.0, 0.15]), np.array([0.35, 0.0, 0.35]), ground[1]]


def bar(k, name):
    """The bar from point k to the next, 1 kg/m; the coupler has an arm to the point that draws."""
    a, b = points[k], points[k + 1]
    along = b - a
    length = np.linalg.norm(along)
    ports = {"near": -0.5 * along, "far": 0.5 * along}
    if name == "coupler":
        ports["pen"] = 0.25 * np.array([-along[2], 0.0, along[0]]) / length
    moment = length**3 / 12
    return cy.Body(mass=length, inertia=[moment] * 3, position=0.5 * (a + b), ports=ports, name=name)


crank, coupler, rocker = (bar(k, name) for k, name in enumerate(("crank", "coupler", "rocker")))
y = (0, 1, 0)
loop = [
    joints.hinge(crank.port("near"), axis=y, angle=lambda t: 2 * np.pi * t, name="motor"),
    joints.hinge(crank.port("far"), coupler.port("near"), axis=y),
    joints.ball(coupler.port("far"), rocker.port("near")),
    joints.universal(rocker.port("far"), axis=(0, 1, 0), other=(0, 0, 1)),
]
model = cy.Model(crank, coupler, rocker, joints=loop)
run = cy.simulate(model, 1.0, 1e-3, rule=cy.rules.midpoint, save_every=0.01)

# %%
pen = run.port(coupler, "pen").position.values
figure, axes = plt.subplots(figsize=(6.0, 3.8), layout="constrained")
for k in range(0, 100, 10):
    corners = [ground[0]] + [run.port(b, "far").position.values[k] for b in (crank, coupler)] + [ground[1]]
    axes.plot(*np.array(corners)[:, [0, 2]].T, "o-", color=plt.cm.viridis(k / 100), lw=1, ms=3, alpha=0.7)
axes.plot(pen[:, 0], pen[:, 2], "k", lw=2, label="coupler curve")
axes.set(xlabel="x [m]", ylabel="z [m]", aspect="equal", title="a turn of the crank")
axes.legend(loc="upper right")
lengths = np.linalg.norm(run.port(crank, "far").position.values - run.port(coupler, "far").position.values, axis=1)
back = np.linalg.norm(pen[-1] - pen[0])
print(f"the pen comes back to {back:.0e} m; the coupler's length within {np.ptp(lengths):.0e} m")
assert back < 1e-10
assert np.ptp(lengths) < 1e-12
plt.show()
