"""A blade that turns: its frequencies over the speed, where a load meets them, and a run that rings as they say.

A steel blade of 8 m, 0.3 m wide and 60 mm thick, turns about its root. In the frame that turns with it the blade rests,
stretched by centrifugal forces; small motions about that state have Coriolis forces. What is checked: the flap
frequencies are those of Wright, Smith, Thresher and Wang (1982), and a driven blade that is let go along a mode moves
at its frequency.
"""

import numpy as np

import cayley as cy
from cayley import joints, supports
from cayley.report import vibration

steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
plate = cy.Section.rectangle(width=0.3, height=0.06, material=steel)
blade = cy.Rod(plate, length=8.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=24, name="blade")
model = cy.Model(blade, supports=[supports.clamp(blade.start)])

# speeds and frequencies over sqrt(EI/(m l^4)): of flapping, without shear
wright = {0: (3.5160, 22.0345), 2: (4.1373, 22.6149), 4: (5.5850, 24.2733), 6: (7.3604, 26.8091), 8: (9.2568, 29.9954)}
unit = np.sqrt(plate.stiffness[3, 3] / plate.mass_per_length) / blade.length**2
diagram = cy.campbell(model, unit * np.array(list(wright)), count=4)
print(diagram)
flap = 2.0 * np.pi * diagram.frequency.sel(mode=[0, 2]).values / unit
for (speed, table), found in zip(wright.items(), flap, strict=True):
    print(f"speed {speed}: flap {found[0]:7.4f} {found[1]:8.4f}, published {table[0]:7.4f} {table[1]:8.4f}")
print("a load fixed in space meets a mode twice a turn at", diagram.crossings(2).round(2), "rad/s")
assert np.abs(flap / np.array(list(wright.values())) - 1.0).max() < 5e-3

spin = 8.0 * unit
modes = cy.modes(model, about=cy.equilibrium(model, spin=spin), count=4)
print(modes)
hinge = joints.hinge(blade.start, cy.ground, axis=(0, 0, 1), angle=lambda t: spin * t, name="hub")
driven = model.replace(supports=[], joints=[hinge])
step = 2.0 * np.pi / float(modes.angular_frequency[1]) / 200.0
run = cy.simulate(
    driven, start=modes.state(1, 0.05), t_end=400 * step, dt=step, rule=cy.rules.midpoint, save_every=step
)
tip = run[blade].position.isel(node=-1).values
sideways = np.cos(spin * run.time) * tip[:, 1] - np.sin(spin * run.time) * tip[:, 0]
around = sideways[2:] + sideways[:-2]
found = np.arccos(0.5 * (sideways[1:-1] @ around) / (sideways[1:-1] @ sideways[1:-1])) / step / (2.0 * np.pi)
print(f"mode 1 at {spin:.3g} rad/s: {float(modes.frequency[1]):.4f} Hz, in a run {found:.4f} Hz")
assert abs(found / float(modes.frequency[1]) - 1.0) < 2e-3

figure = vibration.campbell(diagram)
