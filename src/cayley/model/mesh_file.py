"""Meshes from files, by meshio."""

from __future__ import annotations

from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from cayley.model.triangles import Ints
from cayley.model.validate import Array


def read(path: Any) -> tuple[Array, Ints]:
    """Vertices in the unit of the file, shape (n, 3), and triangles, shape (m, 3); quadrilaterals are cut in two.

    Triangles with a corner twice, which many programs write, are left out.

    Raises:
        ImportError: meshio is not installed.
        FileNotFoundError: there is no such file.
        ValueError: meshio cannot read it, or it has no triangles.
    """
    try:
        import meshio
    except ImportError as error:
        raise ImportError('Mesh.read needs meshio; pip install "cayley[export]"') from error

    if not Path(path).is_file():
        raise FileNotFoundError(f"Mesh.read: there is no file {str(path)!r}")
    told = StringIO()  # where it cannot read it prints, and ends the process
    try:
        with (
            redirect_stdout(told),
            redirect_stderr(told),
            np.errstate(over="ignore"),
        ):  # text of an STL file as a number
            found = meshio.read(path)
    except (SystemExit, Exception) as error:  # its readers raise whatever broken files lead to
        raise ValueError(
            f"Mesh.read: {str(path)!r} is no file of a mesh that can be read, such as STL, OBJ or PLY"
        ) from error
    quads = [block.data for block in found.cells if block.type == "quad"]
    corners = [block.data for block in found.cells if block.type == "triangle"]
    corners += [four[:, half] for four in quads for half in ([0, 1, 2], [0, 2, 3])]
    if not corners:
        raise ValueError(f"Mesh.read: {str(path)!r} has no triangles; write its surface to a file such as STL")
    triangles = np.concatenate(corners).astype(np.int64)
    a, b, c = triangles.T
    vertices = np.asarray(found.points, dtype=np.float64)
    return vertices, triangles[(a != b) & (b != c) & (c != a)]
