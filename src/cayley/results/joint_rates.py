"""What joints ask of accelerations: the part of the second derivative of their constraints that velocities make."""

from collections.abc import Callable

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx
from cayley.discrete.joint import DRIVE, joint_constraints, parameter_count
from cayley.discrete.layout import Layout
from cayley.discrete.node import tangent
from cayley.steppers.cells import alike
from cayley.system.redundancy import ground_values
from cayley.system.system import System

STEP = 1e-4
"""Of the difference quotients of prescribed motions [s]: second ones are good to 1e-8 of the motion, over s²."""
Rates = Callable[[np.ndarray, np.ndarray, float], list[np.ndarray]]


def joint_rates(system: System) -> Rates:
    """Functions that give Ġ v + ∂²g/∂t² of all joints, where g̈ = G v̇ + Ġ v + ∂²g/∂t².

    Args:
        system: the system.

    Returns: a function of values (nodes, rows), velocities (nodes, dofs) and the time [s]; it returns an array
    (joints, constraints) for each kind of joints, in the order of their cells (see steppers.cells).
    """
    layout, groups = system.layout, alike(system.joints)
    functions = {kind: _second(*kind, layout) for kind in groups}
    ground = ground_values(layout)

    def rates(values: np.ndarray, velocity: np.ndarray, time: float) -> list[np.ndarray]:
        found = []
        for kind, joints in groups.items():
            columns = []
            for joint in joints:
                other = (ground, np.zeros(layout.dofs))
                if not joint.grounded:
                    other = values[joint.second], velocity[joint.second]
                behind, now, ahead = joint.motion(time + STEP * np.array([-1.0, 0.0, 1.0]))
                moving = [now, (ahead - behind) / (2.0 * STEP), (ahead - 2.0 * now + behind) / STEP**2]
                sides = [values[joint.first], other[0], velocity[joint.first], other[1]]
                columns.append(np.concatenate([*sides, joint.parameters, *moving]))
            found.append(np.asarray(functions[kind](np.column_stack(columns))).T)
        return found

    return rates


def _second(kind: str, grounded: bool, layout: Layout) -> ca.Function:
    """d²g/dt² at constant velocities, from both nodes, their velocities, parameters, and d, ḋ, d̈."""
    a, b = symbols("a", layout.rows), symbols("b", layout.rows)
    u, v = to_sx(symbols("u", layout.dofs)), to_sx(symbols("v", layout.dofs))
    given = symbols("c", parameter_count(kind))
    drive, faster, fastest = (symbols(name, DRIVE) for name in ("d", "d_t", "d_tt"))
    g = ca.vertcat(*[to_sx(e) for e in joint_constraints(kind, layout, (a, b), given, drive, grounded=grounded)])
    place = ca.vertcat(to_sx(a), to_sx(b), to_sx(drive))
    moving = ca.vertcat(tangent(layout, a) @ u, tangent(layout, b) @ v, to_sx(faster))
    first = ca.jtimes(g, place, moving)
    second = ca.jtimes(first, place, moving) + ca.jtimes(first, to_sx(faster), to_sx(fastest))
    inputs = [to_sx(a), to_sx(b), u, v, to_sx(given), to_sx(drive), to_sx(faster), to_sx(fastest)]
    return ca.Function("second", [ca.vertcat(*inputs)], [ca.densify(second)])


__all__ = ["joint_rates"]
