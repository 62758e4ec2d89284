"""A density nobody wrote for the library: Daniel Bernoulli's hanging chain, and its lowest tone.

A heavy string hangs from one end. Pulled aside, it swings in modes that Bernoulli found in 1732: the displacement is
y = J₀(j √(1 - s/ℓ)) cos ωt with ω = ½ j √(g/ℓ), where J₀ is the Bessel function he had to invent for it and
j = 2.404826 is its first zero. So the period is not that of a pendulum of the same length, nor of a rod.

All the library is told is the Lagrangian density: kinetic energy, stretching energy, weight. It finds the inertia,
what is strain and what is load, that all nodes are explicit, and the stable step. The string is stiff, so that its
stretch (1e-4) does not matter; the start is its hanging equilibrium plus a thousandth of the first mode.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import j0, jn_zeros

import cayley as cy


@cy.lagrangian(x=cy.Vector(3), s=cy.Interval)
def chain(q, c):
    """Mass c.mass per length, stiffness c.stiffness against stretch, none against bending; s from the top down."""
    stretch = cy.norm(q.x_s) - 1.0
    return 0.5 * c.mass * cy.dot(q.x_t, q.x_t) - 0.5 * c.stiffness * stretch**2 + c.mass * cy.dot(c.gravity, q.x)


length, mass, g, elements = 1.0, 0.2, 9.81, 100
weight = mass * length * g
stiffness = 1e4 * weight
system = cy.compile(
    chain,
    rule=cy.rules.verlet,
    domain=cy.Interval(0.0, length, elements=elements),
    constants={"mass": mass, "stiffness": stiffness, "gravity": np.array([0.0, 0.0, -g])},
    held={"x": "start"},
)
print(system)  # what was found

# equilibrium: every element carries the weight below its middle
s = system.nodes
middle = 0.5 * (s[1:] + s[:-1])
hanging = np.append(0.0, np.cumsum(np.diff(s) * (1.0 + weight * (1.0 - middle / length) / stiffness)))
zero = jn_zeros(0, 1)[0]
amplitude = 1e-3 * length
shape = amplitude * j0(zero * np.sqrt(1.0 - s / length))
start = np.stack([shape, 0 * s, -hanging], axis=1)

period = 4.0 * np.pi / zero * np.sqrt(length / g)
run = cy.integrate(system, {"x": start}, t_end=period, save_every=period / 100)
x = run.data["x"].sel(axis="x").values  # (time, node)
energy = run.energy.values
swing = amplitude**2 * weight / length  # the order of the energy in the swing

quarter, end = x[25, -1] / amplitude, x[-1, -1] / amplitude
print(f"period {period:.4f} s; tip after a quarter of it {quarter:.1e} of the amplitude, after all of it {end:.5f}")
print(f"shape after one period differs by {np.abs(x[-1] - shape).max() / amplitude:.1e} of the amplitude")
print(f"energy ripple {np.ptp(energy) / swing:.1e} of the energy in the swing")
assert abs(quarter) < 1e-3
assert np.abs(x[-1] - shape).max() < 1e-3 * amplitude
assert np.ptp(energy) < 1e-3 * swing

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.4), layout="constrained")
left.plot(x[-1] / amplitude, s, label="after one period")
left.plot(shape[::8] / amplitude, s[::8], "k.", label="Bernoulli's J₀")
left.invert_yaxis()
left.set(xlabel="displacement over amplitude", ylabel="s [m]")
left.legend()
right.plot(run.time, x[:, -1] / amplitude)
right.plot(run.time, np.cos(2 * np.pi * run.time / period), "k--", lw=0.8, label="cos ωt")
right.set(xlabel="time [s]", ylabel="tip over amplitude")
right.legend()
plt.show()
