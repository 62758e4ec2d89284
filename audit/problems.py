"""The nonlinear problems of the audit: two of a lone rotation, two of a rod."""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import cayley as cy
from cayley.discrete.rules import Rule, gauss
from cayley.lie import quaternion
from cayley.model import Model
from cayley.results.trajectory import Trajectory
from cayley.system.compile import chain_nodes
from cayley.system.discretize import discretize, initial_values
from cayley.system.legendre import initial_state
from cayley.system.system import State, System
from verify.problems import TOP, TOP_START, bend, free_body, heavy_top, in_flight, thick_rod
from verify.test_order import jacobi, product

INERTIA, SPIN = np.array([1.0, 2.0, 3.0]), np.array([0.3, 0.2, 1.0])
LIVELY, CALM, SMALL = "lively", "calm", "small"
Prepared = tuple[System, State]


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """One problem with everything the measures ask of it.

    Args:
        name: its name on the page.
        on_interval: whether it is a density on an interval.
        prepare: (rule, form, kind) -> compiled system and start: LIVELY for the order, CALM for the long run (energy
            wanders through the modes of a lively rod, whatever the rule), SMALL for the Jacobian of the flow.
        exact: rule -> values at the end that the order is measured against (see place).
        span: time over which the order is measured [s].
        steps: order -> numbers of steps of the four points.
        step: order -> step of the long run, the reversal and the flow [s].
        maps: run -> momentum maps the problem has symmetries for, shape (time, k).
        momenta: their names.
    """

    name: str
    on_interval: bool
    prepare: Callable[..., Prepared]
    exact: Callable[[Rule], np.ndarray]
    span: float
    steps: dict[int, tuple[int, ...]]
    step: dict[int, float]
    maps: Callable[[Trajectory], np.ndarray]
    momenta: str


def place(system: System, state: State) -> np.ndarray:
    """Positions and rotation matrices of all nodes as one vector: the same for both forms, blind to the sign of p."""
    layout, parts = system.layout, []
    for name in layout.fields:
        rows = state.values[:, layout.rows_of(name)]
        turns = name in layout.rotations
        parts.append(quaternion.to_matrix(layout.representation.to_quaternion(rows)) if turns else rows)
    return np.concatenate([part.ravel() for part in parts])


def prepare_top(rule: Rule, form: str = "quaternion", kind: str = LIVELY) -> Prepared:
    """The fast top of Bruels, Cardona and Arnold (2012)."""
    system = cy.compile(heavy_top, rule=rule, constants=TOP, rotation=form)
    return system, started(system, TOP_START)


def prepare_body(rule: Rule, form: str = "quaternion", kind: str = LIVELY) -> Prepared:
    """A free body of three different moments of inertia."""
    system = cy.compile(free_body, rule=rule, constants={"inertia": np.diag(INERTIA)}, rotation=form)
    return system, started(system, {"p": (1, 0, 0, 0), "p_t": SPIN})


def prepare_flight(rule: Rule, form: str = "quaternion", kind: str = LIVELY) -> Prepared:
    """A thick rubber rod, bent, thrown and spinning, free at both ends."""
    rod, model = thick_rod(elements_of(rule, 7, kind), clamped=False)
    fine = refined(rod, rule.degree)
    spin = (1.0, 5.0, -8.0) if kind != CALM else (0.5, 2.0, -3.0)
    start = in_flight(fine, bend(fine, 4.0 if kind != CALM else 1.0), velocity=(0.3, -0.2, 0.5), spin=spin)
    return from_model(model, rule, form, {rod: start})


def prepare_pendulum(rule: Rule, form: str = "quaternion", kind: str = LIVELY) -> Prepared:
    """The thin rubber pendulum of the benchmarks, pinned, bent and swinging in space under its weight.

    Lively it starts horizontal; calm it hangs.
    """
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(5e-3, rubber, shear_correction=27 / 28)
    direction = (1, 0, 0) if kind != CALM else (0, 0, -1)
    rod = cy.Rod(section, length=1.0, direction=direction, normal=(0, 1, 0), elements=elements_of(rule, 5, kind))
    gravity = cy.loads.gravity((0.0, 0.0, -9.81))
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[gravity])
    fine = refined(rod, rule.degree)
    spin = (1.0, 5.0, -8.0) if kind != CALM else (0.3, 0.6, -0.2)
    start = in_flight(fine, bend(fine, 3.0 if kind != CALM else 0.1), velocity=(0.0, 0.0, 0.0), spin=spin)
    return from_model(model, rule, form, {rod: start})


def elements_of(rule: Rule, nodes: int, kind: str) -> int:
    """As many elements as give so many nodes; of a small rod two with two nodes, or one with more."""
    if kind == SMALL:
        return 2 if rule.degree == 1 else 1
    return max((nodes - 1) // rule.degree, 1)


def started(system: System, start: dict[str, Any]) -> State:
    """The first state of a lone rotation."""
    values = system.layout.representation.from_quaternion(np.array([start["p"]], dtype=float))
    return initial_state(system, values, np.array([start["p_t"]], dtype=float))


def from_model(model: Model, rule: Rule, form: str, initial: dict[Any, Any]) -> Prepared:
    """System and first state of a model."""
    system = discretize(model, rule, rotation=form)
    values, velocity, _ = initial_values(model, system, initial)
    return system, initial_state(system, values, velocity)


def refined(rod: Any, degree: int) -> Any:
    """What ``bend`` and ``in_flight`` ask of a rod, with the inner nodes of elements of a higher degree."""
    nodes = chain_nodes(np.asarray(rod.nodes), degree)
    return SimpleNamespace(nodes=nodes, positions=rod.positions, rotation=rod.rotation, elements=len(nodes) - 1)


@functools.cache
def exact_top(rule: Rule) -> np.ndarray:
    """By an explicit Runge-Kutta method of order 8 on Euler's equations, to 4e-12."""
    inertia, weight, center = TOP["inertia"], TOP["weight"], TOP["center"]

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        p, w = y[:4], y[4:]
        torque = np.cross(center, quaternion.inverse_rotate(p, np.array([0.0, 0.0, -weight])))
        return np.concatenate([quaternion.tangent(p, w), np.linalg.solve(inertia, torque - np.cross(w, inertia @ w))])

    start = np.concatenate([TOP_START["p"], TOP_START["p_t"]])
    p = solve_ivp(rate, (0.0, 0.5), start, method="DOP853", rtol=1e-13, atol=1e-13).y[:4, -1]
    return quaternion.to_matrix(p).ravel()


@functools.cache
def exact_body(rule: Rule) -> np.ndarray:
    """Jacobi's elliptic functions, to 1e-12."""
    _, seen, first = jacobi(INERTIA, SPIN, 10.0)
    return quaternion.to_matrix(product(quaternion.conjugate(first), seen, first)).ravel()


def by_order_ten(prepare: Callable[..., Prepared], span: float, steps: int) -> Callable[[Rule], np.ndarray]:
    """Reference with the same terms in space and five Gauss points in time: what is left is the error in time."""

    def exact(rule: Rule) -> np.ndarray:
        system, start = prepare(Rule("reference", time=gauss(5), strain=rule.strain, order=10))
        return place(system, cy.integrate(system, start, span, span / steps, save_every=span).state)

    return exact


PROBLEMS = (
    Problem(
        name="heavy top",
        on_interval=False,
        prepare=prepare_top,
        exact=exact_top,
        span=0.5,
        steps={2: (1000, 2000, 4000, 8000), 4: (100, 200, 400, 800), 6: (50, 100, 200, 400), 8: (40, 56, 80, 112)},
        step={2: 2e-4, 4: 2e-3, 6: 5e-3, 8: 5e-3},
        maps=lambda run: np.column_stack([run.angular_momentum.values[:, 2], run.frames.momenta[:, 0, 1]]),
        momenta="about the vertical and about its own axis",
    ),
    Problem(
        name="free asymmetric body",
        on_interval=False,
        prepare=prepare_body,
        exact=exact_body,
        span=10.0,
        steps={2: (100, 200, 400, 800), 4: (20, 40, 80, 160), 6: (12, 24, 48, 96), 8: (11, 16, 23, 32)},
        step={2: 0.05, 4: 0.2, 6: 0.5, 8: 0.5},
        maps=lambda run: run.angular_momentum.values,
        momenta="angular, all three",
    ),
    Problem(
        name="rod in free flight",
        on_interval=True,
        prepare=prepare_flight,
        exact=by_order_ten(prepare_flight, 0.1, 300),
        span=0.1,
        steps={
            2: (3200, 6400, 12800, 25600),
            4: (400, 800, 1600, 3200),
            6: (120, 180, 270, 405),
            8: (95, 134, 190, 269),
        },
        step={2: 5e-5, 4: 2.5e-4, 6: 5e-4, 8: 1e-3},
        maps=lambda run: np.hstack([run.linear_momentum.values, run.angular_momentum.values]),
        momenta="linear and angular, all six",
    ),
    Problem(
        name="rubber pendulum",
        on_interval=True,
        prepare=prepare_pendulum,
        exact=by_order_ten(prepare_pendulum, 0.02, 500),
        span=0.02,
        steps={
            2: (6400, 12800, 25600, 51200),
            4: (800, 1600, 3200, 6400),
            6: (200, 300, 450, 675),
            8: (150, 212, 300, 424),
        },
        step={2: 5e-5, 4: 1e-4, 6: 1e-4, 8: 1e-4},
        maps=lambda run: run.angular_momentum.values[:, 2:],
        momenta="angular about the vertical",
    ),
)
