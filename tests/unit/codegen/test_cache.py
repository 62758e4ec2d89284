"""Machine code on disk: found again, never trusted when broken, never in the way."""

import ctypes
import shutil
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from cayley.codegen import jit, kernels
from cayley.codegen.kernels import Kernels, sources_digest
from cayley.codegen.llvm import print_ir
from cayley.density import trace
from cayley.discrete.equations import derive
from cayley.discrete.rules import nodal, verlet
from unit.codegen.machine import blocks_of, program_of, row_of
from unit.density.examples import EXAMPLES

NAMES = ("made", "made_setup", "made_width")


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("CAYLEY_CACHE_DIR", str(tmp_path / "kernels"))
    monkeypatch.setattr(kernels, "_LOADED", {})
    return tmp_path / "kernels"


def ir(factor: float = 2.0) -> str:
    """The code of y = factor x."""
    x = ca.SX.sym("x")
    return print_ir(program_of([], [factor * x * x], lanes=[x]), 2)


def result(addresses: tuple[int, ...]) -> list[float]:
    """Run the code on 1, 2, 3."""
    data = blocks_of([np.array([1.0, 2.0, 3.0])], 2, 2)
    integer, pointer = ctypes.c_int64, ctypes.c_void_p
    ctypes.CFUNCTYPE(integer, pointer, pointer, integer, integer)(addresses[0])(
        data.ctypes.data, data.ctypes.data, 1, 3
    )
    return row_of(data, 1, 3).tolist()


def never() -> str:
    raise AssertionError("compiled although the cache has it")


def test_second_load_comes_from_the_cache(folder):
    addresses, cached = jit.load(NAMES, ir, "key")
    assert not cached
    assert result(addresses) == [2.0, 8.0, 18.0]
    again, cached = jit.load(NAMES, never, "key")
    assert cached
    assert result(again) == [2.0, 8.0, 18.0]
    assert [p.suffix for p in folder.iterdir()] == [".o"]  # nothing temporary is left


def test_another_key_or_name_is_another_entry(folder):
    jit.load(NAMES, ir, "key")
    assert not jit.load(NAMES, ir, "other")[1]
    assert not jit.load(NAMES[:1], ir, "key")[1]
    assert len(list(folder.iterdir())) == 3


def damaged(content: bytes) -> dict[str, bytes]:
    flipped = bytearray(content)
    flipped[len(content) // 2] ^= 1
    return {
        "flipped bit": bytes(flipped),
        "truncated": content[:-7],
        "header only": content[: len(jit.HEADER)],
        "empty": b"",
        "longer": content + b"\0",
        "text": b"not machine code",
        "older version": content.replace(jit.HEADER, b"cayley object 0\n"),
        "bare object": content[len(jit.HEADER) + 32 :],
    }


@pytest.mark.parametrize("kind", damaged(bytes(200)))
def test_damaged_entry_is_rebuilt(folder, kind):
    jit.load(NAMES, ir, "key")
    (path,) = folder.iterdir()
    content = path.read_bytes()
    path.write_bytes(damaged(content)[kind])
    addresses, cached = jit.load(NAMES, ir, "key")
    assert not cached
    assert result(addresses) == [2.0, 8.0, 18.0]
    assert path.read_bytes() == content
    assert jit.load(NAMES, never, "key")[1]


def test_foreign_entry_is_rebuilt(folder):
    jit.load(NAMES, ir, "key")
    (path,) = folder.iterdir()
    jit.load(NAMES, lambda: ir(5.0), "other")
    (other,) = (p for p in folder.iterdir() if p != path)
    shutil.copy(other, path)
    addresses, cached = jit.load(NAMES, ir, "key")
    assert not cached
    assert result(addresses) == [2.0, 8.0, 18.0]


def test_unwritable_folder_only_costs_time(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("CAYLEY_CACHE_DIR", str(tmp_path / "file" / "kernels"))
    for _ in range(2):
        addresses, cached = jit.load(NAMES, ir, "key")
        assert not cached
        assert result(addresses) == [2.0, 8.0, 18.0]


def test_folder_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("CAYLEY_CACHE_DIR", str(tmp_path))
    assert jit.cache_directory() == tmp_path
    monkeypatch.delenv("CAYLEY_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert jit.cache_directory() == tmp_path / "xdg" / "cayley"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert jit.cache_directory() == tmp_path / "home" / ".cache" / "cayley"


def compiled(lanes: int = 2, rule=verlet, rotation: str = "quaternion", varying=(), **constants) -> None:
    """Ask for the kick kernel of the rod."""
    density = trace(EXAMPLES["rod"].lagrangian, EXAMPLES["rod"].constants | constants)
    assert Kernels(derive(density, rule, rotation=rotation, varying=varying), lanes)["kick"].run > 0


def test_entries_of_kernels(folder, monkeypatch):
    """New numbers need no new code; another rule, form, pattern, width or other sources do."""
    compiled()
    for same in ({}, {"mass": 3.0}, {"stiffness": 7.0 * EXAMPLES["rod"].constants["stiffness"]}):
        compiled(**same)
        assert len(list(folder.iterdir())) == 1
    changes = [
        {"lanes": 4},
        {"rule": nodal},
        {"rotation": "matrix"},
        {"varying": ["c.mass"]},
        {"stiffness": np.eye(6)},
        {"gravity": np.array([0.0, 0.0, 1.0])},
    ]
    for count, change in enumerate(changes, start=2):
        compiled(**change)
        assert len(list(folder.iterdir())) == count
    monkeypatch.setattr(kernels, "sources_digest", lambda: "other sources")
    kernels._LOADED.clear()  # the sources of a process do not change
    compiled()
    assert len(list(folder.iterdir())) == len(changes) + 2


def test_a_process_loads_a_kernel_once(folder):
    """Made again with other numbers, equations find what was derived and loaded."""
    compiled()
    shutil.rmtree(folder)
    compiled(mass=3.0)
    assert not folder.exists()


@pytest.mark.parametrize("changed", ["lie/series.py", "density/trace.py", "discrete/solve.py", "codegen/operations.py"])
def test_key_changes_with_the_sources(tmp_path, monkeypatch, changed):
    root = Path(kernels.__file__).parents[1]
    for layer in ("lie", "density", "discrete", "codegen"):
        shutil.copytree(root / layer, tmp_path / layer, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(kernels, "__file__", str(tmp_path / "codegen" / "kernels.py"))
    assert sources_digest.__wrapped__() == sources_digest()
    with (tmp_path / changed).open("a") as file:
        file.write("# a change\n")
    assert sources_digest.__wrapped__() != sources_digest()
