"""Trial runs: where the nodes are at a few times, and how far two runs with different steps are apart."""

import math
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from cayley.steppers import coupled_run, decoupled_run, implicit_run
from cayley.steppers.outcome import Outcome
from cayley.steppers.saddle import is_constrained
from cayley.system.system import State, System

FRAMES, FEWEST_FRAMES = 64, 8
"""Times in a whole run at which trials are compared, and the fewest for large systems."""
LARGEST_TRACK = 1_000_000
"""Nodes times frames of a trial; larger systems are compared at fewer times."""


@dataclass(frozen=True, slots=True)
class Track:
    """Where the nodes were in a trial, at the start and after every frame.

    Args:
        h: step of the trial [s].
        places: positions of the nodes [m], shape (frames + 1, nodes, k).
        turns: rotations of nodes without an element (bodies, or all there is), twice the quaternion so that small
            distances are angles [rad], shape (frames + 1, k, m); without such nodes m is 0.
    """

    h: float
    places: np.ndarray
    turns: np.ndarray

    @property
    def frames(self) -> int:
        """Number of frames after the start."""
        return len(self.places) - 1

    @property
    def extent(self) -> float:
        """What position errors are relative to [m]: the diagonal of the box around all nodes at the start.

        Of a single node it is the box around its way, and 1 where that does not move.
        """
        if self.places.shape[2] == 0:
            return 1.0
        size = float(np.linalg.norm(np.ptp(self.places[0], axis=0)))
        if size == 0.0:
            size = float(np.linalg.norm(np.ptp(self.places, axis=(0, 1))))
        return size if size > 0.0 else 1.0

    @property
    def moved(self) -> float:
        """Largest distance from the start, over the extent or in radians [-]."""
        start = Track(self.h, self.places[:1], self.turns[:1])
        return float(max(_apart(self.places, start.places).max() / self.extent, _apart(self.turns, start.turns).max()))


def stepper_of(system: System) -> ModuleType:
    """The module that steps a system."""
    if system.equations.rule.implicit:
        return implicit_run
    coupled = is_constrained(system) or system.springs or system.members or system.contact is not None
    return coupled_run if coupled else decoupled_run


def frames_of(nodes: int) -> int:
    """Number of times in a whole run at which trials are compared."""
    return max(FEWEST_FRAMES, min(LARGEST_TRACK // nodes, FRAMES))


def follow(system: System, state: State, spacing: float, frames: int, h: float) -> Track | None:
    """Run from a state through equally spaced frames.

    Args:
        system: the system.
        state: the start.
        spacing: time between frames [s].
        frames: how many of them.
        h: upper bound of the step [s], fitted to the frames.

    Returns: the Track, or None if a step was not solved or the motion blew up.
    """
    stride = max(1, math.ceil(spacing / h * (1.0 - 1e-9)))
    start = state.at_step(spacing / stride)
    received = [start.values[None]]

    def receive(values: np.ndarray, momenta: np.ndarray, **more: np.ndarray) -> None:
        received.append(values)

    result = stepper_of(system).run(system, start, stride=stride, saves=frames, receive=receive)
    if result.outcome is not Outcome.FINISHED:
        return None
    values, layout = np.concatenate(received), system.layout
    vectors = [values[..., layout.rows_of(name)] for name in layout.fields if name not in layout.rotations]
    lone = np.repeat(np.array(system.chains) == 1, system.chains)
    turns = [
        2.0 * layout.representation.to_quaternion(values[:, lone, layout.rows_of(name)])
        for name in layout.rotations
        if lone.any()
    ]
    nothing = values[..., :0]
    places = np.concatenate([*vectors, nothing], axis=2)
    return Track(start.h, places, np.concatenate(turns, axis=2) if turns else nothing)


def differences(first: Track, second: Track) -> np.ndarray:
    """Largest distance of a node in two trials so far, over the extent, at the frames they share [-].

    Returns: shape (frames + 1,); infinite from where a trial is not finite.
    """
    count = min(len(first.places), len(second.places))
    places = _apart(first.places[:count], second.places[:count]) / second.extent
    apart = np.maximum(places, _apart(first.turns[:count], second.turns[:count]))
    found: np.ndarray = np.maximum.accumulate(np.where(np.isfinite(apart), apart, np.inf))
    return found


def _apart(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Largest distance over the nodes, frame by frame."""
    found: np.ndarray = np.linalg.norm(first - second, axis=2).max(axis=1)
    return found
