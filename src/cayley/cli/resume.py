"""`cayley resume`: go on with a run that was killed, stopped or is to be longer."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cayley.cli.execute import Wanted, finished, guarded
from cayley.cli.scenario import Scenario, parse
from cayley.cli.screen import Progress


def resume(folder: Path, *, until: float | None, wanted: Wanted) -> int:
    """Go on with DIR/run.zarr, with the model of DIR/scenario.toml where that is there.

    Args:
        folder: DIR, or the store itself.
        until: end of the run [s]; that which was asked for if None.
        wanted: what to print and write.

    Returns: the exit code; an error is told on standard error.
    """
    place = folder.parent if folder.suffix == ".zarr" else folder

    def run() -> int:
        scenario = scenario_of(place)

        def resumed(progress: Progress) -> Any:
            from cayley.simulation import resume

            model = None if scenario is None else scenario.model()
            return resume(place / "run.zarr", until, model=model, progress=progress, watch=progress.watch)

        return finished(str(folder), scenario, place, resumed, wanted)

    return guarded(str(folder), run)


def scenario_of(folder: Path) -> Scenario | None:
    """The scenario that ran in a folder, if it is there."""
    file = folder / "scenario.toml"
    if not file.exists():
        return None
    return parse(file.read_text(encoding="utf-8"), name=folder.name, file=str(file))
