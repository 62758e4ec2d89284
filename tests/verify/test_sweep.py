"""Rods over many powers of ten, with ``accuracy=1e-2`` and nothing else; benchmarks/sweep.py does 200 of them."""

import numpy as np
import pytest

import cayley as cy
from cayley import loads, supports

RODS = [
    # modulus, radius, length, density
    (1e4, 0.02, 1.0, 1000.0),  # jelly
    (5e6, 1e-3, 0.3, 1100.0),  # rubber thread
    (3e9, 5e-3, 2.0, 1200.0),  # plastic tube, full
    (2e11, 1e-4, 0.1, 7850.0),  # steel hair
    (2e11, 0.1, 100.0, 7850.0),  # steel mast
]


@pytest.mark.parametrize(("modulus", "radius", "length", "density"), RODS)
def test_a_rod_finishes_within_its_accuracy(modulus, radius, length, density):
    """Clamped, pushed at its end by twice EI/l² for a third of its slowest period; against a quarter of the step."""
    material = cy.Material(density=density, youngs_modulus=modulus, poisson_ratio=0.3)
    rod = cy.Rod(cy.Section.circle(radius, material), length=length, direction=(1, 0, 0), elements=10)
    stiffness = modulus * np.pi * radius**4 / 4.0
    period = 2.0 * np.pi / 3.516 * length**2 * np.sqrt(density * np.pi * radius**2 / stiffness)
    push = loads.force(rod.end, (0.0, 0.6 * stiffness / length**2, 1.9 * stiffness / length**2))
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[push])
    run = cy.simulate(model, period / 3.0, accuracy=1e-2)
    again = cy.simulate(model, period / 3.0, 0.25 * run.dt, rule=cy.rules.by_name(str(run.rule)))
    error = np.abs(run[rod].position.values[-1] - again[rod].position.values[-1]).max() / length
    moved = np.abs(run[rod].position.values[-1] - run[rod].position.values[0]).max() / length
    assert error < 1e-2 < 0.1 < moved
    assert run.error_estimate <= 1e-2
    assert str(run.rule) in run.why
