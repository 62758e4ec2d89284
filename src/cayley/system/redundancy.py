"""Which constraints of joints follow from others and from supports: they have no unique forces, and steppers fail.

SciPy is imported where joints are looked at: models without any do not wait for it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx
from cayley.discrete.joint import DIRECTIONS, evaluator, joint_program
from cayley.discrete.layout import Layout
from cayley.discrete.node import tangent
from cayley.system.couplings import Coupling, joint_inputs

if TYPE_CHECKING:
    from scipy.sparse import csr_array

TOLERANCE = 1e-8
"""Of a row of length one, what is left outside the span of others below this is round-off."""
DENSE = 400
"""Up to so many constraints that hang together dense projections are quick; of more, sparse pivots are looked at."""
MOST_NAMED = 5
"""Of more joints from which one follows, so many are named."""
PIVOT = 1e-10
"""Pivots of G Gᵀ, squares of what is left of a row, below this are round-off."""


def redundant(layout: Layout, values: np.ndarray, free: np.ndarray, joints: Sequence[Coupling]) -> list[str]:
    """Constraints at a configuration that are combinations of others, a line for each.

    y ≠ 0 with yᵀ G = 0, where G is the derivative of all constraints along the free degrees of freedom

    Joints that hang together by common nodes are looked at together. Rods between nodes are taken as elastic.

    Args:
        layout: rows of a node.
        values: the configuration, shape (nodes, rows).
        free: False where a degree of freedom is held, shape (nodes, dofs).
        joints: the joints.

    Returns: lines such as "hinge2: about e2 follows from hinge1, hinge3".
    """
    if not joints:
        return []
    from scipy.sparse import csr_array, lil_array

    scale = np.ones(layout.dofs)
    scale[layout.dofs_of("x")] = _length(layout, values)
    slopes = joint_slopes(layout, values, joints)
    lines: list[str] = []
    for members in _components(joints, free):
        nodes = sorted({n for k in members for n in _nodes(joints[k])})
        column = {n: slice(i * layout.dofs, (i + 1) * layout.dofs) for i, n in enumerate(nodes)}
        matrix = lil_array((sum(joints[k].count for k in members), len(nodes) * layout.dofs))
        first = 0
        for k in members:
            for node, slope in zip(_nodes(joints[k]), np.split(slopes[k], 2, axis=1), strict=False):
                matrix[first : first + joints[k].count, column[node]] = slope * scale * free[node]
            first += joints[k].count
        owners = [(joints[k].name, word) for k in members for word in DIRECTIONS[joints[k].kind]]
        lines += _told(owners, _dependencies(csr_array(matrix)))
    return lines


def joint_slopes(layout: Layout, values: np.ndarray, joints: Sequence[Coupling]) -> list[np.ndarray]:
    """∂g of joints along δp = ½ p η and δx of their two nodes, shape (constraints, 2 × dofs) each."""
    ground = ground_values(layout)
    programs = {
        (kind, grounded): evaluator(joint_program(kind, layout, grounded=grounded, what="slope"))
        for kind, grounded in {(joint.kind, joint.grounded) for joint in joints}
    }
    node = symbols("q", layout.rows)
    turn = ca.Function("tangent", [to_sx(node)], [ca.densify(tangent(layout, node))])
    found = []
    for joint in joints:
        inputs = joint_inputs(joint, values, ground)
        c, rows = joint.count, layout.rows
        slope = programs[joint.kind, joint.grounded](inputs)[0, c:].reshape(c, 2, rows)
        found.append(np.hstack([slope[:, k] @ np.array(turn(inputs[k * rows : (k + 1) * rows])) for k in range(2)]))
    return found


def ground_values(layout: Layout) -> np.ndarray:
    """Values of the ground in place of those of a node: rotations one, vectors zero, shape (rows,)."""
    found = np.zeros(layout.rows)
    for name in layout.rotations:
        found[layout.rows_of(name)] = layout.representation.from_quaternion(np.array([1.0, 0.0, 0.0, 0.0]))
    return found


def _nodes(joint: Coupling) -> tuple[int, ...]:
    return (joint.first,) if joint.grounded else (joint.first, joint.second)


def _length(layout: Layout, values: np.ndarray) -> float:
    """A length that makes displacements comparable with rotations: the extent of the nodes, or 1 m."""
    extent = float(np.linalg.norm(np.ptp(values[:, layout.rows_of("x")], axis=0)))
    return extent if extent > 0.0 else 1.0


def _components(joints: Sequence[Coupling], free: np.ndarray) -> list[list[int]]:
    """Joints that hang together by nodes that can move."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges = [(k, node) for k, joint in enumerate(joints) for node in _nodes(joint) if free[node].any()]
    count = len(joints)
    rows, columns = [k for k, _ in edges], [count + node for _, node in edges]
    size = count + len(free)
    graph = coo_array((np.ones(len(edges)), (rows, columns)), shape=(size, size))
    _, labels = connected_components(graph, directed=False)
    members: dict[int, list[int]] = {}
    for k in range(count):
        members.setdefault(int(labels[k]), []).append(k)
    return list(members.values())


def _dependencies(matrix: csr_array) -> list[list[int]]:
    """Sets of rows one of which, the last, follows from the others; alone: from supports."""
    from scipy.sparse import csr_array, diags_array
    from scipy.sparse.linalg import lsqr

    size = np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=1)).reshape(-1))
    found = [[int(k)] for k in np.flatnonzero(size < TOLERANCE)]
    rows = np.flatnonzero(size >= TOLERANCE)
    unit = csr_array(diags_array(1.0 / size[rows]) @ matrix[rows])
    search = _by_projection if len(rows) <= DENSE else _by_pivots
    culprits = search(unit)
    sound = np.setdiff1d(np.arange(len(rows)), culprits)
    for k in culprits:
        share = lsqr(unit[sound].T, unit[[k]].toarray()[0], atol=1e-12, btol=1e-12)[0]
        found.append([*rows[sound[np.abs(share) > 1e-6]].tolist(), int(rows[k])])
    return found


def _by_projection(unit: csr_array) -> list[int]:
    """Rows of length one of which nothing is left outside the span of those before them."""
    basis = np.zeros(unit.shape)
    culprits, count = [], 0
    for k, row in enumerate(unit.toarray()):
        rest = row
        for _ in range(2):  # twice is enough (Kahan, Parlett)
            rest = rest - basis[:count].T @ (basis[:count] @ rest)
        left = float(np.linalg.norm(rest))
        if left > TOLERANCE:
            basis[count], count = rest / left, count + 1
        else:
            culprits.append(k)
    return culprits


def _by_pivots(unit: csr_array) -> list[int]:
    """The same for many rows, by pivots of G Gᵀ, which are the squares of what is left."""
    from scipy.sparse import csc_array, eye_array
    from scipy.sparse.linalg import splu

    shifted = csc_array(unit @ unit.T + 1e-15 * eye_array(unit.shape[0]))
    factor = splu(shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    pivots = np.abs(factor.U.diagonal())
    place = np.argsort(factor.perm_c)  # of each pivot
    return sorted(place[pivots < PIVOT].tolist())


def _told(owners: Sequence[tuple[str, str]], dependencies: Sequence[Sequence[int]]) -> list[str]:
    """A line for each joint with redundant constraints."""
    words: dict[str, list[str]] = {}
    causes: dict[str, list[str]] = {}
    for *others, last in dependencies:
        name, word = owners[last]
        words.setdefault(name, []).append(word)
        known = causes.setdefault(name, [])
        known += [n for n in dict.fromkeys(owners[k][0] for k in others) if n not in known and n != name]
    verbs = {name: "follows" if len(found) == 1 else "follow" for name, found in words.items()}
    return [
        f"{name}: {', '.join(found)} {verbs[name]} from {_named(causes[name]) or 'supports'}"
        for name, found in words.items()
    ]


def _named(names: Sequence[str]) -> str:
    """Names in a row, of many the first ones."""
    shown = names if len(names) <= MOST_NAMED + 1 else [*names[:MOST_NAMED], f"{len(names) - MOST_NAMED} more"]
    return ", ".join(shown)
