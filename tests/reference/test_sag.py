"""Order 2m in space, in statics: a rubber rod clamped level, sagging under its weight until it hangs."""

import functools

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import cayley as cy
from verify.problems import slopes

galerkin = cy.rules.galerkin
FINE, FINEST = galerkin(time=1, space=5), 48


def rubber(length, elements, shear=1.0):
    """The section of the rubber pendulum, its shear stiffness times a factor: EI/(weight l²) is 1/345 at 1 m."""
    material = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    circle = cy.Section.circle(5e-3, material, shear_correction=27 / 28)
    stiffness = np.diag([shear, shear, 1.0, 1.0, 1.0, 1.0]) @ circle.stiffness
    section = cy.Section.given(stiffness=stiffness, mass_per_length=circle.mass_per_length, inertia=circle.inertia)
    rod = cy.Rod(section, length=length, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    gravity = cy.loads.gravity((0.0, 0.0, -9.81))
    return rod, cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[gravity])


@functools.cache
def settled(length, elements, rule, shear=1.0):
    """Nodes of a rod and its equilibrium, found from a finer mesh or another shear stiffness; the finest by itself."""
    rod, model = rubber(length, elements, shear)
    if (rule, shear) == (FINE, 1.0):
        return model, cy.equilibrium(model, rule=rule)
    if shear != 1.0:
        return model, cy.equilibrium(model, rule=rule, start=settled(length, elements, rule)[1])
    finest = settled(length, FINEST, FINE)[1].still
    start = CubicSpline(finest.system.nodes, finest.values)
    initial = {"position": lambda s: start(s)[4:], "rotation": lambda s: unit(start(s)[:4])}
    return model, cy.equilibrium(model, rule=rule, initial={rod: initial})


def unit(q):
    return q / np.linalg.norm(q)


def quarters(length, elements, rule, shear=1.0):
    """Places of the quarters of the rod, per length."""
    still = settled(length, elements, rule, shear)[1].still
    return still.values[:: elements * rule.degree // 4, 4:] / length


def errors(length, rule, meshes, shear=1.0):
    """Distance from the sag with elements of degree 5."""
    exact = quarters(length, FINEST, FINE, shear)
    return np.array([np.linalg.norm(quarters(length, n, rule, shear) - exact) for n in meshes])


def orders(meshes, found):
    """Observed between successive meshes."""
    return np.log(found[:-1] / found[1:]) / np.log(np.array(meshes[1:]) / np.array(meshes[:-1]))


@pytest.mark.parametrize("shear", [0.01, 1.0, 100.0])
@pytest.mark.parametrize(("degree", "meshes"), [(1, (8, 16, 24, 32)), (2, (8, 12, 16, 24)), (3, (8, 12, 16, 20))])
def test_order_of_the_sag(degree, meshes, shear):
    """2m at 250 mm, where κGA l²/EI is 32, 3200 or 320 000: shear never matters."""
    found = errors(0.25, galerkin(time=1, space=degree), meshes, shear)
    assert found[-1] > 1e-10, found
    assert np.all(np.abs(orders(meshes, found) - 2 * degree) < 0.2), found


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_shear_stiffness_does_not_enter_the_error(degree):
    """A hundred times the shear stiffness, elements of 3 to 70 lengths √(EI/κGA): the same error to 1 %."""
    soft, stiff = (errors(0.25, galerkin(time=1, space=degree), (8, 16), shear) for shear in (1.0, 100.0))
    np.testing.assert_allclose(stiff, soft, rtol=0.01)


@pytest.mark.parametrize(("degree", "meshes"), [(1, (48, 64, 96, 128)), (2, (32, 48, 64, 96)), (3, (32, 40, 48, 64))])
def test_order_of_the_rubber_pendulum(degree, meshes):
    """2m at 1 m too, once elements are shorter than √(EI/weight) = 54 mm, in which the rod turns down."""
    found = errors(1.0, galerkin(time=1, space=degree), meshes)
    assert np.all(np.abs(orders(meshes, found) - 2 * degree) < 0.2), found


def test_what_coarse_meshes_of_the_rubber_pendulum_miss():
    """Longer elements of degree 3 read 4 to 5, whatever the shear stiffness: the bend at the clamp, not shear."""
    meshes = (8, 12, 16)
    soft, stiff = (errors(1.0, galerkin(time=1, space=3), meshes, shear) for shear in (1.0, 10.0))
    assert np.all(np.abs(orders(meshes, soft) - 4.5) < 0.5), soft
    np.testing.assert_allclose(stiff, soft, rtol=0.02)


@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.midpoint, cy.rules.screw, cy.rules.screw_midpoint], ids=str)
def test_order_of_two_node_rules(rule):
    """2, for every rule that takes two nodes."""
    meshes = (16, 32, 64, 128)
    assert np.all(np.abs(slopes(errors(0.25, rule, meshes)) - 2.0) < 0.2)


@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.screw, galerkin(time=2, space=3)], ids=str)
def test_a_run_stays_in_equilibrium(rule):
    """What is solved here is at rest for the compiled steps: nothing moves by more than Newton's tolerance."""
    model, rest = settled(0.25, 8, rule)
    run = cy.simulate(model, 0.05, 1e-3 if rule.implicit else None, rule=rule, save_every=0.01, start=rest)
    assert np.abs(run.frames.values[..., 4:] - rest.still.values[:, 4:]).max() < 1e-9
