"""Write the programs of explicit rules: one step of all nodes, half a kick, and what results are made of."""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from cayley.density.expression import Expression, from_sx, symbols, to_sx, wrap
from cayley.discrete.element import element_energy, element_forces, element_points
from cayley.discrete.node import Inertia, corner_inertia, node_load, node_point
from cayley.discrete.places import constants_at
from cayley.discrete.polynomial import polynomial_forces
from cayley.discrete.program import Assign, Carry, Program, Step
from cayley.discrete.rules import MIDDLE, lobatto, lobatto_weights
from cayley.discrete.solve import Block, find_structure, side_by_side, solve_steps

if TYPE_CHECKING:
    from cayley.discrete.equations import DiscreteEquations

UNIFORMS = ("h", "t", "t_next")


class Writer:
    """Writes programs: the symbols of the equations and where their values stand.

    A lane is a cell: an element without its right end, of one node for degree 1. That end is the first node of the
    next lane; the last node of a chain is in a cell of length 0, whose other nodes weigh nothing and stay at rest.
    """

    _reads: list[tuple[ca.SX, int, int]]  # what the program written reads besides what all do

    def __init__(self, equations: "DiscreteEquations") -> None:
        """Make the symbols."""
        self._reads = []
        self.density, self.rule, self.layout = equations.density, equations.rule, equations.layout
        self.rows, self.uniforms = equations.rows, equations.uniforms
        self.interval = self.density.lagrangian.interval is not None
        self.symbol = dict(zip(self.density.names, ca.vertsplit(self.density.parameters), strict=True))
        self.symbol |= {name: ca.SX.sym(name) for name in (*self.uniforms, *self.rows.named) if name not in self.symbol}
        self.cell = range(self.rows.cell)
        self.nodes = self._each("q", self.layout.rows)
        self.next = symbols("q_next", self.layout.rows)
        self.momenta, self.free, self.unknowns = (self._each(n, self.layout.dofs) for n in ("mu", "free", "u"))
        self.symbol["right"] = ca.SX.sym("here_next")

    def write(self, name: str) -> Program:
        """Write one program."""
        if name in ("step", "step_held"):
            return self._step(held=name == "step_held")
        if name in ("drift", "drift_held"):
            return self._drift(held=name == "drift_held")
        return self._kick() if name == "kick" else self._observe()

    def blocks(self) -> tuple[Block, ...]:
        """Structure of the residual of one node."""
        residual, column, _ = self._residual(0, symbols("pushed", self.layout.dofs))
        return find_structure(residual, column)

    def _each(self, name: str, size: int) -> list[Expression]:
        """Symbols for every node of a cell."""
        return [symbols(f"{name}{k or ''}", size) for k in self.cell]

    def _place(self, k: int = 0) -> dict[str, Any]:
        """Where and when node k of a cell is, and its own constants."""
        place = {name: wrap(self.symbol[name]) for name in (*UNIFORMS, "inverse", "here") if name in self.symbol}
        if k:
            place["here"] = place["here"] + float(lobatto(len(self.cell))[k]) * wrap(self.symbol["length"])
        if self.interval:
            place |= {"left": place["here"], "right": wrap(self.symbol["right"])}
            points = range(len(self.rule.strain.at))
            place["at points"] = [constants_at(self.symbol, point) for point in points]
        return place | constants_at(self.symbol, k)

    def _weights(self, k: int) -> tuple[Expression, Expression]:
        """Weight of node k of a cell and its inverse: inside an element its Lobatto share of the length."""
        if k == 0:
            return wrap(self.symbol["weight"]), wrap(self.symbol["1/weight"])
        share = float(lobatto_weights(len(self.cell))[k])
        return share * wrap(self.symbol["length"]), wrap(self.symbol["inverse"]) * (1.0 / share)

    def _program(
        self,
        name: str,
        steps: list[Step],
        stores: list[tuple[int, ca.SX]],
        more: Iterable[tuple[ca.SX, int, int]] = (),
    ) -> Program:
        """Close a program: read just what its steps need."""
        rows = self.rows
        lanes = [(s, i, 0) for s, i in zip(_all(self.nodes), _range(rows.values), strict=True)]
        first = slice(rows.values.start, rows.values.start + self.layout.rows)
        lanes += [(s, i, 1) for s, i in zip(_entries(self.next), _range(first), strict=True)]
        lanes += [(s, i, 0) for s, i in zip(_all(self.momenta), _range(rows.momenta), strict=True)]
        lanes += [(s, i, 0) for s, i in zip(_all(self.free), _range(rows.held), strict=True)]
        lanes += [(self.symbol[n], i, 0) for n, i in rows.named.items()]
        if self.interval:
            lanes.append((self.symbol["right"], rows.named["here"], 1))
        lanes += more
        uniforms = tuple(self.symbol[n] for n in self.uniforms)
        return Program(name, uniforms, tuple(lanes), tuple(steps), tuple(stores), rows.count)

    def _impulse(self) -> tuple[list[Step], list[Expression]]:
        """Steps that find h × (forces on the nodes), and these sums."""
        return self._conservative(self._place()["h"])

    def _conservative(self, factor: Any) -> tuple[list[Step], list[Expression]]:
        """Steps that find factor × (forces of W and U on the nodes), and these sums."""
        loads = [
            node_load(self.density, self.layout, self.nodes[k], self._place(k)) * self._weights(k)[0] for k in self.cell
        ]
        kicks = [load * factor for load in loads]
        if not self.interval:
            return [], kicks
        steps, pulls, mask = self._from_elements(self._element_forces(self._place()), factor, self.rows.carried)
        return steps, [kick + pull * mask for kick, pull in zip(kicks, pulls, strict=True)]

    def _from_elements(
        self, forces: list[Expression], factor: Any, carried_rows: slice, label: str = ""
    ) -> tuple[list[Step], list[Any], np.ndarray]:
        """Steps that gather forces of elements on their nodes, these sums, and 1 for degrees of freedom with any."""
        scale = factor * wrap(self.symbol["length"])
        words = ("left", *(f"inner{k}" for k in self.cell[1:]), "right")
        own = [symbols(label + n, self.layout.dofs) for n in words]
        carried = symbols(label + "carried", self.layout.dofs)
        still = [all(to_sx(force[i]).is_zero() for force in forces) for i in range(self.layout.dofs)]
        values = [entry for force in forces for entry in _entries(where_element(scale, force * scale))]
        steps: list[Step] = [Assign(tuple(_all(own)), tuple(values))]
        moving = [i for i in range(self.layout.dofs) if not still[i]]
        rows = _range(carried_rows)
        pick = [(_entries(carried)[i], _entries(own[-1])[i], rows[i]) for i in moving]
        if pick:
            steps.append(Carry(*(tuple(column) for column in zip(*pick, strict=True))))
        mask = np.array([float(i in moving) for i in range(self.layout.dofs)])
        return steps, [own[0] + carried, *own[1:-1]], mask

    def _element_forces(self, place: Mapping[str, Any]) -> list[Expression]:
        """Forces on the nodes of an element, its right end last, per unit of its length."""
        points, ends = self.rule.strain, [*self.nodes, self.next]
        if len(self.cell) > 1:
            return polynomial_forces(self.density, points, self.layout, ends, place)
        return list(element_forces(self.density, points, self.layout, (ends[0], ends[1]), place))

    def _residual(self, k: int, pushed: Expression) -> tuple[ca.SX, ca.SX, Inertia]:
        """Equations of one node, per unit of its weight: pushed + D₀ T_d = 0."""
        inertia = corner_inertia(self.density, self.layout, self.nodes[k], self.unknowns[k], self._place(k))
        return to_sx(inertia.scale * pushed + inertia.before), to_sx(self.unknowns[k]), inertia

    def _step(self, *, held: bool) -> Program:
        """One step of all nodes: forces, solve, momenta."""
        steps, kicks = self._impulse()
        given, pushed = self._each("given", self.layout.dofs), self._each("pushed", self.layout.dofs)
        moved = [momentum + kick for momentum, kick in zip(self.momenta, kicks, strict=True)]
        steps.append(Assign(tuple(_all(given)), tuple(_all(moved))))
        scaled = [given[k] * self._weights(k)[1] for k in self.cell]
        steps.append(Assign(tuple(_all(pushed)), tuple(_all(scaled))))
        solutions, after, momenta = self._moves(given, pushed, held=held)
        steps += side_by_side(solutions)
        stores = list(zip(_range(self.rows.values), _all(after), strict=True))
        stores += list(zip(_range(self.rows.momenta), _all(momenta), strict=True))
        return self._program("step_held" if held else "step", steps, stores)

    def _drift(self, *, held: bool) -> Program:
        """One step of all nodes from momenta that forces have been added to."""
        given, pushed = self.momenta, self._each("pushed", self.layout.dofs)
        scaled = [given[k] * self._weights(k)[1] for k in self.cell]
        steps: list[Step] = [Assign(tuple(_all(pushed)), tuple(_all(scaled)))]
        solutions, after, momenta = self._moves(given, pushed, held=held)
        steps += side_by_side(solutions)
        stores = list(zip(_range(self.rows.values), _all(after), strict=True))
        stores += list(zip(_range(self.rows.momenta), _all(momenta), strict=True))
        return self._program("drift_held" if held else "drift", steps, stores)

    def _moves(
        self, given: list[Expression], pushed: list[Expression], *, held: bool
    ) -> tuple[list[list[Step]], list[Expression], list[Expression]]:
        """Steps that solve the equations of every node of a cell, values and momenta after the step."""
        solutions, after, momenta = [], [], []
        for k in self.cell:
            residual, column, inertia = self._residual(k, pushed[k])
            blocks = find_structure(residual, column)
            momentum = given[k] + inertia.total * self._weights(k)[0]
            if held:
                residual = to_sx(self.free[k] * wrap_column(residual) + (1.0 - self.free[k]) * self.unknowns[k])
                momentum = self.free[k] * momentum
            solutions.append(solve_steps(residual, column, blocks))
            after.append(inertia.after)
            momenta.append(momentum)
        return solutions, after, momenta

    def _kick(self) -> Program:
        """Add h × forces to the momenta."""
        steps, kicks = self._impulse()
        moved = [momentum + kick for momentum, kick in zip(self.momenta, kicks, strict=True)]
        return self._program("kick", steps, list(zip(_range(self.rows.momenta), _all(moved), strict=True)))

    def _observe(self) -> Program:
        """Velocities from momenta (Legendre transform), energies, forces and slopes, for results."""
        found = [self._observe_node(k) for k in self.cell]
        steps = side_by_side([own for own, _ in found])
        outputs = {name: [own[name] for _, own in found] for name in ("velocity", "load")}
        energies = [own["energies"] for _, own in found]
        if self.interval and len(self.cell) == 1:  # results.interpolated does longer cells
            energies[0][1], between = self._observe_element()
            outputs |= {name: [value] for name, value in between.items()}
        outputs["energies"] = energies
        pairs = [(self.rows.observed[n], _all(values)) for n, values in outputs.items()]
        stores = [pair for rows, values in pairs for pair in zip(_range(rows), values, strict=True)]
        return self._program("observe", steps, stores, self._reads)

    def _observe_node(self, k: int) -> tuple[list[Step], dict[str, Expression]]:
        """Steps that find the velocity of node k, and velocity, load and energies there."""
        place, layout, node = self._place(k), self.layout, self.nodes[k]
        weight, inverse = self._weights(k)
        point = node_point(layout, node, self.density.lagrangian.interval, place)
        steps, velocity, momentum = self.velocity_of(k, point, self.momenta[k] * inverse, f"v{k or ''}")
        column = to_sx(velocity)
        moving = point | {f"{name}_t": velocity[layout.dofs_of(name)] for name in layout.fields}
        kinetic = wrap(ca.dot(to_sx(momentum), column) - self.density.value("inertia", moving)) * weight
        stored = wrap(self.density.value("load", point)) * weight
        load = node_load(self.density, layout, node, place) * weight
        energies = wrap(np.array([_scalar(kinetic), ca.SX(0), _scalar(stored)], dtype=object))
        return steps, {"velocity": velocity, "load": load, "energies": energies}

    def velocity_of(
        self, k: int, point: Mapping[str, Any], given: Any, name: str
    ) -> tuple[list[Step], Expression, Expression]:
        """Steps that find the velocity of node k from its momentum per unit of weight, 0 where held; ∂T/∂q̇ of it."""
        layout = self.layout
        velocity = symbols(name, layout.dofs)
        moving = dict(point) | {f"{name}_t": velocity[layout.dofs_of(name)] for name in layout.fields}
        gradient = self.density.gradient("inertia", moving)
        momentum = wrap(np.concatenate([gradient[f"{name}_t"] for name in layout.fields]))
        residual = to_sx(self.free[k] * (momentum - given) + (1.0 - self.free[k]) * velocity)
        column = to_sx(velocity)
        blocks = find_structure(ca.jacobian(to_sx(momentum), column) @ column, column)
        return solve_steps(residual, column, blocks), velocity, momentum

    def _observe_element(self) -> tuple[ca.SX, dict[str, Expression]]:
        """Strain energy of an element between two nodes; its forces on them and its slopes."""
        place, layout = self._place(), self.layout
        strain_at = self.rule.strain
        if self.rule.degree > 1:  # results.interpolated does higher degrees
            strain_at, place = MIDDLE, place | {"at points": [{}]}
        ends, length = (self.nodes[0], self.next), wrap(self.symbol["length"])
        left, right = element_forces(self.density, strain_at, layout, ends, place)
        strain = wrap(element_energy(self.density, strain_at, layout, ends, place)) * length
        outputs = {"left": where_element(length, left * length), "right": where_element(length, right * length)}
        at = element_points(self.density, strain_at, layout, ends, place)[0][1]
        along = self.density.lagrangian.interval
        outputs["slopes"] = wrap(np.concatenate([at[f"{name}_{along}"] for name in layout.fields]))
        return _scalar(where_element(length, strain)), outputs


def wrap_column(value: ca.SX) -> Expression:
    """A CasADi column as an Expression of shape (n,)."""
    return wrap(np.atleast_1d(from_sx(ca.densify(value))))


def _entries(value: Any) -> list[ca.SX]:
    return ca.vertsplit(to_sx(value))


def _all(values: Sequence[Any]) -> list[ca.SX]:
    """Entries of several columns, one after the other."""
    return [entry for value in values for entry in _entries(value)]


def where_element(length: Expression, value: Expression) -> Expression:
    """The value where there is an element, zero behind the last node of a chain (where it may be 0/0)."""
    one = length.view(np.ndarray).item()
    chosen = [e if e.is_zero() else ca.if_else(one != 0, e, 0) for e in _entries(wrap(np.atleast_1d(value)))]
    return wrap(np.array(chosen, dtype=object).reshape(np.shape(value)))


def _range(rows: slice) -> list[int]:
    return list(range(rows.start, rows.stop))


def _scalar(value: Expression) -> ca.SX:
    return value.view(np.ndarray).item()
