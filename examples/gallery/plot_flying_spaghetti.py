"""Flying spaghetti: a free rod that is pushed and twisted for five seconds, then left alone.

The rod of Simo and Vu-Quoc (1988) starts at rest; a force and two moments act on its lower end, rise for 2.5 s and
fall for 2.5 s. Whatever it does, its center of mass must go on with exactly 5 m/s, for the impulse is 50 N s and the
mass 10 kg.

Insight: momenta are kept to round-off on any mesh, because every symmetry of the Lagrangian is one of the discrete
one.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

section = cy.Section.given(
    stiffness=np.diag([1e4, 1e4, 1e4, 500.0, 500.0, 500.0]), mass_per_length=1.0, inertia=10.0 * np.eye(3)
)
rod = cy.Rod(section, length=10.0, elements=16, origin=(6, 0, 0), direction=(-0.6, 0.8, 0), normal=(0, 0, 1))


def triangle(t):
    """0 at 0 s, 200 at 2.5 s, 0 from 5 s on."""
    return 200.0 * max(0.0, 1.0 - abs(t - 2.5) / 2.5)


push = cy.loads.force(rod.start, lambda t: (triangle(t) / 10.0, 0.0, 0.0))
turn = cy.loads.moment(rod.start, lambda t: (0.0, -0.5 * triangle(t), -triangle(t)))
run = cy.simulate(cy.Model(rod, loads=[push, turn]), t_end=7.0, dt=2.5e-3, rule=cy.rules.verlet, save_every=0.25)

# %%
# Snapshots, half a second apart.
places = run[rod].position.values
figure, panels = plt.subplots(2, 1, figsize=(7.4, 4.6), sharex=True, layout="constrained")
for axes, across, name in zip(panels, (1, 2), "yz", strict=True):
    for k in range(0, len(places), 2):
        axes.plot(places[k, :, 0], places[k, :, across], color=plt.cm.viridis(k / len(places)), lw=2)
    axes.set(ylabel=f"{name} [m]", aspect="equal")
panels[0].set_title("every half second, from dark to light: from above, and from the side")
panels[1].set_xlabel("x [m]")

# %%
# From 5 s on nothing acts.
after = run.time >= 5.0
linear, angular = run.linear_momentum.values[after], run.angular_momentum.values[after]
print("linear momentum after 5 s:", linear[-1].round(9), "kg m/s")
print("angular momentum changes by", np.abs(angular - angular[0]).max(), "kg m²/s")
assert np.abs(linear - (50.0, 0.0, 0.0)).max() < 1e-10
assert np.abs(angular - angular[0]).max() < 1e-11 * np.linalg.norm(angular[0])
plt.show()
