"""simulate and integrate: the schedule of steps, the start, what is refused, and going on."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import cayley as cy
from cayley.simulation import Schedule, schedule

WEIGHT = np.array([0.4, -0.3, -9.81])
RULES = {"nodal": cy.rules.nodal, "verlet": cy.rules.verlet}


@pytest.fixture
def rod() -> Any:
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
    section = cy.Section.rectangle(0.02, 0.03, rubber)
    return cy.Rod(section, length=0.8, elements=6, direction=(1, 2, 2), origin=(0, 1, 0))


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(2))
def top(q: Any, c: Any) -> Any:
    kinetic = 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) + 0.5 * cy.dot(q.x_t, q.x_t)
    return kinetic - q.p.rotate(cy.E2)[2] - 0.5 * cy.dot(q.x, q.x)


def top_system(rule: Any = cy.rules.nodal, rotation: str = "quaternion") -> Any:
    return cy.compile(top, rule=rule, constants={"inertia": np.diag([1.0, 2.0, 1.5])}, rotation=rotation)


@pytest.fixture
def system() -> Any:
    return top_system()


START = {"p": (1, 0, 0, 0), "p_t": (0.1, 5, -0.3), "x": (1, 2)}


# the schedule


@pytest.mark.parametrize(
    ("span", "dt", "save_every", "expected"),
    [
        (1.0, 0.1, 0.5, Schedule(0.1, 5, 2, 0)),
        (1.0, 0.3, 0.5, Schedule(0.25, 2, 2, 0)),  # smaller, so that saves are met
        (1.0, 2.0, 0.5, Schedule(0.5, 1, 2, 0)),  # no step over a save
        (10.0, 1e-4, 0.01, Schedule(1e-4, 100, 1000, 0)),  # 0.01/1e-4 is not 100 in binary
        (1.0, 0.1, 0.4, Schedule(0.1, 4, 2, 2)),  # saves do not divide the span: its end is met
        (0.3, 0.1, 0.3, Schedule(0.1, 3, 1, 0)),
    ],
)
def test_schedule(span: float, dt: float, save_every: float, expected: Schedule) -> None:
    found = schedule(span, dt, save_every)
    assert (found.stride, found.saves, found.rest) == (expected.stride, expected.saves, expected.rest)
    assert found.h == pytest.approx(expected.h, rel=1e-14)


def test_schedule_of_odd_spans() -> None:
    random = np.random.default_rng(1)
    for _ in range(500):
        span, dt = 10.0 ** random.uniform(-3, 3), 10.0 ** random.uniform(-6, -1)
        save_every = min(span, 10.0 ** random.uniform(-4, 1))
        plan = schedule(span, dt, save_every)
        assert plan.h <= dt * (1 + 1e-11)
        steps = plan.saves * plan.stride + plan.rest
        assert steps * plan.h == pytest.approx(span, rel=1e-12)
        assert steps - 1 <= span / min(dt, save_every) * (1 + 1e-11) + plan.saves  # no more steps than needed
        assert 0 <= plan.rest < plan.stride


def test_frames_meet_the_saves(rod: Any) -> None:
    run = cy.simulate(cy.Model(rod), t_end=0.0107, dt=6e-5, save_every=0.001)
    assert run.dt <= 6e-5
    assert run.time[0] == 0.0
    assert run.time[-1] == pytest.approx(0.0107, rel=1e-12)
    assert np.abs(run.time[:-1] - 0.001 * np.arange(len(run.time) - 1)).max() < 10 * run.dt
    default = cy.simulate(cy.Model(rod), t_end=0.0107)
    assert len(default.time) == 101
    assert np.allclose(default.time, np.linspace(0, 0.0107, 101), rtol=1e-12)


def test_the_step_without_dt_is_safely_below_the_limit(rod: Any) -> None:
    run = cy.simulate(cy.Model(rod), t_end=0.01, save_every=0.01)
    limit = run.system.stable_dt()
    assert 0.85 * limit < run.dt <= 0.9 * limit


# refusals


def refused(call: Callable[[], Any], line: str, error: type[Exception] = ValueError) -> None:
    with pytest.raises(error, match=line) as caught:
        call()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, "1", None, True])
def test_times_must_be_positive_numbers(rod: Any, system: Any, value: Any) -> None:
    model = cy.Model(rod)
    refused(lambda: cy.simulate(model, t_end=value), r"^t_end is .*; give a positive number \[s\]$")
    refused(lambda: cy.integrate(system, START, t_end=value), r"^t_end is .*; give a positive number \[s\]$")
    if value is not None:
        refused(lambda: cy.simulate(model, 0.01, value), r"^dt is .*; give a positive number \[s\]$")
        refused(lambda: cy.simulate(model, 0.01, save_every=value), r"^save_every is .*; give a positive number \[s\]$")


def test_a_run_must_end_after_its_start(system: Any) -> None:
    refused(
        lambda: cy.integrate(system, START, 1.0, 0.01, t_start=2.0), "t_end is 1 s, the start is at 2 s; t_end must"
    )


def test_a_step_over_the_limit_is_refused(rod: Any) -> None:
    model = cy.Model(rod)
    limit = cy.simulate(model, t_end=1e-4).system.stable_dt()
    refused(lambda: cy.simulate(model, 0.01, 1.1 * limit), rf"over the step limit {limit:.4g} s.*allow_unstable=True$")
    run = cy.simulate(model, 11 * limit, 1.1 * limit, save_every=11 * limit, allow_unstable=True)
    assert run.dt > limit


def test_wrong_things_are_told(rod: Any, system: Any) -> None:
    model = cy.Model(rod)
    refused(lambda: cy.simulate(system, 1.0), "is no Model; for a Lagrangian of your own use", TypeError)
    refused(lambda: cy.integrate(model, START, 1.0), "is no compiled system; make one with", TypeError)
    refused(lambda: cy.simulate(model, 1.0, rule="verlet"), "rule is 'verlet'; give one of cy.rules", TypeError)
    refused(lambda: cy.simulate(model, 1.0, rotation="euler"), "rotation is 'euler'; give one of quaternion, matrix")


@pytest.mark.parametrize(
    ("start", "line"),
    [
        ({"v": (1, 2)}, r"^start names 'v'; give p, p_t, x, x_t$"),
        ({"p": (1, 0, 0)}, r"^start\['p'\] has shape \(3,\); give \(1, 4\) or \(4,\)$"),
        ({"x_t": "fast"}, r"^start\['x_t'\] has shape \(\); give \(1, 2\) or \(2,\)$"),
        ({"x": (1, math.nan)}, r"^start\['x'\] has an entry that is not finite$"),
        ({"p": (1, 1, 0, 0), "x": (0, 0)}, r"^start\['p'\]: quaternions must have length 1, one has 1.41421$"),
        ({"p": (1, 0, 0, 0)}, r"^start does not give x; give its values, shape \(2,\)$"),
    ],
)
def test_start_of_a_lagrangian_is_checked(system: Any, start: dict[str, Any], line: str) -> None:
    refused(lambda: cy.integrate(system, start, 1.0, 0.01), line)


@pytest.mark.parametrize(
    ("initial", "line"),
    [
        ({"speed": (1, 0, 0)}, r"^initial\['rod'\]\['speed'\] is unknown; give position, rotation, velocity"),
        ({"velocity": (1, 0)}, r"^initial\['rod'\]\['velocity'\] has shape \(2,\); give \(7, 3\) or \(3,\)$"),
        ({"velocity": lambda s: (s, 0)}, r"has shape \(7, 2\); give \(7, 3\) or \(3,\)$"),
        ({"position": np.full((7, 3), np.inf)}, r"\['position'\] has an entry that is not finite$"),
        ({"rotation": (2, 0, 0, 0)}, r"\['rotation'\]: quaternions must have length 1, one has 2$"),
        ({"velocity": (1, 0, 0), "momentum": (1, 0, 0)}, r"gives both velocity and momentum; give one$"),
        (
            {"angular_velocity": (1, 0, 0), "angular_momentum": (1, 0, 0)},
            r"gives both angular_velocity and angular_momentum; give one$",
        ),
    ],
)
def test_start_of_a_model_is_checked(rod: Any, initial: dict[str, Any], line: str) -> None:
    refused(lambda: cy.simulate(cy.Model(rod), 0.01, initial={rod: initial}), line)


def test_start_of_an_unknown_rod_is_refused(rod: Any) -> None:
    other = cy.Rod(rod.section, length=1.0, elements=2)
    for key in ("mast", other):
        refused(lambda key=key: cy.simulate(cy.Model(rod), 0.01, initial={key: {}}), "rod")


# the start


def test_functions_of_s_arrays_and_constants_start_alike(rod: Any) -> None:
    model = cy.Model(rod)

    def moved(s: float) -> np.ndarray:
        return np.array(rod.origin) + s * np.array(rod.direction) * (1.0 + 0.1 * s)

    as_function = {"position": moved, "velocity": lambda s: (0.0, s, 1.0), "rotation": lambda s: rod.rotation}
    as_array = {
        "position": np.array([moved(s) for s in rod.nodes]),
        "velocity": np.stack([0 * rod.nodes, rod.nodes, 1 + 0 * rod.nodes], axis=1),
        "rotation": rod.rotation,
    }
    one = cy.simulate(model, 0.005, initial={rod: as_function})
    two = cy.simulate(model, 0.005, initial={"rod": as_array})
    first = one[rod].isel(time=0)
    assert np.allclose(first.position, as_array["position"], rtol=1e-15)
    assert np.allclose(first.velocity, as_array["velocity"], atol=1e-15)
    assert np.array_equal(one.frames.values, two.frames.values)


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
def test_momenta_start_as_their_velocities(rod: Any, rotation: str) -> None:
    """Γ⁰ = m ẋ and Π⁰ = J ω per length give the run that ẋ and ω give."""
    model, section = cy.Model(rod, supports=[cy.supports.pin(rod.start)]), rod.section
    v = np.stack([rod.nodes, -rod.nodes, rod.nodes**2], axis=1)
    omega = np.stack([np.sin(rod.nodes), np.cos(rod.nodes), 2 + rod.nodes], axis=1)
    velocities = {"velocity": v, "angular_velocity": omega}
    momenta = {"momentum": section.mass_per_length * v, "angular_momentum": omega @ section.inertia}
    one, two = (cy.simulate(model, 0.01, rotation=rotation, initial={rod: i}) for i in (velocities, momenta))
    assert np.allclose(one.frames.momenta[0], two.frames.momenta[0], rtol=1e-14)
    assert np.allclose(one.frames.values, two.frames.values, atol=1e-12)
    assert np.allclose(one[rod].velocity[0, 1:], v[1:], atol=1e-14)
    assert np.allclose(two[rod].angular_velocity[0], omega, rtol=1e-12)


def test_held_components_do_not_start_moving(rod: Any) -> None:
    model = cy.Model(rod, supports=[cy.supports.hold(rod.start, position="xz", rotation="y")])
    start = {rod: {"velocity": (1.0, 2.0, 3.0), "angular_velocity": (4.0, 5.0, 6.0)}}
    run = cy.simulate(model, 0.005, initial=start)
    first = run[rod].isel(time=0, node=0)
    assert np.allclose(first.velocity, (0.0, 2.0, 0.0))
    assert np.allclose(first.angular_velocity, (4.0, 0.0, 6.0))
    place = run[rod].position.isel(node=0).values
    assert np.all(place[:, [0, 2]] == place[0, [0, 2]])
    assert place[-1, 1] > place[0, 1]


@pytest.mark.parametrize("rule", RULES)
def test_the_mass_center_of_a_free_rod_falls_exactly(rod: Any, rule: str) -> None:
    """x(t) = x₀ + v t + ½ g t², whatever the rod does meanwhile and however large the step."""
    model = cy.Model(rod, loads=[cy.loads.gravity(WEIGHT)])
    start = {"velocity": lambda s: (s, 1.0 - s, 0.5), "angular_velocity": (0.0, 3.0, 1.0)}
    run = cy.simulate(model, t_end=0.2, rule=RULES[rule], initial={rod: start})
    share = np.full(7, 1 / 6)
    share[[0, -1]] /= 2
    center = share @ run[rod].position.values
    v = share @ run[rod].velocity.values[0]
    t = run.time[:, None]
    assert np.abs(center - (center[0] + v * t + 0.5 * WEIGHT * t**2)).max() < 1e-12
    assert np.allclose(run.linear_momentum, rod.mass * (v + WEIGHT * t), rtol=1e-11)


def test_time_may_start_elsewhere(system: Any) -> None:
    one = cy.integrate(system, START, 1.0, 0.01)
    two = cy.integrate(system, START, 4.0, 0.01, t_start=3.0)
    assert np.allclose(two.time, one.time + 3.0, rtol=1e-15)
    assert np.allclose(two.data["p"], one.data["p"], atol=1e-12)


# on the way


def test_progress_is_told(rod: Any) -> None:
    told: list[tuple[float, float]] = []
    run = cy.simulate(cy.Model(rod), 0.1, 1e-6, save_every=0.01, progress=lambda done, time: told.append((done, time)))
    fractions = [done for done, _ in told]
    assert len(told) > 2
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert told[-1][1] == pytest.approx(run.time[-1])
    assert all(time == pytest.approx(0.1 * done) for done, time in told)


def test_a_blow_up_tells_time_node_and_remedy(rod: Any) -> None:
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity(WEIGHT)])
    line = (
        r"^stopped at t = .* s \(step \d+\) at node \d of rod: .*; (dt is over the step limit .*|give dt below .*)\. "
    )
    with pytest.raises(cy.SimulationError, match=line) as caught:
        cy.simulate(model, 1.0, 1e-3, save_every=0.01, allow_unstable=True)
    partial = caught.value.partial
    assert np.isfinite(partial.frames.values).all()
    assert partial.time[-1] < 1.0
    assert f"t = {partial.time[-1]:.6g} s" in str(caught.value)


# going on


def loaded(rod: Any, rule: Any, rotation: str, t_end: float) -> Any:
    """A pinned rod with loads of limited time, so that their windows must be met too."""
    loads = [
        cy.loads.gravity(WEIGHT),
        cy.loads.force(rod.end, lambda t: (np.sin(50 * t), t, 1.0), frame="body", start=0.005, until=0.0333),
        cy.loads.moment(rod.node(2), (0.0, 0.01, 0.0)),
    ]
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=loads)
    return cy.simulate(model, t_end, 7e-5, rule=rule, rotation=rotation, save_every=1e-3)


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("rule", RULES)
def test_a_model_goes_on_bit_for_bit(rod: Any, rule: str, rotation: str) -> None:
    whole = loaded(rod, RULES[rule], rotation, 0.05)
    half = loaded(rod, RULES[rule], rotation, 0.02)
    rest = cy.integrate(half.system, half.state, t_end=0.05, save_every=1e-3)
    assert np.array_equal(half.frames.values, whole.frames.values[:21])
    assert np.array_equal(rest.frames.values, whole.frames.values[20:])
    assert np.array_equal(rest.frames.momenta, whole.frames.momenta[20:])
    assert np.array_equal(rest.time, whole.time[20:])
    assert np.array_equal(rest.energy, whole.energy[20:])
    assert rest.steps == whole.steps - half.steps


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("rule", RULES)
def test_a_lagrangian_goes_on_bit_for_bit(rule: str, rotation: str) -> None:
    """Also from a frame in the middle, and over a span whose saves do not divide it."""
    system = top_system(RULES[rule], rotation)
    whole = cy.integrate(system, START, 2.0, 0.013, save_every=0.1)
    for k in (3, 11, 20):
        if k < 20:
            rest = cy.integrate(system, whole.frames.state(k), 2.0, save_every=0.1)
            assert np.array_equal(rest.frames.values, whole.frames.values[k:])
            assert np.array_equal(rest.frames.momenta, whole.frames.momenta[k:])
    odd = cy.integrate(system, START, 2.0, 0.013, save_every=0.3)
    rest = cy.integrate(system, odd.frames.state(4), 2.0, save_every=0.3)
    assert np.array_equal(rest.frames.values, odd.frames.values[4:])
    assert np.array_equal(rest.time, odd.time[4:])


def test_a_new_step_starts_a_new_count(system: Any) -> None:
    first = cy.integrate(system, START, 1.0, 0.01)
    then = cy.integrate(system, first.state, 2.0, 0.005)
    assert then.dt == pytest.approx(0.005)
    assert then.time[0] == pytest.approx(1.0)
    assert (then.state.origin, then.state.step) == (pytest.approx(1.0), 200)


def test_a_state_of_another_system_is_refused(rod: Any, system: Any) -> None:
    state = cy.simulate(cy.Model(rod), 0.001).state
    refused(lambda: cy.integrate(system, state, 2.0), "of another system or rotation form; this one has values")
    mine = cy.integrate(system, START, 1.0, 0.01).state
    refused(lambda: cy.integrate(top_system(rotation="matrix"), mine, 2.0), "of another system or rotation form")
