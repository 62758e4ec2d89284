"""A readable listing of a kernel: formulas, step by step."""

from collections import Counter

import casadi as ca

from cayley.codegen.operations import ARITHMETIC, COMPARISONS, INTRINSICS, LIBRARY
from cayley.codegen.tape import Operation, record
from cayley.discrete.program import Assign, Carry, Program

_SIGNS = {"fadd": "+", "fsub": "-", "fmul": "*", "fdiv": "/", "olt": "<", "ole": "<=", "oeq": "==", "une": "!="}
_WORDS = {ca.OP_SIGN: "sign", ca.OP_NOT: "not", ca.OP_AND: "and", ca.OP_OR: "or", ca.OP_IF_ELSE_ZERO: "where_nonzero"}


def print_listing(program: Program, lanes: int) -> str:
    """Formulas of a program, step by step, with the number of operations.

    Args:
        program: what to list.
        lanes: doubles in a vector.

    Returns: text of many lines.
    """
    lines = [f"kernel {program.name}: {lanes} lanes, {program.rows} rows a block"]
    lines.append("uniform: " + ", ".join(s.name() for s in program.uniforms))
    for step in program.steps:
        if isinstance(step, Assign):
            lines += _formulas([s.name() for s in step.targets], list(step.values))
        elif isinstance(step, Carry):
            pairs = zip(step.targets, step.sources, strict=True)
            lines += [f"{t.name()}[k] = {s.name()}[k - 1]" for t, s in pairs]
        else:
            names = [s.name() for s in step.unknown]
            lines.append(
                f"iterate {', '.join(names)} from {', '.join(s.name() for s in step.start)} until error <= bound:"
            )
            errors, bounds = ca.vertsplit(step.error), ca.vertsplit(step.bound)
            targets = [*(f"{n} (next)" for n in names), *["error"] * len(errors), *["bound"] * len(bounds)]
            lines += ["    " + line for line in _formulas(targets, [*step.following, *errors, *bounds])]
    lines += _formulas([f"row {row}" for row, _ in program.stores], [v for _, v in program.stores])
    return "\n".join(lines)


def _formulas(names: list[str], values: list[ca.SX]) -> list[str]:
    """One line a formula; what is used more than once gets a name."""
    tape = record(values)
    uses = Counter(i for o in tape.operations if o.code != ca.OP_INPUT for i in o.operands)
    uses.update(tape.outputs)
    text: dict[int, str] = {}
    lines, count = [], 0
    for operation in tape.operations:
        formula = _formula(operation, tape.inputs, text)
        if operation.code not in (ca.OP_INPUT, ca.OP_CONST):
            count += 1
            if uses[operation.result] > 1:
                name = f"t{operation.result}"
                lines.append(f"{name} = {formula}")
                formula = name
        text[operation.result] = formula
    lines += [f"{name} = {text[i]}" for name, i in zip(names, tape.outputs, strict=True)]
    return [f"# {count} operations", *lines]


def _formula(operation: Operation, inputs: tuple[str, ...], text: dict[int, str]) -> str:
    code = operation.code
    if code == ca.OP_INPUT:
        return inputs[operation.operands[0]]
    if code == ca.OP_CONST:
        return f"{operation.constant:.17g}"
    operands = [text[i] for i in operation.operands]
    sign = _SIGNS.get(ARITHMETIC.get(code, "") or COMPARISONS.get(code, ""))
    if sign:
        return f"({operands[0]} {sign} {operands[1]})"
    simple = {ca.OP_SQ: "{}^2", ca.OP_TWICE: "2*{}", ca.OP_NEG: "-{}", ca.OP_INV: "1/{}"}
    if code in simple:
        return "(" + simple[code].format(operands[0]) + ")"
    word = INTRINSICS.get(code) or LIBRARY.get(code) or _WORDS.get(code, f"operation{code}")
    return f"{word}({', '.join(operands)})"
