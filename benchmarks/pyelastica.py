"""The rubber pendulum against PyElastica: same rod, same elements, same step, loop time alone, both errors beside.

The step is the largest of ``STEPS`` with which both programs run through: both are explicit. PyElastica runs in an
environment of its own (``benchmarks/.venv-peers``, made here at first use), driven line by line so that the two
programs take turns.
"""

import argparse
from pathlib import Path
from typing import Any

from harness import HERE, distance, paired, spread, write
from peer import FAILED, Peer, Run, environment, peer, versions

import cayley as cy

ELEMENTS = (20, 40, 80, 160)
STEPS = (1.25e-4, 1e-4, 8e-5, 6.25e-5, 5e-5, 4e-5, 2.5e-5, 1e-5)
"""Candidates for the time step [s], all of which divide 1 s."""
WANTED = {20: 25.0, 160: 10.0}
"""Least number of times cayley must be faster, by number of elements."""
EXACT = (-0.94009, 0.0, -0.09910)
"""Tip at 1 s [m]: limit of the rule ``verlet`` for fine meshes."""
STABLE = 0.03
"""Tip error [m] above which a run counts as blown up; the coarsest mesh has 0.013."""
VENV = HERE / ".venv-peers"


def peer_python() -> Path:
    """Interpreter that has PyElastica: $PYELASTICA_PYTHON, or that of an environment made here at first use."""
    wanted = ["-r", str(HERE / "peers" / "requirements.txt")]
    return environment("PYELASTICA_PYTHON", VENV, wanted, what="PyElastica")


def ours(elements: int, dt: float, rule: Any = None) -> Run:
    """The same pendulum in cayley, rule ``verlet`` if none is given."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(5e-3, rubber, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
    try:
        run = cy.simulate(model, t_end=1.0, dt=dt, rule=rule or cy.rules.verlet, save_every=1.0)
    except (ValueError, cy.SimulationError):  # the step is over our limit
        return FAILED
    tip = run[rod].position.isel(time=-1, node=-1).values
    return Run(run.steps, run.dt, run.wall_time, tuple(tip.tolist()))


def theirs(elastica: Peer, elements: int, dt: float) -> Run:
    """The pendulum in PyElastica."""
    return elastica.run(elements=elements, dt=dt, t_end=1.0)


def common_step(elastica: Peer, elements: int) -> float:
    """Largest candidate step with which both programs run through [s]."""
    for dt in STEPS:
        if max(run.error(EXACT) for run in (ours(elements, dt), theirs(elastica, elements, dt))) < STABLE:
            return dt
    raise RuntimeError(f"no step of {STEPS} is stable for both programs at {elements} elements")


def compare(elastica: Peer, elements: int, repeats: int) -> dict[str, Any]:
    """Time both programs in turn at one number of elements."""
    dt = common_step(elastica, elements)
    mine, other = ours(elements, dt), theirs(elastica, elements, dt)
    if mine.steps != other.steps:
        raise RuntimeError(f"{mine.steps} steps against {other.steps}: the programs do not do the same")
    pairs = paired(lambda: theirs(elastica, elements, dt).wall_time, lambda: ours(elements, dt).wall_time, repeats)
    ratio = spread(pairs.ratios)
    wanted = WANTED.get(elements)
    print(
        f"{elements:4d} elements, dt {mine.dt:.3g} s: {ratio['median']:.1f} times faster"
        f" ({ratio['min']:.1f} to {ratio['max']:.1f}){f', wanted {wanted:g}' if wanted else ''};"
        f" tip error cayley {mine.error(EXACT):.1e}, PyElastica {other.error(EXACT):.1e} m"
    )
    return {
        "elements": elements,
        "dt_s": mine.dt,
        "steps": mine.steps,
        "times_faster": ratio,
        "times_faster_wanted": wanted,
        "cayley": _describe(mine, pairs.second),
        "pyelastica": _describe(other, pairs.first),
    }


def _describe(run: Run, times: tuple[float, ...]) -> dict[str, Any]:
    microseconds = spread([1e6 * t / run.steps for t in times])
    return {"loop_s": spread(times), "us_per_step": microseconds, "tip_m": run.tip, "tip_error_m": run.error(EXACT)}


def _add_own_errors(rows: list[dict[str, Any]]) -> None:
    """Add each program's distance to its own limit, extrapolated at second order from its two finest meshes.

    Both are second order in space, but they model stretch differently: PyElastica's section thins with it.
    """
    if len(rows) < 2 or rows[-1]["elements"] != 2 * rows[-2]["elements"]:
        return
    for program in ("cayley", "pyelastica"):
        coarse, fine = (row[program]["tip_m"] for row in rows[-2:])
        limit = [b + (b - a) / 3.0 for a, b in zip(coarse, fine, strict=True)]
        for row in rows:
            row[program]["tip_error_to_own_limit_m"] = distance(row[program]["tip_m"], limit)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, nargs="+", default=ELEMENTS)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    python = peer_python()
    with peer(python, "pyelastica_pendulum.py") as elastica:
        rows = [compare(elastica, elements, given.repeats) for elements in given.elements]
    _add_own_errors(rows)
    figures = {
        "problem": "rubber pendulum: length 1 m, radius 5 mm, E 5e6 Pa, nu 0.5, 1100 kg/m3, pinned, let go horizontal",
        "rule": "`verlet` against PyElastica's position Verlet, no damping",
        "tip_exact_m": EXACT,
        "peer": versions(python, "pyelastica", "numba", "numpy"),
        "rows": rows,
    }
    write("pyelastica", figures, to=given.out)


if __name__ == "__main__":
    main()
