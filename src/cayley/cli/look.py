"""`cayley report` and `cayley view`: look at a run that is on the disk, or is being written."""

from __future__ import annotations

import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer

from cayley.cli.execute import DONE, REPORT, SCENARIO, STORE, WRONG_INPUT, one_line, told
from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import load


@dataclass(frozen=True, slots=True)
class Found:
    """What a folder holds.

    Attributes:
        store: of the run.
        scenario: the file beside it, read, or None.
    """

    store: Path
    scenario: Any

    @property
    def title(self) -> str:
        """The scenario's title, or the folder's name."""
        own = self.scenario.tables.title if self.scenario else ""
        return own or self.store.resolve().parent.name


def found(folder: Path) -> Found:
    """The store of a folder, or the store itself, and the scenario beside it.

    Raises:
        ScenarioError: if the scenario can't be read.
    """
    store = folder / STORE if (folder / STORE).exists() else folder
    beside = store.parent / SCENARIO
    return Found(store, load(str(beside)) if store.name == STORE and beside.exists() else None)


def write(folder: Path, out: Path | None) -> int:
    """Write the report of a folder; returns the exit code."""
    try:
        from cayley.report import write_report
        from cayley.results.trajectory import Trajectory

        own = found(folder)
        path = own.store.parent / REPORT if out is None else out
        options = own.scenario.report_options() if own.scenario else {}
        written = write_report(Trajectory.open(own.store), path, **(options | {"title": own.title}))
    except ScenarioError as error:
        return told(error.problems, WRONG_INPUT)
    except (OSError, ValueError) as error:
        return told([one_line(error)], WRONG_INPUT)
    typer.echo(f"Report:  {written}")
    return DONE


def view(folder: Path, *, port: int, browser: bool) -> int:
    """Serve the page of a folder until interrupted; returns the exit code."""
    try:
        from cayley.report.serve import server

        own = found(folder)
        text = own.scenario.text if own.scenario else None
        serving = server(own.store, port=port, title=own.title, scenario_text=text)
    except ScenarioError as error:
        return told(error.problems, WRONG_INPUT)
    except (OSError, ValueError) as error:
        return told([one_line(error)], WRONG_INPUT)
    address = f"http://{serving.server_address[0]!s}:{serving.server_port}/"
    typer.echo(f"{own.store}: {address} (end with Ctrl+C)")
    if browser:
        webbrowser.open(address)
    with serving:
        try:
            serving.serve_forever()
        except KeyboardInterrupt:
            typer.echo("")
    return DONE
