r"""A rod rolled up to a circle
===========================

An end moment :math:`M = 2\pi EI/l` bends a straight cantilever to a closed circle. It is the classical test of a rod
that turns by any angle: curvature is constant, :math:`\kappa = M/EI`, and the exact shape is known under any moment.
"""

# %%
# The rod of Wang et al. (2017), stiffness in the order shear, shear, axial, bending, bending, twist. Elements of the
# rule ``screw`` have constant strain, so a circle is exact on any mesh; here are three of them.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH, BENDING = 10.0, 86.9e3
section = cy.Section.given(
    stiffness=np.diag([1770e3, 1770e3, 1770e3, BENDING, 215e3, 8.16e3]), mass_per_length=1.0, inertia=np.eye(3)
)
rod = cy.Rod(section, length=LENGTH, elements=3, direction=(1, 0, 0), normal=(0, 1, 0))

# %%
# Loads are put on in as many steps as Newton's method needs.

shapes = {}
for turns in (0.25, 0.5, 0.75, 1.0):
    moment = cy.loads.moment(rod.end, (0, -turns * 2.0 * np.pi * BENDING / LENGTH, 0))
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[moment])
    shapes[turns] = cy.equilibrium(model, rule=cy.rules.screw)
rest = shapes[1.0]
tip = rest[rod].position.values[-1] - (LENGTH, 0.0, 0.0)

print(rest)
print("tip displacement of the full circle, 3 elements of screw [m]")
print("published  -10, 0, 0; one Legendre element of 6 nodes: -10.985, of 9: -10.058 (Wang et al. 2017)")
print(f"ours       {tip[0]:.12f}, {tip[1]:.1e}, {tip[2]:.1e}")
assert np.abs(tip - (-LENGTH, 0.0, 0.0)).max() < 1e-9 * LENGTH

# %%
# The moments of GXBeam's example, from 0.4 to 2 times :math:`\pi EI/l` on its bar of 12 inches, and its mesh.

bar = cy.Section.given(
    stiffness=np.diag([1.5e7, 1.5e7, 3e7, 2.5e6, 2.5e6, 2.5e6]), mass_per_length=1.0, inertia=np.eye(3)
)
rod16 = cy.Rod(bar, length=12.0, elements=16, direction=(1, 0, 0), normal=(0, 1, 0))
print("M l/πEI   exact u, w [in]           ours, 16 elements of screw")
for share in (0.4, 0.8, 1.2, 1.6, 1.8, 2.0):
    curvature = share * np.pi / 12.0
    moment = cy.loads.moment(rod16.end, (0, -curvature * 2.5e6, 0))
    model = cy.Model(rod16, supports=[cy.supports.clamp(rod16.start)], loads=[moment])
    u, _, w = cy.equilibrium(model, rule=cy.rules.screw)[rod16].position.values[-1] - (12.0, 0.0, 0.0)
    exact = np.sin(share * np.pi) / curvature - 12.0, (1.0 - np.cos(share * np.pi)) / curvature
    print(f"{share:7g}   {exact[0]:11.7f}, {exact[1]:10.7f}   {u:11.7f}, {w:10.7f}")
    assert np.abs(np.subtract((u, w), exact)).max() < 1e-8

# %%
# Between the nodes the rod is drawn as the arc that an element is.

figure, axes = plt.subplots(figsize=(6.0, 4.5), layout="constrained")
for turns, found in shapes.items():
    s, curvature = np.linspace(0.0, LENGTH, 200), 2.0 * np.pi * turns / LENGTH
    (line,) = axes.plot(np.sin(curvature * s) / curvature, (1.0 - np.cos(curvature * s)) / curvature, lw=1.0)
    x, _, z = found[rod].position.values.T
    axes.plot(x, z, "o", color=line.get_color(), label=f"{turns:g} turns")
axes.set(xlabel="x [m]", ylabel="z [m]", aspect="equal", title="nodes of 3 elements on exact arcs")
axes.legend()
