r"""Frequencies of Timoshenko's beam
================================

Bending frequencies :math:`\Omega = \omega\sqrt{\rho A l^4/EI}` of beams with shear and rotary inertia, clamped at one
end, free, or pinned at both ends, over the slenderness :math:`r = \sqrt{I/A}/l`, for :math:`\nu = 0.3` and a shear
correction of 5/6. The values beside ours are the roots of the closed form's determinant; the first row of each beam is
that of Euler and Bernoulli.
"""

# %%
# Eight elements of degree 4. Length, mass and bending stiffness are one, so frequencies are those of the tables.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

SHEAR = 5.0 / 6.0 / 2.6  # of the correction and E/G
RULE = cy.rules.galerkin(time=1, space=4)
SUPPORTS = {
    "clamped-free": lambda rod: [cy.supports.clamp(rod.start)],
    "free-free": lambda _: [],
    "pinned-pinned": lambda rod: [cy.supports.pin(rod.start), cy.supports.hold(rod.end, position="yz")],
}


def frequencies(r, ends, count):
    """The lowest frequencies of bending, one of each pair: a round section bends alike in all planes."""
    axial = 1.0 / r**2
    stiffness = np.diag([SHEAR * axial, SHEAR * axial, axial, 1.0, 1.0, 2.0 / 2.6])
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=r**2 * np.diag([1.0, 1.0, 2.0]))
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), elements=8)
    model = cy.Model(rod, supports=SUPPORTS[ends](rod))
    modes = cy.modes(model, about=cy.equilibrium(model, rule=RULE), count=20)
    moves = np.abs(modes[rod].displacement.values).max(axis=1)
    bends = (moves[:, 1:].max(axis=1) > 0.1 * moves.max()) & (modes.angular_frequency.values > 1.0)  # not as a whole
    return modes.angular_frequency.values[bends][: 2 * count : 2]


# %%

CLOSED_FORM = {
    "clamped-free": {
        1e-4: (3.516015, 22.034477, 61.697116, 120.901560),
        0.02: (3.502641, 21.469824, 58.149832, 109.029143),
        0.04: (3.463579, 20.014730, 50.561942, 88.195688),
        0.08: (3.321388, 16.233135, 36.534573, 57.941383),
    },
    "free-free": {
        1e-4: (22.373276, 61.672745, 120.903092),
        0.02: (21.993182, 58.819927, 110.733166),
        0.04: (20.986989, 52.432919, 91.965809),
        0.08: (18.190682, 39.273842, 62.050870, 81.064702),
    },
    "pinned-pinned": {
        1e-4: (9.869602, 39.478385, 88.826277),
        0.02: (9.790536, 38.266761, 83.086521),
        0.04: (9.566690, 35.306542, 71.468308, 113.427911),
        0.08: (8.826635, 28.356978, 51.225672, 74.880985),
    },
}
print("beam           r       closed form                              ours, 8 elements of degree 4")
for ends, rows in CLOSED_FORM.items():
    for r, wanted in rows.items():
        found = frequencies(r, ends, len(wanted))
        texts = [" ".join(f"{one:10.6f}" for one in values) for values in (wanted, found)]
        print(f"{ends:13}  {r:<6g} {texts[0]:44} {texts[1]}")
        assert np.abs(found / wanted - 1.0).max() < 2e-6

# %%
# Shear and rotary inertia lower the higher frequencies most, and a short beam's more than a slender one's.

figure, panels = plt.subplots(1, 3, figsize=(8.6, 3.4), layout="constrained", sharey=True)
radii = np.linspace(0.005, 0.08, 6)
for axes, (ends, rows) in zip(panels, CLOSED_FORM.items(), strict=True):
    curves = np.array([frequencies(r, ends, 3) for r in radii])
    for k in range(3):
        (line,) = axes.plot(radii, curves[:, k] / rows[1e-4][k])
        axes.plot(
            list(rows), [row[k] / rows[1e-4][k] for row in rows.values()], "o", mfc="none", color=line.get_color()
        )
        axes.annotate(f"{k + 1}", (0.082, curves[-1, k] / rows[1e-4][k]), color=line.get_color(), va="center")
    axes.set(xlabel="r [-]", title=ends, xlim=(-0.002, 0.088))
panels[0].set_ylabel("frequency over that without shear")
