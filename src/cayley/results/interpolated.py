"""Strain energy and stress resultants of elements of higher degree: at their Gauss points, then at the nodes."""

from collections.abc import Callable

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx
from cayley.discrete.embedded import embedded_point
from cayley.discrete.layout import Layout
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import lagrange, lobatto
from cayley.results.frames import Frames
from cayley.system.system import System


def interpolated(system: System, frames: Frames) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Evaluate the strain terms on the polynomials of every element.

    W and ∂W/∂(x′, Ω) are taken at the Gauss points, where they are most accurate; the polynomial through these gives
    their values at the nodes, the mean of both sides where elements meet.

    Args:
        system: a system whose rule has a degree above 1 along the interval.
        frames: its saved states.

    Returns: strain energy (m,) [J]; resultants in the paper's sign (m, nodes, dofs), as of results.resultants;
    derivatives x′ and Ω between nodes, each at the left one of two (m, nodes, dofs).
    """
    rule = system.equations.rule
    strain, degree = rule.strain, rule.degree
    nodes = lobatto(degree)
    at_gauss, slope_at_gauss = lagrange(nodes, strain.at)
    to_nodes, _ = lagrange(np.array(strain.at), nodes)
    middles = 0.5 * (nodes[1:] + nodes[:-1])
    at_middle, slope_at_middle = lagrange(nodes, middles)
    energy = np.zeros(len(frames.times))
    found = np.zeros((len(frames.times), system.size, system.layout.dofs))
    slopes, shares = np.zeros_like(found), np.zeros(system.size)
    evaluate = _term(system)
    start = 0
    for count in system.chains:
        for first in range(start, start + count - 1, degree):
            own = slice(first, first + degree + 1)
            length = float(system.named["length"][first : first + degree].sum())
            values = _as_quaternions(system.layout, frames.values[:, own])
            inputs = (
                np.einsum("ga,tar->tgr", at_gauss, values),
                np.einsum("ga,tar->tgr", slope_at_gauss, values) / length,
            )
            density, stress, _ = evaluate(*inputs, first, length * np.array(strain.at), frames.times)
            energy += length * density @ np.array(strain.weights)
            found[:, own] -= np.einsum("ng,tgd->tnd", to_nodes, stress)
            shares[own] += 1.0
            inputs = (
                np.einsum("ga,tar->tgr", at_middle, values),
                np.einsum("ga,tar->tgr", slope_at_middle, values) / length,
            )
            slopes[:, first : first + degree] = evaluate(*inputs, first, length * middles, frames.times)[2]
        start += count
    return energy, found / np.maximum(shares, 1.0)[None, :, None], slopes  # nodes without an element have no share


def _as_quaternions(layout: Layout, values: np.ndarray) -> np.ndarray:
    """Values of the nodes of an element with rotations as quaternions, neighbors in one hemisphere."""
    if layout.representation.rows == 4:
        return values
    parts = []
    for name in layout.fields:
        own = values[..., layout.rows_of(name)]
        parts.append(layout.representation.to_quaternion(own) if name in layout.rotations else own)
    return np.concatenate(parts, axis=-1)


def _term(system: System) -> Callable[..., list[np.ndarray]]:
    """W, its derivatives with respect to x′ and Ω, and these themselves, at points (m, g, rows) behind a node."""
    density = system.equations.density
    layout = Layout(system.layout.fields, REPRESENTATIONS["quaternion"])
    along = str(density.lagrangian.interval)
    z, slope, here, t = symbols("z", layout.rows), symbols("dz", layout.rows), symbols("here"), symbols("t")
    point = embedded_point(layout, z, slope, along) | {along: here, "t": t}
    gradient = density.gradient("strain", point)
    stress = ca.vertcat(*[to_sx(gradient[f"{name}_{along}"]) for name in layout.fields])
    slopes = ca.vertcat(*[to_sx(point[f"{name}_{along}"]) for name in layout.fields])
    inputs = ca.vertcat(*[to_sx(e) for e in (z, slope, here, t)], density.parameters)
    outputs = [density.value("strain", point), ca.densify(stress), ca.densify(slopes)]
    function = ca.Function("strain", [inputs], outputs)
    places = range(len(system.equations.rule.strain.at))
    constants = np.array([[system.values_of(name, g) for name in density.names] for g in places])

    def evaluate(
        values: np.ndarray, slopes: np.ndarray, node: int, at: np.ndarray, times: np.ndarray
    ) -> list[np.ndarray]:
        frames, points, _ = values.shape
        rest = np.zeros((frames, points, 2 + len(density.names)))
        rest[:, :, 0] = system.named["here"][node]
        rest[:, :, 2:] = constants[:, :, node]
        rest[:, :, 0] += at
        rest[:, :, 1] = times[:, None]
        columns = np.concatenate([values, slopes, rest], axis=2).reshape(frames * points, -1)
        one, stress, slope = (np.asarray(m).T.reshape(frames, points, -1) for m in function(columns.T))
        return [one[:, :, 0], stress, slope]

    return evaluate
