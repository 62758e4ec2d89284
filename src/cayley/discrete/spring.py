"""Springs and dampers between two nodes, or a node and the ground: the programs of their energy and their forces.

linear:      e = ‖P_B − P_A‖ − ℓ₀
rotational:  e = 2 arctan(u₃/u₀) − θ₀, the twist of u about e3
bushing:     e = (Δ, log u)

with the points P, the relative place Δ and rotation u of discrete.joint. The energy is ½ e·K e, the dissipative force
−C ė, of virtual work −(C ė)·δe.
"""

import casadi as ca
import numpy as np

from cayley.density.expression import Expression, dot, symbols, to_sx, where, wrap
from cayley.discrete.joint import Parts, joint_sides, once, plain_program
from cayley.discrete.layout import Layout
from cayley.discrete.program import Program
from cayley.lie import exponential, quaternion

SPRINGS = {"linear": 1, "rotational": 1, "bushing": 6}
"""Components of the strain e of each kind."""
_TINY = 1e-300
"""Added to a squared length so that its root has derivatives at zero, too; it changes no other length."""


def spring_parameter_count(kind: str) -> int:
    """Number of parameters: offset and frame in a and in b, K, C, and ℓ₀ or θ₀ unless it is a bushing."""
    size = SPRINGS[kind]
    return 14 + 2 * size * size + (kind != "bushing")


@once
def spring_program(kind: str, layout: Layout, *, grounded: bool) -> Program:
    """The energy of a spring and its derivatives with respect to the values of its nodes.

    Args:
        kind: a word of SPRINGS.
        layout: rows of a node with the fields p and x, rotations as quaternions.
        grounded: whether side b is the ground, in place of which its pose (p = 1, x = 0) is read.

    Returns: a program on rows (values of a, of b, parameters) -> (V, ∂V, upper triangle of ∂²V), as the point programs
    of discrete.embedded, named spring_KIND or spring_KIND_ground; without uniforms.
    """
    a, b, given = symbols("a", layout.rows), symbols("b", layout.rows), symbols("c", spring_parameter_count(kind))
    unknown = ca.vertcat(to_sx(a), to_sx(b))
    strain, stiffness, _ = _strain(kind, layout, (a, b), given, grounded=grounded)
    energy = 0.5 * ca.dot(strain, stiffness @ strain)
    gradient = ca.gradient(energy, unknown)
    hessian = ca.densify(ca.jacobian(gradient, unknown))
    size = 2 * layout.rows
    upper = [hessian[i, k] for i in range(size) for k in range(i, size)]
    inputs = [*ca.vertsplit(unknown), *ca.vertsplit(to_sx(given))]
    outputs = [energy, *ca.vertsplit(ca.densify(gradient)), *upper]
    return plain_program(_name("spring", kind, grounded), inputs, outputs)


@once
def damper_program(kind: str, layout: Layout, *, grounded: bool) -> Program:
    """The dissipative force of a spring, conjugate to the values of its nodes.

    f = −Gᵀ C G ż,   G = ∂e/∂z

    Args:
        kind: a word of SPRINGS.
        layout: rows of a node with the fields p and x, rotations as quaternions.
        grounded: whether side b is the ground.

    Returns: a program on rows (values of a, of b, their rates ż of a, of b, parameters) -> (f, its Jacobian by rows
    over values and rates, 2R × 4R), as force programs of a density, named damper_KIND or damper_KIND_ground.
    """
    a, b, given = symbols("a", layout.rows), symbols("b", layout.rows), symbols("c", spring_parameter_count(kind))
    unknown, rates = ca.vertcat(to_sx(a), to_sx(b)), to_sx(symbols("v", 2 * layout.rows))
    strain, _, damping = _strain(kind, layout, (a, b), given, grounded=grounded)
    slope = ca.jacobian(strain, unknown)
    force = -(slope.T @ (damping @ (slope @ rates)))
    jacobian = ca.densify(ca.jacobian(force, ca.vertcat(unknown, rates)))
    inputs = [*ca.vertsplit(unknown), *ca.vertsplit(rates), *ca.vertsplit(to_sx(given))]
    outputs = [*ca.vertsplit(ca.densify(force)), *ca.vertsplit(ca.vec(jacobian.T))]
    return plain_program(_name("damper", kind, grounded), inputs, outputs)


def _name(what: str, kind: str, grounded: bool) -> str:
    return "_".join([what, kind, *(["ground"] if grounded else [])])


def _strain(
    kind: str, layout: Layout, nodes: Parts, given: Expression, *, grounded: bool
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """e, K and C."""
    if layout.representation.name != "quaternion":
        raise ValueError(f"springs want rotation='quaternion', not {layout.representation.name!r}")
    sides = joint_sides(layout, nodes, given)
    (origin, frame), (point, other) = reversed(sides) if grounded else sides
    size = SPRINGS[kind]
    stiffness, damping = (
        ca.reshape(to_sx(given[start : start + size * size]), size, size) for start in (14, 14 + size * size)
    )
    apart = wrap(point - origin)
    turn = wrap(np.asarray(quaternion.relative(frame, other)))
    if kind == "linear":
        strain = to_sx(np.sqrt(dot(apart, apart) + _TINY) - given[16])
    elif kind == "rotational":
        sign = where(turn[0] < 0.0, -1.0, 1.0)
        strain = to_sx(2.0 * np.arctan2(sign * turn[3], sign * turn[0]) - given[16])
    else:
        moved = quaternion.inverse_rotate(frame, apart)
        strain = ca.vertcat(to_sx(wrap(moved)), to_sx(wrap(np.asarray(exponential.log(turn)))))
    return strain, stiffness, damping


__all__ = ["SPRINGS", "damper_program", "spring_parameter_count", "spring_program"]
