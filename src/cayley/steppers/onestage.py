"""Step systems by rules with one stage in time and two nodes in an element: midpoint, and its kin.

The equations are those of steppers.galerkin with r = m = 1,

    μ_a + D_{a,0} L_d = 0 -> q¹,      μ_a⁺ = D_{a,1} L_d,

but one kernel assembles residual, momenta and block tridiagonal tangent of all nodes in lanes (discrete.fused), which
is about ten times as fast as contracting point by point.
"""

import math

import numpy as np
from numba import njit

from cayley.steppers.calls import call_kernel, call_setup
from cayley.steppers.controls import hand_turned, hold_turn
from cayley.steppers.dense import solve_chain
from cayley.steppers.galerkin import (
    FIRST_PART,
    FLOOR,
    ITERATIONS,
    LARGEST_GROWTH,
    LARGEST_TURN,
    QUICK_ITERATIONS,
    SMALLEST_GROWTH,
    SMALLEST_PART,
    STEP_TOLERANCE,
    WILD_GROWTH,
    note,
)

FINISHED, NOT_CONVERGED, NOT_FINITE = 0, 1, 2
_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def advance(problem, memory, warm, clock, stride, frames, counts, history):  # type: ignore[no-untyped-def]
    """Advance through len(frames) saves of stride steps each; see steppers.galerkin.advance.

    problem = (addresses of the kernel, blocks, rows, uniforms, fields, free, mesh, momenta, loads), where rows are
    their number, then those where residual, momentum, diagonal, upper and lower begin, and mesh = (chains of nodes,
    1/extent, a tuple as long as a node has degrees of freedom).

    Returns: (outcome, number of the save).
    """
    call, data, at, uniforms, fields, free, mesh, momenta, _ = problem
    nodes, dofs, rows, lanes = momenta.shape[0], len(mesh[2]), at[0], data.shape[2]
    upper, right = np.zeros((nodes, dofs, dofs)), np.zeros((nodes, dofs))
    accepted, taken, push = np.zeros((nodes, rows)), np.zeros((nodes, dofs)), np.zeros((nodes, 2 * dofs))
    work = (upper, right, accepted, taken, push, history)
    uniforms[0] = clock[1]
    for save in range(frames.shape[0]):
        for j in range(stride):
            number = save * stride + j
            uniforms[1] = clock[0] + (clock[2] + number + 0.5) * clock[1]
            call_setup(call[1], uniforms.ctypes.data)
            solved, worst = _solve_step(problem, memory, warm or number > 0, number, work, counts)
            counts[2], counts[3] = number, worst
            if not solved:
                return NOT_CONVERGED, save
            _hand_on(data, at, fields, free, momenta, push)
            for a in range(nodes):
                block, lane = 1 + a // lanes, a % lanes
                for row in range(rows):
                    memory[a, 0, row] = data[block, row, lane]
                    data[block, row, lane] = data[block, rows + row, lane]
        check = 0.0
        for a in range(nodes):
            block, lane = 1 + a // lanes, a % lanes
            for row in range(rows):
                frames[save, a, row] = data[block, row, lane]
                check += 0.0 * data[block, row, lane]
            for d in range(dofs):
                frames[save, a, rows + d] = momenta[a, d]
                check += 0.0 * momenta[a, d]
        if not math.isfinite(check):
            return NOT_FINITE, save
    return FINISHED, frames.shape[0]


@njit(**_options)
def _solve_step(problem, memory, warm, number, work, counts):  # type: ignore[no-untyped-def]
    """Newton's method, then with care, then with care from the state itself, then along shorter steps."""
    _, data, at, _, fields, free, _, momenta, _ = problem
    for attempt in range(3):
        _start(data, at[0], memory, fields, momenta.shape[0], attempt < 2 and warm)
        _hold(data, at[0], fields, free)
        passes, worst, solved = _newton(problem, number, work, attempt > 0)
        counts[0] += passes
        counts[1] = max(counts[1], passes)
        if solved:
            return True, worst
    _start(data, at[0], memory, fields, momenta.shape[0], False)
    return _follow(problem, number, work, counts)


@njit(**_options)
def _follow(problem, number, work, counts):  # type: ignore[no-untyped-def]
    """Follow the solution from that of a much shorter step; see galerkin._follow."""
    call, data, at, uniforms, fields, free, _, momenta, _ = problem
    nodes, rows, h = momenta.shape[0], at[0], uniforms[0]
    reached = np.zeros((nodes, rows))
    size, good, growth = FIRST_PART, 0.0, 2.0
    while True:
        uniforms[0] = size * h
        call_setup(call[1], uniforms.ctypes.data)
        passes, worst, solved = _newton(problem, number, work, False)
        counts[0] += passes
        if solved and size == 1.0:
            return True, worst
        if solved:
            good = size
            _swap(data, rows, reached, nodes, True)
        else:
            growth = math.sqrt(growth)
            if good == 0.0 or growth < SMALLEST_GROWTH:
                uniforms[0] = h
                return False, worst
            _swap(data, rows, reached, nodes, False)
        size = min(1.0, good * growth)
        _stretch(data, rows, fields, nodes, size / good)
        _hold(data, rows, fields, free)


@njit(**_options)
def _newton(problem, number, work, careful):  # type: ignore[no-untyped-def]
    """Solve one step; returns (iterations, node of the largest correction, converged); see galerkin._newton."""
    _, data, at, _, fields, free, mesh, momenta, _ = problem
    upper, right, accepted, taken, push, history = work
    chains, extent, size_of_node = mesh
    nodes, dofs, lanes = momenta.shape[0], len(size_of_node), data.shape[2]
    last, part, worst = math.inf, 1.0, 0
    _swap(data, at[0], accepted, nodes, True)
    for iteration in range(ITERATIONS if careful else QUICK_ITERATIONS):
        _assemble(problem, number, push)
        residual = 0.0
        for a in range(nodes):
            block, lane = 1 + a // lanes, a % lanes
            for d in range(dofs):
                right[a, d] = -(momenta[a, d] + data[block, at[1] + d, lane] + push[a, d]) if free[a, d] else 0.0
                residual = max(residual, abs(right[a, d]))
        for c in range(chains.shape[0]):
            solve_chain(data, at[3:], chains[c, 0], chains[c, 1], free, upper, right, size_of_node)
        size, turn, worst = _measure(right, fields, extent)
        note(history, iteration, size, residual)
        if careful and not size <= max(LARGEST_GROWTH * last, FLOOR) and part > SMALLEST_PART:  # also for NaN
            part *= 0.5
            _swap(data, at[0], accepted, nodes, False)
            _move(data, at[0], taken, fields, part)
            _hold(data, at[0], fields, free)
            continue
        if not math.isfinite(size) or (not careful and size > max(WILD_GROWTH * last, FLOOR)):
            return iteration + 1, worst, False
        _swap(data, at[0], accepted, nodes, True)
        taken[:] = right
        part = min(1.0, LARGEST_TURN / turn) if turn > 0.0 else 1.0
        _move(data, at[0], taken, fields, part)
        _hold(data, at[0], fields, free)
        if size <= STEP_TOLERANCE or (size <= FLOOR and size > 0.3 * last):
            _assemble(problem, number, push)
            return iteration + 1, worst, True
        last = size
    return ITERATIONS, worst, False


@njit(**_options)
def _assemble(problem, number, push):  # type: ignore[no-untyped-def]
    """Residual, momenta and tangent of all nodes by the kernel, and loads."""
    call, data, at, uniforms, fields, _, _, _, loads = problem
    call_kernel(call[0], data.ctypes.data, uniforms.ctypes.data, 1, data.shape[0] - 1)
    _load(data, at, fields, loads, number, uniforms[0], push)


@njit(**_options)
def _swap(data, rows, copy, nodes, outward):  # type: ignore[no-untyped-def]
    """Copy the unknown values of all nodes out of the blocks, or back."""
    lanes = data.shape[2]
    for a in range(nodes):
        block, lane = 1 + a // lanes, a % lanes
        for row in range(rows):
            if outward:
                copy[a, row] = data[block, rows + row, lane]
            else:
                data[block, rows + row, lane] = copy[a, row]


@njit(**_options)
def _start(data, rows, memory, fields, nodes, onward):  # type: ignore[no-untyped-def]
    """First guess: the last step once more, its rotations normalized, or no motion."""
    lanes = data.shape[2]
    for a in range(nodes):
        block, lane = 1 + a // lanes, a % lanes
        for row in range(rows):
            now = data[block, row, lane]
            data[block, rows + row, lane] = 2.0 * now - memory[a, 0, row] if onward else now
    if onward:
        _normalize(data, rows, fields, nodes)


@njit(**_options)
def _stretch(data, rows, fields, nodes, factor):  # type: ignore[no-untyped-def]
    """So many times the way from start to end, rotations normalized."""
    lanes = data.shape[2]
    for a in range(nodes):
        block, lane = 1 + a // lanes, a % lanes
        for row in range(rows):
            start = data[block, row, lane]
            data[block, rows + row, lane] = start + factor * (data[block, rows + row, lane] - start)
    _normalize(data, rows, fields, nodes)


@njit(**_options)
def _normalize(data, rows, fields, nodes):  # type: ignore[no-untyped-def]
    """Bring the unknown rotations to length one."""
    lanes = data.shape[2]
    for a in range(nodes):
        block, lane = 1 + a // lanes, a % lanes
        for f in range(fields.shape[0]):
            if fields[f, 0]:
                size = 0.0
                for k in range(4):
                    size += data[block, rows + fields[f, 1] + k, lane] ** 2
                for k in range(4):
                    data[block, rows + fields[f, 1] + k, lane] /= math.sqrt(size)


@njit(**_options)
def _hold(data, rows, fields, free):  # type: ignore[no-untyped-def]
    """Held components at the end of the step are those at its start; see controls.hold."""
    lanes = data.shape[2]
    start, point = np.empty(4), np.empty(4)
    for a in range(free.shape[0]):
        block, lane = 1 + a // lanes, a % lanes
        for f in range(fields.shape[0]):
            row, dof = fields[f, 1], fields[f, 2]
            if not fields[f, 0]:
                for k in range(fields[f, 3]):
                    if not free[a, dof + k]:
                        data[block, rows + row + k, lane] = data[block, row + k, lane]
            elif not (free[a, dof] and free[a, dof + 1] and free[a, dof + 2]):
                for k in range(4):
                    start[k], point[k] = data[block, row + k, lane], data[block, rows + row + k, lane]
                hold_turn(start, point, free[a, dof : dof + 3])
                for k in range(4):
                    data[block, rows + row + k, lane] = point[k]


@njit(**_options)
def _hand_on(data, at, fields, free, momenta, push):  # type: ignore[no-untyped-def]
    """Momenta at the end of the step, and what its equations leave unsolved; see controls.hand_on."""
    rows, lanes, dofs = at[0], data.shape[2], momenta.shape[1]
    unsolved, before, after = np.empty(dofs), np.empty(4), np.empty(4)
    for a in range(momenta.shape[0]):
        block, lane = 1 + a // lanes, a % lanes
        for d in range(dofs):
            unsolved[d] = -(momenta[a, d] + data[block, at[1] + d, lane] + push[a, d]) if free[a, d] else 0.0
            momenta[a, d] = data[block, at[2] + d, lane] + push[a, dofs + d]
        for f in range(fields.shape[0]):
            row, dof = fields[f, 1], fields[f, 2]
            if fields[f, 0]:
                for k in range(4):
                    before[k], after[k] = data[block, row + k, lane], data[block, rows + row + k, lane]
                hand_turned(before, after, 0, unsolved[dof : dof + 3], momenta[a, dof:])
            else:
                for k in range(fields[f, 3]):
                    momenta[a, dof + k] -= unsolved[dof + k]
        for d in range(dofs):
            if not free[a, d]:
                momenta[a, d] = 0.0


@njit(**_options)
def _measure(right, fields, extent):  # type: ignore[no-untyped-def]
    """Size of a correction (turns in radians, vectors relative to the extent), its largest turn, and where it is."""
    size, turn, worst = 0.0, 0.0, 0
    for a in range(right.shape[0]):
        for f in range(fields.shape[0]):
            for k in range(fields[f, 3]):
                one = abs(right[a, fields[f, 2] + k])
                if fields[f, 0]:
                    turn = max(turn, one)
                else:
                    one *= extent
                if not one <= size:
                    size, worst = one, a
    return size, turn, worst


@njit(**_options)
def _move(data, rows, right, fields, part):  # type: ignore[no-untyped-def]
    """Move the unknown values by part of a correction: x + part η, p Cay(part η/2)."""
    lanes = data.shape[2]
    for n in range(right.shape[0]):
        block, lane = 1 + n // lanes, n % lanes
        for f in range(fields.shape[0]):
            row, dof = rows + fields[f, 1], fields[f, 2]
            if not fields[f, 0]:
                for k in range(fields[f, 3]):
                    data[block, row + k, lane] += part * right[n, dof + k]
                continue
            x, y, z = 0.5 * part * right[n, dof], 0.5 * part * right[n, dof + 1], 0.5 * part * right[n, dof + 2]
            square = x * x + y * y + z * z
            cosine = 1.0 / math.sqrt(1.0 + square)
            small = -square * cosine * cosine / (1.0 + cosine)
            x, y, z = cosine * x, cosine * y, cosine * z
            w, a = data[block, row, lane], data[block, row + 1, lane]
            b, c = data[block, row + 2, lane], data[block, row + 3, lane]
            data[block, row, lane] = w + (w * small - a * x - b * y - c * z)
            data[block, row + 1, lane] = a + (a * small + w * x + b * z - c * y)
            data[block, row + 2, lane] = b + (b * small + w * y + c * x - a * z)
            data[block, row + 3, lane] = c + (c * small + w * z + a * y - b * x)


@njit(**_options)
def _load(data, at, fields, loads, number, h, push):  # type: ignore[no-untyped-def]
    """Time-dependent loads at the middle of the step, on both ends of it, left-trivialized.

    A body moment m does the work m·ε with ε = 2 Im(z̄ δz)/‖z‖², z = (p⁰ + p¹)/2: on pⁱ that is Im(p̄ⁱ z m)/(2 ‖z‖²).
    """
    table, entries, scales = loads
    push[:] = 0.0
    rows, lanes, dofs = at[0], data.shape[2], push.shape[1] // 2
    z, ends = np.empty(4), np.empty((2, 4))
    for e in range(entries.shape[0]):
        a, turn, form = entries[e, 0], entries[e, 2], entries[e, 3]
        column, moment, dof = entries[e, 4], entries[e, 5], entries[e, 6]
        s = h * scales[e]
        x, y, v = s * table[number, 0, column], s * table[number, 0, column + 1], s * table[number, 0, column + 2]
        if x == 0.0 and y == 0.0 and v == 0.0:
            continue
        block, lane = 1 + a // lanes, a % lanes
        size = 0.0
        if form or moment:
            for k in range(4):
                ends[0, k], ends[1, k] = data[block, turn + k, lane], data[block, rows + turn + k, lane]
                z[k] = 0.5 * (ends[0, k] + ends[1, k])
                size += z[k] * z[k]
        if form:
            sign = 1.0 if form == 2 else -1.0
            w, i, j, l = z[0], sign * z[1], sign * z[2], sign * z[3]
            p, q, r = j * v - l * y, l * x - i * v, i * y - j * x
            x, y, v = (
                x + 2.0 * (w * p + j * r - l * q) / size,
                y + 2.0 * (w * q + l * p - i * r) / size,
                v + 2.0 * (w * r + i * q - j * p) / size,
            )
        if not moment:
            for end in range(2):
                push[a, end * dofs + dof] += 0.5 * x
                push[a, end * dofs + dof + 1] += 0.5 * y
                push[a, end * dofs + dof + 2] += 0.5 * v
            continue
        w, i, j, l = z[0], z[1], z[2], z[3]
        g0, g1 = -(i * x + j * y + l * v) / size, (w * x + j * v - l * y) / size
        g2, g3 = (w * y + l * x - i * v) / size, (w * v + i * y - j * x) / size
        for end in range(2):
            w, i, j, l = ends[end, 0], ends[end, 1], ends[end, 2], ends[end, 3]
            push[a, end * dofs + dof] += 0.5 * (w * g1 - i * g0 - j * g3 + l * g2)
            push[a, end * dofs + dof + 1] += 0.5 * (w * g2 - j * g0 - l * g1 + i * g3)
            push[a, end * dofs + dof + 2] += 0.5 * (w * g3 - l * g0 - i * g2 + j * g1)
