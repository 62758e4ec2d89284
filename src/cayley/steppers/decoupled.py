"""Step systems whose nodes decouple: explicit-like rules with corners in time.

With P the momentum after the inertia of a step and F(qʲ) all forces at a node, one step is

    P + h F(qʲ) = −D₀ T_d(qʲ, qʲ⁺¹)   -> qʲ⁺¹,        P = D₁ T_d(qʲ, qʲ⁺¹),

the force serving the step before and the step after; at a saved frame the momentum is μ = P + h/2 F. Kernels do both
halves of the first line for a block of nodes; this driver repeats them between saves, without Python.
"""

import math

import numpy as np
from numba import njit

from cayley.steppers.calls import call_kernel, call_setup

FINISHED, NOT_CONVERGED, NOT_FINITE = 0, 1, 2

_H, _T, _T_NEXT = 0, 1, 2  # places in the uniform inputs


@njit(cache=True, nogil=True, error_model="numpy")
def advance(
    kernels: np.ndarray,
    data: np.ndarray,
    uniforms: np.ndarray,
    timed: bool,
    spans: np.ndarray,
    depth: int,
    clock: np.ndarray,
    held: np.ndarray,
    table: np.ndarray,
    entries: np.ndarray,
    scales: np.ndarray,
    places: np.ndarray,
    stride: int,
    frames: np.ndarray,
) -> tuple[int, int]:
    """Advance from one saved frame through len(frames) others.

    Args:
        kernels: addresses of run and setup of step, step_held and kick, shape (3, 2).
        data: blocks, shape (blocks + 2, rows, lanes), the first and last of them padding; changed in place.
        uniforms: uniform inputs of each kernel and room behind them, shape (3, width); h, t and t_next are set here.
        timed: whether the density depends on time, so that uniform values change at every step.
        spans: (first block, last block, any component held) of each tile, in order, shape (tiles, 3).
        depth: how many steps a tile takes before its neighbors follow (a wavefront that keeps tiles in the cache).
        clock: origin of time [s], step [s], number of the first step.
        held: (block, row, lane) of momenta that are zero, shape (m, 3).
        table: loads at every step, shape (len(frames) * stride + 1, columns).
        entries: (block, lane, row of momentum, row of rotation, form, column, tile) per loaded node, sorted by tile.
        scales: factor of each entry [-, m].
        places: first entry of each tile, shape (tiles + 1,).
        stride: steps between frames.
        frames: values and momenta at each save, shape (saves, blocks, rows kept, lanes); filled here.

    Returns: (outcome, number of the save in which it happened).
    """
    where = data.ctypes.data
    origin, h, begin = clock[0], clock[1], int(clock[2])
    for kind in range(2):
        _set(kernels, uniforms, kind, h, origin + begin * h, origin + (begin + 1) * h)
    tiles, kept = len(spans), frames.shape[2]
    for save in range(len(frames)):
        first = save * stride
        _kick(kernels, data, uniforms, spans, -0.5 * h, origin + (begin + first) * h)
        for e in range(len(entries)):
            _push(data, entries, scales, table[first], e, -0.5 * h)
        done = 0
        failed = 0
        while done < stride:
            together = min(depth, stride - done)
            for front in range(tiles + together - 1):
                for k in range(max(0, front - tiles + 1), min(together, front + 1)):
                    tile = front - k
                    j = first + done + k
                    for e in range(places[tile], places[tile + 1]):
                        _push(data, entries, scales, table[j], e, h)
                    kind = spans[tile, 2]
                    if timed:
                        _set(kernels, uniforms, kind, h, origin + (begin + j) * h, origin + (begin + j + 1) * h)
                    constants = uniforms[kind].ctypes.data
                    failed += call_kernel(kernels[kind, 0], where, constants, spans[tile, 0], spans[tile, 1])
            done += together
            if failed:
                return NOT_CONVERGED, save
        _kick(kernels, data, uniforms, spans, 0.5 * h, origin + (begin + first + stride) * h)
        for e in range(len(entries)):
            _push(data, entries, scales, table[first + stride], e, 0.5 * h)
        for k in range(len(held)):
            data[held[k, 0], held[k, 1], held[k, 2]] = 0.0
        if not _copy(data, frames[save], kept):
            return NOT_FINITE, save
    return FINISHED, len(frames)


@njit(cache=True, nogil=True, error_model="numpy")
def _set(kernels: np.ndarray, uniforms: np.ndarray, kind: int, h: float, t: float, t_next: float) -> None:
    """Give a kernel its step and times."""
    uniforms[kind, _H], uniforms[kind, _T], uniforms[kind, _T_NEXT] = h, t, t_next
    call_setup(kernels[kind, 1], uniforms[kind].ctypes.data)


@njit(cache=True, nogil=True, error_model="numpy")
def _kick(kernels: np.ndarray, data: np.ndarray, uniforms: np.ndarray, spans: np.ndarray, h: float, t: float) -> None:
    """Add h × (forces of the density) to all momenta."""
    _set(kernels, uniforms, 2, h, t, t)
    call_kernel(kernels[2, 0], data.ctypes.data, uniforms[2].ctypes.data, spans[0, 0], spans[-1, 1])


@njit(cache=True, nogil=True, error_model="numpy")
def _push(data: np.ndarray, entries: np.ndarray, scales: np.ndarray, loads: np.ndarray, e: int, h: float) -> None:
    """Add h × one load to the momentum of one node.

    Forms: 0 as given; 1 space to body and 2 body to space by a quaternion; 3 and 4 the same by a matrix.
    """
    block, lane, row, turn, form, column = entries[e, :6]
    s = h * scales[e]
    a, b, c = s * loads[column], s * loads[column + 1], s * loads[column + 2]
    if a == 0.0 and b == 0.0 and c == 0.0:
        return
    if form in (1, 2):
        sign = 2.0 if form == 2 else -2.0
        w, x = data[block, turn, lane], data[block, turn + 1, lane]
        y, z = data[block, turn + 2, lane], data[block, turn + 3, lane]
        u, v, r = y * c - z * b, z * a - x * c, x * b - y * a
        p, q, o = y * r - z * v, z * u - x * r, x * v - y * u
        a, b, c = a + sign * w * u + 2.0 * p, b + sign * w * v + 2.0 * q, c + sign * w * r + 2.0 * o
    elif form != 0:
        across, down = (3, 1) if form == 3 else (1, 3)
        m = data[block, turn : turn + 9, lane]
        a, b, c = (
            m[0] * a + m[across] * b + m[2 * across] * c,
            m[down] * a + m[down + across] * b + m[down + 2 * across] * c,
            m[2 * down] * a + m[2 * down + across] * b + m[2 * down + 2 * across] * c,
        )
    data[block, row, lane] += a
    data[block, row + 1, lane] += b
    data[block, row + 2, lane] += c


@njit(cache=True, nogil=True, error_model="numpy")
def _copy(data: np.ndarray, frame: np.ndarray, kept: int) -> bool:
    """Copy values and momenta into a frame; False if one of them is not finite."""
    check = 0.0
    for b in range(frame.shape[0]):
        for row in range(kept):
            for lane in range(frame.shape[2]):
                value = data[b + 1, row, lane]
                frame[b, row, lane] = value
                check += 0.0 * value
    return math.isfinite(check)
