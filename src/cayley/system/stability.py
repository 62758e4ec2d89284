"""The step limit of explicit rules: a guaranteed bound of the highest frequency of the linearized system."""

from __future__ import annotations

from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.element import element_forces
from cayley.discrete.equations import DiscreteEquations
from cayley.discrete.layout import Layout
from cayley.discrete.node import mass_matrix, node_load, node_point, tangent
from cayley.discrete.places import constants_at, placed
from cayley.discrete.polynomial import polynomial_forces
from cayley.discrete.rules import lobatto_weights
from cayley.system.damping import Matrices, forced_matrices
from cayley.system.spring_limits import largest, spring_columns
from cayley.system.system import System, joined
from cayley.system.turned import as_quaternions, embedded

if TYPE_CHECKING:
    from scipy.sparse import csc_array

SHARPNESS = 1.02
DENSE = 400
"""Up to so many degrees of freedom all eigenvalues of the dense matrix are quicker."""
MOST_SOLVED = 20_000_000
"""Entries of the factor of springs (160 MB) up to which a bound is lowered; with more the sum must do."""


def stable_dt(system: System, values: np.ndarray, rates: np.ndarray | None = None, *, enough: float = np.inf) -> float:
    """Largest stable step min(2/ω_max, 2/δ_max) for the system linearized about values and velocities.

    δ_max, of forces that depend on velocities, is the largest eigenvalue of M⁻¹D, D the symmetric part of −∂G/∂q̇. With
    z = hδ, a step of a mode (discrete.forced) has determinant 1 − z + z²/2 and is stable for z < 2 and
    (hω)² < (4 − 2z + z²)/(1 − z/2), which is 4 at least; matrices K and D that do not commute were tried at random.

    For lumped masses ω_max² ≤ max over elements of λ_max(M_e⁻¹ K_e) (Irons and Treharne 1971, Fried 1972), with each
    node's mass shared between its elements; springs add their own λ_max(M⁻¹ K), dampers theirs to δ_max. The bound is
    then lowered as far as a Cholesky factorization of σM − K, which exists just where σ > ω_max², certifies. Joints are
    left out: holding something lowers every frequency (Rayleigh).

    Args:
        system: the system.
        values: where to linearize, shape (nodes, rows).
        rates: velocities there, shape (nodes, dofs); at rest without them. They count with forces that depend on them.
        enough: stop at the first bound if it already allows this step [s].

    Returns: the step [s]; infinite where nothing oscillates, not a number where springs have no finite derivatives.
    """
    return float(np.min(_limits(system, values, rates, enough)))


def decay_limit(system: System, values: np.ndarray, *, enough: float = np.inf) -> float:
    """The part 2/δ_max of stable_dt, about values at rest: what decays faster is not resolved by a longer step [s]."""
    return _limits(system, values, None, enough)[1]


def _limits(system: System, values: np.ndarray, rates: np.ndarray | None, enough: float) -> tuple[float, float]:
    """2/ω_max and 2/δ_max."""
    of_groups = [_matrices(group, values[nodes]) for group, nodes in system.spans]
    masses, stiffness = joined([own for own, _ in of_groups]), _joined([own for _, own in of_groups])
    try:
        springs, dampers = _tied(system, values, masses)
    except FloatingPointError:
        return np.nan, np.nan
    damping: tuple[np.ndarray, np.ndarray] | None = None
    if system.with_forces:
        motion = np.zeros((system.size, system.layout.dofs)) if rates is None else rates
        more, damping = _forced(system, values, motion)
        stiffness = (stiffness[0] + more[0], stiffness[1] + more[1])
    elif dampers is not None:
        damping = (np.zeros_like(stiffness[0]), np.zeros_like(stiffness[1]))
    squared = _highest(system, masses, stiffness, springs, 4.0 / enough**2)
    rate = 0.0 if damping is None else _highest(system, masses, damping, dampers, 2.0 / enough)
    return 2.0 / float(np.sqrt(squared)) if squared > 0.0 else np.inf, 2.0 / rate if rate > 0.0 else np.inf


def _forced(system: System, values: np.ndarray, rates: np.ndarray) -> tuple[Matrices, Matrices]:
    """What forces beside the Lagrangian add to the stiffness, and their damping, of all groups."""
    found = [
        forced_matrices(group, _inputs(group, values[nodes]), _lengths(group), rates[nodes])
        for group, nodes in system.spans
    ]
    return _joined([stiffness for stiffness, _ in found]), _joined([damping for _, damping in found])


def _joined(found: list[Matrices]) -> Matrices:
    """Matrices of elements and of nodes of all groups."""
    return joined([elements for elements, _ in found]), joined([nodes for _, nodes in found])


def _tied(system: System, values: np.ndarray, masses: np.ndarray) -> tuple[csc_array | None, csc_array | None]:
    """Factors of the scaled matrices of springs and of dampers; None where there are none."""
    if not system.springs:
        return None, None
    free = system.free
    values, roots = as_quaternions(system.layout, values), free[:, :, None] * _inverse_roots(masses) * free[:, None, :]
    found = spring_columns(embedded(system), values, roots)
    springs, dampers = (columns if columns.shape[1] else None for columns in found)
    return springs, dampers


def _highest(
    system: System,
    masses: np.ndarray,
    matrices: tuple[np.ndarray, np.ndarray],
    ties: csc_array | None,
    harmless: float,
) -> float:
    """Bound of the largest eigenvalue of M⁻¹A + B Bᵀ, its root sharp to 2 % unless harmless; 0 if none is positive."""
    own = max(_largest(_scaled_elements(system, masses, matrices)), 0.0)
    bound = own if ties is None else own + largest(ties)
    if bound <= harmless or own == 0.0:
        return bound
    bands = _assemble(system, masses, matrices, system.free)
    if system.size * system.layout.dofs <= DENSE:
        return max(_exact(bands, ties), 0.0)
    if ties is not None and ties.shape[0] * ties.shape[1] > MOST_SOLVED:
        return bound
    return _certify(bands, ties, bound)


def _linearization(equations: DiscreteEquations) -> tuple[ca.Function, np.ndarray, bool]:
    """Mass, stiffness of node loads, stiffness of an element as a function of rows of inputs (see _inputs).

    Returns: the function, which inputs it does not use, and whether it depends on where vectors are.
    """
    density, layout = equations.density, equations.layout
    along = density.lagrangian.interval
    ends = [symbols(f"end{k}", layout.rows) for k in range(equations.rule.cell + 1)]
    names = {n: wrap(ca.SX.sym(n)) for n in ("inverse", "left", "right", "t", "weight", "length")}
    extra = {n: ca.SX.sym(n) for n in placed(equations.varying)}
    place = names | {"here": names["left"]}
    place["at points"] = [constants_at(extra, k) for k in range(len(equations.rule.strain.at))]
    tangents = [tangent(layout, end) for end in ends]
    load = to_sx(node_load(density, layout, ends[0], place)) * to_sx(names["weight"])
    outputs = [
        mass_matrix(density, layout, node_point(layout, ends[0], along, place)) * to_sx(names["weight"]),
        -ca.jacobian(load, to_sx(ends[0])) @ tangents[0],
    ]
    if along is not None:
        if equations.rule.cell == 1:
            forces = list(element_forces(density, equations.rule.strain, layout, (ends[0], ends[1]), place))
        else:
            forces = polynomial_forces(density, equations.rule.strain, layout, ends, place)
        both = ca.vertcat(*[to_sx(f) for f in forces]) * to_sx(names["length"])
        turn = ca.diagcat(*tangents)
        outputs.append(-ca.jacobian(both, ca.vertcat(*[to_sx(e) for e in ends])) @ turn)
    columns = [*(to_sx(e) for e in ends), *(to_sx(v) for v in names.values()), density.parameters, *extra.values()]
    inputs = ca.vertcat(*columns)
    used = {symbol.name() for symbol in ca.symvar(ca.vertcat(*[ca.vec(ca.densify(o)) for o in outputs]))}
    idle = np.array([symbol.name() not in used for symbol in ca.vertsplit(inputs)])
    vectors = [name for name in layout.fields if name not in layout.rotations]
    places_count = not vectors or density.depends("strain", *vectors)
    if not places_count:
        left = ca.vertcat(*[to_sx(ends[0][layout.rows_of(name)]) for name in vectors])
        places_count = bool(ca.depends_on(ca.vertcat(*[ca.vec(ca.densify(o)) for o in outputs[:2]]), left))
    return ca.Function("linearized", [inputs], [ca.densify(o) for o in outputs]), idle, places_count


def _matrices(system: System, values: np.ndarray) -> tuple[np.ndarray, Matrices]:
    """Masses of nodes (n, d, d); stiffness of elements, each at its first node, and of node loads (n, d, d).

    Elements of degree m have matrices of size (m + 1) d.
    """
    equations, layout = system.equations, system.layout
    function, idle, places_count = equations.once("linearization", lambda: _linearization(equations))
    inputs_at, ends = _inputs(system, values), equations.rule.cell + 1
    inputs_at[:, idle] = 0.0
    if not places_count:
        inputs_at = _shifted(layout, inputs_at, ends)
    scale = np.abs(inputs_at).max(axis=0)
    alike = (inputs_at / np.where(scale > 0.0, scale, 1.0)).round(12)
    _, first, again = np.unique(alike, axis=0, return_index=True, return_inverse=True)  # congruent elements
    width = ends * layout.dofs
    shaped = [_batch(np.asarray(m), len(first))[again.reshape(-1)] for m in function(inputs_at[first].T)]
    masses, loads = shaped[0], shaped[1]
    along = equations.density.lagrangian.interval
    elements = shaped[2] if along is not None else np.zeros((system.size, width, width))
    elements[_lengths(system) == 0.0] = 0.0
    return masses, (0.5 * (elements + elements.transpose(0, 2, 1)), 0.5 * (loads + loads.transpose(0, 2, 1)))


def _lengths(system: System) -> np.ndarray:
    """Length of the element that starts at a node, 0 where none does, shape (nodes,)."""
    found = np.zeros(system.size)
    if "length" in system.named:
        cell, spaces = system.equations.rule.cell, system.named["length"]
        starts = np.flatnonzero((system.slots % cell == 0) & (spaces > 0.0))
        found[starts] = sum(spaces[starts + k] for k in range(cell))
    return found


def _inputs(system: System, values: np.ndarray) -> np.ndarray:
    """Rows of inputs of the linearization, shape (nodes, inputs)."""
    cell, lengths = system.equations.rule.cell, _lengths(system)
    others = np.column_stack([np.roll(values, -1 - k, axis=0) for k in range(cell)])
    if cell > 1:
        others[lengths == 0.0] = 0.0  # nothing comes of these
    named = system.named
    zeros, ones = np.zeros(system.size), np.ones(system.size)
    here = named.get("here", zeros)
    along = system.equations.density.lagrangian.interval
    inverse = ones if along is None else system.values_of("inverse")
    columns = [inverse, here, np.roll(here, -cell), zeros, named["weight"], lengths]
    constants = [system.values_of(name) for name in system.equations.density.names]
    constants += [named[name] for name in placed(system.equations.varying)]
    return np.column_stack([values, others, *columns, *constants])


def _shifted(layout: Layout, rows: np.ndarray, ends: int) -> np.ndarray:
    """Inputs with every first node's vectors at the origin, where no term depends on where they are."""
    moved = rows.copy()
    for name in layout.fields:
        if name not in layout.rotations:
            left = layout.rows_of(name)
            for k in range(1, ends):
                other = slice(left.start + k * layout.rows, left.stop + k * layout.rows)
                moved[:, other] -= moved[:, left]
            moved[:, left] = 0.0
    return moved


def _batch(matrix: np.ndarray, count: int) -> np.ndarray:
    """(r, count·c) -> (count, r, c)."""
    r = matrix.shape[0]
    return matrix.reshape(r, count, -1).transpose(1, 0, 2)


def _scaled_elements(system: System, masses: np.ndarray, stiffness: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """M_e^(−½) K_e M_e^(−½) of elements, each with its share of its nodes' masses and loads; or of the lone nodes."""
    elements, loads = stiffness
    roots = _inverse_roots(masses)
    if "length" not in system.named:
        return roots @ loads @ roots
    lengths, weight, cell = _lengths(system), system.named["weight"], system.equations.rule.cell
    inside = np.flatnonzero(lengths > 0.0)
    d = system.layout.dofs
    k = elements[inside].copy()
    scale = np.zeros_like(k)
    for end, part in enumerate(lobatto_weights(cell)):
        node, own = inside + end, slice(end * d, (end + 1) * d)
        share = part * lengths[inside] / weight[node]
        k[:, own, own] += share[:, None, None] * loads[node]
        free = system.free[node].astype(float)
        scale[:, own, own] = roots[node] / np.sqrt(share)[:, None, None] * free[:, :, None] * free[:, None, :]
    return scale @ k @ scale


def _inverse_roots(masses: np.ndarray) -> np.ndarray:
    values, vectors = np.linalg.eigh(masses)
    return (vectors / np.sqrt(values)[:, None, :]) @ vectors.transpose(0, 2, 1)


def _largest(matrices: np.ndarray) -> float:
    """Upper bound, 1 % sharp, of the largest eigenvalue of any of a batch of symmetric matrices.

    (tr A^(2k))^(1/2k) with 2k = 256 by squaring; exact bound, and quicker than eigenvalues for large batches.
    """
    size = np.abs(matrices).max(initial=0.0)
    if size == 0.0:
        return 0.0
    rounded = (matrices / size).round(10).reshape(len(matrices), -1) + 0.0
    _, first = np.unique(rounded.view(f"V{rounded.shape[1] * 8}"), return_index=True)
    unique = matrices[first]
    power = unique / size
    log = np.zeros(len(unique))
    for k in range(8):
        power = power @ power
        norm = np.abs(power).max(axis=(1, 2))
        norm[norm == 0.0] = 1.0
        log += np.log(norm) / 2 ** (k + 1)
        power /= norm[:, None, None]
    trace = np.maximum(np.trace(power, axis1=1, axis2=2), 1e-300)
    return float(size * np.exp(log + np.log(trace) / 2**8).max())


def _assemble(
    system: System, masses: np.ndarray, stiffness: tuple[np.ndarray, np.ndarray], free: np.ndarray
) -> list[np.ndarray]:
    """M^(−½) K M^(−½) as a block banded matrix: its blocks (i, i + k), k = 0 ... m, shape (n − k, d, d) each."""
    elements, loads = stiffness
    n, d, cell = system.size, system.layout.dofs, system.equations.rule.cell
    roots = _inverse_roots(masses) * free[:, :, None] * free[:, None, :]
    bands = [loads.copy(), *(np.zeros((max(n - k, 0), d, d)) for k in range(1, cell + 1))]
    for k, band in enumerate(bands):
        for i in range(min(cell + 1 - k, n - k)):
            band[i:] += elements[: n - k - i, i * d : (i + 1) * d, (i + k) * d : (i + k + 1) * d]
    return [roots[: n - k] @ band @ roots[k:] for k, band in enumerate(bands)]


def _exact(bands: list[np.ndarray], ties: csc_array | None) -> float:
    """Largest eigenvalue of the block banded matrix + B Bᵀ, with a margin for rounding."""
    n, d, _ = bands[0].shape
    dense = np.zeros((n, d, n, d))
    nodes = np.arange(n)
    for k, band in enumerate(bands):
        dense[nodes[: n - k], :, nodes[k:], :] = band
        dense[nodes[k:], :, nodes[: n - k], :] = band.transpose(0, 2, 1)
    whole = dense.reshape(n * d, n * d)
    if ties is not None:
        whole = whole + (ties @ ties.T).toarray()
    return float(np.linalg.eigvalsh(whole)[-1]) * (1.0 + 1e-9)


def _certify(bands: list[np.ndarray], ties: csc_array | None, bound: float) -> float:
    """Smallest σ, to 2 %, found by bisection for which σ − A − B Bᵀ is positive definite.

    It is where σ − A is, and 1 − Bᵀ (σ − A)⁻¹ B too.
    """
    from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

    n, d, _ = bands[0].shape
    u = len(bands) * d - 1
    band = np.zeros((u + 1, n * d))  # upper form: band[u + i − k, k] = A[i, k]
    for shift, blocks in enumerate(bands):
        for i, k in np.ndindex(d, d):
            if (i <= k or shift) and len(blocks):
                column = k + shift * d
                band[u + i - column, column::d] = blocks[:, i, k]

    columns = None if ties is None else ties.toarray()

    def holds(sigma: float) -> bool:
        shifted = -band
        shifted[u] += sigma
        try:
            factor = cholesky_banded(shifted, check_finite=False)
            if columns is not None:
                solved = cho_solve_banded((factor, False), columns, check_finite=False)
                np.linalg.cholesky(np.eye(columns.shape[1]) - columns.T @ solved)
        except LinAlgError:
            return False
        return True

    low, high = 0.0, bound
    if not holds(high):  # cannot happen but for rounding
        return bound * (1.0 + 1e-9)
    while high > SHARPNESS * low and high > 1e-12 * bound:
        middle = 0.5 * (low + high) if low == 0.0 else np.sqrt(low * high)
        if holds(middle):
            high = middle
        else:
            low = middle
    return high
