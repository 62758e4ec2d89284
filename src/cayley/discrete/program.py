"""What a compiled kernel does, as data: loads, straight assignments, carries between lanes, Newton loops, stores."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca


@dataclass(frozen=True, slots=True)
class Assign:
    """Name values for the steps that follow: targets = values."""

    targets: tuple[ca.SX, ...]
    values: tuple[ca.SX, ...]


@dataclass(frozen=True, slots=True)
class Carry:
    """Hand values of each element's right end to the node there: target at node k = source at element k − 1."""

    targets: tuple[ca.SX, ...]
    sources: tuple[ca.SX, ...]
    rows: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Newton:
    """Iterate unknown = following until error ≤ bound in every lane.

    Each pass is one Newton step and one more with the same inverse; its second correction squared over its first
    estimates the error that is left. error and bound are columns, one entry for each node that is solved.
    """

    unknown: tuple[ca.SX, ...]
    start: tuple[ca.SX, ...]
    following: tuple[ca.SX, ...]
    error: ca.SX
    bound: ca.SX


Step = Assign | Carry | Newton


@dataclass(frozen=True, slots=True)
class Program:
    """One kernel over the nodes of a system, a block of lanes at a time.

    Args:
        name: name of the kernel.
        uniforms: symbols that are equal for all nodes, in the order they are passed.
        lanes: (symbol, row, shift) for values read per node; shift 1 reads the next node.
        steps: the computation.
        stores: (row, value) written back.
        rows: number of rows of a block.
    """

    name: str
    uniforms: tuple[ca.SX, ...]
    lanes: tuple[tuple[ca.SX, int, int], ...]
    steps: tuple[Step, ...]
    stores: tuple[tuple[int, ca.SX], ...]
    rows: int
    notes: Sequence[str] = field(default=())
