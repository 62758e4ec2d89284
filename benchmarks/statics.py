"""A cantilever at rest, of 1000 elements, and 20 of its modes: cayley against EXUDYN, and against a dense solution.

A round steel rod under a dead force of 2 EI/l² at its tip, which bends it by half its length. Both programs take
two-node geometrically exact beam elements with one point of integration, a tolerance of 1e-9 and a sparse solver, in
one load step, and are timed in turn: the search alone, and for cayley also the whole call, from the model. The error
is that of the tip, against elements of degree 5.

Modes are those of the straight rod, 200 elements. The dense solution is scipy.linalg.eigh of the same matrices.
"""

import argparse
import os
import time
from pathlib import Path
from typing import Any

import numpy as np
from harness import HERE, distance, paired, spread, write
from peer import Peer, exudyn_python, peer, versions
from scipy.linalg import eigh

import cayley as cy
from cayley.statics.newton import solve
from cayley.steppers.still import Still
from cayley.system.discretize import discretize

LENGTH, RADIUS, FORCE = 1.0, 0.01, 2.0
"""Length [m], radius [m], force at the tip [EI/l²]."""
ELEMENTS, MESH_OF_MODES, MODES = 1000, 200, 20
STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
SECTION = cy.Section.circle(RADIUS, STEEL, shear_correction="none")
PYTHON = HERE / ".venv-peers" / "bin" / "python"


def cantilever(elements: int, *, loaded: bool = True) -> cy.Model:
    rod = cy.Rod(SECTION, length=LENGTH, elements=elements, direction=(1, 0, 0), normal=(0, 1, 0), name="rod")
    load = cy.loads.force(rod.end, (0.0, 0.0, FORCE * SECTION.stiffness[3, 3] / LENGTH**2))
    return cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[load] if loaded else [])


def tip(rest: Any) -> tuple[float, ...]:
    return tuple(rest["rod"].position.values[-1].tolist())


def searched(system: Any) -> tuple[float, int]:
    """Time of Newton's method alone [s], from the straight rod, and its corrections."""
    still = Still.at(system, system.reference)
    began = time.perf_counter()
    found = solve(still)
    wall_time = time.perf_counter() - began
    if not found.found:
        raise RuntimeError("no equilibrium of the cantilever was found")
    return wall_time, found.iterations


def called(model: cy.Model) -> float:
    """Time of the whole call [s]."""
    began = time.perf_counter()
    cy.equilibrium(model)
    return time.perf_counter() - began


def statics(exudyn: Peer | None, repeats: int) -> dict[str, Any]:
    model = cantilever(ELEMENTS)
    system, fine = discretize(model, cy.rules.midpoint), cy.rules.galerkin(time=1, space=5)
    exact = tip(cy.equilibrium(cantilever(40), rule=fine))
    asked = {"elements": ELEMENTS, "force": FORCE, "load_steps": 1}
    own = {
        "corrections": searched(system)[1],
        "tip_error_m": distance(tip(cy.equilibrium(model)), exact),
        "whole_call_s": spread([called(model) for _ in range(repeats)]),
    }
    figures: dict[str, Any] = {"elements": ELEMENTS, "force_EI_per_l2": FORCE, "cayley": own}
    if exudyn is None:
        own["search_s"] = spread([searched(system)[0] for _ in range(repeats)])
    else:
        pairs = paired(lambda: searched(system)[0], lambda: exudyn.run(**asked).wall_time, repeats)
        other = exudyn.run(**asked)
        own["search_s"] = spread(pairs.first)
        figures["exudyn"] = {
            "iterations": other.steps,
            "tip_error_m": other.error(exact),
            "search_s": spread(pairs.second),
        }
        figures["exudyn_over_cayley"] = spread([1.0 / ratio for ratio in pairs.ratios])
    own["search_us_per_element"] = 1e6 * own["search_s"]["median"] / ELEMENTS
    return figures


def dense(rest: Any) -> tuple[float, np.ndarray]:
    """Time [s] of all modes by a dense solution of the same matrices, and the lowest frequencies [Hz]."""
    still = rest.still
    stiffness, mass = (-still.matrix(order).toarray()[np.ix_(still.free, still.free)] for order in (0, 2))
    began = time.perf_counter()
    squares = eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, MODES - 1])
    return time.perf_counter() - began, np.sqrt(squares) / (2.0 * np.pi)


def vibration(exudyn: Peer | None, repeats: int) -> dict[str, Any]:
    if not hasattr(cy, "modes"):
        return {"skipped": "this cayley has no cy.modes"}
    model = cantilever(MESH_OF_MODES, loaded=False)
    rest = cy.equilibrium(model)

    def own() -> tuple[float, np.ndarray]:
        began = time.perf_counter()
        found = cy.modes(model, about=rest, count=MODES)
        return time.perf_counter() - began, np.asarray(found.frequency)

    pairs = paired(lambda: own()[0], lambda: dense(rest)[0], repeats)
    frequencies, exact = own()[1], dense(rest)[1]
    figures: dict[str, Any] = {
        "elements": MESH_OF_MODES,
        "modes": MODES,
        "cayley_s": spread(pairs.first),
        "dense_s": spread(pairs.second),
        "largest_difference": float(np.abs(frequencies / exact - 1.0).max()),
    }
    if exudyn is not None:
        runs = [exudyn.run(elements=MESH_OF_MODES, modes=MODES) for _ in range(repeats + 1)][1:]
        figures["exudyn_s"] = spread([run.wall_time for run in runs])
        figures["exudyn_difference"] = float(np.abs(np.array(runs[0].tip) / exact - 1.0).max())
    return figures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=7, help="counted pairs of runs (default: %(default)s)")
    parser.add_argument("--to", type=Path, help="folder of the JSON (default: benchmarks/results)")
    given = parser.parse_args()
    python = exudyn_python(PYTHON) if PYTHON.exists() or "EXUDYN_PYTHON" in os.environ else None
    if python is None:
        figures = {"statics": statics(None, given.repeats), "modes": vibration(None, given.repeats)}
    else:
        with peer(python, "exudyn_cantilever.py") as exudyn:
            figures = {"statics": statics(exudyn, given.repeats), "modes": vibration(exudyn, given.repeats)}
        figures["peers"] = versions(python, "exudyn")
    write("statics", figures, to=given.to)


if __name__ == "__main__":
    main()
