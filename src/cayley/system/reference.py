"""The strain of a configuration as a rule measures it, to be taken for the strain without stress."""

import casadi as ca
import numpy as np

from cayley.density import library, trace
from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.element import element_points
from cayley.discrete.embedded import embedded_point
from cayley.discrete.layout import Layout
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import Rule, lagrange, lobatto

ROUND_OFF = 16.0 * float(np.finfo(np.float64).eps)
"""Strains below this, times the largest curvature where they are curvatures, are taken for zero; so are differences."""


def reference_strain(rule: Rule, position: np.ndarray, rotation: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """ε = (Λᵀx′ − e₃, Ω) at the strain points of every element, with the difference quotients of the rule.

    Args:
        rule: the rule.
        position: of the nodes [m], shape (elements × degree + 1, 3).
        rotation: unit quaternions, neighbors in one hemisphere, shape (elements × degree + 1, 4).
        lengths: unstressed lengths of the elements [m], shape (elements,).

    Returns: shape (elements, strain points, 6); what is zero or equal but for round-off is so exactly.
    """
    density = trace(library.rod, {"mass": 1.0, "inertia": np.eye(3), "stiffness": np.eye(6), "gravity": np.zeros(3)})
    layout = Layout(density.lagrangian.fields, REPRESENTATIONS["quaternion"])
    values = np.empty((len(position), layout.rows))
    values[:, layout.rows_of("x")], values[:, layout.rows_of("p")] = position, rotation
    a, b, inverse = symbols("a", layout.rows), symbols("b", layout.rows), ca.SX.sym("inverse")
    if rule.strain.between_ends or rule.degree == 1:
        place = {"inverse": wrap(inverse), "t": 0.0, "left": 0.0, "right": 0.0}
        points = [point for _, point in element_points(density, rule.strain, layout, (a, b), place)]
        pairs = np.concatenate([values[:-1], values[1:]], axis=1)[:, None]
    else:
        points = [embedded_point(layout, a, b, "s")]
        pairs = _at_gauss_points(rule, values, lengths)
    strains = [
        ca.vertcat(to_sx(q["frame of p"]).T @ to_sx(q["x_s"]) - ca.DM([0, 0, 1]), to_sx(q["p_s"])) for q in points
    ]
    function = ca.Function("strain", [ca.vertcat(to_sx(a), to_sx(b), inverse)], [ca.densify(ca.horzcat(*strains))])
    elements, given, width = pairs.shape
    scales = np.broadcast_to(1.0 / lengths[:, None, None], (elements, given, 1))
    inputs = np.concatenate([pairs, scales], axis=2).reshape(-1, width + 1)
    columns = np.asarray(function(inputs.T)).T.reshape(elements, -1, 6)
    return _rounded(columns)


def _at_gauss_points(rule: Rule, values: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Values z and slopes z′ at the Gauss points of every element, shape (elements, points, 2 rows)."""
    degree = rule.degree
    basis, slopes = lagrange(lobatto(degree), rule.strain.at)
    nodes = values[degree * np.arange(len(lengths))[:, None] + np.arange(degree + 1)]
    z = np.einsum("ga,ear->egr", basis, nodes)
    return np.concatenate([z, np.einsum("ga,ear->egr", slopes, nodes) / lengths[:, None, None]], axis=2)


def _rounded(strain: np.ndarray) -> np.ndarray:
    """The same strains, those that are zero, or in all elements equal, but for round-off exactly so."""
    scale = np.ones(6)
    scale[3:] = np.abs(strain[..., 3:]).max()
    found = np.where(np.abs(strain) <= ROUND_OFF * scale, 0.0, strain)
    alike = np.ptp(found, axis=0) <= ROUND_OFF * scale
    return np.where(alike, found[:1], found)
