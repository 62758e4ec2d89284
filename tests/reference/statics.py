"""Statics and small vibrations of a discretized model, from the discrete equations of its rule."""

import functools
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.element import element_forces
from cayley.discrete.node import mass_matrix, node_load, node_point
from cayley.discrete.places import constants_at, placed
from cayley.discrete.polynomial import polynomial_forces
from cayley.lie import quaternion
from cayley.steppers.cells import in_space
from cayley.system.discretize import discretize


def forces_on_nodes(equations, nodes, length, within):
    """Forces of the strain on the nodes of one element, from what the steppers of the rule compile.

    `within` has symbols for the constants that differ within an element; implicit steppers do without.
    """
    density, rule, layout = equations.density, equations.rule, equations.layout
    if rule.implicit:
        return point_forces(equations, nodes, length)
    place = {"inverse": wrap(1.0 / length)} | {n: wrap(ca.SX(0)) for n in ("left", "right", "t")}
    place["at points"] = [constants_at(within, k) for k in range(len(rule.strain.at))]
    by_ends = element_forces if rule.degree == 1 else polynomial_forces
    return length * ca.vertcat(*[to_sx(f) for f in by_ends(density, rule.strain, layout, nodes, place)])


def point_forces(equations, nodes, length):
    """−Σ over Gauss points of weight × length × ∂W/∂(z, z′) contracted with φ, φ′ and the turning of the nodes."""
    program, layout, rule = equations.program("strain_point"), equations.layout, equations.rule
    rows, forces = ca.horzcat(*[to_sx(n) for n in nodes]), [ca.SX(0)] * len(nodes)
    known = ca.vertcat(*[s for s, *_ in program.lanes], program.uniforms[0])
    gradient = ca.vertcat(*[value for _, value in program.stores[1 : 1 + 2 * layout.rows]])
    values, slopes, weights = in_space(rule.strain)
    scale = 1.0 if rule.strain.between_ends else 1.0 / length
    for phi, slope, weight in zip(values, slopes, weights, strict=True):
        point = ca.vertcat(rows @ phi, rows @ slope * scale, 0, 1.0 / length, 0)
        g = ca.substitute(gradient, known, point)
        for i, node in enumerate(nodes):
            pulled = length * (phi[i] * g[: layout.rows] + slope[i] * scale * g[layout.rows :])
            forces[i] = forces[i] - weight * turned(layout, node).T @ pulled
    return ca.vertcat(*forces)


def turned(layout, node):
    """Derivative of a node's rows along its degrees of freedom, shape (rows, dofs)."""
    found = np.zeros((layout.rows, layout.dofs), dtype=object)
    for name in layout.fields:
        own = layout.representation.tangent(node[layout.rows_of(name)]) if name in layout.rotations else np.eye(3)
        found[layout.rows_of(name), layout.dofs_of(name)] = own
    return to_sx(wrap(found))


@functools.cache
def functions(of):
    """(rows of the nodes, length, constants) -> forces, stiffness of an element; (node, constants) -> load, mass."""
    equations, layout, density = of.equations, of.equations.layout, of.equations.density
    nodes = [symbols(f"n{i}_", layout.rows) for i in range(equations.rule.degree + 1)]
    length, rows = ca.SX.sym("length"), ca.vertcat(*[to_sx(n) for n in nodes])
    within = {name: ca.SX.sym(name) for name in placed(equations.varying)}
    forces = forces_on_nodes(equations, nodes, length, within)
    stiffness = -ca.jacobian(forces, rows) @ ca.diagcat(*[turned(layout, n) for n in nodes])
    inputs = [ca.vertcat(rows, length, density.parameters, *within.values())]
    element = ca.Function("element", inputs, [ca.densify(forces), ca.densify(stiffness)])
    place = {n: wrap(ca.SX(0)) for n in ("here", "t")}
    load = to_sx(node_load(density, layout, nodes[0], place))
    mass = mass_matrix(density, layout, node_point(layout, nodes[0], density.lagrangian.interval, place))
    return element, ca.Function("node", [to_sx(nodes[0]), density.parameters], [ca.densify(load), ca.densify(mass)])


@dataclass(frozen=True)
class Derived:
    """Equations, equal where they were derived from the same text."""

    signature: str
    equations: Any = field(compare=False)


class Discrete:
    """A model discretized by a rule: forces, stiffness and masses at given values of its nodes."""

    def __init__(self, model, rule):
        """Find the elements and the free unknowns."""
        self.system = discretize(model, rule)
        equations, self.layout = self.system.equations, self.system.layout
        self.element, self.node = functions(Derived(equations.signature, equations))
        known = dict(zip(equations.density.names, equations.density.values, strict=True)) | dict(self.system.named)
        names = (*equations.density.names, *placed(equations.varying))
        self.constants = np.array([np.broadcast_to(known[name], self.system.size) for name in names]).T
        self.parameters = self.constants[:, : len(equations.density.names)]
        first = np.arange(0, self.system.size - 1, rule.degree)
        self.nodes = first[:, None] + np.arange(rule.degree + 1)
        self.lengths = np.add.reduceat(self.system.named["length"][:-1], first)
        self.free = np.flatnonzero(self.system.free.reshape(-1))

    def strained(self, values):
        """Forces of the strain (all unknowns) and stiffness (free ones)."""
        d, count = self.layout.dofs, len(self.lengths)
        constants = self.constants[self.nodes[:, 0]]
        columns = np.hstack([values[self.nodes].reshape(count, -1), self.lengths[:, None], constants]).T
        f, k = (np.asarray(m) for m in self.element(columns))
        where = (self.nodes[:, :, None] * d + np.arange(d)).reshape(count, -1)
        forces = np.bincount(where.T.reshape(-1), f.reshape(-1), self.system.size * d)
        blocks = k.reshape(len(f), count, -1).transpose(1, 0, 2)
        i, j = np.broadcast_to(where[:, :, None], blocks.shape), np.broadcast_to(where[:, None, :], blocks.shape)
        stiffness = coo_array((blocks.reshape(-1), (i.reshape(-1), j.reshape(-1)))).tocsc()
        return forces, stiffness[self.free][:, self.free]

    def node_terms(self):
        """Dead loads of the nodes (all unknowns) and lumped masses (free ones, the diagonal)."""
        weight, size = self.system.named["weight"][:, None], self.system.size
        load, mass = (np.asarray(m) for m in self.node(self.system.reference.T, self.parameters.T))
        masses = np.diagonal(mass.reshape(self.layout.dofs, size, -1), axis1=0, axis2=2)
        return (weight * load.T).reshape(-1), (weight * masses).reshape(-1)[self.free]

    def moved(self, values, step):
        """Values after an increment of the free unknowns, p Cay(½ η) of rotations."""
        full = np.zeros(self.system.size * self.layout.dofs)
        full[self.free] = step
        step, after = full.reshape(self.system.size, -1), values.copy()
        x, p = self.layout.rows_of("x"), self.layout.rows_of("p")
        after[:, x] += step[:, self.layout.dofs_of("x")]
        turn = np.insert(0.5 * step[:, self.layout.dofs_of("p")], 0, 1.0, axis=1)
        turn /= np.linalg.norm(turn, axis=1, keepdims=True)
        after[:, p] = quaternion.multiply(values[:, p], turn)
        return after

    def settled(self, start=None, shares=(1.0,), more=0.0):
        """Values of all nodes in equilibrium with the dead loads and more, put on in shares, by Newton's method."""
        values, load = self.system.reference if start is None else start, self.node_terms()[0] + more
        for share in shares:
            size, corrections = np.inf, 0
            while size > (1e-10 if share == shares[-1] else 0.05):
                forces, stiffness = self.strained(values)
                step = spsolve(stiffness, (forces + share * load)[self.free])
                size, corrections = np.abs(step).max(), corrections + 1
                values = self.moved(values, step * min(1.0, 0.5 / size))
                assert corrections < 40, f"no equilibrium under {share} of the load: the last correction is {size:.1e}"
        return values
