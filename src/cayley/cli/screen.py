"""What a command shows while it runs, and the table of conserved quantities."""

from __future__ import annotations

import time as clock
from types import TracebackType
from typing import Any

from rich import progress as rich_progress
from rich.console import Console
from rich.table import Table

from cayley.report.conserved import conservation

LOOK_EVERY = 2.0
"""Time between two looks at the energy of a run in progress [s]; one costs a few milliseconds."""


class Progress:
    """A bar with the time reached, the time left, the speed and the energy.

    Called by the integrator with (fraction done, time [s]); ``watch`` with the system and its state.
    """

    def __init__(self, console: Console, t_end: float) -> None:
        self._bar = rich_progress.Progress(
            rich_progress.TextColumn("{task.description}"),
            rich_progress.BarColumn(),
            rich_progress.TaskProgressColumn(),
            rich_progress.TextColumn("{task.fields[reached]}"),
            rich_progress.TimeRemainingColumn(),
            console=console,
        )
        self._t_end = t_end
        # a bar that only moves while the equations are derived and compiled: nobody knows how long that takes
        self._task = self._bar.add_task("Compiling", total=None, reached="")
        self._begun: tuple[float, float] | None = None
        self._energy, self._looked = "", 0.0

    def __enter__(self) -> Progress:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def __call__(self, fraction: float, time: float) -> None:
        """Show how far the run is."""
        now = clock.perf_counter()
        self._begun = self._begun or (now, time)
        spent, way = now - self._begun[0], time - self._begun[1]
        speed = f", {way / spent:.2g} s/s" if spent > 0.0 and way > 0.0 else ""
        reached = f"t = {time:.4g}{f' of {self._t_end:.4g}' if self._t_end else ''} s{speed}{self._energy}"
        self._bar.update(self._task, description="Running", total=1.0, completed=fraction, reached=reached)

    def watch(self, system: Any, state: Any) -> None:
        """Look at the energy now and then."""
        now = clock.perf_counter()
        if now - self._looked < LOOK_EVERY:
            return
        self._looked = now
        from cayley.results.observe import energy_of

        self._energy = f", {energy_of(system, state):.5g} J"


def conservation_table(run: Any) -> Table:
    """The figures of conservation and speed, for the screen."""
    table = Table(title="Conservation", title_justify="left", title_style="bold", box=None, pad_edge=False)
    table.add_column("quantity")
    table.add_column("value", justify="right")
    table.add_column("unit")
    table.add_column("", style="dim")
    for row in conservation(run):
        table.add_row(row.quantity, row.value, row.unit, row.note)
    return table
