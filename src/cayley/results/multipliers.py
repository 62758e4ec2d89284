"""Forces of constraints at saved frames: the multipliers of the equations of motion there."""

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from cayley.density.expression import to_sx
from cayley.discrete.constraint import element_constraints
from cayley.discrete.node import tangent
from cayley.results.elements import element_inputs, element_starts, element_symbols
from cayley.results.frames import Frames
from cayley.results.inertia import NodeInertia
from cayley.results.joint_rates import JointRates
from cayley.steppers.saddle import reactions, saddle_problem
from cayley.system.system import System

Rates = Callable[[np.ndarray, np.ndarray, float], np.ndarray]


@dataclass(frozen=True, slots=True)
class ConstraintForces:
    """Forces of the multipliers at saved frames, body moments and forces in space.

    Args:
        left: of each element on its left node, at that node, shape (m, nodes, dofs).
        right: of each element on its right node, at its left node, shape (m, nodes, dofs).
        point: of all joints on the nodes, shape (m, nodes, dofs).
        joints: of each joint on its first node, shape (m, joints, dofs).
    """

    left: np.ndarray
    right: np.ndarray
    point: np.ndarray
    joints: np.ndarray


def constraint_forces(system: System, frames: Frames, velocity: np.ndarray, forces: np.ndarray) -> ConstraintForces:
    """Forces of the multipliers on the nodes.

    M v̇ = F − b − Gᵀ λ and g̈ = G v̇ + γ = 0 give (G M⁻¹ Gᵀ) λ = G M⁻¹ (F − b) + γ, with b the terms of the
    velocities in d/dt ∂T/∂v (for rotations ω × Jω), and γ = Ġ v and what prescribed motions add to it: λ follows from
    the state of a frame and the time alone.

    Args:
        system: the system, of a constrained density or with joints.
        frames: its saved states.
        velocity: ω and ẋ, shape (m, nodes, dofs).
        forces: all other forces on the nodes, shape (m, nodes, dofs).

    Returns: the ConstraintForces.

    Source: Hairer, Lubich, Wanner (2006), Geometric Numerical Integration, section VII.1.2.
    """
    of_joints, saddle = JointRates(system), saddle_problem(system)
    inertia, nodes = NodeInertia(system, saddle.plan.nodes), saddle.plan.nodes
    left, right, point = (np.zeros_like(forces) for _ in range(3))
    joints = np.zeros((len(frames.times), len(system.joints), system.layout.dofs))
    turning = _all_turning(system)
    for k, time in enumerate(map(float, frames.times)):
        values, moving = frames.values[k], velocity[k]
        rates = of_joints(values, moving, time)
        rates = [*(one(values, moving, time) for _, one in turning), *rates]
        driving = forces[k].copy()
        driving[nodes] -= inertia(values, moving, time)[0]
        solved = reactions(saddle, values, time, driving, [-rate for rate in rates])
        pulls = [of_cells.sum(axis=1) for of_cells in solved.forces]
        for (elements, _), both in zip(turning, pulls[: len(turning)], strict=True):
            left[k, elements], right[k, elements] = both[:, 0], both[:, 1]
        for members, both in zip(of_joints.groups.values(), pulls[len(turning) :], strict=True):
            for joint, (first, second) in zip(members, both, strict=True):
                joints[k, joint] = first
                point[k, system.joints[joint].first] += first
                if not system.joints[joint].grounded:
                    point[k, system.joints[joint].second] += second
    return ConstraintForces(left, right, point, joints)


def _all_turning(system: System) -> list[tuple[np.ndarray, Rates]]:
    """Of every constrained density first nodes of its elements, and what gives their Ġ v, (elements, constraints)."""
    found = []
    for group, own in system.spans:
        elements = element_starts(group)
        if group.with_constraints and len(elements):
            found.append((elements + own.start, _rates(group, own, elements)))
    return found


def _rates(system: System, nodes: slice, elements: np.ndarray) -> Rates:
    turning, inputs = _turning(system), element_inputs(system, elements)
    return lambda values, moving, time: np.asarray(turning(inputs(values[nodes], moving[nodes], time))).T


def _turning(system: System) -> ca.Function:
    """Ġ v of the element that begins at a node."""
    equations, layout, known = system.equations, system.layout, element_symbols(system)
    rows = ca.vertcat(*[to_sx(e) for e in known.ends])
    pairs = zip(known.ends, known.rates, strict=True)
    moving = ca.vertcat(*[tangent(layout, end) @ to_sx(rate) for end, rate in pairs])
    ends = (known.ends[0], known.ends[1])
    g = element_constraints(equations.density, equations.rule.strain, layout, ends, known.place)
    turning = ca.jtimes(ca.jtimes(g, rows, moving), rows, moving)
    return ca.Function("turning", [known.inputs], [ca.densify(turning)])


__all__ = ["ConstraintForces", "constraint_forces"]
