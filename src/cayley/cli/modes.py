"""`cayley modes`: frequencies and shapes of a scenario's model, a table, a store, pictures and a page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from cayley.cli.execute import analyzed
from cayley.cli.modes_schema import ModesTable
from cayley.cli.scenario import Scenario

_DPI = 150


def modes(source: str, *, out: Path | None, count: int | None, report: bool, quiet: bool) -> int:
    """Find the modes of a scenario and write DIR/modes.zarr, modes.png and modes.html, with speeds also campbell.png.

    Args:
        source: a TOML file or the name of a shipped scenario; its table [modes] says what is wanted.
        out: the folder DIR; runs/NAME by default.
        count: number of modes; that of the file if None.
        report: whether to write the page.
        quiet: print nothing but errors.

    Returns: the exit code; an error is told on standard error, one line for each problem.
    """
    console = Console(quiet=quiet, highlight=False)

    def act(scenario: Scenario, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        wanted = scenario.tables.modes or ModesTable.model_validate({})
        with console.status("Finding modes"):
            found, diagram = _found(scenario, wanted, wanted.count if count is None else count)
        found.save(folder / "modes.zarr")
        console.print(table(found))
        _drawn(found, diagram, folder)
        console.print(f"Results: {folder / 'modes.zarr'}", soft_wrap=True)
        if report:
            from cayley.report import write_modes

            page = folder / "modes.html"
            write_modes(found, page, title=scenario.title, scenario_text=scenario.text, diagram=diagram)
            console.print(f"Page:    {page}", soft_wrap=True)

    return analyzed(source, out, act)


def table(found: Any) -> Table:
    """Modes with frequency, damping, what moves most and effective masses."""
    made = Table(
        title=f"Modes about {found.about!r}", title_justify="left", title_style="bold", box=None, pad_edge=False
    )
    for column in ("mode", "frequency \\[Hz]", "damping \\[-]"):
        made.add_column(column, justify="right", no_wrap=True)
    made.add_column("moves most")
    for column in ("mass x \\[kg]", "y", "z"):
        made.add_column(column, justify="right", no_wrap=True)
    mass = found.effective_mass.values[:, :3].round(12)
    rows = zip(found.frequency.values, found.damping_ratio.values, found.moves_most(), mass, strict=True)
    for k, (frequency, damping, words, own) in enumerate(rows):
        made.add_row(str(k), f"{frequency:.6g}", f"{damping:.3g}", words, *(f"{m:.3g}" for m in own))
    return made


def _found(scenario: Scenario, wanted: ModesTable, count: int) -> tuple[Any, Any]:
    """The modes, and the Campbell diagram if speeds are given."""
    from cayley.discrete import rules
    from cayley.statics import equilibrium
    from cayley.vibration import campbell, modes

    model, rule = scenario.model(), rules.by_name(wanted.rule or scenario.still_rule)
    if wanted.about == "reference":
        model = model.replace(loads=[])
    rest = equilibrium(model, spin=wanted.spin, rule=rule)
    if wanted.speeds is None:
        return modes(model, about=rest, count=count), None
    axis = np.array(wanted.spin or (0.0, 0.0, 1.0))
    return modes(model, about=rest, count=count), campbell(model, wanted.speeds, count, axis=axis, rule=rule)


def _drawn(found: Any, diagram: Any, folder: Path) -> None:
    from cayley.report import vibration

    vibration.mode_shapes(found).savefig(folder / "modes.png", dpi=_DPI)
    if diagram is not None:
        vibration.campbell(diagram).savefig(folder / "campbell.png", dpi=_DPI)
