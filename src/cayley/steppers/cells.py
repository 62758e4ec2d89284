"""Cells of the compiled steppers: where terms of the action, forces and constraints are evaluated, by what kernels."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cayley.codegen.kernels import Kernel, compiled
from cayley.density.force import KINDS, NODE
from cayley.discrete.joint import COUNTS, joint_program
from cayley.discrete.places import name_at, placed
from cayley.discrete.program import Program
from cayley.discrete.rules import Points, lagrange, lobatto
from cayley.discrete.spring import damper_program, spring_program
from cayley.system.couplings import Coupling, Elastic
from cayley.system.system import System


@dataclass(frozen=True, slots=True, kw_only=True)
class Cells:
    """Points of one kind at which a kernel is evaluated, several in a cell.

    Args:
        programs: with second derivatives, and without.
        kernels: their machine code.
        uniforms: values of their uniform inputs behind the time.
        nodes: nodes of every cell, the number of nodes for the ground, shape (cells, width).
        phi: interpolation of values at the points, shape (gauss, width).
        psi: of slopes, shape (gauss, width).
        inverse: factor of psi, shape (cells,).
        weight: of the points, shape (cells, gauss).
        constant: inputs that do not change, shape (cells, gauss, constants).
        slots: 1 for values alone, 2 with slopes (or for two ends).
        rates: whether the kernel sees rates.
        rated: whether it returns derivatives along them.
        force: whether it returns a force and its Jacobian instead of value, gradient and Hessian.
        accounted: whether power of work and loss stand behind the force.
        count: constraints of a point.
        drive: function times (m,) -> (m, driven, drives), of the last constants of driven cells, or None.
        driver: which driven cell a cell is, or −1, shape (cells,).
        names: what joints and springs are called.
        group: number of the density they are of; None for joints and springs.
        alternating: whether forces of its multipliers can make rotations alternate from node to node (see couplings.c).
        starts: first of the entries of every pair of slots, one more behind the last.
        entries: place in the pair and row of the kernel of second derivatives that are not always zero, shape (k, 2).
    """

    programs: tuple[Program, Program]
    kernels: tuple[Kernel, Kernel]
    uniforms: np.ndarray
    nodes: np.ndarray
    phi: np.ndarray
    psi: np.ndarray
    inverse: np.ndarray
    weight: np.ndarray
    constant: np.ndarray
    slots: int
    rates: bool = False
    rated: bool = False
    force: bool = False
    accounted: bool = False
    count: int = 0
    drive: Callable[[np.ndarray], np.ndarray] | None = None
    driver: np.ndarray | None = None
    names: tuple[str, ...] = ()
    group: int | None = None
    alternating: bool = False
    starts: np.ndarray = field(init=False, repr=False)
    entries: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Find the second derivatives that are not always zero: once, not in every call of a driver."""
        starts, entries = _second_derivatives(self)
        object.__setattr__(self, "starts", starts)
        object.__setattr__(self, "entries", entries)

    @property
    def gauss(self) -> int:
        """Points of a cell."""
        return len(self.phi)


def inertia_cells(system: System, nodes: np.ndarray) -> list[Cells]:
    """Inertia and loads of every density, at some nodes; cells number them by their place among these."""
    return [_at_nodes(own, "inertia_point", rated=True) for own in _chosen(system, nodes) if len(own.nodes)]


def term_cells(system: System) -> list[Cells]:
    """All terms of a system: inertia, strain, forces, springs and dampers."""
    nodes = np.arange(system.size)
    found = inertia_cells(system, nodes)
    for own in _chosen(system, nodes):
        elements = any(count > 1 for count in own.group.chains)
        if elements:
            found.append(_on_elements(own, "strain_point", sign=-1.0))
        force = own.group.equations.density.force
        if force is not None:
            if elements and any(force.between_nodes(kind) for kind in KINDS):
                found.append(_on_elements(own, "force_point", rates=True, force=True, accounted=True))
            if any((NODE, kind) in force.terms for kind in KINDS):
                found.append(_at_nodes(own, "node_force_point", force=True, accounted=True))
    return found + spring_cells(system, nodes)


def constraint_cells(system: System, nodes: np.ndarray) -> list[Cells]:
    """All constraints of a system, those of the densities and of the joints; cells number nodes by their place."""
    found = []
    for own in _chosen(system, nodes):
        equations = own.group.equations
        count = equations.density.constraints.numel()
        if count and any(chain > 1 for chain in own.group.chains):
            screw = equations.rule.strain.screw
            found.append(_on_elements(own, "constraint_point", light="_slope", count=count, alternating=screw))
    return found + joint_cells(system, nodes)


@dataclass(frozen=True, slots=True)
class _Chosen:
    """Some nodes of a group.

    Args:
        number: of the group.
        group: the system of one density.
        nodes: among its nodes, shape (n,).
        places: what cells number these by, shape (n,).
    """

    number: int
    group: System
    nodes: np.ndarray
    places: np.ndarray


def _chosen(system: System, nodes: np.ndarray) -> list[_Chosen]:
    """Some nodes of a system, in rising order, by groups."""
    found = []
    for number, (group, own) in enumerate(system.spans):
        places = np.flatnonzero((nodes >= own.start) & (nodes < own.stop))
        found.append(_Chosen(number, group, nodes[places] - own.start, places))
    return found


def _at_nodes(own: _Chosen, name: str, **kind: Any) -> Cells:
    system, nodes = own.group, own.nodes
    return Cells(
        **_kernels(system, name, "_force"),
        group=own.number,
        nodes=own.places[:, None],
        phi=np.ones((1, 1)),
        psi=np.zeros((1, 1)),
        inverse=np.ones(len(nodes)),
        weight=np.ascontiguousarray(system.named["weight"][nodes, None]),
        constant=_constants(system, nodes[:, None], np.zeros((len(nodes), 1))),
        slots=1,
        rates=True,
        **kind,
    )


def _on_elements(own: _Chosen, name: str, *, light: str = "_force", sign: float = 1.0, **kind: Any) -> Cells:
    """At the strain points of every element of a group, all of whose nodes are chosen."""
    system = own.group
    strain, degree = system.equations.rule.strain, system.equations.rule.degree
    starts, first = [], 0
    for count in system.chains:
        starts.append(first + np.arange(0, count - 1, degree))
        first += count
    nodes = np.concatenate(starts)[:, None] + np.arange(degree + 1)
    lengths = system.named["length"][nodes[:, :-1]].sum(axis=1)
    phi, psi, heavy = in_space(strain)
    along = np.zeros(1) if strain.between_ends else np.array(strain.at)
    constant = _constants(system, np.repeat(nodes[:, :1], len(heavy), axis=1), np.outer(lengths, along))
    if strain.corners:  # one evaluation for both: what differs between them stands behind
        others = [system.named[name][nodes[:, :1]] for name in placed(system.equations.varying)]
        constant = np.concatenate([constant, *(values[:, :, None] for values in others)], axis=2)
    return Cells(
        **_kernels(system, name, light),
        group=own.number,
        nodes=own.places[nodes],
        phi=phi,
        psi=psi,
        inverse=np.ones(len(lengths)) if strain.between_ends else 1.0 / lengths,
        weight=sign * np.outer(lengths, heavy),
        constant=constant,
        slots=2,
        **kind,
    )


def in_space(strain: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """φ, φ′ and weights of the strain points; between ends the kernel takes the two end nodes as they are."""
    if strain.between_ends:
        return np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]]), np.ones(1)
    phi, psi = lagrange(lobatto(len(strain.at)), strain.at)
    return phi, psi, np.array(strain.weights)


def _kernels(system: System, full: str, light: str) -> dict[str, Any]:
    equations = system.equations
    known = dict(zip(equations.uniforms, system.uniforms, strict=True))
    names = (full, full + light)
    return {
        "programs": tuple(equations.program(name) for name in names),
        "kernels": tuple(system.kernels[name] for name in names),
        "uniforms": np.array([known[n] for n in equations.density.names if n not in equations.varying]),
    }


def _constants(system: System, nodes: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Coordinate, 1/length and what varies, of points that are ``along`` from nodes, shape (cells, gauss, constants).

    Constants with values of their own at each point of an element have a name for each (see discrete.places).
    """
    equations, size = system.equations, system.size
    known = dict(zip(equations.uniforms, system.uniforms, strict=True))
    inverse = system.named.get("inverse", np.full(size, known.get("inverse", 1.0)))
    here = system.named.get("here", np.zeros(size))[nodes] + along
    found = [here, inverse[nodes]]
    for name in equations.density.names:
        if name in equations.varying:
            by_point = [system.named.get(name_at(name, g), system.named[name]) for g in range(nodes.shape[1])]
            found.append(np.stack([values[nodes[:, g]] for g, values in enumerate(by_point)], axis=1))
    return np.stack(found, axis=-1)


def joint_cells(system: System, nodes: np.ndarray) -> list[Cells]:
    """Joints, those of one kind together."""
    found = []
    for (kind, grounded), joints in alike(system.joints).items():
        program = joint_program(kind, system.layout, grounded=grounded)
        outputs = COUNTS[kind] * (1 + 2 * system.layout.rows)
        constant = np.stack([np.concatenate([joint.parameters, joint.motion(np.zeros(1))[0]]) for joint in joints])
        driven = [joint for joint in joints if joint.drive is not None]
        driver = np.full(len(joints), -1, dtype=np.int64)
        driver[[k for k, joint in enumerate(joints) if joint.drive is not None]] = np.arange(len(driven))
        found.append(
            Cells(
                **_between(system, program, outputs, joints, nodes),
                constant=constant[:, None],
                count=COUNTS[kind],
                drive=_together(driven) if driven else None,
                driver=driver,
            )
        )
    return found


def _together(driven: Sequence[Coupling]) -> Callable[[np.ndarray], np.ndarray]:
    """Prescribed motions of several joints as one function of times, (m,) -> (m, joints, 7)."""
    return lambda times: np.stack([joint.motion(times) for joint in driven], axis=1)


def spring_cells(system: System, nodes: np.ndarray) -> list[Cells]:
    """Springs and dampers, those of one kind together."""
    found = []
    for (kind, grounded), springs in alike(system.springs).items():
        constant = np.stack([spring.parameters for spring in springs])[:, None]
        program, outputs = spring_program(kind, system.layout, grounded=grounded), 2 * system.layout.rows
        found.append(Cells(**_between(system, program, 1 + outputs, springs, nodes, sign=-1.0), constant=constant))
        if any(spring.damped for spring in springs):
            program = damper_program(kind, system.layout, grounded=grounded)
            shared = _between(system, program, outputs, springs, nodes)
            found.append(Cells(**shared, constant=constant, rates=True, force=True))
    return found


def alike(ties: Sequence[Any]) -> dict[tuple[str, bool], list[Any]]:
    """Joints or springs by their kind and whether they are grounded: those of one cells."""
    found: dict[tuple[str, bool], list[Any]] = {}
    for tie in ties:
        found.setdefault((tie.kind, tie.grounded), []).append(tie)
    return found


def _between(
    system: System,
    program: Program,
    outputs: int,
    ties: Sequence[Coupling | Elastic],
    nodes: np.ndarray,
    sign: float = 1.0,
) -> dict[str, Any]:
    """What cells of two nodes have in common; the light program has the first outputs only, in the same rows."""
    programs = program, replace(program, name=f"{program.name}_light", stores=program.stores[:outputs])
    local = np.full(system.size + 1, -1)
    local[nodes] = np.arange(len(nodes))
    local[-1] = len(nodes)  # the ground
    signature = f"{dict(system.layout.fields)} {system.layout.representation.name}"  # the same in every process
    return {
        "programs": programs,
        "kernels": tuple(compiled(one, system.kernels.lanes, signature) for one in programs),
        "uniforms": np.zeros(0),
        "nodes": local[np.array([(tie.first, tie.second) for tie in ties])],
        "phi": np.array([[1.0, 0.0]]),
        "psi": np.array([[0.0, 1.0]]),
        "inverse": np.ones(len(ties)),
        "weight": np.full((len(ties), 1), sign),
        "slots": 2,
        "names": tuple(tie.name for tie in ties),
    }


__all__ = [
    "Cells",
    "alike",
    "constraint_cells",
    "in_space",
    "inertia_cells",
    "joint_cells",
    "spring_cells",
    "term_cells",
]


def _second_derivatives(cells: Cells) -> tuple[np.ndarray, np.ndarray]:
    """Entries that are not always zero, slot by slot: of a Hessian (its upper triangle is stored) or a Jacobian."""
    program = cells.programs[0]
    slots_in, slots_out = cells.slots * (1 + cells.rates), cells.slots * (1 + cells.rated)
    rows = (len(program.lanes) - cells.constant.shape[-1] - cells.count) // slots_in  # of a node
    size = slots_in * rows
    first = program.rows - (slots_out * rows * size if cells.force else size * (size + 1) // 2)
    filled = {row for row, value in program.stores if not value.is_zero()}
    starts, entries = [0], []
    for out, inner in itertools.product(range(slots_out), range(slots_in)):
        for i, j in itertools.product(range(rows), range(rows)):
            row, column = out * rows + i, inner * rows + j
            low, high = (row, column) if cells.force else sorted((row, column))
            where = low * size + high if cells.force else low * size - low * (low - 1) // 2 + high - low
            if first + where in filled:
                entries.append((i * rows + j, first + where))
        starts.append(len(entries))
    return np.array(starts, dtype=np.int64), np.array(entries, dtype=np.int64).reshape(-1, 2)
