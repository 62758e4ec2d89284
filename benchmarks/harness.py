"""What every benchmark shares: the machine, the commit, repeated timing in pairs, JSON.

A figure is worth something only beside what it was measured on and how exact the result was. ``write`` adds the first;
each script puts the second next to its times.
"""

import json
import os
import platform
import statistics
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, NoReturn

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
RESULTS = HERE / "results"
PACKAGES = ("numpy", "casadi", "llvmlite", "scipy", "xarray", "zarr")


@dataclass(frozen=True, slots=True)
class Pairs:
    """Times of two programs run in turn, A B A B ..., so that a slow spell of the machine meets both.

    Args:
        first: times of A.
        second: times of B, run right after.
    """

    first: tuple[float, ...]
    second: tuple[float, ...]

    @property
    def ratios(self) -> tuple[float, ...]:
        """A/B, pair by pair [-]."""
        return tuple(a / b for a, b in zip(self.first, self.second, strict=True))


def paired(first: Callable[[], float], second: Callable[[], float], repeats: int) -> Pairs:
    """Run two programs in turn, once without counting and then ``repeats`` times.

    Args:
        first: runs A and returns its time.
        second: runs B and returns its time.
        repeats: number of counted pairs.
    """
    if repeats < 1:
        raise ValueError(f"repeats is {repeats}; give 1 or more")
    first(), second()
    times = [(first(), second()) for _ in range(repeats)]
    return Pairs(tuple(a for a, _ in times), tuple(b for _, b in times))


def spread(values: Sequence[float]) -> dict[str, float | int]:
    """Median, smallest and largest of some measured values, and how many there are."""
    return {"median": statistics.median(values), "min": min(values), "max": max(values), "repeats": len(values)}


def distance(first: Sequence[float], second: Sequence[float]) -> float:
    """Largest difference of two points in any component, max |aᵢ − bᵢ| [m]."""
    return max(abs(float(a) - float(b)) for a, b in zip(first, second, strict=True))


def machine() -> dict[str, Any]:
    """Processor, cores, system, Python and the packages that matter for speed."""
    return {
        "cpu": _processor(),
        "cores": len(os.sched_getaffinity(0)),
        "system": platform.platform(),
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "load_average": round(os.getloadavg()[0], 2),
    }


def commit() -> str:
    """Hash of the commit, with "-dirty" if anything but the results themselves was changed since."""
    try:
        found = _git("rev-parse", "HEAD")
        changed = _git("status", "--porcelain", "--", ".", ":!benchmarks/results", ":!benchmarks/README.md")
    except (OSError, subprocess.CalledProcessError):
        return "none"
    return found + ("-dirty" if changed else "")


def write(name: str, figures: dict[str, Any], *, to: Path | None = None) -> Path:
    """Write figures with machine, commit and date as JSON, and say where.

    Args:
        name: name of the benchmark; the file is ``name.json``.
        figures: what was measured.
        to: folder; ``benchmarks/results`` without it.
    """
    path = (to or RESULTS) / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    date = datetime.now(UTC).isoformat(timespec="seconds")
    record = {"benchmark": name, "date": date, "commit": commit(), "machine": machine(), **figures}
    path.write_text(json.dumps(record, indent=2, allow_nan=False) + "\n")
    print(f"wrote {path}")
    return path


def skip(reason: str) -> NoReturn:
    """End the script without figures because something it needs is not here."""
    print(f"skipped: {reason}", file=sys.stderr)
    raise SystemExit(0)


def _git(*arguments: str) -> str:
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.strip()


def _processor() -> str:
    """Model of the processor, with family and model number where the name alone is vague."""
    try:
        rows = Path("/proc/cpuinfo").read_text().split("\n\n")[0].splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    told = {key.strip(): value.strip() for key, _, value in (row.partition(":") for row in rows)}
    name = told.get("model name", platform.machine())
    return f"{name} (family {told.get('cpu family', '?')}, model {told.get('model', '?')})"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
