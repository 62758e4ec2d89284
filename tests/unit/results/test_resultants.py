"""Stress resultants at nodes: ends, loads, supports, equilibria, and the balance of momentum at every step."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation as Turn

import cayley as cy

WEIGHT = np.array([0.0, 0.0, -9.81])
RULES = {"nodal": cy.rules.nodal, "verlet": cy.rules.verlet}


@pytest.fixture(params=RULES)
def rule(request: pytest.FixtureRequest) -> Any:
    return RULES[request.param]


@pytest.fixture
def rod() -> Any:
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
    section = cy.Section.rectangle(0.02, 0.03, rubber)
    return cy.Rod(section, length=0.8, elements=8, direction=(1, 0, 1), normal=(0, 1, 0))


def in_space(data: Any, node: int, name: str) -> np.ndarray:
    """A body vector of a node, turned into space, shape (time, 3)."""
    turn = Turn.from_quat(data.rotation.values[:, node], scalar_first=True)
    return turn.apply(data[name].values[:, node])


def test_free_ends_carry_exactly_nothing(thrown: Any) -> None:
    ends = thrown.run[thrown.rod].isel(node=[0, -1])
    for name in ("force", "moment", "sigma", "Sigma"):
        assert not np.any(ends[name].values), name
    assert np.any(thrown.run[thrown.rod].force.isel(node=slice(1, -1)).values)


@pytest.mark.parametrize("by", ["gravity", "line force"])
def test_hanging_rod_carries_the_weight_below(hanging: Callable[..., Any], rule: Any, by: str) -> None:
    rod, _, start = hanging()
    line = rod.section.mass_per_length * WEIGHT
    load = cy.loads.gravity(WEIGHT) if by == "gravity" else cy.loads.line_force(rod, line)
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[load])
    run = cy.simulate(model, t_end=0.02, rule=rule, initial={rod: start}, save_every=0.001)
    data, mass = run[rod], rod.section.mass_per_length
    below = mass * 9.81 * (rod.length - rod.nodes)
    total = below[0]
    assert np.allclose(data.force.sel(axis="z"), below, atol=1e-9 * total)
    assert np.allclose(data.sigma.sel(axis="z"), below, atol=1e-9 * total)  # what the support gives: upward
    assert np.allclose(data.force.sel(axis=["x", "y"]), 0.0, atol=1e-9 * total)
    assert np.allclose(data.moment, 0.0, atol=1e-9 * total)
    assert not np.any(data.force.isel(node=-1).values)


def test_hanging_weight_is_carried_all_the_way_up(hanging: Callable[..., Any]) -> None:
    rod, _, start = hanging(load=3.0)
    loads = [cy.loads.gravity(WEIGHT), cy.loads.force(rod.end, (0, 0, -3.0))]
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=loads)
    run = cy.simulate(model, t_end=0.02, initial={rod: start}, save_every=0.001)
    axial = run[rod].force.sel(axis="z")
    total = rod.mass * 9.81 + 3.0
    assert np.allclose(axial.isel(node=0), total, rtol=1e-9)
    assert np.allclose(axial.isel(node=-1), 3.0, rtol=1e-14)


def test_a_force_at_a_node_is_the_jump_across_it(hanging: Callable[..., Any]) -> None:
    """Half way down hangs a weight; the node's own value is the mean of what is above and below."""
    rod, _, _ = hanging()
    middle = 0.5 * (rod.nodes[1:] + rod.nodes[:-1])
    carried = rod.section.mass_per_length * 9.81 * (rod.length - middle) + 2.0 * (middle < 1.0)
    depth = np.append(0.0, np.cumsum(rod.element_length * (1.0 + carried / rod.section.stiffness[2, 2])))
    loads = [cy.loads.gravity(WEIGHT), cy.loads.force(rod.at(1.0), (0, 0, -2.0))]
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=loads)
    run = cy.simulate(model, t_end=0.01, initial={rod: {"position": np.outer(depth, (0, 0, -1))}}, save_every=0.001)
    below = rod.section.mass_per_length * 9.81 * (rod.length - rod.nodes)
    expected = below + np.select([rod.nodes < 0.99, rod.nodes < 1.01], [2.0, 1.0], 0.0)
    assert np.allclose(run[rod].force.sel(axis="z"), expected, atol=1e-8)


def test_end_loads_appear_at_the_ends(rod: Any, rule: Any) -> None:
    """At the far end the internal force is the load, at the near end its opposite, however the rod moves."""
    pull, twist = np.array([0.3, -0.1, 0.2]), np.array([0.02, 0.01, -0.03])
    loads = [
        cy.loads.force(rod.end, pull),
        cy.loads.force(rod.start, -2 * pull, frame="body"),
        cy.loads.moment(rod.end, twist, frame="body"),
        cy.loads.moment(rod.start, 3 * twist),
        cy.loads.gravity(WEIGHT),
        cy.loads.line_force(rod, (0.1, 0.2, 0.3)),
    ]
    run = cy.simulate(cy.Model(rod, loads=loads), t_end=0.05, rule=rule, save_every=0.005)
    data = run[rod]
    assert np.allclose(in_space(data, -1, "force"), pull, rtol=1e-12)
    assert np.allclose(data.force.isel(node=0), 2 * pull, rtol=1e-12)
    assert np.allclose(data.moment.isel(node=-1), twist, rtol=1e-12)
    assert np.allclose(in_space(data, 0, "moment"), -3 * twist, rtol=1e-12)


def test_a_load_of_limited_time_is_gone_after_it(rod: Any) -> None:
    push = cy.loads.force(rod.end, lambda t: (np.sin(t), t, 1.0), start=0.01, until=0.02)
    run = cy.simulate(cy.Model(rod, loads=[push]), t_end=0.03, dt=5e-5, save_every=0.005)
    force = in_space(run[rod], -1, "force")
    t = run.time
    on = (t > 0.0101) & (t < 0.0199)
    assert np.allclose(force[on], np.stack([np.sin(t), t, np.ones_like(t)], axis=1)[on], rtol=1e-12)
    assert not np.any(force[(t < 0.0099) | (t > 0.0201)])


def test_pure_bending_is_an_equilibrium() -> None:
    """A moment at the tip of a clamped rod bends it to a polygon of equal angles, without any force, exactly.

    θ from EI dΩ²/2 ds/dθ = M with Ω = (4/ds) tan(θ/4).
    """
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
    rod = cy.Rod(cy.Section.circle(0.01, rubber), length=1.0, elements=12)
    ds, theta = rod.element_length, 0.15
    tangent = np.tan(theta / 4)
    moment = rod.section.stiffness[3, 3] * 4 / ds * tangent * (1 + tangent**2)
    half = 0.5 * theta * np.arange(rod.elements + 1)
    rotation = np.stack([np.cos(half), np.sin(half), 0 * half, 0 * half], axis=1)
    middle = theta * (np.arange(rod.elements) + 0.5)
    steps = ds * np.stack([0 * middle, -np.sin(middle), np.cos(middle)], axis=1)
    position = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    model = cy.Model(
        rod,
        supports=[cy.supports.clamp(rod.start)],
        loads=[cy.loads.moment(rod.end, (moment, 0.0, 0.0), frame="body")],
    )
    run = cy.simulate(model, t_end=0.05, initial={rod: {"position": position, "rotation": rotation}}, save_every=0.005)
    data = run[rod]
    assert np.abs(data.position - position).max() < 1e-9
    assert np.allclose(data.moment, (moment, 0.0, 0.0), atol=1e-7 * moment)
    assert np.abs(data.force).max() < 1e-6 * moment / rod.length


@pytest.mark.parametrize("kind", ["pin", "clamp"])
def test_reactions_balance_momentum_at_every_step(rod: Any, rule: Any, kind: str) -> None:
    """Pʲ⁺¹ − Pʲ = ½h (Rʲ + Rʲ⁺¹) + h W and likewise about the support, with R, M = σ, Λ Σ at the held node."""
    support = getattr(cy.supports, kind)(rod.start)
    model = cy.Model(rod, supports=[support], loads=[cy.loads.gravity(WEIGHT)])
    start = {"velocity": lambda s: (0.0, 2 * s, 0.0), "angular_velocity": (0.0, 0.0, 1.0)}
    run = cy.simulate(model, t_end=0.01, dt=5e-5, rule=rule, initial={rod: start}, save_every=5e-5)
    data, h = run[rod], run.dt
    weights = np.full(rod.elements + 1, rod.element_length)
    weights[[0, -1]] *= 0.5
    mass = rod.section.mass_per_length * weights
    force = data.sigma.values[:, 0] + rod.mass * WEIGHT
    moment = -in_space(data, 0, "moment") + np.cross(mass @ data.position.values, WEIGHT)
    for momentum, cause in ((run.linear_momentum, force), (run.angular_momentum, moment)):
        change = np.diff(momentum.values, axis=0)
        size = np.abs(h * cause).max()
        assert np.allclose(change[1:], 0.5 * h * (cause[:-1] + cause[1:])[1:], atol=1e-9 * size)
    assert np.any(np.abs(data.moment.values[:, 0]) > 1e-3) == (kind == "clamp")


def test_string_carries_its_tension() -> None:
    @cy.lagrangian(x=cy.Vector(2), s=cy.Interval)
    def string(q: Any, c: Any) -> Any:
        return 0.5 * cy.dot(q.x_t, q.x_t) - 0.5 * c.stiffness * (cy.norm(q.x_s) - 1.0) ** 2

    system = cy.compile(
        string,
        rule=cy.rules.verlet,
        domain=cy.Interval(0.0, 2.0, elements=6),
        constants={"stiffness": 50.0},
        held={"x": ("start", "end")},
    )
    straight = 1.2 * np.stack([0.6 * system.nodes, 0.8 * system.nodes], axis=1)
    run = cy.integrate(system, {"x": straight}, t_end=0.1)
    assert np.allclose(run.observed.resultants, -10.0 * np.array([0.6, 0.8]), rtol=1e-12)
