"""Newton's method for equilibria: at once, along fading forces, with a line search, and with inertia from far away."""

from dataclasses import dataclass, field

import numpy as np

from cayley.steppers.still import Still

ITERATIONS, MOST_RELAXED = 40, 400
"""Most corrections of one try, and of a relaxation."""
TOLERANCE = 1e-9
"""A correction this small, by a new tangent, is the last: the next would be about its square."""
FLOOR = 1e-6
"""Below, a correction that no longer shrinks is rounding."""
IDLE, LIFT = 1e-2, 1e3
"""Size below which a correction that no longer shrinks may be a motion that nothing resists, driven by rounding; and by
how much more stiffness is raised to see: that makes such a motion as much shorter."""
LARGEST_TURN, WANTED_TURN = 2.0, 1.6
"""Longest turn of one correction, and that of the first one of a load step [rad]: 2 is a quarter turn after Cayley."""
WILD = 2.0
"""Full corrections that grow to so many times the first lead nowhere; they zigzag before: bending, then stretch."""
SMALLEST_PART, SMALLEST_STEP = 1e-3, 1e-5
"""Smallest part of a correction, and of the load, that is tried."""
EASY = 5
"""After a load step of so few corrections the next one is longer, by GROWTH."""
GROWTH = 1.5
RELAXED_SIZE, PUSH = 0.2, 1e-4
"""Size of a correction that relaxation aims at, and of a push by chance off an unstable equilibrium."""
CLEAR = 30.0
"""Stiffness, in multiples of that by which K is raised, up to which it counts as none."""


@dataclass(slots=True)
class Solution:
    """How a search ended.

    Args:
        found: whether it converged.
        how: "newton", "line search" or "relaxation".
        load_steps: number of steps in which forces were put on.
        history: (size, largest force before) of every correction of the last try; sizes are in radians, or lengths over
            the extent, forces in N and N m.
        iterations: number of all corrections.
        worst: node of the largest last correction.
        long: turn of a first correction that was too long to be taken [rad], or 0.
    """

    found: bool = False
    how: str = "newton"
    load_steps: int = 1
    history: list[tuple[float, float]] = field(default_factory=list)
    iterations: int = 0
    worst: int = -1
    long: float = 0.0


def solve(still: Still, *, inertia: float = 0.0, relax: bool | None = None, bent: bool = False) -> Solution:
    """Find an equilibrium from where a system is.

    Loads are put on in as few steps as corrections that turn by no more than LARGEST_TURN allow: point and line loads
    times λ, and what else acts at the start fades, f(q) = (1 − λ) f(q₀). Loads are not faded but scaled, for a moment
    in space less one that turns with its node is a load of another kind, under which a rod may have no equilibrium.
    Where this ends before λ = 1, Newton's method with a line search is tried, then relaxation.

    Args:
        still: the system; it ends at the equilibrium, or where it was.
        inertia: mass matrices by which stiffness is raised [1/s²] so that motions without any stay finite.
        relax: True: by relaxation alone; False: not at all.
        bent: the start is not the reference, so positions are settled first: then rods bear their loads in the shape
            they begin with, and a cable has the tension that makes it stiff.
    """
    start = still.values, still.multipliers
    total, told = 0, Solution()
    searches = [*([_settled] if bent else []), _stepped, _careful]
    for search in [_relaxed] if relax else searches if relax is False else [*searches, _relaxed]:
        still.put(*start)
        told = search(still, inertia)
        total += told.iterations
        if told.found:
            break
    else:
        still.put(*start)
    told.iterations = total
    return told


def _settled(still: Still, inertia: float) -> Solution:
    x = still.settle(inertia=inertia)
    if x is None or not np.isfinite(still.measure(x)[0]):
        return Solution()
    still.move(x)
    return newton(still, inertia=inertia)


def _stepped(still: Still, inertia: float) -> Solution:
    still.put_on(0.0)
    begin, total = still.force(), Solution(load_steps=0)
    done, step = 0.0, 1.0
    while done < 1.0:
        to = min(1.0, done + step)
        reached = still.values, still.multipliers
        still.put_on(to)
        told = newton(still, fade=(1.0 - to) * begin if to < 1.0 else None, inertia=inertia)
        total.iterations += told.iterations
        total.history, total.worst = told.history, told.worst
        if told.found:
            done, total.load_steps = to, total.load_steps + 1
            step *= GROWTH if told.iterations <= EASY else 1.0
            continue
        still.put(*reached)
        step = (to - done) * (max(WANTED_TURN / told.long, 0.05) if told.long else 0.5)
        if step < SMALLEST_STEP:
            still.put_on(1.0)
            return total
    total.found = True
    return total


def newton(
    still: Still, *, fade: np.ndarray | None = None, inertia: float = 0.0, careful: bool = False, most: int = ITERATIONS
) -> Solution:
    """Correct values and multipliers until forces vanish: K x = −f, q ← q + x.

    After each correction positions are settled (see Still.settle): the stretch by its turn, at most η²/2, would be a
    force of EA η²/2 in the next tangent, and slender rods would take many small corrections. Structures converge fast
    but not monotonically, so full corrections are taken; with care, that part after which the next correction with the
    same tangent is shorter (the natural monotonicity test).

    Args:
        still: the system; where it is, is the start.
        fade: forces that are subtracted.
        inertia: see solve.
        careful: with line search; without one, a first correction that turns too far is not taken.
        most: largest number of corrections.

    Source: P. Deuflhard, Newton Methods for Nonlinear Problems (2004), section 3.3.
    """
    told, last = Solution(), np.inf
    for _ in range(most):
        force, regular = still.tangent(inertia=inertia)
        if fade is not None:
            force -= fade
        if not regular:
            return told
        x = still.solve(-force)
        size, turn, told.worst = still.measure(x)
        told.history.append((size, float(np.abs(force).max(initial=0.0))))
        told.iterations += 1
        if not np.isfinite(size):
            return told
        if not careful and turn > LARGEST_TURN and told.iterations == 1:
            told.long = turn
            return told
        if not careful and size > WILD * told.history[0][0]:
            return told
        if size <= TOLERANCE or (size <= FLOOR and size > 0.3 * last):
            still.move(x)
            told.found = True
            return told
        if size <= IDLE and size > 0.3 * last and _idles(still, fade, inertia):
            told.found = True
            return told
        if careful:
            if not _part(still, x, size, turn, fade):
                told.found = size <= IDLE and _idles(still, fade, inertia)
                return told
        else:
            still.move(x, min(1.0, LARGEST_TURN / turn) if turn > 0.0 else 1.0)
            _settle(still, size, fade, inertia)
        last = size
    return told


def _settle(still: Still, size: float, fade: np.ndarray | None, inertia: float) -> None:
    """Take out what a correction stretched, if that is no more than the correction itself."""
    if size > FLOOR:
        x = still.settle(fade, inertia=inertia)
        if x is not None and still.measure(x)[0] <= size:
            still.move(x)


def _idles(still: Still, fade: np.ndarray | None, inertia: float) -> bool:
    """Whether all that is left to correct are motions that nothing resists, as of a pinned rod about its own axis."""
    force, regular = still.tangent(inertia=LIFT * inertia)
    x = still.solve(-(force if fade is None else force - fade)) if regular else force
    if regular and still.measure(x)[0] <= FLOOR:
        still.move(x)
        return True
    still.tangent(inertia=inertia)
    return False


def _careful(still: Still, inertia: float) -> Solution:
    told = newton(still, inertia=inertia, careful=True)
    told.how = "line search"
    return told


def _part(still: Still, x: np.ndarray, size: float, turn: float, fade: np.ndarray | None) -> float:
    """Correct by the largest part of x that passes the test; returns it, or 0 where none does."""
    values, multipliers = still.values, still.multipliers
    part = min(1.0, LARGEST_TURN / turn) if turn > 0.0 else 1.0
    while part > SMALLEST_PART:
        still.move(x, part)
        force = still.force()
        next_size = still.measure(still.solve(-(force if fade is None else force - fade)))[0]
        if next_size <= (1.0 - 0.25 * part) * size:
            return part
        still.put(values, multipliers)
        part *= 0.5
    return 0.0


def _relaxed(still: Still, inertia: float) -> Solution:
    """Pseudo-transient continuation, (K + σM) x = −f, downhill: σ keeps K + σM positive and corrections short.

    Source: C. T. Kelley and D. E. Keyes, Convergence analysis of pseudo-transient continuation (1998), section 2.
    """
    told, sigma, chance = Solution(how="relaxation"), max(inertia, still.fastest()), np.random.default_rng(1)
    for _ in range(MOST_RELAXED):
        told.iterations += 1
        force, regular = still.tangent(inertia=sigma)
        x = still.solve(-force) if regular else force
        size, _, told.worst = still.measure(x) if regular else (np.inf, 0.0, -1)
        told.history = [*told.history[-8:], (size, float(np.abs(force).max(initial=0.0)))]
        if not size <= 2.0 * RELAXED_SIZE or still.unstable(inertia=sigma):
            sigma *= 4.0
            if size <= TOLERANCE:  # at an unstable equilibrium: off it
                x[still.free] = PUSH * chance.standard_normal(len(still.free))
                still.move(x)
            continue
        still.move(x)
        if size <= TOLERANCE and sigma <= 2.0 * inertia:
            told.found = True
            return told
        sigma = max(sigma * min(max(size / RELAXED_SIZE, 0.1), 2.0), inertia)
        if size < 1e-3 * RELAXED_SIZE:
            ahead = still.values, still.multipliers
            end = newton(still, inertia=inertia)
            told.iterations += end.iterations
            if end.found and not still.unstable(inertia=CLEAR * inertia):
                told.found, told.history = True, end.history
                return told
            still.put(*ahead)
    return told
