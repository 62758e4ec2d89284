"""Runs on disk: one Zarr store, format 3, that holds a result and all it takes to go on from it.

A run in progress adds to its store (results.writer): states whole chunks at a time, the last frames in a journal beside
them, what is observed when it ends.

    /                    attributes: format, version, rule, fields, model, ...
    /time, /step, /kinetic_energy, /strain_energy, /load_energy                     (time)
    /work                of loads and forces, and loss, where accounted for         (time, cell, account)
    /rates               velocities by the last three steps, where there is damping (time, node, component)
    /reactions           of joints on their first nodes                             (time, joint, component)
    /held                nodes that supports hold                                   (support)
    /supports            what supports exert on these                               (time, support, component)
    /nodes               coordinates along the interval                             (node)
    /fields/NAME/value, momentum, velocity, and on an interval slope, resultant     (time, node, component)
    /loads/K/value       of each load of the model that is a function of time       (time, axis)
    /motions/NAME/QUANTITY  of each joint that a function of time moves             (time, axis)
    /checkpoint          attributes frames: how many are complete, chunk: after how many each chunk ends; step and
                         memory of implicit rules there
    .journal-K           frames behind those (results.journal)

Dimensions are named and units given, so that xarray opens any group without this library:
``xarray.open_zarr(path, group="fields/x", consolidated=False)``.
"""

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
from cayley.model.rod_loads import KINDS
from cayley.results.append import (
    ENERGIES,
    FORMAT,
    VERSION,
    about_run,
    append_frames,
    append_observed,
    attributes,
    check_replaceable,
    observed_of_field,
    plain,
)
from cayley.results.arrays import Arrays, chunk_frames
from cayley.results.known import Known, observed
from cayley.results.observe import Observations
from cayley.results.outline import Outline
from cayley.results.record import model_from, model_record
from cayley.results.sampled import Sampled
from cayley.results.tie_record import recorded_functions
from cayley.results.trajectory import Trajectory

_OTHER = {*ENERGIES, "reactions", "held", "supports"}


def save(trajectory: Trajectory, path: str | Path, *, overwrite: bool = False) -> None:
    """Write a run to a store; it appears at its path when it is complete.

    Args:
        trajectory: the run.
        path: the store, a directory to be made.
        overwrite: replace a run that is there.

    Raises:
        FileExistsError: if something is there; with overwrite, something that is no run.
    """
    if trajectory.only is not None:
        raise ValueError("the run saved some nodes only (save_only), and is in its store already; copy that")
    target = Path(path)
    if target.exists():
        check_replaceable(target, overwrite=overwrite)
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
    about = attributes(source)
    if about.get("format") != FORMAT:
        raise ValueError(f"{source} is no run of cayley; give a directory that Trajectory.save wrote")
    with _damage_told(source):
        if int(about["version"]) > VERSION:
            raise _Foreign(
                f"{source} has format {about['version']}, and this is cayley {__version__}, which reads formats up to "
                f"{VERSION}; open it with a newer cayley (it was written by {about.get('cayley', 'an unknown one')})"
            )
        root = zarr.open_group(source, mode="r", use_consolidated=False)
        outline = outline_of(root, about)
        known = Known.of(source, root, about, outline)
        frames = known.frames
        count = len(frames.times) if known.late is None else known.stored  # those behind are observed when asked for
        seen, damage = (
            _observed(root, outline, count, known.damage, about["model"] is not None) if count else (None, "")
        )
        if model is None:
            model = _model(root, about["model"], frames.times[: known.stored])
        elif model_record(model) != about["model"]:
            raise _Foreign(f"{source}: the model given is not the one that ran; leave it out to take the one stored")
        parts = {name: slice(first, stop) for name, (first, stop) in about["parts"].items()}
        info = about["info"] | ({"damage": damage} if damage else {})
        only = None if about.get("only") is None else np.array(about["only"])
        told: dict[str, Any] = {"model": model, "parts": parts, "only": only}
        run = Trajectory(frames=frames, outline=outline, observed=None if known.late else seen, info=info, **told)
        run.seen, run.late, run.memories = seen, known.late, known.memories
        run.path = source
        return run


def _write(run: Trajectory, path: Path) -> None:
    """Write a whole store."""
    import zarr

    about = about_run(run.outline, run.spans, run.model, run.frames.h, run.frames.origin) | {"info": plain(run.info)}
    root = zarr.create_group(path, zarr_format=3, attributes=about)
    arrays = Arrays(root, chunk_frames(run.outline.layout, len(run.outline.nodes), len(run.time)))
    arrays.put("", {"nodes": ("m", run.outline.nodes)}, ("node",))
    append_frames(arrays, run.outline, run.frames, run.model)
    append_observed(arrays, run.outline, run.observed)
    if run.frames.memory is not None:
        memory = run.frames.memory
        arrays.put("", {"memory": (None, memory)}, ("node", "control", "row")[: memory.ndim])


def outline_of(root: Any, about: Mapping[str, Any]) -> Outline:
    """The outline of the system that ran."""
    kinds = {name: Rotation() if kind == "rotation" else Vector(kind) for name, kind in about["fields"]}
    layout = Layout(kinds, REPRESENTATIONS[about["rotation"]])
    nodes = _get(root, "nodes", np.shape(root["nodes"]))
    return Outline(layout=layout, rule=str(about["rule"]), interval=about["interval"], nodes=nodes)


def _observed(
    root: Any, outline: Outline, count: int, damage: str, recomputable: bool
) -> tuple[Observations | None, str]:
    """What was observed, or nothing where it is not there yet or damaged but can be observed again; and the damage."""
    if observed(root) < count:
        return None, damage
    try:
        return _read_observed(root, outline, count), damage
    except Exception as error:
        if not recomputable:
            raise
        return None, damage or f"of what was observed something is lost and is observed again ({error})"


def _read_observed(root: Any, outline: Outline, count: int) -> Observations:
    """Everything observed of the first frames."""
    shape = (count, len(outline.nodes), outline.layout.dofs)
    arrays = {f.name: np.zeros(shape) for f in fields(Observations) if f.name not in _OTHER}
    energies = {key: _get(root, name, (count,)) for key, name in ENERGIES.items()}
    held = _get(root, "held", root["held"].shape, kind=np.int64) if "held" in root else None
    reactions, supports = (_optional(root, name, count) for name in ("reactions", "supports"))
    found = Observations(**arrays, **energies, reactions=reactions, held=held, supports=supports)
    for name in outline.layout.fields:
        for key, part in observed_of_field(outline, name, found).items():
            part[:] = _get(root, f"fields/{name}/{key}", part.shape)  # a view into one of the arrays above
    return found


def _optional(root: Any, name: str, count: int) -> np.ndarray | None:
    """What only some runs have, of the first frames."""
    return _get(root, name, (count, *root[name].shape[1:])) if name in root else None


def _get(root: Any, name: str, shape: tuple[int, ...], *, kind: type = np.float64) -> np.ndarray:
    """Read the first entries of an array, all of which must be there."""
    array = root[name]
    complete = array.nchunks_initialized == array.nchunks
    if array.shape[1:] != shape[1:] or array.shape[0] < shape[0] or not complete:
        raise ValueError(f"{name} is not complete")
    return np.array(array[: shape[0]], dtype=kind)


def _model(root: Any, record: Mapping[str, Any] | None, times: np.ndarray) -> Model | None:
    """The model in a store; loads and motions that were functions are tables, of the frames in arrays."""
    if record is None:
        return None
    functions: list[Sampled | None] = []
    for k, load in enumerate(record["loads"]):
        timed = isinstance(load.get("value"), Mapping) and load["kind"] not in KINDS
        table = _table(root, f"loads/{k}/value", len(times)) if timed else None
        functions.append(None if table is None else Sampled(load["value"]["function"], times, table))
    motions: dict[str, Sampled] = {}
    for name, quantity, function in recorded_functions(record):
        values = _table(root, f"motions/{name}/{quantity}", len(times))
        motions[f"{name}/{quantity}"] = Sampled(function, times, values, quantity)
    return model_from(record, functions, motions)


def _table(root: Any, name: str, count: int) -> np.ndarray:
    """Values of a function of time at the first frames; a run that has only begun has none, and no array for them."""
    return _get(root, name, (count, *root[name].shape[1:])) if count else np.zeros((0, 3))


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
