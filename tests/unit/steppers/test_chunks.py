"""How a run is cut into calls, tiles and wavefronts does not change a single bit."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads, supports
from cayley.codegen.kernels import Kernels
from cayley.simulation import record
from cayley.steppers import decoupled_run
from cayley.system.discretize import discretize
from cayley.system.legendre import initial_state
from cayley.system.system import System
from unit.system.rods import pendulum, round_rod

DT, STEPS = 2e-5, 36


def busy_model() -> cy.Model:
    """Two rods with nodes held in the middle and loads of every form, also on neighbors across tiles."""
    a, b = round_rod(19, name="a"), round_rod(14, origin=(0, 1, 0), name="b")
    held = [supports.clamp(a.start), supports.hold(a.node(9), position="y"), supports.pin(b.end)]
    acting = [loads.gravity((0, 0, -9.81)), loads.line_force(b, (0.0, 1.0, 2.0), frame="body")]
    for node in (3, 4, 8, 15, 16, 19):
        acting.append(loads.force(a.node(node), (0.0, 1.0, 0.2), frame="body"))
        acting.append(loads.moment(a.node(node), lambda t: np.array([np.sin(1e4 * t), 0.1, 0.0]), until=5e-4))
    acting.append(loads.moment(b.start, (0.0, 0.0, 0.3), start=1e-4))
    return cy.Model(a, b, supports=held, loads=acting)


def narrow(system: System) -> System:
    """The same system in vectors of two lanes: more blocks for as many nodes."""
    return replace(system, kernels=Kernels(system.equations, 2))


@cy.lagrangian(x=cy.Vector(2), s=cy.Interval)
def timed(q, c):
    """A chain of springs, every one with its own weight, in a field that changes with time."""
    kinetic = 0.5 * (1.0 + 0.1 * np.sin(1e4 * q.t)) * (1.0 + q.s) * q.x_t @ q.x_t
    return kinetic - 50.0 * q.x_s @ q.x_s * (1.0 + q.s) + np.cos(2e4 * q.t) * q.x[0] * q.s


def timed_system(rule: cy.rules.Rule = cy.rules.verlet) -> System:
    domain = cy.Interval(0.0, 1.0, elements=24)
    return narrow(cy.compile(timed, rule=rule, domain=domain, held={"x": ("start", 11)}))


SYSTEMS = {
    "rods": lambda: narrow(discretize(busy_model(), cy.rules.verlet)),
    "nodal": lambda: narrow(discretize(busy_model(), cy.rules.nodal)),
    "matrices": lambda: narrow(discretize(busy_model(), cy.rules.verlet, rotation="matrix")),
    "spectral": lambda: narrow(discretize(busy_model(), cy.rules.spectral(space=3))),
    "timed": timed_system,
    "timed spectral": lambda: timed_system(cy.rules.spectral(space=2)),
    "free": lambda: narrow(discretize(cy.Model(round_rod(21), loads=[loads.gravity((1, 2, 3))]), cy.rules.verlet)),
}


def final(system: System, *, every: int = 12, steps: int = STEPS) -> cy.Trajectory:
    rng = np.random.default_rng(5)
    velocity = rng.normal(scale=0.1, size=(system.size, system.layout.dofs))
    start = initial_state(system, system.reference, velocity)
    return cy.integrate(system, start, steps * DT, DT, save_every=every * DT, allow_unstable=True)


def same(one: cy.Trajectory, other: cy.Trajectory) -> bool:
    return np.array_equal(one.frames.values, other.frames.values) and np.array_equal(
        one.frames.momenta, other.frames.momenta
    )


@pytest.fixture(params=SYSTEMS)
def system(request) -> System:
    return SYSTEMS[request.param]()


@pytest.fixture
def expected(system, monkeypatch) -> cy.Trajectory:
    monkeypatch.setattr(decoupled_run, "CACHED_BYTES", 10**9)
    run = final(system)
    assert len(decoupled_run.make_plan(system).spans) <= 7
    assert np.isfinite(run.frames.values).all()
    assert np.abs(run.frames.values[-1] - run.frames.values[0]).max() > 1e-6
    return run


@pytest.mark.parametrize(("tile", "depth"), [(1, 1), (1, 5), (2, 3), (3, 12), (4, 8), (100, 4)])
def test_wavefront(system, expected, monkeypatch, tile, depth):
    """Tiles that run ahead of their neighbors give what whole steps give."""
    monkeypatch.setattr(decoupled_run, "CACHED_BYTES", 0)
    monkeypatch.setattr(decoupled_run, "TILE", tile)
    monkeypatch.setattr(decoupled_run, "DEPTH", depth)
    plan = decoupled_run.make_plan(system)
    blocks = -(-system.cells // 2)
    assert plan.depth == depth
    assert len(plan.spans) >= -(-blocks // tile)
    assert same(final(system), expected)


@pytest.mark.parametrize("chunk", [1, 12, 25, 10**6])
def test_calls_of_the_driver(system, expected, monkeypatch, chunk):
    monkeypatch.setattr(decoupled_run, "CHUNK", chunk)
    assert same(final(system), expected)


def test_going_on_from_a_saved_state(system, expected):
    """A run that stops and goes on is the run that never stopped."""
    first = final(system, steps=12)
    second = cy.integrate(system, first.state, STEPS * DT, save_every=12 * DT, allow_unstable=True)
    assert np.array_equal(second.frames.values, expected.frames.values[1:])
    assert np.array_equal(second.frames.momenta, expected.frames.momenta[1:])
    assert np.array_equal(second.frames.steps, expected.frames.steps[1:])


def test_more_frames_change_nothing_but_round_off(system, expected):
    """At a save half a step's forces are given and taken again."""
    often = final(system, every=1)
    assert_allclose(often.frames.values[::12], expected.frames.values, rtol=0, atol=1e-13)
    scale = np.abs(expected.frames.momenta).max()
    assert_allclose(often.frames.momenta[::12], expected.frames.momenta, rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize("lanes", [4, 8])
def test_lanes(lanes):
    """Vectors of any width give the same run."""
    system = discretize(busy_model(), cy.rules.verlet)
    runs = [final(replace(system, kernels=Kernels(system.equations, n))).frames for n in (lanes, 2)]
    assert_allclose(runs[0].values, runs[1].values, rtol=0, atol=1e-13)


def test_saves_that_do_not_divide_the_run():
    """The last frame is the end of the run; steps are all of one size, at most dt."""
    run = cy.simulate(pendulum(3), 1e-3, 3e-5, save_every=3e-4)
    assert run.time[-1] == pytest.approx(1e-3, rel=1e-14)
    assert run.dt <= 3e-5
    assert_allclose(np.diff(run.time)[:-1], 3e-4, rtol=0.05)
    assert run.steps * run.dt == pytest.approx(1e-3, rel=1e-12)


def test_progress(monkeypatch):
    """Reported between calls of the driver, which take longer and longer, up to the end."""
    monkeypatch.setattr(record, "CALL_SECONDS", 1e9)
    seen: list[tuple[float, float]] = []
    cy.simulate(pendulum(3), 1e-3, 1e-5, save_every=1e-4, progress=lambda *at: seen.append(at))
    fractions, times = zip(*seen, strict=True)
    assert_allclose(fractions, [0.1, 0.5, 1.0])
    assert_allclose(times, [1e-4, 5e-4, 1e-3])
