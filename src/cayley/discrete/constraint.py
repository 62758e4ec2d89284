"""Constraints g(q) = 0 at the strain points of elements."""

from collections.abc import Mapping
from typing import Any

import casadi as ca

from cayley.density import Density
from cayley.density.expression import Expression
from cayley.discrete.element import element_points
from cayley.discrete.layout import Layout
from cayley.discrete.polynomial import polynomial_points
from cayley.discrete.rules import Points


def element_constraints(
    density: Density, points: Points, layout: Layout, nodes: list[Expression], place: Mapping[str, Any]
) -> ca.SX:
    """The constraints g of an element at its strain points, a column (see element_points and polynomial_points)."""
    if len(nodes) > 2:
        found = polynomial_points(density, points, layout, nodes, place)
    else:
        found = element_points(density, points, layout, (nodes[0], nodes[1]), place)
    return ca.vertcat(*[density.constraint(point) for _, point in found])
