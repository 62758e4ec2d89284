"""Scenario files: a model and a run in TOML."""

from __future__ import annotations

import shutil
import tomllib
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cayley.cli import problems, schema
from cayley.cli.build import BuildError, build
from cayley.cli.problems import ScenarioError
from cayley.cli.tie_build import port_of
from cayley.model import Model

_SAVES = 500  # frames of a run that does not say how often to save


@dataclass(frozen=True, slots=True)
class Scenario:
    """A checked scenario.

    Attributes:
        name: of the file, without `.toml`.
        file: how messages call it.
        text: of the file.
        tables: its contents.
        folder: in which files that it names are.
    """

    name: str
    file: str
    text: str
    tables: schema.ScenarioTables
    folder: Path

    @property
    def title(self) -> str:
        """The title, or the name."""
        return self.tables.title or self.name

    @property
    def run(self) -> schema.RunTable:
        """The `[run]` table.

        Raises:
            ScenarioError: there is none.
        """
        if self.tables.run is None:
            raise ScenarioError(self.file, ["run: is missing; allowed: a [run] table with t_end"])
        return self.tables.run

    @property
    def still_rule(self) -> str:
        """How strain is measured along an element where nothing moves: the rule of `[run]`, or midpoint."""
        return (self.tables.run.rule if self.tables.run else None) or "midpoint"

    def model(self) -> Model:
        """The model it describes."""
        return build(self.tables, self.folder)

    def write(self, folder: Path) -> None:
        """Write it as scenario.toml to a folder, and the files that it names, so that it can run again there."""
        (folder / "scenario.toml").write_text(self.text, encoding="utf-8")
        for table in self.tables.obstacle:
            name = getattr(table, "file", None)
            source, target = self.folder / (name or ""), folder / (name or "")
            if name and source.resolve() != target.resolve():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, target)

    def report_options(self) -> dict[str, Any]:
        """The arguments of `cayley.report.write_report` besides run and path."""
        shown, notes = self.tables.report, self.tables.notes
        return {
            "title": self.title,
            "scenario_text": self.text,
            "notes": () if notes is None else (notes.title, *notes.paragraphs),
            "times": shown.snapshots if shown else None,
            "nodes": shown.nodes if shown else None,
        }

    def options(self) -> dict[str, Any]:
        """The arguments of `cayley.simulate` besides the model."""
        from cayley.discrete import rules  # with CasADi behind it, which checking a file does not need

        run = self.run
        chosen = run.accuracy is not None and run.rule is None
        return {
            "t_end": run.t_end,
            "dt": run.dt,
            "rule": None if chosen else rules.by_name(run.rule or "verlet"),
            **self._saves(),
            "initial": self.initial(),
            "rotation": run.rotation,
            "allow_unstable": run.allow_unstable,
            **({"balance": True} if run.balance else {}),
            **({"settle": run.settle} if run.settle else {}),
            **({} if run.rest is None else {"rest": run.rest}),
            **({} if run.accuracy is None else {"accuracy": run.accuracy}),
        }

    def _saves(self) -> dict[str, Any]:
        """When and what is saved."""
        run, found = self.run, dict[str, Any]()
        every = run.t_end / _SAVES if run.save_steps is None and run.save_at is None else None
        given = {"save_every": run.save_every or every, "save_steps": run.save_steps, "save_at": run.save_at}
        found |= {name: value for name, value in given.items() if value is not None}
        if run.save_only is not None:
            model = self.model()
            parts = dict(zip(model.names, model.parts, strict=True))
            found["save_only"] = [text if text in parts else port_of(text, parts) for text in run.save_only]
        return found

    def initial(self) -> dict[str, dict[str, list[float]]]:
        """What moves at the start, by the name of the part: velocity [m/s], angular_velocity [rad/s], momenta."""
        return {
            str(table.rod or table.body or table.part): table.model_dump(
                exclude={"rod", "body", "part"}, exclude_none=True
            )
            for table in self.tables.initial
        }


def shipped() -> dict[str, Traversable]:
    """The scenarios that come with the library, by name."""
    folder = resources.files("cayley.cli") / "scenarios"
    files = (file for file in folder.iterdir() if file.name.endswith(".toml"))
    return {file.name.removesuffix(".toml"): file for file in sorted(files, key=lambda file: file.name)}


def load(source: str | Path) -> Scenario:
    """Read and check a scenario.

    Args:
        source: path of a TOML file, or the name of a shipped scenario.

    Returns: the scenario; its model can be built.

    Raises:
        ScenarioError: the file is missing or something in it is wrong; one line for each problem.
    """
    text, name = source_text(source)
    return parse(text, name=name, file=str(source))


def source_text(source: str | Path) -> tuple[str, str]:
    """The text of a scenario, and its name.

    Raises:
        ScenarioError: there is no such file, or it is no text.
    """
    name = str(source)
    file: Path | Traversable = Path(source)
    if not file.is_file():
        known = shipped()
        if name not in known:
            near = problems.nearest(name, known)
            hint = f' (did you mean "{near}"?)' if near else ""
            what = "is a directory" if file.is_dir() else f"no such file{hint}"
            raise ScenarioError(name, [f"{what}; allowed: a TOML file, or a shipped scenario ({', '.join(known)})"])
        file = known[name]
    try:
        text = file.read_bytes().decode("utf-8")
    except OSError as error:
        raise ScenarioError(name, [f"cannot be read: {error.strerror}"]) from None
    except UnicodeDecodeError as error:
        raise ScenarioError(name, [f"is no text in UTF-8 (byte {error.start}); allowed: a TOML file"]) from None
    return text, file.name.removesuffix(".toml")


def parse(text: str, *, name: str, file: str, folder: Path | None = None) -> Scenario:
    """Check the text of a scenario.

    Args:
        text: of the file.
        name: of the scenario.
        file: how messages call it.
        folder: in which files that it names are; that of the file if None.

    Raises:
        ScenarioError: something in it is wrong; one line for each problem.
    """
    try:
        tables = schema.ScenarioTables.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(file, [f"TOML syntax: {error}"]) from None
    except ValidationError as error:
        raise ScenarioError(file, problems.of_validation(error)) from None
    if all(table is None for table in (tables.run, tables.statics, tables.modes, tables.trace)):
        allowed = "a [run] table with t_end, or one of [statics], [modes], [trace]"
        raise ScenarioError(file, [f"run: is missing; allowed: {allowed}"])
    around = Path(file).parent if folder is None else folder
    try:
        build(tables, around)
    except BuildError as error:
        raise ScenarioError(file, error.found) from None
    return Scenario(name, file, text, tables, around)
