"""Run a constrained system of an explicit rule from frame to frame."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cayley.steppers import constrained
from cayley.steppers.outcome import Outcome, Result
from cayley.system.system import State, System, gather, pack, scatter

CHUNK = 20_000
"""Most steps in one call of the driver."""
KERNELS = ("kick", "drift", "violation", "schur", "rate")
_ROWS = ("next", "after", "multiplier", "violation", "left", "right", "diagonal", "coupling", "rate")


@dataclass(frozen=True, slots=True)
class Plan:
    """What the driver needs besides state and loads.

    Args:
        calls: addresses of run and setup of KERNELS, shape (5, 2).
        uniforms: their uniform inputs and room behind them, shape (5, width).
        at: first row and number of values, of momenta; first rows of _ROWS; the row of lengths, shape (14,).
        count: multipliers of an element.
        fixed: (block, row, lane) of momenta that stay zero, shape (m, 3).
        entries: loads: block, lane, row, row of the rotation, form and column, shape (k, 6).
        scales: their factors, shape (k,).
    """

    calls: np.ndarray
    uniforms: np.ndarray
    at: np.ndarray
    count: int
    fixed: np.ndarray
    entries: np.ndarray
    scales: np.ndarray


def make_plan(system: System) -> Plan:
    """Kernels, rows and loads of a system."""
    rows, lanes = system.equations.rows, system.kernels.lanes
    node, dof = np.nonzero(~system.free)
    held = "_held" if len(node) else ""
    names = [name if name in ("kick", "violation") else name + held for name in KERNELS]
    if system.equations.rule.implicit:
        names[:2] = names[3:4] * 2  # that neither kicks nor drifts
    found = [system.kernels[name] for name in names]
    uniforms = np.zeros((len(found), max(kernel.width for kernel in found)))
    uniforms[:, : len(system.uniforms)] = system.uniforms
    first = [rows.values.start, system.layout.rows, rows.momenta.start, system.layout.dofs]
    at = [*first, *(rows.constraint[name].start for name in _ROWS), rows.named["length"]]
    entries, scales = np.zeros((0, 6), dtype=np.int64), np.zeros(0)
    if system.loads is not None:
        loads = system.loads
        columns = [1 + loads.node // lanes, loads.node % lanes, rows.momenta.start + loads.dof]
        entries = np.column_stack([*columns, loads.turn, loads.form, loads.column]).astype(np.int64)
        scales = np.ascontiguousarray(loads.scale)
    return Plan(
        calls=np.array([(kernel.run, kernel.setup) for kernel in found], dtype=np.int64),
        uniforms=uniforms,
        at=np.array(at, dtype=np.int64),
        count=system.equations.density.constraints.numel(),
        fixed=np.column_stack([1 + node // lanes, rows.momenta.start + dof, node % lanes]).astype(np.int64),
        entries=entries,
        scales=scales,
    )


def run(
    system: System,
    state: State,
    *,
    stride: int,
    saves: int,
    receive: Callable[[np.ndarray, np.ndarray], None],
    progress: Callable[[float, float], None] | None = None,
) -> Result:
    """Advance a state through frames, each stride steps after the one before; arguments as in decoupled_run.run."""
    plan, rows = make_plan(system), system.equations.rows
    data = pack(system, state)
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        frames = np.empty((count, data.shape[0] - 2, rows.momenta.stop, data.shape[2]))
        outcome, reached, counts, memory = _advance(system, plan, data, state, stride, frames)
        if reached:
            values, momenta = (gather(frames[:reached], part, system.size) for part in (rows.values, rows.momenta))
            receive(values, momenta)
            last = state.step + reached * stride
            known = memory if outcome is Outcome.FINISHED else None
            state = replace(state, values=values[-1], momenta=momenta[-1], step=last, memory=known)
        if outcome is not Outcome.FINISHED:
            return Result(outcome, state, state.step + int(counts[2]) - reached * stride, int(counts[3]))
        done += count
        if progress is not None:
            progress(done / saves, state.time)
    return Result(Outcome.FINISHED, state, state.step)


def prepare(system: System) -> None:
    """Compile or load everything a run of the system calls."""
    state = State(values=system.reference, momenta=np.zeros((system.size, system.layout.dofs)), h=1.0)
    data = pack(system, state)
    frames = np.empty((0, data.shape[0] - 2, system.equations.rows.momenta.stop, data.shape[2]))
    _advance(system, make_plan(system), data, state, 1, frames)


def violation(system: System, values: np.ndarray) -> np.ndarray:
    """The constraints g of every element, at its left node, shape (nodes, count)."""
    plan, rows = make_plan(system), system.equations.rows
    data = pack(system, State(values=values, momenta=np.zeros((system.size, system.layout.dofs))))
    scatter(data, rows.constraint["next"], values)
    system.kernels["violation"](data, plan.uniforms[2], 1, data.shape[0] - 1)
    return gather(data[1:-1], rows.constraint["violation"], system.size)


def projected(system: System, state: State) -> tuple[np.ndarray, int]:
    """Momenta μ − Gᵀ ν that agree with the constraints; and the node of a redundant constraint, or −1."""
    plan, data = make_plan(system), pack(system, state)
    arguments = (plan.calls, plan.uniforms, data, plan.at, system.size, plan.count, plan.fixed)
    node = int(constrained.prepare_project(*arguments))
    return gather(data[1:-1], system.equations.rows.momenta, system.size), node


def _advance(
    system: System, plan: Plan, data: np.ndarray, state: State, stride: int, frames: np.ndarray
) -> tuple[Outcome, int, np.ndarray, np.ndarray]:
    """One call of the driver; returns the outcome, the frames reached, counts (see steppers.constrained) and memory."""
    shape = (system.size, 1, plan.count)
    known = state.memory is not None and state.memory.shape == shape
    memory = state.memory.copy() if known and state.memory is not None else np.zeros(shape)
    table = np.zeros((1, 1))
    if system.loads is not None:
        times = state.origin + (state.step + np.arange(len(frames) * stride + 1)) * state.h
        table = np.ascontiguousarray(system.loads.table(times, state.h, state.origin))
    clock, counts = np.array([state.origin, state.h, float(state.step)]), np.zeros(4, dtype=np.int64)
    code, reached = constrained.advance(
        *(plan.calls, plan.uniforms, data, plan.at, system.size, plan.count, plan.fixed),
        *((table, plan.entries, plan.scales), clock, stride, frames, memory, counts),
    )
    return list(Outcome)[code], reached, counts, memory


def pulls(system: System, state: State, turning: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces −Gᵀ ι of the multipliers on the left and right node of every element, G M⁻¹ (f − Gᵀ ι) + turning = 0.

    Args:
        system: the system.
        state: values, and the forces f in place of momenta.
        turning: acceleration of g from velocities alone, shape (nodes, count).

    Returns: two arrays of shape (nodes, dofs), an element at its left node.
    """
    plan, data = make_plan(system), pack(system, state)
    impulse = turning.copy()
    constrained.instant(plan.calls, plan.uniforms, data, plan.at, system.size, plan.count, impulse)
    rows, shape = system.equations.rows.constraint, (system.size, plan.count, system.layout.dofs)
    sides = (gather(data[1:-1], rows[name], system.size).reshape(shape) for name in ("left", "right"))
    left, right = (-np.einsum("akd,ak->ad", side, impulse) for side in sides)
    return left, right
