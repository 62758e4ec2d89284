"""Microseconds per element and Newton iteration of the rule ``midpoint``, from 20 to 100 000 elements.

One iteration assembles residual and tangent of every element, factors the matrix along the chain and
moves the nodes. The time of the whole loop is divided by the iterations taken, so that it holds all other work too:
first guess, loads, and the one more assembly at the end of a step, which gives the new momenta.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from harness import spread, write

import cayley as cy
from cayley.steppers import implicit_run
from cayley.steppers.outcome import Outcome
from cayley.steppers.problem import field_table
from cayley.system.discretize import discretize, initial_values
from cayley.system.legendre import initial_state
from cayley.system.system import State, System

ELEMENTS = (20, 200, 2000, 100_000)
STEP = 2.5e-3
"""Time step [s], 100 times the explicit one."""
WORK = 200_000
"""Element-steps in one timed run, if that makes no fewer steps than FEWEST and no more than MOST."""
FEWEST, MOST = 8, 400
AIM, LIMIT = 0.6, 1.0
"""What one element and iteration should and may cost [µs]."""


@dataclass(frozen=True, slots=True)
class Problem:
    """The rubber pendulum, ready to be stepped.

    Args:
        system: compiled and discretized.
        state: horizontal, at rest.
    """

    system: System
    state: State


@dataclass(frozen=True, slots=True)
class Run:
    """One timed run.

    Args:
        wall_time: of the loop [s].
        iterations: Newton iterations of all steps.
        most: largest number of iterations in a step.
        tip: position of the free end at the end [m].
    """

    wall_time: float
    iterations: int
    most: int
    tip: tuple[float, ...]


def problem(elements: int, dt: float) -> Problem:
    """The rubber pendulum of ``pyelastica.py`` under the rule ``midpoint``."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(5e-3, rubber, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
    system = discretize(model, cy.rules.midpoint)
    values, velocity, _ = initial_values(model, system, {})
    return Problem(system, initial_state(system, values, velocity).at_step(dt))


def steps(elements: int) -> int:
    """Steps of a timed run."""
    return max(FEWEST, min(MOST, WORK // elements))


def run(given: Problem, count: int) -> Run:
    """Take a number of steps."""
    system, state = given.system, given.state
    plan = implicit_run.make_plan(system)
    frames = np.empty((1, system.size, system.layout.rows + system.layout.dofs))
    began = time.perf_counter()
    call = implicit_run.advance(plan, state, count, frames)
    outcome, reached, counts = call.outcome, call.reached, call.counts
    wall_time = time.perf_counter() - began
    if outcome is not Outcome.FINISHED or reached != 1:
        raise RuntimeError(f"{count} steps at {system.size - 1} elements ended as {outcome} at step {counts[2]}")
    field = next(row for row in field_table(system) if not row[0])  # the position
    tip = frames[0, -1, field[1] : field[1] + 3]
    return Run(wall_time, int(counts[0]), int(counts[1]), tuple(tip.tolist()))


def measure(elements: int, repeats: int, dt: float) -> dict[str, Any]:
    """Time one number of elements; the error is the tip's difference to a run with half the step."""
    given, count = problem(elements, dt), steps(elements)
    once = run(given, count)
    halved = run(Problem(given.system, given.state.at_step(0.5 * dt)), 2 * count)
    runs = [run(given, count) for _ in range(repeats)]
    cost = spread([1e6 * each.wall_time / each.iterations / elements for each in runs])
    error = max(abs(a - b) for a, b in zip(once.tip, halved.tip, strict=True))
    print(
        f"{elements:6d} elements: {cost['median']:.2f} us per element and iteration"
        f" ({cost['min']:.2f} to {cost['max']:.2f}), aim {AIM:g}, at most {LIMIT:g};"
        f" {once.iterations / count:.2f} iterations a step; half the step moves the tip by {error:.1e} m"
    )
    return {
        "elements": elements,
        "dt_s": dt,
        "steps": count,
        "iterations": once.iterations,
        "iterations_per_step": once.iterations / count,
        "most_iterations": once.most,
        "us_per_element_iteration": cost,
        "us_per_element_assembly": cost["median"] * once.iterations / (once.iterations + count),
        "loop_s": spread([each.wall_time for each in runs]),
        "tip_m": once.tip,
        "tip_change_at_half_step_m": error,
    }


def growth(rows: Sequence[dict[str, Any]]) -> float | None:
    """Cost per element at the most elements over that at the fewest [-]; 1 is linear growth."""
    if len(rows) < 2:
        return None
    few, many = (
        chosen(rows, key=lambda row: row["elements"])["us_per_element_iteration"]["median"] for chosen in (min, max)
    )
    return float(many / few)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, nargs="+", default=ELEMENTS)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--dt", type=float, default=STEP, help="time step [s]")
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    rows = [measure(elements, given.repeats, given.dt) for elements in given.elements]
    figures = {
        "problem": "rubber pendulum: length 1 m, radius 5 mm, E 5e6 Pa, nu 0.5, 1100 kg/m3, pinned, let go horizontal",
        "rule": "midpoint",
        "us_aim": AIM,
        "us_limit": LIMIT,
        "growth_of_cost_per_element": growth(rows),
        "rows": rows,
    }
    write("implicit_cost", figures, to=given.out)


if __name__ == "__main__":
    main()
