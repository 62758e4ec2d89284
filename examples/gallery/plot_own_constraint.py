"""A thread on a globe: a density of one's own, and a constraint of one's own.

An elastic thread slides without friction on a sphere, its ends held. The sphere is a constraint, x·x = R² in every
element, with a multiplier that is the pressure; the density is that of a string with some friction in the air.

Insight: the thread comes to rest on the great circle, the shortest way; nobody told it about geodesics.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy


def air(q, c):
    """A force against the motion, proportional to the velocity."""
    return [(-c.air * q.x_t, q.x)]


@cy.lagrangian(
    x=cy.Vector(3), s=cy.Interval, force=air, constraint=lambda q, c: (cy.dot(q.x, q.x) / c.radius - c.radius) / 2
)
def thread(q, c):
    """Mass c.mass per length, tension in proportion to the stretch, as a rubber band that has no length of its own."""
    return 0.5 * c.mass * cy.dot(q.x_t, q.x_t) - 0.5 * c.stiffness * cy.dot(q.x_s, q.x_s)


n, radius = 40, 1.0
system = cy.compile(
    thread,
    rule=cy.rules.verlet,
    domain=cy.Interval(0.0, 1.0, elements=n),
    constants={"mass": 1.0, "stiffness": 4.0, "air": 4.0, "radius": radius},
    held={"x": ("start", "end")},
)
print(system)

# %%
# The start: a detour over the north, on the sphere at the middle of every element, where the constraint holds.
turn = np.linspace(0, 0.6 * np.pi, n + 1)
latitude = 0.2 + 0.8 * np.sin(np.pi * np.linspace(0, 1, n + 1)) ** 2
path = np.stack([np.cos(latitude) * np.cos(turn), np.cos(latitude) * np.sin(turn), np.sin(latitude)], axis=1)
for k in range(n):  # node by node along the ray through the path, so that middles are on the sphere
    direction = path[k + 1] / np.linalg.norm(path[k + 1])
    b, c = path[k] @ direction, path[k] @ path[k] - 4 * radius**2
    path[k + 1] = direction * (-b + np.sqrt(b * b - c))
run = cy.integrate(system, {"x": path}, t_end=8.0, save_every=0.1)
x = run.data["x"].values

# %%
figure = plt.figure(figsize=(5.4, 4.6), layout="constrained")
axes = figure.add_subplot(projection="3d")
u, v = np.mgrid[0 : 2 * np.pi : 25j, 0 : np.pi : 13j]
axes.plot_wireframe(0.98 * np.cos(u) * np.sin(v), 0.98 * np.sin(u) * np.sin(v), 0.98 * np.cos(v), color="0.85", lw=0.5)
for shade, k in zip((0, 0.25, 0.5, 0.75, 0.95), (0, 3, 6, 10, 80), strict=True):
    axes.plot(*x[k].T, color=plt.cm.viridis(shade), lw=2, label=f"{run.time[k]:g} s")
axes.set_aspect("equal")
axes.view_init(28, 55)
axes.set_axis_off()
axes.legend(loc="upper left", fontsize=8)
middle = 0.5 * (x[-1, 1:] + x[-1, :-1])
normal = np.cross(x[-1, 0], x[-1, -1])
off = np.abs(middle @ normal / np.linalg.norm(normal)).max()
print(f"off the sphere {np.abs(np.linalg.norm(middle, axis=1) - radius).max():.0e} m, off the great circle {off:.1e} m")
assert np.abs(np.linalg.norm(middle, axis=1) - radius).max() < 1e-12
assert off < 5e-3
plt.show()
