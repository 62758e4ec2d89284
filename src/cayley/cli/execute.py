"""`cayley run`: from a scenario file to a folder of results."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import Scenario, load
from cayley.cli.screen import Progress, conservation_table

DONE, WRONG_INPUT, STOPPED, INTERRUPTED = 0, 2, 3, 130


@dataclass(frozen=True, slots=True)
class Wanted:
    """What a command is to print and to write.

    Args:
        report: whether to write the report.
        quiet: print nothing but errors.
        as_json: print one JSON object instead of tables.
    """

    report: bool = True
    quiet: bool = False
    as_json: bool = False

    @property
    def console(self) -> Console:
        """Where tables go."""
        return Console(quiet=self.quiet or self.as_json, highlight=False)


def execute(source: str, *, out: Path | None, wanted: Wanted) -> int:
    """Run a scenario and write DIR/run.zarr, DIR/scenario.toml and DIR/report.html.

    Args:
        source: a TOML file or the name of a shipped scenario.
        out: the folder DIR; runs/NAME by default.
        wanted: what to print and write.

    Returns: the exit code; an error is told on standard error, one line for each problem.
    """

    def run() -> int:
        scenario = load(source)
        folder = Path("runs") / scenario.name if out is None else out
        folder.mkdir(parents=True, exist_ok=True)
        scenario.write(folder)  # at once: to resume a killed run

        def simulated(progress: Progress) -> Any:
            from cayley.simulation import simulate

            options = scenario.options() | {"store": folder / "run.zarr", "overwrite": True}
            return simulate(scenario.model(), **options, progress=progress, watch=progress.watch)

        return finished(source, scenario, folder, simulated, wanted)

    return guarded(source, run)


def finished(
    source: str, scenario: Scenario | None, folder: Path, simulated: Callable[[Progress], Any], wanted: Wanted
) -> int:
    """Run, print figures and write the report; returns the exit code."""
    from cayley.simulation import Interrupted, SimulationError

    console, store = wanted.console, folder / "run.zarr"
    try:
        with Progress(console, 0.0 if scenario is None else scenario.run.t_end) as progress:
            run = simulated(progress)
    except SimulationError as error:
        # the library's message is for Python; here the frames are on the disk
        return told([f"{source}: {one_line(error).replace(_PARTIAL, str(store))}"], STOPPED)
    except Interrupted as error:
        time = error.partial.time[-1]
        return told([f"{source}: stopped by hand at t = {time:.6g} s; cayley resume {folder} goes on"], INTERRUPTED)
    if "error_estimate" in run.info:
        console.print(run.why, soft_wrap=True)
    if wanted.as_json:
        print(json.dumps(facts(run, store)))
    elif not wanted.quiet:
        console.print(conservation_table(run))
    console.print(f"Results: {store}", soft_wrap=True)
    if wanted.report:
        write_report_of(run, scenario, folder / "report.html", console)
    return DONE


_PARTIAL = "the exception's .partial"


def guarded(source: str, act: Callable[[], int]) -> int:
    """Do something and tell what goes wrong in lines on standard error; returns the exit code."""
    try:
        return act()
    except ScenarioError as error:
        return told(error.problems, WRONG_INPUT)
    except OSError as error:  # of the folder or the disk
        return told([f"{error.filename}: {error.strerror}" if error.strerror else one_line(error)], WRONG_INPUT)
    except (KeyError, TypeError, ValueError) as error:
        return told([f"{source}: {one_line(error)}"], WRONG_INPUT)
    except KeyboardInterrupt:
        return told([f"{source}: stopped by hand"], INTERRUPTED)


def analyzed(source: str, out: Path | None, act: Callable[[Scenario, Path], None]) -> int:
    """Do something with the equilibria of a scenario, for a folder, runs/NAME by default; returns the exit code."""
    from cayley.statics import EquilibriumError

    def analyze() -> int:
        scenario = load(source)
        try:
            act(scenario, Path("runs") / scenario.name if out is None else out)
        except EquilibriumError as error:
            return told([f"{source}: {one_line(error)}"], STOPPED)
        return DONE

    return guarded(source, analyze)


def write_report_of(run: Any, scenario: Scenario | None, path: Path, console: Console) -> None:
    """Write the HTML report of a run."""
    from cayley.report import write_report

    options = {} if scenario is None else scenario.report_options()
    with console.status("Writing the report"):
        write_report(run, path, **options)
    console.print(f"Report:  {path}", soft_wrap=True)


def facts(run: Any, store: Path) -> dict[str, Any]:
    """Figures of a run for scripts."""
    from cayley.report.conserved import conservation

    rows = {row.quantity: {"value": row.value, "unit": row.unit} for row in conservation(run)}
    numbers = {"rule": run.rule, "dt": run.dt, "steps": run.steps, "wall_time": run.wall_time}
    return {"store": str(store), "frames": len(run.time), "t_end": float(run.time[-1]), **numbers, "conservation": rows}


def told(lines: Any, code: int) -> int:
    """Print lines on standard error; returns the exit code."""
    for line in lines:
        print(line, file=sys.stderr)
    return code


def one_line(error: Exception) -> str:
    """The message of an error without line breaks."""
    text = error.args[0] if isinstance(error, KeyError) and error.args else error
    return " ".join(str(text).split())
