r"""Branches of a clamped rod
=========================

A slender rod, clamped at one end and guided at the other, leaves its straight shape at three loads below
:math:`170\,EI/l^2`. What branches off there are elastica: with the modulus :math:`k`, the sine of half the steepest
slope, the first and the third obey

.. math:: \sqrt{P/EI}\,l = 4 n K(k), \qquad \text{chord} = (2 E(k)/K(k) - 1)\,l, \qquad n = 1, 2;

on the second, which is its own image when it turns by half a turn, the guide also pushes sideways.
"""

# %%
# Sixteen elements of degree 3. Bending out of the plane is stiff, so all happens in the plane.

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

import cayley as cy

stiffness = np.diag([1e6, 1e6, 2e6, 1e3, 1.0, 1e3])
section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=1e-3 * np.eye(3))
rod = cy.Rod(section, length=1.0, direction=(0, 0, 1), elements=16, name="rod")
push = cy.loads.force(rod.end, (0, 0, -1.0))
guide = cy.supports.hold(rod.end, position="xy", rotation="xyz")
model = cy.Model(rod, supports=[cy.supports.clamp(rod.start), guide], loads=[push])
rule = cy.rules.galerkin(time=1, space=3)
straight = cy.trace(model, push, range=(30.0, 170.0), rule=rule, step=0.2)

# %%
# Loads at which it buckles: :math:`4\pi^2`, :math:`4 x^2` with :math:`\tan x = x`, and :math:`16\pi^2`.

ODD = 4.0 * 4.493409458**2
print("branch   critical load [EI/l²]   ours, 16 elements of degree 3")
for k, (one, exact) in enumerate(zip(straight.bifurcations, (4.0 * np.pi**2, ODD, 16.0 * np.pi**2), strict=True)):
    print(f"{k + 1:6}   {exact:21.5f}   {one.parameter:.5f}")
    assert abs(one.parameter / exact - 1.0) < 2e-3
branches = [straight.branch(one, range=(20.0, 300.0), step=0.2, points=50) for one in straight.bifurcations]

# %%
# Along each branch the load at a given chord is that of elliptic integrals.


def even(chord, waves):
    """The load on the first (waves = 1) and the third branch (2)."""
    m = brentq(lambda m: 2.0 * ellipe(m) / ellipk(m) - 1.0 - chord, 0.0, 1.0 - 1e-12)
    return (4.0 * waves * ellipk(m)) ** 2


def odd(chord):
    """The load on the second branch, whose middle is straight.

    From there sin φ/2 = k sin ψ, with φ from the line of the force R and √(R/EI) s = F(ψ, k) − K(k). The end must be
    where its own tangent through the middle meets it.
    """

    def shape(k):
        def end(psi):
            wave = 2.0 * (ellipkinc(psi, k**2) - ellipk(k**2))
            along = 2.0 * (ellipeinc(psi, k**2) - ellipe(k**2)) / wave - 0.5
            return wave, 2.0 * np.arcsin(k * np.sin(psi)), along, -2.0 * k * np.cos(psi) / wave

        def aside(psi):
            _, tangent, along, across = end(psi)
            return across * np.cos(tangent) - along * np.sin(tangent)

        wave, tangent, along, across = end(brentq(aside, 1.5 * np.pi, 2.0 * np.pi))
        return wave**2 * np.cos(tangent), 2.0 * (along * np.cos(tangent) + across * np.sin(tangent))

    return shape(brentq(lambda k: shape(k)[1] - chord, 1e-4, 0.9))[0]


EXACT = (lambda chord: even(chord, 1), odd, lambda chord: even(chord, 2))
print("branch   chord/l     elliptic integrals   ours [EI/l²]")
for k, (branch, exact) in enumerate(zip(branches, EXACT, strict=True)):
    chords = branch[rod].position.values[:, -1, 2]
    for n in range(1, len(branch)):
        wanted = exact(chords[n])
        if n % 10 == 0:
            print(f"{k + 1:6}   {chords[n]:8.5f}   {wanted:20.5f}   {branch.parameter[n]:.5f}")
        assert abs(branch.parameter[n] / wanted - 1.0) < 2e-3

# %%
# Full circles are stable. The first branch is, until its ends meet and another path leaves it there.

meet = even(0.0, 1)
print(f"ends meet at {meet:.4f}; ours, further bifurcation point at {branches[0].bifurcations[0].parameter:.4f}")
assert abs(branches[0].bifurcations[0].parameter / meet - 1.0) < 1e-3

figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 4.0), layout="constrained")
for k, (branch, exact) in enumerate(zip(branches, EXACT, strict=True)):
    chords = branch[rod].position.values[:, -1, 2]
    fine = np.linspace(chords.min(), chords.max() - 1e-3, 100)
    left.plot(1.0 - fine, [exact(chord) for chord in fine], lw=1.0, color=f"C{k}", label=f"branch {k + 1}")
    for stable, face in ((branch.stable, f"C{k}"), (~branch.stable, "white")):
        left.plot(1.0 - chords[stable][::2], branch.parameter[stable][::2], "o", ms=4, color=f"C{k}", mfc=face)
    for n in (len(branch) // 3, len(branch) - 1):
        x, _, z = branch[rod].position.values[n].T
        right.plot(z, x + 0.7 * (1 - k), color=f"C{k}", lw=1.0 + (n == len(branch) - 1))
left.axhline(0.0, color="0.7", lw=0.8)
left.set(xlabel="ends nearer [l]", ylabel="load [EI/l²]", title="lines: elliptic integrals; full circles: stable")
left.legend()
right.set(xlabel="z [l]", yticks=[], aspect="equal", title="shapes, of branch 1 above to 3 below")
