"""Compiled steppers know what they were compiled from."""

import ctypes
import shutil

import pytest

from cayley.codegen import jit
from cayley.steppers import native
from cayley.steppers.native.fingerprint import fingerprint


@pytest.mark.parametrize("pose", [False, True])
@pytest.mark.parametrize("lanes", [n for n in (2, 4, 8) if n <= jit.lanes()])
def test_libraries_are_of_the_sources_beside_them(lanes, pose):
    assert native._sources_of(native.library(lanes, pose=pose)) == fingerprint(native.HERE)


def test_stale_library_is_told(tmp_path, monkeypatch):
    """One line that says what to do, before any call into the library."""
    for path in native.HERE.iterdir():
        if path.suffix in (".c", ".h", ".so"):
            shutil.copy(path, tmp_path)
    with (tmp_path / "terms.c").open("a") as file:
        file.write("/* changed */\n")
    monkeypatch.setattr(native, "HERE", tmp_path)
    monkeypatch.setattr(native, "_fingerprint", lambda: fingerprint(tmp_path))
    with pytest.raises(ImportError, match=r"^cayley: engine_2\.so is not compiled from .*; compile it again .*$"):
        native.library.__wrapped__(2)


def test_library_older_than_fingerprints_is_stale():
    assert native._sources_of(ctypes.CDLL(None)) == ""


def test_every_source_counts(tmp_path):
    (tmp_path / "a.c").write_text("int a;")
    found = {fingerprint(tmp_path)}
    (tmp_path / "b.h").write_text("")
    found.add(fingerprint(tmp_path))
    (tmp_path / "b.h").write_text("int b;")
    found.add(fingerprint(tmp_path))
    (tmp_path / "a.so").write_text("not a source")
    found.add(fingerprint(tmp_path))
    assert len(found) == 3
