"""Elements of a higher degree: order 2m in space, the tips of the prototype, and energies by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import cayley as cy
from cayley.discrete.rules import lagrange, lobatto
from cayley.lie import quaternion
from cayley.system.compile import chain_nodes
from verify.problems import bend, fitted, in_flight

galerkin = cy.rules.galerkin


def pendulum(elements, *, weight=9.81):
    """The rubber pendulum of the benchmarks, horizontal, pinned at the origin."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(5e-3, rubber, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    gravity = cy.loads.gravity((0.0, 0.0, -weight))
    return rod, cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[gravity])


def positions(run):
    """Of all nodes, also those inside elements."""
    return run.frames.values[..., run.system.layout.rows_of("x")]


def refined(rod, degree):
    """What ``bend`` and ``in_flight`` ask of a rod, with the nodes inside its elements."""
    nodes = chain_nodes(np.asarray(rod.nodes), degree)
    return SimpleNamespace(nodes=nodes, positions=rod.positions, rotation=rod.rotation, elements=len(nodes) - 1)


def turning(rod, degree, curvature=2.0):
    """A start without jumps: bent by κ sin⁴(π s/l), and turning about the pin as a rigid body."""
    fine = refined(rod, degree)
    return {rod: in_flight(fine, bend(fine, curvature), velocity=(0.0, 0.0, 0.0), spin=(1.0, 5.0, -8.0))}


def swing(elements, degree):
    """Positions at the quarters of a weightless pendulum, ten times in 0.01 s: the free end moves by 0.1 m."""
    rod, model = pendulum(elements, weight=0.0)
    start = turning(rod, degree)
    run = cy.simulate(model, 0.01, 1e-4, rule=galerkin(time=3, space=degree), save_every=1e-3, initial=start)
    return positions(run)[1:, :: elements * degree // 4]


def block(elements, degree):
    """The same of a clamped rubber block of 0.4 m by 1 m, bent by a radian, ten times in 6 ms."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(0.2, rubber, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)])
    start = {rod: bend(refined(rod, degree), 3.0)}
    run = cy.simulate(model, 6e-3, 2e-4, rule=galerkin(time=3, space=degree), save_every=6e-4, initial=start)
    return positions(run)[1:, :: elements * degree // 4]


def observed_order(motion, degree, meshes, exact):
    """Slope of a straight line through the errors of meshes, all above what steps and reference leave."""
    errors = np.array([np.linalg.norm(motion(n, degree) - exact) for n in meshes])
    assert errors[-1] > 5e-9, errors
    return fitted(1.0 / np.array(meshes), errors)


@pytest.fixture(scope="module")
def exact_block():
    return block(48, 4)


@pytest.fixture(scope="module")
def exact_swing():
    return swing(24, 5)


@pytest.mark.parametrize(
    ("degree", "meshes"), [(1, (16, 24, 32, 64)), (2, (20, 24, 32, 48)), (3, (20, 24, 28, 32))], ids=["1", "2", "3"]
)
def test_order_in_space(degree, meshes, exact_block):
    """Order 2m once elements are no longer than the rod is thick."""
    observed = observed_order(block, degree, meshes, exact_block)
    assert abs(observed - 2 * degree) < 0.3, observed


@pytest.mark.parametrize(
    ("degree", "meshes", "expected"),
    [(1, (8, 16, 32, 64), 2.0), (2, (8, 12, 16, 24), 3.9), (3, (8, 12, 16), 5.3)],
    ids=["1", "2", "3"],
)
def test_order_in_space_of_a_slender_rod(degree, meshes, expected, exact_swing):
    """The rubber pendulum, whose elements are 4 to 12 diameters long: a little less than 2m."""
    observed = observed_order(swing, degree, meshes, exact_swing)
    assert abs(observed - expected) < 0.3, observed


@pytest.mark.parametrize(
    ("time", "space", "elements", "h", "expected"),
    [
        (2, 2, 10, 0.01, (-0.93982504, 0.0, -0.09949865)),
        (2, 2, 20, 0.005, (-0.94007123, 0.0, -0.09914458)),
        (3, 3, 12, 0.008, (-0.94009324, 0.0, -0.09909941)),
    ],
)
def test_tip_of_the_rubber_pendulum(time, space, elements, h, expected):
    """After 1 s, against an independent program."""
    _, model = pendulum(elements)
    run = cy.simulate(model, 1.0, h, rule=galerkin(time=time, space=space), save_every=1.0)
    np.testing.assert_allclose(positions(run)[-1, -1], expected, atol=2e-7)


def test_long_steps_of_the_rubber_pendulum():
    """Three elements and 25 steps for the swing of a second: as near as the mesh allows."""
    _, model = pendulum(3)
    run = cy.simulate(model, 1.0, 0.04, rule=galerkin(time=3, space=3), save_every=1.0)
    np.testing.assert_allclose(positions(run)[-1, -1], (-0.94009, 0.0, -0.09910), atol=0.02)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_energy_by_hand(degree):
    """T = Σ w (½ m ẋ·ẋ + ½ ω·Jω), V = Σ over elements and Gauss points of ½ ε·Cε, less Σ w m g·x, in plain NumPy."""
    rod, model = pendulum(4)
    rule = galerkin(time=2, space=degree)
    run = cy.simulate(model, 0.05, 1e-3, rule=rule, save_every=5e-3, initial=turning(rod, degree, curvature=1.0))
    system, section = run.system, rod.section
    weight, layout = system.named["weight"][:, None], system.layout
    x, p = positions(run), run.frames.values[..., layout.rows_of("p")]
    mx, mp = (run.frames.momenta[..., layout.dofs_of(name)] for name in ("x", "p"))
    mass, inertia = section.mass_per_length, np.diag(section.inertia)
    kinetic = 0.5 * (mx**2 / (weight * mass) + mp**2 / (weight * inertia)).sum(axis=(1, 2))
    potential = 9.81 * mass * (weight[:, 0] * x[..., 2]).sum(axis=1)
    phi, psi = lagrange(lobatto(degree), rule.strain.at)
    for e in range(rod.elements):
        own, length = slice(e * degree, (e + 1) * degree + 1), rod.element_length
        for k, share in enumerate(rule.strain.weights):
            z, slope, tangent = phi[k] @ p[:, own], psi[k] @ p[:, own] / length, psi[k] @ x[:, own] / length
            square = (z**2).sum(axis=1, keepdims=True)
            gamma = quaternion.inverse_rotate(z / np.sqrt(square), tangent) - np.array([0.0, 0.0, 1.0])
            bending = 2.0 * quaternion.multiply(quaternion.conjugate(z), slope)[:, 1:] / square
            strain = np.hstack([gamma, bending])
            potential += 0.5 * share * length * np.einsum("ti,ij,tj->t", strain, section.stiffness, strain)
    np.testing.assert_allclose(run.kinetic_energy.values, kinetic, rtol=1e-10)
    np.testing.assert_allclose(run.potential_energy.values, potential, rtol=1e-10)
    assert np.ptp(run.energy.values) < 1e-2 * np.ptp(kinetic)
