"""Forces of contacts are minus the gradient of the energy that is told: of every feature of every shape."""

from dataclasses import replace

import numpy as np
import pytest

import cayley as cy
from cayley.lie import quaternion
from cayley.lie.exponential import exp
from cayley.steppers.contacts import TOLD, at_start, view
from cayley.system.discretize import discretize

RUBBER = cy.Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.49)
RADIUS = 0.01
STIFF = cy.Contact(stiffness=300.0, penetration=0.02, allow_overlap=False)
ROOF = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, -1, 0.4], [0, 1, 0.4]], dtype=float) * 0.2
"""A ridge along y over a square, """
VALLEY = ROOF * np.array([1.0, 1.0, -1.0])
"""and a valley."""
SLOPES = [[1, 2, 5], [1, 5, 4], [0, 4, 5], [0, 5, 3]]


def rod(start, way, elements=2, name="rod"):
    way = np.asarray(way, dtype=float)
    return cy.Rod(
        cy.Section.circle(RADIUS, RUBBER),
        length=float(np.linalg.norm(way)),
        origin=tuple(start),
        direction=tuple(way),
        elements=elements,
        name=name,
    )


def body(**more):
    return cy.Body(mass=0.3, inertia=[2e-4, 3e-4, 4e-4], **more)


def scene(model, bend=None, seed=0):
    """System and values, a little out of what is straight; bend: height of the middle of the first rod."""
    system = discretize(model, cy.rules.verlet)
    values, random = system.reference.copy(), np.random.default_rng(seed)
    x, p = system.layout.rows_of("x"), system.layout.rows_of("p")
    values[:, x] += 2e-4 * random.standard_normal(values[:, x].shape)
    turn = exp(0.02 * random.standard_normal((len(values), 3)))
    values[:, p] = quaternion.multiply(values[:, p], turn)
    if bend is not None:
        values[1, x] += bend
    return system, values


def told(system, values):
    found = at_start(system, values, 1.0)
    return found[0], found[TOLD:].reshape(system.size, -1)


def gradient(system, values, step=1e-6):
    """Of the energy, by central differences along positions and rotations in the body frame."""
    layout, found = system.layout, np.zeros((system.size, system.layout.dofs))
    x, p = layout.rows_of("x"), layout.rows_of("p")
    for node in range(system.size):
        for k in range(3):
            for name, rows in (("x", x), ("p", p)):
                energies = []
                for sign in (1.0, -1.0):
                    moved, way = values.copy(), sign * step * np.eye(3)[k]
                    if name == "x":
                        moved[node, rows] += way
                    else:
                        moved[node, rows] = quaternion.multiply(values[node, rows], exp(way))
                    energies.append(told(system, moved)[0])
                found[node, layout.dofs_of(name).start + k] = (energies[0] - energies[1]) / (2.0 * step)
    return found


def assert_gradient(system, values, contacts):
    assert len(view(system, values, 1.0)) == contacts
    energy, force = told(system, values)
    assert energy > 1e-7
    assert np.abs(force).max() > 0.02
    np.testing.assert_allclose(force, -gradient(system, values), atol=2e-7 * np.abs(force).max() + 1e-8)


CYLINDER = cy.Cylinder(0.05, 0.2, axis=(0.3, 0.2, 1))
UP = np.array(CYLINDER.axis)
ACROSS = np.cross(UP, (0, 1, 0)) / np.linalg.norm(np.cross(UP, (0, 1, 0)))
BOX = cy.Box((0.2, 0.16, 0.1))
SUNK = 0.85 * RADIUS
ON_SHAPES = {
    "plane": (cy.Plane(normal=(0.1, 0.2, 1)), (0, 0, SUNK), (0.1, 0.2, 0.1), 1),
    "sphere": (cy.Sphere(0.05), (-0.06, 0.01, 0.048 + SUNK), (0.2, 0, 0.003), 1),
    "capsule": (cy.Capsule((0, -0.1, 0), (0, 0.1, 0), 0.03), (-0.1, 0.02, 0.03 + SUNK), (0.13, 0.02, 0), 1),
    "cylinder side": (
        CYLINDER,
        (0.05 + 0.5 * RADIUS) * ACROSS - 0.012 * np.cross(UP, ACROSS),
        0.04 * np.cross(UP, ACROSS),
        2,
    ),
    "cylinder side, long elements": (
        CYLINDER,
        (0.05 + 0.5 * RADIUS) * ACROSS - 0.05 * np.cross(UP, ACROSS),
        0.2 * np.cross(UP, ACROSS),
        1,
    ),
    "cylinder cap": (CYLINDER, 0.02 * ACROSS + (0.1 + SUNK) * UP, 0.15 * UP + 0.03 * ACROSS, 1),
    "cylinder rim": (CYLINDER, 0.055 * ACROSS + 0.106 * UP, 0.15 * ACROSS + 0.1 * UP, 1),
    "box face": (BOX, (0.01, 0.02, 0.05 + SUNK), (0.03, 0.02, 0.1), 1),
    "box edge": (BOX, (0.1 + 0.6 * RADIUS - 0.03, 0.0, 0.05 + 0.6 * RADIUS + 0.03), (0.1, 0.01, -0.1), 1),
    "box corner": (BOX, (0.1 + 0.005, 0.08 + 0.005, 0.05 + 0.005), (0.1, 0.1, 0.1), 1),
    "mesh face": (cy.Mesh(ROOF, SLOPES), (0.05, 0.06, 0.06 + 1.1 * SUNK), (0.05, 0.0, 0.1), 1),
    "mesh edge": (cy.Mesh(ROOF, SLOPES), (-0.06, 0.03, 0.08 + SUNK), (0.16, 0.05, 0.0), 1),
    "mesh valley": (cy.Mesh(VALLEY, SLOPES), (0.0, 0.03, -0.08 + 0.9 * RADIUS), (0.0, 0.02, 0.1), 2),
}


@pytest.mark.parametrize("case", list(ON_SHAPES))
def test_of_a_rod_on_what_is_fixed(case):
    shape, start, way, contacts = ON_SHAPES[case]
    assert_gradient(*scene(cy.Model(rod(start, way), obstacles=[shape], contact=STIFF)), contacts)


def test_of_rods_that_cross_and_meet_end_to_end():
    first = rod((-0.13, 0, 0), (0.2, 0, 0))
    others = (
        rod((0.0, -0.06, 2 * SUNK), (0.02, 0.1, 0), name="b"),
        rod((0.07 + 1.6 * RADIUS, 0.004, 0.002), (0.1, 0.05, 0.02), name="c"),
    )
    assert_gradient(*scene(cy.Model(first, *others, contact=STIFF)), 2)


def test_in_the_hollow_of_a_bend():
    across = rod((0.002, -0.06, -0.02 + 1.5 * RADIUS), (0.002, 0.12, 0), name="b")
    system, values = scene(cy.Model(rod((-0.06, 0, 0), (0.12, 0, 0)), across, contact=STIFF), bend=(0, 0, -0.02))
    seen = view(system, values, 1.0)
    chords = 2 * RADIUS - (values[3:, 6].mean() - values[1, 6]) * np.cos(np.arctan(0.02 / 0.06))
    assert seen[:, 3].max() > chords + 1e-3  # the curve that rounds the corner is nearer
    assert_gradient(system, values, len(seen))


CARRIED = {
    "box on a plane": (cy.Box((0.2, 0.1, 0.06)), cy.Plane(normal=(0.03, 0.02, 1)), 0.029),
    "cylinder on a box": (cy.Cylinder(0.03, 0.1), cy.Box((0.2, 0.2, 0.1)), 0.0995),
    "capsule on a cylinder": (
        cy.Capsule((-0.1, 0.02, 0), (0.1, 0, 0), 0.02),
        cy.Cylinder(0.05, 0.3, axis=(0, 1, 0)),
        0.069,
    ),
    "sphere on a mesh": (cy.Sphere(0.05), cy.Mesh(ROOF, SLOPES), 0.13 - 0.001),
    "box on a mesh": (cy.Box((0.2, 0.1, 0.06)), cy.Mesh(ROOF, SLOPES), 0.109),
}


@pytest.mark.parametrize("case", CARRIED)
@pytest.mark.parametrize("below", ["fixed", "a body"])
def test_of_shapes_on_bodies(case, below):
    shape, other, height = CARRIED[case]
    upper = body(position=(0.003, 0.002, height), name="upper")
    parts = [upper]
    if below == "a body":
        parts.append(body(name="lower"))
        other = replace(other, on=parts[1])
    model = cy.Model(*parts, obstacles=[replace(shape, on=upper), other], contact=replace(STIFF, allow_overlap=False))
    system, values = scene(model)
    assert_gradient(system, values, len(view(system, values, 1.0)))


def test_of_a_rod_on_a_turned_body():
    carrier = body(rotation=(0.8, 0.0, 0.36, 0.48), position=(0.1, 0, 0))
    box = cy.Box((0.3, 0.3, 0.3), center=(0, 0.1, 0.02), rotation=(0.8, 0.6, 0, 0), on=carrier)
    place, turn = carrier.position, carrier.rotation
    top = np.array(place) + quaternion.rotate(
        turn, np.array(box.center) + quaternion.rotate(box.rotation, (0.02, 0.03, 0.15 + SUNK))
    )
    up = quaternion.rotate(turn, quaternion.rotate(box.rotation, (0.1, 0, 0.1)))
    assert_gradient(*scene(cy.Model(rod(top, up), carrier, obstacles=[box], contact=STIFF)), 1)
