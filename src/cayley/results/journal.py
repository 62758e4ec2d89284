"""The last frames of a run in progress, as plain files that are only ever added to: what a killed run does not lose.

Each record is a header (tag, last step, frames, number of bytes, checksum) and doubles. One that was cut off has a
wrong checksum and ends the file; everything before it is whole.
"""

import os
import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

_HEADER = struct.Struct("<4sqqqI")
_NAME = ".journal-"
FRAMES, MEMORY = b"\0\0\0\1", b"\0\0\0\2"


@dataclass(frozen=True, slots=True)
class Entry:
    """A record of a journal.

    Args:
        tag: FRAMES, or MEMORY for what an implicit rule remembers of the step before.
        step: number of the (last) step.
        count: number of frames.
        numbers: doubles, shape (k,).
    """

    tag: bytes
    step: int
    count: int
    numbers: np.ndarray


class Journal:
    """A journal to add to, one for each chunk of frames."""

    def __init__(self, folder: Path, number: int) -> None:
        """Begin a journal in a store."""
        self.number, self.path = number, folder / f"{_NAME}{number:06}"
        # unbuffered: what is written survives the process
        self._file = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        self._open = True

    def add(self, tag: bytes, step: int, arrays: Sequence[np.ndarray], count: int = 0) -> None:
        """Add a record of arrays of doubles, one behind the other."""
        parts = [np.ascontiguousarray(array, dtype=np.float64).reshape(-1).view(np.uint8).data for array in arrays]
        check = 0
        for part in parts:
            check = zlib.crc32(part, check)
        header = _HEADER.pack(tag, step, count, sum(len(part) for part in parts), check)
        for part in (memoryview(header), *parts):
            while part:
                part = part[_write(self._file, part) :]

    def close(self, *, remove: bool = False) -> None:
        """Close the file, or remove it."""
        if self._open:
            os.close(self._file)
        self._open = False
        if remove:
            self.path.unlink(missing_ok=True)


_write = os.write


def journals(folder: Path) -> list[Path]:
    """The journals in a store, one after the other."""
    return sorted(folder.glob(f"{_NAME}*"))


def remove_journals(folder: Path) -> None:
    """Remove all journals of a store."""
    for path in journals(folder):
        path.unlink(missing_ok=True)


def read(folder: Path) -> Iterator[Entry]:
    """The whole records of the journals in a store."""
    for path in journals(folder):
        yield from _records(path.read_bytes())


def _records(content: bytes) -> Iterator[Entry]:
    at = 0
    while at + _HEADER.size <= len(content):
        tag, step, count, size, check = _HEADER.unpack_from(content, at)
        at += _HEADER.size
        own = content[at : at + size]
        if tag not in (FRAMES, MEMORY) or len(own) != size or zlib.crc32(own) != check:
            return
        yield Entry(tag, step, count, np.frombuffer(own, dtype=np.float64))
        at += size
