"""Run a system of an implicit rule from frame to frame."""

import ctypes
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cayley.steppers import problem
from cayley.steppers.cells import constraint_cells, term_cells
from cayley.steppers.contact_plan import ContactPlan
from cayley.steppers.contacts import TOLD, make_contacts
from cayley.steppers.outcome import Outcome, Result
from cayley.steppers.problem import Plan
from cayley.steppers.turned_run import run_turned
from cayley.system.system import State, System
from cayley.system.turned import embedded

CHUNK = 2_000
"""Most steps in one call of the driver."""


def run(
    system: System,
    state: State,
    *,
    stride: int,
    saves: int,
    receive: Callable[..., None],
    progress: Callable[[float, float], None] | None = None,
) -> Result:
    """Advance a state through frames, each stride steps after the one before; arguments as in decoupled_run.run."""
    if system.layout.representation.name != "quaternion":
        return run_turned(run, system, state, stride=stride, saves=saves, receive=receive, progress=progress)
    plan = make_plan(system)
    accounted = system.accounted
    rows = system.layout.rows
    done = 0
    while done < saves:
        count = max(1, min(saves - done, CHUNK // stride))
        frames = np.empty((count, system.size, rows + system.layout.dofs))
        call = advance(plan, state, stride, frames)
        outcome, reached, counts = call.outcome, call.reached, call.counts
        if reached:
            values, momenta = frames[:reached, :, :rows].copy(), frames[:reached, :, rows:].copy()
            more = {"work": call.work[:reached]} if accounted else {}
            more |= {"rates": call.rates[:reached]} if system.damped else {}
            more |= {} if system.contact is None else {"contact": call.contact[:reached]}
            receive(values, momenta, **more)
            last = state.step + reached * stride
            # after a failure the memory is not that of the last frame
            memory = call.memory if outcome is Outcome.FINISHED else None
            work = call.work[reached - 1] if accounted else None
            state = replace(state, values=values[-1], momenta=momenta[-1], step=last, memory=memory, work=work)
        if outcome is not Outcome.FINISHED:
            last = state.step + int(counts[2]) - reached * stride
            return Result(outcome, state, last, int(counts[3]), call.history, call.partners)
        done += count
        if progress is not None:
            progress(done / saves, state.time)
    return Result(Outcome.FINISHED, state, state.step)


def make_plan(system: System) -> Plan:
    """Cells and blocks, kernels compiled: a node between elements is a block, those inside one are one together."""
    if "implicit" in system.plans:
        return system.plans["implicit"]
    nodes = np.arange(system.size)
    cells = term_cells(system), constraint_cells(system, nodes)
    plan = problem.make_plan(system, nodes, system.equations.rule.time, element_groups(system), *cells)
    system.plans["implicit"] = plan
    return plan


def element_groups(system: System) -> np.ndarray:
    """Number of the block of every node: those inside an element are one together, shape (nodes,)."""
    degree, groups, first = system.equations.rule.degree, [], 0
    for count in system.chains:
        element, inner = np.divmod(np.arange(count), degree)
        own = 2 * element + (inner > 0) if degree > 1 else element
        groups.append(first + own)
        first += int(own[-1]) + 1
    return np.concatenate(groups)


def prepare(system: System) -> None:
    """Compile or load everything a run of the system calls."""
    make_plan(embedded(system))


@dataclass(frozen=True, slots=True)
class Advance:
    """What one call of the driver returns.

    Args:
        outcome: how it ended.
        reached: frames written.
        counts: iterations in all, most in a step, number and node of the last step, shape (4,).
        memory: control nodes, multipliers and, where there is damping, the motion of the last steps, flat.
        history: relative correction and largest residual [N s, N m s] of the last iterations, shape (HISTORY, 2).
        work: work and loss at the frames [J], shape (frames, 1, 2).
        rates: velocities at the frames by the last three steps (see Frames), shape (frames, nodes, dofs).
        contact: what frames have of contacts, shape (frames, k).
        partners: which touch where it stopped for that.
    """

    outcome: Outcome
    reached: int
    counts: np.ndarray
    memory: np.ndarray
    history: np.ndarray
    work: np.ndarray
    rates: np.ndarray
    contact: np.ndarray
    partners: str


def advance(plan: Plan, state: State, stride: int, frames: np.ndarray) -> Advance:
    """One call of the driver."""
    system, steps = plan.system, len(frames) * stride
    entries, scales = load_entries(system)
    work = np.zeros((len(frames), 1, 2))
    shape = (plan.size, system.layout.dofs)
    motion = np.zeros((3, plan.size + 1, shape[1])) if system.damped else np.zeros(0)
    rates = np.zeros((len(frames), *shape)) if system.damped else np.zeros(0)
    made = problem.make_problem(
        plan,
        state,
        steps,
        len(frames),
        {
            "table": stage_table(system, state, plan.tables["at"], steps),
            "entries": entries,
            "scales": scales,
            "frames": frames,
            "works": work,
            "rates": rates,
            "contact_told": (told := np.zeros((len(frames), TOLD))),
            "contact_force": (force := np.zeros((len(frames), plan.size if system.contact else 0, shape[1]))),
            **({"motion": motion} if system.damped else {}),
        },
    )
    if state.work is not None:
        made.arrays["energy"][1:] = state.work[0]
    known = None if state.memory is None else state.memory[: _size(made)]
    made.struct.warm = int(_recall(known, made))
    touching = None
    if system.contact is not None:
        touching = ContactPlan(made, make_contacts(system, state.h))
        touching.contacts.begin(state.values, None if state.memory is None else state.memory[_size(made) :])
        touching.begin()
    reached = ctypes.c_int64(0)
    code = made.engine.advance(ctypes.byref(made.struct), ctypes.byref(reached))
    if touching is not None and touching.failure is not None:
        touching.contacts.end()
        raise touching.failure
    outcome, counts = list(Outcome)[code], made.arrays["counts"]
    if outcome is Outcome.REDUNDANT:
        counts[3] = np.flatnonzero(plan.block_of == counts[3])[0]
    elif outcome.hasty:
        counts[3] = -1
    memory = np.concatenate([part.reshape(-1) for part in _remembered(made)])
    partners = ""
    if touching is not None:
        outcome, memory, partners = touching.contacts.close(outcome, memory)
    contact = np.concatenate([told, force.reshape(len(frames), -1)], axis=1)
    return Advance(outcome, reached.value, counts, memory, made.arrays["history"], work, rates, contact, partners)


def _remembered(made: problem.Problem) -> list[np.ndarray]:
    """Views of what a state remembers of the last steps."""
    parts = [made.arrays["memory"][:, :-1], *(c["start"] for c in made.couplings)]
    return [*parts, made.arrays["motion"]] if made.plan.system.damped else parts


def _size(made: problem.Problem) -> int:
    return sum(part.size for part in _remembered(made))


def _recall(memory: np.ndarray | None, made: problem.Problem) -> bool:
    """Put what a state remembers into the arrays; returns whether there was anything."""
    parts = _remembered(made)
    sizes = [part.size for part in parts]
    if memory is None or memory.shape != (sum(sizes),):
        return False
    for part, values in zip(parts, np.split(memory, np.cumsum(sizes)[:-1]), strict=True):
        part[:] = values.reshape(part.shape)
    return True


def stage_table(system: System, state: State, stages: np.ndarray, steps: int) -> np.ndarray:
    """Values of the time-dependent loads at the stages of the next steps, shape (steps, stages, columns)."""
    if system.loads is None:
        return np.zeros((1, 1, 1))
    times = state.origin + (state.step + np.arange(steps)[:, None] + stages[None]) * state.h
    return np.ascontiguousarray(system.loads.table.at_stages(times, state.h, state.origin))


def load_entries(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Loaded nodes.

    Returns: (node, row, row of rotation, form, column, is moment, dof) per entry, shape (k, 7), and their factors and
    levers, shape (k, 4).
    """
    loads, layout = system.loads, system.layout
    if loads is None:
        return np.zeros((0, 7), dtype=np.int64), np.zeros((0, 4))
    row_of_dof = {layout.dofs_of(n).start: layout.rows_of(n).start for n in layout.fields}
    moments = {layout.dofs_of(n).start for n in layout.rotations}
    row = [row_of_dof[int(d)] for d in loads.dof]
    moment = [int(int(d) in moments) for d in loads.dof]
    columns = [loads.node, np.array(row), loads.turn, loads.form, loads.column, np.array(moment), loads.dof]
    return np.column_stack(columns).astype(np.int64), loads.factors
