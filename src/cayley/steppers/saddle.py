"""Constraints of a system at one time: how far they are violated, momenta that agree with them, and their forces."""

import ctypes
from dataclasses import dataclass, replace

import numpy as np

from cayley.discrete.rules import CORNERS
from cayley.steppers import problem
from cayley.steppers.cells import Cells, constraint_cells, inertia_cells
from cayley.steppers.problem import Plan
from cayley.system.couplings import Coupling, Elastic
from cayley.system.system import State, System
from cayley.system.turned import as_quaternions, embedded


def constrained_nodes(system: System) -> np.ndarray:
    """Nodes that constraints, springs and dampers know: all of a density with constraints, of others those of ties.

    Of several densities, or with contact, there is one at least: then a run that nothing ties together is that of a
    problem, too.
    """
    ties: list[Coupling | Elastic] = [*system.joints, *system.springs]
    found = {node for tie in ties for node in (tie.first, tie.second) if node >= 0}
    for group, nodes in system.spans:
        if group.with_constraints:
            found.update(range(nodes.start, nodes.stop))
    alone = system.members or system.contact is not None
    return np.array(sorted(found or {0} if alone else found), dtype=np.int64)


def make_plan(system: System, terms: list[Cells] | None = None) -> Plan:
    """The problem of the constrained nodes of a system, one block each."""
    nodes = constrained_nodes(system)
    cells = [*inertia_cells(system, nodes), *(terms or [])]
    return problem.make_plan(system, nodes, CORNERS, np.arange(len(nodes)), cells, constraint_cells(system, nodes))


def is_constrained(system: System) -> bool:
    """Whether a system has any constraint."""
    return bool(system.with_constraints or system.joints)


def violation(system: System, values: np.ndarray, time: float = 0.0) -> list[tuple[Cells, np.ndarray]]:
    """The constraints g of all cells, shape (cells, gauss × count) for each kind of them."""
    values, system = as_quaternions(system.layout, values), embedded(system)
    state = State(values=values, momenta=np.zeros((len(values), system.layout.dofs)), origin=time, h=1.0)
    made = problem.make_problem(make_plan(system), state, 1, 1)
    engine = made.engine
    engine.violations.restype = ctypes.c_double
    engine.violations(ctypes.byref(made.struct), *_words(0, 0), ctypes.c_double(time))
    return _multipliers(made)


def largest_violation(system: System, values: np.ndarray, time: float = 0.0) -> float:
    """The largest constraint of all, in the units of each."""
    return max((float(np.abs(found).max()) for _, found in violation(system, values, time)), default=0.0)


def projected(system: System, state: State) -> tuple[np.ndarray, int]:
    """Momenta μ − Gᵀ ν whose velocities agree with the constraints; and the node of a redundant one, or −1."""
    plan = make_plan(embedded(system))
    begin = replace(state, values=as_quaternions(system.layout, state.values))
    made = problem.make_problem(plan, begin if begin.h else begin.at_step(1.0), 1, 1)
    time = ctypes.c_double(state.time)
    failed = made.engine.project(ctypes.byref(made.struct), *_words(0, 0), time, ctypes.c_double(made.struct.h))
    if failed:
        return state.momenta, int(plan.nodes[np.flatnonzero(plan.block_of == failed - 1)[0]])
    momenta = state.momenta.copy()
    momenta[plan.nodes] = made.arrays["momenta"][:-1]
    return momenta, -1


@dataclass(frozen=True, slots=True)
class Reactions:
    """Solution of M a + Gᵀ ν = f, G a = s.

    Args:
        acceleration: a, shape (nodes, dofs); zero at nodes without constraints.
        multipliers: ν of every kind of cells, shape (cells, gauss × count).
        forces: −Gᵀ ν on the nodes of every cell, shape (cells, gauss × count, width, dofs), for every kind.
    """

    acceleration: np.ndarray
    multipliers: list[tuple[Cells, np.ndarray]]
    forces: list[np.ndarray]


def saddle_problem(system: System) -> problem.Problem:
    """What reactions() works on, for any number of calls."""
    blank = State(values=system.reference, momenta=np.zeros((system.size, system.layout.dofs)), h=1.0)
    return problem.make_problem(make_plan(system), blank, 1, 1)


def reactions(
    made: problem.Problem, values: np.ndarray, time: float, force: np.ndarray, rates: list[np.ndarray]
) -> Reactions:
    """Multipliers that give accelerations the constraints allow.

    Args:
        made: by saddle_problem; it is overwritten.
        values: of all nodes, shape (nodes, rows).
        time: the time [s].
        force: f on every node, left-trivialized, shape (nodes, dofs).
        rates: s of every kind of cells, shape (cells, gauss × count).

    Returns: the Reactions; not numbers where the constraints are redundant, as at a dead center.
    """
    plan, call = made.plan, ctypes.byref(made.struct)
    made.arrays["control"][0, : plan.size] = values[plan.nodes]
    for cells, arrays in zip(plan.constraints, made.couplings, strict=True):
        if cells.drive is not None:
            arrays["drive"][0, 0] = cells.drive(np.array([time]))[0]
    failed = made.engine.saddle_point(call, *_words(0, 0), ctypes.c_double(time))
    unknown, place = made.arrays["unknown"], made.arrays["place"]
    unknown[:] = 0.0
    dofs = np.arange(plan.system.layout.dofs)
    unknown[place[:, None] + dofs] = np.where(plan.system.free, force, 0.0)[plan.nodes]
    for arrays, rate in zip(made.couplings, rates, strict=True):
        unknown[arrays["spot"][:, None] + np.arange(rate.shape[1])] = rate
    addresses = [ctypes.c_void_p(made.arrays[name].ctypes.data) for name in ("matrix", "pivots", "unknown")]
    made.engine.solve(ctypes.c_int64(plan.blocks.fronts), *addresses)
    if failed:
        unknown[:] = np.nan
    acceleration = np.zeros_like(force)
    acceleration[plan.nodes] = unknown[place[:, None] + dofs]
    multipliers = _multipliers(made)
    forces = []
    for (cells, found), arrays in zip(multipliers, made.couplings, strict=True):
        slopes = np.moveaxis(arrays["slopes"], -1, 1)  # (blocks, lanes, together, width, dofs)
        slopes = slopes.reshape(-1, *slopes.shape[2:])[: len(cells.nodes)]
        forces.append(-found[:, :, None, None] * slopes)
    return Reactions(acceleration, multipliers, forces)


def _multipliers(made: problem.Problem) -> list[tuple[Cells, np.ndarray]]:
    found = []
    for cells, arrays in zip(made.plan.constraints, made.couplings, strict=True):
        together = np.arange(cells.gauss * cells.count)
        found.append((cells, made.arrays["unknown"][arrays["spot"][:, None] + together]))
    return found


def _words(*numbers: int) -> list[ctypes.c_int64]:
    return [ctypes.c_int64(number) for number in numbers]
