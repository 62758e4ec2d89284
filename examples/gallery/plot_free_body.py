"""A body thrown into the air: why it flips about its middle axis, against Jacobi's elliptic functions.

A rigid body without any force turns steadily about its axes of the least and of the largest inertia, but not about
the one in between: started there it flips over, again and again (Dzhanibekov). Jacobi solved the motion in 1849: ω =
(a₁ cn λt, a₂ sn λt, a₃ dn λt).

Insight: nothing is normalized and nothing drifts, so the flips come at the right time, turn after turn.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import ellipj, ellipkinc

import cayley as cy

inertia = np.array([1.0, 2.0, 3.0])


def jacobi(start, t):
    """Angular velocity of a free body whose angular momentum circles the axis of the largest inertia."""
    i1, i2, i3 = inertia
    twice, square = inertia @ start**2, inertia**2 @ start**2
    a1 = np.sqrt((twice * i3 - square) / (i1 * (i3 - i1)))
    a2 = np.sqrt((twice * i3 - square) / (i2 * (i3 - i2)))
    a3 = np.sqrt((square - twice * i1) / (i3 * (i3 - i1)))
    rate = np.sqrt((i3 - i2) * (square - twice * i1) / (i1 * i2 * i3))
    m = (i2 - i1) * (twice * i3 - square) / ((i3 - i2) * (square - twice * i1))
    phase = ellipkinc(np.arctan2(start[1] / a2, start[0] / a1), m)
    sn, cn, dn, _ = ellipj(rate * t + phase, m)
    return np.stack([a1 * cn, a2 * sn, a3 * dn], axis=1)


def thrown(start, t_end, dt):
    """The run of a body with an angular velocity in its own frame."""
    body = cy.Body(mass=1.0, inertia=inertia)
    model = cy.Model(body)
    rule = cy.rules.galerkin(time=2)
    run = cy.simulate(model, t_end, dt, rule=rule, save_every=0.05, initial={body: {"angular_velocity": start}})
    return run, run[body].angular_velocity.values


# %%
# A wobble about the third axis, and a flip: a start that is 1 % off the second one.
starts = np.array([0.3, 0.2, 1.0]), np.array([0.0, 1.0, 0.01])
figure, panels = plt.subplots(2, 1, figsize=(7.4, 4.4), layout="constrained")
for axes, start, title in zip(panels, starts, ("about the third axis", "about the middle axis"), strict=True):
    run, found = thrown(start, 30.0, 0.05)
    exact = jacobi(start, run.time)
    for k, color in enumerate(("#0072B2", "#D55E00", "#009E73")):
        axes.plot(run.time, exact[:, k], color=color, lw=3, alpha=0.3)
        axes.plot(run.time, found[:, k], color=color, lw=1, label=f"$\\omega_{k + 1}$")
    axes.set(title=f"started {title}", ylabel="ω [rad/s]", xlim=(0, 30))
    print(f"{title}: error at 30 s {np.abs(found[-1] - exact[-1]).max():.1e} rad/s")
    assert np.abs(found - exact).max() < 2e-4
panels[1].set_xlabel("time [s]; wide and pale: Jacobi")
panels[0].legend(loc="right")

# %%
# The published point: ω(10 s) of the first body.
run, found = thrown(starts[0], 10.0, 0.02)
assert np.abs(found[-1] - (-0.1571329690, -0.3245138365, 0.9890552344)).max() < 1e-6
assert np.abs(jacobi(starts[0], np.array([10.0]))[0] - (-0.1571329690, -0.3245138365, 0.9890552344)).max() < 1e-9
plt.show()
