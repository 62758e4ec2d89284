"""`cayley statics`: the equilibrium of a scenario's model, tables, a store and a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from cayley.cli.execute import analyzed
from cayley.cli.scenario import Scenario
from cayley.cli.statics_schema import StaticsTable

_DPI = 150
_ZERO = 1e-9
"""Numbers below this part of the largest beside them are printed as 0: rounding."""


def statics(source: str, *, out: Path | None, picture: bool, quiet: bool) -> int:
    """Find the equilibrium of a scenario and write DIR/rest.zarr, DIR/rest.png and DIR/scenario.toml.

    Args:
        source: a TOML file or the name of a shipped scenario; its table [statics] says what is wanted.
        out: the folder DIR; runs/NAME by default.
        picture: whether to draw the deformed shape.
        quiet: print nothing but errors.

    Returns: the exit code; an error is told on standard error, one line for each problem.
    """
    console = Console(quiet=quiet, highlight=False)
    return analyzed(source, out, lambda scenario, folder: _found(scenario, folder, console, picture=picture))


def _found(scenario: Scenario, folder: Path, console: Console, *, picture: bool) -> None:
    from cayley.discrete import rules
    from cayley.statics import equilibrium

    wanted = scenario.tables.statics or StaticsTable.model_validate({})
    options = wanted.model_dump(exclude={"rule"})
    with console.status("Looking for the equilibrium"):
        rest = equilibrium(scenario.model(), rule=rules.by_name(wanted.rule or "midpoint"), **options)
    folder.mkdir(parents=True, exist_ok=True)
    rest.save(folder / "rest.zarr", overwrite=True)
    scenario.write(folder)
    console.print(str(rest.model), repr(rest), sep="\n", soft_wrap=True, markup=False)
    for table in (ends(rest), reactions(rest), moments(rest)):
        if table.row_count:
            console.print("", table)
    console.print(f"Results: {folder / 'rest.zarr'}", soft_wrap=True)
    if picture:
        from cayley.report import figures

        figures.deformed(rest).savefig(folder / "rest.png", dpi=_DPI)
        console.print(f"Picture: {folder / 'rest.png'}", soft_wrap=True)


def ends(rest: Any) -> Table:
    """Where the end of every rod and every body is, and how far it moved."""
    table = _table("Ends of rods, and bodies", "part", ["x \\[m]", "y", "z", "moved \\[m]"])
    model, begin = rest.model, rest.system.reference[:, rest.system.layout.rows_of("x")]
    for part, name in zip(model.parts, model.names, strict=True):
        place = rest[part].position.values
        last = place if place.ndim == 1 else place[-1]
        moved = np.linalg.norm(last - begin[rest.frame._parts[name].stop - 1])
        table.add_row(name, *_shown(last), f"{moved:.6g}")
    return table


def reactions(rest: Any) -> Table:
    """What the ground exerts at each support, and joints on their second sides."""
    axes = ["force x \\[N]", "y", "z", "moment x \\[N m]", "y", "z"]
    table = _table("Reactions of supports, and forces of joints", "at", axes)
    model = rest.model
    held = [(f"{s.kind} {s.port.called(model.name_of(s.port.part))}", rest.reaction(s)) for s in model.supports]
    joined = [
        (name, rest.reaction(joint) if joint.grounded else rest.joint(joint))
        for name, joint in zip(model.connection_names, model.connections, strict=True)
    ]
    for name, wrench in held + joined:
        table.add_row(name, *_shown(wrench.force.values), *_shown(wrench.moment.values))
    return table


def moments(rest: Any) -> Table:
    """The largest force and moment in every rod, and where along it."""
    columns = ["force \\[N]", "at s \\[m]", "moment \\[N m]", "at s \\[m]", "curvature \\[1/m]"]
    table = _table("Largest in each rod", "rod", columns)
    for rod in rest.model.rods:
        own = rest[rod]
        row = []
        for field in ("force", "moment"):
            size = np.linalg.norm(own[field].values, axis=-1)
            k = int(np.argmax(size))
            row += [f"{size[k]:.6g}", f"{float(own['s'][k]):.4g}"]
        bent = np.linalg.norm(own["curvature"].values, axis=-1).max()
        table.add_row(rest.model.name_of(rod), *row, f"{bent:.6g}")
    return table


def _table(title: str, first: str, columns: Sequence[str]) -> Table:
    table = Table(title=title, title_justify="left", title_style="bold", box=None, pad_edge=False)
    table.add_column(first, no_wrap=True)
    for column in columns:
        table.add_column(column, justify="right", no_wrap=True)
    return table


def _shown(vector: np.ndarray) -> list[str]:
    """Numbers with six digits, rounding errors as 0."""
    least = _ZERO * float(np.abs(vector).max(initial=0.0))
    return [f"{value:.6g}" if abs(value) > least else "0" for value in vector]
