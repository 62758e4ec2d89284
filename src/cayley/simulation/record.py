"""Where the frames of a run go: into memory, or into a store that a killed run leaves whole."""

from collections.abc import Sequence
from dataclasses import dataclass

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

    @classmethod
    def of(cls, state: State) -> "Block":
        """The one of a state."""
        work = None if state.work is None else state.work[None]
        return cls(np.array([state.step]), state.values[None], state.momenta[None], work)


class Record:
    """The frames of a run."""

    def __init__(self, begin: State, writer: Writer | None = None, *, known: bool = False) -> None:
        """Begin with a state.

        Args:
            begin: the state.
            writer: takes the frames; they stay in memory without one.
            known: whether the writer's store has the frame of the state.
        """
        self.begin, self.writer, self.known = begin, writer, known
        self._last = begin.step
        self._count = 1.0
        self._blocks = [] if known else [Block.of(begin)]
        self._fresh = len(self._blocks)

    def most(self, frames: int) -> int:
        """Frames of the next call, at most so many."""
        waiting = 0 if self.writer is None else self._fresh  # it is not known yet whether there is an account of work
        room = frames if self.writer is None else min(frames, max(self.writer.room - waiting, 1))
        return max(1, min(room, int(self._count)))

    def receive(self, stride: int, values: np.ndarray, momenta: np.ndarray, work: np.ndarray | None = None) -> None:
        """Take frames of a call, so many steps apart."""
        numbers = self._last + stride * (1 + np.arange(len(values)))
        self._last = int(numbers[-1])
        self._blocks.append(Block(numbers, values, momenta, work))

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
        for k, (block, work) in enumerate(zip(self._blocks, _works(self._blocks), strict=True)):
            last = k == len(self._blocks) - 1 and state is not None
            self.writer.add(block.steps, block.values, block.momenta, work, state.memory if last and state else None)
        self._blocks, self._fresh = [], 0

    def close(self) -> None:
        """End the writing; of a run that was stopped, frames of a call that did not end are written too."""
        assert self.writer is not None
        self._write()
        self.writer.close()

    def frames(self, memory: np.ndarray | None) -> Frames:
        """All frames that are in memory."""
        steps, works = np.concatenate([block.steps for block in self._blocks]), _works(self._blocks)
        accounted = [work for work in works if work is not None]
        return Frames(
            times=self.begin.origin + steps * self.begin.h,
            steps=steps,
            values=np.concatenate([block.values for block in self._blocks]),
            momenta=np.concatenate([block.momenta for block in self._blocks]),
            origin=self.begin.origin,
            h=self.begin.h,
            memory=memory,
            work=np.concatenate(accounted) if accounted else None,
        )


def _works(blocks: Sequence[Block]) -> list[np.ndarray | None]:
    """Work and loss at all frames; none at the start, unless the run goes on from one that had some."""
    found = [block.work for block in blocks if block.work is not None]
    if not found:
        return [None] * len(blocks)
    shape = found[-1].shape[1:]
    return [np.zeros((len(block.steps), *shape)) if block.work is None else block.work for block in blocks]
