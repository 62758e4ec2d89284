"""The block-sparse LU against dense solves of the same matrices."""

import ctypes
import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.codegen import jit
from cayley.steppers.blocks import Blocks
from cayley.steppers.native import address, library
from cayley.system.system import aligned

CHAIN = [(k, k + 1) for k in range(9)]
RING = [*CHAIN, (0, 9)]
TREE = [(0, k) for k in range(1, 4)] + [(k, 3 * k + j) for k in range(1, 4) for j in range(3)]
GRID = [(4 * i + j, 4 * i + j + 1) for i in range(4) for j in range(3)] + [
    (4 * i + j, 4 * i + j + 4) for i in range(3) for j in range(4)
]
WHOLE = list(itertools.combinations(range(6), 2))


def matrix_of(blocks: Blocks, pairs: list[tuple[int, int]], rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A matrix with random blocks, in place and dense, in the order of elimination."""
    starts, sizes = blocks.starts, blocks.sizes
    stored, dense = aligned((blocks.size,)), np.zeros((sizes.sum(), sizes.sum()))
    stored[:] = 0.0
    every = [(k, k) for k in range(len(sizes))] + pairs + [(b, a) for a, b in pairs]
    for a, b in every:
        offset, stride = blocks.locate(np.array([a]), np.array([b]))[0]
        block = rng.normal(size=(sizes[a], sizes[b]))
        dense[starts[a] : starts[a] + sizes[a], starts[b] : starts[b] + sizes[b]] = block
        for row in range(sizes[a]):
            stored[offset + row * stride : offset + row * stride + sizes[b]] = block[row]
    return stored, dense


@pytest.mark.parametrize("pairs", [CHAIN, RING, TREE, GRID, WHOLE], ids=["chain", "ring", "tree", "grid", "whole"])
@pytest.mark.parametrize("lanes", [n for n in (2, 4, 8) if n <= jit.lanes()])
@pytest.mark.parametrize("size", [1, 6, 7, 20, None])
def test_solves(pairs, lanes, size):
    rng = np.random.default_rng(5)
    count = 1 + max(max(pair) for pair in pairs)
    sizes = rng.integers(1, 30, size=count) if size is None else np.full(count, size)
    blocks = Blocks(lanes, sizes, np.array(pairs), np.zeros((0, 2), dtype=np.int64))
    stored, dense = matrix_of(blocks, pairs, rng)
    right = rng.normal(size=len(dense))
    found, pivots = right.copy(), np.zeros(len(dense), dtype=np.int64)
    engine, fronts = library(lanes), ctypes.c_int64(blocks.fronts)
    assert engine.factorize(fronts, address(stored), address(pivots), None) == 0
    engine.solve(fronts, address(stored), address(pivots), address(found))
    assert_allclose(dense @ found, right, atol=1e-8 * np.abs(found).max())


def test_singular_block_is_named():
    blocks = Blocks(2, np.array([2, 2]), np.array([(0, 1)]), np.zeros((0, 2), dtype=np.int64))
    stored = aligned((blocks.size,))
    stored[:] = 0.0
    pivots = np.zeros(4, dtype=np.int64)
    assert library(2).factorize(ctypes.c_int64(blocks.fronts), address(stored), address(pivots), None) in (1, 2)


def test_order_of_elimination_is_kept():
    """A saddle point: the second block has no pivot of its own before the first is eliminated."""
    blocks = Blocks(2, np.array([2, 1]), np.array([(0, 1)]), np.array([(0, 1)]))
    assert blocks.starts.tolist() == [0, 2]
    turned = Blocks(2, np.array([2, 1]), np.array([(0, 1)]), np.array([(1, 0)]))
    assert turned.starts.tolist() == [1, 0]


def test_chains_have_no_fill():
    """A chain of n blocks of six unknowns takes one block to the right and one below each."""
    count = 50
    pairs = np.array([(k, k + 1) for k in range(count - 1)])
    blocks = Blocks(2, np.full(count, 6), pairs, np.zeros((0, 2), dtype=np.int64))
    assert blocks.size == count * 36 + 2 * (count - 1) * 36
