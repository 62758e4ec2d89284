"""What writing costs: the same runs in memory and into a store, in turn; medians.

The time of the integration tells what writing beside it costs where a processor is idle; the processor time of all
threads what it costs where none is.

python benchmarks/store.py
"""

import argparse
import json
import os
import statistics
import tempfile
import time
from pathlib import Path

import cayley as cy

RUNS = 5
COLUMNS = ("in memory [s]", "ratio", "processor time [s]", "ratio of processor time", "MB")


def model(elements: int) -> cy.Model:
    steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
    rod = cy.Rod(cy.Section.circle(0.005, steel), length=1.0, direction=(1, 0, 0), elements=elements)
    return cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[cy.loads.gravity((0, 0, -9.81))])


MIDPOINT = {"rule": cy.rules.midpoint, "dt": 1e-3, "t_end": 30.0}
CASES = {
    "midpoint, 100 elements, every 10 steps": (
        100,
        MIDPOINT | {"save_every": 1e-2},
    ),
    "midpoint, 20 elements, every step": (
        20,
        MIDPOINT | {"save_every": 1e-3},
    ),
    "verlet, 100 elements, every 1000 steps": (100, {"rule": cy.rules.verlet, "t_end": 0.4, "save_every": 4e-4}),
}


def measured(own: cy.Model, options: dict) -> tuple[float, float]:
    """Time of the integration [s], and processor time of all threads for it and what is observed of it [s]."""
    began = time.process_time()
    run = cy.simulate(own, **options)
    _ = run.energy
    return run.wall_time, time.process_time() - began


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "results" / "store.json")
    rows = []
    for name, (elements, options) in CASES.items():
        own = model(elements)
        cy.simulate(own, **(options | {"t_end": options["t_end"] / 100}))
        found = []
        for _ in range(RUNS):
            plain, cpu = measured(own, options)
            with tempfile.TemporaryDirectory() as folder:
                stored, cpu_stored = measured(own, options | {"store": Path(folder) / "run.zarr"})
                size = sum(f.stat().st_size for f in Path(folder).rglob("*") if f.is_file()) / 1e6
            found.append((plain, stored / plain, cpu, cpu_stored / cpu, size))
        numbers = (statistics.median(column) for column in zip(*found, strict=True))
        row = {"case": name} | dict(zip(COLUMNS, numbers, strict=True))
        rows.append(row | {"load": os.getloadavg()[0], "processors": os.cpu_count()})
        print(
            f"{name:40s} {row['in memory [s]']:6.2f} s, written {row['ratio']:.3f} times that; processor time with all "
            f"observed {row['processor time [s]']:6.2f} s, written {row['ratio of processor time']:.3f} times that; "
            f"{row['MB']:.1f} MB; load {rows[-1]['load']:.1f}"
        )
    parser.parse_args().out.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
