"""Run the steps of a kernel with NumPy, one lane at a time: what machine code must reproduce."""

from collections.abc import Sequence

import casadi as ca
import numpy as np

from cayley.discrete.program import Assign, Carry, Newton, Program, Step

PASSES = 12


def assign(targets: Sequence[ca.SX], values: Sequence[ca.SX], known: dict[str, float]) -> None:
    """Evaluate expressions of known symbols and name the results."""
    column = ca.vertcat(*values)
    free = ca.symvar(column)
    found = ca.Function("f", [ca.vertcat(*free)], [ca.densify(column)])([known[s.name()] for s in free])
    known |= dict(zip([t.name() for t in targets], np.array(found).reshape(-1).tolist(), strict=True))


def newton(step: Newton, known: dict[str, float]) -> bool:
    """Iterate one lane; False where it does not converge."""
    known |= {u.name(): known[s.name()] for u, s in zip(step.unknown, step.start, strict=True)}
    after = [ca.SX.sym(f"{u.name()}_after") for u in step.unknown]
    error, bound = ca.SX.sym("error"), ca.SX.sym("bound")
    for _ in range(PASSES):
        assign([*after, error, bound], [*step.following, step.error, step.bound], known)
        known |= {u.name(): known[a.name()] for u, a in zip(step.unknown, after, strict=True)}
        if known["error"] <= known["bound"]:
            return True
    return False


def solve(steps: Sequence[Step], known: dict[str, float]) -> bool:
    """Run assignments and Newton loops; False if one of them did not converge."""
    good = True
    for step in steps:
        if isinstance(step, Assign):
            assign(step.targets, step.values, known)
        elif isinstance(step, Newton):
            good &= newton(step, known)
        else:
            raise TypeError(f"a {type(step).__name__} needs neighbors")
    return good


def interpret(program: Program, data: np.ndarray, uniforms: np.ndarray, first: int, last: int) -> int:
    """What the compiled kernel does to blocks of shape (blocks, rows, lanes); returns the failed blocks."""
    failed = 0
    shared = {s.name(): float(v) for s, v in zip(program.uniforms, uniforms, strict=True)}
    lanes = data.shape[2]
    for block in range(first, last):
        known = [dict(shared) for _ in range(lanes)]
        good = True
        for symbol, row, shift in program.lanes:
            values = np.append(data[block, row], data[block + 1, row, 0] if shift else 0.0)
            for lane in range(lanes):
                known[lane][symbol.name()] = float(values[lane + shift])
        for step in program.steps:
            if isinstance(step, Carry):
                _carry(step, known, data, block)
            else:
                results = [solve([step], lane) for lane in known]  # every lane, also behind one that fails
                good &= all(results)
        outcomes = [ca.SX.sym(f"store_{row}") for row, _ in program.stores]
        for lane, names in enumerate(known):
            assign(outcomes, [value for _, value in program.stores], names)
            for (row, _), outcome in zip(program.stores, outcomes, strict=True):
                data[block, row, lane] = names[outcome.name()]
        failed += not good
    return failed


def _carry(step: Carry, known: list[dict[str, float]], data: np.ndarray, block: int) -> None:
    for target, source, row in zip(step.targets, step.sources, step.rows, strict=True):
        own = [names[source.name()] for names in known]
        for names, value in zip(known, [data[block - 1, row, -1], *own[:-1]], strict=True):
            names[target.name()] = float(value)
        data[block, row] = own
