r"""A rotating cantilever
=====================

Centrifugal forces stiffen a blade that turns about an axis at its root or, with a hub, beside it. Its flap frequencies,
out of the plane of turning, are those of Wright, Smith, Thresher and Wang (1982), here to the digits of an independent
solution of Euler and Bernoulli's beam; in the plane :math:`\omega_{lag}^2 = \omega_{flap}^2 - \Omega^2`.
"""

# %%
# Speeds and frequencies are in units of :math:`\sqrt{EI/(m l^4)}`. Four elements of degree 4, so slender that neither
# shear, nor stretch, nor Coriolis forces show.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

RADIUS = 3e-4  # of gyration, over the length
RULE = cy.rules.galerkin(time=1, space=4)
stiffness = np.diag([1.0 / RADIUS**2] * 3 + [1.0, 1.0, 0.8])
section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=RADIUS**2 * np.diag([1.0, 1.0, 2.0]))


def frequencies(hub, speed):
    """The lowest three flap and lag frequencies of a blade that turns about z at a distance from its root."""
    rod = cy.Rod(section, length=1.0, origin=(hub, 0, 0), direction=(1, 0, 0), elements=4)
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)])
    modes = cy.modes(model, about=cy.equilibrium(model, spin=speed, rule=RULE), count=6)
    moves = np.abs(modes[rod].displacement.values).max(axis=1)
    flaps = moves[:, 2] > moves[:, 1]
    found = modes.angular_frequency.values
    return found[flaps], found[~flaps]


# %%

WRIGHT = {  # hub radius over the length: speed: flap frequencies
    0.0: {
        1.0: (3.6816, 22.1810, 61.8418),
        2.0: (4.1373, 22.6149, 62.2732),
        3.0: (4.7973, 23.3203, 62.9850),
        4.0: (5.5850, 24.2733, 63.9668),
        5.0: (6.4495, 25.4461, 65.2050),
        6.0: (7.3604, 26.8091, 66.6839),
        7.0: (8.2996, 28.3341, 68.3860),
        8.0: (9.2568, 29.9954, 70.2930),
        9.0: (10.2257, 31.7705, 72.3867),
        10.0: (11.2023, 33.6404, 74.6493),
        11.0: (12.1843, 35.5890, 77.0638),
        12.0: (13.1702, 37.6031, 79.6145),
    },
    1.0: {
        1.0: (3.8888, 22.3750, 62.0431),
        2.0: (4.8337, 23.3660, 63.0675),
        5.0: (8.9404, 29.3528, 69.7607),
        10.0: (16.6064, 44.3682, 89.1563),
        12.0: (19.7215, 51.0701, 98.5268),
    },
}
ours = {}
print("hub/l  speed   flap: published             ours, 4 elements of degree 4   lag: from published flap    ours")
for hub, rows in WRIGHT.items():
    for speed, wanted in rows.items():
        flap, lag = ours[hub, speed] = frequencies(hub, speed)
        beside = np.sqrt(np.square(wanted) - speed**2)
        texts = [" ".join(f"{one:8.4f}" for one in values) for values in (wanted, flap, beside, lag)]
        print(f"{hub:5g}  {speed:5g}   {texts[0]}  {texts[1]:29}  {texts[2]}  {texts[3]}")
        assert np.abs(flap / wanted - 1.0).max() < 1e-4
        assert np.abs(lag / beside - 1.0).max() < 1e-4

# %%
# Without a hub the first lag frequency meets the speed near 4: an excitation once a turn finds it.

figure, (lowest, higher) = plt.subplots(1, 2, figsize=(8.0, 3.8), layout="constrained")
for hub, color in ((0.0, "C0"), (1.0, "C1")):
    speeds, table = list(WRIGHT[hub]), np.array(list(WRIGHT[hub].values()))
    flap, lag = (np.array([ours[hub, speed][k] for speed in speeds]) for k in (0, 1))
    lowest.plot(speeds, flap[:, 0], color=color, label=f"flap, hub radius {hub:g} l")
    lowest.plot(speeds, lag[:, 0], "--", color=color, label=f"lag, hub radius {hub:g} l")
    higher.plot(speeds, flap[:, 1:], color=color)
    lowest.plot(speeds, table[:, 0], "o", mfc="none", color=color)
    higher.plot(speeds, table[:, 1:], "o", mfc="none", color=color)
lowest.plot((0, 12), (0, 12), color="0.6", lw=0.8, label="once a turn")
speed, frequency = r"speed $\Omega\sqrt{m l^4/EI}$", r"frequency $\omega\sqrt{m l^4/EI}$"
lowest.set(xlabel=speed, ylabel=frequency, title="first flap and lag; circles: published")
higher.set(xlabel=speed, title="second and third flap", ylim=(0.0, None))
lowest.legend()
