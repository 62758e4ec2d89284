"""A chain that cannot stretch: Daniel Bernoulli's hanging chain again, with a constraint instead of a stiff spring.

The chain of own_density_string.py keeps its length by a stiffness of 1e4 times its weight, and the speed of its
stretching waves bounds the step. Here ‖x′‖ = 1 holds by Lagrange multipliers in every element, so nothing is left that
vibrates faster than the chain swings. The lowest mode is y = J₀(j √(1 - s/ℓ)) cos ωt with ω = ½ j √(g/ℓ), j = 2.404826.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import j0, jn_zeros

import cayley as cy


@cy.lagrangian(x=cy.Vector(3), s=cy.Interval, constraint=lambda q, c: cy.dot(q.x_s, q.x_s) - 1.0)
def chain(q, c):
    """Mass c.mass per length and its weight; no stiffness at all."""
    return 0.5 * c.mass * cy.dot(q.x_t, q.x_t) + c.mass * cy.dot(c.gravity, q.x)


length, g, elements = 1.0, 9.81, 50
system = cy.compile(
    chain,
    rule=cy.rules.verlet,
    domain=cy.Interval(0.0, length, elements=elements),
    constants={"mass": 0.2, "gravity": np.array([0.0, 0.0, -g])},
    held={"x": "start"},
)
print(system)

s, zero, amplitude = system.nodes, jn_zeros(0, 1)[0], 1e-3
shape = amplitude * j0(zero * np.sqrt(1.0 - s / length))
aside = np.diff(shape)
down = np.append(0.0, np.cumsum(np.sqrt((length / elements) ** 2 - aside**2)))  # so that every link has its length
shape -= shape[0]
period = 4.0 * np.pi / zero * np.sqrt(length / g)
run = cy.integrate(system, {"x": np.stack([shape, 0 * s, -down], axis=1)}, period, 1e-3, save_every=period / 100)

x = run.frames.values
links = np.linalg.norm(np.diff(x, axis=1), axis=2) * elements
print(f"{run.steps} steps of {run.dt:.2g} s; links differ from their length by {np.abs(links - 1.0).max():.0e}")
print(f"shape after one period differs by {np.abs(x[-1, :, 0] - shape).max() / amplitude:.1e} of the amplitude")
assert np.abs(links - 1.0).max() < 1e-12
assert np.abs(x[-1, :, 0] - shape).max() < 5e-3 * amplitude

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.6), layout="constrained")
for k in range(0, 51, 10):
    left.plot(1e3 * x[k, :, 0], x[k, :, 2], color=plt.cm.viridis(k / 60), label=f"{run.time[k]:.2f} s")
left.set(xlabel="x [mm]", ylabel="z [m]", title="half a period")
left.legend(fontsize=7)
right.plot(run.time, np.abs(links - 1.0).max(axis=1))
right.set(xlabel="time [s]", ylabel="largest stretch of a link [-]", title="rounding, and no more")
plt.show()
