"""`cayley sweep`: run a scenario with many values of some of its keys, and put what comes out into one table."""

from __future__ import annotations

import csv
import itertools
import os
import tomllib
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from copy import deepcopy
from pathlib import Path
from typing import Any

from rich.table import Table

from cayley.cli.execute import DONE, STOPPED, Wanted, guarded, one_line
from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import parse, source_text

MOST_SHOWN = 40
"""Rows of the table on the screen; the file has all."""


def sweep(source: str, settings: list[str], *, out: Path | None, workers: int | None, wanted: Wanted) -> int:
    """Run a scenario for all combinations of values, and write DIR/sweep.csv and DIR/NNNN/run.zarr.

    Args:
        source: a TOML file or the name of a shipped scenario.
        settings: "KEY=V1,V2,..." with a key such as section.tube.thickness, run.dt or load.2.value (lists count from
            1).
        out: the folder DIR; runs/NAME_sweep by default.
        workers: processes; as many as there are processors without it.
        wanted: what to print.

    Returns: the exit code: 3 if a run stopped, the others are there all the same.
    """

    def run() -> int:
        text, name = source_text(source)
        axes = [_axis(setting) for setting in settings]
        if not axes:
            raise ValueError("sweep: there is nothing to vary; give --set KEY=V1,V2,...")
        cases = [
            dict(zip((key for key, _ in axes), values, strict=True))
            for values in itertools.product(*(v for _, v in axes))
        ]
        folder = Path("runs") / f"{name}_sweep" if out is None else out
        tables = tomllib.loads(text)
        for case in cases:  # all are checked before the first one runs
            parse(_toml(_with(tables, case)), name=name, file=source)
        folder.mkdir(parents=True, exist_ok=True)
        jobs = [(_toml(_with(tables, case)), name, str(folder / f"{k + 1:04}"), source) for k, case in enumerate(cases)]
        count = workers or os.cpu_count() or 1
        with ProcessPoolExecutor(min(count, len(jobs))) as pool:
            found = list(pool.map(_one, jobs))
        rows = [case | result for case, result in zip(cases, found, strict=True)]
        _write(folder / "sweep.csv", rows)
        wanted.console.print(_table(rows))
        wanted.console.print(f"Results: {folder / 'sweep.csv'}", soft_wrap=True)
        return STOPPED if any(result["outcome"] != "finished" for result in found) else DONE

    return guarded(source, run)


def _axis(setting: str) -> tuple[str, list[Any]]:
    """Key and values of "KEY=V1,V2,..."; values as TOML writes them, words without quotes, too."""
    key, sign, values = setting.partition("=")
    if not sign or not key.strip() or not values.strip():
        raise ValueError(f"--set {setting!r}: give KEY=V1,V2,..., such as --set run.dt=1e-3,1e-4")
    try:
        return key.strip(), tomllib.loads(f"v = [{values}]")["v"]
    except tomllib.TOMLDecodeError:
        return key.strip(), [word.strip() for word in values.split(",")]


def _with(tables: Mapping[str, Any], case: Mapping[str, Any]) -> dict[str, Any]:
    """The scenario with other values of some keys."""
    made = deepcopy(dict(tables))
    for key, value in case.items():
        *way, last = key.split(".")
        at: Any = made
        for word in way:
            at = _entry(at, word, key)
        if isinstance(at, list):
            at[_number(at, last, key)] = value
        elif isinstance(at, dict):
            at[last] = value
        else:
            raise ValueError(f"--set {key}: there is no such key in the scenario")
    return made


def _entry(at: Any, word: str, key: str) -> Any:
    if isinstance(at, list):
        named = [one for one in at if isinstance(one, dict) and one.get("name") == word]
        return named[0] if named else at[_number(at, word, key)]
    if isinstance(at, dict) and word in at:
        return at[word]
    raise ValueError(f"--set {key}: there is no {word!r} in the scenario")


def _number(at: list[Any], word: str, key: str) -> int:
    if not word.isdigit() or not 1 <= int(word) <= len(at):
        raise ValueError(f"--set {key}: {word!r} is neither a name nor a number from 1 to {len(at)}")
    return int(word) - 1


def _toml(tables: Mapping[str, Any]) -> str:
    import tomli_w

    return tomli_w.dumps(dict(tables))


def _one(job: tuple[str, str, str, str]) -> dict[str, Any]:
    """Run one case in a process of its own; returns a row of the table."""
    text, name, place, source = job
    from cayley.simulation import SimulationError, simulate

    folder = Path(place)
    folder.mkdir(parents=True, exist_ok=True)
    try:
        scenario = parse(text, name=name, file=place, folder=Path(source).parent)
        scenario.write(folder)
        run = simulate(scenario.model(), **scenario.options(), store=folder / "run.zarr", overwrite=True)
    except SimulationError as error:
        return {"outcome": one_line(error), "folder": place}
    except (ScenarioError, TypeError, ValueError) as error:
        return {"outcome": one_line(error), "folder": place}
    energy = run.energy.values
    ends: dict[str, float] = {}
    for part in run._parts:
        position = run[part].position.isel(time=-1).values.reshape(-1, 3)[-1]
        ends |= {f"{part} end {axis} [m]": float(value) for axis, value in zip("xyz", position, strict=True)}
    return {
        "outcome": "finished",
        "rule": run.rule,
        "dt [s]": run.dt,
        "wall time [s]": run.wall_time,
        "energy ripple [J]": float(energy.max() - energy.min()),
        **ends,
        "folder": place,
    }


def _write(path: Path, rows: list[dict[str, Any]]) -> None:
    names = list(dict.fromkeys(name for row in rows for name in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names, restval="")
        writer.writeheader()
        writer.writerows(rows)


def _table(rows: list[dict[str, Any]]) -> Table:
    made = Table(box=None, pad_edge=False)
    names = [name for name in dict.fromkeys(name for row in rows for name in row) if name != "folder"]
    for name in names:
        made.add_column(name, justify="right", overflow="fold")
    for row in rows[:MOST_SHOWN]:
        made.add_row(*(f"{v:.5g}" if isinstance(v := row.get(name, ""), float) else str(v) for name in names))
    return made
