"""Joints and springs of a system as data: which nodes they couple, and the numbers their programs read."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cayley.discrete.joint import COUNTS, DRIVE
from cayley.discrete.spring import SPRINGS

GROUND = -1
"""In place of the second node."""
STILL = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
"""No prescribed motion: d = 0, r = 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupling:
    """A joint of two nodes, or of a node and the ground: g(q_first, q_second, t) = 0 (see discrete.joint).

    Args:
        kind: "weld", "ball", ...; the program is joint_program(kind, layout, grounded=grounded).
        name: what messages and results call it.
        first: node of side a.
        second: node of side b, or GROUND.
        parameters: offset and frame in a, offset and frame in b, and of a link its length [m];
            shape (parameter_count(kind),). Of a joint to the ground, offset and frame in b are those in space.
        drive: prescribed relative motion, a function of times (m,) -> d and r, shape (m, 7); None: there is none.
        steady: the prescribed motion is taken at one time, as if it stood still there.
    """

    kind: str
    name: str
    first: int
    second: int
    parameters: np.ndarray
    drive: Callable[[np.ndarray], np.ndarray] | None = None
    steady: bool = False

    @property
    def grounded(self) -> bool:
        """Whether side b is the ground."""
        return self.second == GROUND

    @property
    def count(self) -> int:
        """Number of constraints."""
        return COUNTS[self.kind]

    def motion(self, times: np.ndarray) -> np.ndarray:
        """Prescribed d [m] and r at times [s], shape (m, 7)."""
        return np.tile(STILL, (len(times), 1)) if self.drive is None else self.drive(np.asarray(times, dtype=float))


@dataclass(frozen=True, slots=True, kw_only=True)
class Elastic:
    """A spring or damper between two nodes, or a node and the ground (see discrete.spring).

    Args:
        kind: "linear", "rotational" or "bushing"; the programs are spring_program and damper_program.
        name: what messages and results call it.
        first: node of side a.
        second: node of side b, or GROUND.
        parameters: offset and frame in a, offset and frame in b, stiffness, damping, unstressed length or angle;
            shape (spring_parameter_count(kind),).
    """

    kind: str
    name: str
    first: int
    second: int
    parameters: np.ndarray

    @property
    def grounded(self) -> bool:
        """Whether side b is the ground."""
        return self.second == GROUND

    @property
    def damped(self) -> bool:
        """Whether it has any damping."""
        size = SPRINGS[self.kind] ** 2
        return bool(self.parameters[14 + size : 14 + 2 * size].any())


def joint_inputs(joint: Coupling, values: np.ndarray, ground: np.ndarray, time: float = 0.0) -> np.ndarray:
    """What the programs "slope" and "drive" of a joint read, shape (2 × rows + parameters + 7,).

    Args:
        joint: the joint.
        values: values of all nodes, shape (nodes, rows).
        ground: values of the ground, shape (rows,).
        time: the time [s].
    """
    other = ground if joint.grounded else values[joint.second]
    return np.concatenate([values[joint.first], other, joint.parameters, joint.motion(np.array([time]))[0]])


__all__ = ["DRIVE", "GROUND", "STILL", "Coupling", "Elastic", "joint_inputs"]
