"""Damping, loads along rods and the account of work in a store: all come back, and a run goes on bit for bit."""

import json

import numpy as np
import pytest

import cayley as cy
from cayley import damping, loads, supports
from cayley.results.record import model_from, model_record
from cayley.results.trajectory import Trajectory

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
SECTION = cy.Section.circle(0.05, RUBBER)


def damped_model(*more):
    given = damping.rayleigh((0.05, 3.0), (0.1, 20.0)) + damping.viscous(np.arange(1.0, 7.0))
    rod = cy.Rod(SECTION, length=1.0, direction=(1, 0, 0), elements=4, damping=given, name="mast")
    acting = [
        loads.gravity((0, 0, -9.81)),
        loads.drag(rod, density=1.2, diameter=0.1, tangential=0.1, velocity=(1.0, 0.0, 2.0)),
        loads.buoyancy(rod, density=1.2, area=0.01),
        loads.decay(rod, 3.0, until=0.015),
        loads.tendon(rod, 20.0, offset=(0.03, 0, 0), until=0.5),
        loads.temperature(rod, 20.0, expansion=1e-4),
        loads.pressure(rod, 2.0, axis="d2", start=0.1),
        loads.distributed(rod, (0, 0, 1.0), moment=True, frame="body"),
    ]
    return cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[*acting, *(make(rod) for make in more)])


def test_record_and_back_through_json():
    model = damped_model()
    record = json.loads(json.dumps(model_record(model)))
    again = model_from(record, [None] * len(model.loads))
    assert model_record(again) == record
    assert str(again) == str(model)


def test_an_opened_run_has_its_balance_and_goes_on_bit_for_bit(tmp_path):
    model = damped_model()
    whole = cy.simulate(model, 0.02, save_every=0.005)
    half = cy.simulate(model, 0.01, whole.dt, save_every=0.005)
    half.save(tmp_path / "half.zarr")
    opened = Trajectory.open(tmp_path / "half.zarr")
    assert np.array_equal(opened.work.values, half.work.values)
    assert np.array_equal(opened.energy_balance.defect.values, half.energy_balance.defect.values)
    rest = cy.integrate(opened.system, opened.state, 0.02, save_every=0.005)
    assert np.array_equal(rest.state.values, whole.state.values)
    assert np.array_equal(rest.state.work, whole.state.work)


def test_functions_come_back_with_the_model_only(tmp_path):
    model = damped_model(lambda rod: loads.distributed(rod, lambda s, t: np.stack([0 * s, 0 * s, np.sin(t) * s])))
    run = cy.simulate(model, 0.005)
    run.save(tmp_path / "run.zarr")
    opened = Trajectory.open(tmp_path / "run.zarr")
    assert np.array_equal(opened["mast"].force.values, run["mast"].force.values)
    with pytest.raises(ValueError, match="not in the store, only its name"):
        _ = opened.system
    again = Trajectory.open(tmp_path / "run.zarr", model=model)
    assert again.system.size == 5


def test_a_run_without_account_says_so():
    rod = cy.Rod(SECTION, length=1.0, elements=2)
    run = cy.simulate(cy.Model(rod, loads=[loads.force(rod.end, (0, 0, 1))]), 0.001)
    with pytest.raises(ValueError, match="kept no account of work"):
        _ = run.work
