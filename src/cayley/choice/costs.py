"""What a step costs on this machine: measured once for each rule, on a rubber rod, and kept in the cache."""

import functools
import hashlib
import json
import math
import os
import tempfile
import time as clock
from pathlib import Path
from typing import Any

import numpy as np

from cayley.choice.pilot import stepper_of
from cayley.codegen import jit
from cayley.codegen.kernels import lanes_for, sources_digest
from cayley.discrete.rules import Rule
from cayley.model import Material, Model, Rod, Section, loads, supports
from cayley.steppers.outcome import Outcome
from cayley.steppers.saddle import constrained_nodes, is_constrained
from cayley.system.discretize import discretize
from cayley.system.legendre import initial_state
from cayley.system.system import State, System

ELEMENTS = 23
"""Of the rod that is timed; 24 nodes fill whole vectors."""
REPEATS = 5
COMPILED_LOAD, SLOW_LOAD, LOADED_NODE = 0.7e-6, 4e-6, 1e-8
"""Time to evaluate a compiled load [s], time from which on a load counts as not compiled, time to add it to a node."""
JOINED, SPRUNG = 200.0, 60.0
"""What a node with multipliers, or with springs alone, adds to a step of an explicit rule, in nodes that have neither.

Measured with the compiled engine: an inextensible rod of 24 nodes 160, chains of 24 bodies and single bodies on ball
joints 220 to 260, a spring or a damper at the end of a rod 40 and 90."""
JOINED_IMPLICIT = 0.7
"""Part by which a node with multipliers is dearer than others under implicit rules: that rod 0.6 to 0.8, the chain 0.5
under midpoint, next to nothing for one joint at a rod's end and for springs."""
PROBES = 200
IMPLICIT_DT = 4e-3
"""Step of the implicit rules there [s]: three to four Newton iterations, as in most runs."""


def seconds_per_step(rule: Rule, nodes: int) -> float:
    """Expected wall time of one step [s]: nodes, in whole vectors where the rule is explicit, times a constant.

    The constant is that of a rod whatever the density: a Lagrangian of one's own differs by a factor, which does not
    matter where the rule is given anyway.
    """
    return _padded(rule, nodes) * seconds_per_node(rule)


def seconds_per_node(rule: Rule) -> float:
    """Measured wall time of a step of a rod, per node [s], with two digits: the same in every later process."""
    name = f"{rule.name}, {rule.degree}"
    path = _path()
    known = _read(path)
    if name not in known:
        known[name] = _rounded(_measured(rule))
        _write(path, known)
    return known[name]


def seconds_of_ties(rule: Rule, system: System) -> float:
    """Expected wall time that constraints, joints and springs add to a step [s], by the nodes they know."""
    known = len(constrained_nodes(system))
    if rule.implicit:
        factor = JOINED_IMPLICIT if is_constrained(system) else 0.0
    else:
        factor = JOINED if is_constrained(system) else SPRUNG
    return factor * known * seconds_per_node(rule) if known else 0.0


def seconds_of_loads(system: System) -> float:
    """Expected wall time of evaluating and adding the loads that depend on time, once [s].

    Functions that could be compiled count alike, so that the choice does not hang on a measurement; others run as
    Python for every step, which is measured.
    """
    if system.loads is None:
        return 0.0
    best = math.inf
    for _ in range(REPEATS):
        began = clock.perf_counter()
        system.loads.table(np.linspace(0.0, 1.0, PROBES), 1.0 / PROBES, 0.0)
        best = min(best, clock.perf_counter() - began)
    loads = system.loads.columns // 3
    each = best / PROBES / loads
    return loads * (COMPILED_LOAD if each < SLOW_LOAD else _rounded(each)) + len(system.loads.node) * LOADED_NODE


def _padded(rule: Rule, nodes: int) -> int:
    if rule.implicit:
        return nodes
    cells = -(-nodes // rule.cell)  # those that close a chain included
    lanes = lanes_for(rule.cell, cells)
    return -(-cells // lanes) * lanes * rule.cell


def _measured(rule: Rule) -> float:
    """Best of several timings of a short run [s per node and step]."""
    rubber = Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    rod = Rod(Section.circle(5e-3, rubber), length=1.0, direction=(1, 0, 0), elements=ELEMENTS)
    model = Model(rod, supports=[supports.pin(rod.start)], loads=[loads.gravity((0, 0, -9.81))])
    system = discretize(model, rule)
    state = initial_state(system, system.reference, np.zeros((system.size, system.layout.dofs)))
    h, steps = (IMPLICIT_DT, 100) if rule.implicit else (0.9 * system.stable_dt(), 2000)
    stepper = stepper_of(system)
    stepper.prepare(system)
    # the difference of two runs is that of their steps: what a run takes to begin is left out
    long, short = (_timed(rule, system, state.at_step(h), count) for count in (steps + steps // 10, steps // 10))
    return max(long - short, 0.1 * long) / steps / _padded(rule, system.size)


def _timed(rule: Rule, system: System, state: State, steps: int) -> float:
    """Best of several times of a run of so many steps [s]."""
    best = math.inf
    for _ in range(REPEATS):
        began = clock.perf_counter()
        result = stepper_of(system).run(system, state, stride=steps, saves=1, receive=_nothing)
        best = min(best, clock.perf_counter() - began)
        if result.outcome is not Outcome.FINISHED:
            raise RuntimeError(f"the rod that is timed does not run under the rule {rule}: {result.outcome.value}")
    return best


def _nothing(values: np.ndarray, momenta: np.ndarray) -> None:
    """Frames that nobody wants."""


def _rounded(seconds: float) -> float:
    """Two digits: more would pretend."""
    return float(f"{seconds:.1e}")


@functools.cache
def _path() -> Path:
    """File of the constants of this machine and these sources."""
    digest = hashlib.sha256(f"{jit.host_key()}|{sources_digest()}".encode())
    folder = Path(__file__).parents[1] / "steppers"
    for path in sorted([*folder.glob("*.py"), *folder.rglob("*.[ch]")]):
        digest.update(path.name.encode() + path.read_bytes())
    return jit.cache_directory() / f"costs-{digest.hexdigest()[:16]}.json"


_SESSION: dict[str, float] = {}
"""Constants of this process, for a cache that can't be written."""


def _read(path: Path) -> dict[str, float]:
    """Constants known so far; a file that is not what _write writes counts as none."""
    try:
        found: Any = json.loads(path.read_text(encoding="utf-8"))
        kept = {str(name): float(value) for name, value in found.items() if 0.0 < float(value) < 1.0}
    except (OSError, ValueError, AttributeError, TypeError):
        kept = {}
    return kept | _SESSION


def _write(path: Path, known: dict[str, float]) -> None:
    """Write as a whole or not at all."""
    _SESSION.update(known)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent)
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            json.dump(known, file, indent=1)
        os.replace(temporary, path)
    except OSError:
        return
