"""What the driver of constrained implicit rules works on: that of Galerkin rules, multipliers, a banded matrix."""

from dataclasses import dataclass

import numpy as np

from cayley.steppers import constrained_implicit, constrained_run, galerkin_plan
from cayley.steppers.galerkin_plan import Advance, points_of, stacked, stage_table, work_arrays
from cayley.steppers.outcome import Outcome
from cayley.system.system import State, System, pack


@dataclass(frozen=True, slots=True)
class Plan:
    """What the driver needs besides the state and the loads.

    Args:
        galerkin: the plan of the Galerkin rule.
        calls: addresses of run and setup of inertia_point, strain_point and constraint_point, shape (3, 2).
        starts: first unknown of every block of nodes.
        between: first unknown of every element's multipliers.
        reach: diagonals on either side of the matrix.
        frame: what projects momenta at saved frames.
    """

    galerkin: galerkin_plan.Plan
    calls: np.ndarray
    starts: np.ndarray
    between: np.ndarray
    reach: int
    frame: constrained_run.Plan


def make_plan(system: System, state: State) -> Plan:
    """Order the unknowns along the chains and compile the kernels."""
    plan = galerkin_plan.make_plan(system, state)
    kernel = system.kernels["constraint_point"]
    active, chains = plan.mesh[5], plan.mesh[7]
    more = _multipliers(system) * len(plan.rule[2])
    starts, between, at = [], [], 0
    for first, last in chains:
        for block in range(first, last):
            starts.append(at)
            at += int(active[block])
            if block + 1 < last:
                between.append(at)
                at += more
    width = int(active.max())
    return Plan(
        galerkin=plan,
        calls=np.vstack([plan.calls, [[kernel.run, kernel.setup]]]).astype(np.int64),
        starts=np.array(starts, dtype=np.int64),
        between=np.array(between, dtype=np.int64),
        reach=2 * width + more - 1,
        frame=constrained_run.make_plan(system),
    )


def advance(system: System, plan: Plan, state: State, stride: int, frames: np.ndarray) -> Advance:
    """One call of the driver; returns the outcome, the frames reached, counts (see steppers.galerkin) and memory."""
    base, layout, lanes = plan.galerkin, system.layout, system.kernels.lanes
    order, count = base.rule[0].shape[1], system.equations.density.constraints.numel()
    control = np.repeat(state.values[:, None, :], order, axis=1)
    shape = (system.size, order - 1, layout.rows + _multipliers(system))
    warm = state.memory is not None and state.memory.shape == shape
    memory = state.memory.copy() if warm and state.memory is not None else np.zeros(shape)
    work = work_arrays(system, base, control, names=("inertia_point", "strain_point", "constraint_point"))
    elements, strain = base.mesh[1], system.equations.rule.strain
    gauss, width = base.rule[4].shape
    along = np.outer(elements[:, 1], [0.0] if strain.between_ends else strain.at)
    owners = np.repeat(elements[:, 0].astype(int), gauss)
    points = points_of(system, "constraint_point", owners, lanes, along.reshape(-1))
    size = int(base.mesh[5].sum()) + len(elements) * (order - 1) * gauss * count
    saddle = (
        np.zeros((len(elements), order - 1, gauss * count)),
        np.zeros((len(elements), order - 1, gauss * count)),
        stacked(points, order),
        np.zeros((order, len(elements), gauss, width, count, layout.dofs)),
        np.zeros((order, len(elements), gauss, count)),
        np.zeros_like(control),
        plan.starts,
        plan.between,
        np.zeros((size, 3 * plan.reach + 1)),
        np.zeros((size, plan.reach)),
        np.zeros(size, dtype=np.int64),
        np.zeros((2, size)),
        np.zeros(size),
    )
    frame = plan.frame
    counts, clock = np.zeros(4, dtype=np.int64), np.array([state.origin, state.h, float(state.step)])
    table = stage_table(system, state, base.rule[7], len(frames) * stride)
    code, reached = constrained_implicit.advance(
        *(plan.calls, base.rule, base.mesh, work, (control, state.momenta.copy(), memory), saddle),
        *((frame.calls, frame.uniforms, pack(system, state), frame.at, frame.count, frame.fixed), warm),
        *((table, base.entries, base.scales), clock, stride, frames, counts),
    )
    return Advance(list(Outcome)[code], reached, counts, memory, work[14])


def _multipliers(system: System) -> int:
    """Multipliers of an element at one time."""
    strain = system.equations.rule.strain
    return system.equations.density.constraints.numel() * (1 if strain.between_ends else len(strain.at))
