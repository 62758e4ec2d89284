"""Catenary: a chain that cannot stretch, hung between two points.

Leibniz, Huygens and Johann Bernoulli found its shape in 1691: y = a cosh(x/a), with a = H/w, the horizontal force
over the weight per length. Here it is the equilibrium of a rod that neither shears nor stretches and hardly resists
bending.

Insight: the axial force of an inextensible rod is a multiplier, not a stiffness times a stretch, and just as exact.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import cayley as cy

LENGTH, SPAN, GRAVITY = 1.5, 1.0, 9.81  # m, m, m/s²

cord = cy.Section.given(stiffness=np.diag([1, 1, 1, 1e-5, 1e-5, 1e-5]), mass_per_length=0.1, inertia=1e-6 * np.eye(3))
ELEMENTS = 40


def arc(s, bend):
    """A circular arc of the chain's length through both ends, s the arc length."""
    radius = 0.5 * SPAN / np.sin(bend)
    angle = -bend + 2 * bend * s / LENGTH
    return 0.5 * SPAN + radius * np.sin(angle), 0.0, radius * (np.cos(bend) - np.cos(angle))


bend = brentq(lambda b: 0.5 * SPAN / np.sin(b) * 2 * b - LENGTH, 0.1, 3.0)
chain = cy.Rod.along(
    cord, lambda s: arc(s, bend), span=(0, LENGTH), elements=ELEMENTS, kinematics="inextensible", name="chain"
)
ends = [cy.supports.pin(chain.start), cy.supports.pin(chain.end)]
rest = cy.equilibrium(cy.Model(chain, supports=ends, loads=[cy.loads.gravity((0, 0, -GRAVITY))]))

# %%
a = brentq(lambda a: 2 * a * np.sinh(0.5 * SPAN / a) - LENGTH, 0.1, 2.0)
x, _, z = rest[chain].position.values.T
exact = a * (np.cosh((x - 0.5 * SPAN) / a) - np.cosh(0.5 * SPAN / a))
tension = np.linalg.norm(rest[chain].force.values, axis=1)
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.4), layout="constrained")
left.plot(x, z, "o", ms=3, label="rod, at rest")
left.plot(x, exact, "k-", lw=1, label="a cosh(x/a)")
left.plot(*np.array([arc(s, bend) for s in np.linspace(0, LENGTH, 100)])[:, [0, 2]].T, ":", color="0.6", label="start")
left.set(xlabel="x [m]", ylabel="z [m]", aspect="equal")
left.legend(loc="upper center", fontsize=7)
right.plot(x, tension, "o", ms=3)
right.plot(x, 0.1 * GRAVITY * (z - z.min() + a), "k-", lw=1)
right.set(xlabel="x [m]", ylabel="tension [N]", title="weight per length times height above the directrix")
print(f"shape within {1e3 * np.abs(z - exact).max():.2f} mm of the catenary, {rest.iterations} corrections")
assert np.abs(z - exact).max() < 2e-3 * SPAN
plt.show()
