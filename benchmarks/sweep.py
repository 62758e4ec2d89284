"""Rods of all kinds, each run with ``accuracy=1e-2`` and nothing else: how many finish, and how exact they are.

Modulus, radius and length are drawn log-uniformly over many powers of ten, with supports, gravity and smooth loads by
chance. A rod counts as finished if its run reaches the end; it counts as exact if its positions agree with those of a
run at a quarter of the step within the accuracy. What stops must say why.
"""

import argparse
import math
import statistics
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from harness import write

import cayley as cy

ACCURACY = 1e-2
KINDS = ("plain", "chains", "follower")
SLENDERNESS = (20.0, 5000.0)
"""Length over radius: below it is no rod, above a thread whose bending does not matter."""
GRAVITY = 9.81
HEAVIEST = 100.0
"""Largest weight, over EI/L², with which a rod is given gravity: beyond it is a chain, whose swinging is chaotic."""


@dataclass(frozen=True, slots=True)
class Problem:
    """A rod drawn by chance.

    Args:
        seed: what it was drawn with.
        told: its figures in words.
        rod: the rod.
        model: with supports and loads.
        t_end: length of the run [s].
    """

    seed: int
    told: str
    rod: cy.Rod
    model: cy.Model
    t_end: float


def drawn(seed: int, kind: str = "plain") -> Problem:
    """A rod, its supports and loads; t_end is about one to three of its slowest periods.

    Args:
        seed: of the random numbers.
        kind: "plain"; "chains" gives gravity to rods that hang like chains, too; "follower" adds a moment that turns
            with the end of the rod: it is not conservative, so without damping it makes high frequencies flutter.
    """
    random = np.random.default_rng(seed)
    modulus = _log(random, 1e4, 2e11)
    radius = _log(random, 1e-4, 1e-1)
    slenderness = _log(random, max(SLENDERNESS[0], 0.1 / radius), min(SLENDERNESS[1], 100.0 / radius))
    length, density = slenderness * radius, random.uniform(900.0, 8000.0)
    material = cy.Material(density=density, youngs_modulus=modulus, poisson_ratio=random.uniform(0.0, 0.49))
    rod = cy.Rod(
        cy.Section.circle(radius, material),
        length=length,
        elements=int(random.integers(8, 41)),
        direction=_unit(random),
    )
    bending = modulus * math.pi * radius**4 / 4.0
    mass = density * math.pi * radius**2
    period = 2.0 * math.pi / 3.516 * length**2 * math.sqrt(mass / bending)
    heavy = random.random() < 0.5 and (kind == "chains" or mass * GRAVITY * length**3 / bending < HEAVIEST)
    if heavy:
        period = min(period, 2.0 * math.pi * math.sqrt(length / GRAVITY))
    t_end = period * random.uniform(0.5, 2.0)
    support = str(random.choice(["clamp", "pin", "free"], p=[0.5, 0.3, 0.2]))
    held = {"clamp": [cy.supports.clamp(rod.start)], "pin": [cy.supports.pin(rod.start)], "free": []}[support]
    push = _log(random, 0.1, 5.0) * bending / length**2
    loads: list[Any] = [
        cy.loads.force(rod.end, _smooth(random, push, t_end)),
        cy.loads.force(rod.node(rod.elements // 2), _smooth(random, push, t_end)),
        cy.loads.line_force(rod, _smooth(random, push / length, t_end)),
    ]
    loads = [load for load in loads if random.random() < 0.6] or loads[:1]
    if kind == "follower":
        moment = _smooth(random, push * length, t_end, twist=support == "clamp")
        loads.append(cy.loads.moment(rod.end, moment, frame="body"))
    if heavy:
        loads.append(cy.loads.gravity((0.0, 0.0, -GRAVITY)))
    told = (
        f"E {modulus:.2g} Pa, radius {radius:.2g} m, length {length:.3g} m, {rod.elements} elements, {support}, "
        f"{'gravity, ' if heavy else ''}push {push * length**2 / bending:.2g} EI/L2, t_end {t_end:.3g} s"
    )
    return Problem(seed, told, rod, cy.Model(rod, supports=held, loads=loads), t_end)


def _log(random: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(random.uniform(math.log(low), math.log(high))))


def _unit(random: np.random.Generator) -> tuple[float, ...]:
    vector = random.normal(size=3)
    return tuple((vector / np.linalg.norm(vector)).tolist())


def _smooth(random: np.random.Generator, size: float, t_end: float, *, twist: bool = True) -> Any:
    """A sum of three slow sines in every direction, from zero.

    Without twist there is none about the axis: a rod that is free to spin would reach a million turns a second.
    """
    amplitude = size * random.normal(size=(3, 3)) / 3.0
    amplitude[2] *= twist
    rate = 2.0 * np.pi * np.array([0.5, 1.0, 2.0]) / t_end

    def value(t: Any) -> Any:
        return [sum(a * np.sin(w * t) for a, w in zip(row, rate, strict=True)) for row in amplitude.tolist()]

    return value


def ran(problem: Problem, *, check: bool) -> dict[str, Any]:
    """Run one rod."""
    row: dict[str, Any] = {"seed": problem.seed, "rod": problem.told}
    began = time.perf_counter()
    try:
        run = cy.simulate(problem.model, t_end=problem.t_end, accuracy=ACCURACY)
    except (cy.SimulationError, ValueError) as error:
        return row | {"outcome": "stopped", "reason": str(error), "seconds": time.perf_counter() - began}
    except Exception as error:  # what should never happen is what is looked for
        return row | {"outcome": "failed", "reason": repr(error), "seconds": time.perf_counter() - began}
    row |= {"outcome": "finished", "seconds": time.perf_counter() - began, "integration_s": run.wall_time}
    row |= {"rule": run.rule, "dt_s": run.dt, "steps": run.steps, "estimate": run.error_estimate, "why": run.why}
    return row | ({"error": error_of(problem, run)} if check else {})


def error_of(problem: Problem, run: cy.Trajectory) -> float | None:
    """Largest distance to a run at a quarter of the step, over the length; none if that one stops."""
    rule = run.system.equations.rule
    try:
        finer = cy.simulate(problem.model, t_end=problem.t_end, rule=rule, dt=0.25 * run.dt)
    except cy.SimulationError:
        return None
    apart = run[problem.rod].position.values - finer[problem.rod].position.values
    return float(np.linalg.norm(apart, axis=2).max() / problem.rod.length)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rods", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="seed of the first rod")
    parser.add_argument("--kind", choices=KINDS, default="plain", help="loads; the others make motions chaotic")
    parser.add_argument("--check", action=argparse.BooleanOptionalAction, default=True, help="measure the error")
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    rows = []
    for seed in range(given.first, given.first + given.rods):
        row = ran(drawn(seed, given.kind), check=given.check)
        rows.append(row)
        told = row.get("reason") or f"{row['rule']}, {row['steps']} steps, error {row.get('error')}"
        print(f"{seed:4d} {row['outcome']} in {row['seconds']:.2f} s: {row['rod']}; {told}", flush=True)
    figures = {"kind": given.kind, **summary(rows)}
    print({name: value for name, value in figures.items() if name != "rows"})
    write("sweep" if given.kind == "plain" else f"sweep_{given.kind}", figures, to=given.out)


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Counts of outcomes and rules, times and errors."""
    finished = [row for row in rows if row["outcome"] == "finished"]
    errors = [row["error"] for row in finished if row.get("error") is not None]
    times = sorted(row["seconds"] for row in rows)
    names = sorted({row["rule"] for row in finished})
    return {
        "accuracy": ACCURACY,
        "rods": len(rows),
        "outcomes": {name: sum(r["outcome"] == name for r in rows) for name in ("finished", "stopped", "failed")},
        "rules": {name: sum(r["rule"] == name for r in finished) for name in names},
        "seconds": {"median": statistics.median(times), "max": times[-1], "sum": sum(times)},
        "checked": len(errors),
        "within_accuracy": sum(error <= ACCURACY for error in errors),
        "largest_error": max(errors, default=None),
        "median_error": statistics.median(errors) if errors else None,
        "rows": rows,
    }


if __name__ == "__main__":
    main()
