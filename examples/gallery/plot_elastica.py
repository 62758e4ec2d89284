r"""The elastica
============

A slender cantilever under a transverse dead force, :math:`F l^2/EI` from 0.5 to 16, against elliptic integrals
(Mattiasson 1981).
"""

# %%
# A rod of length and bending stiffness one whose shear and stretch are too stiff to show; 16 elements of degree 3.

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy

section = cy.Section.given(stiffness=np.diag([1e9, 1e9, 1e9, 1, 1, 1]), mass_per_length=1.0, inertia=np.eye(3))
rod = cy.Rod(section, length=1.0, elements=16, direction=(1, 0, 0), normal=(0, 1, 0))
TABLE = {  # shortening and deflection over the length
    0.5: (0.0159189625, 0.1621435757),
    1.0: (0.0564332363, 0.3017207738),
    2.0: (0.1606417208, 0.4934574804),
    5.0: (0.3876283607, 0.7137915236),
    10.0: (0.5549955978, 0.8106090249),
    16.0: (0.6467725851, 0.8527469783),
}

# %%
# Each solution starts from the one before.

shapes, rest = {}, None
print("F l²/EI   published u/l, w/l             ours, 16 elements of degree 3")
for force, published in TABLE.items():
    load = cy.loads.force(rod.end, (0, 0, force))
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[load])
    rest = cy.equilibrium(model, rule=cy.rules.galerkin(time=1, space=3), start=rest)
    x, _, z = rest[rod].position.values.T
    shapes[force] = x, z
    print(f"{force:5g}     {published[0]:.10f}, {published[1]:.10f}   {1.0 - x[-1]:.10f}, {z[-1]:.10f}")
    assert np.abs(np.subtract(published, (1.0 - x[-1], z[-1]))).max() < 1e-6

# %%

figure, axes = plt.subplots(figsize=(6.0, 4.5), layout="constrained")
for force, (x, z) in shapes.items():
    (line,) = axes.plot(x, z, label=f"{force:g}")
    axes.plot(1.0 - TABLE[force][0], TABLE[force][1], "o", color=line.get_color())
axes.set(xlabel="x/l", ylabel="z/l", aspect="equal", title="shapes, and published tips")
axes.legend(title="$F l^2/EI$")
