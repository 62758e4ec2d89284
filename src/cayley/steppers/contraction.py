"""Terms of a step at their quadrature points, contracted with the interpolation: residual and tangent of a step.

Up to the points where the terms of the density are evaluated (see discrete.embedded) everything is linear in the
control nodes, so gradients and Hessians from the kernels are contracted here and then left-trivialized.
"""

import numpy as np
from numba import njit

from cayley.steppers.calls import call_kernel, call_setup
from cayley.steppers.controls import add_trivialized, extrapolate, hold, trivialize, turn, turn_correction
from cayley.steppers.dense import factorize, solve_factorized

_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def assemble(calls, rule, mesh, work, state, loads, number, begin, h, tangent):
    """Evaluate all terms and fill γ, the right-hand side and, if a tangent is wanted, the blocks."""
    ell, weights = rule[0], rule[2]
    gamma, stage, diagonal, upper, lower, right = work[0], work[1], work[2], work[3], work[4], work[5]
    control, momenta = state[0], state[1]
    fields, free = mesh[3], mesh[4]
    gamma[:], stage[:], right[:] = 0.0, 0.0, 0.0
    if tangent:
        diagonal[:], upper[:], lower[:] = 0.0, 0.0, 0.0
    nodes, stages = control.shape[0], ell.shape[0]
    for a in range(nodes):
        for k in range(stages):
            for i in range(control.shape[1]):
                for row in range(control.shape[2]):
                    stage[a, k, row] += ell[k, i] * control[a, i, row]
    for k in range(stages):
        time = begin + rule[7][k] * h
        _inertia(calls, rule, mesh, work, state, k, time, h, tangent)
        _push(loads, fields, work, rule, number, k, h * weights[k])
    if mesh[1].shape[0]:
        _strain(calls, rule, mesh, work, begin, h, tangent)
    dofs, r = momenta.shape[1], control.shape[1] - 1
    moment = np.zeros(dofs)
    for a in range(nodes):
        block, base = mesh[2][a, 0], mesh[2][a, 1]
        for i in range(r):
            trivialize(gamma[a, i], control[a, i], fields, moment)
            for d in range(dofs):
                value = moment[d] + (momenta[a, d] if i == 0 else 0.0)
                right[block, base + i * dofs + d] = -value if free[a, d] else 0.0
        if not tangent:
            continue
        for i in range(1, r):
            turn_correction(gamma[a, i], control[a, i], fields, diagonal[block], base + i * dofs, base + (i - 1) * dofs)
        for i in range(r):
            for d in range(dofs):
                if not free[a, d]:
                    row = base + i * dofs + d
                    diagonal[block, row] = 0.0
                    upper[block, row] = 0.0
                    lower[block, row] = 0.0
                    diagonal[block, row, row] = 1.0
    for b in range(diagonal.shape[0] if tangent else 0):
        for row in range(mesh[5][b], diagonal.shape[1]):
            diagonal[b, row, row] = 1.0  # the first block of a chain has one node only


@njit(**_options)
def _inertia(calls, rule, mesh, work, state, k, time, h, tangent):
    """T − U at one stage, contracted with the interpolation in time at every node."""
    ell, dell, weights = rule[0], rule[1], rule[2]
    gamma, stage, diagonal, points = work[0], work[1], work[2], work[6]
    half, moved, full, _, _, index = work[10]
    control = state[0]
    nodes, order, rows = control.shape[0], control.shape[1], control.shape[2]
    lanes = points.shape[2]
    for a in range(nodes):
        block, lane = a // lanes, a % lanes
        for row in range(rows):
            slope = 0.0
            for i in range(order):
                slope += dell[k, i] * control[a, i, row]
            points[block, row, lane] = stage[a, k, row]
            points[block, rows + row, lane] = slope / h
    evaluate(calls, work[8], 0, points, time)
    first = points.shape[1] - (1 + 2 * rows + rows * (2 * rows + 1))
    dofs = mesh[4].shape[1]
    for a in range(nodes):
        block, lane = a // lanes, a % lanes
        w = h * weights[k] * mesh[0][a]
        for i in range(order):
            for row in range(rows):
                value, slope = points[block, first + 1 + row, lane], points[block, first + 1 + rows + row, lane]
                gamma[a, i, row] += w * (ell[k, i] * value + dell[k, i] / h * slope)
        for i in range(order - 1 if tangent else 0):
            for j in range(1, order):
                s11, s12 = w * ell[k, i] * ell[k, j], w * ell[k, i] * dell[k, j] / h
                s21, s22 = w * dell[k, i] * ell[k, j] / h, w * dell[k, i] * dell[k, j] / (h * h)
                combine(points, block, lane, first + 1 + 2 * rows, index, s11, s12, s21, s22, full)
                base = mesh[2][a, 1]
                row, column = base + i * dofs, base + (j - 1) * dofs
                out = diagonal[mesh[2][a, 0]]
                add_trivialized(full, control[a, i], control[a, j], mesh[3], out, row, column, half, moved)


@njit(**_options)
def _strain(calls, rule, mesh, work, begin, h, tangent):
    """−W at all stages, contracted with the interpolation in space and time over every element."""
    ell, weights, phi, psi, heavy = rule[0], rule[2], rule[4], rule[5], rule[6]
    gamma, stage, diagonal, upper, lower, stretches = work[0], work[1], work[2], work[3], work[4], work[7]
    half, moved, full, hessians, over, index = work[10]
    control, elements, scaled = work[9], mesh[1], mesh[6]
    gauss, width, rows = phi.shape[0], phi.shape[1], stage.shape[2]
    stages, lanes = stretches.shape[0], stretches.shape[3]
    for k in range(stages):
        for e in range(elements.shape[0]):
            start, inverse = int(elements[e, 0]), elements[e, 2] if scaled else 1.0
            for g in range(gauss):
                point = e * gauss + g
                block, lane = point // lanes, point % lanes
                for row in range(rows):
                    value, slope = 0.0, 0.0
                    for a in range(width):
                        value += phi[g, a] * stage[start + a, k, row]
                        slope += psi[g, a] * inverse * stage[start + a, k, row]
                    stretches[k, block, row, lane] = value
                    stretches[k, block, rows + row, lane] = slope
        evaluate(calls, work[8], 1, stretches[k], begin + rule[7][k] * h)
    first = stretches.shape[2] - (1 + 2 * rows + rows * (2 * rows + 1))
    dofs, order = mesh[4].shape[1], control.shape[1]
    for e in range(elements.shape[0]):
        start, length, inverse = int(elements[e, 0]), elements[e, 1], elements[e, 2] if scaled else 1.0
        for k in range(stages):
            for g in range(gauss):
                block, lane = (e * gauss + g) // lanes, (e * gauss + g) % lanes
                w = -h * weights[k] * heavy[g] * length
                for a in range(width):
                    for row in range(rows):
                        value = stretches[k, block, first + 1 + row, lane]
                        slope = stretches[k, block, first + 1 + rows + row, lane]
                        pulled = w * (phi[g, a] * value + psi[g, a] * inverse * slope)
                        for i in range(order):
                            gamma[start + a, i, row] += ell[k, i] * pulled
        if not tangent:
            continue
        for k in range(stages):
            for g in range(gauss):
                block, lane = (e * gauss + g) // lanes, (e * gauss + g) % lanes
                w = -h * weights[k] * heavy[g] * length
                _unpack(stretches[k], block, lane, first + 1 + 2 * rows, index, w, inverse, hessians[k, g])
        for a in range(width):
            for b in range(width):
                over[:] = 0.0
                for k in range(stages):
                    full[:] = 0.0
                    for g in range(gauss):
                        s11, s12 = phi[g, a] * phi[g, b], phi[g, a] * psi[g, b]
                        s21, s22 = psi[g, a] * phi[g, b], psi[g, a] * psi[g, b]
                        for row in range(rows):
                            for column in range(rows):
                                full[row, column] += (
                                    s11 * hessians[k, g, 0, row, column]
                                    + s12 * hessians[k, g, 1, row, column]
                                    + s21 * hessians[k, g, 2, row, column]
                                    + s22 * hessians[k, g, 3, row, column]
                                )
                    for i in range(order - 1):
                        for j in range(1, order):
                            both = ell[k, i] * ell[k, j]
                            for row in range(rows):
                                for column in range(rows):
                                    over[i, j - 1, row, column] += both * full[row, column]
                na, nb = start + a, start + b
                ra, rb = mesh[2][na, 0], mesh[2][nb, 0]
                if ra == rb:
                    out = diagonal[ra]
                elif ra < rb:
                    out = upper[ra]
                else:
                    out = lower[ra]
                for i in range(order - 1):
                    for j in range(1, order):
                        row, column = mesh[2][na, 1] + i * dofs, mesh[2][nb, 1] + (j - 1) * dofs
                        left, right = control[na, i], control[nb, j]
                        add_trivialized(over[i, j - 1], left, right, mesh[3], out, row, column, half, moved)


@njit(**_options)
def evaluate(calls, uniforms, kind, data, time):
    """Run the kernel of inertia (0) or strain (1) at one time."""
    uniforms[kind, 0] = time
    where = uniforms[kind].ctypes.data
    call_setup(calls[kind, 1], where)
    call_kernel(calls[kind, 0], data.ctypes.data, where, 0, data.shape[0])


@njit(**_options)
def _push(loads, fields, work, rule, number, k, weight):
    """Virtual work of time-dependent loads at one stage, added to γ.

    A body moment m does the work m·ε with ε = 2 Im(z̄ δz)/‖z‖², so its force on z is 2 (z m)/‖z‖².
    """
    table, entries, scales = loads[0], loads[1], loads[2]
    gamma, stage, ell = work[0], work[1], rule[0]
    for e in range(entries.shape[0]):
        a, row, turn, form, column, moment = (
            entries[e, 0], entries[e, 1], entries[e, 2], entries[e, 3], entries[e, 4], entries[e, 5],
        )  # fmt: skip
        s = weight * scales[e]
        x, y, z = s * table[number, k, column], s * table[number, k, column + 1], s * table[number, k, column + 2]
        if x == 0.0 and y == 0.0 and z == 0.0:
            continue
        p = stage[a, k]
        if form:
            size = p[turn] ** 2 + p[turn + 1] ** 2 + p[turn + 2] ** 2 + p[turn + 3] ** 2
            sign = 1.0 if form == 2 else -1.0
            w, i, j, l = p[turn], sign * p[turn + 1], sign * p[turn + 2], sign * p[turn + 3]
            u, v, q = j * z - l * y, l * x - i * z, i * y - j * x
            x, y, z = (
                x + 2.0 * (w * u + j * q - l * v) / size,
                y + 2.0 * (w * v + l * u - i * q) / size,
                z + 2.0 * (w * q + i * v - j * u) / size,
            )
        if moment:
            w, i, j, l = p[row], p[row + 1], p[row + 2], p[row + 3]
            f = 2.0 / (w * w + i * i + j * j + l * l)
            push = (
                -f * (i * x + j * y + l * z),
                f * (w * x + j * z - l * y),
                f * (w * y + l * x - i * z),
                f * (w * z + i * y - j * x),
            )
            for control in range(gamma.shape[1]):
                for c in range(4):
                    gamma[a, control, row + c] += ell[k, control] * push[c]
        else:
            for control in range(gamma.shape[1]):
                gamma[a, control, row] += ell[k, control] * x
                gamma[a, control, row + 1] += ell[k, control] * y
                gamma[a, control, row + 2] += ell[k, control] * z


@njit(**_options)
def _unpack(data, block, lane, at, index, weight, inverse, out):
    """The four parts of a Hessian in (z, z′), the latter per unit of the element, times a weight."""
    rows = out.shape[1]
    s12, s22 = weight * inverse, weight * inverse * inverse
    for i in range(rows):
        for j in range(rows):
            out[0, i, j] = weight * data[block, at + index[i, j], lane]
            out[1, i, j] = s12 * data[block, at + index[i, rows + j], lane]
            out[2, i, j] = s12 * data[block, at + index[rows + i, j], lane]
            out[3, i, j] = s22 * data[block, at + index[rows + i, rows + j], lane]


@njit(**_options)
def combine(data, block, lane, at, index, s11, s12, s21, s22, out):
    """s₁₁ H₁₁ + s₁₂ H₁₂ + s₂₁ H₂₁ + s₂₂ H₂₂ from the upper triangle of a Hessian stored behind row ``at``."""
    rows = out.shape[0]
    for i in range(rows):
        for j in range(rows):
            out[i, j] = (
                s11 * data[block, at + index[i, j], lane]
                + s12 * data[block, at + index[i, rows + j], lane]
                + s21 * data[block, at + index[rows + i, j], lane]
                + s22 * data[block, at + index[rows + i, rows + j], lane]
            )


@njit(**_options)
def first_guess(calls, rule, mesh, work, state, memory, onward, safest, begin, h):
    """The polynomial of the step before, continued; where there is none, by the momenta; the safest: no motion."""
    control = state[0]
    if safest:
        for i in range(1, control.shape[1]):
            control[:, i] = control[:, 0]
    elif onward:
        extrapolate(control, memory, rule[3], mesh[3])
    else:
        start_from_momenta(calls, rule, mesh, work, state, begin, h)
    hold(mesh, control)


@njit(**_options)
def start_from_momenta(calls, rule, mesh, work, state, begin, h):
    """Start from the state alone, with the velocities its momenta say: xᵢ = x + cᵢ h v, pᵢ = p Cay(½ cᵢ h ω)."""
    control, momenta = state[0], state[1]
    fields, free, times = mesh[3], mesh[4], rule[8]
    points = work[6]
    nodes, rows, dofs = control.shape[0], control.shape[2], momenta.shape[1]
    lanes = points.shape[2]
    for a in range(nodes):
        for row in range(rows):
            points[a // lanes, row, a % lanes] = control[a, 0, row]
            points[a // lanes, rows + row, a % lanes] = 0.0
    evaluate(calls, work[8], 0, points, begin)
    first = points.shape[1] - (1 + 2 * rows + rows * (2 * rows + 1))
    half, moved, full, _, _, index = work[10]
    mass = np.zeros((dofs, dofs))
    pivots, velocity = np.zeros(dofs, dtype=np.int64), np.zeros(dofs)
    for a in range(nodes):
        w = mesh[0][a]
        combine(points, a // lanes, a % lanes, first + 1 + 2 * rows, index, 0.0, 0.0, 0.0, w, full)
        mass[:] = 0.0
        add_trivialized(full, control[a, 0], control[a, 0], fields, mass, 0, 0, half, moved)
        for d in range(dofs):
            velocity[d] = momenta[a, d]
        factorize(mass, pivots)
        solve_factorized(mass, pivots, velocity)
        for i in range(1, control.shape[1]):
            control[a, i] = control[a, 0]
            for f in range(fields.shape[0]):
                turns, row, dof, count = fields[f]
                if turns:
                    turn(control[a, i], row, velocity[dof : dof + 3], 0.5 * times[i] * h)
                    continue
                for k in range(count):
                    if free[a, dof + k]:
                        control[a, i, row + k] += times[i] * h * velocity[dof + k]
