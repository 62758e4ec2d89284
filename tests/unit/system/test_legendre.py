"""Momenta from velocities: the Legendre transform against differences of the user's own function."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.discrete.rules import verlet
from cayley.system.legendre import initial_state, momenta_of
from unit.density.evaluation import slopes, unit_quaternions, value_of
from unit.density.examples import EXAMPLES


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("name", ["rod", "mixed", "offset_body", "two_bodies", "quartic_top", "charge", "driven"])
def test_momenta(name, rotation):
    """μ = weight × ∂T/∂v for every node, at its own place, with the linear terms of gyroscopic energies."""
    lagrangian, constants = EXAMPLES[name]
    domain = None if lagrangian.interval is None else cy.Interval(0.5, 2.0, elements=3)
    system = cy.compile(lagrangian, rule=verlet, domain=domain, constants=constants, rotation=rotation)
    layout, rng, time = system.layout, np.random.default_rng(3), 0.4
    values = rng.normal(size=(system.size, layout.rows))
    turns = {p: unit_quaternions(rng, system.size) for p in layout.rotations}
    for p, quaternions in turns.items():
        values[:, layout.rows_of(p)] = layout.representation.from_quaternion(quaternions)
    velocity = rng.normal(size=(system.size, layout.dofs))
    found = momenta_of(system, values, velocity, time)
    for node in range(system.size):
        here = turns | {k: values[:, layout.rows_of(k)] for k in layout.fields if k not in turns}
        point = {k: v[node] for k, v in here.items()} | {"t": time}
        if domain is not None:
            point |= {f"{k}_s": np.zeros(f.size) for k, f in lagrangian.fields.items()} | {"s": system.nodes[node]}

        def energy(by, node=node, point=point):
            moving = {f"{k}_t": (velocity[node] + by)[layout.dofs_of(k)] for k in layout.fields}
            return value_of(lagrangian, point | moving, constants)

        expected = system.named["weight"][node] * slopes(energy, layout.dofs)
        assert_allclose(found[node], expected, atol=1e-8)


def test_held_components_have_no_momentum():
    string, constants = EXAMPLES["string"]
    domain = cy.Interval(0.0, 1.0, elements=2)
    system = cy.compile(string, rule=verlet, domain=domain, constants=constants, held={"x": ("start", 1)})
    state = initial_state(system, system.reference, np.ones((3, 3)), time=2.5)
    assert_allclose(state.momenta, [[0.0] * 3, [0.0] * 3, [0.1 * 0.25] * 3])
    assert (state.time, state.step) == (2.5, 0)


def test_velocity_of_a_held_field_moves_nothing():
    """ẋ couples with ω in the kinetic energy; held, it takes no part in the angular momentum."""
    body, constants = EXAMPLES["offset_body"]
    for held, expected in (({}, False), ({"x": 0}, True)):
        system = cy.compile(body, rule=verlet, constants=constants, held=held)
        momenta = [
            initial_state(system, system.reference, np.array([[0.1, 0.2, 0.3, *v]])).momenta
            for v in ((0.0, 0.0, 0.0), (1.0, -2.0, 3.0))
        ]
        assert np.array_equal(momenta[0][:, :3], momenta[1][:, :3]) == expected


@pytest.mark.parametrize("rule", [verlet, cy.rules.midpoint, cy.rules.spectral(space=2)], ids=str)
def test_signs_of_neighbors_do_not_matter(rule):
    """The quaternions p and -p are one rotation: a start with signs by chance runs as one with all alike."""
    rod = cy.Rod(
        cy.Section.circle(0.02, cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)),
        length=1.0,
        direction=(1, 0, 0),
        elements=4,
    )
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[cy.loads.gravity((0.0, 0.0, -9.81))])
    count = 4 * rule.degree + 1
    signs = np.where(np.arange(count) % 3 == 1, -1.0, 1.0)[:, None]
    runs = [
        cy.simulate(model, 0.05, 2e-4, rule=rule, initial={rod: {"rotation": sign * np.asarray(rod.rotation)}})
        for sign in (np.ones((count, 1)), signs)
    ]
    assert np.array_equal(*(run[rod].position.values for run in runs))
