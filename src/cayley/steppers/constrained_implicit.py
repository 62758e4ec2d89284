"""Step constrained systems of implicit rules: Newton's method on the saddle point of a step.

With D_i L_d of steppers.galerkin and the multipliers λ_i at the control times 0 ... r − 1,

    μ + D_0 L_d + h Σ Gᵀ(q_0) λ_0 = 0,   D_i L_d + h Σ Gᵀ(q_i) λ_i = 0 (0 < i < r),   g(q_i) = 0 (0 < i <= r),

Σ over strain points, weighted by length, and μ⁺ = D_r L_d. At saved frames momenta are projected (RATTLE); the
multipliers λ_0 of the next step take up the difference. Unknowns stand along the chain, those of an element's
multipliers between its nodes: the matrix is banded, and row pivots need no special case for supports.

Source: Wenger, Ober-Blöbaum, Leyendecker (2017), Construction and analysis of higher order variational integrators for
dynamical systems with holonomic constraints; projection: steppers.constrained.
"""

import math

import numpy as np
from numba import njit

from cayley.steppers.band import factorize_band, solve_band
from cayley.steppers.constrained import prepare_project
from cayley.steppers.contraction import assemble, combine, evaluate, first_guess
from cayley.steppers.controls import (
    add_trivialized,
    hand_on,
    hold,
    measure,
    move,
    trivialize,
    turn_correction,
)
from cayley.steppers.galerkin import (
    FLOOR,
    ITERATIONS,
    LARGEST_GROWTH,
    LARGEST_TURN,
    LEFT_TOLERANCE,
    QUICK_ITERATIONS,
    SLOW,
    SMALLEST_PART,
    STEP_TOLERANCE,
    WILD_GROWTH,
    note,
)

FINISHED, NOT_CONVERGED, NOT_FINITE, REDUNDANT, TENSE = 0, 1, 2, 3, 4
_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def advance(  # type: ignore[no-untyped-def]
    calls, rule, mesh, work, state, saddle, frame, warm, loads, clock, stride, frames, counts
):
    """Advance through len(frames) saves of stride steps each; arguments as in steppers.constrained_implicit_plan.

    Returns: (outcome, number of the save); counts holds iterations in all, most in a step, failed step and node.
    """
    control, momenta, memory = state
    multipliers = saddle[0]
    elements = mesh[1]
    nodes, last, rows = control.shape[0], control.shape[1] - 1, control.shape[2]
    kept = memory[:, :, :rows].copy()
    for save in range(frames.shape[0]):
        for j in range(stride):
            number = save * stride + j
            begin = clock[0] + (clock[2] + number) * clock[1]
            solved, worst = False, 0
            for attempt in range(3):
                onward = warm or number > 0
                first_guess(calls, rule, mesh, work, state, kept, onward, attempt > 1, begin, clock[1])
                for e in range(elements.shape[0]):
                    a = int(elements[e, 0])
                    for i in range(last):
                        multipliers[e, i] = memory[a, i, rows:]
                passes, worst, solved = _newton(
                    calls, rule, mesh, work, state, saddle, loads, number, begin, clock[1], attempt > 0
                )
                counts[0] += passes
                counts[1] = max(counts[1], passes)
                if solved:
                    break
            counts[2], counts[3] = number, worst
            if not solved:
                found = _project(frame, control, momenta)
                if found < 0:
                    return NOT_CONVERGED, save
                counts[3] = found
                return REDUNDANT, save
            hand_on(mesh, work, control, momenta)
            kept[:] = control[:, :last]
            for e in range(elements.shape[0]):
                a = int(elements[e, 0])
                for i in range(last):
                    memory[a, i, rows:] = multipliers[e, i]
            control[:, 0] = control[:, last]
            if not mesh[6] and number > 0:  # screw strains; the first multipliers also take up a blow
                counts[3] = _overstrained(mesh, work, saddle, clock[1])
                if counts[3] >= 0:
                    return TENSE, save
        found = _project(frame, control, momenta)
        if found >= 0:
            counts[3] = found
            return REDUNDANT, save
        check = 0.0
        for a in range(nodes):
            for k in range(rows):
                frames[save, a, k] = control[a, 0, k]
                check += 0.0 * control[a, 0, k]
            for d in range(momenta.shape[1]):
                frames[save, a, rows + d] = momenta[a, d]
                check += 0.0 * momenta[a, d]
        if not math.isfinite(check):
            return NOT_FINITE, save
    memory[:, :, :rows] = kept
    return FINISHED, frames.shape[0]


@njit(**_options)
def _project(frame, control, momenta):  # type: ignore[no-untyped-def]
    """Project the momenta at the first control nodes; returns the node of a redundant constraint, or −1."""
    calls, uniforms, data, at, count, fixed = frame
    nodes, rows, dofs, lanes = control.shape[0], control.shape[2], momenta.shape[1], data.shape[2]
    for a in range(nodes):
        block, lane = 1 + a // lanes, a % lanes
        for row in range(rows):
            data[block, at[0] + row, lane] = control[a, 0, row]
        for d in range(dofs):
            data[block, at[2] + d, lane] = momenta[a, d]
    found = prepare_project(calls, uniforms, data, at, nodes, count, fixed)
    if found < 0:
        for a in range(nodes):
            for d in range(dofs):
                momenta[a, d] = data[1 + a // lanes, at[2] + d, a % lanes]
    return found


@njit(**_options)
def _newton(  # type: ignore[no-untyped-def]
    calls, rule, mesh, work, state, saddle, loads, number, begin, h, careful
):
    """Solve one step; returns (iterations, node of the largest correction, converged); see steppers.galerkin."""
    control, right = state[0], work[5]
    accepted, taken = work[12], work[13]
    multipliers, change = saddle[0], saddle[1]
    held, moved = multipliers.copy(), np.zeros_like(multipliers)
    accepted[:] = control
    last, part, worst, fresh = math.inf, 1.0, 0, True
    for iteration in range(ITERATIONS if careful else QUICK_ITERATIONS):
        assemble(calls, rule, mesh, work, state, loads, number, begin, h, fresh)
        _constrain(calls, rule, mesh, work, saddle, begin, h, fresh, iteration == 0)
        if fresh and _factorize(mesh, rule, work, saddle, h) >= 0:
            return iteration + 1, worst, False
        residual = np.abs(right).max()
        _solve(mesh, work, saddle)
        size, turn, worst = measure(mesh, right, control)
        note(work[14], iteration, size, residual)
        if careful and not size <= LARGEST_GROWTH * last and part > SMALLEST_PART:  # also for NaN
            part *= 0.5
            control[:] = accepted
            multipliers[:] = held + part * moved
            move(mesh, taken, control, part)
            hold(mesh, control)
            continue
        if not math.isfinite(size) or (not careful and size > WILD_GROWTH * last):
            return iteration + 1, worst, False
        accepted[:], taken[:] = control, right
        held[:], moved[:] = multipliers, change
        part = min(1.0, LARGEST_TURN / turn) if turn > 0.0 else 1.0
        multipliers[:] = held + part * moved
        move(mesh, taken, control, part)
        hold(mesh, control)
        rate = size / last  # 0 at first
        settled = size <= STEP_TOLERANCE or (size <= FLOOR and rate > 0.3)
        if (fresh and settled) or (0.0 < rate < SLOW and size * rate <= LEFT_TOLERANCE):
            assemble(calls, rule, mesh, work, state, loads, number, begin, h, False)  # what is left, and momenta
            _constrain(calls, rule, mesh, work, saddle, begin, h, False, False)
            return iteration + 1, worst, True
        fresh = careful or rate > SLOW
        last = size
    return ITERATIONS, worst, False


@njit(**_options)
def _constrain(calls, rule, mesh, work, saddle, begin, h, tangent, first):  # type: ignore[no-untyped-def]
    """Evaluate g and G at the control times, add the forces of the multipliers and, if wanted, their tangent."""
    multipliers, _, points, gradients, violation, force = (
        saddle[0], saddle[1], saddle[2], saddle[3], saddle[4], saddle[5],
    )  # fmt: skip
    phi, psi, heavy = rule[4], rule[5], rule[6]
    control, right, diagonal = work[9], work[5], work[2]
    half, moved, full, _, _, index = work[10]
    elements, fields, free, scaled = mesh[1], mesh[3], mesh[4], mesh[6]
    nodes, order, rows = control.shape[0], control.shape[1], control.shape[2]
    gauss, width, dofs, lanes = phi.shape[0], phi.shape[1], free.shape[1], points.shape[3]
    count = violation.shape[3]
    upper = points.shape[2] - rows * (2 * rows + 1)
    jacobian = upper - count * 2 * rows
    values, given = jacobian - count, jacobian - 2 * count
    row_of = np.zeros(rows)
    for i in range(0 if first else 1, order):
        data = points[i]
        for e in range(elements.shape[0]):
            start, inverse = int(elements[e, 0]), elements[e, 2] if scaled else 1.0
            for g in range(gauss):
                block, lane = (e * gauss + g) // lanes, (e * gauss + g) % lanes
                for row in range(rows):
                    value, slope = 0.0, 0.0
                    for a in range(width):
                        value += phi[g, a] * control[start + a, i, row]
                        slope += psi[g, a] * inverse * control[start + a, i, row]
                    data[block, row, lane] = value
                    data[block, rows + row, lane] = slope
                for c in range(count):
                    data[block, given + c, lane] = multipliers[e, min(i, order - 2), g * count + c]
        evaluate(calls, work[8], 2, data, begin + rule[8][i] * h)
        for e in range(elements.shape[0]):
            start, inverse = int(elements[e, 0]), elements[e, 2] if scaled else 1.0
            for g in range(gauss):
                block, lane = (e * gauss + g) // lanes, (e * gauss + g) % lanes
                for c in range(count):
                    at = jacobian + c * 2 * rows
                    violation[i, e, g, c] = data[block, values + c, lane]
                    for a in range(width):
                        for row in range(rows):
                            row_of[row] = (
                                phi[g, a] * data[block, at + row, lane]
                                + psi[g, a] * inverse * data[block, at + rows + row, lane]
                            )
                        trivialize(row_of, control[start + a, i], fields, gradients[i, e, g, a, c])
    for e in range(elements.shape[0]):
        start, length = int(elements[e, 0]), elements[e, 1]
        for i in range(order - 1):
            for g in range(gauss):
                for c in range(count):
                    push = h * length * heavy[g] * multipliers[e, i, g * count + c]
                    for a in range(width):
                        block, base = mesh[2][start + a, 0], mesh[2][start + a, 1]
                        for d in range(dofs):
                            if free[start + a, d]:
                                right[block, base + i * dofs + d] -= push * gradients[i, e, g, a, c, d]
    if not tangent or order == 2:
        return
    force[:] = 0.0
    for i in range(1, order - 1):
        data = points[i]
        for e in range(elements.shape[0]):
            start, length, inverse = int(elements[e, 0]), elements[e, 1], elements[e, 2] if scaled else 1.0
            for g in range(gauss):
                block, lane = (e * gauss + g) // lanes, (e * gauss + g) % lanes
                w = h * length * heavy[g]
                for a in range(width):
                    for c in range(count):
                        at, push = jacobian + c * 2 * rows, w * multipliers[e, i, g * count + c]
                        for row in range(rows):
                            force[start + a, i, row] += push * (
                                phi[g, a] * data[block, at + row, lane]
                                + psi[g, a] * inverse * data[block, at + rows + row, lane]
                            )
                    for b in range(width):
                        s11, s12 = w * phi[g, a] * phi[g, b], w * phi[g, a] * psi[g, b] * inverse
                        s21, s22 = w * psi[g, a] * phi[g, b] * inverse, w * psi[g, a] * psi[g, b] * inverse * inverse
                        combine(data, block, lane, upper, index, s11, s12, s21, s22, full)
                        na, nb = start + a, start + b
                        ra, rb = mesh[2][na, 0], mesh[2][nb, 0]
                        out = diagonal[ra]
                        if ra < rb:
                            out = work[3][ra]
                        elif ra > rb:
                            out = work[4][ra]
                        row, column = mesh[2][na, 1] + i * dofs, mesh[2][nb, 1] + (i - 1) * dofs
                        add_trivialized(full, control[na, i], control[nb, i], fields, out, row, column, half, moved)
    for a in range(nodes):
        block, base = mesh[2][a, 0], mesh[2][a, 1]
        for i in range(1, order - 1):
            row, column = base + i * dofs, base + (i - 1) * dofs
            turn_correction(force[a, i], control[a, i], fields, diagonal[block], row, column)
            for d in range(dofs):
                if not free[a, d]:
                    diagonal[block, row + d], work[3][block, row + d], work[4][block, row + d] = 0.0, 0.0, 0.0
                    diagonal[block, row + d, row + d] = 1.0


@njit(**_options)
def _overstrained(mesh, work, saddle, h):  # type: ignore[no-untyped-def]
    """First node of an element whose multipliers make rotations that alternate from node to node unstable, or −1.

    The screw strain of an element depends on such rotations, and forces of multipliers act as explicit ones do: they
    need h² K/4 < M with K = −λ·∂²g along (η, −η) and M the inertia, both by axis and per length.
    """
    control, data, inertia, elements, fields = work[9], saddle[2][1], work[6], mesh[1], mesh[3]
    half, moved, full, _, _, index = work[10]
    rows, dofs, lanes = control.shape[2], mesh[4].shape[1], data.shape[2]
    upper = data.shape[1] - rows * (2 * rows + 1)
    first = inertia.shape[1] - rows * (2 * rows + 1)
    stiffness, mass = np.zeros((dofs, dofs)), np.zeros((dofs, dofs))
    for e in range(elements.shape[0]):
        node = int(elements[e, 0])
        stiffness[:], mass[:] = 0.0, 0.0
        for a in range(2):
            for b in range(2):
                sign = 1.0 if a == b else -1.0
                s11, s12 = sign * (1 - a) * (1 - b), sign * (1 - a) * b
                s21, s22 = sign * a * (1 - b), sign * a * b
                combine(data, e // lanes, e % lanes, upper, index, s11, s12, s21, s22, full)
                left, right = control[node + a, 0], control[node + b, 0]
                add_trivialized(full, left, right, fields, stiffness, 0, 0, half, moved)
        combine(inertia, node // lanes, node % lanes, first, index, 0.0, 0.0, 0.0, 1.0, full)
        add_trivialized(full, control[node, 0], control[node, 0], fields, mass, 0, 0, half, moved)
        for f in range(fields.shape[0]):
            for d in range(fields[f, 2], fields[f, 2] + 3 if fields[f, 0] else fields[f, 2]):
                if -0.25 * h * h * stiffness[d, d] > mass[d, d]:
                    return node
    return -1


@njit(**_options)
def _factorize(mesh, rule, work, saddle, h):  # type: ignore[no-untyped-def]
    """LU of the tangent, its blocks along the chain and the gradients between them; returns the row found singular."""
    diagonal, upper, lower, gradients = work[2], work[3], work[4], saddle[3]
    starts, between, band, low, pivots, scales = saddle[6], saddle[7], saddle[8], saddle[9], saddle[10], saddle[11]
    elements, places, free, active = mesh[1], mesh[2], mesh[4], mesh[5]
    heavy, reach = rule[6], low.shape[1]
    blocks, dofs, order = diagonal.shape[0], free.shape[1], gradients.shape[0]
    gauss, width, count = gradients.shape[2], gradients.shape[3], gradients.shape[4]
    band[:], low[:] = 0.0, 0.0
    for b in range(blocks):
        for i in range(active[b]):
            row = starts[b] + i
            for j in range(active[b]):
                band[row, starts[b] + j - row + reach] = diagonal[b, i, j]
            if b + 1 < blocks:
                for j in range(active[b + 1]):
                    band[row, starts[b + 1] + j - row + reach] = upper[b, i, j]
            if b > 0:
                for j in range(active[b - 1]):
                    band[row, starts[b - 1] + j - row + reach] = lower[b, i, j]
    for e in range(elements.shape[0]):
        start, length = int(elements[e, 0]), elements[e, 1]
        for i in range(order - 1):
            for g in range(gauss):
                w = h * length * heavy[g]
                for c in range(count):
                    own = between[e] + (i * gauss + g) * count + c
                    for a in range(width):
                        node = start + a
                        at = starts[places[node, 0]] + places[node, 1] + i * dofs
                        for d in range(dofs):
                            if free[node, d]:
                                band[own, at + d - own + reach] = gradients[i + 1, e, g, a, c, d]
                                band[at + d, own - at - d + reach] = w * gradients[i, e, g, a, c, d]
    return factorize_band(band, reach, low, pivots, scales)


@njit(**_options)
def _solve(mesh, work, saddle):  # type: ignore[no-untyped-def]
    """Corrections of the control nodes, in place of the right-hand side, and of the multipliers."""
    right, change, violation, starts, between = work[5], saddle[1], saddle[4], saddle[6], saddle[7]
    low, unknown, active = saddle[9], saddle[12], mesh[5]
    _, elements, gauss, count = violation.shape
    for b in range(right.shape[0]):
        for i in range(active[b]):
            unknown[starts[b] + i] = right[b, i]
    for e in range(elements):
        for i in range(change.shape[1]):
            for k in range(gauss * count):
                unknown[between[e] + i * gauss * count + k] = -violation[i + 1, e, k // count, k % count]
    solve_band(saddle[8], low.shape[1], low, saddle[10], saddle[11], unknown)
    for b in range(right.shape[0]):
        for i in range(active[b]):
            right[b, i] = unknown[starts[b] + i]
    for e in range(elements):
        for i in range(change.shape[1]):
            for k in range(gauss * count):
                change[e, i, k] = unknown[between[e] + i * gauss * count + k]
