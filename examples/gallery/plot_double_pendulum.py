"""Double pendulum: two bars on hinges, chaos, and an energy that does not care.

Two pendulums start a millionth of a radian apart. Their paths part after some seconds, however exact the steps are.

Insight: of a chaotic motion no single path can be computed for long, but its energy and the hinges hold all the time.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy


def pendulum(angle):
    """Two bars of 1 m and 1 kg: the upper one at an angle from the vertical, the lower one level."""
    knee = np.array([np.sin(angle), 0.0, -np.cos(angle)])
    tip = knee + np.array([1.0, 0.0, 0.0])
    upper, lower = (
        cy.Body(
            mass=1.0,
            inertia=[1 / 12] * 3,
            position=0.5 * (a + b),
            ports={"near": 0.5 * (a - b), "far": 0.5 * (b - a)},
            name=name,
        )
        for a, b, name in ((np.zeros(3), knee, "upper"), (knee, tip, "lower"))
    )
    hinges = [
        cy.joints.hinge(upper.port("near"), axis=(0, 1, 0)),
        cy.joints.hinge(upper.port("far"), lower.port("near"), axis=(0, 1, 0)),
    ]
    return cy.Model(upper, lower, joints=hinges, loads=[cy.loads.gravity((0, 0, -9.81))])


runs = [cy.simulate(pendulum(2.0 + d), 12.0, 2e-3, rule=cy.rules.midpoint, save_every=0.01) for d in (0.0, 1e-6)]
one, two = (run.port("lower", "far").position.values for run in runs)
knee = runs[0].port("upper", "far").position.values

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.4), layout="constrained")
left.plot(one[:, 0], one[:, 2], lw=0.7, color="#0072B2", label="tip")
left.plot(two[:, 0], two[:, 2], lw=0.7, color="#D55E00", label="tip, 1e-6 rad off")
left.plot(*np.array([[0, 0], knee[0, [0, 2]], one[0, [0, 2]]]).T, "k-o", lw=2, ms=4)
left.set(xlabel="x [m]", ylabel="z [m]", title="12 seconds", aspect="equal")
left.legend(loc="lower center", bbox_to_anchor=(0.5, -0.45), ncols=2, fontsize=7)
apart = np.linalg.norm(one - two, axis=1)
energy = runs[0].energy.values
right.semilogy(runs[0].time[1:], apart[1:], label="distance of the two tips [m]")
right.semilogy(runs[0].time[1:], np.abs(energy - energy[0])[1:], label="change of the energy [J]")
right.set(xlabel="time [s]", title="what parts and what stays")
right.legend()
gap = np.abs(np.linalg.norm(knee, axis=1) - 1.0).max()
print(f"tips apart by {apart[-1]:.2f} m; energy within {np.ptp(energy):.1e} J; hinge closed to {gap:.0e} m")
assert apart.max() > 0.1
assert np.ptp(energy) < 5e-2
assert gap < 1e-12
plt.show()
