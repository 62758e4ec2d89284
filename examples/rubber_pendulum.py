"""A rubber rod as a pendulum: pinned at one end, let go from the horizontal; where is its tip after one second?

A round rod of 1 cm diameter and 1 m length falls, bends as a whip does, and passes the lowest point after about half a
second. No formula tells where its tip is then, so the mesh is refined: with the rule `verlet` the error falls like the
square of the element length, and two meshes together (Richardson's extrapolation) give the limit to more digits than
either of them.

The step is not given: the library takes 0.9 of the largest that is guaranteed to be stable. For a slender rod that
limit comes from the rotation of cross-sections against shear, and does not depend on the mesh.

Energy is conserved by the motion, and kept by the rule up to a ripple that is small beside the 0.42 J at stake.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LIMIT = np.array([-0.94009, 0.0, -0.09910])
"""Tip at 1 s [m], extrapolated from meshes of 20 to 160 elements with an independent prototype."""


def swing(elements):
    """The pendulum's first second, and its rod."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(5e-3, rubber, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, elements=elements, direction=(1, 0, 0), normal=(0, 1, 0))
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
    return cy.simulate(model, t_end=1.0, rule=cy.rules.verlet, save_every=0.01), rod


tips = {}
for elements, height in ((20, -0.109372), (40, -0.101812), (80, -0.099783)):
    run, rod = swing(elements)
    tips[elements] = run[rod].position.isel(time=-1, node=-1).values
    ripple = float(np.ptp(run.energy)) / float(run.kinetic_energy.max())
    print(f"{elements} elements: tip {tips[elements].round(5)} m, {run.steps} steps, energy ripple {ripple:.0e}")
    assert abs(tips[elements][2] - height) < 5e-5
    assert ripple < 1e-5

extrapolated = (4 * tips[80] - tips[40]) / 3
order = np.log2(np.linalg.norm(tips[20] - tips[40]) / np.linalg.norm(tips[40] - tips[80]))
print(f"extrapolated: {extrapolated.round(5)} m; observed order {order:.2f}")
assert np.abs(extrapolated - LIMIT).max() < 1e-4
assert abs(order - 2.0) < 0.2

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.6), layout="constrained", width_ratios=(1.5, 1))
places = run[rod].position.values  # of the last, finest run
for k in range(0, 101, 10):
    left.plot(places[k, :, 0], places[k, :, 2], color=plt.cm.viridis(k / 110), lw=1.5)
left.set(xlabel="x [m]", ylabel="z [m]", aspect="equal", title="every tenth of a second")
right.loglog(list(tips), [np.linalg.norm(tip - LIMIT) for tip in tips.values()], "o-")
right.set(xlabel="elements", ylabel="error of the tip at 1 s [m]", title="order 2")
right.set_xticks([20, 40, 80], ["20", "40", "80"])
right.minorticks_off()
plt.show()
