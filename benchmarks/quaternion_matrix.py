"""Rotations as unit quaternions against rotations as matrices: the same density, rule and step, in turn.

The paper found quaternions about a fifth cheaper. Measured here: the paper's beam with its torque (a Python function,
whose sampling costs both forms the same), the same beam let go 1 % off, and that in 1000 elements. Beside the times
stand the difference of the two results and the error both make because of the step, estimated by halving it.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from harness import distance, paired, spread, write
from limit import problem

import cayley as cy

FORMS = ("quaternion", "matrix")


@dataclass(frozen=True, slots=True)
class Case:
    """A run of the paper's beam.

    Args:
        name: what is run.
        elements: number of elements.
        dt: time step [s].
        t_end: end of the run [s].
    """

    name: str
    elements: int
    dt: float
    t_end: float


TORQUE, RELEASED = "paper's torque", "let go 1 % off"
CASES = (Case(TORQUE, 11, 1e-4, 10.0), Case(RELEASED, 11, 1e-4, 40.0), Case(RELEASED, 1000, 8e-6, 0.2))


@dataclass(frozen=True, slots=True)
class Run:
    """One run.

    Args:
        ns: wall time of the loop per node and step [ns].
        steps: number of steps.
        tip: position of the free end at the end [m].
    """

    ns: float
    steps: int
    tip: tuple[float, ...]


def torque(t: float) -> np.ndarray:
    """Body-fixed torque of the paper's scenario at time t [s], [N m]."""
    return 1.5 * np.sin(np.pi * t / 2) * np.array([np.cos(np.pi * t / 4), np.sin(np.pi * t / 4), 0.0])


def run(case: Case, form: str, part: float = 1.0) -> Run:
    """Run a case with one form of rotations and a part of its step."""
    given = problem(case.elements)
    model, start = given.model, {given.rod: given.start}
    if case.name == TORQUE:
        turned = cy.loads.moment(given.rod.start, torque, frame="body", until=2.0)
        model, start = model.replace(loads=(*model.loads, turned)), {}
    found = cy.simulate(
        model,
        t_end=case.t_end,
        dt=part * case.dt,
        rule=cy.rules.nodal,
        save_every=case.t_end / 2,
        rotation=form,
        initial=start,
    )
    tip = found[given.rod].position.isel(time=-1, node=-1).values
    return Run(1e9 * found.wall_time / found.steps / (case.elements + 1), found.steps, tuple(tip.tolist()))


def own_error(case: Case, form: str, tip: Sequence[float]) -> float:
    """Error of the tip that comes from the step, 4/3 of the change when the step is halved [m]."""
    return 4.0 / 3.0 * distance(tip, run(case, form, 0.5).tip)


def compare(case: Case, repeats: int) -> dict[str, Any]:
    """Time both forms in turn."""
    tips = {form: run(case, form).tip for form in FORMS}
    steps = run(case, FORMS[0]).steps
    errors = {form: own_error(case, form, tips[form]) for form in FORMS}
    pairs = paired(lambda: run(case, "quaternion").ns, lambda: run(case, "matrix").ns, repeats)
    ratio, gap = spread(pairs.ratios), distance(tips["quaternion"], tips["matrix"])
    print(
        f"{case.name}, {case.elements} elements: quaternions {spread(pairs.first)['median']:.1f} ns,"
        f" matrices {spread(pairs.second)['median']:.1f} ns, ratio {ratio['median']:.3f}"
        f" ({ratio['min']:.3f} to {ratio['max']:.3f}); tips differ by {gap:.1e} m,"
        f" errors from the step {errors['quaternion']:.1e} and {errors['matrix']:.1e} m"
    )
    described = {
        form: {"ns_per_node_step": spread(times), "tip_m": tips[form], "tip_error_from_step_m": errors[form]}
        for form, times in zip(FORMS, (pairs.first, pairs.second), strict=True)
    }
    return {
        "name": case.name,
        "elements": case.elements,
        "nodes": case.elements + 1,
        "dt_s": case.t_end / steps,
        "steps": steps,
        "t_end_s": case.t_end,
        "quaternion_over_matrix": ratio,
        "tip_difference_m": gap,
        **described,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--shorten", type=float, default=1.0, help="run only this part of each case, for a trial")
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    cases = [replace(case, t_end=given.shorten * case.t_end) for case in CASES]
    rows = [compare(case, given.repeats) for case in cases]
    figures = {
        "problem": "the paper's beam (Table 1, pinned, gravity, body-fixed torque at node 0 until 2 s)",
        "rule": "nodal",
        "rows": rows,
    }
    write("quaternion_matrix", figures, to=given.out)


if __name__ == "__main__":
    main()
