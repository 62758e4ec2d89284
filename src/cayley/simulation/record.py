"""Where the frames of a run go: into memory, or into a store that a killed run leaves whole."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cayley.results.frames import Frames
from cayley.results.writer import Writer
from cayley.system.system import State

CALL_SECONDS, WRITTEN_SECONDS = 0.5, 0.1
"""Time that one call of a stepper is to take, so that Ctrl-C is heard; less where a killed run loses the call."""
FASTER = 4.0
"""Factor by which the next call may have more frames."""


@dataclass(frozen=True, slots=True)
class Block:
    """Frames received from one call of the driver."""

    steps: np.ndarray
    values: np.ndarray
    momenta: np.ndarray
    work: np.ndarray | None = None
    rates: np.ndarray | None = None
    contact: np.ndarray | None = None

    @classmethod
    def of(cls, state: State, contact: np.ndarray | None = None) -> "Block":
        """The one of a state, with what contacts are there."""
        work, touching = (None if own is None else own[None] for own in (state.work, contact))
        return cls(np.array([state.step]), state.values[None], state.momenta[None], work, contact=touching)


class Record:
    """The frames of a run."""

    def __init__(
        self, begin: State, writer: Writer | None = None, *, known: bool = False, contact: np.ndarray | None = None
    ) -> None:
        """Begin with a state.

        Args:
            begin: the state.
            writer: takes the frames; they stay in memory without one.
            known: whether the writer's store has the frame of the state.
            contact: what frames have of contacts there.
        """
        self.begin, self.writer, self.known = begin, writer, known
        self._last = begin.step
        self._count = 1.0
        self._blocks = [] if known else [Block.of(begin, contact)]
        self._fresh = len(self._blocks)

    def most(self, frames: int) -> int:
        """Frames of the next call, at most so many."""
        waiting = 0 if self.writer is None else self._fresh  # it is not known yet whether there is an account of work
        room = frames if self.writer is None else min(frames, max(self.writer.room - waiting, 1))
        return max(1, min(room, int(self._count)))

    def receive(self, stride: int, values: np.ndarray, momenta: np.ndarray, **more: np.ndarray) -> None:
        """Take frames of a call, so many steps apart."""
        numbers = self._last + stride * (1 + np.arange(len(values)))
        self._last = int(numbers[-1])
        self._blocks.append(Block(numbers, values, momenta, **more))

    def called(self, state: State, seconds: float) -> None:
        """A call of the stepper ended with a state, after so many seconds."""
        count = sum(len(block.steps) for block in self._blocks[self._fresh :])
        wanted = CALL_SECONDS if self.writer is None else WRITTEN_SECONDS
        self._count = min(count * wanted / max(seconds, 1e-9), FASTER * max(count, 1))
        if self.writer is None:
            self._fresh = len(self._blocks)
        else:
            self._write(state)

    def _write(self, state: State | None = None) -> None:
        assert self.writer is not None
        blocks = _completed(self._blocks)
        for k, block in enumerate(blocks):
            last = k == len(blocks) - 1 and state is not None
            more = {
                "work": block.work,
                "rates": block.rates,
                "contact": block.contact,
                "memory": state.memory if last and state else None,
            }
            self.writer.add(block.steps, block.values, block.momenta, **more)
        self._blocks, self._fresh = [], 0

    def close(self) -> None:
        """End the writing; of a run that was stopped, frames of a call that did not end are written too."""
        assert self.writer is not None
        self._write()
        self.writer.close()

    def frames(self, memory: np.ndarray | None) -> Frames:
        """All frames that are in memory."""
        blocks = _completed(self._blocks)
        steps = np.concatenate([block.steps for block in blocks])
        names = ("work", "rates", "contact")
        works, rates, contact = ([own for b in blocks if (own := getattr(b, name)) is not None] for name in names)
        return Frames(
            times=self.begin.origin + steps * self.begin.h,
            steps=steps,
            values=np.concatenate([block.values for block in blocks]),
            momenta=np.concatenate([block.momenta for block in blocks]),
            origin=self.begin.origin,
            h=self.begin.h,
            memory=memory,
            work=np.concatenate(works) if works else None,
            rates=np.concatenate(rates) if rates else None,
            contact=np.concatenate(contact) if contact else None,
        )


def _completed(blocks: Sequence[Block]) -> list[Block]:
    """Blocks with work and loss and rates, if others have them; no work at the start, and no rates (NaN)."""
    found = list(blocks)
    for name, nothing in (("work", 0.0), ("rates", np.nan), ("contact", 0.0)):
        known = [own for block in found if (own := getattr(block, name)) is not None]
        if known:
            shape = known[-1].shape[1:]
            found = [
                replace(block, **{name: np.full((len(block.steps), *shape), nothing)})
                if getattr(block, name) is None
                else block
                for block in found
            ]
    return found
