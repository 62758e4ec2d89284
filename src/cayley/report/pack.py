"""Scenes as text and bytes for the player: what does not change as JSON, frames as compressed arrays.

A chunk of frames is, compressed by gzip,

    4 bytes    length of the header, little-endian
    header     JSON: {"frames": m, "channels": [[kind, scale], ...]}, padded with spaces to 8 bytes
    channels   one after another, each padded to 8 bytes

A channel has m rows of the numbers of one frame. Kind "i2" are whole numbers from -32767 to 32767, times the scale,
each as the difference from the frame before modulo 2^16; its low bytes come first, then its high bytes, for so they
are compressed best. Kinds "f4" and "f8" are floating-point numbers, their first bytes first, then their second ones.
The order of channels is that of `channels` below and of `channels` in web/data.js.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from cayley.report.conserved import Array
from cayley.report.mesh import ring
from cayley.report.scene import Flat, Place, Scene, Skin, Strand

_LEVEL = 6  # of gzip: higher ones take three times as long and save one percent
_LARGEST = 32767


def described(scene: Scene) -> dict[str, Any]:
    """What does not change with the frames, ready for JSON."""
    return {
        "name": scene.name,
        "note": scene.note,
        "up": list(scene.up),
        "shade": scene.shade,
        "period": scene.period,
        "parts": [_strand(part) if isinstance(part, Strand) else _block(part) for part in scene.parts],
        "marks": [{"kind": mark.kind, "name": mark.name, "place": _place(mark.place)} for mark in scene.marks],
        "links": [
            {"name": link.name, "first": _place(link.first), "second": _place(link.second)} for link in scene.links
        ],
        "solids": [_skin(solid) if isinstance(solid, Skin) else _flat(solid) for solid in scene.solids],
        "graphs": [{"title": graph.title, "unit": graph.unit, "names": graph.names} for graph in scene.graphs],
    }


def chunk(scene: Scene, first: int = 0, stop: int | None = None) -> bytes:
    """Frames of a scene from `first` to before `stop`, compressed."""
    own = slice(first, stop)
    kinds, bodies = [], []
    for kind, values in channels(scene):
        scale, data = _encoded(kind, values[own])
        kinds.append([kind, scale])
        bodies.append(data + bytes(-len(data) % 8))
    header = json.dumps({"frames": len(scene.time[own]), "channels": kinds}).encode("ascii")
    header += b" " * (-(len(header) + 4) % 8)
    raw = len(header).to_bytes(4, "little") + header + b"".join(bodies)
    return gzip.compress(raw, _LEVEL, mtime=0)


def channels(scene: Scene) -> Iterator[tuple[str, Array]]:
    """Kinds and values of all that changes with the frames, in their order."""
    yield "f8", scene.time
    for part in scene.parts:
        yield "f4", part.position
        yield "i2", part.rotation
        for quantity in part.quantities.values():
            yield "i2", quantity.values
    for graph in scene.graphs:
        yield "f8", graph.values


def _encoded(kind: str, values: Array) -> tuple[float, bytes]:
    """Scale and bytes of a channel."""
    flat = np.ascontiguousarray(values, dtype=float).reshape(len(values), -1)
    if kind != "i2":
        numbers, scale = flat.astype(f"<{kind}"), 1.0
    else:
        flat = np.nan_to_num(flat, nan=0.0, posinf=0.0, neginf=0.0)
        scale = float(np.abs(flat).max(initial=0.0)) / _LARGEST or 1.0
        whole = np.rint(flat / scale).astype(np.int64)
        numbers = np.diff(whole, axis=0, prepend=0).astype("<i2")  # modulo 2^16: differences reach beyond it
    planes = numbers.reshape(-1, 1).view(np.uint8).reshape(numbers.size, -1).T
    return scale, planes.tobytes()


def _strand(part: Strand) -> dict[str, Any]:
    around = ring(part.outlines)
    return {
        "kind": "strand",
        "name": part.name,
        "nodes": part.position.shape[1],
        "s": _rounded(part.s),
        "outlines": _rounded(part.outlines),
        "points": around.points,
        "normals": _rounded(around.normals, 4),
        "caps": around.caps,
        "quantities": _quantities(part),
    }


def _block(part: Any) -> dict[str, Any]:
    return {
        "kind": "block",
        "name": part.name,
        "nodes": 1,
        "sides": None if part.sides is None else _rounded(part.sides),
        "turn": list(part.turn),
        "shaped": part.shaped,
        "ports": {name: list(shift) for name, shift in part.ports.items()},
        "quantities": _quantities(part),
    }


def _skin(solid: Skin) -> dict[str, Any]:
    return {
        "kind": "skin",
        "name": solid.name,
        "part": solid.part,
        "vertices": _rounded(solid.vertices.reshape(-1)),
        "triangles": solid.triangles.reshape(-1).tolist(),
        "sheer": solid.sheer,
    }


def _flat(solid: Flat) -> dict[str, Any]:
    return {
        "kind": "flat",
        "name": solid.name,
        "part": solid.part,
        "point": list(solid.point),
        "normal": list(solid.normal),
    }


def _quantities(part: Any) -> list[dict[str, Any]]:
    return [
        {
            "key": key,
            "label": quantity.label,
            "unit": quantity.unit,
            "axes": list(quantity.axes) if quantity.values.ndim == 3 else None,
        }
        for key, quantity in part.quantities.items()
    ]


def _place(place: Place) -> dict[str, Any]:
    return {"part": place.part, "node": place.node, "shift": list(place.shift)}


def _rounded(values: Array, digits: int = 6) -> Any:
    """Nested lists of numbers with a few significant digits, which JSON writes short."""
    if np.ndim(values) == 0:
        return float(f"{float(values):.{digits}g}")
    return [_rounded(value, digits) for value in values]
