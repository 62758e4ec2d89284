"""Saved states of a run."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cayley.system.system import State, System


@dataclass(frozen=True, slots=True, kw_only=True)
class Frames:
    """Saved states of a run.

    Args:
        times: [s], shape (m,).
        steps: step number of each frame, shape (m,).
        values: shape (m, nodes, rows).
        momenta: shape (m, nodes, dofs).
        origin: time of step 0 [s].
        h: time step [s].
        memory: what implicit rules remember of the step before the last frame (see State).
        work: work and loss since the start (see State), shape (m, k, 2), or None.
        rates: velocities ω and ẋ that the last three steps of an implicit rule say, if forces depend on velocities,
            shape (m, nodes, dofs): with u, w, v the mean velocities of these steps v + w/2 − u/2, which is of order 2
            and does not know what decays within a step; not numbers before the third step.
        contact: what is told of contacts (energy, loss, deepest in radii, ..., see steppers.contacts.TOLD) and behind
            it their forces on all nodes, shape (m, TOLD + nodes × dofs), or None.
    """

    times: np.ndarray
    steps: np.ndarray
    values: np.ndarray
    momenta: np.ndarray
    origin: float
    h: float
    memory: np.ndarray | None = None
    work: np.ndarray | None = None
    rates: np.ndarray | None = None
    contact: np.ndarray | None = None

    @classmethod
    def of(cls, state: State) -> "Frames":
        """The one frame of a state."""
        return cls(
            times=np.array([state.time]),
            steps=np.array([state.step]),
            values=state.values[None],
            momenta=state.momenta[None],
            origin=state.origin,
            h=state.h,
            work=None if state.work is None else state.work[None],
        )

    def state(self, k: int = -1) -> State:
        """The state of a frame, to go on from."""
        return State(
            values=self.values[k].copy(),
            momenta=self.momenta[k].copy(),
            origin=self.origin,
            step=int(self.steps[k]),
            h=self.h,
            memory=self.memory if k in (-1, len(self.times) - 1) else None,
            work=None if self.work is None else self.work[k].copy(),
        )

    def at_nodes(self, nodes: np.ndarray) -> "Frames":
        """The same frames of some nodes."""
        rates = None if self.rates is None else self.rates[:, nodes]
        return replace(
            self, values=self.values[:, nodes], momenta=self.momenta[:, nodes], memory=None, rates=rates, contact=None
        )

    def then(self, later: "Frames") -> "Frames":
        """These frames, and those behind them."""
        if not len(self.times):
            return later
        names = ("times", "steps", "values", "momenta", "work", "rates", "contact")
        both = {name: (getattr(self, name), getattr(later, name)) for name in names}
        joined: dict[str, Any] = {
            name: np.concatenate(pair) if pair[0] is not None else None for name, pair in both.items()
        }
        return replace(self, memory=later.memory, **joined)

    def part(self, which: slice) -> "Frames":
        """Some of the frames, without what is remembered."""
        return replace(
            self,
            times=self.times[which],
            steps=self.steps[which],
            values=self.values[which],
            momenta=self.momenta[which],
            memory=None,
            work=None if self.work is None else self.work[which],
            rates=None if self.rates is None else self.rates[which],
            contact=None if self.contact is None else self.contact[which],
        )


def by_group(system: System, frames: Frames) -> list[tuple[System, Frames]]:
    """The groups of a system, each with its part of saved states."""
    if not system.members:
        return [(system, frames)]
    found = []
    for (group, nodes), cells in zip(system.spans, system.cell_spans, strict=True):
        own = replace(
            frames,
            values=frames.values[:, nodes],
            momenta=frames.momenta[:, nodes],
            memory=None,
            work=None if frames.work is None else frames.work[:, cells],
            rates=None if frames.rates is None else frames.rates[:, nodes],
            contact=None,
        )
        found.append((group, own))
    return found
