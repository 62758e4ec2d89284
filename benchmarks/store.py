"""What writing costs: the same runs in memory and into a store, in turn.

python benchmarks/store.py
"""

import argparse
import json
import statistics
import tempfile
from pathlib import Path

import cayley as cy

RUNS = 5


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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "results" / "store.json")
    rows = []
    for name, (elements, options) in CASES.items():
        own = model(elements)
        cy.simulate(own, **(options | {"t_end": options["t_end"] / 100}))
        ratios, sizes, memory = [], [], []
        for _ in range(RUNS):
            plain = cy.simulate(own, **options).wall_time
            with tempfile.TemporaryDirectory() as folder:
                stored = cy.simulate(own, store=Path(folder) / "run.zarr", **options)
                sizes.append(sum(f.stat().st_size for f in Path(folder).rglob("*") if f.is_file()) / 1e6)
            ratios.append(stored.wall_time / plain)
            memory.append(plain)
        ratio = statistics.median(ratios)
        rows.append({"case": name, "in memory [s]": statistics.median(memory), "ratio": ratio, "MB": sizes[-1]})
        print(f"{name:45s} {rows[-1]['in memory [s]']:6.2f} s, written {ratio:.3f} times that, {sizes[-1]:.1f} MB")
    parser.parse_args().out.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
