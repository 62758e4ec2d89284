"""Step systems by Galerkin rules: Newton's method on the block-tridiagonal equations of the control nodes of a step.

With control nodes q_{a,i}, i = 0 ... r, of every node a, and L_d the quadrature of the action over one step,

    μ_a + D_{a,0} L_d = 0,   D_{a,i} L_d = 0 (0 < i < r)   -> q_{a,1} ... q_{a,r},      μ_a⁺ = D_{a,r} L_d.

Up to the points where the terms of the density are evaluated (see discrete.embedded) everything is linear in the
control nodes, so gradients and Hessians from the kernels are contracted with the interpolation here and then
left-trivialized. A block is the nodes of one element without its left end; block LU runs along each chain.
"""

import math

import numpy as np
from numba import njit

from cayley.steppers.calls import call_kernel, call_setup
from cayley.steppers.dense import factorize, solve_columns, solve_factorized, subtract_product, subtract_vector

FINISHED, NOT_CONVERGED, NOT_FINITE = 0, 1, 2
QUICK_ITERATIONS = 20
ITERATIONS = 60
"""Most iterations of the first try of a step, and of the careful second one."""
STEP_TOLERANCE = 1e-9
"""Newton stops when a correction with a new tangent is this small: the next would be about its square."""
LEFT_TOLERANCE = 1e-16
"""It stops too when corrections with one tangent shrink at a rate that leaves this in all."""
SLOW = 0.15
"""A correction that is more than this part of the one before asks for a new tangent."""
FLOOR = 1e-6
"""Below this a correction that no longer shrinks is rounding, not failure to converge."""
LARGEST_TURN = 1.0
"""Longest correction of a rotation in one iteration [rad]."""
LARGEST_GROWTH = 2.0
"""A correction this many times the one before is too long."""
WILD_GROWTH = 10.0
"""The quick first try of a step is given up when a correction is this many times the one before."""
SMALLEST_PART = 0.02
"""Smallest part of a correction that is tried."""

_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def advance(calls, rule, mesh, work, state, warm, loads, clock, stride, frames, counts):
    """Advance through len(frames) saves of stride steps each; the arguments are those of steppers.galerkin_plan.

    Returns: (outcome, number of the save); counts holds iterations in all, most in a step, failed step and node.
    """
    control, momenta, memory = state
    fields = mesh[3]
    nodes, last = control.shape[0], control.shape[1] - 1
    rows = control.shape[2]
    for save in range(frames.shape[0]):
        for j in range(stride):
            number = save * stride + j
            begin = clock[0] + (clock[2] + number) * clock[1]
            solved = False
            for attempt in range(3):  # then with care, then with care from the safest start, the state itself
                if attempt < 2 and (warm or number > 0):
                    _extrapolate(control, memory, rule[3], fields)
                elif attempt < 2:
                    _continue(calls, rule, mesh, work, state, begin, clock[1])
                else:
                    for i in range(1, last + 1):
                        control[:, i] = control[:, 0]
                _hold(mesh, control)
                passes, worst, solved = _newton(
                    calls, rule, mesh, work, state, loads, number, begin, clock[1], attempt > 0
                )
                counts[0] += passes
                counts[1] = max(counts[1], passes)
                if solved:
                    break
            counts[2], counts[3] = number, worst
            if not solved:
                return NOT_CONVERGED, save
            _hand_on(mesh, work, control, momenta)
            memory[:] = control[:, :last]
            control[:, 0] = control[:, last]
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
    return FINISHED, frames.shape[0]


@njit(**_options)
def _newton(calls, rule, mesh, work, state, loads, number, begin, h, careful):
    """Solve one step; returns (iterations, node of the largest correction, converged).

    Stiff structures converge fast but not monotonically, so full corrections come first, with a new tangent only where
    the last one no longer serves. The careful second try takes a new tangent every time, takes a correction that makes
    the next larger for too long (the natural monotonicity test of Deuflhard 2004, section 3.3), takes it back and
    halves it.
    """
    control, right = state[0], work[5]
    accepted, taken = work[12], work[13]
    accepted[:] = control
    last, part, worst, fresh = math.inf, 1.0, 0, True
    for iteration in range(ITERATIONS if careful else QUICK_ITERATIONS):
        _assemble(calls, rule, mesh, work, state, loads, number, begin, h, fresh)
        if fresh:
            _factorize_chains(mesh, work)
        _solve_chains(mesh, work)
        size, turn, worst = _measure(mesh, right, control)
        if careful and not size <= LARGEST_GROWTH * last and part > SMALLEST_PART:  # also for NaN
            part *= 0.5
            control[:] = accepted
            _move(mesh, taken, control, part)
            _hold(mesh, control)
            continue
        if not math.isfinite(size) or (not careful and size > WILD_GROWTH * last):
            return iteration + 1, worst, False
        accepted[:] = control
        taken[:] = right
        part = min(1.0, LARGEST_TURN / turn) if turn > 0.0 else 1.0
        _move(mesh, taken, control, part)
        _hold(mesh, control)
        rate = size / last  # 0 at first
        settled = size <= STEP_TOLERANCE or (size <= FLOOR and rate > 0.3)
        if (fresh and settled) or (0.0 < rate < SLOW and size * rate <= LEFT_TOLERANCE):
            _assemble(calls, rule, mesh, work, state, loads, number, begin, h, False)  # momenta of the corrected nodes
            return iteration + 1, worst, True
        fresh = careful or rate > SLOW
        last = size
    return ITERATIONS, worst, False


@njit(**_options)
def _assemble(calls, rule, mesh, work, state, loads, number, begin, h, tangent):
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
            _trivialize(gamma[a, i], control[a, i], fields, moment)
            for d in range(dofs):
                value = moment[d] + (momenta[a, d] if i == 0 else 0.0)
                right[block, base + i * dofs + d] = -value if free[a, d] else 0.0
        if not tangent:
            continue
        for i in range(1, r):
            _turn_correction(
                gamma[a, i], control[a, i], fields, diagonal[block], base + i * dofs, base + (i - 1) * dofs
            )
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
    _call(calls, work[8], 0, points, time)
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
                _combine(points, block, lane, first + 1 + 2 * rows, index, s11, s12, s21, s22, full)
                base = mesh[2][a, 1]
                row, column = base + i * dofs, base + (j - 1) * dofs
                out = diagonal[mesh[2][a, 0]]
                _add_trivialized(full, control[a, i], control[a, j], mesh[3], out, row, column, half, moved)


@njit(**_options)
def _strain(calls, rule, mesh, work, begin, h, tangent):
    """−W at all stages, contracted with the interpolation in space and time over every element."""
    ell, weights, phi, psi, heavy = rule[0], rule[2], rule[4], rule[5], rule[6]
    gamma, stage, diagonal, upper, lower, stretches = work[0], work[1], work[2], work[3], work[4], work[7]
    half, moved, full, part, over, index = work[10]
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
        _call(calls, work[8], 1, stretches[k], begin + rule[7][k] * h)
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
        for a in range(width if tangent else 0):
            for b in range(width):
                over[:] = 0.0
                for k in range(stages):
                    full[:] = 0.0
                    for g in range(gauss):
                        block, lane = (e * gauss + g) // lanes, (e * gauss + g) % lanes
                        w = -h * weights[k] * heavy[g] * length
                        s11, s12 = w * phi[g, a] * phi[g, b], w * phi[g, a] * psi[g, b] * inverse
                        s21, s22 = w * psi[g, a] * phi[g, b] * inverse, w * psi[g, a] * psi[g, b] * inverse * inverse
                        _combine(stretches[k], block, lane, first + 1 + 2 * rows, index, s11, s12, s21, s22, part)
                        full += part
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
                        _add_trivialized(over[i, j - 1], left, right, mesh[3], out, row, column, half, moved)


@njit(**_options)
def _call(calls, uniforms, kind, data, time):
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
def _combine(data, block, lane, at, index, s11, s12, s21, s22, out):
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
def _trivialize(gradient, point, fields, out):
    """Left-trivialized gradient of a node: ½ Im(p̄ γ) for rotations."""
    for f in range(fields.shape[0]):
        turns, row, dof, size = fields[f]
        if turns:
            w, x, y, z = point[row], point[row + 1], point[row + 2], point[row + 3]
            a, b, c, d = gradient[row], gradient[row + 1], gradient[row + 2], gradient[row + 3]
            out[dof] = 0.5 * (w * b - x * a - y * d + z * c)
            out[dof + 1] = 0.5 * (w * c - y * a - z * b + x * d)
            out[dof + 2] = 0.5 * (w * d - z * a - x * c + y * b)
        else:
            for k in range(size):
                out[dof + k] = gradient[row + k]


@njit(**_options)
def _add_trivialized(matrix, left, right, fields, out, row, column, half, moved):
    """Add Tₗᵀ M Tᵣ, with T the tangents ½ p eᵢ of rotations, to a block; half and moved are room."""
    for i in range(matrix.shape[0]):
        _trivialize(matrix[i], right, fields, half[:, i])
    for d in range(half.shape[0]):
        _trivialize(half[d], left, fields, moved)
        for k in range(half.shape[0]):
            out[row + k, column + d] += moved[k]


@njit(**_options)
def _turn_correction(gradient, point, fields, out, row, column):
    """Derivative of ½ Im(p̄ γ) with γ fixed and δp = ½ p η: −¼ (y₀ η − Y × η) with y = p̄ γ."""
    for f in range(fields.shape[0]):
        turns, at, dof, _ = fields[f]
        if not turns:
            continue
        w, x, y, z = point[at], point[at + 1], point[at + 2], point[at + 3]
        a, b, c, d = gradient[at], gradient[at + 1], gradient[at + 2], gradient[at + 3]
        real = w * a + x * b + y * c + z * d
        i = w * b - x * a - y * d + z * c
        j = w * c - y * a - z * b + x * d
        l = w * d - z * a - x * c + y * b
        r, s = row + dof, column + dof
        for k in range(3):
            out[r + k, s + k] -= 0.25 * real
        out[r, s + 1] -= 0.25 * l
        out[r + 1, s] += 0.25 * l
        out[r + 1, s + 2] -= 0.25 * i
        out[r + 2, s + 1] += 0.25 * i
        out[r + 2, s] -= 0.25 * j
        out[r, s + 2] += 0.25 * j


@njit(**_options)
def _factorize_chains(mesh, work):
    """Block LU along every chain: factors of the pivot blocks, and the upper blocks divided by them."""
    diagonal, upper, lower, pivots = work[2], work[3], work[4], work[11]
    chains = mesh[7]
    for c in range(chains.shape[0]):
        first, last = chains[c, 0], chains[c, 1]
        for b in range(first, last):
            factorize(diagonal[b], pivots[b])
            if b + 1 < last:
                solve_columns(diagonal[b], pivots[b], upper[b])
                subtract_product(diagonal[b + 1], lower[b + 1], upper[b])


@njit(**_options)
def _solve_chains(mesh, work):
    """The solution replaces the right-hand side."""
    diagonal, upper, lower, right, pivots = work[2], work[3], work[4], work[5], work[11]
    chains = mesh[7]
    for c in range(chains.shape[0]):
        first, last = chains[c, 0], chains[c, 1]
        for b in range(first, last):
            if b > first:
                subtract_vector(right[b], lower[b], right[b - 1])
            solve_factorized(diagonal[b], pivots[b], right[b])
        for b in range(last - 2, first - 1, -1):
            subtract_vector(right[b], upper[b], right[b + 1])


@njit(**_options)
def _hand_on(mesh, work, control, momenta):
    """Momenta at the end of the step, μ⁺ = D_r L_d, and what its equations leave unsolved.

    The sum of D_i L_d over all nodes of a symmetric system vanishes, so with the residuals handed on the momentum maps
    do not depend on how well the equations are solved. That of a rotation is turned into the frame of the new momentum.
    """
    fields, free, right, gamma = mesh[3], mesh[4], work[5], work[0]
    last, dofs = control.shape[1] - 1, free.shape[1]
    for a in range(control.shape[0]):
        block, base = mesh[2][a, 0], mesh[2][a, 1]
        _trivialize(gamma[a, last], control[a, last], fields, momenta[a])
        for f in range(fields.shape[0]):
            turns, row, dof, count = fields[f]
            for i in range(last):
                at = base + i * dofs + dof
                if turns:
                    hand_turned(control[a, i], control[a, last], row, right[block, at : at + 3], momenta[a, dof:])
                else:
                    for k in range(count):
                        momenta[a, dof + k] -= right[block, at + k]
        for d in range(dofs):
            if not free[a, d]:
                momenta[a, d] = 0.0


@njit(**_options)
def hand_turned(before, after, row, unsolved, out):
    """Subtract a body vector of one frame, given in another."""
    w, x, y, z = before[row], before[row + 1], before[row + 2], before[row + 3]
    a, b, c, d = after[row], after[row + 1], after[row + 2], after[row + 3]
    s = a * w + b * x + c * y + d * z  # conj(after) before = (s, u)
    u = (a * x - b * w - c * z + d * y, a * y - c * w - d * x + b * z, a * z - d * w - b * y + c * x)
    t = (
        u[1] * unsolved[2] - u[2] * unsolved[1],
        u[2] * unsolved[0] - u[0] * unsolved[2],
        u[0] * unsolved[1] - u[1] * unsolved[0],
    )
    out[0] -= unsolved[0] + 2.0 * (s * t[0] + u[1] * t[2] - u[2] * t[1])
    out[1] -= unsolved[1] + 2.0 * (s * t[1] + u[2] * t[0] - u[0] * t[2])
    out[2] -= unsolved[2] + 2.0 * (s * t[2] + u[0] * t[1] - u[1] * t[0])


@njit(**_options)
def _hold(mesh, control):
    """Held components of all control nodes are those at the start of the step; of rotations, those of the turn."""
    fields, free = mesh[3], mesh[4]
    for a in range(control.shape[0]):
        for f in range(fields.shape[0]):
            turns, row, dof, count = fields[f]
            for i in range(1, control.shape[1]):
                if turns:
                    hold_turn(control[a, 0, row : row + 4], control[a, i, row : row + 4], free[a, dof : dof + 3])
                    continue
                for k in range(count):
                    if not free[a, dof + k]:
                        control[a, i, row + k] = control[a, 0, row + k]


@njit(**_options)
def hold_turn(start, point, free):
    """Take held components out of the Cayley vector f of a turn, point = start Cay f."""
    if free[0] and free[1] and free[2]:
        return
    if not (free[0] or free[1] or free[2]):
        point[:] = start
        return
    w, x, y, z = start[0], start[1], start[2], start[3]
    a, b, c, d = point[0], point[1], point[2], point[3]
    s = w * a + x * b + y * c + z * d
    f = np.zeros(3)
    f[0] = (w * b - x * a - y * d + z * c) / s if free[0] else 0.0
    f[1] = (w * c - y * a - z * b + x * d) / s if free[1] else 0.0
    f[2] = (w * d - z * a - x * c + y * b) / s if free[2] else 0.0
    point[:] = start
    _turn(point, 0, f, 1.0)


@njit(**_options)
def _measure(mesh, right, control):
    """Size of a correction, its largest turn, and the node where it is largest.

    Rotations count in radians, vectors relative to the extent of the configuration.
    """
    fields, extent = mesh[3], mesh[8]
    dofs, order = mesh[4].shape[1], control.shape[1]
    size, turn, worst = 0.0, 0.0, 0
    for a in range(control.shape[0]):
        block, base = mesh[2][a, 0], mesh[2][a, 1]
        for f in range(fields.shape[0]):
            turns, _, dof, count = fields[f]
            for i in range(order - 1):
                for k in range(count):
                    one = abs(right[block, base + i * dofs + dof + k])
                    if turns:
                        turn = max(turn, one)
                    else:
                        one *= extent[0]
                    if not one <= size:
                        size, worst = one, a
    return size, turn, worst


@njit(**_options)
def _move(mesh, right, control, part):
    """Move the control nodes of a step by part of a correction."""
    fields = mesh[3]
    dofs, order = mesh[4].shape[1], control.shape[1]
    for a in range(control.shape[0]):
        block, base = mesh[2][a, 0], mesh[2][a, 1]
        for f in range(fields.shape[0]):
            turns, row, dof, count = fields[f]
            for i in range(order - 1):
                at = base + i * dofs + dof
                if turns:
                    _turn(control[a, i + 1], row, right[block, at : at + 3], 0.5 * part)
                else:
                    for k in range(count):
                        control[a, i + 1, row + k] += part * right[block, at + k]


@njit(**_options)
def _turn(point, row, eta, factor):
    """The quaternion times Cay(factor η), as an increment, so that rounding stays unbiased."""
    x, y, z = factor * eta[0], factor * eta[1], factor * eta[2]
    square = x * x + y * y + z * z
    cosine = 1.0 / math.sqrt(1.0 + square)
    small = -square * cosine * cosine / (1.0 + cosine)
    x, y, z = cosine * x, cosine * y, cosine * z
    w, a, b, c = point[row], point[row + 1], point[row + 2], point[row + 3]
    point[row] = w + (w * small - a * x - b * y - c * z)
    point[row + 1] = a + (a * small + w * x + b * z - c * y)
    point[row + 2] = b + (b * small + w * y + c * x - a * z)
    point[row + 3] = c + (c * small + w * z + a * y - b * x)


@njit(**_options)
def _continue(calls, rule, mesh, work, state, begin, h):
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
    _call(calls, work[8], 0, points, begin)
    first = points.shape[1] - (1 + 2 * rows + rows * (2 * rows + 1))
    half, moved, full, _, _, index = work[10]
    mass = np.zeros((dofs, dofs))
    pivots, velocity = np.zeros(dofs, dtype=np.int64), np.zeros(dofs)
    for a in range(nodes):
        w = mesh[0][a]
        _combine(points, a // lanes, a % lanes, first + 1 + 2 * rows, index, 0.0, 0.0, 0.0, w, full)
        mass[:] = 0.0
        _add_trivialized(full, control[a, 0], control[a, 0], fields, mass, 0, 0, half, moved)
        for d in range(dofs):
            velocity[d] = momenta[a, d]
        factorize(mass, pivots)
        solve_factorized(mass, pivots, velocity)
        for i in range(1, control.shape[1]):
            control[a, i] = control[a, 0]
            for f in range(fields.shape[0]):
                turns, row, dof, count = fields[f]
                if turns:
                    _turn(control[a, i], row, velocity[dof : dof + 3], 0.5 * times[i] * h)
                    continue
                for k in range(count):
                    if free[a, dof + k]:
                        control[a, i, row + k] += times[i] * h * velocity[dof + k]


@njit(**_options)
def _extrapolate(control, memory, matrix, fields):
    """Start from the polynomial of the step before, continued, with its rotations normalized."""
    last = control.shape[1] - 1
    for a in range(control.shape[0]):
        for i in range(1, control.shape[1]):
            for row in range(control.shape[2]):
                value = matrix[i, last] * control[a, 0, row]
                for k in range(last):
                    value += matrix[i, k] * memory[a, k, row]
                control[a, i, row] = value
            for f in range(fields.shape[0]):
                if fields[f, 0]:
                    row = fields[f, 1]
                    size = 0.0
                    for k in range(4):
                        size += control[a, i, row + k] ** 2
                    for k in range(4):
                        control[a, i, row + k] /= math.sqrt(size)
