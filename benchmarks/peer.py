"""Other programs, each waiting for runs in a process of its own: a line of JSON in is a run, a line out its result."""

import json
import math
import os
import subprocess
import venv
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness import HERE, distance, skip

PROGRAMS = HERE / "peers"


@dataclass(frozen=True, slots=True)
class Run:
    """What any program returns.

    Args:
        steps: number of steps.
        dt: time step [s].
        wall_time: time of the loop alone [s].
        tip: position of the free end at the end [m], None if the run failed.
    """

    steps: int
    dt: float
    wall_time: float
    tip: tuple[float, ...] | None

    def error(self, exact: Sequence[float]) -> float:
        """Largest error of the tip in any component [m], infinite after a failure."""
        return math.inf if self.tip is None else distance(self.tip, exact)


FAILED = Run(0, math.nan, math.inf, None)


class Peer:
    """A program that waits for runs."""

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        """Hold the process."""
        self._process = process

    def run(self, **asked: Any) -> Run:
        """Let it run what is asked; what the keys mean is the program's matter."""
        source, sink = self._process.stdout, self._process.stdin
        assert source is not None
        assert sink is not None
        sink.write(json.dumps(asked) + "\n")
        sink.flush()
        line = source.readline()
        if not line:
            raise RuntimeError(f"{self._process.args} ended without an answer to {asked}; see above")
        told = json.loads(line)
        return Run(told["steps"], told["dt"], told["wall_time"], told["tip"] and tuple(told["tip"]))


@contextmanager
def peer(python: Path, program: str) -> Iterator[Peer]:
    """A program of the folder ``peers``, in a process that ends with the block."""
    given = [python, PROGRAMS / program]
    with subprocess.Popen(given, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1) as process:
        yield Peer(process)
        if process.stdin is not None:
            process.stdin.close()


def environment(variable: str, folder: Path, *wanted: Sequence[str], what: str) -> Path:
    """Interpreter that has what is wanted: the one a variable names, or that of an environment made at first use.

    Args:
        variable: environment variable, which names an interpreter.
        folder: of the environment; an installation that did not end is begun again.
        wanted: arguments of pip install, one call after the other.
        what: name of what is installed, for who reads that it could not be.
    """
    given = os.environ.get(variable)
    if given:
        return Path(given)
    python = folder / "bin" / "python"
    if not (folder / ".done").exists():
        print(f"setting up {folder}, once")
        venv.create(folder, with_pip=True, clear=True)
        pip = [str(python), "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
        if any(subprocess.run([*pip, *one], check=False).returncode for one in wanted):
            skip(f"{what} could not be installed; give an interpreter that has it in ${variable}")
        (folder / ".done").touch()
    return python


def versions(python: Path, *packages: str) -> dict[str, str]:
    """Versions of those of some packages that an interpreter has."""
    program = (
        "import json, sys\nfrom importlib.metadata import PackageNotFoundError, version\nfound = {}\n"
        "for name in sys.argv[1:]:\n    try:\n        found[name] = version(name)\n"
        "    except PackageNotFoundError:\n        pass\nprint(json.dumps(found))"
    )
    told = subprocess.run([python, "-c", program, *packages], capture_output=True, text=True, check=True).stdout
    found: dict[str, str] = json.loads(told)
    return found


def exudyn_python(default: Path) -> Path | None:
    """Interpreter that has EXUDYN: $EXUDYN_PYTHON, or the default if it has it."""
    python = Path(os.environ.get("EXUDYN_PYTHON", default))
    return python if "exudyn" in versions(python, "exudyn") else None
