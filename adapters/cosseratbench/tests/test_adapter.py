"""The adapter against scenarios of the suite: starts as it has them, ways, settings, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from cayley_cosseratbench import CayleySolver
from cayley_cosseratbench.start import element_directors, node_frames
from cosseratbench import registry
from cosseratbench.metrics import twist_angles
from cosseratbench.scenario import EndCondition, Motion, PointLoad, Rod, Scenario
from cosseratbench.solver import Diverged

EXPERIMENTS = ("cantilever", "catenary", "pendulum", "twist", "crossing", "capstan", "pile")


def scenario(name):
    return registry.load_experiment(name).scenario


def clamped(**more):
    material = scenario("cantilever").rods[0].material
    rod = Rod(((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), 0.02, material, start=EndCondition.CLAMPED, **more)
    return Scenario(rods=(rod,), duration=1.0, quasi_static=True, self_contact=False)


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_starts_are_those_of_the_suite(name):
    for spec in scenario(name).rods:
        positions, rotations = node_frames(spec, 50)
        np.testing.assert_array_equal(positions, spec.nodes(50))
        found = element_directors(positions[None], rotations[None])[0]
        np.testing.assert_allclose(found, spec.directors(50), atol=2e-2)
        assert np.abs(twist_angles(positions, found)).max() < 1e-6


@pytest.mark.parametrize(
    ("name", "way"),
    [("cantilever", "statics"), ("catenary", "statics"), ("pendulum", "motion"), ("twist", "damped run")],
)
def test_the_way_of_a_scenario(name, way):
    told = CayleySolver().settings(scenario(name), n_elements=20, n_frames=11)
    assert told["way"] == way
    if way != "statics":
        assert 0.0 < told["time_step"] <= scenario(name).duration / 10


def test_the_step_is_multiplied():
    given = clamped(start_motion=Motion((0.0, 1.0), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.1)), ((0.0, 0.0, 0.0),) * 2))
    once, twice = (CayleySolver(scale).settings(given, n_elements=10, n_frames=2) for scale in (1.0, 2.0))
    assert (once["rule"], twice["rule"]) == ("screw", "screw_midpoint")
    assert twice["time_step"] == pytest.approx(2.0 * once["time_step"], rel=1e-2)


def test_frames_of_statics():
    found = CayleySolver().run(scenario("catenary"), n_elements=20, n_frames=4)
    np.testing.assert_array_equal(found.positions[0][0], scenario("catenary").rods[0].nodes(20))
    np.testing.assert_array_equal(found.positions[0][1], found.positions[0][3])
    assert found.directors[0].shape == (4, 20, 3)


def test_a_driven_clamp_goes_where_its_motion_says_and_slides():
    motion = Motion(
        times=(0.0, 1.0, 2.0),
        displacement=((0.0, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.1, 0.05)),
        rotation=((0.0, 0.0, 0.0), (0.7, 0.0, 0.0), (0.7, 0.0, 0.0)),
        slides_along=(2.0, 0.0, 0.0),
    )
    given = replace(
        clamped(end=EndCondition.CLAMPED, end_motion=motion, loads=(PointLoad((1.0, 0.0, 0.0)),)), duration=3.0
    )
    found = CayleySolver().run(given, n_elements=10, n_frames=4)
    end = found.positions[0][:, -1]
    np.testing.assert_allclose(end[:, 1:], [[0.0, 0.0], [0.1, 0.0], [0.1, 0.05], [0.1, 0.05]], atol=1e-9)
    assert end[-1, 0] == pytest.approx(1.0, abs=0.02)
    assert end[-1, 0] != 1.0
    turn = np.cos(0.7), np.sin(0.7)
    twist = twist_angles(found.positions[0][-1], found.directors[0][-1]).sum()
    assert twist == pytest.approx(0.7 * 9 / 10, abs=0.02), turn


def test_a_rope_that_should_hold_holds():
    experiment = registry.load_experiment("capstan")
    given = replace(experiment.scenario, duration=0.4)
    found = CayleySolver().run(given, n_elements=60, n_frames=21)
    assert 0.0 <= experiment.metrics["slide"](given, found) < 1e-4
    slipping = replace(experiment.scenario_for(overhang=1.5), duration=0.4)
    found = CayleySolver().run(slipping, n_elements=60, n_frames=21)
    assert experiment.metrics["slide"](slipping, found) > 1e-2


def test_frames_have_all_nodes_of_the_model():
    solver, given = CayleySolver(), replace(scenario("crossing"), duration=0.02)
    found = solver.run(given, n_elements=51, n_frames=3)
    assert solver.settings(given, n_elements=51, n_frames=3)["elements"] == 153
    assert [x.shape for x in found.positions] == [(3, 154, 3)] * 2
    assert [d.shape for d in found.directors] == [(3, 153, 3)] * 2
    for x, spec in zip(found.positions, given.rods, strict=True):
        np.testing.assert_allclose(x[0, ::3], spec.nodes(51), atol=1e-9)


def test_a_heap_comes_to_rest():
    experiment = registry.load_experiment("pile")
    given = experiment.scenario_for(speed=0.8)
    found = CayleySolver().run(given, n_elements=40, n_frames=51)
    assert found.times[-1] == given.duration
    assert experiment.metrics["settling_residual"](given, found) < 2e-4
    clamp = found.positions[0][:, 0, 2]
    assert clamp[-1] == pytest.approx(0.15, abs=1e-9)


def test_what_is_not_there_is_told():
    still = Motion((0.0, 1.0), ((0.0, 0.0, 0.0),) * 2, ((0.0, 0.0, 0.0),) * 2)
    arc = tuple((float(np.sin(a)), 0.0, float(1.0 - np.cos(a))) for a in np.linspace(0.0, 1.0, 51))
    bent = replace(clamped().rods[0], centerline=arc, normal=(0.0, 1.0, 0.0), end=EndCondition.CLAMPED)
    solver, one = CayleySolver(), clamped()
    with pytest.raises(NotImplementedError, match="its other end driven as well"):
        solver.run(replace(one, rods=(replace(bent, start_motion=still, end_motion=still),)), n_elements=10, n_frames=2)
    soft = replace(one.rods[0].material, shear_modulus=1e5)
    with pytest.raises(NotImplementedError, match="not isotropic"):
        solver.run(replace(one, rods=(replace(one.rods[0], material=soft),)), n_elements=10, n_frames=2)
    rough = replace(one.rods[0], friction=0.5)
    with pytest.raises(NotImplementedError, match="rods of different friction"):
        solver.run(replace(one, rods=(one.rods[0], rough)), n_elements=10, n_frames=2)


def test_a_run_that_stops_has_diverged():
    turns = Motion((0.0, 1e-3), ((0.0, 0.0, 0.0), (1e6, 0.0, 0.0)), ((0.0, 0.0, 0.0),) * 2)
    with pytest.raises(Diverged) as told:
        CayleySolver().run(clamped(start_motion=turns), n_elements=10, n_frames=3)
    assert told.value.time is not None
