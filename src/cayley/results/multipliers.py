"""Forces of constraints at saved frames: the multipliers of the equations of motion there."""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.constraint import element_constraints
from cayley.discrete.node import node_point, tangent
from cayley.results.frames import Frames
from cayley.results.reactions import JointRates
from cayley.steppers.saddle import make_plan, reactions
from cayley.system.system import System


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
    function, of_joints, plan = _rates(system), JointRates(system), make_plan(system)
    left, right, point = (np.zeros_like(forces) for _ in range(3))
    joints = np.zeros((len(frames.times), len(system.joints), system.layout.dofs))
    elements = np.flatnonzero(system.named["length"])
    constrained = bool(system.equations.density.constraints.numel() and len(elements))
    for k, time in enumerate(frames.times):
        turning, bias = function(_inputs(system, frames.values[k], velocity[k], float(time)))
        rates = [np.asarray(turning).T[elements]] if constrained else []
        rates += of_joints(frames.values[k], velocity[k], float(time))
        solved = reactions(system, plan, frames.state(k), forces[k] - np.asarray(bias).T, [-rate for rate in rates])
        found = [of_cells.sum(axis=1) for of_cells in solved.forces]
        if constrained:
            left[k, elements], right[k, elements] = found[0][:, 0], found[0][:, 1]
        for members, both in zip(of_joints.groups.values(), found[constrained:], strict=True):
            for joint, (first, second) in zip(members, both, strict=True):
                joints[k, joint] = first
                point[k, system.joints[joint].first] += first
                if not system.joints[joint].grounded:
                    point[k, system.joints[joint].second] += second
    return ConstraintForces(left, right, point, joints)


def _rates(system: System) -> ca.Function:
    """Ġ v of the element at the right of a node, and b of the node."""
    equations, layout = system.equations, system.layout
    density, along = equations.density, equations.density.lagrangian.interval
    ends = symbols("a", layout.rows), symbols("b", layout.rows)
    rates = symbols("u", layout.dofs), symbols("v", layout.dofs)
    named = {n: wrap(ca.SX.sym(n)) for n in ("inverse", "left", "right", "weight", "t")}
    place = named | {"here": named["left"]}
    rows = ca.vertcat(*[to_sx(e) for e in ends])
    moving = ca.vertcat(*[tangent(layout, e) @ to_sx(v) for e, v in zip(ends, rates, strict=True)])
    g = element_constraints(density, equations.rule.strain, layout, ends, place)
    turning = ca.jtimes(ca.jtimes(g, rows, moving), rows, moving)
    point = node_point(layout, ends[0], along, place)
    point |= {f"{name}_t": rates[0][layout.dofs_of(name)] for name in layout.fields}
    gradient = density.gradient("inertia", point)
    momentum = ca.vertcat(*[to_sx(gradient[f"{name}_t"]) for name in layout.fields])
    bias = ca.jtimes(momentum, to_sx(ends[0]), tangent(layout, ends[0]) @ to_sx(rates[0]))
    bias -= ca.vertcat(*[to_sx(gradient[name]) for name in layout.fields])
    for name in layout.rotations:
        dofs = layout.dofs_of(name)
        bias[dofs] += ca.cross(to_sx(rates[0])[dofs], momentum[dofs])
    inputs = [rows, *[to_sx(v) for v in rates], *[to_sx(v) for v in named.values()], density.parameters]
    outputs = [ca.densify(turning), ca.densify(bias * to_sx(named["weight"]))]
    return ca.Function("rates", [ca.vertcat(*inputs)], outputs)


def _inputs(system: System, values: np.ndarray, velocity: np.ndarray, time: float) -> np.ndarray:
    """Columns of inputs of _rates, one for each node."""
    named, ones = system.named, np.ones(system.size)
    known = dict(zip(system.equations.uniforms, system.uniforms, strict=True))
    inverse = named.get("inverse", known.get("inverse", 1.0) * ones)
    here = named["here"]
    columns = [inverse, here, np.roll(here, -1), named["weight"], time * ones]
    constants = [named.get(name, known.get(name, 0.0) * ones) for name in system.equations.density.names]
    after, faster = (np.roll(array, -1, axis=0) for array in (values, velocity))
    return np.column_stack([values, after, velocity, faster, *columns, *constants]).T
