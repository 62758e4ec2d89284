"""Runs on disk: one Zarr store, format 3, that holds a result and all it takes to go on from it.

    /                    attributes: format, version, rule, fields, model, ...
    /time, /step, /kinetic_energy, /strain_energy, /load_energy                     (time)
    /work                of loads and forces, and loss, where accounted for         (time, cell, account)
    /reactions           of joints on their first nodes                             (time, joint, component)
    /held                nodes that supports hold                                   (support)
    /supports            what supports exert on these                               (time, support, component)
    /nodes               coordinates along the interval                             (node)
    /fields/NAME/value, momentum, velocity, and on an interval slope, resultant     (time, node, component)
    /loads/K/value       of each load of the model that is a function of time       (time, axis)
    /motions/NAME/QUANTITY  of each joint that a function of time moves             (time, axis)

Dimensions are named and units given, so that xarray opens any group without this library:
``xarray.open_zarr(path, group="fields/x", consolidated=False)``.
"""

import json
import os
import shutil
import uuid
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from cayley import __version__
from cayley.density import Rotation, Vector
from cayley.discrete.layout import Layout
from cayley.discrete.representation import REPRESENTATIONS
from cayley.model import Model
from cayley.model.loads import LineLoad, PointLoad
from cayley.model.rod_loads import KINDS
from cayley.results.frames import Frames
from cayley.results.observe import Observations
from cayley.results.outline import Outline
from cayley.results.record import model_from, model_record
from cayley.results.sampled import Sampled
from cayley.results.tie_record import driven_functions, recorded_functions
from cayley.results.trajectory import Trajectory

FORMAT = "cayley run"
VERSION = 1
CHUNK_BYTES = 2**20
"""Size of a chunk before compression; a chunk holds all nodes of some frames."""

_ENERGIES = {"kinetic": "kinetic_energy", "strain": "strain_energy", "load": "load_energy"}
_OTHER = {*_ENERGIES, "reactions", "held", "supports"}
_ON_INTERVAL = {"slope": "slopes", "resultant": "resultants"}
_UNITS = {  # of a rod; what the fields of a Lagrangian of one's own mean, its author knows
    "x": {"value": "m", "velocity": "m/s", "momentum": "kg m/s", "slope": "1", "resultant": "N"},
    "p": {"value": "1", "velocity": "rad/s", "momentum": "kg m^2/s", "slope": "1/m", "resultant": "N m"},
}


def save(trajectory: Trajectory, path: str | Path, *, overwrite: bool = False) -> None:
    """Write a run to a store; it appears at its path when it is complete.

    Args:
        trajectory: the run.
        path: the store, a directory to be made.
        overwrite: replace a run that is there.

    Raises:
        FileExistsError: if something is there; with overwrite, something that is no run.
    """
    target = Path(path)
    if target.exists() and not overwrite:
        raise FileExistsError(f"{target} is there already; give another path, or overwrite=True to replace it")
    if target.exists() and _attributes(target).get("format") != FORMAT:
        raise FileExistsError(f"{target} is no run of cayley, so it is not overwritten; remove it or give another path")
    target.parent.mkdir(parents=True, exist_ok=True)
    fresh, old = (target.with_name(f".{target.name}.{uuid.uuid4().hex}.{word}") for word in ("new", "old"))
    try:
        _write(trajectory, fresh)
        if target.exists():
            os.replace(target, old)
        os.replace(fresh, target)
    finally:
        shutil.rmtree(fresh, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)


def open_run(path: str | Path, *, model: Model | None = None) -> Trajectory:
    """Read a run from a store.

    Args:
        path: the store.
        model: the model that ran, if it is at hand, to be taken for the one in the store.

    Returns: the Trajectory, its numbers bit for bit those that were saved.

    Raises:
        FileNotFoundError: if there is nothing.
        ValueError: if it is no run, of a newer format or damaged, or the model is not the one that ran.
    """
    import zarr

    source = Path(path)
    if not source.exists():
        raise FileNotFoundError(f"there is no run at {source}")
    about = _attributes(source)
    if about.get("format") != FORMAT:
        raise ValueError(f"{source} is no run of cayley; give a directory that Trajectory.save wrote")
    with _damage_told(source):
        if int(about["version"]) > VERSION:
            raise _Foreign(
                f"{source} has format {about['version']}, and this is cayley {__version__}, which reads formats up to "
                f"{VERSION}; open it with a newer cayley (it was written by {about.get('cayley', 'an unknown one')})"
            )
        root = zarr.open_group(source, mode="r", use_consolidated=False)
        frames, outline, observed = _read(root, about)
        found = _model(root, about["model"], frames.times)
        if model is not None and (found is None or model_record(model) != about["model"]):
            raise _Foreign(f"{source}: the model given is not the one that ran; leave it out to take the one stored")
        parts = {name: slice(first, stop) for name, (first, stop) in about["parts"].items()}
        return Trajectory(
            frames=frames, outline=outline, observed=observed, info=about["info"], model=model or found, parts=parts
        )


def _write(run: Trajectory, path: Path) -> None:
    """Write a whole store."""
    import zarr

    layout, frames, observed = run.outline.layout, run.frames, run.observed
    about = {
        "format": FORMAT,
        "version": VERSION,
        "cayley": __version__,
        "rule": run.rule,
        "dt": frames.h,
        "origin": frames.origin,
        "fields": [[n, "rotation" if n in layout.rotations else kind.size] for n, kind in layout.fields.items()],
        "rotation": layout.representation.name,
        "interval": run.outline.interval,
        "parts": {name: [nodes.start, nodes.stop] for name, nodes in run._parts.items()},
        "info": json.loads(json.dumps(run.info, default=float)),
        "model": None if run.model is None else model_record(run.model),
    }
    root = zarr.create_group(path, zarr_format=3, attributes=about)
    times = {"time": ("s", frames.times)}
    _put(root, times | {"step": ("1", frames.steps)}, ("time",))
    _put(root, {name: ("J", getattr(observed, key)) for key, name in _ENERGIES.items()}, ("time",))
    _put(root, {"nodes": ("m", run.outline.nodes)}, ("node",))
    if frames.memory is not None:
        _put(root, {"memory": (None, frames.memory)}, ("node", "control", "row")[: frames.memory.ndim])
    if observed.reactions is not None:
        _put(root, {"reactions": (None, observed.reactions)}, ("time", "joint", "component"))
    if observed.held is not None and observed.supports is not None:
        _put(root, {"held": (None, observed.held)}, ("support",))
        _put(root, {"supports": (None, observed.supports)}, ("time", "support", "component"))
    if frames.work is not None:
        _put(root, {"work": ("J", frames.work)}, ("time", "cell", "account"))
    for name in layout.fields:
        group = root.create_group(f"fields/{name}")
        _put(group, times, ("time",))
        if run.outline.interval is not None:
            _put(group, {run.outline.interval: ("m", run.outline.nodes)}, ("node",))
        units = _UNITS[name] if run.model is not None else {}
        for key, values in _of_field(run.outline, name, frames, observed).items():
            turns = key == "value" and name in layout.rotations
            component = {4: "wxyz", 9: "entry"}[layout.representation.rows] if turns else "axis"
            _put(group, {key: (units.get(key), values)}, ("time", "node", component), along=run.outline.interval)
    for k, load in enumerate(run.model.loads if run.model is not None else ()):
        if isinstance(load, PointLoad | LineLoad) and callable(load.value):
            group = root.create_group(f"loads/{k}")
            table = np.array([load.at(float(t)) for t in frames.times])
            _put(group, times, ("time",))
            _put(group, {"value": (load.unit, table)}, ("time", "axis"))
    for name, quantity, joint in driven_functions(run.model) if run.model is not None else ():
        group = root.require_group(f"motions/{name}")
        table = joint.motion(quantity, frames.times)
        _put(group, {quantity: ("m" if quantity in ("displacement", "position") else "rad", table)}, ("time", "axis"))


def _of_field(outline: Outline, name: str, frames: Frames, observed: Observations) -> dict[str, np.ndarray]:
    """Parts of the arrays of frames and observations that belong to a field, shape (m, nodes, components) each."""
    rows, dofs = outline.layout.rows_of(name), outline.layout.dofs_of(name)
    found = {
        "value": frames.values[..., rows],
        "momentum": frames.momenta[..., dofs],
        "velocity": observed.velocity[..., dofs],
    }
    along = _ON_INTERVAL if outline.interval is not None else {}
    return found | {key: getattr(observed, own)[..., dofs] for key, own in along.items()}


def _put(
    group: Any, arrays: Mapping[str, tuple[str | None, np.ndarray]], dims: tuple[str, ...], *, along: str | None = None
) -> None:
    """Write arrays, cut into chunks in time, with a checksum each."""
    from zarr.codecs import ZstdCodec

    for name, (unit, values) in arrays.items():
        frame = max(1, values[:1].nbytes)
        attributes = ({"units": unit} if unit else {}) | ({"coordinates": along} if along else {})
        group.create_array(
            name,
            data=np.ascontiguousarray(values),
            chunks=(min(len(values), max(1, CHUNK_BYTES // frame)), *values.shape[1:]),
            dimension_names=dims,
            attributes=attributes,
            compressors=ZstdCodec(level=3, checksum=True),
            config={"write_empty_chunks": True},  # so that a chunk that is not there is one that was lost
        )


def _read(root: Any, about: Mapping[str, Any]) -> tuple[Frames, Outline, Observations]:
    """Read what _write wrote."""
    kinds = {name: Rotation() if kind == "rotation" else Vector(kind) for name, kind in about["fields"]}
    layout = Layout(kinds, REPRESENTATIONS[about["rotation"]])
    nodes = _get(root, "nodes", np.shape(root["nodes"]))
    outline = Outline(layout=layout, rule=str(about["rule"]), interval=about["interval"], nodes=nodes)
    times = _get(root, "time", np.shape(root["time"]))
    count = (len(times), len(nodes))
    frames = Frames(
        times=times,
        steps=_get(root, "step", times.shape, kind=np.int64),
        values=np.empty((*count, layout.rows)),
        momenta=np.empty((*count, layout.dofs)),
        origin=float(about["origin"]),
        h=float(about["dt"]),
        memory=_optional(root, "memory"),
        work=_optional(root, "work"),
    )
    arrays = {f.name: np.zeros((*count, layout.dofs)) for f in fields(Observations) if f.name not in _OTHER}
    energies = {key: _get(root, name, times.shape) for key, name in _ENERGIES.items()}
    held = _get(root, "held", root["held"].shape, kind=np.int64) if "held" in root else None
    reactions, supports = (_optional(root, name) for name in ("reactions", "supports"))
    observed = Observations(**arrays, **energies, reactions=reactions, held=held, supports=supports)
    for name in layout.fields:
        for key, part in _of_field(outline, name, frames, observed).items():
            part[:] = _get(root, f"fields/{name}/{key}", part.shape)  # a view into one of the arrays above
    return frames, outline, observed


def _optional(root: Any, name: str) -> np.ndarray | None:
    """What only some runs have: what an implicit rule remembered of its last step, work and loss."""
    return _get(root, name, root[name].shape) if name in root else None


def _get(root: Any, name: str, shape: tuple[int, ...], *, kind: type = np.float64) -> np.ndarray:
    """Read an array of known shape, whole."""
    array = root[name]
    if array.shape != shape or array.nchunks_initialized != array.nchunks:
        raise ValueError(f"{name} is not complete")
    return np.array(array[...], dtype=kind)


def _model(root: Any, record: Mapping[str, Any] | None, times: np.ndarray) -> Model | None:
    """The model in a store; loads and motions that were functions are tables."""
    if record is None:
        return None
    functions: list[Sampled | None] = []
    for k, load in enumerate(record["loads"]):
        timed = isinstance(load.get("value"), Mapping) and load["kind"] not in KINDS
        table = _get(root, f"loads/{k}/value", (len(times), 3)) if timed else None
        functions.append(None if table is None else Sampled(load["value"]["function"], times, table))
    motions: dict[str, Sampled] = {}
    for name, quantity, function in recorded_functions(record):
        array = root[f"motions/{name}/{quantity}"]
        values = _get(root, f"motions/{name}/{quantity}", (len(times), array.shape[1]))
        motions[f"{name}/{quantity}"] = Sampled(function, times, values, quantity)
    return model_from(record, functions, motions)


def _attributes(path: Path) -> Mapping[str, Any]:
    """Attributes of the group at a path; none where there is no group."""
    try:
        found = json.loads((path / "zarr.json").read_text(encoding="utf-8"))["attributes"]
    except (OSError, ValueError, KeyError, TypeError):
        return {}
    return found if isinstance(found, dict) else {}


class _Foreign(ValueError):
    """A store that is whole but not for us."""


@contextmanager
def _damage_told(path: Path) -> Iterator[None]:
    """Make one line of whatever goes wrong when a store is not as it was written."""
    try:
        yield
    except _Foreign as error:
        raise ValueError(str(error)) from None
    except Exception as error:  # what a missing file, a broken chunk or a changed word raises differs by place
        told = " ".join(f"{type(error).__name__}: {error}".split())
        raise ValueError(f"{path} is damaged and can't be opened ({told})") from error


__all__ = ["FORMAT", "VERSION", "open_run", "save"]
