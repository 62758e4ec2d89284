"""`cayley doctor`: what this installation is, and whether it works."""

from __future__ import annotations

import os
import platform
import time as clock
from collections.abc import Callable
from importlib import metadata

from rich.console import Console
from rich.table import Table

from cayley.cli.execute import one_line

LIBRARIES = ("numpy", "scipy", "casadi", "llvmlite", "xarray", "zarr", "matplotlib", "pydantic")


def doctor() -> int:
    """Print a table of facts and checks; returns 0, or 1 if a check fails."""
    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_row("Python", f"{platform.python_version()} on {platform.system()} {platform.machine()}")
    table.add_row("processor", f"{_processor()}, {os.cpu_count()} cores")
    for name in ("cayley", *LIBRARIES):
        table.add_row(name, _version(name))
    failed = False
    for name, check in {"engine": _engine, "compiler": _small_run, "implicit": _implicit_run, "cache": _cache}.items():
        try:
            table.add_row(name, check())
        except Exception as error:  # whatever is wrong with an installation is what is to be told
            failed = True
            table.add_row(name, f"[red]{type(error).__name__}: {one_line(error)}[/red]")
    Console(highlight=False).print(table)
    return int(failed)


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    from cayley.codegen.jit import host_name

    return host_name()


def _engine() -> str:
    from cayley.codegen.kernels import lanes_for
    from cayley.steppers.native import library

    lanes = lanes_for(1, 1000)
    library(lanes, pose=True)
    return f"compiled, {lanes} doubles side by side"


def _run(rule_name: str, dt: float | None = None) -> Callable[[], str]:
    def run() -> str:
        import cayley as cy

        rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
        rod = cy.Rod(cy.Section.circle(0.01, rubber), length=0.3, elements=4)
        model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[cy.loads.gravity((0, -9.81, 0))])
        begun = clock.perf_counter()
        found = cy.simulate(model, t_end=0.1, dt=dt, rule=getattr(cy.rules, rule_name))
        drift = float(abs(found.energy - found.energy[0]).max() / found.kinetic_energy.max())
        return f"{rule_name}: a run in {clock.perf_counter() - begun:.2g} s, energy ripple {drift:.1e}"

    return run


_small_run, _implicit_run = _run("verlet"), _run("midpoint", dt=1e-3)


def _cache() -> str:
    from cayley.codegen.jit import cache_directory

    folder = cache_directory()
    size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file()) if folder.exists() else 0
    return f"{folder}, {size / 1e6:.1f} MB"
