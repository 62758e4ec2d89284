"""`cayley run`: from a scenario file to a folder of results."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from rich.console import Console

from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import Scenario, load
from cayley.cli.screen import Progress, conservation_table

DONE, WRONG_INPUT, STOPPED = 0, 2, 3
STORE, SCENARIO, REPORT = "run.zarr", "scenario.toml", "report.html"  # in the folder of a run


def execute(source: str, *, out: Path | None, report: bool, quiet: bool) -> int:
    """Run a scenario and write DIR/run.zarr, DIR/scenario.toml and DIR/report.html.

    Args:
        source: a TOML file or the name of a shipped scenario.
        out: the folder DIR; runs/NAME by default.
        report: whether to write the report.
        quiet: print nothing but errors.

    Returns: the exit code; an error is told on standard error, one line for each problem.
    """
    console = Console(quiet=quiet, highlight=False)
    try:
        scenario = load(source)
        folder = Path("runs") / scenario.name if out is None else out
        store = folder / STORE
        folder.mkdir(parents=True, exist_ok=True)
        run = _simulated(scenario, store, console)
        run.save(store, overwrite=True)
        (folder / SCENARIO).write_text(scenario.text, encoding="utf-8")
        if scenario.run.accuracy is not None:
            console.print(run.why, soft_wrap=True)
        if not quiet:
            console.print(conservation_table(run))
        console.print(f"Results: {store}", soft_wrap=True)
        if report:
            _reported(run, scenario, folder / REPORT, console)
    except ScenarioError as error:
        return told(error.problems, WRONG_INPUT)
    except OSError as error:  # of the folder or the disk
        return told([f"{error.filename}: {error.strerror}" if error.strerror else str(error)], WRONG_INPUT)
    except _Refused as error:
        return told([f"{source}: {error}"], WRONG_INPUT)
    except _Stopped as error:
        return told([f"{source}: {error}"], STOPPED)
    return DONE


class _Refused(Exception):
    """The library does not accept what the scenario says."""


class _Stopped(Exception):
    """The run stopped on the way."""


def _simulated(scenario: Scenario, store: Path, console: Console) -> Any:
    with Progress(console, scenario.run.t_end) as progress:
        from cayley.simulation import SimulationError, simulate

        try:
            return simulate(scenario.model(), **scenario.options(), progress=progress)
        except SimulationError as error:
            error.partial.save(store, overwrite=True)
            # the library's message is for Python; here the frames are on the disk
            raise _Stopped(one_line(error).replace("the exception's .partial", str(store))) from error
        except (TypeError, ValueError) as error:
            raise _Refused(one_line(error)) from error


def _reported(run: Any, scenario: Scenario, path: Path, console: Console) -> None:
    from cayley.report import write_report

    with console.status("Writing the report"):
        write_report(run, path, **scenario.report_options())
    console.print(f"Report:  {path}", soft_wrap=True)


def told(lines: Any, code: int) -> int:
    """Print lines on standard error; returns the exit code."""
    for line in lines:
        print(line, file=sys.stderr)
    return code


def one_line(error: Exception) -> str:
    """The message of an error without line breaks."""
    return " ".join(str(error).split())
