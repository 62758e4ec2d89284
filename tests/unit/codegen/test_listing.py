"""What people see of a kernel: formulas, step by step."""

import re

import casadi as ca
import numpy as np
import pytest

import cayley as cy
from cayley.codegen.listing import print_listing
from cayley.codegen.tape import record
from cayley.density import trace
from cayley.discrete.equations import derive
from cayley.discrete.program import Assign, Newton
from cayley.discrete.rules import verlet
from unit.codegen.machine import program_of
from unit.density.examples import EXAMPLES


def test_listing_of_the_string(golden):
    equations = derive(trace(*EXAMPLES["string"]), verlet)
    golden("string_verlet_step.txt", print_listing(equations.program("step"), 8) + "\n")


def test_listing_reads_as_formulas():
    x, y, h, u, u0 = (ca.SX.sym(n) for n in ("x", "y", "h", "u", "u0"))
    part = ca.SX.sym("part")
    steps = [
        Assign((part, u0), (ca.sin(x) * ca.sin(x) + ca.atan2(y, 2 * x), h - 0.1)),
        Newton((u,), (u0,), (u - (u**3 - part),), part - u, ca.SX(1e-6)),
    ]
    text = print_listing(program_of(steps, [-u, ca.if_else(x < y, u, 0)], lanes=[x, y], uniforms=[h]), 4)
    lines = text.splitlines()
    assert lines[0] == "kernel made: 4 lanes, 4 rows a block"
    assert lines[1] == "uniform: h"
    assert "part = ((sin(x)^2) + atan2(y, (2*x)))" in lines
    assert "u0 = (h - 0.10000000000000001)" in lines
    assert "iterate u from u0 until error <= bound:" in lines
    assert "    error = (part - u)" in lines
    assert "    bound = 9.9999999999999995e-07" in lines
    assert lines[-2:] == ["row 2 = (-u)", "row 3 = where_nonzero((x < y), u)"]


FUNCTIONS = {"sqrt", "sin", "cos", "fabs", "minnum", "where_nonzero"}
WORD = re.compile(r"(?<![\w.])(?:1/weight|[A-Za-z_][\w.]*(?:\[[\d,]+\])?)")


@pytest.mark.parametrize("name", ["rod", "double_pendulum", "bent"])
def test_every_name_of_a_listing_is_defined_before(name):
    """A formula uses inputs, functions, and names from lines above it."""
    program = derive(trace(*EXAMPLES[name]), verlet).program("step")
    known = {s.name() for s in program.uniforms} | {s.name() for s, _, _ in program.lanes} | FUNCTIONS
    for line in print_listing(program, 8).splitlines()[2:]:
        if line.startswith("iterate"):
            unknown, start = line.removeprefix("iterate ").removesuffix(" until error <= bound:").split(" from ")
            assert set(WORD.findall(start)) <= known
            known |= set(WORD.findall(unknown))
        elif not line.strip().startswith("#"):
            target, _, formula = line.strip().partition(" = ")
            assert set(WORD.findall(formula.removesuffix("[k - 1]"))) <= known, line
            known.add(target.removesuffix("[k]"))


def test_print_of_kernels_is_the_listing():
    system = cy.compile(
        EXAMPLES["string"].lagrangian,
        rule=cy.rules.verlet,
        domain=cy.Interval(0.0, 1.0, elements=3),
        constants=EXAMPLES["string"].constants,
    )
    assert str(system.kernels) == print_listing(system.equations.program("step"), system.kernels.lanes)
    assert "4 nodes, 12 degrees of freedom" in str(system)
    assert "x[0] explicit" in str(system)


def test_tape_is_in_single_assignment_form():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    shared = ca.sin(x * y)
    tape = record([shared + 1, shared * shared, x, ca.SX(3.5), ca.sin(x * y)])
    results = [o.result for o in tape.operations]
    assert len(set(results)) == len(results)
    seen: set[int] = set()
    for operation in tape.operations:
        if operation.code != ca.OP_INPUT:
            assert set(operation.operands) <= seen
        seen.add(operation.result)
    assert [o.code for o in tape.operations].count(ca.OP_SIN) == 1
    assert set(tape.inputs) == {"x", "y"}
    assert len(tape.outputs) == 5
    constants = {o.result: o.constant for o in tape.operations if o.code == ca.OP_CONST}
    assert constants[tape.outputs[3]] == 3.5
    assert np.isin(tape.outputs, results).all()
