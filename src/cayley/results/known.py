"""What is whole in a store: states from its arrays and its journal, and the last frame from which a run can go on."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cayley.discrete.rules import by_name
from cayley.results import journal
from cayley.results.frames import Frames
from cayley.results.outline import Outline
from cayley.system.system import State


class DamageWarning(UserWarning):
    """A store is damaged: what is whole was opened, and the message says what is not."""


@dataclass(frozen=True, slots=True)
class Known:
    """Whole frames of a store.

    Args:
        frames: states, with what is remembered of the step before the last one, if that is known.
        stored: how many of them stand in arrays; others in the journal.
        memories: numbers of frames from which a run of an implicit rule goes on bit for bit, with their memory.
        damage: what is lost, in one line; or nothing.
        late: of a store with frames of some nodes, those of the journal with all nodes.
    """

    frames: Frames
    stored: int
    memories: Mapping[int, np.ndarray]
    damage: str
    late: Frames | None = None

    @classmethod
    def of(cls, source: Path, root: Any, about: Mapping[str, Any], outline: Outline) -> "Known":
        """Read a store, as far as it is whole.

        Raises:
            ValueError: if not even the first frame is.
        """
        layout, nodes = outline.layout, len(outline.nodes)
        wanted = committed(root)
        states = [f"fields/{name}/{key}" for name in layout.fields for key in ("value", "momentum")]
        names = ["time", "step", *states, *(name for name in ("work", "rates", "contact") if name in root)]
        read = {name: _prefix(source, root, name, wanted) for name in names if wanted}
        count = min((len(values) for values in read.values()), default=0)
        short = [name for name, values in read.items() if len(values) == count]
        damage = f"{short[0]} is whole for {count} of {wanted} frames only" if count < wanted else ""
        if count < wanted and not count:
            raise ValueError(damage)
        frames = Frames(
            times=read["time"][:count].astype(float) if wanted else np.zeros(0),
            steps=read["step"][:count].astype(np.int64) if wanted else np.zeros(0, dtype=np.int64),
            values=np.zeros((count, nodes, layout.rows)),
            momenta=np.zeros((count, nodes, layout.dofs)),
            origin=float(about["origin"]),
            h=float(about["dt"]),
            work=read["work"][:count] if "work" in read else None,
            rates=read["rates"][:count] if "rates" in read else None,
            contact=read["contact"][:count] if "contact" in read else None,
        )
        for name in layout.fields if wanted else ():
            frames.values[..., layout.rows_of(name)] = read[f"fields/{name}/value"][:count]
            frames.momenta[..., layout.dofs_of(name)] = read[f"fields/{name}/momentum"][:count]
        memories, late, only = _memories(root, frames.steps), None, about.get("only")
        if count == wanted:
            # of implicit rules one pair of work and loss, and rates behind it
            pairs = 1 if by_name(outline.rule).implicit else None
            size = int(about.get("size", nodes))
            touching = int(about.get("contact", 0))
            late, latest = _of_journal(frames, source, (size, layout.rows), (size, layout.dofs), (pairs, touching))
            memories |= latest
            if late is not None:
                frames = frames.then(late if only is None else late.at_nodes(np.asarray(only)))
        if not len(frames.times):
            raise ValueError("it has no frame")
        frames = replace(frames, memory=memories.get(len(frames.times) - 1))
        if damage:
            warnings.warn(f"{source} is damaged: {damage}; the whole ones were opened", DamageWarning, stacklevel=4)
        return cls(frames, count, memories, damage, None if only is None else late)


def whole_state(path: Path, about: Mapping[str, Any], outline: Outline) -> tuple[State, int]:
    """The last state of all nodes from which a run in a store with frames of some goes on, and the frames up to it.

    Without a full chunk of frames it is the start, of which no frame is counted.

    Raises:
        ValueError: if there is none.
    """
    import zarr

    root: Any = zarr.open_group(path, mode="r", use_consolidated=False)
    size, count, layout = int(about["size"]), committed(root), outline.layout
    origin, h = float(about["origin"]), float(about["dt"])
    if count:
        group, steps = root["checkpoint"], np.asarray(root["step"][:count])
        rows = np.asarray(group["step"][...])
        good = np.isin(rows, steps)
        if "memory" in group:  # a run stopped by hand has a last row without
            good &= np.isfinite(np.asarray(group["memory"][...])).all(axis=1)
        if not good.any():
            raise ValueError(f"{path} has no state to go on from")
        k = int(np.flatnonzero(good)[-1])
        step, count = int(rows[k]), int(np.searchsorted(steps, rows[k])) + 1
        more = {name: np.asarray(group[name][k]) for name in ("memory", "work") if name in group}
        values, momenta = (np.asarray(group[name][k]).reshape(size, -1) for name in ("values", "momenta"))
        work = more["work"].reshape(-1, 2) if "work" in more else None
        found = {"memory": more.get("memory"), "work": work}
        return State(values=values, momenta=momenta, origin=origin, step=step, h=h, **found), count
    for entry in journal.read(path):
        own = _split(entry, (size, layout.rows), (size, layout.dofs), (None, int(about.get("contact", 0))))
        values, momenta, step = own["values"][0].copy(), own["momenta"][0].copy(), int(own["steps"][0])
        return State(values=values, momenta=momenta, origin=origin, step=step, h=h), 0
    raise ValueError(f"{path} has no state to go on from")


def committed(root: Any) -> int:
    """Number of frames whose states are complete in the arrays."""
    if "checkpoint" in root:
        return int(root["checkpoint"].attrs["frames"])
    return int(root["time"].shape[0])


def observed(root: Any) -> int:
    """Number of frames of which everything was observed."""
    return int(root["checkpoint"].attrs["observed"]) if "checkpoint" in root else committed(root)


def _prefix(source: Path, root: Any, name: str, count: int) -> np.ndarray:
    """The first entries of an array that can be read, at most count."""
    array = root[name]
    if array.shape[0] < count:
        count = int(array.shape[0])
    length = array.chunks[0]
    inner = "/".join("0" for _ in array.shape[1:])
    found = []
    for k in range(-(-count // length)):
        if not (source / name / "c" / str(k) / inner).exists():
            break
        try:
            found.append(np.asarray(array[k * length : min((k + 1) * length, count)]))
        except Exception:  # what a broken chunk raises differs by how it is broken
            break
    return np.concatenate(found) if found else np.zeros((0, *array.shape[1:]))


def _memories(root: Any, steps: np.ndarray) -> dict[int, np.ndarray]:
    """What is remembered at some frames, by their number."""
    found: dict[int, np.ndarray] = {}
    if "memory" in root and len(steps):
        found[len(steps) - 1] = np.array(root["memory"][...])
    if "checkpoint" in root and all(name in root["checkpoint"] for name in ("memory", "step")):
        group = root["checkpoint"]
        for k, step in enumerate(np.asarray(group["step"][...])):
            frame = int(np.searchsorted(steps, step))
            row = np.array(group["memory"][k]) if k < group["memory"].shape[0] else np.full(1, np.nan)
            if frame < len(steps) and steps[frame] == step and np.isfinite(row).all():
                found[frame] = row
    return found


def _of_journal(
    frames: Frames, folder: Path, values: tuple[int, int], momenta: tuple[int, int], more: tuple[int | None, int]
) -> tuple[Frames | None, dict[int, np.ndarray]]:
    """Frames of the journal behind others, of all nodes, and what is remembered at some, numbered after those."""
    first, memories = len(frames.times), {}
    found: dict[str, list[np.ndarray]] = {
        name: [] for name in ("steps", "values", "momenta", "work", "rates", "contact")
    }
    last, count, shapes = int(frames.steps[-1]) if first else -1, 0, (values, momenta)
    for entry in journal.read(folder):
        if entry.tag == journal.FRAMES and entry.step > last:
            last, count = entry.step, count + entry.count
            for name, numbers in _split(entry, *shapes, more).items():
                found[name].append(numbers)
        elif entry.tag == journal.MEMORY and entry.step == last:
            memories[first + count - 1] = entry.numbers.copy()
    if not count:
        return None, memories
    joined = {name: np.concatenate(own) for name, own in found.items()}
    steps, work, rates, contact = joined["steps"].astype(np.int64), joined["work"], joined["rates"], joined["contact"]
    return Frames(
        times=frames.origin + steps * frames.h,
        steps=steps,
        values=joined["values"],
        momenta=joined["momenta"],
        origin=frames.origin,
        h=frames.h,
        work=work.reshape(count, -1, 2) if work.size else None,
        rates=rates.reshape(count, *momenta) if rates.size else None,
        contact=contact if contact.size else None,
    ), memories


def _split(
    entry: journal.Entry, values: tuple[int, int], momenta: tuple[int, int], more: tuple[int | None, int]
) -> dict[str, np.ndarray]:
    """Steps, values, momenta, work, rates and what contacts were of a record, frame by frame.

    more: pairs of work and loss (None: all that is left), and numbers of contacts in a frame.
    """
    m, sizes = entry.count, (1, values[0] * values[1], momenta[0] * momenta[1])
    parts = np.split(entry.numbers, np.cumsum([m * size for size in sizes]))
    pairs, touching = more
    behind = parts[3].size - m * touching
    rest = behind if pairs is None else 2 * pairs * m
    return {
        "steps": parts[0],
        "values": parts[1].reshape(m, *values),
        "momenta": parts[2].reshape(m, *momenta),
        "work": parts[3][:rest].reshape(m, -1),
        "rates": parts[3][rest:behind].reshape(m, -1),
        "contact": parts[3][behind:].reshape(m, -1),
    }
