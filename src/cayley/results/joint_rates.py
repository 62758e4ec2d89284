"""What joints ask of the accelerations at a frame."""

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx
from cayley.discrete.joint import DRIVE, joint_constraints, once, parameter_count
from cayley.discrete.layout import Layout
from cayley.discrete.node import tangent
from cayley.system.couplings import Coupling
from cayley.system.redundancy import ground_values
from cayley.system.system import System

_STEP = 1e-4
"""Step of the differences for rates of a prescribed motion [s]; the error of its acceleration is about 1e-8 of it."""


class JointRates:
    """d²g/dt² of joints without the accelerations of the nodes: what velocities and prescribed motions add.

    Joints of one kind stand together, in the order of steppers.cells.joint_cells.
    """

    def __init__(self, system: System) -> None:
        """Derive the functions of the kinds there are."""
        self.system = system
        self.groups: dict[tuple[str, bool], list[int]] = {}
        for k, joint in enumerate(system.joints):
            self.groups.setdefault((joint.kind, joint.grounded), []).append(k)
        self.functions = {key: _second_rate(key[0], system.layout, grounded=key[1]) for key in self.groups}

    def __call__(self, values: np.ndarray, velocity: np.ndarray, time: float) -> list[np.ndarray]:
        """For values and velocities of all nodes at a time, shape (joints, constraints) for every kind."""
        if not self.groups:  # what has no joints may have no pose
            return []
        ground, still = ground_values(self.system.layout), np.zeros(self.system.layout.dofs)
        found = []
        for key, members in self.groups.items():
            rows = []
            for joint in (self.system.joints[k] for k in members):
                other = (ground, still) if joint.grounded else (values[joint.second], velocity[joint.second])
                nodes = [values[joint.first], other[0], velocity[joint.first], other[1]]
                rows.append(np.concatenate([*nodes, joint.parameters, *_motions(joint, time)]))
            found.append(np.asarray(self.functions[key](np.array(rows).T)).T)
        return found


def _motions(joint: Coupling, time: float) -> list[np.ndarray]:
    """Prescribed motion, its rate and its acceleration, shape (7,) each."""
    if joint.drive is None or joint.steady:
        return [joint.motion(np.array([time]))[0], np.zeros(DRIVE), np.zeros(DRIVE)]
    before, now, after = joint.drive(np.array([time - _STEP, time, time + _STEP]))
    return [now, (after - before) / (2.0 * _STEP), (after - 2.0 * now + before) / _STEP**2]


@once
def _second_rate(kind: str, layout: Layout, *, grounded: bool) -> ca.Function:
    a, b = symbols("a", layout.rows), symbols("b", layout.rows)
    velocities = [symbols("u", layout.dofs), symbols("v", layout.dofs)]
    given = symbols("c", parameter_count(kind))
    drive, rate, acceleration = (symbols(n, DRIVE) for n in ("d", "d1", "d2"))
    g = ca.vertcat(*[to_sx(e) for e in joint_constraints(kind, layout, (a, b), given, drive, grounded=grounded)])
    at = ca.vertcat(to_sx(a), to_sx(b), to_sx(drive))
    moving = [tangent(layout, node) @ to_sx(v) for node, v in zip((a, b), velocities, strict=True)]
    along = ca.vertcat(*moving, to_sx(rate))
    first = ca.jtimes(g, at, along)
    second = ca.jtimes(first, at, along) + ca.jtimes(g, to_sx(drive), to_sx(acceleration))
    inputs = [a, b, *velocities, given, drive, rate, acceleration]
    return ca.Function("second", [ca.vertcat(*[to_sx(e) for e in inputs])], [ca.densify(second)])
