"""A frame and a weight: two tubes at a right angle and a ball joint; damping, reactions, energy balance.

A mast is clamped at its foot, an arm welded to its top, and a weight hangs from the end of the arm. A push sets it
swinging; the material of both tubes calms the frame. What is checked: the ball joint stays closed to
round-off, the clamp carries the weight in the end, and energy, work of the push and loss add up.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy
from cayley import damping, joints, loads, supports

steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
tube = cy.Section.tube(outer_radius=0.02, thickness=0.002, material=steel)
calm = damping.retardation(5e-3)
mast = cy.Rod(tube, length=2.0, direction=(0, 0, 1), elements=8, name="mast", damping=calm)
arm = cy.Rod(tube, length=1.0, origin=(0, 0, 2), direction=(1, 0, 0), elements=6, name="arm", damping=calm)
weight = cy.Body(
    mass=2.0, inertia=np.diag([0.01, 0.01, 0.01]), position=(1, 0, 1.7), name="weight", ports={"eye": (0, 0, 0.3)}
)
ball = joints.ball(arm.end, weight.port("eye"))
model = cy.Model(
    mast,
    arm,
    weight,
    supports=[supports.clamp(mast.start)],
    joints=[joints.weld(mast.end, arm.start), ball],
    loads=[loads.gravity((0, 0, -9.81)), loads.force(weight.centre, (0, 5.0, 0), until=0.1)],
)
print(model)

run = cy.simulate(model, t_end=15.0, dt=4e-3, rule=cy.rules.galerkin(time=2), save_every=0.02)

gap = np.linalg.norm(run[arm].position.isel(node=-1).values - run.port(weight, "eye").position.values, axis=-1)
carried = float(run.reaction(mast.start).force.sel(axis="z")[-1])
hangs = float(run.joint(ball).force.sel(axis="z")[-1])
balance = run.energy_balance
print(f"largest gap in the ball joint {gap.max():.1e} m")
print(f"the clamp carries {carried:.2f} N in the end; all weigh {model.mass * 9.81:.2f} N")
print(f"the ball joint carries {hangs:.2f} N; the weight weighs {weight.mass * 9.81:.2f} N")
print(
    f"work of the push {float(balance.work[-1]):.4f} J, lost {float(balance.dissipated[-1]):.4f} J, "
    f"out of balance by {float(abs(balance.defect).max()):.1e} J"
)

assert gap.max() < 1e-12
assert abs(carried / (model.mass * 9.81) - 1.0) < 0.01
assert abs(hangs / (weight.mass * 9.81) - 1.0) < 0.02
assert abs(balance.defect).max() < 1e-3 * float(balance.work[-1])

figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.4, 4.2), sharex=True, layout="constrained")
top.plot(run.time, run[weight].position.sel(axis="y"), label="weight")
top.plot(run.time, run[arm].position.sel(axis="y").isel(node=-1), label="end of the arm")
top.set(ylabel="y [m]")
top.legend()
bottom.plot(run.time, balance.energy - float(balance.energy[0]), label="energy")
bottom.plot(run.time, balance.dissipated, label="dissipated")
bottom.plot(run.time, balance.work, "k--", label="work of the push")
bottom.set(xlabel="time [s]", ylabel="[J]")
bottom.legend()
plt.show()
