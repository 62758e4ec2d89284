"""`cayley advise`: a table of rules and steps for a scenario, without running it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from cayley.cli.execute import DONE, WRONG_INPUT, one_line, told
from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import Scenario, load

ACCURACY = 1e-3
"""Where neither the file nor the command gives one."""


def advise(source: str, *, accuracy: float | None) -> int:
    """Print the alternatives for a scenario, the best first.

    Args:
        source: a TOML file or the name of a shipped scenario.
        accuracy: largest position error over the extent; that of the file or 1e-3 if None.

    Returns: the exit code; an error is told on standard error, one line for each problem.
    """
    console = Console(highlight=False)
    try:
        scenario = load(source)
        wanted = next(a for a in (accuracy, scenario.run.accuracy, ACCURACY) if a is not None)
        with console.status("Trying rules and steps"):
            best, others, said = _looked_at(scenario, wanted)
    except ScenarioError as error:
        return told(error.problems, WRONG_INPUT)
    except (TypeError, ValueError) as error:
        return told([f"{source}: {one_line(error)}"], WRONG_INPUT)
    console.print(table([*best, *others], wanted))
    return DONE if best else told([f"{source}: {said}"], WRONG_INPUT)


def table(alternatives: Sequence[Any], accuracy: float) -> Table:
    """Rules with their steps, the best first."""
    title = f"Rules for an accuracy of {accuracy:g}: steps, expected wall time and error"
    made = Table(title=title, title_justify="left", title_style="bold", box=None, pad_edge=False)
    made.add_column("rule", no_wrap=True)
    for column in ("step \\[s]", "steps", "time \\[s]", "error"):
        made.add_column(column, justify="right", no_wrap=True)
    made.add_column("", style="dim", overflow="fold")
    for k, one in enumerate(alternatives):
        error = "?" if math.isnan(one.error) else f"{one.error:.1e}"
        numbers = (f"{one.dt:.3g}", f"{one.steps}", f"{one.cost:.2g}", error)
        made.add_row(str(one.rule), *numbers, one.reason or ("the cheapest" if k == 0 else ""))
    return made


def _looked_at(scenario: Scenario, accuracy: float) -> tuple[list[Any], tuple[Any, ...], str]:
    """The best rule, if there is one, the others, and what is to be said where there is none."""
    from cayley.choice import Unreached
    from cayley.simulation import advise

    given = scenario.options()
    options = {name: given[name] for name in ("t_end", "initial", "rotation")} | {"save_every": given.get("save_every")}
    try:
        choice = advise(scenario.model(), accuracy=accuracy, **options)
    except Unreached as error:
        return [], error.tried, f"no rule reaches an accuracy of {accuracy:g}"
    return [choice.best], choice.others, ""
