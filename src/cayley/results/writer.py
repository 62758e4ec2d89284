"""A run that is written while it runs: whole chunks of frames into a Zarr store, the last ones into a journal."""

import os
import queue
import shutil
import threading
import uuid
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cayley.model import Model
from cayley.results.append import append_frames, append_observed, check_replaceable, plain
from cayley.results.arrays import Arrays, chunk_frames
from cayley.results.frames import Frames
from cayley.results.journal import FRAMES, MEMORY, Journal, remove_journals
from cayley.results.known import committed, observed
from cayley.results.observe import observe
from cayley.results.outline import Outline
from cayley.system.system import System

WAITING = 2
"""Chunks of frames that may wait to be written; a run that is quicker than the disk waits, too."""


class WriteError(OSError):
    """The disk does not take the frames; those before are in the store."""


class Writer:
    """Writes frames: each into a journal at once, whole chunks into arrays, in a thread of its own.

    A frame that was taken is out of reach of whatever kills the process. The arrays are complete again after every
    chunk: the attribute "frames" of the group "checkpoint" is written last, and then the journal of the chunk goes.
    """

    def __init__(
        self,
        path: Path,
        system: System,
        model: Model | None,
        h: float,
        origin: float,
        *,
        only: Sequence[int] | None = None,
    ) -> None:
        """Begin to write behind the frames that the arrays of a store have.

        Args:
            path: the store; it is there (see begin_store).
            system: the system.
            model: the model, if there is one.
            h: time step [s].
            origin: time of step 0 [s].
            only: nodes whose frames are kept, and observed at once; all without it.
        """
        import zarr

        outline = Outline.of(system)
        self.path, self.outline, self.model, self.h, self.origin = path, outline, model, h, origin
        self.system, self.only = system, None if only is None else np.asarray(only)
        self.root: Any = zarr.open_group(path, mode="r+", use_consolidated=False)
        self.done = committed(self.root)
        self.chunk = _chunk(self.root, outline)
        self._arrays = Arrays(self.root, self.chunk)
        self._taken = self.done
        self._first = self.done == 0  # call, to be handed over alone: the arrays are made while the run goes on
        self._pending: list[tuple[np.ndarray | None, ...]] = []
        self._memory: np.ndarray | None = None
        self._failed: Exception | None = None
        self._queue: queue.Queue[Any] = queue.Queue(WAITING)
        remove_journals(path)
        self._journal = Journal(path, 0)
        self._thread = threading.Thread(target=self._work, name="cayley writer", daemon=True)
        self._thread.start()

    @property
    def room(self) -> int:
        """Frames until the next chunk is full; blocks of frames end there, so that memory is known at its end."""
        return self.chunk - self._taken % self.chunk

    def add(
        self,
        steps: np.ndarray,
        values: np.ndarray,
        momenta: np.ndarray,
        *,
        work: np.ndarray | None,
        rates: np.ndarray | None,
        contact: np.ndarray | None,
        memory: np.ndarray | None,
    ) -> None:
        """Take frames, at most ``room``, and what is remembered at the last of them.

        Raises:
            WriteError: if they, or earlier ones, can't be written.
        """
        self._raise()
        try:
            more = [own for own in (work, rates, contact) if own is not None]
            self._journal.add(FRAMES, int(steps[-1]), [steps, values, momenta, *more], len(steps))
            if memory is not None:
                self._journal.add(MEMORY, int(steps[-1]), [memory])
        except OSError as error:
            self._failed = error
            self._raise()
        self._pending.append((steps, values, momenta, work, rates, contact))
        self._memory = memory
        self._taken += len(steps)
        if self._taken % self.chunk == 0 or (self._first and len(self._pending) > 1):
            self._first = False
            self._hand_over()
            self._journal = Journal(self.path, self._journal.number + 1)

    def close(self) -> None:
        """Write all that was taken, and end.

        Raises:
            WriteError: if it could not be written.
        """
        if self._failed is None and self._pending:
            self._hand_over()
        self._queue.put(None)
        self._thread.join()
        self._journal.close()
        self._raise()
        remove_journals(self.path)

    def _hand_over(self) -> None:
        """Give what is pending to the thread that writes arrays."""
        self._queue.put((self._pending, self._memory, self._journal))
        self._pending = []

    def _raise(self) -> None:
        if self._failed is not None:
            raise WriteError(
                f"{self.path} can't be written ({self._failed}); all but the last frames are there: make room and go "
                "on with `cayley resume` or Trajectory.resume"
            ) from self._failed

    def _work(self) -> None:
        while (item := self._queue.get()) is not None:
            if self._failed is not None:
                continue
            pending, memory, own = item
            try:
                self._flush(pending, memory)
                own.close(remove=True)
            except Exception as error:  # told by add and close, in the thread that runs
                self._failed = error

    def _flush(self, pending: Sequence[Any], memory: np.ndarray | None) -> None:
        """Write frames to the arrays, and then that they are there."""
        steps, values, momenta = (np.concatenate([block[k] for block in pending]) for k in range(3))
        works, rates, contact = ([block[k] for block in pending if block[k] is not None] for k in (3, 4, 5))
        frames = Frames(
            times=self.origin + steps * self.h,
            steps=steps,
            values=values,
            momenta=momenta,
            origin=self.origin,
            h=self.h,
            work=np.concatenate(works) if works else None,
            rates=np.concatenate(rates) if rates else None,
            contact=np.concatenate(contact) if contact else None,
        )
        known = frames if self.only is None else frames.at_nodes(self.only)
        append_frames(self._arrays, self.outline.at_nodes(self.only), known, self.model, self.done)
        if self.only is not None:
            seen = observe(self.system, frames).at_nodes(self.only)
            append_observed(self._arrays, self.outline.at_nodes(self.only), seen, self.done)
        group, found = self.root["checkpoint"], {} if memory is None else {"memory": memory}
        if self.only is not None:  # frames do not have all that it takes to go on
            found |= {"values": values[-1], "momenta": momenta[-1]}
            found |= {} if frames.work is None else {"work": frames.work[-1]}
        self._add_checkpoint(int(steps[-1]), found)
        self.done += len(steps)
        group.attrs.update({"frames": self.done} | ({} if self.only is None else {"observed": self.done}))

    def _add_checkpoint(self, step: int, found: dict[str, np.ndarray]) -> None:
        """Write what it takes to go on from a step; what is not known of one, such as its memory, is not a number."""
        if not found:
            return
        group = self.root["checkpoint"]
        start = group["step"].shape[0] if "step" in group else 0
        if start and "memory" in group and "memory" not in found:
            found = found | {"memory": np.full(group["memory"].shape[1], np.nan)}
        for name, numbers in found.items():
            row, known = numbers.reshape(1, -1), start
            if start and name not in group:
                row, known = np.concatenate([np.full((start, row.shape[1]), np.nan), row]), 0
            self._arrays.put("checkpoint", {name: (None, row)}, ("checkpoint", f"{name}_row"), start=known)
        self._arrays.put("checkpoint", {"step": ("1", np.array([step]))}, ("checkpoint",), start=start)


def begin_store(
    path: Path,
    outline: Outline,
    about: Mapping[str, Any],
    info: Mapping[str, Any],
    *,
    expected: int,
    only: Sequence[int] | None = None,
    overwrite: bool = False,
) -> None:
    """Make a store without frames.

    Args:
        path: of the store.
        outline: of the system.
        about: attributes, see about_run.
        info: facts of the run.
        expected: number of frames that are to come.
        only: nodes whose frames are kept; all without it.
        overwrite: replace a run that is there.

    Raises:
        FileExistsError: if something is there; with overwrite, something that is no run.
    """
    import zarr

    if path.exists():
        check_replaceable(path, overwrite=overwrite)
        old = path.with_name(f".{path.name}.{uuid.uuid4().hex}.old")
        os.replace(path, old)
        shutil.rmtree(old, ignore_errors=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    root = zarr.create_group(path, zarr_format=3, attributes=dict(about) | {"info": plain(info)})
    Arrays(root, 1).put("", {"nodes": ("m", outline.at_nodes(only).nodes)}, ("node",))
    chunk = chunk_frames(outline.layout, len(outline.nodes), expected)
    root.create_group("checkpoint", attributes={"frames": 0, "observed": 0, "chunk": chunk})


def add_info(path: Path, info: Mapping[str, Any]) -> None:
    """Write more facts of a run into its store."""
    import zarr

    root: Any = zarr.open_group(path, mode="r+", use_consolidated=False)
    root.attrs["info"] = plain(dict(root.attrs["info"]) | dict(info))


def rewind(path: Path, frames: Frames, outline: Outline, model: Model | None, count: int) -> None:
    """Make a store end at the first ``count`` of its frames, those of its journal among them."""
    import zarr

    root: Any = zarr.open_group(path, mode="r+", use_consolidated=False)
    if "checkpoint" not in root:
        root.create_group("checkpoint", attributes={"frames": committed(root), "observed": committed(root)})
    group, known = root["checkpoint"], committed(root)
    if count > known:
        append_frames(Arrays(root, _chunk(root, outline)), outline, frames.part(slice(known, count)), model, known)
    group.attrs["frames"] = count
    group.attrs["observed"] = min(count, int(group.attrs["observed"]))


def finish(path: Path, system: System, outline: Outline, info: Mapping[str, Any]) -> None:
    """Observe the frames of which nothing was observed yet, a chunk at a time, and write facts of the run."""
    import zarr

    root: Any = zarr.open_group(path, mode="r+", use_consolidated=False)
    layout, group, known = outline.layout, root["checkpoint"], committed(root)
    chunk, first = _chunk(root, outline), observed(root)
    arrays = Arrays(root, chunk)
    while first < known:
        some = slice(first, min((first // chunk + 1) * chunk, known))
        frames = Frames(
            times=np.asarray(root["time"][some]),
            steps=np.asarray(root["step"][some]),
            values=_fields(root, layout, "value", layout.rows, some),
            momenta=_fields(root, layout, "momentum", layout.dofs, some),
            origin=float(root.attrs["origin"]),
            h=float(root.attrs["dt"]),
            work=np.asarray(root["work"][some]) if "work" in root else None,
            rates=np.asarray(root["rates"][some]) if "rates" in root else None,
            contact=np.asarray(root["contact"][some]) if "contact" in root else None,
        )
        append_observed(arrays, outline, observe(system, frames), first)
        group.attrs["observed"] = first = some.stop
    before = dict(root.attrs["info"])
    spent = {"wall_time": float(before.get("wall_time", 0.0)) + float(info["wall_time"])}
    root.attrs["info"] = plain(before | dict(info) | spent)


def _chunk(root: Any, outline: Outline) -> int:
    """Frames after which chunks end; in a store that was not written by a Writer, as many as one would have taken."""
    group, known = root["checkpoint"], committed(root)
    return int(group.attrs.get("chunk", chunk_frames(outline.layout, len(outline.nodes), known)))


def _fields(root: Any, layout: Any, key: str, width: int, some: slice) -> np.ndarray:
    found = np.zeros((some.stop - some.start, root["nodes"].shape[0], width))
    for name in layout.fields:
        own = layout.rows_of(name) if key == "value" else layout.dofs_of(name)
        found[..., own] = root[f"fields/{name}/{key}"][some]
    return found
