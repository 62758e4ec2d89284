r"""Rods that buckle under twist
============================

A twisting moment buckles a shaft: with ends that turn freely to any side at :math:`2\pi EI/l`, the less with a thrust
(Greenhill 1883), with clamped ends at :math:`8.98682\,EI/l`. A long rod whose ends then come nearer does not bow along
its whole length: it winds to a helix in the middle (van der Heijden and Thompson 2000).
"""

# %%
# Greenhill's shafts of 4 and 8 elements of degree 3, much stiffer against stretch and shear than against bending.

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import cayley as cy
from cayley import joints, loads, supports
from cayley.lie import quaternion

CUBIC = cy.rules.galerkin(time=1, space=3)
TORSION = 0.8


def given(stretch, bending, torsion):
    """A section of given stiffness, the same in shear as in stretch."""
    stiffness = np.diag([stretch] * 3 + [bending, bending, torsion])
    return cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=1e-3 * np.diag([1, 1, 2]))


def buckles(thrust):
    """The moment at which a shaft between pins buckles; twist is held in its middle."""
    rod = cy.Rod(given(1e5, 1.0, TORSION), length=1.0, direction=(0, 0, 1), elements=4)
    twist = [loads.moment(rod.end, (0, 0, 1.0)), loads.moment(rod.start, (0, 0, -1.0))]
    held = [supports.pin(rod.start), supports.hold(rod.end, position="xy"), supports.hold(rod.node(2), rotation="z")]
    model = cy.Model(rod, supports=held, loads=[*twist, loads.force(rod.end, (0, 0, -thrust))])
    about = 0.9 * 2.0 * np.pi * np.sqrt(1.0 - thrust / np.pi**2)
    return cy.buckling(model, twist, about=about, rule=CUBIC).factors[0]


thrusts = np.array([-10.0, -5.0, 0.0, 3.0, 6.0, 9.0])
moments = np.array([buckles(thrust) for thrust in thrusts])
exact = 2.0 * np.pi * np.sqrt(1.0 - thrusts / np.pi**2)
print("thrust [EI/l²]   moment [EI/l]: Greenhill   ours, 4 elements of degree 3")
for row in zip(thrusts, exact, moments, strict=True):
    print("{:8.1f}   {:22.5f}   {:20.5f}".format(*row))
assert np.abs(moments / exact - 1.0).max() < 2e-4

rod = cy.Rod(given(1e5, 1.0, TORSION), length=1.0, direction=(0, 0, 1), elements=8)
chuck = joints.cylindrical(rod.end, cy.ground, axis=(0, 0, 1), angle=lambda t: t, name="chuck")
model = cy.Model(rod, supports=[supports.clamp(rod.start)], joints=[chuck])
path = cy.trace(model, chuck, range=(0.0, 11.4), rule=CUBIC, turn=2.0, step=0.5)
clamped = TORSION * path.bifurcations[0].parameter
print(f"clamped ends: Greenhill 8.98682, ours, 8 elements of degree 3, {clamped:.5f}")
assert abs(clamped / 8.98682 - 1.0) < 1e-4

# %%
# The long rod has 27 turns and a length of 100, and its ends come nearer by :math:`D`. Without shear and stretch, with
# moment and tension :math:`m = Ml/2\pi B`, :math:`t = Tl^2/4\pi^2 B` and :math:`r^2 = 4t - m^2`,
#
# .. math:: D = \frac{l r}{\pi t}, \qquad 54\pi = \frac{Ml}{C} + 4\arccos\frac{m}{2\sqrt t}, \qquad
#    \cos\varphi = 1 - \frac{r^2}{2t\cosh^2 \pi r(s/l - 1/2)},
#
# :math:`\varphi` being the tilt of the axis to the line of the ends. 80 elements of degree 3.

BEND, TWIST, LENGTH, ANGLE, STRETCH = 1.345, 0.789, 100.0, 54.0 * np.pi, 1e3
rod = cy.Rod(given(STRETCH, BEND, TWIST), length=LENGTH, direction=(0, 0, 1), elements=80)
chuck = joints.cylindrical(
    rod.end,
    cy.ground,
    axis=(0, 0, 1),
    angle=lambda t: ANGLE * min(t / 0.01, 1.0),
    displacement=lambda t: 0.1 * min(t / 0.01, 1.0) - max(t - 0.02, 0.0),  # first pulled by 0.1
)
model = cy.Model(rod, supports=[supports.clamp(rod.start)], joints=[chuck])
begin = {
    rod: {
        "rotation": lambda s: (np.cos(0.5 * ANGLE * s / LENGTH), 0.0, 0.0, np.sin(0.5 * ANGLE * s / LENGTH)),
        "position": lambda s: (0.0, 0.0, s * (1.0 + 0.1 / LENGTH)),
    }
}
taut = cy.trace(model, chuck, range=(0.015, 0.087), initial=begin, rule=CUBIC, step=0.2)
slack = taut.branch(0, range=(0.015, 3.1), step=2.0, turn=2.0, points=45)


def homoclinic(nearer):
    """m, t and r of the closed form for ends that are nearer [-] by so much."""

    def known(m):
        quarter = 0.25 * (ANGLE - 2.0 * np.pi * m * BEND / TWIST)
        t = (0.5 * m / np.cos(quarter)) ** 2
        return m, t, 2.0 * np.sqrt(t) * np.sin(quarter)

    most = ANGLE * TWIST / (2.0 * np.pi * BEND)  # of the straight rod

    def wrong(m):
        _, t, r = known(m)
        return LENGTH * r / (np.pi * t) - nearer

    return known(brentq(wrong, 0.98 * most, most))


force, moment = (slack.joint(chuck)[kind].values[:, 2] for kind in ("force", "moment"))
nearer = np.abs(slack[rod].position.values[:, -1, 2] - LENGTH * (1.0 + np.abs(force) / STRETCH))
tilts = np.asarray(quaternion.rotate(slack[rod].rotation.values, np.array([0.0, 0.0, 1.0])))[:, :, 2]
s = slack[rod].s.values / LENGTH - 0.5
picked = [int(np.abs(nearer - one).argmin()) for one in (1.0, 1.4, 1.75)]
envelopes = {}
print("ends nearer   closed form: m, t       ours, 80 elements of degree 3   largest difference of cos φ")
for k in picked:
    m, t, r = homoclinic(nearer[k])
    envelopes[k] = 1.0 - r**2 / (2.0 * t) / np.cosh(np.pi * r * s) ** 2
    ours = np.abs(moment[k]) * LENGTH / (2.0 * np.pi * BEND), np.abs(force[k]) * LENGTH**2 / (4.0 * np.pi**2 * BEND)
    error = np.abs(tilts[k] - envelopes[k]).max()
    print(f"{nearer[k]:11.4f}   {m:11.4f}, {t:.4f}   {ours[0]:11.4f}, {ours[1]:.4f}   {error:22.1e}")
    assert error < 1e-2
    assert np.abs(np.divide(ours, (m, t)) - 1.0).max() < 1e-2

# %%

figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.8), layout="constrained")
fine = np.linspace(-10.0, np.pi**2, 200)
left.plot(fine, 2.0 * np.pi * np.sqrt(1.0 - fine / np.pi**2), label="Greenhill")
left.plot(thrusts, moments, "o", mfc="none", label="ours")
left.set(
    xlabel="thrust [EI/l²]",
    ylabel="moment [EI/l]",
    title="pinned shaft: where it buckles",
    ylim=(0.0, None),
    xticks=(-10, -5, 0, 5, 10),
)
left.legend()
for k in picked:
    right.plot(s + 0.5, tilts[k], label=f"ends {nearer[k]:.2f} nearer")
    right.plot(s + 0.5, envelopes[k], "--", color="0.3", lw=0.9)
right.set(xlabel="s/l", ylabel="cosine of the tilt", title="long rod; dashed: the closed form")
right.legend(loc="lower right")
