"""Obstacles and contact in a store: all come back, bit for bit."""

import json

import numpy as np

import cayley as cy
from cayley.model import contact_radius
from cayley.results.record import model_from, model_record

STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)


def touching():
    rope = cy.Rod(cy.Section.circle(0.01, STEEL), length=1.0, elements=2, name="rope")
    strip = cy.Rod(cy.Section.rectangle(0.01, 0.02, STEEL), length=1.0, elements=2, name="strip")
    drum = cy.Body(mass=1.0, inertia=[1, 1, 1], position=(0, 0, 1 / 3), name="drum")
    floor, lid = cy.Plane(friction=0.1 + 0.2, name="floor"), cy.Box((1, 1, 0.1), center=(0, 0, 5)).mesh
    shapes = [
        *(cy.Sphere(0.3, on=drum), cy.Cylinder(0.2, 1 / 3, axis=(1, 2, 3), on=drum), floor, lid),
        *(cy.Box((1, 2, 3), rotation=(0, 1, 0, 0), on=drum), cy.Capsule((0, 0, 9), (0, 1, 9), 0.1)),
    ]
    contact = cy.Contact(
        friction=0.3, self_contact=[rope], radii={strip: 0.02}, without=[(strip, floor), (rope, drum)], stiffness=1e4
    )
    return cy.Model(rope, strip, drum, obstacles=shapes, contact=contact)


def test_record_and_back_through_json():
    model = touching()
    record = json.loads(json.dumps(model_record(model)))
    again = model_from(record, [])
    assert model_record(again) == record
    assert str(again) == str(model)
    assert again.obstacles[0].on is again.bodies[0]
    assert np.array_equal(again.obstacles[3].vertices, model.obstacles[3].vertices)
    assert contact_radius(again, again.rods[0]) == 0.01


def test_models_without_contact_are_kept_as_ever():
    """Stores of before there was contact open with their model."""
    record = model_record(touching().replace(obstacles=(), contact=None))
    assert not {"obstacles", "contact"} & set(record)
    assert all("radius" not in section for section in record["sections"])
