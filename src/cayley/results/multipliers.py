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
        inner: of the element that begins at a node on its nodes, shape (m, nodes, degree + 1, dofs).
        multipliers: λ of each element at its strain points, per unit of length: L has λ·g there beside −W,
            shape (m, elements, points, constraints), of each density.
        point: of all joints on the nodes, shape (m, nodes, dofs).
        joints: of each joint on its first node, shape (m, joints, dofs).
    """

    inner: np.ndarray
    multipliers: tuple[np.ndarray, ...]
    point: np.ndarray
    joints: np.ndarray


def constraint_forces(system: System, frames: Frames, velocity: np.ndarray, forces: np.ndarray) -> ConstraintForces:
    """Forces of the multipliers on the nodes.

    M v̇ = F − b − Gᵀ λ and g̈ = G v̇ + γ = 0 give (G M⁻¹ Gᵀ) λ = G M⁻¹ (F − b) + γ, with b the terms of the
    velocities in d/dt ∂T/∂v (for rotations ω × Jω), and γ = Ġ v and what prescribed motions add to it: λ follows from
    the state of a frame and the time alone, F of viscous stresses from observe.acting_velocity.

    Args:
        system: the system, of a constrained density or with joints.
        frames: its saved states.
        velocity: ω and ẋ, shape (m, nodes, dofs).
        forces: all other forces on the nodes, shape (m, nodes, dofs).

    Returns: the ConstraintForces.

    Source: Hairer, Lubich, Wanner (2006), Geometric Numerical Integration, section VII.1.2.
    """
    of_joints, saddle = JointRates(system), saddle_problem(system)
    if any(joint.steady for joint in system.joints):
        saddle.struct.watch = None  # redundant joints are told from others by inertia, which has no part at rest
    inertia, nodes = NodeInertia(system, saddle.plan.nodes), saddle.plan.nodes
    joints = np.zeros((len(frames.times), len(system.joints), system.layout.dofs))
    point, inner = (
        np.zeros_like(forces),
        np.zeros((*forces.shape[:2], system.equations.rule.degree + 1, forces.shape[2])),
    )
    turning, multipliers = _all_turning(system), _no_multipliers(system, len(frames.times))
    found = [own for own in multipliers if own.size]
    for k, time in enumerate(map(float, frames.times)):
        values, moving = frames.values[k], velocity[k]
        rates = of_joints(values, moving, time)
        rates = [*(one(values, moving, time) for _, one in turning), *rates]
        driving = forces[k].copy()
        driving[nodes] -= inertia(values, moving, time)[0]
        solved = reactions(saddle, values, time, driving, [-rate for rate in rates])
        pulls = [of_cells.sum(axis=1) for of_cells in solved.forces]
        for (elements, _), pulled in zip(turning, pulls[: len(turning)], strict=True):
            inner[k, elements] = pulled
        for own, (cells, impulse) in zip(found, solved.multipliers[: len(found)], strict=True):
            own[k] = -impulse.reshape(own.shape[1:]) / cells.weight[:, :, None]
        for members, both in zip(of_joints.groups.values(), pulls[len(turning) :], strict=True):
            for joint, (first, second) in zip(members, both, strict=True):
                joints[k, joint] = first
                point[k, system.joints[joint].first] += first
                if not system.joints[joint].grounded:
                    point[k, system.joints[joint].second] += second
    return ConstraintForces(inner, tuple(multipliers), point, joints)


def _all_turning(system: System) -> list[tuple[np.ndarray, Rates]]:
    """Of every constrained density first nodes of its elements, and what gives their Ġ v, (elements, constraints)."""
    found = []
    for group, own in system.spans:
        elements = element_starts(group)
        if group.with_constraints and len(elements):
            found.append((elements + own.start, _rates(group, own, elements)))
    return found


def _no_multipliers(system: System, frames: int) -> list[np.ndarray]:
    """Zeros for the multipliers of every density, shape (frames, elements, points, constraints)."""
    points = len(system.equations.rule.strain.at)
    kinds = [(len(element_starts(own)), points, own.equations.density.constraints.numel()) for own in system.groups]
    return [np.zeros((frames, *kind)) for kind in kinds]


def _rates(system: System, nodes: slice, elements: np.ndarray) -> Rates:
    turning, inputs = _turning(system), element_inputs(system, elements)
    return lambda values, moving, time: np.asarray(turning(inputs(values[nodes], moving[nodes], time))).T


def _turning(system: System) -> ca.Function:
    """Ġ v of the element that begins at a node."""
    equations, layout, known = system.equations, system.layout, element_symbols(system)
    rows = ca.vertcat(*[to_sx(e) for e in known.ends])
    pairs = zip(known.ends, known.rates, strict=True)
    moving = ca.vertcat(*[tangent(layout, end) @ to_sx(rate) for end, rate in pairs])
    g = element_constraints(equations.density, equations.rule.strain, layout, known.ends, known.place)
    turning = ca.jtimes(ca.jtimes(g, rows, moving), rows, moving)
    return ca.Function("turning", [known.inputs], [ca.densify(turning)])


__all__ = ["ConstraintForces", "constraint_forces"]
