"""The compiled steppers: C sources, built when the package is installed (docs/adr/0007), and how Python calls them."""

import ctypes
import functools
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cayley.steppers.native.fingerprint import fingerprint

HERE = Path(__file__).parent
_TYPES = {"i64": ctypes.c_int64, "double": ctypes.c_double}


@functools.cache
def library(lanes: int, *, pose: bool = False) -> Any:
    """The functions of engine.h for vectors of so many doubles; pose: for nodes of one rotation and one position.

    Raises:
        ImportError: if the package was installed without them, or they are not of the sources that stand beside them.
    """
    path = HERE / f"engine_{lanes}{'_pose' * pose}.so"
    if not path.exists():
        raise ImportError(
            f"cayley: {path.name} is missing; install cayley again (pip install --force-reinstall cayley)"
        )
    found = ctypes.CDLL(str(path))
    if _sources_of(found) != _fingerprint():
        raise ImportError(
            f"cayley: {path.name} is not compiled from the C sources beside it; compile it again (python "
            "hatch_build.py in a checkout, else pip install --force-reinstall cayley)"
        )
    for name in ("order_blocks", "matrix_size", "advance", "project", "factorize", "contact_count"):
        getattr(found, name).restype = ctypes.c_int64
    return found


def _sources_of(found: Any) -> str:
    """The fingerprint a library was compiled with; nothing of one that is older than fingerprints."""
    try:
        found.sources.restype = ctypes.c_char_p
    except AttributeError:
        return ""
    return str(found.sources().decode())


_fingerprint = functools.cache(functools.partial(fingerprint, HERE))


@functools.cache
def structure(name: str) -> type[ctypes.Structure]:
    """The struct of that name in engine.h, its pointers as addresses."""
    text = (HERE / "engine.h").read_text()
    body = re.search(rf"^struct {name} {{\n(.*?)^}};", text, re.MULTILINE | re.DOTALL)
    assert body is not None, name
    fields = []
    for line in re.sub(r"/\*.*?\*/", "", body[1], flags=re.DOTALL).splitlines():
        found = re.fullmatch(r"\s*(?:struct )?(\w+) (\*?)(\w+);\s*", line)
        if found:
            fields.append((found[3], ctypes.c_void_p if found[2] else _TYPES[found[1]]))
    return type(name, (ctypes.Structure,), {"_fields_": fields})


def fill(name: str, values: Mapping[str, Any]) -> Any:
    """A struct with all its fields: numbers, and arrays that the caller keeps alive.

    Raises:
        TypeError: if a field is missing, unknown, or an array of the wrong type.
    """
    kind = structure(name)
    fields = {field[0] for field in kind._fields_}
    if fields != set(values):
        raise TypeError(f"struct {name}: {sorted(fields ^ set(values))} are missing or unknown")
    made = kind()
    for field, value in values.items():
        if isinstance(value, np.ndarray):
            if value.dtype not in (np.float64, np.int64) or not value.flags.c_contiguous:
                raise TypeError(f"struct {name}: {field} is no contiguous array of 64-bit numbers")
            value = value.ctypes.data
        setattr(made, field, value)
    return made


def address(array: np.ndarray) -> ctypes.c_void_p:
    """Where an array begins."""
    return ctypes.c_void_p(array.ctypes.data)
