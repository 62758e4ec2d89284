"""Terms of a density as functions of two points of the embedding space: what polynomial interpolation needs.

A polynomial of unit quaternions, normalized where it is used, is linear in its control nodes before the normalization.
So a term is written once as a function of the unnormalized value z and its derivative z′ (or of two end values) and
its gradient and Hessian are contracted with the interpolation: the size of the code does not depend on the degree.
"""

from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, dot, symbols, to_sx, wrap
from cayley.discrete.element import element_points
from cayley.discrete.jet import Jet, jet
from cayley.discrete.layout import Layout
from cayley.discrete.places import constants_at, placed
from cayley.discrete.pose import screw_jet, strain_jet, strains_only
from cayley.discrete.program import Program
from cayley.discrete.representation import homogeneous
from cayley.discrete.rules import Points
from cayley.lie import quaternion

POINT_PROGRAMS = (
    *("inertia_point", "strain_point", "constraint_point"),
    *("inertia_point_force", "strain_point_force", "constraint_point_slope"),
)
"""Names of the programs here."""


def point_program(
    density: Density, layout: Layout, name: str, points: Points | None, varying: tuple[str, ...]
) -> Program:
    """Value, derivative and Hessian of one term at one quadrature point, or without the Hessian.

    name "inertia_point": T − U at (z, ż).  name "strain_point": W at (z, z′), or of two end nodes where the rule takes
    corners.  name "constraint_point": the constraints g there, and the Hessian of λ·g. With p = z/‖z‖:
    ω = 2 Im(z̄ ż)/‖z‖², and Ω alike. The names "inertia_point_force", "strain_point_force" and
    "constraint_point_slope" are those without the Hessian, on the same inputs.

    Args:
        density: the density.
        layout: rows of a node, rotations as quaternions.
        name: which term.
        points: where the strain terms and the constraints stand.
        varying: names of constants that differ from point to point, and behind them NAME@1 of what differs between the
            two corners (see places).

    Returns: a program on rows (z, z′, here, inverse, varying ..., λ of constraints) -> (value, derivative by rows,
        upper triangle of the Hessian).
    """
    term, second = name.removesuffix("_force").removesuffix("_slope"), name.endswith("_point")
    count = density.constraints.numel()
    multiplier = ca.SX.sym("lambda", count) if term == "constraint_point" else ca.SX(1.0)
    z, slope = symbols("z", layout.rows), symbols("dz", layout.rows)
    here, inverse, t = (ca.SX.sym(n) for n in ("here", "inverse", "t"))
    constants = inputs_by_name(density, varying)
    place: dict[str, Any] = {"here": wrap(here), "inverse": wrap(inverse), "t": wrap(t)}
    place["at points"] = [constants_at(constants, k) for k in range(len(points.at))] if points is not None else []
    found = _term(density, layout, term, points, (z, slope), place, multiplier, second=second)
    outputs = [*_entries(found.values), *_entries(found.slope)]
    if found.curvature is not None:
        hessian = ca.densify(found.curvature)
        outputs += [hessian[i, k] for i in range(hessian.size1()) for k in range(i, hessian.size1())]
    inputs = [*_list(z), *_list(slope), here, inverse, *(constants[n] for n in varying), *ca.symvar(multiplier)]
    return Program(
        name=name,
        uniforms=(t, *(constants[n] for n in density.names if n not in varying)),
        lanes=tuple((s, i, 0) for i, s in enumerate(inputs)),
        steps=(),
        stores=tuple((len(inputs) + i, v) for i, v in enumerate(outputs)),
        rows=len(inputs) + len(outputs),
    )


def _term(
    density: Density,
    layout: Layout,
    name: str,
    points: Points | None,
    at: tuple[Expression, Expression],
    place: Mapping[str, Any],
    multiplier: ca.SX,
    *,
    second: bool,
) -> Jet:
    """A term at (z, its derivative), or at two ends, with its derivatives."""
    along, here, inverse, t = str(density.lagrangian.interval), place["here"], place["inverse"], place["t"]
    unknown = ca.vertcat(to_sx(at[0]), to_sx(at[1]))

    def of_point(point: Mapping[str, Any]) -> ca.SX:
        if name == "inertia_point":
            return density.value("inertia", point) - density.value("load", point)
        return density.constraint(point) if name == "constraint_point" else density.value("strain", point)

    strained = name != "inertia_point" and strains_only(density, name.removesuffix("_point"))
    if strained and points is not None and points.screw:
        middle = {"inverse": inverse, "t": t, along: here + 0.5 / inverse}
        return screw_jet(density, layout, of_point, at, middle, weights=multiplier, second=second)
    if name != "inertia_point" and points is not None and points.between_ends:
        ends = normalized(layout, at[0]), normalized(layout, at[1])
        where = {"inverse": inverse, "t": t, "left": here, "right": here + 1.0 / inverse}
        where["at points"] = place["at points"]
        found = element_points(density, points, layout, ends, where)
    else:
        suffix = "t" if name == "inertia_point" else along
        found = [(1.0, embedded_point(layout, *at, suffix) | {"t": t, along: here})]
    if strained:
        return strain_jet(density, of_point, found, unknown, weights=multiplier, second=second)
    terms = [weight * of_point(point) for weight, point in found]
    return jet(sum(terms[1:], start=terms[0]), unknown, unknown, weights=multiplier, second=second)


def inputs_by_name(density: Density, varying: tuple[str, ...]) -> dict[str, ca.SX]:
    """Symbols of all constants of a density, and of those at places of an element among ``varying``."""
    known = dict(zip(density.names, ca.vertsplit(density.parameters), strict=True))
    return known | {name: ca.SX.sym(name) for name in placed(varying)}


def _list(value: Expression) -> list[ca.SX]:
    return ca.vertsplit(to_sx(value))


def _entries(matrix: ca.SX) -> list[ca.SX]:
    """Entries of a matrix, row by row."""
    return ca.vertsplit(ca.vec(ca.densify(matrix).T))


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
