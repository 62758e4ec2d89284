"""The choice of rule and step: the search on made-up errors, costs, and runs whose error is what was wanted."""

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import cayley as cy
from cayley import choice
from cayley.choice import Alternative, Task, Unreached, choose, costs, pilot, settle
from cayley.choice.pilot import Track
from cayley.system.discretize import discretize

EXPLICIT, MIDPOINT, QUARTIC = cy.rules.verlet, cy.rules.midpoint, cy.rules.galerkin(time=2)
COSTS = {EXPLICIT: 1e-8, MIDPOINT: 1e-6, QUARTIC: 1e-5}
"""Of a node and step [s]."""


class Clockwork:
    """A system whose error is made up."""

    def __init__(self, limit: float) -> None:
        self.limit, self.values = limit, np.zeros((5, 3))

    def stable_dt(self, state: Any) -> float:
        return self.limit


def task(limit: float = math.inf, **given: Any) -> Task:
    made = {"nodes": 5, "span": 10.0, "save_every": 0.1, "accuracy": 1e-3}
    return Task(begin=lambda rule: (Clockwork(limit), rule), **made | given)  # type: ignore[arg-type, return-value]


@pytest.fixture
def pretend(monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[tuple[Any, float, int]]]:
    """Replace trials by positions that err by error(rule, h) × (t/t_end); None for a step that is not solved."""

    def start(error: Callable[[Any, float], float | None], costs: Any = COSTS) -> list[tuple[Any, float, int]]:
        made = []

        def follow(system: Any, rule: Any, spacing: float, frames: int, h: float) -> Track | None:
            made.append((rule, h, frames))
            stride = math.ceil(spacing / h * (1.0 - 1e-9))
            size = error(rule, spacing / stride)
            if size is None:
                return None
            part = np.arange(frames + 1) / pilot.frames_of(5)
            way = (part * (1.0 + size))[:, None, None] * np.ones((1, 5, 1))
            places = np.linspace(0.0, 1.0, 5)[None, :, None] * [0.0, 0.0, 1.0] + way * [1.0, 0.0, 0.0]
            return Track(spacing / stride, places, places[..., :0])

        monkeypatch.setattr(settle, "follow", follow)
        monkeypatch.setattr(settle, "seconds_per_step", lambda rule, nodes: nodes * costs[rule])
        return made

    return start


# the search for a step


def test_the_step_has_half_the_wanted_error(pretend: Any) -> None:
    pretend(lambda rule, h: 3.0 * h**2)
    found = settle.settle(task(), MIDPOINT)
    assert not found.reason
    assert 0.2e-3 < 3.0 * found.dt**2 <= 0.5e-3
    assert found.error == pytest.approx(3.0 * found.dt**2, rel=0.4)
    assert found.error <= 0.5e-3
    assert found.steps == pytest.approx(10.0 / found.dt)
    assert found.cost == pytest.approx(found.steps * 5e-6)


def test_high_orders_get_long_steps_without_trust_in_the_order(pretend: Any) -> None:
    pretend(lambda rule, h: 50.0 * h**4)
    found = settle.settle(task(), QUARTIC)
    assert 50.0 * found.dt**4 <= 0.5e-3
    assert found.dt > 0.3 * (0.5e-3 / 50.0) ** 0.25


def test_steps_that_are_not_solved_are_halved(pretend: Any) -> None:
    pretend(lambda rule, h: None if h > 0.02 else 1e-6)
    found = settle.settle(task(), MIDPOINT)
    assert not found.reason
    assert 0.01 < found.dt <= 0.02


def test_no_step_is_longer_than_the_time_between_saves(pretend: Any) -> None:
    pretend(lambda rule, h: 1e-9)
    found = settle.settle(task(save_every=0.03), MIDPOINT)
    assert found.dt <= 0.03
    assert found.error < 1e-9


def test_the_step_limit_is_kept(pretend: Any) -> None:
    made = pretend(lambda rule, h: 1e-9)
    found = settle.settle(task(limit=1e-3), EXPLICIT)
    assert 0.8e-3 < found.dt <= 0.9e-3
    assert [h for _, h, _ in made] == pytest.approx([0.9e-3, 0.9e-3 / 1.25], rel=0.01)


def test_chance_is_not_taken_for_accuracy(pretend: Any) -> None:
    """Where steps of any size differ by 0.3, a ratio of steps of 8 must not make 0.3/63 of it."""
    chance = {}

    def error(rule: Any, h: float) -> float:
        return chance.setdefault(h, 0.3 * (len(chance) % 2))

    pretend(error)
    found = settle.settle(task(), MIDPOINT)
    assert "still differs by 0.3" in found.reason
    assert not found.excessive


def test_a_search_ends_where_it_costs_too_much(pretend: Any) -> None:
    pretend(lambda rule, h: None)
    found = settle.settle(task(), MIDPOINT, bound=0.1)
    assert found.excessive
    assert found.reason == "takes over 0.1 s, longer steps fail"


def test_a_short_window_is_extrapolated(pretend: Any) -> None:
    made = pretend(lambda rule, h: 1e-6, costs={EXPLICIT: 1.0})
    settle.settle(task(limit=0.01), EXPLICIT, bound=1e9)
    assert [frames for _, _, frames in made] == [math.ceil(64 * settle.SHARE)] * 2
    coarse, fine = (Track(0.1, t, t[..., :0]) for t in (np.zeros((17, 2, 1)), np.linspace(0, 1, 34).reshape(17, 2, 1)))
    fine.places[0] = [[0.0], [1.0]]
    assert settle.expected_difference(task(), coarse, fine) == pytest.approx(4.0, rel=0.1)  # 16 of 64 frames


@pytest.mark.parametrize(("given", "least"), [({"busy_after": 9.0}, 58), ({"whole": True}, 64)])
def test_a_window_holds_the_start_of_all_loads(pretend: Any, given: Any, least: int) -> None:
    made = pretend(lambda rule, h: 1e-6, costs={EXPLICIT: 1.0})
    settle.settle(task(limit=0.01, **given), EXPLICIT, bound=1e9)
    assert min(frames for _, _, frames in made) >= least


def test_a_window_in_which_nothing_moves_grows(monkeypatch: pytest.MonkeyPatch, pretend: Any) -> None:
    made = pretend(lambda rule, h: 1e-6, costs={EXPLICIT: 1.0})
    monkeypatch.setattr(settle, "MOVED", 700.0)  # of the extent, at an accuracy of 1e-3: after 45 of 64 frames
    settle.settle(task(limit=0.01), EXPLICIT, bound=1e9)
    assert [frames for _, _, frames in made] == [20, 40, 64, 64]


# the choice between rules


def test_a_cheap_explicit_run_needs_no_trials_of_others(pretend: Any) -> None:
    made = pretend(lambda rule, h: 1e-6)
    found = choose(task(limit=1e-4), [EXPLICIT, MIDPOINT, QUARTIC])
    assert found.best.rule is EXPLICIT
    assert {rule for rule, _, _ in made} == {EXPLICIT}


def test_a_stiff_problem_goes_to_an_implicit_rule(pretend: Any) -> None:
    made = pretend(lambda rule, h: 0.1 * h**2)
    found = choose(task(limit=1e-7), [EXPLICIT, MIDPOINT, QUARTIC])
    assert found.best.rule is MIDPOINT
    assert EXPLICIT not in {rule for rule, _, _ in made}  # nobody tries 1e8 steps
    assert "midpoint with dt = 0.05 s is the cheapest found to keep positions within 0.001" in found.why
    assert "verlet not tried, takes at least 5.6 s" in found.why


def test_high_accuracy_goes_to_a_high_order(pretend: Any) -> None:
    pretend(lambda rule, h: h**2 if rule is not QUARTIC else h**4)
    found = choose(task(limit=1e-9, accuracy=1e-9), [EXPLICIT, MIDPOINT, QUARTIC])
    assert found.best.rule is QUARTIC


def test_what_fails_leaves_the_field_to_the_explicit_rule(pretend: Any) -> None:
    pretend(lambda rule, h: None if rule is not EXPLICIT else 1e-6)
    found = choose(task(limit=2e-6), [EXPLICIT, MIDPOINT, QUARTIC])
    assert found.best.rule is EXPLICIT


def test_an_explicit_rule_that_fails_leaves_the_field_to_the_others(pretend: Any) -> None:
    pretend(lambda rule, h: None if rule is EXPLICIT else 0.1 * h**2)
    assert choose(task(limit=1e-4), [EXPLICIT, MIDPOINT]).best.rule is MIDPOINT


def test_thorough_tries_all(pretend: Any) -> None:
    made = pretend(lambda rule, h: 1e-6)
    found = choose(task(limit=1e-4), [EXPLICIT, MIDPOINT, QUARTIC], thorough=True)
    assert {rule for rule, _, _ in made} == {EXPLICIT, MIDPOINT, QUARTIC}
    assert len(found.others) == 2
    assert all(isinstance(one, Alternative) and one.cost >= found.best.cost for one in found.others)


def test_no_rule(pretend: Any) -> None:
    pretend(lambda rule, h: None)
    with pytest.raises(Unreached, match=r"^accuracy=0.001 is not reached \(.*verlet takes over .*give a shorter t_end"):
        choose(task(limit=1e-3), [EXPLICIT, MIDPOINT])


# costs


def test_costs_are_measured_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setattr(costs, "_SESSION", {})
    monkeypatch.setattr(costs, "_path", lambda: tmp_path / "costs.json")
    measured = iter([1.23456e-8])
    monkeypatch.setattr(costs, "_measured", lambda rule: next(measured))
    assert costs.seconds_per_node(EXPLICIT) == 1.2e-8
    monkeypatch.setattr(costs, "_SESSION", {})
    assert costs.seconds_per_node(EXPLICIT) == 1.2e-8  # from the file
    assert json.loads((tmp_path / "costs.json").read_text()) == {"verlet, 1": 1.2e-8}


@pytest.mark.parametrize("content", ["", "[]", '{"verlet, 1": "fast"}', '{"verlet, 1": -1}'])
def test_a_broken_file_of_costs_is_not_trusted(monkeypatch: pytest.MonkeyPatch, tmp_path: Any, content: str) -> None:
    monkeypatch.setattr(costs, "_SESSION", {})
    monkeypatch.setattr(costs, "_path", lambda: tmp_path / "costs.json")
    monkeypatch.setattr(costs, "_measured", lambda rule: 2e-8)
    (tmp_path / "costs.json").write_text(content)
    assert costs.seconds_per_node(EXPLICIT) == 2e-8


def test_measured_cost_is_of_the_right_size() -> None:
    assert 2e-9 < costs._measured(EXPLICIT) < 2e-6


# runs


def pendulum(modulus: float, radius: float, elements: int = 10, **more: Any) -> tuple[Any, Any]:
    material = cy.Material(density=1100.0, youngs_modulus=modulus, poisson_ratio=0.3)
    rod = cy.Rod(cy.Section.circle(radius, material), length=1.0, direction=(1, 0, 0), elements=elements)
    loads = [cy.loads.gravity((0, 0, -9.81)), *more.get("loads", lambda rod: [])(rod)]
    return rod, cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=loads)


@pytest.mark.parametrize(("modulus", "radius", "rule"), [(5e6, 5e-3, "verlet"), (2e11, 1e-3, "midpoint")])
def test_runs_are_as_exact_as_wanted(modulus: float, radius: float, rule: str) -> None:
    rod, model = pendulum(modulus, radius)
    run, again = (cy.simulate(model, t_end=0.5, accuracy=1e-3) for _ in range(2))
    assert (run.rule, run.dt) == (again.rule, again.dt)
    assert run.rule == rule
    assert 0.0 < run.error_estimate <= 1e-3
    finer = cy.simulate(model, t_end=0.5, dt=0.2 * run.dt, rule=cy.rules.by_name(run.rule))
    assert np.linalg.norm((run[rod].position - finer[rod].position).values, axis=2).max() < 1e-3
    assert run.why.startswith(f"{rule} with dt = ")


def test_a_rule_that_is_given_is_kept() -> None:
    _, model = pendulum(5e6, 5e-3)
    assert cy.simulate(model, t_end=0.1, accuracy=1e-2, rule=cy.rules.nodal).rule == "nodal"


@pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.galerkin(time=2)], ids=str)
def test_own_lagrangian(rule: Any) -> None:
    @cy.lagrangian(p=cy.Rotation())
    def body(q: Any, c: Any) -> Any:
        return 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) - c.weight * q.p.rotate(cy.E3)[2]

    constants = {"inertia": np.diag([1.0, 2.0, 1.5]), "weight": 3.0}
    start = {"p": (0.8, 0.6, 0, 0), "p_t": (1.0, 5.0, -0.3)}
    system = cy.compile(body, rule=rule, constants=constants)
    run = cy.integrate(system, start, t_end=2.0, accuracy=1e-3)
    exact = cy.integrate(
        cy.compile(body, rule=cy.rules.galerkin(time=4), constants=constants), start, t_end=2.0, dt=0.01
    )
    error = 2.0 * np.linalg.norm((run.data["p"] - exact.data["p"]).values, axis=1).max()
    assert error < 1e-3
    assert error < 4.0 * run.error_estimate


def test_a_point_is_measured_by_its_way() -> None:
    @cy.lagrangian(x=cy.Vector(2))
    def planet(q: Any, c: Any) -> Any:
        return 0.5 * cy.dot(q.x_t, q.x_t) + 1.0 / cy.norm(q.x)

    system = cy.compile(planet, rule=cy.rules.verlet)
    run = cy.integrate(system, {"x": (1e6, 0), "x_t": (0, 1e-3)}, t_end=6e8, accuracy=1e-2)
    angle = 6e8 * 1e-9
    end = run.data["x"].isel(time=-1).values
    assert np.linalg.norm(end - 1e6 * np.array([math.cos(angle), math.sin(angle)])) < 1e-2 * 1e6


def test_a_run_that_stops_is_chosen_again(monkeypatch: pytest.MonkeyPatch) -> None:
    from cayley import simulation

    _, model = pendulum(5e6, 5e-3)
    original, steps = simulation._run, []

    def stop_once(system: Any, state: Any, t_end: float, dt: float, *rest: Any, **more: Any) -> Any:
        run = original(system, state, t_end, dt, *rest, **more)
        steps.append(dt)
        if len(steps) == 1:
            raise cy.SimulationError("stopped", run)
        return run

    monkeypatch.setattr(simulation, "_run", stop_once)
    run = cy.simulate(model, t_end=0.1, accuracy=1e-2)
    assert steps[1] <= 0.5 * steps[0]
    assert "Before, verlet with dt = " in run.why


def test_late_loads_are_told_to_the_trials(monkeypatch: pytest.MonkeyPatch) -> None:
    from cayley import simulation

    seen = []

    def watch(task: Task, *rest: Any, **more: Any) -> Any:
        seen.append(task)
        return choice.choose(task, *rest, **more)

    monkeypatch.setattr(simulation, "choose", watch)
    _, model = pendulum(5e6, 5e-3, loads=lambda rod: [cy.loads.force(rod.end, (0, 0.01, 0), start=0.08)])
    cy.simulate(model, t_end=0.1, accuracy=1e-2)
    assert seen[0].busy_after == 0.08
    assert seen[0].loads > 0.0


def test_why_is_kept_in_the_store(tmp_path: Any) -> None:
    _, model = pendulum(5e6, 5e-3)
    run = cy.simulate(model, t_end=0.05, accuracy=1e-2)
    run.save(tmp_path / "run.zarr")
    opened = cy.Trajectory.open(tmp_path / "run.zarr")
    assert (opened.why, opened.error_estimate) == (run.why, run.error_estimate)


def test_nothing_is_chosen_when_dt_is_given() -> None:
    _, model = pendulum(5e6, 5e-3)
    run = cy.simulate(model, t_end=0.05, dt=1e-4)
    assert run.rule == "verlet"
    assert math.isnan(run.error_estimate)
    assert run.why.startswith("Rule and step were given")


@pytest.mark.parametrize("accuracy", [0.0, -1e-3, 1e-12, 0.5, 3, math.nan, math.inf, True, "1e-3", None])
def test_accuracy_that_is_none(accuracy: Any) -> None:
    _, model = pendulum(5e6, 5e-3)
    if accuracy is None:
        with pytest.raises(ValueError, match=r"^dt = 0.0001 and accuracy = 0.001 are given; give one of them$"):
            cy.simulate(model, t_end=0.1, dt=1e-4, accuracy=1e-3)
    else:
        with pytest.raises(ValueError, match=r"^accuracy is .*; give a number between 1e-12 and 0.5, such as 1e-3$"):
            cy.simulate(model, t_end=0.1, accuracy=accuracy)


def test_joints_and_springs_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """An explicit step costs much more with a joint, less with a spring alone; an implicit one about the same."""
    monkeypatch.setattr(costs, "seconds_per_node", COSTS.__getitem__)
    rod = cy.Rod(
        cy.Section.circle(5e-3, cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)),
        length=1.0,
        elements=3,
    )
    place = cy.ground.at((0, 0, 1.5))
    joined = cy.Model(rod, joints=[cy.joints.rigid_link(rod.end, place)])
    sprung = cy.Model(rod, springs=[cy.springs.linear(rod.end, place, stiffness=1.0)])
    asked = [(model, rule) for model in (joined, sprung, cy.Model(rod)) for rule in (EXPLICIT, MIDPOINT)]
    found = [costs.seconds_of_ties(rule, discretize(model, rule)) / COSTS[rule] for model, rule in asked]
    assert found == pytest.approx([costs.JOINED, costs.JOINED_IMPLICIT, costs.SPRUNG, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("spin", [5.0, 150.0])
def test_bodies_alone(spin: float) -> None:
    """A heavy top, slow and fast: rule and step are chosen, and its angles are as exact as wanted."""
    top = cy.Body(mass=15.0, inertia=np.diag([0.234375, 0.46875, 0.234375]), position=(0, 1, 0), name="top")
    tip = cy.joints.ball(top.centre.offset((0, -1, 0)), cy.ground)
    model = cy.Model(top, joints=[tip], loads=[cy.loads.gravity((0, 0, -9.81))])
    start = {top: {"angular_velocity": (0, spin, 0)}}
    run = cy.simulate(model, t_end=0.3, accuracy=1e-3, initial=start)
    finer = cy.simulate(model, t_end=0.3, dt=0.1 * run.dt, rule=cy.rules.by_name(run.rule), initial=start)
    apart = 2.0 * np.linalg.norm((run[top].rotation - finer[top].rotation).values, axis=1).max()
    assert apart < 1e-3
