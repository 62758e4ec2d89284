"""Strain energy and stress resultants of elements of higher degree: at their Gauss points, then at the nodes."""

from collections.abc import Callable

import casadi as ca
import numpy as np

from cayley.density.expression import from_sx, symbols, to_sx, zeros
from cayley.density.force import KINDS, STRAIN
from cayley.discrete.embedded import embedded_point
from cayley.discrete.forcing import motion_of
from cayley.discrete.layout import Layout
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import lagrange, lobatto
from cayley.lie import quaternion
from cayley.results.frames import Frames
from cayley.system.system import System


def interpolated(
    system: System, frames: Frames, velocity: np.ndarray, multipliers: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Evaluate the strain terms on the polynomials of every element.

    W and ∂(W − λ·g)/∂(x′, Ω), less the stresses of forces beside the Lagrangian, are taken at the Gauss points, where
    they are most accurate; the polynomial through these gives their values at the nodes, the mean of both sides where
    elements meet.

    Args:
        system: a system whose rule has a degree above 1 along the interval.
        frames: its saved states.
        velocity: of the nodes, shape (m, nodes, dofs).
        multipliers: λ of constraints at the Gauss points of every element, shape (m, elements, g, constraints).

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
    count = system.equations.density.constraints.numel()
    nothing = np.zeros((len(frames.times), degree, count))
    start, element = 0, 0
    for count in system.chains:
        for first in range(start, start + count - 1, degree):
            own = slice(first, first + degree + 1)
            length = float(system.named["length"][first : first + degree].sum())
            values = _as_quaternions(system.layout, frames.values[:, own])
            both = np.concatenate([values, _rates(system.layout, values, velocity[:, own])], axis=-1)
            inputs = (
                np.einsum("ga,tar->tgr", at_gauss, both),
                np.einsum("ga,tar->tgr", slope_at_gauss, both) / length,
            )
            own_multipliers = nothing if multipliers is None else multipliers[:, element]
            density, stress, _ = evaluate(*inputs, first, length * np.array(strain.at), frames.times, own_multipliers)
            element += 1
            energy += length * density @ np.array(strain.weights)
            found[:, own] -= np.einsum("ng,tgd->tnd", to_nodes, stress)
            shares[own] += 1.0
            inputs = (
                np.einsum("ga,tar->tgr", at_middle, both),
                np.einsum("ga,tar->tgr", slope_at_middle, both) / length,
            )
            slopes[:, first : first + degree] = evaluate(*inputs, first, length * middles, frames.times, nothing)[2]
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


def _rates(layout: Layout, values: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Rates of values with rotations as quaternions, ẋ and ½ p ω."""
    form = Layout(layout.fields, REPRESENTATIONS["quaternion"])
    rates = np.zeros_like(values)
    for name in layout.fields:
        rows, own = form.rows_of(name), velocity[..., layout.dofs_of(name)]
        if name in layout.rotations:
            turning = np.concatenate([np.zeros((*own.shape[:-1], 1)), own], axis=-1)
            own = 0.5 * np.asarray(quaternion.multiply(values[..., rows], turning), dtype=float)
        rates[..., rows] = own
    return rates


def _term(system: System) -> Callable[..., list[np.ndarray]]:
    """W, the stresses of x′ and Ω, and these themselves, at points of values and rates (m, g, 2 rows) behind a node.

    The last argument are the multipliers at the points, shape (m, g, constraints).
    """
    density = system.equations.density
    layout = Layout(system.layout.fields, REPRESENTATIONS["quaternion"])
    along = str(density.lagrangian.interval)
    z, slope, here, t = symbols("z", layout.rows), symbols("dz", layout.rows), symbols("here"), symbols("t")
    z_t, slope_t = symbols("z_t", layout.rows), symbols("dz_t", layout.rows)
    point = embedded_point(layout, z, slope, along) | {along: here, "t": t}
    gradient = density.gradient("strain", point)
    stress = ca.vertcat(*[to_sx(gradient[f"{name}_{along}"]) for name in layout.fields])
    unknown, moving = (ca.vertcat(*[to_sx(e) for e in pair]) for pair in ((z, slope), (z_t, slope_t)))
    for kind in KINDS if density.force is not None else ():
        found = density.forces(STRAIN, kind, point | motion_of(density, point, unknown, moving))
        sizes = {name: field.size for name, field in layout.fields.items()}
        stress -= ca.vertcat(*[to_sx(found.get(f"{n}_{along}", zeros(size))) for n, size in sizes.items()])
    slopes = ca.vertcat(*[to_sx(point[f"{name}_{along}"]) for name in layout.fields])
    multiplier, free = ca.SX.sym("lambda", density.constraints.numel()), ca.SX.sym("slopes", slopes.numel())
    at = {f"{name}_{along}": np.atleast_1d(from_sx(free[layout.dofs_of(name)])) for name in layout.fields}
    pull = ca.gradient(ca.dot(multiplier, density.constraint(point | at)), free)
    stress -= ca.substitute(pull, free, slopes)
    inputs = ca.vertcat(*[to_sx(e) for e in (z, z_t, slope, slope_t, here, t)], density.parameters, multiplier)
    outputs = [density.value("strain", point), ca.densify(stress), ca.densify(slopes)]
    function = ca.Function("strain", [inputs], outputs)
    places = range(len(system.equations.rule.strain.at))
    constants = np.array([[system.values_of(name, g) for name in density.names] for g in places])
    constants = constants.reshape(len(places), len(density.names), system.size)  # of a density without any, too

    def evaluate(
        values: np.ndarray, slopes: np.ndarray, node: int, at: np.ndarray, times: np.ndarray, multipliers: np.ndarray
    ) -> list[np.ndarray]:
        frames, points, _ = values.shape
        rest = np.zeros((frames, points, 2 + len(density.names)))
        rest[:, :, 0] = system.named["here"][node]
        rest[:, :, 2:] = constants[:, :, node]
        rest[:, :, 0] += at
        rest[:, :, 1] = times[:, None]
        columns = np.concatenate([values, slopes, rest, multipliers], axis=2).reshape(frames * points, -1)
        one, stress, slope = (np.asarray(m).T.reshape(frames, points, -1) for m in function(columns.T))
        return [one[:, :, 0], stress, slope]

    return evaluate
