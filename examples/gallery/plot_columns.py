r"""Columns
=======

A rod pressed along its axis buckles under Euler's load :math:`(kl)^2 EI/l^2`: with free, pinned, clamped or one pinned
end, :math:`kl = \pi/2, \pi, 2\pi, 4.4934`. With stretch and shear the load is that of Haringx (1942),

.. math:: EI k^2 = P\,(1 - P/EA + P/GA).

"""

# %%
# A thick column, :math:`EA = 4000\,EI/l^2` and :math:`GA = EA/2`. Four elements of degree 3.

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import cayley as cy

CUBIC = cy.rules.galerkin(time=1, space=3)
clamp, hold = cy.supports.clamp, cy.supports.hold
SUPPORTS = {  # what holds the lower and the upper end
    "free": lambda rod: [clamp(rod.start)],
    "pinned": lambda rod: [
        hold(rod.start, position="xyz", rotation="xz"),
        hold(rod.end, position="xy", rotation="xz"),
    ],
    "propped": lambda rod: [clamp(rod.start), hold(rod.end, position="xy", rotation="xz")],
    "clamped": lambda rod: [clamp(rod.start), hold(rod.end, position="xy", rotation="xyz")],
}
WAVES = {"free": np.pi / 2.0, "pinned": np.pi, "propped": 4.493409458, "clamped": 2.0 * np.pi}  # of Euler's columns


def haringx(ends, axial):
    """The load by the closed form; a propped column's wave is the root of tan kl = kl (1 − P/EA)/(1 − P/EA + P/GA)."""

    def wrong(load):
        shortened = 1.0 - load / axial
        softened = shortened + load / (0.5 * axial)
        wave = np.sqrt(load * softened)
        return np.sin(wave) - np.cos(wave) * wave * shortened / softened if ends == "propped" else wave - WAVES[ends]

    euler = WAVES[ends] ** 2
    return brentq(wrong, 0.6 * euler, 1.2 * euler)


def buckled(ends, axial, elements=4):
    """Linear buckling about the column under nearly all of its load: the load, and the mode to the side."""
    stiffness = np.diag([0.5 * axial, 0.5 * axial, axial, 2.0, 1.0, 1.0])  # it bends about y first
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=1e-3 * np.eye(3))
    rod = cy.Rod(section, length=1.0, direction=(0, 0, 1), elements=elements, name="column")
    push = cy.loads.force(rod.end, (0, 0, -1.0))
    model = cy.Model(rod, supports=SUPPORTS[ends](rod), loads=[push])
    found = cy.buckling(model, push, about=0.95 * haringx(ends, axial), rule=CUBIC)
    return found.factors[0], found.modes[0]["column"].displacement.sel(axis="x")


# %%

print("upper end   Euler [EI/l²]   Haringx    ours, 4 elements of degree 3")
shapes = {}
for ends, wave in WAVES.items():
    exact = haringx(ends, 4000.0)
    load, shapes[ends] = buckled(ends, 4000.0)
    print(f"{ends:10} {wave**2:10.5f} {exact:14.5f} {load:12.5f}")
    assert abs(load / exact - 1.0) < 1e-3
slender, _ = buckled("pinned", 1e7)
print(f"pinned, EA = 1e7 EI/l²: Euler {np.pi**2:.6f}, ours {slender:.6f}")
assert abs(slender / np.pi**2 - 1.0) < 1e-4

# %%
# The softer the column the more the two differ.

figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 4.0), layout="constrained")
for k, (ends, shape) in enumerate(shapes.items()):
    z, side = shape.s.values, shape.values / shape.values[np.abs(shape.values).argmax()]
    left.plot(0.0 * side + 1.5 * k, z, color="0.8", lw=1.0)
    left.plot(0.6 * side + 1.5 * k, z, color=f"C{k}")
    left.annotate(ends, (1.5 * k, 1.04), ha="center", color=f"C{k}")
left.set(ylabel="z/l", ylim=(-0.02, 1.12), xticks=[], title="modes")
softness = np.geomspace(2e-4, 1e-2, 30)
right.semilogx(softness, [haringx("pinned", 1.0 / soft) / np.pi**2 for soft in softness], label="Haringx, pinned")
marks = softness[::5]
right.semilogx(marks, [buckled("pinned", 1.0 / soft)[0] / np.pi**2 for soft in marks], "o", mfc="none", label="ours")
right.axhline(1.0, color="0.5", lw=0.8, label="Euler")
right.set(xlabel=r"$EI/(EA\,l^2)$", ylabel="load over Euler's")
right.legend()
