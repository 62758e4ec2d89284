r"""Rods unrolled and wound twice
=============================

A closed circle, clamped at one end, is unrolled by a moment at the other: to a half circle by half the moment
:math:`2\pi EI/l`, to a straight rod by all of it (Ibrahimbegovic 1995). Straight rods, wound to one circle (code_aster,
SSNL103) and to two (Simo and Vu-Quoc 1986, example 7.1), go the other way.
"""

# %%
# Elements of the rule ``screw`` have constant strain: all these shapes are exact on any mesh.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH, RADIUS = 10.0, 5.0 / np.pi


def given(*stiffness):
    """A section of given stiffness."""
    return cy.Section.given(stiffness=np.diag(stiffness), mass_per_length=1.0, inertia=np.eye(3))


def bent(rod, moment):
    """The equilibrium of a rod that is clamped at its start, under a moment at its end."""
    load = cy.loads.moment(rod.end, moment)
    return cy.equilibrium(cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[load]), rule=cy.rules.screw)


# %%
# The circle: five elements, made with E = 1200 of a unit square. Beside ours are ten curved elements of three nodes.

circle = cy.Rod.along(
    given(600.0, 600.0, 1200.0, 100.0, 100.0, 100.0),
    lambda u: (RADIUS * np.sin(u), RADIUS * (1.0 - np.cos(u)), 0.0),
    span=(0.0, 2.0 * np.pi),
    elements=5,
)
PUBLISHED = {  # moment over π: exact, of ten elements of three nodes
    10.0: ((0.0, 20.0 / np.pi), (-0.004, 6.364)),
    20.0: ((10.0, 0.0), (9.998, 0.017)),
}
print("tip x, y [m]   exact                  published          ours, 5 elements of screw")
shapes = {}
for moment, (exact, published) in PUBLISHED.items():
    shapes[moment] = bent(circle, (0.0, 0.0, -moment * np.pi))[circle].position.values
    tip = shapes[moment][-1]
    print(
        f"M = {moment:g} pi      {exact[0]:8.6f}, {exact[1]:.6f}    {published[0]:6.3f}, {published[1]:.3f}     ",
        end="",
    )
    print(f"{tip[0]:.9f}, {tip[1]:.9f}")
    assert np.abs(tip - (*exact, 0.0)).max() < 1e-8

# %%
# The straight rods, of length 1 with EI = 2: the document of code_aster gives two digits, which are not quite those of
# the exact circle, :math:`u = \sin(2\pi s)/2\pi - s`.

straight = cy.Rod(given(200.0, 200.0, 400.0, 2.0, 2.0, 1.6), length=1.0, elements=5, direction=(1, 0, 0))
once, twice = (bent(straight, (0.0, -turns * 4.0 * np.pi, 0.0))[straight].position.values for turns in (1, 2))
s = np.linspace(0.0, 1.0, 6)
print("one circle, 5 elements: u at s = 0.4, 0.6, 1")
print("published, two digits           -0.30    -0.70    -1.00")
print(
    "exact                         ", *(f"{np.sin(2 * np.pi * at) / (2 * np.pi) - at:8.5f}" for at in (0.4, 0.6, 1.0))
)
print("ours, 5 elements of screw     ", *(f"{one:8.5f}" for one in (once[:, 0] - s)[[2, 3, 5]]))
assert np.abs((once[:, 0] - s)[[2, 3, 5]] - (-0.30645, -0.69355, -1.0)).max() < 1e-5
wound = np.stack([np.sin(4.0 * np.pi * s), 0.0 * s, 1.0 - np.cos(4.0 * np.pi * s)], axis=1) / (4.0 * np.pi)
print(f"two circles, 5 elements: published: closed; ours: the tip is {np.abs(twice[-1]).max():.1e} from the clamp")
assert np.abs(twice - wound).max() < 1e-9

# %%

figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.6), layout="constrained")
angle = np.linspace(0.0, 2.0 * np.pi, 200)
left.plot(RADIUS * np.sin(angle), RADIUS * (1.0 - np.cos(angle)), lw=1.0, label="unloaded")
left.plot(2.0 * RADIUS * np.sin(angle / 2.0), 2.0 * RADIUS * (1.0 - np.cos(angle / 2.0)), lw=1.0, label=r"$M = 10\pi$")
left.plot((0.0, LENGTH), (0.0, 0.0), lw=1.0, label=r"$M = 20\pi$")
left.plot(RADIUS * np.sin(angle[::40]), RADIUS * (1.0 - np.cos(angle[::40])), "o", color="C0")
for k, shape in enumerate(shapes.values()):
    left.plot(shape[:, 0], shape[:, 1], "o", color=f"C{k + 1}")
left.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title="unrolled: 5 elements on exact arcs")
left.legend()
for turns, shape in ((1, once), (2, twice)):
    size = 1.0 / (2.0 * np.pi * turns)
    right.plot(size * np.sin(angle), size * (1.0 - np.cos(angle)), lw=1.0, color=f"C{turns}")
    right.plot(shape[:, 0], shape[:, 2], "o", color=f"C{turns}", label=f"wound {('once', 'twice')[turns - 1]}")
right.set(xlabel="x [m]", ylabel="z [m]", aspect="equal", title="wound up: 5 elements", ylim=(-0.02, 0.45))
right.legend(loc="upper right")
