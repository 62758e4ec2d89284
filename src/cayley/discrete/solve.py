"""Solve the equations of one node: find what is linear, in which order, and iterate only on the rest."""

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from cayley.discrete.program import Assign, Newton, Step

TOLERANCE = 1e-14
"""Newton stops when the error left, estimated from its last two corrections, is this fraction of the unknowns."""

SMALL = 1e-10
"""Where fields of different units are solved together, a correction that is this fraction of the unknowns is the last
but one: Newton's method then leaves the square of it, less than round-off."""


@dataclass(frozen=True, slots=True)
class Block:
    """Unknowns that must be solved together, in block-triangular order.

    Args:
        unknowns: their indices.
        equations: indices of the equations that determine them.
        linear: True where the equations are linear in these unknowns.
    """

    unknowns: tuple[int, ...]
    equations: tuple[int, ...]
    linear: bool


def find_structure(residual: ca.SX, unknown: ca.SX) -> tuple[Block, ...]:
    """Put equations into block-triangular order by the sparsity of their Jacobian.

    Raises:
        ValueError: if the Jacobian is structurally singular.
    """
    jacobian = ca.jacobian(residual, unknown)
    pattern = jacobian.sparsity()
    if ca.sprank(jacobian) < unknown.numel():
        raise ValueError("the equations do not determine every unknown")
    count, rows, columns, row_starts, column_starts, *_ = pattern.btf()
    blocks = []
    for k in range(count):  # lower triangular: the first block stands alone
        equations = tuple(sorted(rows[row_starts[k] : row_starts[k + 1]]))
        unknowns = tuple(sorted(columns[column_starts[k] : column_starts[k + 1]]))
        own = ca.vertcat(*[unknown[i] for i in unknowns])
        part = ca.jacobian(ca.vertcat(*[residual[i] for i in equations]), own)
        blocks.append(Block(unknowns, equations, not ca.depends_on(part, own)))
    return tuple(blocks)


def solve_steps(residual: ca.SX, unknown: ca.SX, blocks: tuple[Block, ...]) -> list[Step]:
    """Steps that solve residual(unknown) = 0, block by block.

    Linear blocks are solved at once. The others start from the linearization at zero, corrected once, and iterate.
    """
    steps: list[Step] = []
    for block in blocks:
        u = [unknown[i] for i in block.unknowns]
        r = ca.vertcat(*[residual[i] for i in block.equations])
        own = ca.vertcat(*u)
        zero = ca.SX.zeros(own.shape)
        jacobian = ca.jacobian(r, own)
        inverse = Inverse(ca.substitute([jacobian], [own], [zero])[0])
        first = -inverse(ca.substitute([r], [own], [zero])[0])
        if block.linear:
            steps.append(Assign(tuple(u), tuple(ca.vertsplit(first))))
            continue
        start = first - inverse(ca.substitute([r], [own], [first])[0])
        begin = tuple(ca.SX.sym(f"{e.name()}_start") for e in u)
        steps.append(Assign(begin, tuple(ca.vertsplit(start))))
        inverse = Inverse(jacobian)
        one = -inverse(r)
        two = -inverse(ca.substitute([r], [own], [own + one])[0])
        after = own + one + two
        error = ca.sumsqr(two) ** 2
        bound = TOLERANCE**2 * ca.sumsqr(one) * ca.sumsqr(after)
        if len(u) > 3:  # a rotation with a translation, whose rounding, over a lever, is more than TOLERANCE of a turn
            small = ca.sumsqr(one) - SMALL**2 * ca.sumsqr(after)
            error, bound = ca.fmin(error - bound, small), ca.SX(0)
        steps.append(Newton(tuple(u), begin, tuple(ca.vertsplit(after)), error, bound))
    return steps


def side_by_side(solutions: list[list[Step]]) -> list[Step]:
    """Solve the equations of several nodes together: steps of one structure, merged one by one."""
    merged: list[Step] = []
    for steps in zip(*solutions, strict=True):
        if all(isinstance(step, Assign) for step in steps):
            merged.append(Assign(_joined(steps, "targets"), _joined(steps, "values")))
        else:
            error, bound = (ca.vertcat(*[getattr(step, word) for step in steps]) for word in ("error", "bound"))
            merged.append(
                Newton(_joined(steps, "unknown"), _joined(steps, "start"), _joined(steps, "following"), error, bound)
            )
    return merged


def _joined(steps: tuple[Step, ...], word: str) -> tuple[ca.SX, ...]:
    return tuple(symbol for step in steps for symbol in getattr(step, word))


class Inverse:
    """Multiply by the inverse of a small symbolic matrix: cofactors up to 3 × 3, elimination without pivots above."""

    def __init__(self, matrix: ca.SX) -> None:
        """Factorize."""
        self._size = matrix.shape[0]
        dense = ca.densify(matrix)
        self._factors: tuple[ca.SX, Any] = _adjugate(dense) if self._size <= 3 else _eliminate(dense)

    def __call__(self, b: ca.SX) -> ca.SX:
        """Return matrix⁻¹ b."""
        if self._size <= 3:
            adjugate, reciprocal = self._factors
            return (adjugate @ b) * reciprocal
        lower, pivots = self._factors
        n = self._size
        x = [b[i] for i in range(n)]
        for i in range(n):
            for k in range(i):
                x[i] -= lower[i, k] * x[k]
        for i in reversed(range(n)):
            for k in range(i + 1, n):
                x[i] -= lower[i, k] * x[k]
            x[i] *= pivots[i]
        return ca.vertcat(*x)


def _adjugate(m: ca.SX) -> tuple[ca.SX, ca.SX]:
    n = m.shape[0]
    if n == 1:
        return ca.SX(1), 1 / m
    if n == 2:
        adjugate = ca.vertcat(ca.horzcat(m[1, 1], -m[0, 1]), ca.horzcat(-m[1, 0], m[0, 0]))
        return adjugate, 1 / (m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0])
    adjugate = ca.SX(3, 3)
    for i, k in np.ndindex(3, 3):
        a, b, c, d = (i + 1) % 3, (i + 2) % 3, (k + 1) % 3, (k + 2) % 3
        adjugate[k, i] = m[a, c] * m[b, d] - m[a, d] * m[b, c]
    return adjugate, 1 / (m[0, 0] * adjugate[0, 0] + m[0, 1] * adjugate[1, 0] + m[0, 2] * adjugate[2, 0])


def _eliminate(m: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
    n = m.shape[0]
    m = ca.SX(m)
    pivots = []
    for k in range(n):
        pivots.append(1 / m[k, k])
        for i in range(k + 1, n):
            if m[i, k].is_zero():
                continue
            m[i, k] *= pivots[k]
            for j in range(k + 1, n):
                m[i, j] -= m[i, k] * m[k, j]
    return m, pivots
