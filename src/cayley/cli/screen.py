"""What `cayley run` shows: a progress bar and the table of conserved quantities."""

from __future__ import annotations

from types import TracebackType
from typing import Any

from rich import progress as rich_progress
from rich.console import Console
from rich.table import Table

from cayley.report.conserved import conservation


class Progress:
    """A bar with the time reached and the time left; called by the integrator with (fraction done, time [s])."""

    def __init__(self, console: Console, t_end: float) -> None:
        self._bar = rich_progress.Progress(
            rich_progress.TextColumn("{task.description}"),
            rich_progress.BarColumn(),
            rich_progress.TaskProgressColumn(),
            rich_progress.TextColumn("{task.fields[reached]}"),
            rich_progress.TextColumn("time left"),
            rich_progress.TimeRemainingColumn(),
            console=console,
        )
        self._t_end = t_end
        # a bar that only moves while the equations are derived and compiled: nobody knows how long that takes
        self._task = self._bar.add_task("Compiling", total=None, reached="")

    def __enter__(self) -> Progress:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def __call__(self, fraction: float, time: float) -> None:
        """Show how far the run is."""
        reached = f"t = {time:.4g} of {self._t_end:.4g} s"
        self._bar.update(self._task, description="Running", total=1.0, completed=fraction, reached=reached)


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
