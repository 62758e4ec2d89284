"""Nanoseconds per node and step of the rule ``nodal`` against C written by hand for this one rod, in turn.

The C file is not part of this repository: give it with ``--limit PATH`` or in $CAYLEY_LIMIT. It takes two Newton
iterations whatever comes; cayley tests convergence. Both time their loop alone. The C starts its leapfrog with a whole
kick where cayley takes half of one; cayley is given that momentum, so that the tips must agree in all six digits that
the C prints.
"""

import argparse
import functools
import math
import os
import re
import shutil
import statistics
import subprocess
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from harness import ROOT, distance, paired, skip, spread, write

import cayley as cy
from cayley.lie import quaternion

ELEMENTS = (11, 20, 100, 1000, 100_000)
WORK = 30_000_000
"""Node-steps in one timed run, if that makes no fewer steps than FEWEST and no more than MOST."""
FEWEST, MOST = 1000, 1_000_000
FLAGS = ("-O3", "-march=native", "-ffast-math", "-mprefer-vector-width=512")
SPEED, SHEAR_LIMIT = 70.7, 1.3e-4
"""Axial wave speed [m/s] and step limit from shear [s] in the step rule of the C file."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run of either program.

    Args:
        ns: wall time of the loop per node and step [ns].
        tip: position of the free end after the last step [m].
    """

    ns: float
    tip: tuple[float, ...]


def wanted(elements: int) -> float:
    """Largest allowed ratio to the C [-]."""
    return 1.6 if elements >= 100 else 2.0


def step(elements: int) -> float:
    """Time step of the C file for a mesh [s]."""
    return 1e-4 if elements <= 20 else 0.3 * min(2.0 / elements / SPEED, SHEAR_LIMIT)


def steps(elements: int) -> int:
    """Steps of a timed run."""
    return max(FEWEST, min(MOST, math.ceil(WORK / (elements + 1))))


def build(source: Path, folder: Path) -> Path:
    """Compile the C file into a folder and return the program."""
    program = folder / "rod"
    subprocess.run(["gcc", *FLAGS, str(source), "-o", str(program), "-lm"], check=True)
    return program


def by_hand(program: Path, elements: int) -> Run:
    """Run the C program."""
    told = subprocess.run(
        [program, str(elements), str(steps(elements))], capture_output=True, text=True, check=True
    ).stdout
    found = re.search(r"([\d.]+) ns/node-step.*tip (\S+) (\S+) (\S+)", told)
    if not found:
        raise RuntimeError(f"{program} printed {told!r}; wanted '... ns/node-step ... tip X Y Z'")
    ns, *tip = map(float, found.groups())
    return Run(ns, tuple(tip))


@dataclass(frozen=True, slots=True)
class Problem:
    """The rod of the C file.

    Args:
        rod: hanging, of the paper's material and section.
        model: the rod with node 0 held, under gravity.
        start: initial fields: positions tilted by 1 %, rotations not.
    """

    rod: cy.Rod
    model: cy.Model
    start: dict[str, np.ndarray]

    def run(self, dt: float, count: int) -> cy.Trajectory:
        """Take a number of steps of the rule ``nodal`` and save the last."""
        run = cy.simulate(
            self.model,
            t_end=count * dt,
            dt=dt,
            rule=cy.rules.nodal,
            save_every=count * dt,
            initial={self.rod: self.start},
            allow_unstable=self.rod.elements > 1000,  # it is stable; finding the limit would take longer than the run
        )
        if run.steps != count:
            raise RuntimeError(f"{run.steps} steps instead of {count} at {self.rod.elements} elements")
        return run


def problem(elements: int) -> Problem:
    """The rod of the C file at rest."""
    rubber = cy.Material(density=1000.0, youngs_modulus=5e6, poisson_ratio=0.35)
    section = cy.Section.rectangle(0.01, 0.01, rubber, shear_correction=1.0)
    rod = cy.Rod(section, length=2.0, direction=(0, 0, -1), normal=(1, 0, 0), elements=elements)
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
    s = np.linspace(0.0, 2.0, elements + 1)
    return Problem(rod, model, {"position": np.stack([0.01 * s, 0.0 * s, -s], axis=1)})


@functools.cache
def kicked(elements: int) -> Problem:
    """The same with the momentum of half a kick, which is what one step from rest gives."""
    rest, dt = problem(elements), step(elements)
    run = rest.run(dt, 1)[rest.rod]
    position, rotation = run.position.values, run.rotation.values
    velocity = (position[1] - position[0]) / dt
    spin = 2.0 / dt * quaternion.imaginary(quaternion.relative(rotation[0], rotation[1]))
    return replace(rest, start=rest.start | {"velocity": velocity, "angular_velocity": spin})


def ours(elements: int) -> Run:
    """Run the same rod in cayley."""
    given, count = kicked(elements), steps(elements)
    run = given.run(step(elements), count)
    tip = run[given.rod].position.isel(time=-1, node=-1).values
    return Run(1e9 * run.wall_time / count / (elements + 1), tuple(tip.tolist()))


def compare(program: Path, elements: int, repeats: int) -> dict[str, Any]:
    """Time both programs in turn at one number of elements."""
    mine, hand = ours(elements), by_hand(program, elements)
    pairs = paired(lambda: ours(elements).ns, lambda: by_hand(program, elements).ns, repeats)
    ratio, gap = spread(pairs.ratios), distance(mine.tip, hand.tip)
    medians = [statistics.median(times) for times in (pairs.first, pairs.second)]
    print(
        f"{elements:6d} elements: cayley {medians[0]:.1f} ns, C {medians[1]:.1f} ns,"
        f" ratio {ratio['median']:.2f} ({ratio['min']:.2f} to {ratio['max']:.2f}), wanted {wanted(elements):g};"
        f" tips after {steps(elements) * step(elements):.3g} s differ by {gap:.1e} m"
    )
    return {
        "elements": elements,
        "nodes": elements + 1,
        "dt_s": step(elements),
        "steps": steps(elements),
        "cayley_ns_per_node_step": spread(pairs.first),
        "c_ns_per_node_step": spread(pairs.second),
        "ratio": ratio,
        "ratio_wanted": wanted(elements),
        "tip_m": mine.tip,
        "tip_difference_m": gap,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    default = Path(os.environ.get("CAYLEY_LIMIT", ROOT.parent / "shared" / "limit" / "rod.c"))
    parser.add_argument("--limit", type=Path, default=default, help="the C file")
    parser.add_argument("--elements", type=int, nargs="+", default=ELEMENTS)
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    if shutil.which("gcc") is None:
        skip("no gcc to build the C program with")
    if not given.limit.is_file():
        skip(f"no file {given.limit}; give the C file with --limit PATH or in $CAYLEY_LIMIT")
    with tempfile.TemporaryDirectory() as folder:
        program = build(given.limit, Path(folder))
        rows = [compare(program, elements, given.repeats) for elements in given.elements]
    told = subprocess.run(["gcc", "-dumpfullversion"], capture_output=True, text=True, check=True).stdout.strip()
    figures = {
        "problem": "hanging rubber rod of 2 m, 0.01 x 0.01 m, E 5e6 Pa, nu 0.35, 1000 kg/m3, pinned, let go 1 % off",
        "rule": "nodal",
        "compiler": f"gcc {told} {' '.join(FLAGS)}",
        "rows": rows,
    }
    write("limit", figures, to=given.out)


if __name__ == "__main__":
    main()
