"""Order of elimination of the unknowns of an implicit step, and where the blocks of its matrix stand."""

import ctypes
import weakref
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cayley.steppers.native import address, library


@dataclass(frozen=True, slots=True, weakref_slot=True)
class Blocks:
    """A block-sparse matrix: groups of unknowns, eliminated in an order of small fill.

    Args:
        lanes: doubles in a vector.
        sizes: unknowns of every block, shape (n,).
        pairs: blocks that are coupled, shape (m, 2).
        before: (b, c) where b must be eliminated before c, shape (k, 2).
    """

    lanes: int
    sizes: np.ndarray
    pairs: np.ndarray
    before: np.ndarray
    fronts: int = field(init=False)

    def __post_init__(self) -> None:
        """Plan the elimination."""
        start, neighbor = _lists(np.concatenate([self.pairs, self.pairs[:, ::-1]]), len(self.sizes))
        after_start, after = _lists(self.before, len(self.sizes))
        sizes = np.ascontiguousarray(self.sizes, dtype=np.int64)
        arrays = [address(a) for a in (sizes, start, neighbor, after_start, after)]
        made = self._engine.order_blocks(ctypes.c_int64(len(sizes)), *arrays)
        object.__setattr__(self, "fronts", made)
        weakref.finalize(self, self._engine.release_blocks, ctypes.c_int64(made))

    @property
    def _engine(self) -> Any:
        return library(self.lanes)

    @property
    def size(self) -> int:
        """Length of the array that holds the matrix."""
        return int(self._engine.matrix_size(ctypes.c_int64(self.fronts)))

    @property
    def starts(self) -> np.ndarray:
        """First unknown of every block, shape (n,)."""
        found = np.empty(len(self.sizes), dtype=np.int64)
        self._engine.unknown_starts(ctypes.c_int64(self.fronts), address(found))
        return found

    def locate(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """(offset, stride of a row) of matrix blocks, −1 where there is none, shape (*rows.shape, 2)."""
        rows, columns = (np.ascontiguousarray(a, dtype=np.int64) for a in (rows, columns))
        found = np.empty((*rows.shape, 2), dtype=np.int64)
        self._engine.locate(
            ctypes.c_int64(self.fronts), ctypes.c_int64(rows.size), address(rows), address(columns), address(found)
        )
        return found

    def diagonal(self) -> np.ndarray:
        """Where the diagonal entry of every unknown stands, shape (unknowns,)."""
        every = np.arange(len(self.sizes))
        where = self.locate(every, every)
        inside = np.arange(int(self.sizes.sum())) - np.repeat(np.cumsum(self.sizes) - self.sizes, self.sizes)
        offsets = np.repeat(where[:, 0], self.sizes) + inside * (np.repeat(where[:, 1], self.sizes) + 1)
        found = np.empty_like(offsets)
        found[np.repeat(self.starts, self.sizes) + inside] = offsets
        return found


def distinct(pairs: np.ndarray, count: int) -> np.ndarray:
    """Every pair of numbers below count once, in order, shape (k, 2); as numbers they are sorted much faster."""
    return np.stack(np.divmod(np.unique(pairs[:, 0] * count + pairs[:, 1]), count), axis=1)


def _lists(pairs: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Starts and entries of the lists of second members by first member, each pair once."""
    pairs = distinct(np.asarray(pairs, dtype=np.int64).reshape(-1, 2), count)
    start = np.searchsorted(pairs[:, 0], np.arange(count + 1)).astype(np.int64)
    return start, np.append(pairs[:, 1], 0).astype(np.int64)
