"""Points of a path of equilibria: predicted along its tangent, corrected across it, with the tangent there."""

from dataclasses import dataclass

import numpy as np

from cayley.continuation.parameter import Scaled
from cayley.statics.free import free_motions
from cayley.statics.newton import CLEAR, FLOOR, LARGEST_TURN, TOLERANCE, WILD
from cayley.steppers.still import Still

CORRECTIONS = 12
"""Most corrections of a point; more mean that the arc step was too long."""
DIFFERENCE = 1e-4
"""Step of the difference quotient along the parameter, over its range; exact for what is linear in it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """An equilibrium on a path.

    Args:
        parameter: λ.
        values: of all nodes, shape (nodes, rows).
        multipliers: of all constraints, flat.
        tangent: du/ds, shape (unknowns,), along the path.
        slope: dλ/ds.
        unstable: number of motions that lower the energy.
        corrections: number of corrections it took.
    """

    parameter: float
    values: np.ndarray
    multipliers: np.ndarray
    tangent: np.ndarray
    slope: float
    unstable: int
    corrections: int


class Track:
    """f(u, λ) = 0 with an arc length: ds² = mean over nodes of (turns² + (shifts/extent)²) + (dλ/range)².

    Args:
        still: the system of a model whose time is λ.
        scaled: that model.
        rounding: mass matrices of about the size of rounding errors of the stiffness [1/s²].
        span: width of the range of λ.
    """

    def __init__(self, still: Still, scaled: Scaled, rounding: float, span: float) -> None:
        """Set the arc length."""
        self.still, self.scaled, self.rounding, self.span = still, scaled, rounding, span
        self.inertia = self.raised = 0.0
        scale = np.zeros(len(still.made.arrays["unknown"]))
        for is_rotation, _, first, size in still.made.arrays["field"]:
            scale[still.dofs[:, first : first + size]] = 1.0 if is_rotation else still.made.struct.extent
        self.weight = np.zeros_like(scale)
        self.weight[still.free] = scale[still.free] ** 2 / still.system.size

    def dot(self, first: np.ndarray, second: np.ndarray) -> float:
        """Product of two motions, without their parameters."""
        return float(first @ (self.weight * second))

    def alike(self, first: Point, second: Point) -> float:
        """Cosine of the angle between the tangents of two points."""
        return self.dot(first.tangent, second.tangent) + first.slope * second.slope / self.span**2

    def at(self, point: Point) -> None:
        """Go to a point."""
        self.still.put(point.values, point.multipliers)
        self.scaled.put(self.still, point.parameter)

    def turn(self, point: Point) -> float:
        """Largest turn of a node per arc length at a point [rad]."""
        return self.still.measure(point.tangent)[1]

    def see_free_motions(self) -> None:
        """See whether there are motions that nothing resists here: if so, stiffness is raised by rounding errors of it.

        Zero eigenvalues would make corrections infinite, and be counted by chance; without any, the stiffness stays as
        it is, for slender rods are not much stiffer in bending than rounding errors of their stretch.
        """
        free = len(free_motions(self.still, self.rounding)) > 0
        self.inertia, self.raised = (self.rounding, CLEAR * self.rounding) if free else (0.0, 0.0)

    def push(self, parameter: float) -> np.ndarray:
        """df/dλ at the values where the system is, by central differences."""
        step = DIFFERENCE * self.span
        forces = []
        for side in (step, -step):
            self.scaled.put(self.still, parameter + side)
            forces.append(self.still.force())
        self.scaled.put(self.still, parameter)
        found: np.ndarray = (forces[0] - forces[1]) / (2.0 * step)
        return found

    def step(self, point: Point, ds: float) -> Point | None:
        """The point at an arc length from another one: on the plane across its tangent; None if it is not found.

        Source: H. B. Keller, Numerical solution of bifurcation and nonlinear eigenvalue problems (1977).
        """
        self.at(point)
        self.still.move(point.tangent, ds)
        return self.correct(point.parameter + ds * point.slope, point.tangent, point.slope, along=point)

    def correct(
        self, parameter: float, across: np.ndarray, slope: float, *, along: Point | None = None
    ) -> Point | None:
        """Correct values and parameter in the plane across a direction (across, slope), from where the system is.

        K x + f_λ dλ = −f and ⟨across, x⟩ + slope dλ = 0 by two solves with one factorization.

        Args:
            parameter: λ to begin with.
            across: motion that corrections leave as it is.
            slope: its part of λ; with a motion of zero, λ stays.
            along: a point before, which tells the sense of the tangent; without it, λ grows.

        Returns: the Point, or None where Newton's method fails.
        """
        still, first, last = self.still, 0.0, np.inf
        for corrections in range(1, CORRECTIONS + 1):
            push = self.push(parameter)
            force, regular = still.tangent(inertia=self.inertia)
            if not regular:
                return None
            x, lever = still.solve(-force), still.solve(-push)
            rate = self.dot(across, lever) + slope / self.span**2
            change = -self.dot(across, x) / rate if rate else np.inf
            x += change * lever
            size, turn, _ = still.measure(x)
            size = max(size, abs(change) / self.span)
            first = first or size
            if not np.isfinite(size) or turn > LARGEST_TURN or size > WILD * first:
                return None
            still.move(x)
            parameter += change
            if size <= TOLERANCE or (size <= FLOOR and size > 0.3 * last):
                return self._point(parameter, corrections, along, (across, slope))
            last = size
        return None

    def _point(
        self, parameter: float, corrections: int, along: Point | None, direction: tuple[np.ndarray, float]
    ) -> Point | None:
        push, still = self.push(parameter), self.still
        _, regular = still.tangent(inertia=self.inertia)
        if not regular:
            return None
        tangent, slope = still.solve(-push), 1.0
        length = np.sqrt(self.dot(tangent, tangent) + slope**2 / self.span**2)
        before, rise = direction if along is None else (along.tangent, along.slope)
        sense = np.sign(self.dot(tangent, before) + slope * rise / self.span**2) or 1.0
        return Point(
            parameter=parameter,
            values=still.values,
            multipliers=still.multipliers,
            tangent=sense * tangent / length,
            slope=float(sense * slope / length),
            unstable=still.unstable(inertia=self.raised),
            corrections=corrections,
        )
