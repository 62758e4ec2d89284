"""Build hook: compile the C sources of cayley.steppers.native, once for every vector width of the processor family.

As a script, and for an editable install, it compiles those libraries that are not of the present sources, or older than
this file.
The compiler is $CC, else the system's cc, else the one that comes as the package ziglang. docs/adr/0007 says why.
"""

import os
import platform
import runpy
import shlex
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

FOLDER = Path("src/cayley/steppers/native")
FLAGS = ("-O3", "-std=gnu11", "-fPIC", "-shared", "-ffp-contract=fast", "-fno-math-errno", "-Wall", "-Wextra")
LEVELS = {2: "x86-64", 4: "x86-64-v3", 8: "x86-64-v4"}
"""Doubles in a vector, and what a processor must be to have such vectors."""


class Engine(BuildHookInterface):
    """Compile before the files of a wheel or an editable install are collected."""

    def dependencies(self) -> list[str]:
        """Ask for a compiler where there is none."""
        return [] if _system_compiler() else ["ziglang>=0.14"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile and add the libraries to the wheel; an editable install keeps those that are up to date."""
        compile_engine(Path(self.root) / FOLDER, outdated=version == "editable")
        build_data["artifacts"].append(f"{FOLDER}/*.so")
        build_data["pure_python"] = False
        build_data["infer_tag"] = True


def compile_engine(folder: Path, *, outdated: bool = False) -> None:
    """Compile the sources in a folder to libraries beside them; outdated: only those that need it."""
    intel = platform.machine().lower() in ("x86_64", "amd64")
    cases = [(lanes, level, pose) for lanes, level in (LEVELS if intel else {2: ""}).items() for pose in (False, True)]
    sources = runpy.run_path(str(folder / "fingerprint.py"))["fingerprint"](folder)
    if outdated:
        cases = [case for case in cases if not _is_current(_library(folder, case[0], case[2]), sources)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda case: _compile(folder, sources, *case), cases))


def _library(folder: Path, lanes: int, pose: bool) -> Path:
    return folder / f"engine_{lanes}{'_pose' * pose}.so"


def _is_current(library: Path, sources: str) -> bool:
    """Whether a library is of these sources and not older than this file."""
    if not library.exists() or library.stat().st_mtime < Path(__file__).stat().st_mtime:
        return False
    return sources.encode() in library.read_bytes()


def _compile(folder: Path, sources: str, lanes: int, level: str, pose: bool) -> None:
    compiler = _system_compiler() or [sys.executable, "-m", "ziglang", "cc"]
    target = [f"-march={level.replace('-', '_') if 'ziglang' in compiler else level}"] if level else []
    target += ["-mprefer-vector-width=512"] if lanes == 8 else []
    defined = [f"-DLANES={lanes}", f'-DSOURCES="{sources}"', *(["-DPOSE"] if pose else [])]
    library, files = _library(folder, lanes, pose), [str(path) for path in sorted(folder.glob("*.c"))]
    made = library.with_suffix(".new")  # replaced as a whole: a process that runs keeps the old one
    subprocess.run([*compiler, *FLAGS, *target, *defined, "-o", str(made), *files, "-lm"], check=True)
    os.replace(made, library)


def _system_compiler() -> list[str] | None:
    if os.environ.get("CC"):
        return shlex.split(os.environ["CC"])
    return next(([found] for name in ("cc", "gcc", "clang") if (found := shutil.which(name))), None)


if __name__ == "__main__":
    compile_engine(Path(__file__).parent / FOLDER, outdated=True)
