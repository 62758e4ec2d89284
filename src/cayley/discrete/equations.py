"""Discrete Euler-Lagrange equations of a Lagrangian under a rule, as programs for the compiler."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, from_sx, symbols, to_sx, wrap
from cayley.discrete.constraint import constrained_program, constrained_rows
from cayley.discrete.element import element_energy, element_forces, element_points
from cayley.discrete.embedded import constraint_program, point_program
from cayley.discrete.fused import fused_program
from cayley.discrete.layout import Layout
from cayley.discrete.node import Inertia, corner_inertia, node_load, node_point
from cayley.discrete.program import Assign, Carry, Program, Step
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import MIDDLE, Rule
from cayley.discrete.solve import Block, find_structure, solve_steps

UNIFORMS = ("h", "t", "t_next")


@dataclass(frozen=True, slots=True)
class Rows:
    """Where things stand in a block: one row of lanes each.

    Args:
        values: values of the node.
        momenta: its momenta.
        carried: forces handed from an element to its right node.
        held: 1 where a degree of freedom is free, 0 where it is held.
        named: single rows: "weight" and "1/weight" of the node [m], "length" of the element to its right (0 where
            there is none), and, where they are not uniform, "inverse", "here" and constants.
        observed: velocities, then forces on the left and right node of the element, then load, slopes and energies.
        count: number of rows.
        constraint: what the programs of constrained densities read and write (see discrete.constraint).
    """

    values: slice
    momenta: slice
    carried: slice
    held: slice
    named: dict[str, int]
    observed: dict[str, slice]
    count: int
    constraint: dict[str, slice] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class DiscreteEquations:
    """Discrete Euler-Lagrange equations in position-momentum form; programs are derived when first asked for.

    μ_aʲ + Σ D_(a,j) L_d + h f = 0 gives qʲ⁺¹, and μ_aʲ⁺¹ = Σ D_(a,j+1) L_d.

    Args:
        density: the density they come from.
        rule: the quadrature rule.
        layout: rows of a node.
        rows: rows of a block.
        uniforms: names of the uniform inputs, in order.
        varying: names of inputs that differ from node to node.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 6; position-momentum form: Marsden and West (2001).
    """

    density: Density
    rule: Rule
    layout: Layout
    rows: Rows
    uniforms: tuple[str, ...]
    varying: frozenset[str]
    _derived: dict[str, Any] = field(default_factory=dict, repr=False)

    def program(self, name: str) -> Program:
        """A program by its name; implicit rules have "inertia_point" and "strain_point", or "fused"."""
        if name not in self._derived:
            varying = tuple(n for n in self.density.names if n in self.varying)
            if name == "fused":
                self._derived[name] = fused_program(self.density, self.layout, self.rule.strain, varying)
            elif name.removesuffix("_held") in ("drift", "violation", "schur", "rate"):
                self._derived[name] = constrained_program(_Writer(self), name)
            elif name == "constraint_point":
                self._derived[name] = constraint_program(self.density, self.layout, self.rule.strain, varying)
            elif name.endswith("_point"):
                self._derived[name] = point_program(self.density, self.layout, name, self.rule.strain, varying)
            else:
                self._derived[name] = _Writer(self).write(name)
        return self._derived[name]

    @property
    def main_program(self) -> str:
        """Name of the program that does most of the work of a step."""
        if not self.rule.implicit:
            return "drift" if self.density.constraints.numel() else "step"
        if self.rule.one_stage:
            return "fused"
        return "strain_point" if self.density.lagrangian.interval else "inertia_point"

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Structure of one node's equations, found from the sparsity of their Jacobian."""
        if "blocks" not in self._derived:
            self._derived["blocks"] = _Writer(self).blocks()
        return self._derived["blocks"]

    @property
    def structure(self) -> str:
        """One line on that structure."""
        if self.rule.implicit:
            width = self.layout.dofs * len(self.rule.time.at) * self.rule.degree
            more = self.density.constraints.numel() * len(self.rule.time.at) * self.rule.degree
            if more:
                return f"coupled nodes; banded, {width} unknowns and {more} multipliers an element, by Newton"
            return f"coupled nodes; block tridiagonal, {width} unknowns a block, by Newton"
        words = []
        for block in self.blocks:
            names = ", ".join(self.layout.dof_names[i] for i in block.unknowns)
            words.append(f"{names} {'explicit' if block.linear else 'by Newton'}")
        count = self.density.constraints.numel()
        solved = f"; {count} multiplier{'s' * (count > 1)} an element, block tridiagonal, by Newton" if count else ""
        return "decoupled nodes; " + "; ".join(words) + solved

    @property
    def signature(self) -> str:
        """Text that determines every program."""
        rule = f"{self.rule!r} {self.layout.representation.name} {sorted(self.varying)}"
        return f"{rule}\n{self.density.signature}"


def derive(
    density: Density, rule: Rule, *, rotation: str = "quaternion", varying: Iterable[str] = ()
) -> DiscreteEquations:
    """Derive the discrete Euler-Lagrange equations of a density under a rule.

    Args:
        density: traced Lagrangian.
        rule: quadrature rule.
        rotation: "quaternion" or "matrix".
        varying: names of uniform inputs and constants that differ from node to node.

    Raises:
        ValueError: if the rotation form is unknown, or velocities are coupled with derivatives along the interval.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 6; position-momentum form: Marsden and West (2001).
    """
    if rotation not in REPRESENTATIONS:
        raise ValueError(f"rotation is {rotation!r}; give one of {', '.join(REPRESENTATIONS)}")
    lagrangian = density.lagrangian
    along = lagrangian.interval
    slopes = [f"{name}_{along}" for name in lagrangian.fields] if along else []
    if rule.strain.screw and along and lagrangian.pose is None:
        raise ValueError(
            f"Lagrangian {lagrangian.name}: the rule {rule} is for a pose; declare one, such as pose=('p', 'x')"
        )
    if slopes and density.depends("inertia", *slopes):
        raise ValueError(
            f"Lagrangian {lagrangian.name}: velocities are coupled with derivatives along {along} in one term, so the "
            f"nodes do not decouple under the rule {rule.name}; a block-tridiagonal rule is needed and not there yet"
        )
    if rule.implicit and rotation != "quaternion":
        raise ValueError(f"rotation is {rotation!r}, but the rule {rule} is there for quaternions only, yet")
    if density.constraints.numel() and (rule.strain.corners or rule.degree > 1):
        raise ValueError(
            f"Lagrangian {lagrangian.name}: the rule {rule} is not there for constrained densities; "
            f"use verlet, screw, midpoint, screw_midpoint or galerkin(time=...)"
        )
    if density.constraints.numel() and rotation != "quaternion":
        raise ValueError(f"rotation is {rotation!r}, but constrained densities are there for quaternions only, yet")
    layout = Layout(lagrangian.fields, REPRESENTATIONS[rotation])
    candidates = [*UNIFORMS, *(["inverse"] if along else []), *density.names]
    unknown = sorted(set(varying) - set(candidates))
    if unknown:
        raise ValueError(f"varying names {unknown[0]!r}; inputs are {', '.join(candidates)}")
    uniforms = tuple(name for name in candidates if name not in set(varying))
    rows = _assign_rows(layout, [name for name in candidates if name not in uniforms], interval=along is not None)
    rows = constrained_rows(rows, layout, density.constraints.numel())
    return DiscreteEquations(density, rule, layout, rows, uniforms, frozenset(varying))


def _assign_rows(layout: Layout, varying: list[str], *, interval: bool) -> Rows:
    """Give everything a node stores its row."""
    at = 0

    def take(size: int) -> slice:
        nonlocal at
        at += size
        return slice(at - size, at)

    values, momenta = take(layout.rows), take(layout.dofs)
    carried = take(layout.dofs if interval else 0)
    held = take(layout.dofs)
    named = {
        name: take(1).start for name in ["weight", "1/weight", *(["length", "here"] if interval else []), *varying]
    }
    observed = {"velocity": take(layout.dofs), "load": take(layout.dofs), "energies": take(3)}
    if interval:
        observed |= {"left": take(layout.dofs), "right": take(layout.dofs), "slopes": take(layout.dofs)}
    return Rows(values, momenta, carried, held, named, observed, at)


class _Writer:
    """Writes programs: the symbols of the equations and where their values stand."""

    def __init__(self, equations: DiscreteEquations) -> None:
        self.density, self.rule, self.layout = equations.density, equations.rule, equations.layout
        self.rows, self.uniforms = equations.rows, equations.uniforms
        self.interval = self.density.lagrangian.interval is not None
        self.symbol = dict(zip(self.density.names, ca.vertsplit(self.density.parameters), strict=True))
        self.symbol |= {name: ca.SX.sym(name) for name in (*self.uniforms, *self.rows.named) if name not in self.symbol}
        self.node = symbols("q", self.layout.rows)
        self.next = symbols("q_next", self.layout.rows)
        self.momentum = symbols("mu", self.layout.dofs)
        self.free = symbols("free", self.layout.dofs)
        self.unknown = symbols("u", self.layout.dofs)
        self.symbol["right"] = ca.SX.sym("here_next")

    def write(self, name: str) -> Program:
        """Write one program."""
        if name in ("step", "step_held"):
            return self._step(held=name == "step_held")
        return self._kick() if name == "kick" else self._observe()

    def blocks(self) -> tuple[Block, ...]:
        """Structure of the residual of one node."""
        residual, column, _ = self._residual(symbols("pushed", self.layout.dofs))
        return find_structure(residual, column)

    def _place(self) -> dict[str, Any]:
        place = {name: wrap(self.symbol[name]) for name in (*UNIFORMS, "inverse", "here") if name in self.symbol}
        if self.interval:
            place |= {"left": place["here"], "right": wrap(self.symbol["right"])}
        return place

    def _program(
        self,
        name: str,
        steps: list[Step],
        stores: list[tuple[int, ca.SX]],
        more: Iterable[tuple[ca.SX, int, int]] = (),
    ) -> Program:
        """Close a program: read just what its steps need."""
        lanes = [(s, i, 0) for s, i in zip(_entries(self.node), _range(self.rows.values), strict=True)]
        lanes += [(s, i, 1) for s, i in zip(_entries(self.next), _range(self.rows.values), strict=True)]
        lanes += [(s, i, 0) for s, i in zip(_entries(self.momentum), _range(self.rows.momenta), strict=True)]
        lanes += [(s, i, 0) for s, i in zip(_entries(self.free), _range(self.rows.held), strict=True)]
        lanes += [(self.symbol[n], i, 0) for n, i in self.rows.named.items()]
        if self.interval:
            lanes.append((self.symbol["right"], self.rows.named["here"], 1))
        lanes += more
        uniforms = tuple(self.symbol[n] for n in self.uniforms)
        return Program(name, uniforms, tuple(lanes), tuple(steps), tuple(stores), self.rows.count)

    def _impulse(self) -> tuple[list[Step], Expression]:
        """Steps that find h × (forces on the node), and that sum."""
        place = self._place()
        weight = wrap(self.symbol["weight"])
        steps: list[Step] = []
        total = node_load(self.density, self.layout, self.node, place) * weight
        if self.interval:
            left, right = element_forces(self.density, self.rule.strain, self.layout, (self.node, self.next), place)
            scale = place["h"] * wrap(self.symbol["length"])
            from_left, from_right, carried = (symbols(n, self.layout.dofs) for n in ("left", "right", "carried"))
            moving = [
                i for i in range(self.layout.dofs) if not (to_sx(left[i]).is_zero() and to_sx(right[i]).is_zero())
            ]
            targets = _entries(from_left) + _entries(from_right)
            values = _entries(_where_element(scale, left * scale)) + _entries(_where_element(scale, right * scale))
            steps.append(Assign(tuple(targets), tuple(values)))
            rows = _range(self.rows.carried)
            pick = [(_entries(carried)[i], _entries(from_right)[i], rows[i]) for i in moving]
            if pick:
                steps.append(Carry(*(tuple(column) for column in zip(*pick, strict=True))))
            mask = np.array([float(i in moving) for i in range(self.layout.dofs)])
            return steps, total * place["h"] + (from_left + carried) * mask
        return steps, total * place["h"]

    def _residual(self, pushed: Expression) -> tuple[ca.SX, ca.SX, Inertia]:
        """Equations of one node, per unit of its weight: pushed + D₀ T_d = 0."""
        inertia = corner_inertia(self.density, self.layout, self.node, self.unknown, self._place())
        return to_sx(inertia.scale * pushed + inertia.before), to_sx(self.unknown), inertia

    def _step(self, *, held: bool) -> Program:
        """One step of all nodes: forces, solve, momenta."""
        steps, impulse = self._impulse()
        given, pushed = symbols("given", self.layout.dofs), symbols("pushed", self.layout.dofs)
        weight, inverse = wrap(self.symbol["weight"]), wrap(self.symbol["1/weight"])
        steps.append(Assign(tuple(_entries(given)), tuple(_entries(self.momentum + impulse))))
        steps.append(Assign(tuple(_entries(pushed)), tuple(_entries(given * inverse))))
        residual, column, inertia = self._residual(pushed)
        blocks = find_structure(residual, column)
        momentum = given + inertia.total * weight
        if held:
            residual = to_sx(self.free * wrap_column(residual) + (1.0 - self.free) * self.unknown)
            momentum = self.free * momentum
        steps += solve_steps(residual, column, blocks)
        stores = list(zip(_range(self.rows.values), _entries(inertia.after), strict=True))
        stores += list(zip(_range(self.rows.momenta), _entries(momentum), strict=True))
        return self._program("step_held" if held else "step", steps, stores)

    def _kick(self) -> Program:
        """Add h × forces to the momenta."""
        steps, impulse = self._impulse()
        stores = list(zip(_range(self.rows.momenta), _entries(self.momentum + impulse), strict=True))
        return self._program("kick", steps, stores)

    def _observe(self) -> Program:
        """Velocities from momenta (Legendre transform), energies, forces and slopes, for results."""
        place, layout, observed = self._place(), self.layout, self.rows.observed
        strain_at = self.rule.strain if self.rule.degree == 1 else MIDDLE  # results.interpolated does higher degrees
        weight, inverse = wrap(self.symbol["weight"]), wrap(self.symbol["1/weight"])
        velocity = symbols("v", layout.dofs)
        point = node_point(layout, self.node, self.density.lagrangian.interval, place)
        moving = point | {f"{name}_t": velocity[layout.dofs_of(name)] for name in layout.fields}
        gradient = self.density.gradient("inertia", moving)
        momentum = wrap(np.concatenate([gradient[f"{name}_t"] for name in layout.fields]))
        residual = to_sx(self.free * (momentum - self.momentum * inverse) + (1.0 - self.free) * velocity)
        column = to_sx(velocity)
        blocks = find_structure(ca.jacobian(to_sx(momentum), column) @ column, column)
        steps = solve_steps(residual, column, blocks)
        kinetic = wrap(ca.dot(to_sx(momentum), column) - self.density.value("inertia", moving)) * weight
        stored = wrap(self.density.value("load", point)) * weight
        load = node_load(self.density, layout, self.node, place) * weight
        outputs = {"velocity": velocity, "load": load}
        strain = wrap(ca.SX(0))
        if self.interval:
            ends, length = (self.node, self.next), wrap(self.symbol["length"])
            left, right = element_forces(self.density, strain_at, layout, ends, place)
            strain = wrap(element_energy(self.density, strain_at, layout, ends, place)) * length
            strain = _where_element(length, strain)
            outputs |= {"left": _where_element(length, left * length), "right": _where_element(length, right * length)}
            at = element_points(self.density, strain_at, layout, ends, place)[0][1]
            along = self.density.lagrangian.interval
            outputs["slopes"] = wrap(np.concatenate([at[f"{name}_{along}"] for name in layout.fields]))
        outputs["energies"] = wrap(np.array([_scalar(e) for e in (kinetic, strain, stored)], dtype=object))
        stores = [pair for n, e in outputs.items() for pair in zip(_range(observed[n]), _entries(e), strict=True)]
        return self._program("observe", steps, stores)


def wrap_column(value: ca.SX) -> Expression:
    """A CasADi column as an Expression of shape (n,)."""
    return wrap(np.atleast_1d(from_sx(ca.densify(value))))


def _entries(value: Any) -> list[ca.SX]:
    return ca.vertsplit(to_sx(value))


def _where_element(length: Expression, value: Expression) -> Expression:
    """The value where there is an element, zero behind the last node of a chain (where it may be 0/0)."""
    one = length.view(np.ndarray).item()
    chosen = [e if e.is_zero() else ca.if_else(one != 0, e, 0) for e in _entries(wrap(np.atleast_1d(value)))]
    return wrap(np.array(chosen, dtype=object).reshape(np.shape(value)))


def _range(rows: slice) -> list[int]:
    return list(range(rows.start, rows.stop))


def _scalar(value: Expression) -> ca.SX:
    return value.view(np.ndarray).item()


__all__ = ["UNIFORMS", "DiscreteEquations", "Rows", "derive"]
