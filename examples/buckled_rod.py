"""A wire held at both ends and pushed together: it buckles and bows out, to either side.

Its end is moved, not loaded, so nothing snaps: the support's way is the parameter of the path. The bow that branches
off the straight wire is Euler's elastica; wire that hardly stretches has, with the modulus k = sin(α/2) of the steepest
slope α, the force √(P/EI) L = 4 K(k) and the distance of its ends (2 E(k)/K(k) − 1) L.

What must be seen, and is asserted: the force at which it buckles, 4 π² EI/L², and the elastica after it, within 1 %.
"""

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

import cayley as cy
from cayley.report import figures

steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
section = cy.Section.rectangle(width=0.5e-3, height=5e-3, material=steel)
wire = cy.Rod(section, length=0.5, direction=(0, 0, 1), elements=48, name="wire")
push = cy.supports.slide(wire.end, (0, 0, 1), displacement=lambda t: -t, name="push")
model = cy.Model(wire, supports=[cy.supports.clamp(wire.start), push])

straight = cy.trace(model, push, range=(0.0, 2.5e-6), step=0.1)
bows = [straight.branch(direction=side, range=(0.0, 0.35), step=0.1) for side in (1, -1)]


def force(path):
    """What pushes the end [N]."""
    return path.joint(push).force.sel(axis="z").values


bending = float(section.stiffness[4, 4])
euler = 4 * np.pi**2 * bending / wire.length**2
critical = straight.bifurcations[0]
print(straight)
print(f"buckles at {force(straight)[critical.point]:.4f} N; by hand {euler:.4f} N")
assert abs(force(straight)[critical.point] / euler - 1) < 0.01

bow = bows[0]
for k in range(1, len(bow), 8):
    gap = 1 - bow.parameter[k] / wire.length
    m = brentq(lambda m, gap=gap: 2 * ellipe(m) / ellipk(m) - 1 - gap, 1e-9, 0.999)
    elastica = (4 * ellipk(m) / wire.length) ** 2 * bending
    print(f"ends {1e3 * bow.parameter[k]:6.1f} mm nearer: {force(bow)[k]:.4f} N, elastica {elastica:.4f} N")
    assert abs(force(bow)[k] / elastica - 1) < 0.01
assert bow.unstable[1:].max() == 0

figure = figures.branches(bows, (wire.node(24), "x"))
