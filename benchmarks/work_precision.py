"""The rubber pendulum: tip error at 1 s against the time it takes, for six rules, PyElastica and EXUDYN.

One of the rules runs with the residual bending of rods, too.

Every program gets finer meshes with finer steps: explicit ones the largest stable step, implicit ones a step that
shrinks with the element. The time to reach an error is that of the cheapest run from which on all finer ones keep it;
beyond the finest run it is extrapolated by the order of the last two, and marked. A program is measured against the
limit of its own model: PyElastica's section thins with stretch, so that its limit is another (its error to the common
one is in the file too). The programs take turns; loops alone are timed.
"""

import argparse
import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness import ROOT, distance, spread, write
from peer import FAILED, Peer, Run, exudyn_python, peer, versions
from pyelastica import peer_python

import cayley as cy

T_END = 1.0
EXACT = (-0.9400951, 0.0, -0.0991011)
"""Tip at 1 s [m]: galerkin(time=3, space=3) with 40 elements and a step of 2.5e-3 s; with 24 and 4e-3 s 4e-7 m away."""
TARGETS = (1e-2, 1e-3, 1e-4, 1e-5)
WANTED = {1e-2: 30.0, 1e-4: 100.0}
"""Least number of times the best of our rules must be ahead of the best peer, by error."""
ELASTICA = ((12, 1e-4), (24, 1e-4), (48, 1e-4), (96, 8e-5), (192, 5.2e-5), (384, 2.6e-5), (768, 1.3e-5))
"""Meshes and steps of PyElastica [s], near its limit of stability."""
SPECTRAL = {
    3: ((2, 1.26e-4), (3, 1.26e-4), (7, 1.22e-4), (15, 1.11e-4), (31, 8e-5)),
    4: ((2, 1.25e-4), (3, 1.24e-4), (7, 1.16e-4), (15, 9.4e-5), (23, 7e-5)),
}
"""Meshes and steps of the rules spectral [s], by degree: cells that fill vectors, near the limit of stability."""
BENDING = ((15, 5.2e-4), (23, 3.5e-4), (47, 1.98e-4), (95, 1.3e-4), (191, 6.9e-5), (383, 3.4e-5))
"""Meshes and steps of verlet with residual bending [s]: nodes that fill vectors, near the limit of stability."""
BLOWN_UP = 0.5
"""Tip error above which a run counts as failed [m]."""
FARTHEST = 10.0
"""Times are extrapolated to errors at most this many times below that of the finest run."""
QUICK = 1.0
"""Runs that take less than this are repeated [s]."""
DIAGRAM = ROOT / "docs" / "images" / "work_precision.png"


@dataclass(frozen=True, slots=True)
class Series:
    """One program or rule with its runs from coarse to fine.

    Args:
        name: what the table calls it.
        ours: whether it is cayley.
        own_limit: whether errors are to its own limit, extrapolated from its two finest runs.
        cases: (elements, step [s]) from coarse to fine.
        run: makes a run.
    """

    name: str
    ours: bool
    own_limit: bool
    cases: tuple[tuple[int, float], ...]
    run: Callable[[int, float], Run]


def pendulum(rule: cy.rules.Rule, **more: Any) -> Callable[[int, float], Run]:
    """A function that runs the rubber pendulum under a rule; more: of the rod."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(5e-3, rubber, shear_correction=27 / 28)

    def run(elements: int, dt: float) -> Run:
        rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements, **more)
        model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
        try:
            made = cy.simulate(model, t_end=T_END, dt=dt, rule=rule, save_every=T_END)
        except (ValueError, cy.SimulationError):  # over the step limit, or a step not solved
            return FAILED
        tip = made[rod].position.isel(time=-1, node=-1).values
        return Run(made.steps, made.dt, made.wall_time, tuple(tip.tolist()))

    return run


def doubled(first: int, dt: float, times: int, *, longest: float = math.inf) -> tuple[tuple[int, float], ...]:
    """Meshes of twice the elements each time with half the step, which is no longer than ``longest`` [s]."""
    return tuple((first * 2**k, min(longest, dt / 2**k)) for k in range(times))


def our_series() -> tuple[Series, ...]:
    """The six rules."""
    high = {2: doubled(5, 0.02, 4), 3: ((4, 0.025), (5, 0.02), (6, 0.016), (8, 0.0125), (12, 0.008))}
    return (
        Series("verlet", True, False, doubled(12, 1.04e-3, 8, longest=1.25e-4), pendulum(cy.rules.verlet)),
        Series("verlet, residual bending", True, False, BENDING, pendulum(cy.rules.verlet, residual_bending=True)),
        *(
            Series(f"spectral({m})", True, False, cases, pendulum(cy.rules.spectral(space=m)))
            for m, cases in SPECTRAL.items()
        ),
        Series("midpoint", True, False, doubled(12, 1.0 / 60.0, 6), pendulum(cy.rules.midpoint)),
        *(
            Series(f"galerkin({r}, {r})", True, False, cases, pendulum(cy.rules.galerkin(time=r, space=r)))
            for r, cases in high.items()
        ),
    )


@contextmanager
def peer_series(given: argparse.Namespace) -> Iterator[tuple[tuple[Series, ...], dict[str, str]]]:
    """Those of the other programs that are here, and their versions."""
    elastica = peer_python()
    exudyn = exudyn_python(elastica)
    found, known = [], versions(elastica, "pyelastica", "numba", "numpy")
    with ExitStack() as open_:
        program = open_.enter_context(peer(elastica, "pyelastica_pendulum.py"))
        cases = ELASTICA
        found.append(Series("PyElastica", False, True, cases, asked(program)))
        if exudyn is None:
            print("EXUDYN is not here: left out; give an interpreter that has it in $EXUDYN_PYTHON")
        else:
            known |= versions(exudyn, "exudyn")
            program = open_.enter_context(peer(exudyn, "exudyn_pendulum.py"))
            for node in given.exudyn_nodes:
                cases = doubled(10, 0.02, 5)
                found.append(Series(f"EXUDYN, {node}", False, False, cases, asked(program, node=node)))
        yield tuple(found), known


def asked(program: Peer, **more: Any) -> Callable[[int, float], Run]:
    """A function that lets another program run the pendulum."""

    def run(elements: int, dt: float) -> Run:
        made = program.run(elements=elements, dt=dt, t_end=T_END, **more)
        return made if made.error(EXACT) < BLOWN_UP else FAILED

    return run


def measure(all_series: Sequence[Series], repeats: int) -> list[list[list[Run]]]:
    """Runs of every series and case: all once, then the quick ones again in turn.

    Returns: runs[series][case][repeat].
    """
    runs: list[list[list[Run]]] = [[[] for _ in series.cases] for series in all_series]
    for series in all_series:
        series.run(*series.cases[0])  # compiles
    for again in range(repeats):
        for case in range(max(len(series.cases) for series in all_series)):
            for series, done in zip(all_series, runs, strict=True):
                if case < len(done) and (not again or done[case][0].wall_time < QUICK):
                    done[case].append(series.run(*series.cases[case]))
    return runs


def limit(runs: Sequence[Run]) -> tuple[float, ...]:
    """Limit of a second-order series from its two finest runs, whose meshes differ by a factor of two [m]."""
    coarse, fine = (run.tip for run in runs[-2:])
    if coarse is None or fine is None:
        raise RuntimeError("one of the two finest runs failed; its limit cannot be extrapolated")
    return tuple(b + (b - a) / 3.0 for a, b in zip(coarse, fine, strict=True))


def described(series: Series, runs: Sequence[Sequence[Run]]) -> dict[str, Any]:
    """A series with the time and error of each case and the times to the targets."""
    exact = limit([case[0] for case in runs]) if series.own_limit else EXACT
    rows = []
    for (elements, dt), case in zip(series.cases, runs, strict=True):
        first = case[0]
        failed = first.tip is None
        row = {
            "elements": elements,
            "dt_s": dt if failed else first.dt,
            "steps": first.steps,
            "loop_s": None if failed else spread([run.wall_time for run in case]),
            "tip_m": first.tip,
            "tip_error_m": None if failed else first.error(exact),
            "tip_error_to_common_limit_m": None if failed else first.error(EXACT),
        }
        rows.append(row)
        told = "failed" if failed else f"{row['loop_s']['median']:9.4f} s, tip error {row['tip_error_m']:.1e} m"
        print(f"{series.name:28s} {elements:5d} elements, step {row['dt_s']:<9.3g} s: {told}")
    good = [row for row in rows if row["tip_m"]]
    reached = {f"{target:g}": time_to(target, good) for target in TARGETS}
    return {
        "name": series.name,
        "cayley": series.ours,
        "own_limit": series.own_limit,
        "limit_m": exact,
        "limit_from_common_m": distance(exact, EXACT),
        "time_to_error": reached,
        "rows": rows,
    }


def time_to(target: float, rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Time to reach an error: measured where a run and all finer ones keep it, else extrapolated.

    t = t₁ (e₁/target)^q with q = log(t₁/t₀)/log(e₀/e₁) of the two finest runs

    Args:
        target: largest tip error [m].
        rows: from coarse to fine.
    """
    kept = list(itertools.takewhile(lambda row: row["tip_error_m"] <= target, reversed(rows)))
    if kept:
        best = min(kept, key=lambda row: row["loop_s"]["median"])
        return {
            "s": best["loop_s"]["median"],
            "elements": best["elements"],
            "dt_s": best["dt_s"],
            "extrapolated": False,
        }
    (t0, e0), (t1, e1) = ((row["loop_s"]["median"], row["tip_error_m"]) for row in rows[-2:])
    if not e1 < e0 or e1 > FARTHEST * target:
        return {"s": None, "extrapolated": True}
    power = math.log(t1 / t0) / math.log(e0 / e1)
    return {"s": t1 * (e1 / target) ** power, "extrapolated": True}


def ahead(all_series: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Best of our rules against the best peer for each target."""
    rows = []
    for target in TARGETS:
        times = [(each, each["time_to_error"][f"{target:g}"]) for each in all_series]
        best = {}
        for ours in (True, False):
            known = [(told["s"], each["name"], told) for each, told in times if each["cayley"] is ours and told["s"]]
            if known:
                best[ours] = min(known, key=lambda entry: entry[0])
        if len(best) < 2:
            continue
        factor = best[False][0] / best[True][0]
        row = {
            "error_m": target,
            "cayley": best[True][1],
            "peer": best[False][1],
            "times_faster": factor,
            "times_faster_wanted": WANTED.get(target),
            "extrapolated": best[True][2]["extrapolated"] or best[False][2]["extrapolated"],
        }
        rows.append(row)
        print(f"error {target:g} m: {row['cayley']} is {factor:.0f} times faster than {row['peer']}")
    return rows


def draw(all_series: Sequence[dict[str, Any]], path: Path) -> None:
    """The work-precision diagram."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7.5, 5.0), layout="constrained")
    markers = itertools.cycle("osD^vP*X")
    for each in all_series:
        good = [row for row in each["rows"] if row["tip_m"]]
        times = [row["loop_s"]["median"] for row in good]
        style = "-" if each["cayley"] else "--"
        label = each["name"] + (" (to its own limit)" if each["own_limit"] else "")
        axes.loglog(times, [row["tip_error_m"] for row in good], style, marker=next(markers), ms=5, label=label)
    axes.set(xlabel="time of the loop [s]", ylabel="error of the tip at 1 s [m]")
    axes.set_title("Rubber pendulum, mesh and step refined together")
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(frameon=False, fontsize=9)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)
    plt.close(figure)
    print(f"wrote {path}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=3)
    nodes = ("rotation vector", "tait-bryan", "euler parameters")
    parser.add_argument("--exudyn-nodes", nargs="+", default=nodes[:2], choices=nodes, help="rotations in EXUDYN")
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    parser.add_argument("--diagram", type=Path, default=DIAGRAM, help="where the diagram goes")
    given = parser.parse_args()
    with peer_series(given) as (others, peer_versions):
        all_series = (*our_series(), *others)
        runs = measure(all_series, given.repeats)
    told = [described(series, done) for series, done in zip(all_series, runs, strict=True)]
    figures = {
        "problem": "rubber pendulum: length 1 m, radius 5 mm, E 5e6 Pa, nu 0.5, 1100 kg/m3, pinned, let go horizontal",
        "tip_exact_m": EXACT,
        "peer": peer_versions,
        "ahead": ahead(told),
        "series": told,
    }
    write("work_precision", figures, to=given.out)
    draw(told, given.diagram)


if __name__ == "__main__":
    main()
