"""`cayley trace`: a path of equilibria of a scenario's model, its critical points, a store and a diagram."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from cayley.cli.execute import analyzed
from cayley.cli.scenario import Scenario
from cayley.cli.tie_build import port_of

_DPI = 150


def trace(source: str, *, out: Path | None, quiet: bool) -> int:
    """Follow a path and write DIR/path.zarr, DIR/branch-K-plus.zarr and -minus.zarr of branches, and DIR/trace.png.

    Args:
        source: a TOML file with a table [trace].
        out: the folder DIR; runs/NAME by default.
        quiet: print nothing but errors.

    Returns: the exit code; an error is told on standard error, one line for each problem.
    """
    console = Console(quiet=quiet, highlight=False)

    def act(scenario: Scenario, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        with console.status("Following equilibria"):
            paths = _followed(scenario)
        for name, path in paths.items():
            path.save(folder / f"{name}.zarr", overwrite=True)
        scenario.write(folder)
        console.print(table(paths))
        _drawn(scenario, list(paths.values()), folder / "trace.png")
        console.print(f"Results: {folder / 'path.zarr'}", soft_wrap=True)
        console.print(f"Diagram: {folder / 'trace.png'}", soft_wrap=True)

    return analyzed(source, out, act)


def table(paths: dict[str, Any]) -> Table:
    """Ends and critical points of paths: parameter, and how many motions are unstable from there on."""
    made = Table(title="Paths of equilibria", title_justify="left", title_style="bold", box=None, pad_edge=False)
    made.add_column("path")
    for column in ("point", next(iter(paths.values())).name):
        made.add_column(column, justify="right", no_wrap=True)
    made.add_column("")
    made.add_column("unstable from there", justify="right")
    for name, path in paths.items():
        marks = [(one.point, one.kind) for one in path.critical]
        for k, word in [(0, "begin"), *marks, (len(path) - 1, path.ended)]:
            behind = path.unstable[k + (0 < k < len(path) - 1)]  # at a critical point itself it may be either
            made.add_row(name, str(k), f"{path.parameter[k]:.8g}", word, str(behind))
    return made


def _followed(scenario: Scenario) -> dict[str, Any]:
    """The path, and its branches if they are wanted, by the names of their stores."""
    from cayley.continuation import trace
    from cayley.discrete import rules

    wanted = scenario.tables.trace
    if wanted is None:
        raise ValueError("trace is missing; allowed: a [trace] table with a parameter")
    model = scenario.model()
    words = [wanted.parameter] if isinstance(wanted.parameter, str) else wanted.parameter
    loads = {f"load #{k + 1}": one for k, one in enumerate(model.loads)}
    chosen = [loads.get(word, word) for word in words]
    path = trace(
        model,
        chosen[0] if len(chosen) == 1 else chosen,
        range=(wanted.range[0], wanted.range[1]),
        rule=rules.by_name(wanted.rule or scenario.still_rule),
        **wanted.model_dump(include={"begin", "time", "direction", "points", "step", "turn"}),
    )
    found = {"path": path}
    for k in range(min(wanted.branches, len(path.bifurcations))):
        for direction, word in ((1, "plus"), (-1, "minus")):
            found[f"branch-{k + 1}-{word}"] = path.branch(k, direction=direction)
    return found


def _drawn(scenario: Scenario, paths: list[Any], file: Path) -> None:
    from cayley.report import figures

    wanted = scenario.tables.trace
    assert wanted is not None
    place = None
    if wanted.of is not None:
        model = paths[0].model
        place = port_of(wanted.of, dict(zip(model.names, model.parts, strict=True))), wanted.axis
    figures.branches(paths, place).savefig(file, dpi=_DPI)
