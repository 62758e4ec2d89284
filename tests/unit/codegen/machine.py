"""Compile programs made by hand and call them."""

import ctypes
from collections.abc import Sequence

import casadi as ca
import numpy as np

from cayley.codegen import jit
from cayley.codegen.llvm import print_ir
from cayley.discrete.program import Assign, Program, Step
from cayley.system.system import aligned


class Machine:
    """A compiled program that runs on blocks of lanes."""

    def __init__(self, program: Program, lanes: int) -> None:
        self.program, self.lanes = program, lanes
        name = program.name
        ir = print_ir(program, lanes)
        (run, setup, width), self.cached = jit.load((name, f"{name}_setup", f"{name}_width"), lambda: ir, ir)
        integer, pointer = ctypes.c_int64, ctypes.c_void_p
        self._run = ctypes.CFUNCTYPE(integer, pointer, pointer, integer, integer)(run)
        self._setup = ctypes.CFUNCTYPE(None, pointer)(setup)
        self.width = ctypes.CFUNCTYPE(integer)(width)()

    def __call__(self, data: np.ndarray, uniforms: Sequence[float], first: int, last: int) -> int:
        """Work on blocks first ... last - 1 in place; returns the number of blocks that failed."""
        room = np.zeros(max(self.width, 1))
        room[: len(uniforms)] = uniforms
        self._setup(room.ctypes.data)
        return self._run(data.ctypes.data, room.ctypes.data, first, last)


def blocks_of(columns: Sequence[np.ndarray], rows: int, lanes: int) -> np.ndarray:
    """Blocks with values of nodes in the first rows, zero elsewhere, and a block of padding at either end."""
    nodes = len(columns[0])
    count = -(-nodes // lanes)
    data = aligned((count + 2, rows, lanes))
    data[:] = 0.0
    for row, column in enumerate(columns):
        flat = np.zeros(count * lanes)
        flat[:nodes] = column
        data[1:-1, row] = flat.reshape(count, lanes)
    return data


def row_of(data: np.ndarray, row: int, nodes: int) -> np.ndarray:
    """Values of nodes in a row of blocks."""
    return data[1:-1, row].reshape(-1)[:nodes]


def program_of(
    steps: Sequence[Step],
    values: Sequence[ca.SX],
    *,
    lanes: Sequence[ca.SX] = (),
    shifted: Sequence[tuple[ca.SX, int]] = (),
    uniforms: Sequence[ca.SX] = (),
    extra: int = 0,
) -> Program:
    """A program that reads its lane inputs from the first rows and stores values in those behind.

    Args:
        steps: the computation.
        values: stored in rows len(lanes) + extra, ...
        lanes: read from rows 0, 1, ...
        shifted: symbols for the next node's value, with the row.
        uniforms: uniform inputs.
        extra: rows in between, for what is carried.
    """
    reads = [(s, i, 0) for i, s in enumerate(lanes)] + [(s, row, 1) for s, row in shifted]
    first = len(lanes) + extra
    stores = tuple((first + i, v) for i, v in enumerate(values))
    return Program("made", tuple(uniforms), tuple(reads), tuple(steps), stores, first + len(values))


def evaluate(expression: ca.SX, lanes: Sequence[ca.SX], columns: Sequence[np.ndarray], width: int) -> np.ndarray:
    """Values of one expression of lane inputs for many nodes, by machine code of a width."""
    out = ca.SX.sym("out")
    program = program_of([Assign((out,), (expression,))], [out], lanes=lanes)
    data = blocks_of(columns, program.rows, width)
    assert Machine(program, width)(data, [], 1, len(data) - 1) == 0
    return row_of(data, len(lanes), len(columns[0]))
