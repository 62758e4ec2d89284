"""The independent suite cosseratbench: cayley and the solvers that come with it, run by the suite's own command line.

All run in one environment (``benchmarks/.venv-suite``, made here at first use, or that of $COSSERATBENCH_PYTHON),
variant by variant one solver after the other, on the same machine. What is written down is what the suite's result
files say: wall time, metrics, observations, settings. It takes the peers ten minutes, ``--vary all`` hours.
"""

import argparse
import json
import subprocess
from pathlib import Path
from typing import Any

from harness import HERE, ROOT, skip, write
from peer import environment, versions

EXPERIMENTS = ("cantilever", "catenary", "pendulum", "twist", "crossing", "capstan", "pile")
SOLVERS = ("cayley", "pyelastica", "mujoco")
VENV, RUNS = HERE / ".venv-suite", HERE / ".suite"
ADAPTER = ROOT / "adapters" / "cosseratbench"
KEPT = (
    "outcome",
    "failure",
    "diverged_at",
    "missing",
    "wall_time",
    "n_elements",
    "metrics",
    "observations",
    "settings",
)
"""What is kept of a result file of the suite."""


def suite_python() -> Path:
    """Interpreter that has the suite, its solvers, cayley and the adapter."""
    suite = ["-r", str(HERE / "peers" / "suite.txt")]
    ours = [["-e", str(ROOT)], ["-e", str(ADAPTER)]]
    return environment("COSSERATBENCH_PYTHON", VENV, suite, *ours, what="cosseratbench")


def run(python: Path, experiments: list[str], solvers: list[str], vary: list[str], out: Path, *, force: bool) -> None:
    """Let the suite run; what it has saved and still stands for the code is not run again, unless forced."""
    command = [str(python.parent / "cosseratbench"), "run", *experiments, "--out", str(out)]
    command += [word for solver in solvers for word in ("--solver", solver)]
    command += [word for name in vary for word in ("--vary", name)]
    done = subprocess.run([*command, *(["--force"] if force else [])], check=False)
    if done.returncode:
        print("the suite reports runs that crashed; they have no row in the tables")


def collect(out: Path, experiments: list[str], solvers: list[str]) -> list[dict[str, Any]]:
    """Rows of all result files, the ordinary case of an experiment before its variants."""
    found = []
    for experiment in experiments:
        for folder in sorted((out / experiment).glob("*"), key=lambda path: (path.name != "default", path.name)):
            for solver in solvers:
                path = folder / solver / "result.json"
                if path.exists():
                    told = json.loads(path.read_text())
                    row = {"experiment": experiment, "variant": folder.name, "solver": solver}
                    found.append(row | {name: told[name] for name in KEPT})
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiments", nargs="*", help=f"out of {', '.join(EXPERIMENTS)}; all without any")
    parser.add_argument("--solver", action="append", help=f"out of {', '.join(SOLVERS)}, may be repeated; all without")
    parser.add_argument("--vary", action="append", default=[], help='as of the suite: a parameter, or "all"')
    parser.add_argument("--runs", type=Path, default=RUNS, help="folder of the suite's own results")
    parser.add_argument("--results", type=Path, help="where the JSON goes; benchmarks/results without it")
    parser.add_argument("--force", action="store_true", help="run again what is saved")
    parser.add_argument("--collect", action="store_true", help="run nothing, write down what the folder has")
    given = parser.parse_args()
    experiments, solvers = given.experiments or list(EXPERIMENTS), given.solver or list(SOLVERS)
    python = suite_python()
    if not given.collect:
        run(python, experiments, solvers, given.vary, given.runs, force=given.force)
    rows = collect(given.runs, list(EXPERIMENTS), list(SOLVERS))
    if not rows:
        skip(f"no results of the suite in {given.runs}")
    programs = versions(python, "cosseratbench", "pyelastica", "mujoco", "numpy", "numba")
    write("cosseratbench", {"programs": programs, "rows": rows}, to=given.results)


if __name__ == "__main__":
    main()
