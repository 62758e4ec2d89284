"""Step systems by Galerkin rules: Newton's method on the block-tridiagonal equations of the control nodes of a step.

With control nodes q_{a,i}, i = 0 ... r, of every node a, and L_d the quadrature of the action over one step,

    μ_a + D_{a,0} L_d = 0,   D_{a,i} L_d = 0 (0 < i < r)   -> q_{a,1} ... q_{a,r},      μ_a⁺ = D_{a,r} L_d.

A block is the nodes of one element without its left end; block LU runs along each chain.
"""

import math

import numpy as np
from numba import njit

from cayley.steppers.contraction import assemble, first_guess
from cayley.steppers.controls import hand_on, hold, measure, move, stretch
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
FIRST_PART = 1.0 / 16.0
"""Where nothing else serves, the solution is followed from that of a step so much shorter."""
SMALLEST_GROWTH = 1.02
"""It is followed to longer steps by factors that fall from 2 to this."""

_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def advance(calls, rule, mesh, work, state, warm, loads, clock, stride, frames, counts):
    """Advance through len(frames) saves of stride steps each; the arguments are those of steppers.galerkin_plan.

    Returns: (outcome, number of the save); counts holds iterations in all, most in a step, failed step and node.
    """
    control, momenta, memory = state
    nodes, last = control.shape[0], control.shape[1] - 1
    rows = control.shape[2]
    for save in range(frames.shape[0]):
        for j in range(stride):
            number = save * stride + j
            begin = clock[0] + (clock[2] + number) * clock[1]
            solved = False
            for attempt in range(3):  # then with care, then with care from the safest start, the state itself
                onward = warm or number > 0
                first_guess(calls, rule, mesh, work, state, memory, onward, attempt > 1, begin, clock[1])
                passes, worst, solved = _newton(
                    calls, rule, mesh, work, state, loads, number, begin, clock[1], attempt > 0
                )
                counts[0] += passes
                counts[1] = max(counts[1], passes)
                if solved:
                    break
            if not solved:
                passes, worst, solved = _follow(calls, rule, mesh, work, state, loads, number, begin, clock[1])
                counts[0] += passes
            counts[2], counts[3] = number, worst
            if not solved:
                return NOT_CONVERGED, save
            hand_on(mesh, work, control, momenta)
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
        assemble(calls, rule, mesh, work, state, loads, number, begin, h, fresh)
        if fresh:
            _factorize_chains(mesh, work)
        residual = np.abs(right).max()
        _solve_chains(mesh, work)
        size, turn, worst = measure(mesh, right, control)
        note(work[14], iteration, size, residual)
        if careful and not size <= max(LARGEST_GROWTH * last, FLOOR) and part > SMALLEST_PART:  # also for NaN
            part *= 0.5
            control[:] = accepted
            move(mesh, taken, control, part)
            hold(mesh, control)
            continue
        if not math.isfinite(size) or (not careful and size > max(WILD_GROWTH * last, FLOOR)):
            return iteration + 1, worst, False
        accepted[:] = control
        taken[:] = right
        part = min(1.0, LARGEST_TURN / turn) if turn > 0.0 else 1.0
        move(mesh, taken, control, part)
        hold(mesh, control)
        rate = size / last  # 0 at first
        settled = size <= STEP_TOLERANCE or (size <= FLOOR and rate > 0.3)
        if (fresh and settled) or (0.0 < rate < SLOW and size * rate <= LEFT_TOLERANCE):
            assemble(calls, rule, mesh, work, state, loads, number, begin, h, False)  # momenta of the corrected nodes
            return iteration + 1, worst, True
        fresh = careful or rate > SLOW
        last = size
    return ITERATIONS, worst, False


@njit(**_options)
def note(history, iteration, size, residual):
    """Write the last iterations down: the latest in the last row, NaN where there was none."""
    if iteration == 0:
        history[:] = math.nan
    for k in range(history.shape[0] - 1):
        history[k] = history[k + 1]
    history[-1, 0], history[-1, 1] = size, residual


@njit(**_options)
def _follow(calls, rule, mesh, work, state, loads, number, begin, h):
    """Solve a step by following the solution from that of a much shorter one; the step itself stays what it is.

    Returns: (iterations, node of the largest correction, converged).
    """
    control = state[0]
    for i in range(1, control.shape[1]):
        control[:, i] = control[:, 0]
    reached = control.copy()
    size, good, growth, count = FIRST_PART, 0.0, 2.0, 0
    while True:
        passes, worst, solved = _newton(calls, rule, mesh, work, state, loads, number, begin, size * h, False)
        count += passes
        if solved and size == 1.0:
            return count, worst, True
        if solved:
            good = size
            reached[:] = control
        else:
            growth = math.sqrt(growth)
            if good == 0.0 or growth < SMALLEST_GROWTH:
                return count, worst, False
        size = min(1.0, good * growth)
        stretch(control, reached, rule[8], size / good, mesh[3])
        hold(mesh, control)


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
