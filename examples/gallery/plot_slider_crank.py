"""Slider-crank: a motor turns the crank at a steady rate; what does the bearing of the block feel?

The crank follows a prescribed angle, so the hinge to the ground is a motor whose torque is a multiplier; the block
slides on a rail. Positions are those of school geometry, x = r cos φ + √(ℓ² − r² sin² φ).

Insight: forces of joints follow from each saved state by Newton's law, so they are as exact as the state and need no
filter.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

CRANK, ROD, RATE = 0.1, 0.35, 20.0  # m, m, rad/s

pin, block_at = np.array([CRANK, 0.0, 0.0]), np.array([CRANK + ROD, 0.0, 0.0])
crank = cy.Body(
    mass=1.0,
    inertia=[1e-3] * 3,
    position=0.5 * pin,
    ports={"near": -0.5 * pin, "far": 0.5 * pin},
    name="crank",
)
half = 0.5 * (block_at - pin)
rod = cy.Body(mass=0.5, inertia=[1e-4, 5e-3, 5e-3], position=pin + half, ports={"near": -half, "far": half}, name="rod")
block = cy.Body(mass=2.0, inertia=[1e-3] * 3, position=block_at, name="block")

motor = cy.joints.hinge(crank.port("near"), axis=(0, 1, 0), angle=lambda t: -RATE * t)
rail = cy.supports.slide(block.centre, (1, 0, 0))
model = cy.Model(
    crank,
    rod,
    block,
    supports=[rail],
    joints=[
        motor,
        cy.joints.ball(crank.port("far"), rod.port("near")),
        cy.joints.universal(rod.port("far"), block.centre, axis=(0, 0, 1), other=(0, 1, 0)),
    ],
    loads=[cy.loads.gravity((0, 0, -9.81))],
)
turn = 2 * np.pi / RATE
run = cy.simulate(model, 2 * turn, turn / 400, rule=cy.rules.midpoint, save_every=turn / 100)

phi = RATE * run.time
place = CRANK * np.cos(phi) + np.sqrt(ROD**2 - (CRANK * np.sin(phi)) ** 2)
found = run[block].position.values[:, 0]
torque = run.joint(motor).moment.sel(axis="y").values
force = run.reaction(rail).force.sel(axis="z").values

# %%
figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.4, 4.4), sharex=True, layout="constrained")
top.plot(phi / (2 * np.pi), found, label="block")
top.plot(phi[::10] / (2 * np.pi), place[::10], "k.", ms=4, label="geometry")
top.set(ylabel="place on the rail [m]")
top.legend()
bottom.plot(phi / (2 * np.pi), force, label="rail on the block, z [N]")
bottom.plot(phi / (2 * np.pi), torque, label="torque of the motor [N m]")
bottom.axhline(0, color="k", lw=0.6)
bottom.set(xlabel="turns of the crank")
bottom.legend()
print(f"place of the block within {np.abs(found - place).max():.1e} m; rail at most {np.abs(force).max():.0f} N")
assert np.abs(found - place).max() < 1e-10
plt.show()
