"""The rubber pendulum in PyElastica, for an interpreter that has it: a line in is a run, a line out its result.

A run is ``{"elements": 20, "dt": 1e-4, "t_end": 1.0}``; ``dt`` is an upper bound. Rod, support and load are those of
``benchmarks/pyelastica.py``; ``"rod": {"base_radius": 1e-3, ...}`` makes it another rod. Staying alive
between runs lets the two programs be timed in turn.
"""

import json
import math
import sys
import time
import warnings
from typing import Any

import elastica as ea
import numpy as np

RUBBER = {
    "base_length": 1.0,
    "base_radius": 5e-3,
    "density": 1100.0,
    "youngs_modulus": 5e6,
    "shear_modulus": 5e6 / (2.0 * (1.0 + 0.5)),  # its shear correction is always 27/28
}


class Pendulum(ea.BaseSystemCollection, ea.Constraints, ea.Forcing):
    """A simulator with a support and a load; no damping, contact or callbacks."""


def pendulum(elements: int, given: dict[str, float]) -> tuple[Pendulum, ea.CosseratRod]:
    """Horizontal rod at rest, pinned at the origin, under gravity.

    Args:
        elements: number of elements.
        given: what differs from RUBBER.

    Returns: the finalized simulator and its rod.
    """
    simulator = Pendulum()
    rod = ea.CosseratRod.straight_rod(
        elements,
        start=np.zeros(3),
        direction=np.array([1.0, 0.0, 0.0]),
        normal=np.array([0.0, 1.0, 0.0]),
        **(RUBBER | given),
    )
    simulator.append(rod)
    # No director index is given, so the first element turns freely: a pin.
    simulator.constrain(rod).using(ea.FixedConstraint, constrained_position_idx=(0,))
    simulator.add_forcing_to(rod).using(ea.GravityForces, acc_gravity=np.array([0.0, 0.0, -9.81]))
    simulator.finalize()
    return simulator, rod


def advance(simulator: Pendulum, steps: int, dt: float) -> float:
    """Take equal steps of position Verlet in an explicit loop, as PyElastica's manual recommends.

    Args:
        simulator: what ``pendulum`` returns.
        steps: number of steps.
        dt: time step [s].

    Returns: wall time of the loop alone [s].
    """
    stepper = ea.PositionVerlet()
    now = np.float64(0.0)
    began = time.perf_counter()
    for _ in range(steps):
        now = stepper.step(simulator, now, dt)
    return time.perf_counter() - began


def run(elements: int, dt: float, t_end: float, rod: dict[str, float] | None = None) -> dict[str, Any]:
    """Run to ``t_end`` [s] after a few steps that let Numba compile; ``rod`` is what differs from RUBBER.

    Returns: steps, dt [s], wall_time [s] and the tip [m], null where it is not finite.
    """
    steps = math.ceil(t_end / dt * (1.0 - 1e-12))
    given = rod or {}
    advance(pendulum(elements, given)[0], 20, dt)
    simulator, made = pendulum(elements, given)
    wall_time = advance(simulator, steps, t_end / steps)
    tip = made.position_collection[:, -1].tolist()
    return {
        "steps": steps,
        "dt": t_end / steps,
        "wall_time": wall_time,
        "tip": tip if all(map(math.isfinite, tip)) else None,
    }


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    for line in sys.stdin:
        print(json.dumps(run(**json.loads(line))), flush=True)
