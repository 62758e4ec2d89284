"""`cayley check`, `schema`, `new`, `cite` and `export`: scenario files and results without a run."""

from __future__ import annotations

import json
import re
from importlib import resources
from pathlib import Path

from cayley.cli import problems
from cayley.cli.execute import DONE, WRONG_INPUT, guarded, told
from cayley.cli.resume import scenario_of
from cayley.cli.scenario import load, shipped
from cayley.cli.schema import ScenarioTables

TEMPLATES = ("cantilever", "pendulum", "assembly", "rope", "column")
EXPORTS = ("csv", "netcdf", "vtk")


def check(source: str, *, as_json: bool) -> int:
    """Check a scenario and print its model; returns the exit code."""
    if as_json:
        try:
            load(source)
        except problems.ScenarioError as error:
            print(json.dumps({"file": source, "problems": list(error.problems)}))
            return WRONG_INPUT
        print(json.dumps({"file": source, "problems": []}))
        return DONE

    def look() -> int:
        scenario = load(source)
        print(scenario.model())
        print(f"{source}: nothing is wrong")
        return DONE

    return guarded(source, look)


def schema_text() -> str:
    """The JSON Schema of scenario files."""
    found = ScenarioTables.model_json_schema()
    found |= {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "cayley scenario"}
    return json.dumps(found, indent=2, ensure_ascii=False)


def new(name: str, template: str) -> int:
    """Write NAME.toml from a template; returns the exit code."""
    known = {word: resources.files("cayley.cli") / "templates" / f"{word}.toml" for word in TEMPLATES} | shipped()
    if template not in known:
        return told([f"--template {problems.unlike(template, known)}"], WRONG_INPUT)
    stem = name.removesuffix(".toml")
    if not re.fullmatch(r"[\w./-]+", stem):
        return told([f"NAME is {problems.shown(name)}; allowed: letters, digits, - and _"], WRONG_INPUT)
    path = Path(f"{stem}.toml")
    if path.exists():
        return told([f"{path} is there already; give another name"], WRONG_INPUT)

    def write() -> int:
        text = known[template].read_text(encoding="utf-8")
        path.write_text(text, encoding="utf-8")
        command = "run" if "\n[run]" in text else "trace"
        print(f"{path} is written; edit it, then: cayley {command} {path}")
        return DONE

    return guarded(str(path), write)


def cite(folder: Path | None) -> int:
    """Print references; returns the exit code."""

    def write() -> int:
        from cayley.report.cite import citation
        from cayley.report.cite import cite as cite_run
        from cayley.results.trajectory import Trajectory

        if folder is None:
            print("\n".join(citation()))
        else:
            print(cite_run(Trajectory.open(folder if folder.suffix == ".zarr" else folder / "run.zarr")))
        return DONE

    return guarded(str(folder), write)


def export(folder: Path, kind: str, out: Path | None) -> int:
    """Write a run for other programs; returns the exit code."""
    if kind not in EXPORTS:
        return told([f"--to {problems.unlike(kind, EXPORTS)}"], WRONG_INPUT)

    def write() -> int:
        from cayley.results.export import export as write_export
        from cayley.results.trajectory import Trajectory

        place = folder.parent if folder.suffix == ".zarr" else folder
        scenario = scenario_of(place)
        store = folder if folder.suffix == ".zarr" else folder / "run.zarr"
        run = Trajectory.open(store, model=None if scenario is None else scenario.model())
        target = place / kind if out is None else out
        for path in write_export(run, kind, target):
            print(path)
        return DONE

    return guarded(str(folder), write)
