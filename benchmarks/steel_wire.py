"""A steel wire pendulum: ``midpoint`` at steps of milliseconds against PyElastica at its own stable step.

Same wire, same ten elements. PyElastica's step is the largest of ``CANDIDATES`` that survives a first stretch. Its time
for the whole run is scaled up from that stretch, measured in turn with cayley; if the estimate is below ``--longest``,
the whole run is made once as well, for its error and as a check. Both errors are to a fine mesh of a rule of order 4.
"""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness import distance, paired, spread, write
from peer import FAILED, Peer, Run, peer, versions
from pyelastica import peer_python

import cayley as cy

ELEMENTS, T_END = 10, 0.75
STRETCH = 0.015
"""Time over which PyElastica is measured [s]."""
CANDIDATES = (6e-7, 5e-7, 4e-7, 3e-7, 2.5e-7, 2e-7, 1e-7)
"""Steps that PyElastica is offered [s]."""
STABLE = 1e-4
"""Error after the stretch [m] above which a run counts as blown up."""
STEPS = (1e-2, 2e-3)
"""Steps of ``midpoint`` [s]."""
WANTED = 1000.0
"""Least number of times cayley must be faster."""
FINE = (20, 2.5e-3)
"""Elements and step of the reference, galerkin(time=2, space=2) [s]; half as many tell its own error."""
YOUNGS, POISSON, DENSITY, RADIUS = 2e11, 0.3, 7850.0, 1e-3


def ours(dt: float | None, rule: cy.rules.Rule, *, elements: int = ELEMENTS, t_end: float = T_END) -> Run:
    """The wire in cayley."""
    steel = cy.Material(density=DENSITY, youngs_modulus=YOUNGS, poisson_ratio=POISSON)
    section = cy.Section.circle(RADIUS, steel, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=elements)
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])
    try:
        run = cy.simulate(model, t_end=t_end, dt=dt, rule=rule, save_every=t_end)
    except cy.SimulationError:
        return FAILED
    tip = run[rod].position.isel(time=-1, node=-1).values
    return Run(run.steps, run.dt, run.wall_time, tuple(tip.tolist()))


def theirs(elastica: Peer, dt: float, t_end: float) -> Run:
    """The wire in PyElastica."""
    shear = YOUNGS / (2.0 * (1.0 + POISSON))
    wire = {"base_radius": RADIUS, "density": DENSITY, "youngs_modulus": YOUNGS, "shear_modulus": shear}
    return elastica.run(elements=ELEMENTS, dt=dt, t_end=t_end, rod=wire)


def stable_step(elastica: Peer) -> float:
    """Largest candidate with which PyElastica survives the stretch [s]."""
    exact = ours(None, cy.rules.verlet, t_end=STRETCH).tip
    assert exact is not None
    for dt in CANDIDATES:
        if theirs(elastica, dt, STRETCH).error(exact) < STABLE:
            return dt
    raise RuntimeError(f"PyElastica survives {STRETCH:g} s with no step of {CANDIDATES}")


def compare(elastica: Peer, step: float, dt: float, exact: tuple[float, ...], repeats: int) -> dict[str, Any]:
    """Time ``midpoint`` with step dt for the whole run in turn with PyElastica's stretch, scaled to the whole."""
    mine, more = ours(dt, cy.rules.midpoint), T_END / STRETCH

    def whole() -> float:
        return more * theirs(elastica, step, STRETCH).wall_time

    pairs = paired(whole, lambda: ours(dt, cy.rules.midpoint).wall_time, repeats)
    faster = spread(pairs.ratios)
    print(
        f"midpoint, step {mine.dt:g} s: {spread(pairs.second)['median'] * 1e3:.2f} ms; PyElastica, step {step:g} s:"
        f" {spread(pairs.first)['median']:.1f} s (scaled); {faster['median']:.0f} times faster"
        f" ({faster['min']:.0f} to {faster['max']:.0f}), wanted {WANTED:g}; tip error {mine.error(exact):.1e} m"
    )
    return {
        "dt_s": mine.dt,
        "steps": mine.steps,
        "loop_s": spread(pairs.second),
        "pyelastica_loop_s": spread(pairs.first),
        "times_faster": faster,
        "times_faster_wanted": WANTED,
        "tip_m": mine.tip,
        "tip_error_m": mine.error(exact),
    }


def reference() -> tuple[tuple[float, ...], float]:
    """Tip for a fine mesh and a small step, and its difference to the tip for half as many elements [m]."""
    elements, dt = FINE
    rule = cy.rules.galerkin(time=2, space=2)
    fine, coarse = ours(dt, rule, elements=elements).tip, ours(dt, rule, elements=elements // 2).tip
    if fine is None or coarse is None:
        raise RuntimeError(f"the reference did not run with {elements} elements and a step of {dt:g} s")
    return fine, distance(fine, coarse)


def described(run: Run, exact: tuple[float, ...]) -> dict[str, Any]:
    """A single run with its error, None where it failed."""
    error = run.error(exact) if run.tip else None
    return {"dt_s": run.dt, "steps": run.steps, "loop_s": run.wall_time, "tip_m": run.tip, "tip_error_m": error}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--longest", type=float, default=90.0, help="PyElastica's whole run is made if shorter [s]")
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    python = peer_python()
    exact, doubt = reference()
    mesh = ours(5e-4, cy.rules.midpoint).error(exact)
    explicit = ours(None, cy.rules.verlet)
    whole = None
    with peer(python, "pyelastica_pendulum.py") as elastica:
        step = stable_step(elastica)
        rows = [compare(elastica, step, dt, exact, given.repeats) for dt in STEPS]
        if rows[0]["pyelastica_loop_s"]["median"] < given.longest:
            run = theirs(elastica, step, T_END)
            whole = described(run if run.error(exact) < 1.0 else replace(run, tip=None), exact)
            print(f"PyElastica, whole run: {run.wall_time:.1f} s, tip error {run.error(exact):.1e} m")
    figures = {
        "problem": "steel wire: length 1 m, radius 1 mm, E 2e11 Pa, nu 0.3, 7850 kg/m3, pinned, let go horizontal",
        "elements": ELEMENTS,
        "t_end_s": T_END,
        "tip_exact_m": exact,
        "tip_exact_doubt_m": doubt,
        "mesh_error_m": mesh,
        "peer": versions(python, "pyelastica", "numba", "numpy"),
        "pyelastica": {"dt_s": step, "stretch_s": STRETCH, "whole_run": whole},
        "verlet": described(explicit, exact),
        "rows": rows,
    }
    write("steel_wire", figures, to=given.out)


if __name__ == "__main__":
    main()
