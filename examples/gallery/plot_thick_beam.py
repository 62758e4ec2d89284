r"""A thick beam
============

A cantilever six times as long as thick, soft in shear, under a force at its tip: the linear theory of Timoshenko says

.. math:: w(s) = -\frac{F s}{\kappa G A} - \frac{F l s^2}{2 EI} + \frac{F s^3}{6 EI}.

It is the first example of PyElastica, which prints this line beside its own.
"""

# %%
# Ten elements of degree 3. Rotations are finite here, and the tip moves a little less; under a thousandth of the force
# the two are the same.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH, RADIUS, YOUNG, SHEAR, FORCE = 3.0, 0.25, 1e6, 1e4, 15.0
area, second = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4.0
across, bending = 27.0 / 28.0 * SHEAR * area, YOUNG * second
section = cy.Section.given(
    stiffness=np.diag([across, across, YOUNG * area, bending, bending, 2.0 * SHEAR * second]),
    mass_per_length=1.0,
    inertia=np.eye(3),
)
rod = cy.Rod(section, length=LENGTH, elements=10, direction=(1, 0, 0), normal=(0, 1, 0))


def deflection(force):
    """Places along the rod [m] and how far they move down [m]."""
    load = cy.loads.force(rod.end, (0, 0, -force))
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[load])
    shape = cy.equilibrium(model, rule=cy.rules.galerkin(time=1, space=3))[rod]
    return shape.s.values, shape.position.values[:, 2]


def linear(s, force):
    """Timoshenko's line [m]."""
    return -force * s / across - force * LENGTH * s**2 / (2.0 * bending) + force * s**3 / (6.0 * bending)


# %%

print("force [N]   linear theory [m]    ours, 10 elements of degree 3")
for force, within in ((FORCE, 1e-3), (1e-3 * FORCE, 1e-7)):
    s, w = deflection(force)
    print(f"{force:9g}   {linear(LENGTH, force):17.9e}   {w[-1]:17.9e}")
    assert abs(w[-1] / linear(LENGTH, force) - 1.0) < within

# %%

s, w = deflection(FORCE)
fine = np.linspace(0.0, LENGTH, 100)
figure, axes = plt.subplots(figsize=(6.0, 3.6), layout="constrained")
axes.plot(fine, 1e3 * linear(fine, FORCE), label="Timoshenko, linear")
axes.plot(s, 1e3 * w, "o", mfc="none", ms=4, label="ours")
axes.plot(fine, 1e3 * (linear(fine, FORCE) + FORCE * fine / across), "--", label="without shear")
axes.set(xlabel="s [m]", ylabel="deflection [mm]")
axes.legend()
