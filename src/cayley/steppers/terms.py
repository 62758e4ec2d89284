"""Cells of the compiled implicit stepper: where terms and constraints are evaluated, laid out in lanes."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.codegen.kernels import Kernel
from cayley.discrete.places import name_at
from cayley.discrete.program import Program
from cayley.discrete.rules import Points, lagrange, lobatto
from cayley.system.system import State, System, aligned

if TYPE_CHECKING:
    from cayley.steppers.implicit_plan import Plan


@dataclass(frozen=True, slots=True, kw_only=True)
class Cells:
    """Points of one kind at which a kernel is evaluated, several in a cell.

    Args:
        program: the kernel with second derivatives; its rows.
        kernels: it, and the one without, with the rows of their blocks.
        uniforms: values of their uniform inputs behind the time.
        nodes: nodes of every cell, the number of nodes for the ground, shape (cells, width).
        phi: interpolation of values at the points, shape (gauss, width).
        psi: of slopes, shape (gauss, width).
        inverse: factor of psi, shape (cells,).
        weight: of the points, shape (cells, gauss).
        constant: inputs that do not change, shape (cells, gauss, constants).
        rates: whether the kernel sees rates.
        rated: whether it returns derivatives along them.
        slots: 1 for values alone, 2 with slopes (or for two ends).
        count: constraints of a point.
        drive: function (times (m,)) -> (m, driven, drives) of the last constants, or None.
        driver: which driven cell a cell is, or −1, shape (cells,).
    """

    program: Program
    kernels: tuple[tuple[Kernel, int], tuple[Kernel, int]]
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
    count: int = 0
    drive: Any = None
    driver: np.ndarray | None = None

    @property
    def gauss(self) -> int:
        """Points of a cell."""
        return len(self.phi)


def node_cells(system: System) -> Cells:
    """Inertia and loads, at every node."""
    nodes = np.arange(system.size)[:, None]
    return Cells(
        **_kernels(system, "inertia_point", "inertia_point_force"),
        nodes=nodes,
        phi=np.ones((1, 1)),
        psi=np.zeros((1, 1)),
        inverse=np.ones(system.size),
        weight=system.named["weight"][:, None],
        constant=_constants(system, nodes[:, :1], np.zeros((system.size, 1))),
        slots=1,
        rates=True,
        rated=True,
    )


def element_cells(system: System, name: str) -> Cells:
    """Strain, at the points of every element."""
    nodes, lengths, shapes = _elements(system)
    phi, psi, heavy, scaled, along = shapes
    return Cells(
        **_kernels(system, name, f"{name}_force"),
        nodes=nodes,
        phi=phi,
        psi=psi,
        inverse=1.0 / lengths if scaled else np.ones(len(lengths)),
        weight=-np.outer(lengths, heavy),
        constant=_constants(system, np.repeat(nodes[:, :1], len(heavy), axis=1), np.outer(lengths, along)),
        slots=2,
    )


def constraint_cells(system: System) -> Cells:
    """Constraints of the density, at the strain points of every element."""
    nodes, lengths, (phi, psi, heavy, scaled, along) = _elements(system)
    return Cells(
        **_kernels(system, "constraint_point", "constraint_point_slope"),
        nodes=nodes,
        phi=phi,
        psi=psi,
        inverse=1.0 / lengths if scaled else np.ones(len(lengths)),
        weight=np.outer(lengths, heavy),
        constant=_constants(system, np.repeat(nodes[:, :1], len(heavy), axis=1), np.outer(lengths, along)),
        slots=2,
        count=system.equations.density.constraints.numel(),
    )


def _kernels(system: System, full: str, light: str) -> dict[str, Any]:
    equations = system.equations
    known = dict(zip(equations.uniforms, system.uniforms, strict=True))
    programs = [equations.program(name) for name in (full, light)]
    return {
        "program": programs[0],
        "kernels": tuple((system.kernels[n], p.rows) for n, p in zip((full, light), programs, strict=True)),
        "uniforms": np.array([known[n] for n in equations.density.names if n not in equations.varying]),
    }


def _elements(system: System) -> tuple[np.ndarray, np.ndarray, tuple[Any, ...]]:
    """Nodes and lengths of all elements, and φ, φ′, weights, whether φ′ is per unit, and the positions of the points."""
    strain, degree = system.equations.rule.strain, system.equations.rule.degree
    starts, first = [], 0
    for count in system.chains:
        starts.append(first + np.arange(0, count - 1, degree))
        first += count
    nodes = np.concatenate(starts)[:, None] + np.arange(degree + 1)
    lengths = system.named["length"][nodes[:, :-1]].sum(axis=1)
    phi, psi, heavy, scaled = in_space(strain)
    return nodes, lengths, (phi, psi, heavy, scaled, np.zeros(1) if strain.between_ends else np.array(strain.at))


def in_space(strain: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
    """φ, φ′ and weights of the strain points; between ends the kernel takes the two end nodes as they are."""
    if strain.between_ends:
        return np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]]), np.ones(1), False
    phi, psi = lagrange(lobatto(len(strain.at)), strain.at)
    return phi, psi, np.array(strain.weights), True


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


def term_arrays(plan: "Plan", cells: Cells) -> dict[str, Any]:
    """Fields of struct term."""
    lanes, stages = plan.system.kernels.lanes, len(plan.tables["weights"])
    (full, rows), (light, light_rows) = cells.kernels
    inputs = cells.slots * (1 + cells.rates)
    first = inputs * plan.system.layout.rows + cells.constant.shape[-1]
    return _shared(plan, cells, stages) | {
        "run": full.run,
        "setup": full.setup,
        "light_run": light.run,
        "light_setup": light.setup,
        "data": _zeros((stages, cells.gauss, rows, lanes)),
        "rows": rows,
        "light_rows": light_rows,
        "rates": int(cells.rates),
        "rated": int(cells.rated),
        "gradient": first + 1,  # behind the value
        "held": _held(plan, cells),
        "work": 0,
    }


def coupling_arrays(
    plan: "Plan", cells: Cells, which: int, steps: int, state: State, starts: np.ndarray
) -> dict[str, Any]:
    """Fields of struct coupling; which is its number."""
    system = plan.system
    lanes, stages = system.kernels.lanes, len(plan.tables["weights"])
    (full, rows), (light, light_rows) = cells.kernels
    constants, together = cells.constant.shape[-1], cells.gauss * cells.count
    at_constants = cells.slots * system.layout.rows
    owner, base = plan.multipliers[which]
    blocks = np.where(cells.nodes < system.size, plan.block_of[np.minimum(cells.nodes, system.size - 1)], -1)
    own = np.repeat(owner[:, None], blocks.shape[1], axis=1)
    across, along = plan.blocks.locate(blocks, own), plan.blocks.locate(own, blocks)
    inner = plan.base[np.minimum(cells.nodes, system.size - 1)]
    for found, row, column in ((across, inner, base[:, None]), (along, base[:, None], inner)):
        found[..., 0] = np.where(found[..., 0] < 0, -1, found[..., 0] + row * found[..., 1] + column)
    count = len(cells.nodes)
    padded = -(-count // lanes) * lanes
    driver = np.full(padded, -1, dtype=np.int64)
    drive = np.zeros((1, 1, 1, 1))
    if cells.drive is not None and cells.driver is not None:
        driver[:count] = cells.driver
        times = state.origin + (state.step + np.arange(steps)[:, None] + plan.tables["ends"]) * state.h
        values = cells.drive(times.reshape(-1))
        drive = np.ascontiguousarray(values.reshape(steps, stages + 1, *values.shape[1:]), dtype=float)
    shape = (count, stages, together)
    return _shared(plan, cells, stages + 1) | {
        "run": full.run,
        "setup": full.setup,
        "light_run": light.run,
        "light_setup": light.setup,
        "data": _zeros((stages + 1, cells.gauss, rows, lanes)),
        "rows": rows,
        "light_rows": light_rows,
        "drives": drive.shape[3] if cells.drive is not None else 0,
        "driver": driver,
        "driven": drive.shape[2] if cells.drive is not None else 0,
        "drive": drive,
        "multiplier_row": at_constants + constants,
        "count": cells.count,
        "value": at_constants + constants + cells.count,
        "gradient": at_constants + constants + 2 * cells.count,
        "across": across,
        "along": along,
        "spot": starts[owner] + base,
        "multiplier": np.zeros(shape),
        "start": np.zeros(shape),
        "kept": np.zeros(shape),
    }


def _shared(plan: "Plan", cells: Cells, times: int) -> dict[str, Any]:
    """Fields that struct term and struct coupling have in common, with room for uniforms at so many times."""
    lanes = plan.system.kernels.lanes
    count, width = cells.nodes.shape
    padded = -(-count // lanes) * lanes
    fill_up = np.minimum(np.arange(padded), count - 1)  # lanes without a cell repeat the last, with no weight
    weight = np.where(np.arange(padded)[:, None] < count, cells.weight[fill_up], 0.0)
    tables = [_uniforms(cells, kernel, times) for kernel, _ in cells.kernels]
    starts, entries = _hessian(plan, cells)
    return {
        "uniforms": tables[0],
        "uniform_width": tables[0].shape[1],
        "light_uniforms": tables[1],
        "light_width": tables[1].shape[1],
        "constant_row": cells.slots * (1 + cells.rates) * plan.system.layout.rows,
        "constants": cells.constant.shape[-1],
        "constant": _in_lanes(cells.constant[fill_up], lanes),
        "cells": count,
        "width": width,
        "gauss": cells.gauss,
        "slots": cells.slots,
        "starts": starts,
        "entries": entries,
        "nodes": np.ascontiguousarray(cells.nodes[fill_up], dtype=np.int64),
        "phi": np.ascontiguousarray(cells.phi),
        "psi": np.ascontiguousarray(cells.psi),
        "inverse": _in_lanes(cells.inverse[fill_up], lanes),
        "weight": _in_lanes(weight, lanes),
        "places": _places(plan, cells.nodes),
    }


def _places(plan: "Plan", nodes: np.ndarray) -> np.ndarray:
    """(offset, stride) in the matrix for every pair of nodes of every cell, −1 at the ground."""
    size = plan.system.size
    inside = np.minimum(nodes, size - 1)
    blocks = np.where(nodes < size, plan.block_of[inside], -1)
    width = nodes.shape[1]
    left, right = np.repeat(blocks[:, :, None], width, axis=2), np.repeat(blocks[:, None, :], width, axis=1)
    found = plan.blocks.locate(left, right)
    base = plan.base[inside]
    inner = base[:, :, None] * found[..., 1] + base[:, None, :]
    found[..., 0] = np.where(found[..., 0] < 0, -1, found[..., 0] + inner)
    return np.ascontiguousarray(found)


def _hessian(plan: "Plan", cells: Cells) -> tuple[np.ndarray, np.ndarray]:
    """Entries of the Hessian that are not always zero, part by part, from the upper triangle that the kernel stores."""
    rows = plan.system.layout.rows
    parts_in = cells.slots * (1 + cells.rates)
    parts_out = cells.slots * (1 + cells.rated)
    size = parts_in * rows
    first = cells.program.rows - size * (size + 1) // 2
    filled = {row for row, value in cells.program.stores if not value.is_zero()}
    starts, entries = [0], []
    for out in range(parts_out):
        for inner in range(parts_in):
            for i in range(rows):
                for j in range(rows):
                    low, high = sorted((out * rows + i, inner * rows + j))
                    row = first + low * size - low * (low - 1) // 2 + high - low
                    if row in filled:
                        entries.append((i * rows + j, row))
            starts.append(len(entries))
    return np.array(starts, dtype=np.int64), np.array(entries, dtype=np.int64).reshape(-1, 2)


def _held(plan: "Plan", cells: Cells) -> np.ndarray:
    """Whether a cell of each block has a held component."""
    lanes = plan.system.kernels.lanes
    nodes = np.append(~plan.system.free.all(axis=1), True)
    held = nodes[cells.nodes].any(axis=1)
    return np.add.reduceat(held.astype(np.int64), np.arange(0, len(held), lanes))


def _uniforms(cells: Cells, kernel: Kernel, times: int) -> np.ndarray:
    found = np.zeros((times, max(kernel.width, 1 + len(cells.uniforms))))
    found[:, 1 : 1 + len(cells.uniforms)] = cells.uniforms
    return found


def _in_lanes(values: np.ndarray, lanes: int) -> np.ndarray:
    """(cells, ...) -> (blocks, ..., lanes), aligned."""
    blocked = np.moveaxis(values.reshape(-1, lanes, *values.shape[1:]), 1, -1)
    found = aligned(blocked.shape) if blocked.size else np.zeros(blocked.shape)
    found[:] = blocked
    return found


def _zeros(shape: tuple[int, ...]) -> np.ndarray:
    found = aligned(shape)
    found[:] = 0.0
    return found
