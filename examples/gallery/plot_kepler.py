"""A planet: any Lagrangian, no rotation in sight, and orbits that stay closed.

The Kepler problem in the plane, twenty times around an ellipse with the eccentricity 0.6.

Insight: a symplectic rule never spirals in or out. Of order 2 its ellipse turns slowly; of order 8 it does not turn
at all.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy


@cy.lagrangian(x=cy.Vector(2))
def planet(q, c):
    """Unit mass in the field of a sun of strength c.sun at the origin."""
    return 0.5 * cy.dot(q.x_t, q.x_t) + c.sun / cy.norm(q.x)


eccentricity, orbits = 0.6, 20
start = {"x": (1 - eccentricity, 0), "x_t": (0, np.sqrt((1 + eccentricity) / (1 - eccentricity)))}
period = 2 * np.pi
figure, panels = plt.subplots(1, 3, figsize=(7.4, 2.9), layout="constrained")
errors = {}
for axes, (rule, steps) in zip(
    panels, ((cy.rules.verlet, 200), (cy.rules.galerkin(time=2), 50), (cy.rules.galerkin(time=4), 50)), strict=False
):
    system = cy.compile(planet, rule=rule, constants={"sun": 1.0})
    run = cy.integrate(
        system, start, t_end=orbits * period, dt=period / steps, save_every=period / 50, allow_unstable=True
    )
    x = run.data["x"].values
    errors[str(rule)] = np.linalg.norm(x[-1] - x[0])
    axes.plot(*x.T, lw=0.5)
    axes.plot(0, 0, "o", color="#E69F00")
    axes.set(aspect="equal", title=f"{rule}\n{steps} steps a turn", xlim=(-1.8, 1.4), ylim=(-1.5, 1.5))
    energy = run.energy.values
    print(f"{rule}: after {orbits} turns off by {errors[str(rule)]:.1e}, energy within {np.ptp(energy):.1e}")
    assert np.ptp(energy[: 5 * 50]) > 0.7 * np.ptp(energy)  # no drift: the first quarter has seen nearly all
assert errors["galerkin(time=4)"] < 1e-2
plt.show()
