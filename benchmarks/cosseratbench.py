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

import suite
from harness import HERE, ROOT, skip, write
from peer import environment, versions

EXPERIMENTS = ("cantilever", "catenary", "pendulum", "twist", "crossing", "capstan", "pile")
SOLVERS = ("cayley", "pyelastica", "mujoco")
FINE: dict[str, tuple[int, tuple[str, ...]]] = {
    "cantilever": (160, ()),
    "catenary": (400, ("youngs_modulus", "span")),
    "pendulum": (400, ("youngs_modulus",)),
    "crossing": (255, ("youngs_modulus", "drop")),
}
"""Where there is a reference: elements with which cayley has what the model itself has, and the parameters."""
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
FOLDER = "fine"
"""Where the suite's results with fine meshes are, in the folder of the others."""


def suite_python() -> Path:
    """Interpreter that has the suite, its solvers, cayley and the adapter."""
    wanted = ["-r", str(HERE / "peers" / "suite.txt")]
    ours = [["-e", str(ROOT)], ["-e", str(ADAPTER)]]
    return environment("COSSERATBENCH_PYTHON", VENV, wanted, *ours, what="cosseratbench")


def run(python: Path, experiments: list[str], solvers: list[str], out: Path, options: list[str]) -> None:
    """Let the suite run; what it has saved and still stands for the code is not run again, unless forced."""
    out.mkdir(parents=True, exist_ok=True)
    command = [str(python.parent / "cosseratbench"), "run", *experiments, "--out", str(out.resolve())]
    done = subprocess.run(
        [*command, *_repeated("--solver", solvers), *options], cwd=out, check=False
    )  # logs stay there
    if done.returncode:
        print("the suite reports runs that crashed; they have no row in the tables")


def run_fine(python: Path, experiments: list[str], vary: list[str], out: Path, options: list[str]) -> None:
    """Let the suite run cayley with the fine meshes."""
    for experiment, (elements, parameters) in FINE.items():
        if experiment in experiments:
            wanted = [name for name in parameters if name in vary or "all" in vary]
            more = ["--n-elements", str(elements), *_repeated("--vary", wanted), *options]
            run(python, [experiment], ["cayley"], out / FOLDER, more)


def _repeated(option: str, values: list[str]) -> list[str]:
    return [word for value in values for word in (option, value)]


def collect(out: Path, experiments: list[str], solvers: list[str]) -> list[dict[str, Any]]:
    """Rows of all result files, the ordinary case of an experiment before its variants.

    Behind those of a variant stands what cayley has with a fine mesh.
    """
    found = []
    for experiment in experiments:
        for folder in sorted((out / experiment).glob("*"), key=lambda path: (path.name != "default", path.name)):
            for solver in solvers:
                found += row(folder / solver / "result.json", experiment, folder.name, solver)
            fine = out / FOLDER / experiment / folder.name / "cayley" / "result.json"
            found += row(fine, experiment, folder.name, suite.FINE)
    return found


def row(path: Path, experiment: str, variant: str, solver: str) -> list[dict[str, Any]]:
    """What is kept of a result file, if it is there."""
    if not path.exists():
        return []
    told = json.loads(path.read_text())
    return [{"experiment": experiment, "variant": variant, "solver": solver} | {name: told[name] for name in KEPT}]


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
    force = ["--force"] if given.force else []
    if not given.collect:
        run(python, experiments, solvers, given.runs, [*_repeated("--vary", given.vary), *force])
        if "cayley" in solvers:
            run_fine(python, experiments, given.vary, given.runs, force)
    rows = collect(given.runs, list(EXPERIMENTS), list(SOLVERS))
    if not rows:
        skip(f"no results of the suite in {given.runs}")
    programs = versions(python, "cosseratbench", "pyelastica", "mujoco", "numpy", "numba")
    write("cosseratbench", {"programs": programs, "rows": rows}, to=given.results)


if __name__ == "__main__":
    main()
