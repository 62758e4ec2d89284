"""The wait: what a user waits for beyond the integration, with an empty cache and with a warm one.

Each measurement is a fresh process: the README's first example as it stands there, and ``cayley run leitz2014
--no-report``. The integration itself is what the same run takes when done a second time in one process, where
everything is loaded; ``run.wall_time`` of a first run may contain the loading of drivers, which is waiting too.
"Empty" means new cache folders for cayley and everything else that obeys XDG_CACHE_HOME; the .pyc files of the
installed packages and the system's file cache stay, as after an installation.
"""

import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

from harness import ROOT, paired, spread, write

EMPTY_LIMIT, WARM_LIMIT = 3.0, 1.5
"""Longest wait beyond the integration [s], with an empty and a warm cache."""
CACHES = ("CAYLEY_CACHE_DIR", "XDG_CACHE_HOME")
COMMAND = "import sys; from cayley.cli.main import app; sys.argv[0] = 'cayley'; app()"
TWICE_EXAMPLE = """
import sys
source = open(sys.argv[1]).read()
for _ in range(2):
    names = {}
    exec(source, names)
print("integration", names["run"].wall_time)
"""
TWICE_COMMAND = """
import pathlib, sys
import cayley as cy
from cayley.cli.main import app
for turn in ("first", "second"):
    out = pathlib.Path(sys.argv[1]) / turn
    try:
        app(["run", "leitz2014", "--no-report", "--out", str(out)], standalone_mode=False)
    except SystemExit as end:
        assert not end.code, end.code
store = next(iter(sorted(out.rglob("*.zarr"))))
print("integration", cy.Trajectory.open(store).wall_time)
"""


@dataclass(frozen=True, slots=True)
class Task:
    """Something a user types.

    Args:
        name: what it is called.
        command: what is run, in a folder that is empty but for the example.
        twice: a command that does it twice in one process and prints the second integration's wall time [s].
    """

    name: str
    command: tuple[str, ...]
    twice: tuple[str, ...]


def example() -> str:
    """First Python block of the README that simulates."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), flags=re.DOTALL)
    found = next((block for block in blocks if "cy.simulate(" in block), None)
    if found is None:
        raise RuntimeError("README.md has no Python block with cy.simulate(")
    return found


def tasks(folder: Path) -> list[Task]:
    """The example and the command line, as fresh processes of this interpreter."""
    script = folder / "example.py"
    script.write_text(example())
    python = sys.executable
    installed = Path(python).with_name("cayley")
    cayley = (str(installed),) if installed.exists() else (python, "-c", COMMAND)
    return [
        Task("example", (python, str(script)), (python, "-c", TWICE_EXAMPLE, str(script))),
        Task(
            "command line",
            (*cayley, "run", "leitz2014", "--no-report", "--out", "out"),
            (python, "-c", TWICE_COMMAND, "out"),
        ),
    ]


def caches(folder: Path) -> dict[str, str]:
    """Environment whose caches are in a folder."""
    return {**os.environ, **{name: str(folder / name.lower()) for name in CACHES}}


def run(command: Sequence[str], environment: Mapping[str, str]) -> tuple[float, str, str]:
    """Run a process in a folder of its own.

    Returns: (wall time [s], standard output, standard error).
    """
    with tempfile.TemporaryDirectory() as work:
        began = time.perf_counter()
        done = subprocess.run(command, env=environment, cwd=work, capture_output=True, text=True, check=False)
        wall = time.perf_counter() - began
    if done.returncode:
        raise RuntimeError(f"{' '.join(command[:3])} ... failed:\n{done.stdout[-1000:]}{done.stderr[-2000:]}")
    return wall, done.stdout, done.stderr


def integration(task: Task, environment: Mapping[str, str]) -> float:
    """Wall time of the integration itself, everything loaded [s]; least of three."""
    return min(float(run(task.twice, environment)[1].split()[-1]) for _ in range(3))


def imports(command: Sequence[str], environment: Mapping[str, str]) -> dict[str, float]:
    """Time importing, by package [s]: the largest eight, all others, and the sum.

    Source: ``python -X importtime``, which itself costs a little.
    """
    told = run(command, {**environment, "PYTHONPROFILEIMPORTTIME": "1"})[2]
    spent: Counter[str] = Counter()
    for microseconds, module in re.findall(r"^import time:\s+(\d+) \|\s+\d+ \|\s+(\S+)$", told, flags=re.MULTILINE):
        spent[module.partition(".")[0]] += int(microseconds)
    first = dict(spent.most_common(8))
    shown = {**first, "others": spent.total() - sum(first.values()), "sum": spent.total()}
    return {name: round(1e-6 * t, 4) for name, t in shown.items()}


def measure(task: Task, folder: Path, repeats: int) -> dict[str, Any]:
    """Wait of one task with empty and warm caches, in turn."""
    warm, number = caches(folder / "warm"), count()
    pairs = paired(
        lambda: run(task.command, caches(folder / f"empty{next(number)}"))[0],
        lambda: run(task.command, warm)[0],
        repeats,
    )
    itself = integration(task, warm)
    start = statistics.median(run((sys.executable, "-c", "pass"), warm)[0] for _ in range(5))
    spent = imports(task.command, warm)
    figures: dict[str, Any] = {"integration_s": itself, "python_start_s": start, "imports_warm_s": spent}
    for state, times, limit in (("empty", pairs.first, EMPTY_LIMIT), ("warm", pairs.second, WARM_LIMIT)):
        beyond = spread([t - itself for t in times])
        figures[state] = {"wall_s": spread(times), "wait_s": beyond, "wait_limit_s": limit}
        print(
            f"{task.name}, {state} cache: wait {beyond['median']:.2f} s ({beyond['min']:.2f} to {beyond['max']:.2f})"
            f" beyond an integration of {itself:.3f} s, limit {limit:g} s"
        )
    largest = ", ".join(f"{name} {t:.2f}" for name, t in spent.items())
    print(f"{task.name}: Python alone {start:.2f} s; imports with a warm cache [s]: {largest}")
    return figures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--only", choices=("example", "command line"), help="measure one of the two, write nothing")
    parser.add_argument("--out", type=Path, help="folder of the JSON file")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        chosen = [task for task in tasks(folder) if given.only in (None, task.name)]
        figures = {task.name.replace(" ", "_"): measure(task, folder / task.name, given.repeats) for task in chosen}
    if given.only is None:
        write("wait", figures, to=given.out)


if __name__ == "__main__":
    main()
