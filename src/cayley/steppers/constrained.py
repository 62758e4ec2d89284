"""Step constrained systems of rules with corners in time: SHAKE between saved frames, RATTLE at them.

The kernels and the equations are those of discrete.constraint. The multipliers of a step are found by Newton's method
with the matrix G M⁻¹ Gᵀ at qʲ, block tridiagonal over the elements; an element is counted with its left node, and the
last node of a chain, which has none, with an identity.
"""

import math

import numpy as np
from numba import njit

from cayley.steppers.calls import call_kernel, call_setup

FINISHED, NOT_CONVERGED, NOT_FINITE, REDUNDANT = 0, 1, 2, 3
ITERATIONS = 50
SINGULAR = 1e-12
"""A pivot of the multipliers' matrix that is this part of its diagonal entry tells of a redundant constraint."""
_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def advance(  # type: ignore[no-untyped-def]
    calls, uniforms, data, at, nodes, count, fixed, loads, clock, stride, frames, memory, counts
):
    """Advance through len(frames) saves of stride steps each; the arguments are those of steppers.constrained_run.

    Returns: (outcome, number of the save); counts holds iterations in all, most in a step, failed step and node.
    """
    lanes, h = data.shape[2], clock[1]
    inverse, factor = np.zeros((nodes, count, count)), np.zeros((nodes, count, count))
    right, force, old = np.zeros((nodes, count)), np.zeros((nodes, count)), np.zeros((nodes, count))
    force[:] = memory[:, 0, :]
    counts[3] = _factorize(calls, uniforms, data, at, nodes, count, inverse, factor)
    if counts[3] >= 0:
        return REDUNDANT, 0
    for save in range(frames.shape[0]):
        floor = _floor(data, at, nodes)
        for j in range(stride):
            number = save * stride + j
            counts[2] = number
            part = 0.5 * h if j == 0 else h
            _kick(calls, uniforms, data, at, loads, clock, number, part)
            for a in range(nodes):
                block, lane = 1 + a // lanes, a % lanes
                for i in range(count):
                    guess = 2.0 * force[a, i] - old[a, i] if j > 1 else force[a, i]
                    data[block, at[6] + i, lane] = guess * part * data[block, at[13], lane]
            work = (inverse, factor, right)
            passes, solved = _solve(calls, uniforms, data, at, nodes, count, clock, number, work, floor)
            counts[0] += passes
            counts[1] = max(counts[1], passes)
            if not solved:
                return NOT_CONVERGED, save
            for a in range(nodes):
                block, lane = 1 + a // lanes, a % lanes
                for i in range(count):
                    old[a, i] = force[a, i]
                    length = data[block, at[13], lane]
                    force[a, i] = data[block, at[6] + i, lane] / (part * length) if length > 0.0 else 0.0
            for block in range(1, data.shape[0] - 1):
                data[block, at[0] : at[0] + at[1]] = data[block, at[4] : at[4] + at[1]]
                data[block, at[2] : at[2] + at[3]] = data[block, at[5] : at[5] + at[3]]
            counts[3] = _factorize(calls, uniforms, data, at, nodes, count, inverse, factor)
            if counts[3] >= 0:
                return REDUNDANT, save
        _kick(calls, uniforms, data, at, loads, clock, (save + 1) * stride, 0.5 * h)
        _hold(data, fixed)
        project(calls, uniforms, data, at, nodes, count, inverse, factor, right)
        _hold(data, fixed)
        check = 0.0
        for block in range(1, data.shape[0] - 1):
            for row in range(frames.shape[2]):
                for lane in range(lanes):
                    frames[save, block - 1, row, lane] = data[block, row, lane]
                    check += 0.0 * data[block, row, lane]
        if not math.isfinite(check):
            return NOT_FINITE, save
    memory[:, 0, :] = force
    return FINISHED, frames.shape[0]


@njit(**_options)
def prepare_project(calls, uniforms, data, at, nodes, count, fixed):  # type: ignore[no-untyped-def]
    """Project the momenta in the blocks; returns the node of a redundant constraint, or −1."""
    inverse, factor = np.zeros((nodes, count, count)), np.zeros((nodes, count, count))
    found = _factorize(calls, uniforms, data, at, nodes, count, inverse, factor)
    if found < 0:
        _hold(data, fixed)
        project(calls, uniforms, data, at, nodes, count, inverse, factor, np.zeros((nodes, count)))
        _hold(data, fixed)
    return found


@njit(**_options)
def project(calls, uniforms, data, at, nodes, count, inverse, factor, right):  # type: ignore[no-untyped-def]
    """μ − Gᵀ ν with G M⁻¹ (μ − Gᵀ ν) = 0, twice so that rounding of the first is gone too."""
    lanes, dofs = data.shape[2], at[3]
    for _ in range(2):
        _call(calls, uniforms, data, 4)
        for a in range(nodes):
            for i in range(count):
                right[a, i] = data[1 + a // lanes, at[12] + i, a % lanes]
        _substitute(right, inverse, factor)
        for a in range(nodes):
            block, lane = 1 + a // lanes, a % lanes
            after, place = 1 + (a + 1) // lanes, (a + 1) % lanes
            for i in range(count):
                for d in range(dofs):
                    data[block, at[2] + d, lane] -= data[block, at[8] + i * dofs + d, lane] * right[a, i]
                    if a + 1 < nodes:
                        data[after, at[2] + d, place] -= data[block, at[9] + i * dofs + d, lane] * right[a, i]


@njit(**_options)
def _solve(calls, uniforms, data, at, nodes, count, clock, number, work, floor):  # type: ignore[no-untyped-def]
    """Newton's method for the multipliers of a step; returns (passes, converged)."""
    inverse, factor, right = work
    lanes, last = data.shape[2], math.inf
    _times(uniforms, 1, clock, clock[1], number, number + 1)
    call_setup(calls[1, 1], uniforms[1].ctypes.data)
    for passes in range(ITERATIONS):
        if _run(calls, uniforms, data, 1) > 0:
            return passes + 1, False
        _call(calls, uniforms, data, 2)
        size = 0.0
        for a in range(nodes):
            for i in range(count):
                value = data[1 + a // lanes, at[7] + i, a % lanes]
                right[a, i] = value / clock[1]
                if not abs(value) <= size:
                    size = abs(value)
        if size <= floor or (size <= 1e-11 and size > 0.5 * last):
            return passes + 1, True
        if not size < 1e3:
            return passes + 1, False
        last = size
        _substitute(right, inverse, factor)
        for a in range(nodes):
            for i in range(count):
                data[1 + a // lanes, at[6] + i, a % lanes] += right[a, i]
    return ITERATIONS, False


@njit(**_options)
def _factorize(calls, uniforms, data, at, nodes, count, inverse, factor):  # type: ignore[no-untyped-def]
    """Block LU of G M⁻¹ Gᵀ: inverses of the pivots Dₑ and Dₑ₋₁⁻¹ Cₑ; returns the node of a singular one, or −1."""
    _call(calls, uniforms, data, 3)
    lanes = data.shape[2]
    pivot, coupling = np.zeros((count, count)), np.zeros((count, count))
    for a in range(nodes):
        block, lane = 1 + a // lanes, a % lanes
        there = data[block, at[13], lane] > 0.0
        for i in range(count):
            for k in range(count):
                pivot[i, k] = data[block, at[10] + i * count + k, lane] if there else (1.0 if i == k else 0.0)
                coupling[i, k] = data[block, at[11] + i * count + k, lane] if there and a > 0 else 0.0
        scale = pivot.copy()
        if a > 0:
            for i in range(count):
                for k in range(count):
                    total = 0.0
                    for m in range(count):
                        total += inverse[a - 1, i, m] * coupling[m, k]
                    factor[a, i, k] = total
            for i in range(count):
                for k in range(count):
                    for m in range(count):
                        pivot[i, k] -= coupling[m, i] * factor[a, m, k]
        out = inverse[a]
        for i in range(count):
            for k in range(count):
                out[i, k] = 1.0 if i == k else 0.0
        for c in range(count):
            if not pivot[c, c] > SINGULAR * scale[c, c]:
                return a
            turn = 1.0 / pivot[c, c]
            for k in range(count):
                pivot[c, k] *= turn
                out[c, k] *= turn
            for i in range(count):
                if i != c:
                    f = pivot[i, c]
                    for k in range(count):
                        pivot[i, k] -= f * pivot[c, k]
                        out[i, k] -= f * out[c, k]
    return -1


@njit(**_options)
def _substitute(right, inverse, factor):  # type: ignore[no-untyped-def]
    """Solve with the block LU in place."""
    nodes, count = right.shape
    y = np.zeros(count)
    for a in range(nodes):
        for i in range(count):
            y[i] = right[a, i]
            if a > 0:
                for k in range(count):
                    y[i] -= factor[a, k, i] * right[a - 1, k]
        for i in range(count):
            right[a, i] = y[i]
    for a in range(nodes - 1, -1, -1):
        for i in range(count):
            y[i] = 0.0
            for k in range(count):
                y[i] += inverse[a, i, k] * right[a, k]
            if a + 1 < nodes:
                for k in range(count):
                    y[i] -= factor[a + 1, i, k] * right[a + 1, k]
        for i in range(count):
            right[a, i] = y[i]


@njit(**_options)
def _floor(data, at, nodes):  # type: ignore[no-untyped-def]
    """What rounding leaves of g: ε (1 + ‖x‖/ds)."""
    most, lanes = 0.0, data.shape[2]
    for a in range(nodes):
        block, lane = 1 + a // lanes, a % lanes
        length = data[block, at[13], lane]
        if length > 0.0:
            for row in range(at[1]):
                most = max(most, abs(data[block, at[0] + row, lane]) / length)
    return 2e-15 * (1.0 + 0.5 * most)


@njit(**_options)
def _kick(calls, uniforms, data, at, loads, clock, number, part):  # type: ignore[no-untyped-def]
    """Add part × all forces at a time node to the momenta."""
    table, entries, scales = loads
    _times(uniforms, 0, clock, part, number, number)
    _call(calls, uniforms, data, 0)
    for e in range(entries.shape[0]):
        block, lane, row = entries[e, 0], entries[e, 1], entries[e, 2]
        turn, form, column = entries[e, 3], entries[e, 4], entries[e, 5]
        s = part * scales[e]
        u, v, w = s * table[number, column], s * table[number, column + 1], s * table[number, column + 2]
        if form:
            r = 2.0 * data[block, turn, lane] * (1.0 if form == 2 else -1.0)
            x, y, z = data[block, turn + 1, lane], data[block, turn + 2, lane], data[block, turn + 3, lane]
            a, b, c = y * w - z * v, z * u - x * w, x * v - y * u
            u, v, w = (
                u + r * a + 2.0 * (y * c - z * b),
                v + r * b + 2.0 * (z * a - x * c),
                w + r * c + 2.0 * (x * b - y * a),
            )
        data[block, row, lane] += u
        data[block, row + 1, lane] += v
        data[block, row + 2, lane] += w


@njit(**_options)
def _hold(data, fixed):  # type: ignore[no-untyped-def]
    for k in range(fixed.shape[0]):
        data[fixed[k, 0], fixed[k, 1], fixed[k, 2]] = 0.0


@njit(**_options)
def _times(uniforms, kind, clock, h, number, following):  # type: ignore[no-untyped-def]
    uniforms[kind, 0] = h
    uniforms[kind, 1] = clock[0] + (clock[2] + number) * clock[1]
    uniforms[kind, 2] = clock[0] + (clock[2] + following) * clock[1]


@njit(**_options)
def _call(calls, uniforms, data, kind):  # type: ignore[no-untyped-def]
    call_setup(calls[kind, 1], uniforms[kind].ctypes.data)
    _run(calls, uniforms, data, kind)


@njit(**_options)
def _run(calls, uniforms, data, kind):  # type: ignore[no-untyped-def]
    return call_kernel(calls[kind, 0], data.ctypes.data, uniforms[kind].ctypes.data, 1, data.shape[0] - 1)


@njit(**_options)
def instant(calls, uniforms, data, at, nodes, count, turning):  # type: ignore[no-untyped-def]
    """Solve G M⁻¹ Gᵀ ι = G M⁻¹ f + turning, with f in the rows of momenta; the solution replaces turning."""
    inverse, factor = np.zeros((nodes, count, count)), np.zeros((nodes, count, count))
    found = _factorize(calls, uniforms, data, at, nodes, count, inverse, factor)
    _call(calls, uniforms, data, 4)
    for a in range(nodes):
        for i in range(count):
            turning[a, i] += data[1 + a // data.shape[2], at[12] + i, a % data.shape[2]]
    _substitute(turning, inverse, factor)
    return found
