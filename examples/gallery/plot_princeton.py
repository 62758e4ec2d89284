"""The Princeton beam
==================

A flat aluminum beam with a weight at its tip, turned about its axis: it bends in both directions and twists. The
experiment is that of Dowell and Traybar (1975); beside ours are values of ANSYS's beams (Obrezkov et al. 2022).
"""

# %%
# Eight elements of degree 3. The beam's height is along y, its width along z.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH, HEIGHT, WIDTH, YOUNG, WEIGHT = 0.508, 12.3777e-3, 3.2024e-3, 71.7e9, 8.896
shear, area = YOUNG / (2.0 * 1.31), HEIGHT * WIDTH
flat, edge = HEIGHT * WIDTH**3 / 12.0, WIDTH * HEIGHT**3 / 12.0
stiffness = [shear * area, shear * area, YOUNG * area, YOUNG * flat, YOUNG * edge, shear * 0.198 * (flat + edge)]
section = cy.Section.given(stiffness=np.diag(stiffness), mass_per_length=1.0, inertia=np.eye(3))
rod = cy.Rod(section, length=LENGTH, elements=8, direction=(1, 0, 0), normal=(0, 1, 0))


def moved(angle):
    """Displacement of the tip [m] with the weight at an angle [deg] from the height."""
    turned = np.radians(angle)
    load = cy.loads.force(rod.end, WEIGHT * np.array([0.0, -np.cos(turned), np.sin(turned)]))
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[load])
    rest = cy.equilibrium(model, rule=cy.rules.galerkin(time=1, space=3))
    return rest[rod].position.values[-1] - (LENGTH, 0.0, 0.0)


# %%
# Deflections along the height and the width [m] at 8.896 N.

ANSYS = {
    0: (1.071417630e-2, 0.0),
    15: (1.061328706e-2, 4.208232124e-2),
    30: (1.011169630e-2, 7.939482948e-2),
    45: (8.837226265e-3, 0.108987937),
    60: (6.604665004e-3, 0.129887616),
    75: (3.538889001e-3, 0.142194370),
    90: (0.0, 0.146245978),
}
ours = {angle: np.abs(moved(angle)[1:]) for angle in ANSYS}
print("angle   published v, w [m]    ours, 8 elements of degree 3")
for angle, published in ANSYS.items():
    print(f"{angle:4}    {published[0]:.6f}, {published[1]:.6f}    {ours[angle][0]:.6f}, {ours[angle][1]:.6f}")
    assert np.abs(ours[angle] - published).max() < 2.5e-4

# %%

figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
angles = list(ANSYS)
for k, name in enumerate(("along the height", "along the width")):
    (line,) = axes.plot(angles, [1e3 * ours[angle][k] for angle in angles], label=name)
    axes.plot(angles, [1e3 * ANSYS[angle][k] for angle in angles], "o", color=line.get_color(), mfc="none")
axes.set(xlabel="angle of the load [deg]", ylabel="deflection [mm]", title="lines: ours, circles: ANSYS")
axes.legend()
