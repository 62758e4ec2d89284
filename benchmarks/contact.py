"""Cost of contact: a pile of crossed layers of rods that lie on each other, of 100, 300 and 1000 rods of 50 elements.

Every rod touches all rods of the layers above and below it; the ground holds the lowest layer. Each pile runs the same
steps with contact and without it, in turn; the difference is what contact costs. The search is timed alone.
Beside the times: what the run with contact loses of its energy balance, and how deep contacts are.
"""

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np
from harness import paired, spread, write

import cayley as cy
from cayley.steppers.contacts import make_contacts

PILES = {100: (20, 5), 300: (20, 15), 1000: (20, 50)}
"""Rods -> rods of a layer, layers: as many neighbors for each, so that what is linear costs each segment the same."""
ELEMENTS, LENGTH, RADIUS = 50, 1.0, 0.004
STEP = 2e-5
RUBBER = cy.Material(density=1200.0, youngs_modulus=5e6, poisson_ratio=0.4)


def pile(rods: int, *, contact: bool) -> tuple[cy.Model, dict[Any, Any]]:
    """A pile and its start: rods that move a little, each its own way."""
    across, _ = PILES[rods]
    random, section = np.random.default_rng(1), cy.Section.circle(RADIUS, RUBBER)
    made, initial = [], {}
    for k in range(rods):
        layer, place = divmod(k, across)
        offset, height = 0.9 * LENGTH * ((place + 0.5) / across - 0.5), RADIUS * (2 * layer + 1)
        start = (-0.5 * LENGTH, offset, height) if layer % 2 else (offset, -0.5 * LENGTH, height)
        direction = (1, 0, 0) if layer % 2 else (0, 1, 0)
        rod = cy.Rod(section, length=LENGTH, origin=start, direction=direction, elements=ELEMENTS, name=f"rod{k}")
        initial[rod] = {"velocity": np.broadcast_to(0.05 * random.standard_normal(3), (ELEMENTS + 1, 3))}
        made.append(rod)
    gravity = [cy.loads.gravity((0, 0, -9.81))]
    if not contact:
        return cy.Model(*made, loads=gravity), initial
    return cy.Model(*made, loads=gravity, obstacles=[cy.Plane()], contact=cy.Contact(friction=0.3)), initial


def measured(rods: int, steps: int, repeats: int) -> dict[str, Any]:
    """Times of one pile."""
    last: dict[bool, Any] = {}

    def run(contact: bool) -> float:
        model, initial = pile(rods, contact=contact)
        last[contact] = cy.simulate(model, steps * STEP, dt=STEP, save_steps=steps // 2, initial=initial)
        return float(last[contact].wall_time) / last[contact].steps

    times = paired(lambda: run(True), lambda: run(False), repeats)
    own = last[True]
    segments = rods * ELEMENTS
    candidates, search = _search(own, repeats)
    extra = np.median(times.first) - np.median(times.second)
    balance = own.energy_balance
    return {
        "rods": rods,
        "segments": segments,
        "steps": own.steps,
        "step_s": spread(times.first),
        "step_without_contact_s": spread(times.second),
        "ratio": spread(times.ratios),
        "candidates": candidates,
        "contacts": int(own.contacts.number[-1]),
        "contact_ns_per_candidate": float(1e9 * extra / candidates),
        "contact_ns_per_segment": float(1e9 * extra / segments),
        "search_ns_per_segment": 1e9 * search / segments,
        "deepest_radii": float(own.contacts.deepest[-1]),
        "defect_of_energy": float(abs(balance.defect).max() / abs(balance.dissipated).max()),
    }


def _search(run: cy.Trajectory, repeats: int) -> tuple[int, float]:
    """Candidates, and seconds of one search with the forces of one step."""
    found, count = [], 0
    for _ in range(repeats + 1):
        made = make_contacts(run.system, run.dt)
        began = time.perf_counter()
        made.begin(run.state.values, None)
        found.append(time.perf_counter() - began)
        count = int(made.arrays["told"][4])
        made.end()
    return count, min(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rods", type=int, nargs="*", choices=list(PILES), default=list(PILES))
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    rows = []
    for rods in given.rods:
        rows.append(measured(rods, given.steps, given.repeats))
        print({key: value for key, value in rows[-1].items() if not isinstance(value, dict)}, flush=True)
        print({key: value["median"] for key, value in rows[-1].items() if isinstance(value, dict)}, flush=True)
    write("contact", {"elements": ELEMENTS, "radius_m": RADIUS, "dt_s": STEP, "piles": rows}, to=given.out)


if __name__ == "__main__":
    main()
