"""A strip that curls: growth on one side, temperature, or a muscle are strains without stress.

A bimetal strip of two layers wants a curvature in proportion to the temperature. Held at one end it takes it, and is
free of stress in any shape; held at both ends it can't, and pushes.

Insight: what is free to move shows no force at all, however far it bends; only what is prevented makes stress.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH = 0.2  # m
metal = cy.Material(density=8000.0, youngs_modulus=1.4e11, poisson_ratio=0.3)
section = cy.Section.rectangle(0.02, 0.5e-3, metal)  # bends about d1
strip = cy.Rod(section, length=LENGTH, direction=(1, 0, 0), normal=(0, 1, 0), elements=24, name="strip")
clamp = cy.supports.clamp(strip.start)


def rest_at(turn, supports):
    """Equilibrium of a strip that wants to turn by an angle from end to end."""
    wanted = cy.loads.imposed_strain(strip, (0, 0, 0, turn / LENGTH, 0, 0))
    return cy.equilibrium(cy.Model(strip, supports=supports, loads=[wanted]))


# %%
# One end held: circles, without stress. Both ends held: no motion, and a moment.
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.6), layout="constrained")
turns = np.linspace(0, 2 * np.pi, 7)
largest = 0.0
for turn in turns:
    rest = rest_at(turn, [clamp])
    x = rest[strip].position.values
    left.plot(100 * x[:, 0], 100 * x[:, 2], color=plt.cm.viridis(turn / 7), label=f"{np.degrees(turn):.0f}°")
    largest = max(largest, float(np.abs(rest[strip].moment.values).max()))
left.set(xlabel="x [cm]", ylabel="z [cm]", aspect="equal", title="held at one end: curls, without stress")
left.legend(fontsize=7)

# Both ends held: it stays straight, and the moment is EI Ω⁰ everywhere.
both = [clamp, cy.supports.clamp(strip.end)]
moments = [float(np.abs(rest_at(turn, both)[strip].moment.values[:, 0]).max()) for turn in turns[:4]]
known = section.stiffness[3, 3] * turns / LENGTH
right.plot(np.degrees(turns[:4]), moments, "o", label="held at both ends")
right.plot(np.degrees(turns[:4]), known[:4], "k-", lw=0.8, label="EI Ω⁰")
right.set(xlabel="turn it wants [°]", ylabel="moment [N m]", title="held at both ends: pushes, without motion")
right.legend()
print(f"free: largest moment {largest:.1e} N m; held: within {np.abs(np.array(moments) - known[:4]).max():.1e} N m")
assert largest < 1e-8 * known[-1]
assert np.allclose(moments, known[:4], rtol=1e-9, atol=1e-12)
plt.show()
