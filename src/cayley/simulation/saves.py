"""When and where a run is saved."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cayley.choice.schedule import Schedule, schedule
from cayley.model import Model, Port
from cayley.system.discretize import spans

FRAMES = 100
"""Frames of a run that does not say when to save."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Saves:
    """When and where a run is saved; without a choice of times, a hundred times.

    Args:
        every: time between saved frames [s].
        steps: steps between saved frames, instead.
        at: times of saved frames [s], instead; the steps nearest to them are saved, and the end.
        store: a Zarr store that is written while the run goes on, or None: frames stay in memory.
        overwrite: replace a run that is there.
        only: nodes whose frames are kept in the store; all without it.

    Raises:
        ValueError: if several are given, or one does not fit.
    """

    every: float | None = None
    steps: int | None = None
    at: Sequence[float] | None = None
    store: Path | None = None
    overwrite: bool = False
    only: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        """Check."""
        given = {"save_every": self.every, "save_steps": self.steps, "save_at": self.at}
        named = [name for name, value in given.items() if value is not None]
        if self.only is not None and self.store is None:
            raise ValueError("save_only wants a store; give store=path, too")
        if len(named) > 1:
            raise ValueError(f"{' and '.join(named)} are given; give one of them")
        whole = isinstance(self.steps, int) and not isinstance(self.steps, bool)
        if self.steps is not None and not (whole and self.steps > 0):
            raise ValueError(f"save_steps is {self.steps!r}; give a whole number of steps, 1 or more")
        if self.at is not None:
            times = np.asarray(self.at, dtype=float)
            if times.ndim != 1 or not len(times) or not np.all(np.isfinite(times)) or np.any(np.diff(times) <= 0.0):
                raise ValueError("save_at must be a list of rising times [s]")

    def spacing(self, span: float) -> float:
        """Largest time between saves that bounds the step [s]."""
        return span / FRAMES if self.every is None else min(positive("save_every", self.every, "s"), span)

    def schedule(self, begin: float, span: float, step: float) -> Schedule:
        """Equal steps, at most ``step`` [s], that meet the saves of a run of length ``span`` from a time."""
        if self.steps is None and self.at is None:
            return schedule(span, step, self.spacing(span))
        count = max(1, math.ceil(span / step * (1.0 - 1e-12)))
        h = span / count
        if self.steps is not None:
            return Schedule(h, self.steps, count // self.steps, count % self.steps)
        assert self.at is not None
        numbers = np.unique(np.round((np.asarray(self.at, dtype=float) - begin) / h).astype(int))
        numbers = np.append(numbers[(numbers > 0) & (numbers < count)], count)
        return Schedule(h, 0, 0, 0, tuple(np.diff(numbers, prepend=0).tolist()))

    def info(self) -> dict[str, Any]:
        """What a store says of them."""
        given = {"save_every": self.every, "save_steps": self.steps}
        found: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
        return found | ({} if self.at is None else {"save_at": [float(t) for t in self.at]})


def nodes_of(chosen: Sequence[Any], model: Model, degree: int) -> tuple[int, ...]:
    """Nodes of parts (or their names) and of ports, in rising order.

    Raises:
        ValueError: one is neither of the model.
    """
    among, found = dict(zip(model.names, spans(model, degree), strict=True)), set[int]()
    for one in chosen:
        part = one.part if isinstance(one, Port) else one
        called = part if isinstance(part, str) else getattr(part, "name", "")  # ports may be of a part that equals it
        pairs = list(zip(model.names, model.parts, strict=True))
        own = [name for name, known in pairs if known is part] or [name for name, _ in pairs if name == called]
        name = own[0] if own else None
        if name not in among:
            raise ValueError(f"save_only has {one!r}; give parts of the model ({', '.join(among)}), or their ports")
        nodes = among[name]
        found |= {nodes.start + one.node * degree} if isinstance(one, Port) else set(range(nodes.start, nodes.stop))
    if not found:
        raise ValueError("save_only is empty; give parts of the model, or their ports")
    return tuple(sorted(found))


def positive(name: str, value: Any, unit: str) -> float:
    """A positive number.

    Raises:
        ValueError: if it is none.
    """
    if (
        isinstance(value, bool)
        or not isinstance(value, int | float | np.floating | np.integer)
        or not math.isfinite(value)
        or value <= 0
    ):
        raise ValueError(f"{name} is {value!r}; give a positive number [{unit}]")
    return float(value)
