"""From CasADi expressions to a straight list of operations."""

from collections.abc import Sequence
from typing import NamedTuple

import casadi as ca


class Operation(NamedTuple):
    """One instruction: result number = code(operand numbers); constants and inputs carry theirs."""

    code: int
    result: int
    operands: tuple[int, ...]
    constant: float


class Tape(NamedTuple):
    """Operations in order; inputs by name; the numbers that hold the outputs."""

    operations: tuple[Operation, ...]
    inputs: tuple[str, ...]
    outputs: tuple[int, ...]


def record(values: Sequence[ca.SX]) -> Tape:
    """Linearize expressions, every common subexpression once.

    Args:
        values: scalar expressions.

    Returns: a Tape in static single assignment form; its inputs are the free symbols.
    """
    column = ca.cse(ca.vertcat(*values))
    free = ca.symvar(column)
    function = ca.Function("tape", [ca.vertcat(*free)], [ca.densify(column)])
    number: dict[int, int] = {}
    operations: list[Operation] = []
    outputs = [0] * len(values)
    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        if code == ca.OP_OUTPUT:
            outputs[function.instruction_output(k)[1]] = number[function.instruction_input(k)[0]]
            continue
        constant = function.instruction_constant(k) if code == ca.OP_CONST else 0.0
        if code == ca.OP_INPUT:
            operands: tuple[int, ...] = (function.instruction_input(k)[1],)
        elif code == ca.OP_CONST:
            operands = ()
        else:
            operands = tuple(number[i] for i in function.instruction_input(k))
        number[function.instruction_output(k)[0]] = k
        operations.append(Operation(code, k, operands, constant))
    return Tape(tuple(operations), tuple(s.name() for s in free), tuple(outputs))
