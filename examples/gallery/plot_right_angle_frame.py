"""A right-angle frame that buckles sideways
=========================================

Two thin legs, welded at a right angle, are clamped at one end and pulled in their plane at the other. They are so thin
that the frame tips out of its plane (Argyris et al. 1979), at 1.088 N (Nachbagauer et al. 2013; Simo and Vu-Quoc 1986:
1.09 N).
"""

# %%
# Legs of 0.24 m, 30 mm high and 0.6 mm thick, of 8 two-node elements each.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH, HEIGHT, WIDTH, YOUNG = 0.24, 0.03, 0.0006, 7.124e10
PUBLISHED = 1.088
shear, area = YOUNG / 2.62, HEIGHT * WIDTH
weak, strong = HEIGHT * WIDTH**3 / 12.0, WIDTH * HEIGHT**3 / 12.0
stiffness = [shear * area, shear * area, YOUNG * area, YOUNG * weak, YOUNG * strong, shear * HEIGHT * WIDTH**3 / 3.0]
section = cy.Section.given(stiffness=np.diag(stiffness), mass_per_length=1.0, inertia=1e-6 * np.eye(3))


def frame(elements, sideways=0.0):
    """The frame in the plane of x and y, and the pull at its end, per newton, turned out of the plane a little."""
    more = {"length": LENGTH, "elements": elements}
    first = cy.Rod(section, direction=(1, 0, 0), normal=(0, 1, 0), name="first", **more)
    second = cy.Rod(section, origin=(LENGTH, 0, 0), direction=(0, -1, 0), normal=(1, 0, 0), name="second", **more)
    pull = cy.loads.force(second.end, (1.0, 0.0, sideways))
    corner = cy.joints.weld(first.end, second.start)
    return cy.Model(first, second, supports=[cy.supports.clamp(first.start)], joints=[corner], loads=[pull]), pull


# %%
# The critical load by linear buckling, on three meshes, and on the path of the loaded frame.

print("force at which the frame buckles [N]; published 1.088 (2013) and 1.09 (1986)")
for elements, within in ((4, 2e-2), (8, 3e-3), (16, 3e-3)):
    found = cy.buckling(*frame(elements)).factors[0]
    print(f"ours, linear, {elements:2} elements a leg   {found:.4f}")
    assert abs(found / PUBLISHED - 1.0) < within
model, pull = frame(8)
flat = cy.trace(model, pull, range=(0.0, 2.0), step=0.2)
critical = flat.bifurcations[0].parameter
print(f"ours, path,    8 elements a leg   {critical:.4f}")
assert abs(critical / PUBLISHED - 1.0) < 3e-3

# %%
# Behind it the frame tips to either side; with a thousandth of the load out of the plane it follows one of them.

sides = [flat.branch(direction=side, range=(0.5, 1.4), step=0.2) for side in (1, -1)]
crooked = cy.trace(*frame(8, sideways=1e-3), range=(0.0, 1.4), step=0.2, points=600)


def aside(path):
    """Displacement of the loaded end out of the plane [m]."""
    return path["second"].position.values[:, -1, 2]


assert abs(aside(sides[0])[-1] + aside(sides[1])[-1]) < 1e-6
assert sides[0].unstable[1:].max() == 0
figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
for k, path in enumerate(sides):
    axes.plot(1e3 * aside(path), path.parameter, color="C0", label=None if k else "buckled")
axes.plot(1e3 * aside(crooked), crooked.parameter, color="C1", label="pulled askew")
axes.plot((0, 0), (0, critical), color="0.5", label="in its plane")
axes.plot((0, 0), (critical, 1.4), ":", color="0.5", label="in its plane, unstable")
axes.plot(0.0, PUBLISHED, "o", mfc="none", color="C2", label="published")
axes.set(xlabel="end out of the plane [mm]", ylabel="force [N]", ylim=(0.0, 1.45))
axes.legend(loc="lower left")
