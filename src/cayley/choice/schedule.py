"""Equal steps that meet the saves."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Schedule:
    """Equal steps that meet the saves.

    Args:
        h: time step [s].
        stride: steps between two saves.
        saves: number of full strides.
        rest: steps of a last, shorter stride.
        strides: steps between saves that are not equally far apart, instead.
    """

    h: float
    stride: int
    saves: int
    rest: int
    strides: tuple[int, ...] = ()

    @property
    def pieces(self) -> list[tuple[int, int]]:
        """Strides, and how many times each is taken, one after the other."""
        equal = [(self.stride, self.saves), (self.rest, 1)]
        return [(stride, times) for stride, times in [*equal, *((own, 1) for own in self.strides)] if stride and times]

    @property
    def steps(self) -> int:
        """Number of steps."""
        return self.stride * self.saves + self.rest + sum(self.strides)

    @property
    def frames(self) -> int:
        """Number of frames, with that of the start."""
        return 1 + sum(times for _, times in self.pieces)


def schedule(span: float, dt: float, save_every: float) -> Schedule:
    """Equal steps, at most dt, that meet the saves; where saves do not divide the span, its end instead.

    Args:
        span: length of the run [s].
        dt: upper bound of the step [s].
        save_every: time between saves [s].
    """
    saves = span / save_every
    if abs(saves - round(saves)) < 1e-9 * saves:
        stride = max(1, math.ceil(save_every / dt * (1.0 - 1e-12)))
        return Schedule(span / (round(saves) * stride), stride, round(saves), 0)
    steps = max(1, math.ceil(span / dt * (1.0 - 1e-12)))
    h = span / steps
    stride = max(1, round(save_every / h))
    return Schedule(h, stride, steps // stride, steps % stride)
