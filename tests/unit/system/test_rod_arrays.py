"""Constants of rods over their nodes and elements, and how a system takes them."""

import numpy as np
import pytest

import cayley as cy
from cayley.discrete import rules
from cayley.discrete.rules import lobatto, lobatto_weights
from cayley.system.discretize import discretize
from cayley.system.rod_arrays import rod_arrays

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
THIN, THICK = cy.Section.circle(0.01, RUBBER), cy.Section.circle(0.02, RUBBER)
DOWN = np.array([0.0, 0.0, -9.81])


def helix(u):
    return np.cos(u), np.sin(u), 0.3 * u


def of(rod, rule="verlet"):
    return rod_arrays(rod, rules.by_name(rule), DOWN)


@pytest.mark.parametrize("rule", ["verlet", "spectral(space=3)"])
def test_a_uniform_straight_rod_has_one_set_of_constants(rule):
    rod = cy.Rod(THIN, length=2.0, elements=3, direction=(1, 0, 0))
    found = of(rod, rule)
    for name, own in {"mass": THIN.mass_per_length, "inertia": THIN.inertia, "stiffness": THIN.stiffness}.items():
        np.testing.assert_array_equal(found.constants[name], np.broadcast_to(own, (found.size, *np.shape(own))))
    assert not found.constants["reference"].any()
    assert not discretize(cy.Model(rod), rules.by_name(rule)).equations.varying


def test_nodes_share_the_inertia_of_the_elements_beside_them():
    rod = cy.Rod([THIN, THICK], length=4.0, elements=2, spacing=(1.0, 3.0))
    found = of(rod)
    a, b = THIN.mass_per_length, THICK.mass_per_length
    np.testing.assert_allclose(found.constants["mass"], [a, (0.5 * a + 1.5 * b) / 2.0, b], rtol=1e-14)
    np.testing.assert_allclose(found.named["weight"], [0.5, 2.0, 1.5])
    inertia = found.named["weight"][:, None, None] * found.constants["inertia"]
    np.testing.assert_allclose(inertia.sum(axis=0), THIN.inertia + 3.0 * THICK.inertia, rtol=1e-14)


def test_an_element_has_its_stiffness_at_its_left_node():
    found = of(cy.Rod([THIN, THICK], length=2.0, elements=2))
    np.testing.assert_array_equal(found.constants["stiffness"], [THIN.stiffness, THICK.stiffness, THICK.stiffness])


def test_lengths_of_elements():
    found = of(cy.Rod(THIN, length=4.0, elements=2, spacing=(1.0, 3.0)))
    np.testing.assert_allclose(found.named["length"], [1.0, 3.0, 0.0])
    np.testing.assert_allclose(found.named["inverse"], [1.0, 1.0 / 3.0, 1.0 / 3.0])
    np.testing.assert_allclose(found.named["here"], [0.0, 1.0, 4.0])


def test_nodes_inside_elements_have_their_own_inertia():
    """At the Lobatto nodes, those of the section there."""

    def cone(s):
        return cy.Section.circle(0.02 - 0.005 * s, RUBBER)

    found = of(cy.Rod(cone, length=2.0, elements=1), "spectral(space=3)")
    exact = [cone(2.0 * u).mass_per_length for u in lobatto(3)]
    np.testing.assert_allclose(found.constants["mass"], exact, rtol=1e-12)
    np.testing.assert_allclose(found.named["weight"], 2.0 * lobatto_weights(3))
    at = 1.0 + np.polynomial.legendre.leggauss(3)[0]
    for k, name in enumerate(("stiffness", "stiffness@1", "stiffness@2")):
        np.testing.assert_allclose(found.constants[name][0], cone(at[k]).stiffness, rtol=1e-12, atol=1e-9)


def test_kinematics_leave_out_stiffness_but_no_reference():
    for kinematics, size in (("unshearable", 4), ("inextensible", 3)):
        rod = cy.Rod.along(THIN, helix, span=(0.0, 3.0), elements=4, kinematics=kinematics)
        found = of(rod)
        assert found.constants["stiffness"].shape == (5, size, size)
        assert found.constants["reference"].shape == (5, 6)


def test_a_screw_measures_a_helix_as_it_is():
    """Its curvature and twist are constant, its strain zero but for the direction of the frames."""
    speed = np.hypot(1.0, 0.3)

    def frenet(s):
        u = s / speed
        tangent = np.array([-np.sin(u), np.cos(u), 0.3]) / speed
        inward = np.array([-np.cos(u), -np.sin(u), 0.0])
        return np.stack([inward, np.cross(tangent, inward), tangent], axis=1)

    rod = cy.Rod.along(THIN, helix, span=(0.0, 3.0), elements=2, frames=frenet)
    reference = of(rod, "screw").constants["reference"]
    expected = [0.0, 0.0, 0.0, 0.0, 1.0 / speed**2, 0.3 / speed**2]
    np.testing.assert_allclose(reference, np.broadcast_to(expected, (3, 6)), atol=1e-10)


def test_round_off_is_no_variation():
    """A circle in equal elements, its tangent given, has one set of constants: nothing is read by node."""

    def circle(u):
        return np.cos(u), np.sin(u), 0.0

    rod = cy.Rod.along(THIN, circle, span=(0.0, 3.0), elements=6, tangent=lambda u: (-np.sin(u), np.cos(u), 0.0))
    system = discretize(cy.Model(rod), rules.verlet)
    assert not system.equations.varying
    used = [name for name in system.equations.density.names if name.startswith("c.reference")]
    assert len(used) < 5  # stretch and curvature; the rest is exactly zero


def test_rods_beside_each_other_keep_their_own():
    curved = cy.Rod.along(THIN, helix, span=(0.0, 3.0), elements=4, name="a")
    straight = cy.Rod([THICK, THIN], length=1.0, elements=2, name="b")
    system = discretize(cy.Model(curved, straight), rules.by_name("nodal"))
    assert not system.named["c.reference[2]"][5:].any()
    assert not system.named["c.reference[0]@1"][5:].any()
    assert system.named["c.reference[0]@1"][:4].all()
    np.testing.assert_allclose(system.named["c.stiffness[2,2]"][5:7], [s.stiffness[2, 2] for s in (THICK, THIN)])


def test_values_at_places_of_an_element():
    rod = cy.Rod.along(THIN, helix, span=(0.0, 3.0), elements=4)
    system = discretize(cy.Model(rod), rules.by_name("spectral(space=3)"))
    mass, turn = system.values_of("c.mass", 2), system.values_of("c.reference[3]", 1)
    np.testing.assert_array_equal(mass, np.full(13, THIN.mass_per_length))
    np.testing.assert_array_equal(turn, system.named["c.reference[3]@1"])
    np.testing.assert_array_equal(system.values_of("c.reference[3]"), system.named["c.reference[3]"])
