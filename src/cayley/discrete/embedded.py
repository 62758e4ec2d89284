"""Terms of a density as functions of two points of the embedding space: what polynomial interpolation needs.

A polynomial of unit quaternions, normalized where it is used, is linear in its control nodes before the normalization.
So a term is written once as a function of the unnormalized value z and its derivative z′ (or of two end values) and
its gradient and Hessian are contracted with the interpolation: the size of the code does not depend on the degree.
"""

from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, dot, symbols, to_sx, wrap
from cayley.discrete.constraint import element_constraints
from cayley.discrete.element import element_energy
from cayley.discrete.layout import Layout
from cayley.discrete.program import Program
from cayley.discrete.representation import homogeneous
from cayley.discrete.rules import Points
from cayley.lie import quaternion


def point_program(
    density: Density, layout: Layout, name: str, points: Points | None, varying: tuple[str, ...]
) -> Program:
    """Value, gradient and Hessian of one term at one quadrature point.

    name "inertia_point": T − U at (z, ż).  name "strain_point": W at (z, z′), or of two end nodes where the rule takes
    corners. With p = z/‖z‖: ω = 2 Im(z̄ ż)/‖z‖², and Ω alike.

    Args:
        density: the density.
        layout: rows of a node, rotations as quaternions.
        name: which term.
        points: where the strain terms stand.
        varying: names of constants that differ from point to point.

    Returns: a program on rows (z, z′, here, inverse, varying ...) -> (value, gradient, upper triangle of the Hessian).
    """
    z, slope = symbols("z", layout.rows), symbols("dz", layout.rows)
    along = density.lagrangian.interval
    here, inverse, t = (ca.SX.sym(n) for n in ("here", "inverse", "t"))
    place = {"t": wrap(t), str(along): wrap(here)}
    if name == "inertia_point":
        point = embedded_point(layout, z, slope, "t") | place
        value = density.value("inertia", point) - density.value("load", point)
    elif points is not None and points.between_ends:
        ends = {"inverse": wrap(inverse), "t": wrap(t), "left": wrap(here), "right": wrap(here + 1.0 / inverse)}
        value = element_energy(density, points, layout, (normalized(layout, z), normalized(layout, slope)), ends)
    else:
        value = density.value("strain", embedded_point(layout, z, slope, str(along)) | place)
    unknown = ca.vertcat(to_sx(z), to_sx(slope))
    gradient = ca.gradient(value, unknown)
    hessian = ca.densify(ca.jacobian(gradient, unknown))
    size = 2 * layout.rows
    upper = [hessian[i, k] for i in range(size) for k in range(i, size)]
    constants = dict(zip(density.names, ca.vertsplit(density.parameters), strict=True))
    inputs = [*ca.vertsplit(unknown), here, inverse, *(constants[n] for n in varying)]
    outputs = [value, *ca.vertsplit(ca.densify(gradient)), *upper]
    return Program(
        name=name,
        uniforms=(t, *(s for n, s in constants.items() if n not in varying)),
        lanes=tuple((s, i, 0) for i, s in enumerate(inputs)),
        steps=(),
        stores=tuple((len(inputs) + i, v) for i, v in enumerate(outputs)),
        rows=len(inputs) + len(outputs),
    )


def constraint_program(density: Density, layout: Layout, points: Points, varying: tuple[str, ...]) -> Program:
    """The constraints g at one strain point, their derivatives, and the Hessian of λ·g.

    Args:
        density: the density.
        layout: rows of a node, rotations as quaternions.
        points: where the constraints stand.
        varying: names of constants that differ from point to point.

    Returns: a program on rows (z, z′, here, inverse, varying ..., λ) -> (g, ∂g by rows, upper triangle of λ·∂²g).
    """
    z, slope = symbols("z", layout.rows), symbols("dz", layout.rows)
    along = density.lagrangian.interval
    here, inverse, t = (ca.SX.sym(n) for n in ("here", "inverse", "t"))
    if points.between_ends:
        ends = {"inverse": wrap(inverse), "t": wrap(t), "left": wrap(here), "right": wrap(here)}
        g = element_constraints(density, points, layout, (normalized(layout, z), normalized(layout, slope)), ends)
    else:
        g = density.constraint(embedded_point(layout, z, slope, str(along)) | {"t": wrap(t), str(along): wrap(here)})
    multiplier = ca.SX.sym("lambda", g.numel())
    unknown = ca.vertcat(to_sx(z), to_sx(slope))
    hessian = ca.densify(ca.jacobian(ca.gradient(ca.dot(multiplier, g), unknown), unknown))
    size = 2 * layout.rows
    upper = [hessian[i, k] for i in range(size) for k in range(i, size)]
    constants = dict(zip(density.names, ca.vertsplit(density.parameters), strict=True))
    inputs = [*ca.vertsplit(unknown), here, inverse, *(constants[n] for n in varying), *ca.vertsplit(multiplier)]
    derivative = ca.vertsplit(ca.vec(ca.densify(ca.jacobian(g, unknown)).T))
    outputs = [*ca.vertsplit(ca.densify(g)), *derivative, *upper]
    return Program(
        name="constraint_point",
        uniforms=(t, *(s for n, s in constants.items() if n not in varying)),
        lanes=tuple((s, i, 0) for i, s in enumerate(inputs)),
        steps=(),
        stores=tuple((len(inputs) + i, v) for i, v in enumerate(outputs)),
        rows=len(inputs) + len(outputs),
    )


def embedded_point(layout: Layout, z: Expression, slope: Expression, suffix: str) -> dict[str, Any]:
    """Values of the slots from an unnormalized value and its derivative."""
    point: dict[str, Any] = {}
    for name in layout.fields:
        rows = layout.rows_of(name)
        if name not in layout.rotations:
            point[name], point[f"{name}_{suffix}"] = z[rows], slope[rows]
            continue
        size = dot(z[rows], z[rows])
        point[f"frame of {name}"] = homogeneous(z[rows], 2.0 / size)
        turned = quaternion.multiply(quaternion.conjugate(z[rows]), slope[rows])
        point[f"{name}_{suffix}"] = wrap(np.asarray(turned))[1:] * (2.0 / size)
    return point


def normalized(layout: Layout, z: Expression) -> Expression:
    """Rows of a node with its rotations brought to length one."""
    made = z.copy()
    for name in layout.rotations:
        rows = layout.rows_of(name)
        made[rows] = z[rows] / np.sqrt(dot(z[rows], z[rows]))
    return made
