"""Systems at rest, or in a frame that turns: forces, their derivatives and corrections, by the compiled engine."""

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.sparse import csc_array

from cayley.discrete.rules import CORNERS
from cayley.steppers import problem
from cayley.steppers.cells import constraint_cells, term_cells
from cayley.steppers.implicit_run import element_groups, load_entries
from cayley.steppers.native import address
from cayley.steppers.problem import Plan
from cayley.system.system import State, System
from cayley.system.tables import INSTANT

FAINT = 1e-12
"""Kinds of degrees of freedom with less of the largest stiffness count as without any."""


def make_plan(system: System) -> Plan:
    """All terms and constraints of a system, at one "stage" that is the equilibrium itself."""
    if "still" in system.plans:
        return system.plans["still"]
    nodes = np.arange(system.size)
    cells = term_cells(system), constraint_cells(system, nodes)
    plan = problem.make_plan(system, nodes, CORNERS, element_groups(system), *cells)
    zero, one = np.zeros(2), np.ones(1)
    tables = {"ell": np.array([[0.0, 1.0]]), "dell": np.zeros((1, 2)), "weights": one, "at": np.zeros(1), "ends": zero}
    plan = replace(plan, tables={**plan.tables, **tables})
    system.plans["still"] = plan
    return plan


@dataclass(slots=True)
class Still:
    """A system at given values, with multipliers: what Newton's method for an equilibrium works on.

    Unknowns are corrections of nodes (left-trivialized) and multipliers, in the order of elimination; ``force`` is what
    acts on them [N, N m] and how far constraints are violated, and vanishes at an equilibrium.

    Args:
        made: the arrays.
        spin: angular velocity of the frame [rad/s], shape (3,), about the origin, or None.
    """

    made: problem.Problem
    spin: np.ndarray | None = None

    @classmethod
    def at(cls, system: System, values: np.ndarray, time: float = 0.0, spin: np.ndarray | None = None) -> "Still":
        """Begin at values of all nodes, shape (nodes, rows), and a time [s], with multipliers zero.

        Raises:
            ValueError: if the system has contact.
        """
        if system.contact is not None:
            raise ValueError(
                "statics and vibration know no contact; cy.settle brings a model with contact to rest, or leave it out "
                "with model.replace(obstacles=[], contact=None)"
            )
        plan, layout = make_plan(system), system.layout
        blank = State(values=values, momenta=np.zeros((system.size, layout.dofs)), origin=time, h=1.0)
        entries, scales = load_entries(system)
        more: dict[str, Any] = {"entries": entries, "scales": scales, "watch": 0, "still": 1}
        more["penalty"] = np.ones(layout.dofs)
        if spin is not None:
            more["spin"] = generator(system, spin)
        made = problem.make_problem(plan, blank, 1, 1, more)
        found = cls(made, spin)
        found.made.arrays["control"][1] = found.made.arrays["control"][0]
        for term in made.alive[0]:
            term["held"][:] = 1  # settle holds more than supports do
        found.set_time(time)
        found._scale()
        return found

    @property
    def system(self) -> System:
        """The system."""
        return self.made.plan.system

    @property
    def values(self) -> np.ndarray:
        """Values of all nodes, shape (nodes, rows)."""
        return self.made.arrays["control"][1, :-1].copy()

    @property
    def multipliers(self) -> np.ndarray:
        """All multipliers, flat."""
        return np.concatenate([np.zeros(0), *(c["multiplier"].reshape(-1) for c in self.made.couplings)])

    @property
    def time(self) -> float:
        """Time at which loads and prescribed motions are taken [s]."""
        return float(self.made.arrays["time"])

    @property
    def dofs(self) -> np.ndarray:
        """Unknown of every degree of freedom, shape (nodes, dofs)."""
        return self.made.arrays["place"][:, None] + np.arange(self.system.layout.dofs)

    @property
    def spots(self) -> np.ndarray:
        """Unknowns of all multipliers, as ``multipliers``."""
        found = [np.zeros(0, dtype=np.int64)]
        for coupling in self.made.couplings:
            together = coupling["multiplier"].shape[2]
            found.append((coupling["spot"][:, None] + np.arange(together)).reshape(-1))
        return np.concatenate(found)

    @property
    def free(self) -> np.ndarray:
        """Unknowns of degrees of freedom that are not held, in the order of nodes."""
        return self.dofs[self.system.free]

    def put(self, values: np.ndarray, multipliers: np.ndarray) -> None:
        """Set values of all nodes, and all multipliers."""
        self.made.arrays["control"][1, :-1] = values
        first = 0
        for coupling in self.made.couplings:
            own = coupling["multiplier"]
            own[:] = multipliers[first : first + own.size].reshape(own.shape)
            first += own.size

    def set_time(self, time: float) -> None:
        """Take loads and prescribed motions at a time [s]."""
        loads, made = self.system.loads, self.made
        made.arrays["time"] = np.asarray(time)
        if loads is not None:
            made.arrays["table"] = np.ascontiguousarray(loads.table.at_stages(np.array([[time]]), INSTANT, time))
            made.struct.table, made.struct.columns = made.arrays["table"].ctypes.data, loads.columns
            made.arrays["whole table"] = made.arrays["table"].copy()
        for cells, coupling in zip(made.plan.constraints, made.couplings, strict=True):
            if cells.drive is not None:
                coupling["drive"][0] = cells.drive(np.full(2, time))

    def set_constants(self, values: Sequence[Mapping[str, float]]) -> None:
        """Give constants that are equal everywhere in a density other values, by their labels ("c.gravity[2]").

        Args:
            values: for each density of the system.
        """
        for cells, term in zip(self.made.plan.terms, self.made.alive[0], strict=True):
            if cells.group is None:
                continue
            equations, given = self.system.groups[cells.group].equations, values[cells.group]
            names = (name for name in equations.density.names if name not in equations.varying)
            for k, name in enumerate(names):
                if name in given:
                    term["uniforms"][:, 1 + k] = term["light_uniforms"][:, 1 + k] = given[name]

    def put_on(self, share: float) -> None:
        """Take a share of all point and line loads, as they are at this time."""
        if self.system.loads is not None:
            self.made.arrays["table"][:] = share * self.made.arrays["whole table"]

    def force(self) -> np.ndarray:
        """Forces on the unknowns, and violations with the other sign (see struct problem), shape (unknowns,)."""
        return self._assemble(tangent=False)

    def tangent(self, *, inertia: float = 0.0) -> tuple[np.ndarray, bool]:
        """Forces, and their derivative factorized; inertia: a mass matrix by which stiffness is raised [1/s²].

        Returns: the forces, and whether the derivative is regular.
        """
        force = self._assemble(tangent=True)
        if inertia:
            self._call("add_inertia", ctypes.c_double(self.time), ctypes.c_double(-inertia))
        return force, self._factorize()

    def _factorize(self) -> bool:
        """Factorize the matrix; returns whether it is regular."""
        arrays, fronts = self.made.arrays, ctypes.c_int64(self.made.plan.blocks.fronts)
        return not self.made.engine.factorize(fronts, address(arrays["matrix"]), address(arrays["pivots"]), None)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution of K x = right, with the factorized tangent of equilibrium K."""
        x, arrays = np.array(right, dtype=float), self.made.arrays
        fronts = ctypes.c_int64(self.made.plan.blocks.fronts)
        self.made.engine.solve(fronts, address(arrays["matrix"]), address(arrays["pivots"]), address(x))
        return x

    def settle(self, fade: np.ndarray | None = None, *, inertia: float = 0.0) -> np.ndarray | None:
        """Correction of positions and multipliers alone, rotations being what they are; None where it is singular.

        Strains are linear in positions: this takes out at once what a finite turn stretches, and Newton's method sees
        the forces in a slender rod, not those of its own last correction.

        Args:
            fade: forces that are subtracted.
            inertia: a mass matrix by which stiffness is raised [1/s²].
        """
        free, layout = self.made.arrays["free"], self.system.layout
        kept = free.copy()
        for name in layout.rotations:
            free[:, layout.dofs_of(name)] = 0.0
        force = self._assemble(tangent=True)
        if inertia:
            self._call("add_inertia", ctypes.c_double(self.time), ctypes.c_double(-inertia))
        idle = self._idle()
        self.made.arrays["matrix"][self.made.arrays["diagonal"][idle]] = 1.0
        right = -force if fade is None else fade - force
        right[self.dofs[free[:-1] == 0.0]] = right[idle] = 0.0
        regular = self._factorize()
        free[:] = kept
        return self.solve(right) if regular else None

    def _idle(self) -> np.ndarray:
        """Multipliers of constraints in which nothing may move."""
        found, dofs = [np.zeros(0, dtype=np.int64)], np.arange(self.system.layout.dofs)
        for coupling in self.made.couplings:
            along, together = coupling["along"], np.arange(coupling["multiplier"].shape[2])
            where = along[..., 0, None, None] + along[..., 1, None, None] * together[:, None] + dofs
            slopes = self.made.arrays["matrix"][np.maximum(where, 0)] * (along[..., 0, None, None] >= 0)
            resting = ~np.any(slopes != 0.0, axis=(1, 3))
            found.append((coupling["spot"][:, None] + together)[resting])
        return np.concatenate(found)

    def move(self, x: np.ndarray, part: float = 1.0) -> None:
        """Correct values and multipliers by part of x."""
        x = np.ascontiguousarray(x)
        self._call("move", address(x), ctypes.c_double(part))
        self.put(self.values, self.multipliers + part * x[self.spots])
        self._call("hold")

    def measure(self, x: np.ndarray) -> tuple[float, float, int]:
        """Size of a correction (radians, lengths over the extent), its largest turn [rad], and its node."""
        x, turn, worst = np.ascontiguousarray(x), ctypes.c_double(0.0), ctypes.c_int64(0)
        self.made.engine.measure.restype = ctypes.c_double
        size = self._call("measure", address(x), ctypes.byref(turn), ctypes.byref(worst))
        return float(size), turn.value, worst.value

    def fastest(self) -> float:
        """Largest stiffness over mass of a degree of freedom [1/s²]: the square of about the highest frequency.

        Forces count, too, as if they changed by themselves over the extent of the system, or over a radian.
        """
        force = np.abs(self._assemble(tangent=True))
        lengths = np.ones_like(force)
        for is_rotation, _, first, size in self.made.arrays["field"]:
            lengths[self.dofs[:, first : first + size]] = 1.0 if is_rotation else 1.0 / self.made.struct.extent
        stiffness = np.abs(self.made.arrays["matrix"][self.made.arrays["diagonal"]]) + force / lengths
        mass = -self.matrix(2).diagonal()[self.free]
        return float((stiffness[self.free] / mass)[mass > 0.0].max(initial=0.0))

    def unstable(self, *, inertia: float = 0.0) -> int:
        """Number of independent motions along which the second variation is negative: 0 at a stable equilibrium.

        By the inertia of the saddle-point matrix: with n free unknowns and m multipliers it has m eigenvalues of either
        sign and those of the stiffness on the motions that the constraints allow. Forces are taken as conservative.

        Args:
            inertia: mass matrices by which stiffness is raised [1/s²].
        """
        self._assemble(tangent=True)
        if inertia:
            self._call("add_inertia", ctypes.c_double(self.time), ctypes.c_double(-inertia))
        arrays, count = self.made.arrays, ctypes.c_int64(0)
        self.made.engine.negatives(
            ctypes.c_int64(self.made.plan.blocks.fronts),
            address(arrays["matrix"]),
            address(arrays["pivots"]),
            ctypes.byref(count),
        )
        held = int((~self.system.free).sum())
        return len(arrays["unknown"]) - held - len(self.spots) - count.value

    def matrix(self, order: int = 0) -> csc_array:
        """Derivative of the forces along values (0), rates (1) or accelerations (2), rows and columns by unknowns.

        Order 0 has the derivatives of constraints beside it, order 1 is −C − G, order 2 −M.
        """
        rows, columns, where = self._pattern()
        self.made.struct.order = order
        saved = self.made.arrays["penalty"]
        self.made.struct.penalty = None
        self._assemble(tangent=True)
        self.made.struct.order, self.made.struct.penalty = 0, saved.ctypes.data
        size = len(self.made.arrays["unknown"])
        found = csc_array((self.made.arrays["matrix"][where], (rows, columns)), shape=(size, size))
        found.eliminate_zeros()
        return found

    def _pattern(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows, columns and places in the matrix of all entries that terms and constraints may fill."""
        plan, arrays = self.made.plan, self.made.arrays
        dofs = np.arange(self.system.layout.dofs)
        found = []
        for cells, places in [
            *((cells, term["places"]) for cells, term in zip(plan.terms, self.made.alive[0], strict=True)),
            *((cells, own["places"]) for cells, own in zip(plan.constraints, self.made.couplings, strict=True)),
        ]:
            first = arrays["place"][np.minimum(cells.nodes, plan.size - 1)]
            shape = places.shape[:-1]
            row = np.broadcast_to(first[:, :, None], shape)
            column = np.broadcast_to(first[:, None, :], shape)
            found.append(_entries(places.reshape(-1, 2), row.reshape(-1), column.reshape(-1), dofs, dofs))
        for cells, own in zip(plan.constraints, self.made.couplings, strict=True):
            together = np.arange(own["multiplier"].shape[2])
            first = arrays["place"][np.minimum(cells.nodes, plan.size - 1)].reshape(-1)
            spot = np.repeat(own["spot"], cells.nodes.shape[1])
            found.append(_entries(own["across"].reshape(-1, 2), first, spot, dofs, together))
            found.append(_entries(own["along"].reshape(-1, 2), spot, first, together, dofs))
        rows, columns, where = (np.concatenate(part) for part in zip(*found, strict=True))
        where, unique = np.unique(where, return_index=True)
        return rows[unique], columns[unique], where

    def _assemble(self, *, tangent: bool) -> np.ndarray:
        self._call("assemble", ctypes.c_int64(0), *map(ctypes.c_double, (self.time, 1.0)), ctypes.c_int64(tangent))
        return -self.made.arrays["unknown"]

    def _scale(self) -> None:
        """What stiffness constraints are given: the largest of rotations and of vectors."""
        if not self.made.couplings:
            return
        self.made.struct.penalty, saved = None, self.made.arrays["penalty"]
        self._assemble(tangent=True)
        diagonal = np.abs(self.made.arrays["matrix"][self.made.arrays["diagonal"]])[self.dofs]
        largest = np.where(self.system.free, diagonal, 0.0).max(axis=0)
        for field in self.made.arrays["field"]:
            own = slice(field[2], field[2] + field[3])
            largest[own] = largest[own].max()
        saved[:] = np.where(largest > FAINT * largest.max(initial=0.0), largest, 1.0)
        self.made.struct.penalty = saved.ctypes.data

    def _call(self, name: str, *arguments: Any) -> Any:
        return getattr(self.made.engine, name)(ctypes.byref(self.made.struct), *arguments)


def generator(system: System, spin: np.ndarray) -> np.ndarray:
    """S of dq/dt = S q for nodes that turn about the origin: ẋ = Ω × x, ṗ = ½ Ω p, shape (rows, rows)."""
    layout, (x, y, z) = system.layout, np.asarray(spin, dtype=float)
    found = np.zeros((layout.rows, layout.rows))
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    for name, kind in layout.fields.items():
        rows = layout.rows_of(name)
        if name in layout.rotations:
            found[rows, rows] = 0.5 * np.block(
                [[np.zeros((1, 1)), -np.array([[x, y, z]])], [np.array([[x], [y], [z]]), cross]]
            )
        elif kind.size == 3:
            found[rows, rows] = cross
    return found


def _entries(
    places: np.ndarray, row: np.ndarray, column: np.ndarray, down: np.ndarray, across: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and places of all entries of blocks at (offset, stride), without those of the ground."""
    known = places[:, 0] >= 0
    offset, stride = (places[known, k, None, None] for k in (0, 1))
    shape = (int(known.sum()), len(down), len(across))
    rows = np.broadcast_to(row[known, None, None] + down[:, None], shape)
    columns = np.broadcast_to(column[known, None, None] + across, shape)
    where = np.broadcast_to(offset + down[:, None] * stride + across, shape)
    return rows.reshape(-1), columns.reshape(-1), where.reshape(-1)
