"""A helical spring: let go under its own weight, against the formula of spring makers; one curved rod, nothing else.

The wire's axis is a function, its shape without stress; `Rod.along` finds the length, puts frames on it that do not
twist, and the rod is at rest until the weight acts. As a spring of the rate k = G d⁴/(8 D³ n) and the mass m it is a
bar that stretches: let go, its free end falls to m g/k, twice the rest, in the time 2 √(m/k) in which a wave runs there
and back.

What must be seen, and is asserted: both, within 2 %.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

wire, mean, turns, pitch = 2e-3, 30e-3, 10, 5e-3  # diameters, number and distance of turns [m]
steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
section = cy.Section.circle(0.5 * wire, steel)


def coil(angle):
    """The axis of the wire, downward from its upper end."""
    return 0.5 * mean * np.cos(angle), 0.5 * mean * np.sin(angle), -pitch * angle / (2 * np.pi)


spring = cy.Rod.along(section, coil, span=(0.0, 2 * np.pi * turns), elements=24 * turns, name="spring")
model = cy.Model(spring, supports=[cy.supports.clamp(spring.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
run = cy.simulate(model, t_end=0.02, save_every=1e-4)

rate = steel.shear_modulus * wire**4 / (8 * mean**3 * turns)  # [N/m]
drop = -pitch * turns - run[spring].position.sel(axis="z").isel(node=-1).values
lowest, when = drop.max(), run.time[drop.argmax()]
deep, late = spring.mass * 9.81 / rate, 2 * np.sqrt(spring.mass / rate)
print(model)
print(f"deepest {1e3 * lowest:.3f} mm at {1e3 * when:.1f} ms; by hand {1e3 * deep:.3f} mm at {1e3 * late:.1f} ms")
assert abs(lowest / deep - 1) < 0.02
assert abs(when / late - 1) < 0.02

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.8), layout="constrained", width_ratios=(1, 1.6))
for k, color in ((0, "0.7"), (int(drop.argmax()), "#0072B2")):
    x, _, z = 1e3 * run[spring].position.values[k].T
    left.plot(x, z, color=color, lw=1)
left.set(xlabel="x [mm]", ylabel="z [mm]", aspect="equal", title="before and deepest")
right.plot(1e3 * run.time, 1e3 * drop)
right.plot(1e3 * late, 1e3 * deep, "k+", ms=12, label="m g/k at 2 √(m/k)")
right.set(xlabel="time [ms]", ylabel="drop of the free end [mm]")
right.legend()
plt.show()
