"""Kapitza's pendulum: a stick that stands on its lower end, because its pivot shakes.

Stephenson (1908) and Kapitza (1951): a pendulum stands upright if its pivot is shaken up and down fast enough, (a ω)²
> 2 g ℓ, with a and ω of the shaking and ℓ the length of the pendulum reduced to a point. The pivot here is a driven
support, its motion a function of the time.

Insight: a prescribed motion is a constraint like any other, met exactly at every step, and its work is in the
account.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

LENGTH, MASS, SHAKE, GRAVITY = 0.3, 0.2, 0.01, 9.81  # m, kg, m, m/s²
reduced = 2 / 3 * LENGTH
needed = np.sqrt(2 * GRAVITY * reduced) / SHAKE  # rad/s
lean = 0.15  # rad


def stand(rate):
    """A second and a half of a stick that leans a little, its foot shaken at a rate [rad/s]: the run and the angle."""
    up = np.array([np.sin(lean), 0.0, np.cos(lean)])
    stick = cy.Body(
        mass=MASS,
        inertia=[MASS * LENGTH**2 / 12] * 3,
        position=0.5 * LENGTH * up,
        ports={"foot": -0.5 * LENGTH * up, "top": 0.5 * LENGTH * up},
        name="stick",
    )
    shaker = cy.supports.drive(stick.port("foot"), position=lambda t: (0.0, 0.0, SHAKE * (1 - np.cos(rate * t))))
    model = cy.Model(stick, supports=[shaker], loads=[cy.loads.gravity((0, 0, -GRAVITY))])
    run = cy.simulate(model, t_end=1.5, dt=5e-4, rule=cy.rules.verlet, save_every=2e-3, balance=True)
    foot, top = (run.port(stick, name).position.values for name in ("foot", "top"))
    return run, np.degrees(np.arctan2(*(top - foot)[:, [0, 2]].T)), foot[:, 2]


# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.4), layout="constrained")
for factor, color in ((1.4, "#0072B2"), (0.8, "#D55E00")):
    run, angle, foot = stand(factor * needed)
    left.plot(run.time, np.unwrap(angle, period=360), color=color, lw=1, label=f"ω = {factor:g} of what is needed")
    right.plot(run.time, run.energy_balance.work, color=color, lw=0.6)
    exact = SHAKE * (1 - np.cos(factor * needed * run.time))
    print(
        f"{factor:g}: largest angle {np.abs(angle).max():.0f}°, foot as told within {np.abs(foot - exact).max():.0e} m"
    )
    assert (np.abs(angle).max() < 30) == (factor > 1)
    assert np.abs(foot - exact).max() < 1e-12
left.set(xlabel="time [s]", ylabel="angle from the upright [°]", ylim=(-60, 200))
left.legend(fontsize=7)
right.set(xlabel="time [s]", ylabel="work of the shaker [J]", xlim=(0, 0.2))
plt.show()
