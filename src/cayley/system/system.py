"""A compiled system: discrete equations, machine code, and the arrays they work on."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cayley.codegen.kernels import Kernels
from cayley.discrete.equations import DiscreteEquations
from cayley.discrete.layout import Layout
from cayley.discrete.places import name_at
from cayley.system.contact_arrays import Touching
from cayley.system.couplings import Coupling, Elastic


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """Where a system is: enough to go on as if it had never stopped.

    Args:
        values: values of every node, shape (nodes, layout.rows).
        momenta: momenta of every node, left-trivialized, shape (nodes, layout.dofs).
        origin: time of step 0 [s].
        step: number of steps taken since.
        h: the time step [s], or 0 before the first.
        memory: what a stepper remembers of the steps before, such as control nodes from which implicit rules guess the
            next step, flat; None where there is nothing.
        work: work of loads and forces that are not in the Lagrangian and do not depend on velocities, and loss by those
            that do [J], since the run began; entry by entry as a stepper adds them up, shape (k, 2), of explicit rules
            one for each cell; None where nothing is accounted for.
    """

    values: np.ndarray
    momenta: np.ndarray
    origin: float = 0.0
    step: int = 0
    h: float = 0.0
    memory: np.ndarray | None = None
    work: np.ndarray | None = None

    @property
    def time(self) -> float:
        """Time [s]."""
        return self.origin + self.step * self.h

    def at_step(self, h: float) -> "State":
        """The same state as the origin of steps of another size; of the same size up to rounding, the state itself."""
        return (
            self if math.isclose(h, self.h, rel_tol=1e-9) else replace(self, origin=self.time, step=0, h=h, memory=None)
        )


@dataclass(frozen=True, slots=True)
class LoadEntries:
    """Forces on nodes that are functions of time alone, in space or in a body frame.

    Args:
        table: function (times (m,), step, origin of time) -> values, shape (m, columns).
        columns: number of columns.
        node: node of each entry, shape (k,).
        dof: first of the three degrees of freedom it acts on, shape (k,).
        turn: first row of the rotation that turns it, shape (k,).
        form: 0 as given, 1 from space to body, 2 from body to space, shape (k,).
        column: first of its three columns, shape (k,).
        scale: factor, shape (k,).
        lever: from the node to where a force acts, in its body frame [m], of an entry that is the moment of that force:
            the vector, turned by form, is crossed with it from the left; else zero, shape (k, 3).
    """

    table: Any
    columns: int
    node: np.ndarray
    dof: np.ndarray
    turn: np.ndarray
    form: np.ndarray
    column: np.ndarray
    scale: np.ndarray
    lever: np.ndarray

    @property
    def factors(self) -> np.ndarray:
        """Factor and lever of each entry, as steppers read them, shape (k, 4)."""
        return np.ascontiguousarray(np.column_stack([self.scale, self.lever]))


@dataclass(frozen=True, slots=True, kw_only=True)
class System:
    """Discrete equations with numbers: what steppers step.

    Several densities are several members, systems of one density each, over consecutive nodes; equations, kernels,
    uniforms and named are then what they have in common (see mixed.py), and whatever needs more asks every member.

    Args:
        equations: the discrete equations.
        kernels: their machine code.
        uniforms: values of the uniform inputs, shape (len(equations.uniforms),).
        named: values per node of weight, 1/weight, length, here and of what varies, shape (nodes,) each.
        free: False where a degree of freedom is held, shape (nodes, dofs).
        chains: number of nodes of each chain (one 0-D system is a chain of one node).
        loads: time-dependent loads, or None.
        reference: values of a regular configuration, shape (nodes, rows).
        joints: between nodes, or nodes and the ground.
        springs: springs and dampers, likewise.
        contact: what touches, or None.
        account: whether a run keeps account of the work of loads, whatever else it does.
        members: of several densities, the system of each, without loads, joints and springs; else none.
        plans: what steppers have prepared for it, by their names; another system made from this one has none.
    """

    equations: DiscreteEquations
    kernels: Kernels
    uniforms: np.ndarray
    named: Mapping[str, np.ndarray]
    free: np.ndarray
    chains: tuple[int, ...]
    loads: LoadEntries | None = None
    reference: np.ndarray
    joints: tuple[Coupling, ...] = ()
    springs: tuple[Elastic, ...] = ()
    contact: Touching | None = None
    account: bool = False
    members: tuple["System", ...] = ()
    plans: dict[str, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def layout(self) -> Layout:
        """Rows of a node."""
        return self.equations.layout

    @property
    def size(self) -> int:
        """Number of nodes."""
        return sum(self.chains)

    @property
    def groups(self) -> tuple["System", ...]:
        """The system of every density; of a single one, the system itself."""
        return self.members or (self,)

    @property
    def spans(self) -> list[tuple["System", slice]]:
        """The groups, each with its nodes among all."""
        return list(zip(self.groups, _behind([group.size for group in self.groups]), strict=True))

    @property
    def cell_spans(self) -> list[slice]:
        """Cells of the groups among all."""
        return _behind([group.cells for group in self.groups])

    @property
    def with_forces(self) -> bool:
        """Whether there are forces beside a Lagrangian."""
        return any(group.equations.density.force is not None for group in self.groups)

    @property
    def with_constraints(self) -> bool:
        """Whether a density has constraints."""
        return any(group.equations.density.constraints.numel() for group in self.groups)

    @property
    def accounted(self) -> bool:
        """Whether a run keeps an account of work and loss: on request, with forces beside the Lagrangian or drives."""
        driven = any(joint.drive is not None for joint in self.joints)
        return self.account or self.damped or driven or self.contact is not None

    @property
    def damped(self) -> bool:
        """Whether forces may depend on velocities: those beside the Lagrangian, and dampers."""
        return self.with_forces or any(spring.damped for spring in self.springs)

    @property
    def cells(self) -> int:
        """Number of lanes that kernels of explicit rules work on: one for every element and one to close each chain."""
        cell = self.equations.rule.cell
        return sum((count - 1) // cell + 1 for count in self.chains)

    @property
    def slots(self) -> np.ndarray:
        """Where each node is among those of all cells, cell × nodes of a cell + position in it, shape (nodes,)."""
        cell = self.equations.rule.cell
        padding = np.repeat(np.arange(len(self.chains)), self.chains) * (cell - 1)
        return np.arange(self.size) + padding

    @property
    def nodes(self) -> np.ndarray:
        """Coordinates of the nodes along the interval [m], shape (nodes,)."""
        return self.named["here"]

    def values_of(self, name: str, place: int = 0) -> np.ndarray:
        """An input of the programs at every node, such as "c.mass" or "inverse", uniform or not.

        Args:
            name: its name.
            place: of the element that begins at the node: its strain point, or node of its cell (see discrete.places).

        Returns: shape (nodes,); where no element begins, values without meaning.
        """
        for key in (name_at(name, place), name):
            if key in self.named:
                return self.named[key]
        return np.full(self.size, self.uniforms[self.equations.uniforms.index(name)])

    def stable_dt(self, state: State | None = None, *, enough: float = np.inf) -> float:
        """Largest stable time step of an explicit rule [s], for the system linearized about a state.

        h = 2/ω_max, with ω_max an upper bound of the highest frequency: guaranteed, and sharp to 2 %; with forces that
        depend on velocities also h ≤ 2/δ_max, δ_max their highest rate of decay.

        Args:
            state: the state; without one a straight, unstrained reference.
            enough: a step [s] that would do: a limit found to be above it need not be sharp.

        Returns: the step [s]; infinite for a system without strain, load and springs, and for implicit rules; not a
            number where a spring has no derivatives.
        """
        if self.equations.rule.implicit:
            return float("inf")
        from cayley.system.contact_limits import with_contact
        from cayley.system.stability import stable_dt

        if state is None or not self.with_forces:
            limit = stable_dt(self, self.reference if state is None else state.values, enough=enough)
        else:
            from cayley.system.legendre import velocities_of

            limit = stable_dt(self, state.values, velocities_of(self, state), enough=enough)
        return limit if self.contact is None else with_contact(self, limit)

    def __str__(self) -> str:
        """Describe rule, structure and size."""
        if self.members:
            return "\n".join(map(str, self.members))
        e = self.equations
        nodes = f"{self.size} node{'s' if self.size > 1 else ''}"
        head = f"{e.density.lagrangian} under the rule {e.rule} ({self.layout.representation.name} form)"
        size = f"{nodes}, {self.size * self.layout.dofs} degrees of freedom, {self.kernels.lanes} lanes"
        return f"{head}\n  {size}\n  {e.structure}"


def _behind(counts: Sequence[int]) -> list[slice]:
    """Stretches of so many, each behind the one before."""
    edges = [0, *itertools.accumulate(counts)]
    return [slice(a, b) for a, b in itertools.pairwise(edges)]


def split(system: System, state: State) -> list[tuple[System, State]]:
    """The groups of a system, each with its part of a state."""
    if not system.members:
        return [(system, state)]
    found = []
    for (group, nodes), cells in zip(system.spans, system.cell_spans, strict=True):
        work = None if state.work is None else state.work[cells]
        found.append((group, replace(state, values=state.values[nodes], momenta=state.momenta[nodes], work=work)))
    return found


def joined(arrays: Sequence[np.ndarray], axis: int = 0) -> np.ndarray:
    """Arrays of all groups as one; of a single one without a copy."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays, axis=axis)


def pack(system: System, state: State) -> np.ndarray:
    """Blocks of lanes for the kernels.

    Args:
        system: a system of one density.
        state: its state.

    Returns: shape (blocks + 2, rows, lanes), aligned to 64 bytes; the first and last block are padding.
    """
    rows, layout, lanes = system.equations.rows, system.layout, system.kernels.lanes
    data = aligned((-(-system.cells // lanes) + 2, rows.count, lanes))
    data[:] = 0.0
    for name, row in rows.named.items():  # constants of a node that there is: arbitrary ones may make no inertia
        constant = name.startswith("c.")
        data[:, row] = 0.0 if name == "length" else system.named[name][-1] if constant else 1.0
    data[:, rows.held] = 1.0
    put_state(system, data, state)
    _scatter_nodes(system, data, rows.held, system.free.astype(float), np.ones(layout.dofs))
    first = np.flatnonzero(system.slots % rows.cell == 0)
    for name, row in rows.named.items():
        value = np.asarray(system.named[name])
        value = np.add.reduceat(value, first) if name == "length" else value[first]
        scatter(data, slice(row, row + 1), value[:, None])
    return data


def put_state(system: System, data: np.ndarray, state: State) -> None:
    """Write a state into blocks that have the constants of the nodes."""
    rows = system.equations.rows
    data[:, rows.values] = np.tile(state.values[-1], rows.cell)[None, :, None]  # padding: a node at rest, no element
    _scatter_nodes(system, data, rows.values, state.values, state.values[-1])
    _scatter_nodes(system, data, rows.momenta, state.momenta, np.zeros(system.layout.dofs))
    if rows.forced and state.work is not None:
        scatter(data, rows.forced["account"], state.work)


def _scatter_nodes(system: System, data: np.ndarray, rows: slice, values: np.ndarray, rest: np.ndarray) -> None:
    """Write values of nodes, shape (nodes, width), into the cells of blocks, and rest where a cell has no node."""
    cell = system.equations.rows.cell
    if cell > 1:
        by_slot = np.tile(rest, (system.cells * cell, 1))
        by_slot[system.slots] = values
        values = by_slot.reshape(system.cells, -1)
    scatter(data, rows, values)


def by_node(system: System, blocks: np.ndarray, rows: slice) -> np.ndarray:
    """Rows of blocks by node: (..., blocks, rows, lanes) -> (..., nodes, len(rows) / nodes of a cell)."""
    cell = system.equations.rows.cell
    found = gather(blocks, rows, system.cells)
    if cell == 1:
        return found
    return found.reshape(*found.shape[:-2], system.cells * cell, -1)[..., system.slots, :]


def gather(blocks: np.ndarray, rows: slice, size: int) -> np.ndarray:
    """Rows of blocks by lane: (..., blocks, rows, lanes) -> (..., size, len(rows)); no padding blocks."""
    part = np.moveaxis(blocks[..., rows, :], -2, -1)
    return np.ascontiguousarray(part.reshape(*part.shape[:-3], -1, part.shape[-1])[..., :size, :])


def aligned(shape: tuple[int, ...]) -> np.ndarray:
    """An uninitialized array of doubles that starts at a multiple of 64 bytes."""
    count = int(np.prod(shape))
    raw = np.empty(count + 8)
    start = (-raw.ctypes.data // 8) % 8
    return raw[start : start + count].reshape(shape)


def scatter(data: np.ndarray, rows: slice, values: np.ndarray) -> None:
    """Write values of nodes, shape (nodes, len(rows)), into blocks."""
    nodes, width = values.shape
    lanes = data.shape[2]
    full = nodes // lanes
    data[1 : full + 1, rows] = np.moveaxis(values[: full * lanes].reshape(full, lanes, width), 1, 2)
    if nodes % lanes:
        data[full + 1, rows, : nodes % lanes] = values[full * lanes :].T
