"""The way to rest: by statics, by a damped run, and what is left."""

import math

import numpy as np
import pytest

import cayley as cy
from cayley import loads, supports
from cayley.model.settling import settling, slowest_frequency

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)


def hanging(radius=5e-3, direction=(1, 0, 0), hold=supports.pin):
    rod = cy.Rod(cy.Section.circle(radius, RUBBER), length=1.0, direction=direction, elements=8, name="rod")
    return rod, cy.Model(rod, supports=[hold(rod.start)], loads=[loads.gravity((0, 0, -9.81))])


def test_both_ways_end_at_the_same_place():
    rod, model = hanging()
    static, dynamic = cy.settle(model), cy.settle(model, route="damped run", tolerance=1e-7)
    assert (static.route, dynamic.route) == ("statics", "damped run")
    assert static.residual == 0.0
    assert static.force < 1e-9
    assert dynamic.residual < 1e-7
    np.testing.assert_allclose(dynamic[rod].position.values, static[rod].position.values, atol=1e-6)
    for rest in (static, dynamic):
        for found, name in zip(rest.poses(rod), ("position", "rotation"), strict=True):
            np.testing.assert_array_equal(found, rest[rod][name].values)
    assert cy.simulate(model, 0.01, start=static).residual < 1e-8
    assert "by statics" in repr(static)


def test_a_column_that_buckles_does_not_rest_upright():
    rod, model = hanging(2e-3, (0, 0, 1), supports.clamp)
    upright = cy.equilibrium(model)
    assert not upright.stable
    rest = cy.settle(model)
    assert rest.found.stable
    assert rest[rod].position.values[-1, 2] < -0.5


def test_motion_decays_as_asked_and_the_residual_is_its_speed():
    rod = cy.Rod(cy.Section.circle(5e-3, RUBBER), length=2.0, elements=2)
    run = cy.simulate(cy.Model(rod), 1.0, settle=3.0, initial={rod: {"velocity": (0.5, 0.0, 0.0)}})
    assert run.residual == pytest.approx(0.25 * math.exp(-3.0), rel=1e-5)
    assert abs(run.energy_balance.defect.values[-1]) < 1e-6 * run.energy.values[0]


def test_what_falls_on_a_floor_comes_to_lie_there():
    rod, model = hanging(hold=supports.clamp)
    low = model.replace(obstacles=[cy.Plane(point=(0, 0, -0.1))], contact=cy.Contact(friction=0.3))
    rest = cy.settle(low, tolerance=1e-4)
    assert rest.route == "damped run"
    assert rest.residual < 1e-4
    lowest = rest[rod].position.values[-3:, 2] - (-0.1)
    np.testing.assert_allclose(lowest, 5e-3, rtol=0.02)


def test_a_run_ends_at_rest():
    rod, model = hanging()
    whole = cy.simulate(model, 6.0, settle=True, save_every=0.05)
    early = cy.simulate(model, 6.0, settle=True, save_every=0.05, rest=1e-3)
    assert 2.0 < early.time[-1] < 5.0
    assert early.residual <= 1e-3
    np.testing.assert_array_equal(early.poses(rod)[0], whole.poses(rod)[0][: len(early.time)])
    speeds = np.linalg.norm(early[rod].velocity.values, axis=2).max(axis=1)
    calm = early.time > early.time[-1] - 2.0 / slowest_frequency(model)
    assert speeds[calm].max() <= 1e-3 < speeds[~calm][-2:].max()


def test_the_rate_fits_the_slowest_motion():
    rod, model = hanging(0.02, hold=supports.clamp)
    cantilever = 3.516 * math.sqrt(5e6 * 0.02**2 / 4 / 1100.0)
    assert slowest_frequency(model) == pytest.approx(max(cantilever, math.sqrt(9.81)))
    assert slowest_frequency(model.replace(loads=())) == pytest.approx(cantilever)
    more = cy.Rod(cy.Section.circle(0.02, RUBBER), length=1.0, elements=4, origin=(1, 0, 0), direction=(1, 0, 0))
    longer = cy.Model(rod, more, joints=[cy.joints.weld(rod.end, more.start)])
    assert slowest_frequency(longer) == pytest.approx(cantilever / 4.0)


def test_it_begins_gently_where_nothing_is_driven():
    """Let go from a start with waves in it, the rod hardly moves while the first damping lasts, then as always."""
    rod, model = hanging()
    alpha = 2.0 * slowest_frequency(model)
    run = cy.simulate(model, 0.4 / alpha, settle=True, save_every=0.01 / alpha)
    tip = -run[rod].position.values[:, -1, 2]
    eased = tip[30]
    assert 0.0 < eased < 9.81 / (100.0 * alpha) * 0.3 / alpha
    assert tip[-1] - tip[30] > 0.9 * 0.5 * 9.81 * (0.1 / alpha) ** 2 * 0.9
    driven = model.replace(supports=[supports.drive(rod.start, position=([0.0, 1.0], [(0, 0, 0), (0, 0, 1)]))])
    assert sum("decay" in str(load) for load in settling(driven).loads) == 1
    assert sum("decay" in str(load) for load in settling(model).loads) == 2


def test_what_never_rests_is_told():
    rod = cy.Rod(cy.Section.circle(0.05, RUBBER), length=1.0, elements=2)
    falling = cy.Model(rod, loads=[loads.gravity((0, 0, -9.81))])
    with pytest.raises(cy.SettleError, match="still move by") as told:
        cy.settle(falling, route="damped run", rate=5.0)
    assert told.value.partial.residual == pytest.approx(9.81 / 5.0, rel=1e-6)


def test_refusals():
    ball = cy.Body(mass=1.0, inertia=(1.0, 1.0, 1.0))
    with pytest.raises(ValueError, match="settling damps rods"):
        cy.simulate(cy.Model(ball), 1.0, settle=True)
    _, model = hanging()
    with pytest.raises(ValueError, match="route"):
        cy.settle(model, route="quickly")
    with pytest.raises(ValueError, match="statics knows no contact"):
        cy.settle(model.replace(contact=cy.Contact()), route="statics")
    with pytest.raises(ValueError, match="tolerance"):
        cy.settle(model, tolerance=0.0)
    with pytest.raises(ValueError, match="rate"):
        cy.simulate(model, 1.0, settle=-1.0)
    with pytest.raises(ValueError, match="nothing settles"):
        cy.simulate(model, 1.0, rest=1e-3)
    with pytest.raises(TypeError, match="is no Model"):
        cy.settle("model")
