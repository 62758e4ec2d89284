"""Control nodes of implicit steps: trivialized derivatives, corrections, first guesses, what is held and handed on.

Arguments are those of steppers.galerkin_plan: control (nodes, r + 1, rows), fields (is rotation, row, dof, size).
"""

import math

import numpy as np
from numba import njit

_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def trivialize(gradient, point, fields, out):
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
def add_trivialized(matrix, left, right, fields, out, row, column, half, moved):
    """Add Tₗᵀ M Tᵣ, with T the tangents ½ p eᵢ of rotations, to a block; half and moved are room."""
    for i in range(matrix.shape[0]):
        trivialize(matrix[i], right, fields, half[:, i])
    for d in range(half.shape[0]):
        trivialize(half[d], left, fields, moved)
        for k in range(half.shape[0]):
            out[row + k, column + d] += moved[k]


@njit(**_options)
def turn_correction(gradient, point, fields, out, row, column):
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
def turn(point, row, eta, factor):
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
def normalize(control, fields):
    """Bring the rotations of control nodes after the first to length one."""
    for a in range(control.shape[0]):
        for i in range(1, control.shape[1]):
            for f in range(fields.shape[0]):
                if fields[f, 0]:
                    row = fields[f, 1]
                    size = 0.0
                    for k in range(4):
                        size += control[a, i, row + k] ** 2
                    for k in range(4):
                        control[a, i, row + k] /= math.sqrt(size)


@njit(**_options)
def stretch(control, reached, ends, factor, fields):
    """The polynomial of a step read at times so many times as late, rotations normalized."""
    order = control.shape[1]
    for i in range(1, order):
        control[:, i] = 0.0
        for k in range(order):
            value = 1.0
            for j in range(order):
                if j != k:
                    value *= (factor * ends[i] - ends[j]) / (ends[k] - ends[j])
            control[:, i] += value * reached[:, k]
    normalize(control, fields)


@njit(**_options)
def extrapolate(control, memory, matrix, fields):
    """Start from the polynomial of the step before, continued, with its rotations normalized."""
    last = control.shape[1] - 1
    for a in range(control.shape[0]):
        for i in range(1, control.shape[1]):
            for row in range(control.shape[2]):
                value = matrix[i, last] * control[a, 0, row]
                for k in range(last):
                    value += matrix[i, k] * memory[a, k, row]
                control[a, i, row] = value
    normalize(control, fields)


@njit(**_options)
def hold(mesh, control):
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
    turn(point, 0, f, 1.0)


@njit(**_options)
def move(mesh, right, control, part):
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
                    turn(control[a, i + 1], row, right[block, at : at + 3], 0.5 * part)
                else:
                    for k in range(count):
                        control[a, i + 1, row + k] += part * right[block, at + k]


@njit(**_options)
def measure(mesh, right, control):
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
def hand_on(mesh, work, control, momenta):
    """Momenta at the end of the step, μ⁺ = D_r L_d, and what its equations leave unsolved.

    The sum of D_i L_d over all nodes of a symmetric system vanishes, so with the residuals handed on the momentum maps
    do not depend on how well the equations are solved. That of a rotation is turned into the frame of the new momentum.
    """
    fields, free, right, gamma = mesh[3], mesh[4], work[5], work[0]
    last, dofs = control.shape[1] - 1, free.shape[1]
    for a in range(control.shape[0]):
        block, base = mesh[2][a, 0], mesh[2][a, 1]
        trivialize(gamma[a, last], control[a, last], fields, momenta[a])
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
