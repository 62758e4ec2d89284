"""The measures: order, momentum maps, energy, symplecticity and reversal of one rule in one form on one problem."""

import time
from dataclasses import dataclass, field

import numpy as np

import cayley as cy
from audit.problems import CALM, SMALL, Problem, place
from cayley.discrete.rules import Rule
from cayley.system.system import State, System
from verify.problems import slopes, turned_around
from verify.test_structure import local, shifted, two_form

WITHIN = 0.2
"""Largest distance of each observed order from the theoretical one."""
MOMENTUM = 1e-10
"""Largest change of a momentum map over the long run, relative to the largest momentum."""
DRIFT = 0.05
"""Largest rise of a straight line through the energy of the long run, relative to the ripple ..."""
ROUNDING = 1e-11
"""... or else relative to the largest kinetic energy."""
SYMPLECTIC = 1e-9
"""Largest entry of JᵀΩ(z⁺)J − Ω(z), in units in which Ω of each pair (q, μ) is 1."""
REVERSAL = 1e-9
"""Largest distance from the start after steps forward and back, relative to the size of what moves."""
STEPS = 100_000
"""Steps of the long run; for rods under implicit rules divided by (stages × degree in space)², as their cost grows."""
BACK = 500
"""Steps forward and back."""
FLOW = 5
"""Steps whose Jacobian is taken."""
STENCIL = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Central differences of order 8."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What was measured of one rule in one form on one problem.

    Args:
        problem: name of the problem.
        rule: name of the rule.
        form: "quaternion" or "matrix".
        expected: order the theory gives.
        steps: sizes of the four steps [s].
        errors: errors at the end, positions [m] and entries of rotation matrices.
        momentum: change of the momentum maps over the long run, relative.
        ripple: spread of the energy over the long run, relative to the largest kinetic energy.
        rise: rise of the straight line through it, relative likewise.
        run: number of steps of the long run.
        times: times of the long run [s], thinned out.
        energies: its energy less that of the start, relative likewise.
        defect: of symplecticity.
        back: distance from the start after reversal, relative.
        seconds: time all this took [s].
        note: why something could not be measured.
    """

    problem: str
    rule: str
    form: str
    expected: int
    steps: np.ndarray = field(default_factory=lambda: np.zeros(0))
    errors: np.ndarray = field(default_factory=lambda: np.zeros(0))
    momentum: float = np.nan
    ripple: float = np.nan
    rise: float = np.nan
    run: int = 0
    times: np.ndarray = field(default_factory=lambda: np.zeros(0))
    energies: np.ndarray = field(default_factory=lambda: np.zeros(0))
    defect: float = np.nan
    back: float = np.nan
    seconds: float = 0.0
    note: str = ""

    @property
    def orders(self) -> np.ndarray:
        """Observed orders between successive points."""
        return slopes(self.errors, self.steps[:-1] / self.steps[1:]) if len(self.errors) else np.full(1, np.nan)

    @property
    def passed(self) -> dict[str, bool]:
        """Which measures are within their bounds."""
        return {
            "order": bool(np.all(np.abs(self.orders - self.expected) < WITHIN)),
            "momentum": self.momentum < MOMENTUM,
            "energy": self.rise < max(DRIFT * self.ripple, ROUNDING),
            "symplectic": self.defect < SYMPLECTIC,
            "reversal": self.back < REVERSAL,
        }


def long_run(problem: Problem, rule: Rule) -> int:
    """Steps of the long run that we can afford."""
    cost = (len(rule.time.at) * rule.degree) ** 2 if problem.on_interval and rule.implicit else 1
    return STEPS // cost // 1000 * 1000


def measure(problem: Problem, rule: Rule, form: str) -> Finding:
    """Measure everything; what fails to run is a note, not an error."""
    started = time.perf_counter()
    finding = {"problem": problem.name, "rule": str(rule), "form": form, "expected": rule.order}
    try:
        system, start = problem.prepare(rule, form)
    except ValueError as refused:
        return Finding(**finding, note=str(refused))
    notes = []
    for part in (_order, _long_run, _flow, _reversal):
        try:
            finding |= part(problem, rule, system, start)
        except cy.SimulationError as stopped:
            notes.append(f"{part.__name__.strip('_').replace('_', ' ')}: {stopped}")
    return Finding(**finding, seconds=time.perf_counter() - started, note="; ".join(notes))


def _order(problem: Problem, rule: Rule, system: System, start: State) -> dict:
    """Errors of four steps against the exact solution, or one of order ten of the same equations in space."""
    exact = problem.exact(rule)
    sizes = problem.span / np.array(problem.steps[rule.order])
    ends = [cy.integrate(system, start, problem.span, h, save_every=problem.span).state for h in sizes]
    return {"steps": sizes, "errors": np.array([np.abs(place(system, end) - exact).max() for end in ends])}


def _long_run(problem: Problem, rule: Rule, system: System, start: State) -> dict:
    """Momentum maps and energy over many steps."""
    h = problem.step[rule.order]
    system, start = problem.prepare(rule, system.layout.representation.name, CALM)
    span = long_run(problem, rule) * h
    run = cy.integrate(system, start, span, h, save_every=span / 1000)
    maps = problem.maps(run)
    total, scale = run.energy.values, run.kinetic_energy.values.max()
    change = (total - total[0]) / scale
    rise = np.polyfit(np.linspace(0.0, 1.0, len(change)), change, 1)[0]
    return {
        "momentum": float(np.abs(maps - maps[0]).max() / np.abs(maps).max()),
        "ripple": float(np.ptp(change)),
        "rise": float(abs(rise)),
        "run": run.steps,
        "times": run.time,
        "energies": change,
    }


def _flow(problem: Problem, rule: Rule, system: System, start: State) -> dict:
    """JᵀΩ(z⁺)J − Ω(z) for the derivative J of some steps from z = (q, μ), by differences of order 8.

    Trivialized from the left, Ω((η₁, ν₁), (η₂, ν₂)) = ν₂·η₁ − ν₁·η₂ + μ·(η₁ × η₂): the last term for rotations alone.
    """
    form = system.layout.representation.name
    system, start = problem.prepare(rule, form, SMALL)
    h = problem.step[rule.order]
    state = cy.integrate(system, start, 5 * h, h, save_every=5 * h).state
    state = State(values=state.values, momenta=state.momenta)
    size = system.size * system.layout.dofs
    largest = np.abs(state.momenta).max(axis=0)
    for name in system.layout.fields:
        largest[system.layout.dofs_of(name)] = largest[system.layout.dofs_of(name)].max()
    scale = np.concatenate([np.ones(size), np.tile(largest, system.size)])
    free = np.flatnonzero(np.tile(system.free.ravel(), 2))

    def flow(z: np.ndarray) -> State:
        there = shifted(system, state, scale * z)
        return cy.integrate(system, there, FLOW * h, h, save_every=FLOW * h, allow_unstable=True).state

    end = flow(np.zeros(2 * size))
    jacobian, width = np.zeros((2 * size, 2 * size)), 2e-3
    for k in free:
        for m, weight in enumerate(STENCIL, start=1):
            ahead, behind = (local(system, end, flow(s * m * width * np.eye(2 * size)[k])) for s in (1, -1))
            jacobian[:, k] += weight * (ahead - behind) / width
    before = scale[:, None] * two_form(system, state) * scale
    found = jacobian.T @ two_form(system, end) @ jacobian
    own, unit = np.ix_(free, free), np.sqrt(np.tile(scale[size:], 2))[free]  # 1 for each pair (q, μ)
    return {"defect": float((np.abs(found - before)[own] / np.outer(unit, unit)).max())}


def _reversal(problem: Problem, rule: Rule, system: System, start: State) -> dict:
    """Forward, momenta reversed, the same number of steps again."""
    h = problem.step[rule.order]
    there = cy.integrate(system, start, BACK * h, h, save_every=BACK * h).state
    back = cy.integrate(system, turned_around(there), BACK * h, h, save_every=BACK * h).state
    momenta = np.abs(back.momenta + start.momenta).max() / np.abs(start.momenta).max()
    return {"back": float(max(np.abs(place(system, back) - place(system, start)).max(), momenta))}
