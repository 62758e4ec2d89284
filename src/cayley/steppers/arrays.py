"""Cells as the arrays of struct term and struct coupling of engine.h, laid out in lanes."""

from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.codegen.kernels import Kernel
from cayley.steppers.cells import Cells
from cayley.system.system import State, aligned

if TYPE_CHECKING:
    from cayley.steppers.problem import Plan


def term_arrays(plan: "Plan", cells: Cells) -> dict[str, Any]:
    """Fields of struct term."""
    full, light = cells.kernels
    rows = cells.programs[0].rows
    gradient = len(cells.programs[0].lanes) + (not cells.force)  # behind the value
    return _shared(plan, cells, plan.stages) | {
        "run": full.run,
        "setup": full.setup,
        "light_run": light.run,
        "light_setup": light.setup,
        "data": _zeros((plan.stages, cells.gauss, rows, plan.lanes)),
        "rows": rows,
        "light_rows": cells.programs[1].rows,
        "rates": int(cells.rates),
        "rated": int(cells.rated),
        "gradient": gradient,
        "force": int(cells.force),
        "account": gradient + cells.slots * plan.system.layout.rows if cells.accounted else -1,
        "work": np.zeros(2),
        "held": _held(plan, cells),
    }


def coupling_arrays(
    plan: "Plan", cells: Cells, which: int, steps: int, state: State, starts: np.ndarray
) -> dict[str, Any]:
    """Fields of struct coupling; which is its number."""
    full, light = cells.kernels
    rows, layout = cells.programs[0].rows, plan.system.layout
    together, multipliers = cells.gauss * cells.count, len(cells.programs[0].lanes) - cells.count
    owner, _ = plan.multipliers[which]
    blocks = np.where(cells.nodes < plan.size, plan.block_of[np.minimum(cells.nodes, plan.size - 1)], -1)
    own = np.repeat(owner[:, None], blocks.shape[1], axis=1)
    count = len(cells.nodes)
    padded = -(-count // plan.lanes) * plan.lanes
    shape = (count, plan.stages, together)
    slopes = (padded // plan.lanes, together, cells.nodes.shape[1], layout.dofs, plan.lanes)
    return (
        _shared(plan, cells, plan.stages + 1)
        | _drives(plan, cells, steps, state, padded)
        | coupling_places(plan, cells, which, starts)
        | {
            "run": full.run,
            "setup": full.setup,
            "light_run": light.run,
            "light_setup": light.setup,
            "data": _zeros((plan.stages + 1, cells.gauss, rows, plan.lanes)),
            "rows": rows,
            "light_rows": cells.programs[1].rows,
            "slopes": _zeros(slopes),
            "multiplier_row": multipliers,
            "count": cells.count,
            "alternating": int(cells.alternating),
            "value": multipliers + cells.count,
            "gradient": multipliers + 2 * cells.count,
            "inside": (blocks == own).astype(np.int64),
            "multiplier": np.zeros(shape),
            "start": np.zeros(shape),
            "kept": np.zeros(shape),
        }
    )


def coupling_places(plan: "Plan", cells: Cells, which: int, starts: np.ndarray) -> dict[str, np.ndarray]:
    """Where constraints stand in the matrix, and their multipliers among the unknowns."""
    owner, base = plan.multipliers[which]
    inside = np.minimum(cells.nodes, plan.size - 1)
    blocks = np.where(cells.nodes < plan.size, plan.block_of[inside], -1)
    own = np.repeat(owner[:, None], blocks.shape[1], axis=1)
    across, along = plan.blocks.locate(blocks, own), plan.blocks.locate(own, blocks)
    inner = plan.base[inside]
    for found, row, column in ((across, inner, base[:, None]), (along, base[:, None], inner)):
        found[..., 0] = np.where(found[..., 0] < 0, -1, found[..., 0] + row * found[..., 1] + column)
    return {"across": across, "along": along, "spot": starts[owner] + base, "places": places(plan, cells.nodes)}


def _drives(plan: "Plan", cells: Cells, steps: int, state: State, padded: int) -> dict[str, Any]:
    """Prescribed motions and their rates at the control times of all steps."""
    driver = np.full(padded, -1, dtype=np.int64)
    if cells.drive is None or cells.driver is None:
        nothing = np.zeros(1)
        return {"drives": 0, "driver": driver, "driven": 0, "drive": nothing, "drive_rate": nothing}
    driver[: len(cells.driver)] = cells.driver
    times = state.origin + (state.step + np.arange(steps)[:, None] + plan.tables["ends"]) * state.h
    shape, step = (*times.shape, int(cells.driver.max()) + 1, -1), 1e-3 * state.h
    values = cells.drive(times.reshape(-1)).reshape(shape)
    ahead, behind = ([cells.drive(times.reshape(-1) + sign * k * step) for k in (1, 2)] for sign in (1, -1))
    rate = (8.0 * (ahead[0] - behind[0]) - (ahead[1] - behind[1])) / (12.0 * step)  # of fourth order
    return {
        "drives": values.shape[3],
        "driver": driver,
        "driven": values.shape[2],
        "drive": np.ascontiguousarray(values),
        "drive_rate": np.ascontiguousarray(rate),
    }


def _shared(plan: "Plan", cells: Cells, times: int) -> dict[str, Any]:
    """Fields that struct term and struct coupling have in common, with room for uniforms at so many times."""
    lanes = plan.lanes
    count, width = cells.nodes.shape
    padded = -(-count // lanes) * lanes
    fill_up = np.minimum(np.arange(padded), count - 1)  # lanes without a cell repeat the last, with no weight
    weight = np.where(np.arange(padded)[:, None] < count, cells.weight[fill_up], 0.0)
    tables = [_uniforms(cells, kernel, times) for kernel in cells.kernels]
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
        "starts": cells.starts,
        "entries": cells.entries,
        "nodes": np.ascontiguousarray(cells.nodes[fill_up], dtype=np.int64),
        "phi": np.ascontiguousarray(cells.phi),
        "psi": np.ascontiguousarray(cells.psi),
        "inverse": _in_lanes(cells.inverse[fill_up], lanes),
        "weight": _in_lanes(weight, lanes),
        "places": places(plan, cells.nodes),
    }


def places(plan: "Plan", nodes: np.ndarray) -> np.ndarray:
    """(offset, stride) in the matrix for every pair of nodes of every cell, −1 at the ground, shape (m, k, k, 2)."""
    inside = np.minimum(nodes, plan.size - 1)
    blocks = np.where(nodes < plan.size, plan.block_of[inside], -1)
    width = nodes.shape[1]
    left, right = np.repeat(blocks[:, :, None], width, axis=2), np.repeat(blocks[:, None, :], width, axis=1)
    found = plan.blocks.locate(left, right)
    base = plan.base[inside]
    inner = base[:, :, None] * found[..., 1] + base[:, None, :]
    found[..., 0] = np.where(found[..., 0] < 0, -1, found[..., 0] + inner)
    return np.ascontiguousarray(found)


def _held(plan: "Plan", cells: Cells) -> np.ndarray:
    """Whether a cell of each block has a held component."""
    held = np.append(~plan.system.free[plan.nodes].all(axis=1), True)[cells.nodes].any(axis=1)
    return np.add.reduceat(held.astype(np.int64), np.arange(0, len(held), plan.lanes))


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
