"""Arrays of a Zarr store that grow along the time, all of them cut into chunks at the same frames."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cayley.discrete.layout import Layout

CHUNK_BYTES = 2**22
"""Largest size of a chunk before compression; a chunk holds all nodes of some frames."""
SHORT = 16
"""A short run has chunks for its frames, and not for those that never come, down to this part of the largest size."""
SMALL = 64
"""Chunks of small arrays hold the frames of several chunks of large ones, up to this part of the largest size."""


def chunk_frames(layout: Layout, nodes: int, expected: int) -> int:
    """Frames after which the chunks of all arrays end, of a system with so many nodes and a run of so many frames."""
    frame = 8 * nodes * max(own.stop - own.start for own in map(layout.rows_of, layout.fields))
    return max(1, min(CHUNK_BYTES // frame, max(CHUNK_BYTES // (SHORT * frame), expected)))


class Arrays:
    """The arrays of a store, to be written and added to.

    What is added a chunk at a time makes whole chunks, so that none is read and written again. Arrays are opened once:
    opening one takes about as long as writing a chunk.
    """

    def __init__(self, root: Any, frames: int) -> None:
        """Of a group.

        Args:
            root: the group of the store.
            frames: see chunk_frames; arrays that are there keep their chunks.
        """
        self.root, self.frames = root, frames
        self._open: dict[str, Any] = {}

    def put(
        self,
        group: str,
        arrays: Mapping[str, tuple[str | None, np.ndarray]],
        dims: tuple[str, ...],
        *,
        along: str | None = None,
        start: int = 0,
    ) -> None:
        """Write arrays of a group, with a checksum for each chunk; behind ``start`` entries, which must be there.

        Args:
            group: path of the group; it is made where it is not there.
            arrays: unit and values by name.
            dims: names of their dimensions.
            along: name of the coordinate along the nodes, if they have one.
            start: entries along the first dimension that are kept.
        """
        for name, (unit, values) in arrays.items():
            path = f"{group}/{name}".lstrip("/")
            if start:
                array = self._opened(path)
                if array.shape[0] != start:  # what a run that was killed began
                    array.resize((start, *array.shape[1:]))
                array.append(np.ascontiguousarray(values))
            else:
                self._create(path, unit, values, dims, along)

    def _opened(self, path: str) -> Any:
        import zarr

        if path not in self._open:
            with zarr.config.set({"array.write_empty_chunks": True}):  # as below, which the store does not remember
                self._open[path] = self.root[path]
        return self._open[path]

    def _create(
        self, path: str, unit: str | None, values: np.ndarray, dims: tuple[str, ...], along: str | None
    ) -> None:
        from zarr.codecs import ZstdCodec

        attributes = ({"units": unit} if unit else {}) | ({"coordinates": along} if along else {})
        self._open[path] = self.root.create_array(
            path,
            data=np.ascontiguousarray(values),
            chunks=(self._length(values, dims[0]), *values.shape[1:]),
            dimension_names=dims,
            attributes=attributes,
            compressors=ZstdCodec(level=1, checksum=True),  # level 3 takes twice as long for 1 % less
            config={"write_empty_chunks": True},  # so that a chunk that is not there is one that was lost
            overwrite=True,  # what a run that was killed began
        )

    def _length(self, values: np.ndarray, dim: str) -> int:
        """Entries of a chunk along the first dimension."""
        least = {"time": self.frames, "checkpoint": 1}.get(dim)
        if least is None:  # it does not grow
            return max(1, len(values))
        return least * max(1, CHUNK_BYTES // (SMALL * max(1, least * values[:1].nbytes)))
