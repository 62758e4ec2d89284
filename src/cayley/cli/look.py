"""`cayley report` and `cayley view`: look at a run that is on the disk, or is being written."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Any

from rich.console import Console

from cayley.cli.execute import DONE, guarded, write_report_of
from cayley.cli.resume import scenario_of


def write(folder: Path, out: Path | None) -> int:
    """Write the report of a folder or store; returns the exit code."""

    def report() -> int:
        from cayley.results.trajectory import Trajectory

        place, store = _places(folder)
        run = Trajectory.open(store)
        write_report_of(
            run, scenario_of(place), place / "report.html" if out is None else out, Console(highlight=False)
        )
        return DONE

    return guarded(str(folder), report)


def view(folder: Path, *, port: int, browser: bool) -> int:
    """Serve the page of a folder or store until interrupted; returns the exit code."""

    def serve() -> int:
        from cayley.report.serve import server

        place, store = _places(folder)
        scenario = scenario_of(place)
        options: dict[str, Any] = {"title": place.resolve().name}
        if scenario is not None:
            options = {"title": scenario.title, "scenario_text": scenario.text, "model": scenario.model()}
        with server(store, port=port, **options) as serving:
            address = f"http://{serving.server_address[0]!s}:{serving.server_port}/"
            print(f"{store}: {address} (end with Ctrl+C)", flush=True)
            if browser:
                webbrowser.open(address)
            try:
                serving.serve_forever()
            except KeyboardInterrupt:
                print()
        return DONE

    return guarded(str(folder), serve)


def _places(folder: Path) -> tuple[Path, Path]:
    """The folder of a run, and its store."""
    if folder.suffix == ".zarr":
        return folder.parent, folder
    return folder, folder / "run.zarr"
