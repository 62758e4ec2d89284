"""What runs with contact tell: overlap at the start, too many contacts, depth, results."""

import numpy as np
import pytest

import cayley as cy
from cayley import loads
from cayley.steppers import contacts

RUBBER = cy.Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.49)


def rod(name, height, direction=(1, 0, 0), elements=4):
    start = -0.1 * np.array(direction) + (0, 0, height)
    return cy.Rod(
        cy.Section.circle(0.01, RUBBER),
        length=0.2,
        origin=tuple(start),
        direction=direction,
        elements=elements,
        name=name,
    )


def test_an_overlap_at_the_start_is_named_or_pushed_apart_gently():
    parts = rod("lower", 0.0, (1, 0, 0)), rod("upper", 0.014, (0.1, 1, 0))
    with pytest.raises(
        ValueError, match=r"lower and element \d of upper overlap by 0\.006 m \(0\.6 radii\).*allow_overlap"
    ):
        cy.simulate(cy.Model(*parts, contact=cy.Contact()), 0.1)
    run = cy.simulate(cy.Model(*parts, contact=cy.Contact(allow_overlap=True)), 0.3, save_every=0.01)
    distance = run["upper"].position.values[:, 2, 2] - run["lower"].position.values[:, 2, 2]
    assert distance[-1] > 0.0195
    speed = np.abs(run["upper"].velocity.values).max()
    assert speed < 0.1  # a spring of the same stiffness would throw them apart at 1 m/s and more
    assert np.abs(run.energy_balance.defect.values).max() < 0.1 * np.abs(run.dissipated.values).max()


def test_more_contacts_than_there_is_room_for_are_told(monkeypatch):
    monkeypatch.setattr(contacts, "ROOM", 2)
    monkeypatch.setattr(contacts, "EACH", 0)
    gravity = loads.gravity((0, 0, -9.81))
    model = cy.Model(rod("rod", 0.0101), loads=[gravity], obstacles=[cy.Plane()], contact=cy.Contact())
    with pytest.raises(cy.SimulationError, match="more contacts at once than a run remembers"):
        cy.simulate(model, 0.1)


def test_what_a_run_tells_of_contacts():
    gravity = loads.gravity((0, 0, -9.81))
    floor = cy.Plane(name="floor", friction=0.5)
    resting = rod("rod", 0.0099)
    model = cy.Model(resting, loads=[gravity], obstacles=[floor], contact=cy.Contact(damping=0.5))
    run = cy.simulate(model, 0.3, save_every=0.01)
    weight = model.mass * 9.81
    assert run.contacts.number[-1] == 5
    assert 0.0 < run.contacts.depth[-1] <= run.contacts.deepest[-1] < 0.02
    force = run[resting].contact_force.values[-1]
    np.testing.assert_allclose(force.sum(axis=0), [0, 0, weight], atol=0.02 * weight)
    seen = run.contacts_at(-1)
    assert set(seen.second.values) == {"floor"}
    assert set(seen["first"].values) == {"rod"}
    assert np.all(seen.first_element.values >= 0)
    assert np.all(seen.second_element.values == -1)
    np.testing.assert_allclose(seen.normal.values, np.tile([0, 0, 1], (5, 1)), atol=1e-12)
    np.testing.assert_allclose(seen.place.values[:, 2], 0.0, atol=1e-6)
    np.testing.assert_allclose(seen.force.values.sum(), force[:, 2].sum(), rtol=0.02)
    assert len(run.contacts_at(0).first) == 0 or run.contacts_at(0).depth.max() < 1e-3
    bare = cy.simulate(cy.Model(resting, loads=[gravity]), 0.01)
    with pytest.raises(ValueError, match="nothing can touch"):
        bare.contacts  # noqa: B018
    assert "contact_force" not in bare[resting]


def test_deep_contacts_warn_unless_their_stiffness_was_given():
    falling = rod("rod", 0.02)
    initial = {falling: {"velocity": np.broadcast_to([0, 0, -20.0], (5, 3))}}
    model = cy.Model(falling, obstacles=[cy.Plane()], contact=cy.Contact())
    run = cy.simulate(model, 0.002, initial=initial)
    assert 0.01 < run.contacts.deepest[-1] < 0.1
    with pytest.warns(cy.ContactDepthWarning, match=r"sank .* radii .*smaller dt"):
        cy.simulate(model, 0.002, dt=4.0 * run.dt, initial=initial)
    cy.simulate(model.replace(contact=cy.Contact(stiffness=2e5)), 0.002, dt=1e-6, initial=initial)
