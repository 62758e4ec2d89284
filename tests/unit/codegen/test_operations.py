"""Every operation the compiler knows against NumPy: on lanes, on uniform values, and on both."""

import math

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_max_ulp

from cayley.codegen.operations import ARITHMETIC, COMPARISONS, INTRINSICS, LIBRARY
from cayley.codegen.tape import record
from cayley.discrete.program import Assign
from unit.codegen.machine import Machine, blocks_of, evaluate, program_of, row_of

RNG = np.random.default_rng(2014)
X, Y = ca.SX.sym("x"), ca.SX.sym("y")
SIGNED = np.concatenate([RNG.normal(scale=2.0, size=19), [0.0, 1.0, -1.0, 30.5, -30.5]])
OTHER = np.concatenate([RNG.normal(scale=2.0, size=19), [0.7, 1.0, 2.0, 3.0, -4.0]])
INSIDE = RNG.uniform(-0.95, 0.95, 24)
POSITIVE = np.concatenate([RNG.uniform(0.1, 5.0, 22), [1e-6, 1e6]])
ABOVE = 1.0 + POSITIVE

ONE = {
    ca.OP_SQRT: (ca.sqrt, np.sqrt, POSITIVE),
    ca.OP_FABS: (ca.fabs, np.abs, SIGNED),
    ca.OP_FLOOR: (ca.floor, np.floor, SIGNED),
    ca.OP_CEIL: (ca.ceil, np.ceil, SIGNED),
    ca.OP_SIN: (ca.sin, np.sin, SIGNED),
    ca.OP_COS: (ca.cos, np.cos, SIGNED),
    ca.OP_TAN: (ca.tan, np.tan, SIGNED),
    ca.OP_EXP: (ca.exp, np.exp, SIGNED),
    ca.OP_LOG: (ca.log, np.log, POSITIVE),
    ca.OP_ASIN: (ca.asin, np.arcsin, INSIDE),
    ca.OP_ACOS: (ca.acos, np.arccos, INSIDE),
    ca.OP_ATAN: (ca.atan, np.arctan, SIGNED),
    ca.OP_SINH: (ca.sinh, np.sinh, SIGNED),
    ca.OP_COSH: (ca.cosh, np.cosh, SIGNED),
    ca.OP_TANH: (ca.tanh, np.tanh, SIGNED),
    ca.OP_ASINH: (ca.asinh, np.arcsinh, SIGNED),
    ca.OP_ACOSH: (ca.acosh, np.arccosh, ABOVE),
    ca.OP_ATANH: (ca.atanh, np.arctanh, INSIDE),
    ca.OP_ERF: (ca.erf, np.vectorize(math.erf), SIGNED),
    ca.OP_LOG1P: (ca.log1p, np.log1p, POSITIVE),
    ca.OP_EXPM1: (ca.expm1, np.expm1, INSIDE),
    ca.OP_SIGN: (ca.sign, np.sign, SIGNED),
    ca.OP_NEG: (lambda x: -x, np.negative, SIGNED),
    ca.OP_SQ: (lambda x: x * x, np.square, SIGNED),
    ca.OP_TWICE: (lambda x: x + x, lambda x: 2.0 * x, SIGNED),
    ca.OP_INV: (lambda x: 1 / x, np.reciprocal, OTHER),
    ca.OP_NOT: (ca.logic_not, np.logical_not, SIGNED),
    ca.OP_CONSTPOW: (lambda x: ca.constpow(x, 2.5), lambda x: x**2.5, POSITIVE),
}
TWO = {
    ca.OP_ADD: (lambda x, y: x + y, np.add, SIGNED, OTHER),
    ca.OP_SUB: (lambda x, y: x - y, np.subtract, SIGNED, OTHER),
    ca.OP_MUL: (lambda x, y: x * y, np.multiply, SIGNED, OTHER),
    ca.OP_DIV: (lambda x, y: x / y, np.divide, SIGNED, OTHER),
    ca.OP_POW: (lambda x, y: x**y, np.power, POSITIVE, OTHER),
    ca.OP_COPYSIGN: (ca.copysign, np.copysign, SIGNED, OTHER),
    ca.OP_FMIN: (ca.fmin, np.minimum, SIGNED, OTHER),
    ca.OP_FMAX: (ca.fmax, np.maximum, SIGNED, OTHER),
    ca.OP_ATAN2: (ca.atan2, np.arctan2, SIGNED, OTHER),
    ca.OP_FMOD: (ca.fmod, np.fmod, SIGNED, OTHER),
    ca.OP_REMAINDER: (ca.remainder, np.vectorize(math.remainder), SIGNED, OTHER),
    ca.OP_HYPOT: (ca.hypot, np.hypot, SIGNED, OTHER),
    ca.OP_LT: (lambda x, y: x < y, np.less, SIGNED, OTHER),
    ca.OP_LE: (lambda x, y: x <= y, np.less_equal, SIGNED, OTHER),
    ca.OP_EQ: (lambda x, y: x == y, np.equal, SIGNED, OTHER),
    ca.OP_NE: (lambda x, y: x != y, np.not_equal, SIGNED, OTHER),
    ca.OP_AND: (ca.logic_and, np.logical_and, SIGNED, OTHER),
    ca.OP_OR: (ca.logic_or, np.logical_or, SIGNED, OTHER),
    ca.OP_IF_ELSE_ZERO: (lambda x, y: ca.if_else(x, y, 0), lambda x, y: np.where(x != 0, y, 0.0), SIGNED, OTHER),
}
NAMES = {value: name for name, value in vars(ca).items() if name.startswith("OP_") and isinstance(value, int)}


def test_nothing_is_left_out():
    special = {ca.OP_SQ, ca.OP_TWICE, ca.OP_NEG, ca.OP_INV, ca.OP_NOT, ca.OP_AND, ca.OP_OR}
    special |= {ca.OP_IF_ELSE_ZERO, ca.OP_SIGN}
    assert set(ONE) | set(TWO) == {*ARITHMETIC, *INTRINSICS, *LIBRARY, *COMPARISONS} | special


@pytest.mark.parametrize("code", ONE, ids=NAMES.get)
def test_one_operand(code):
    """On lanes of every width, and on a uniform value."""
    symbolic, expected, values = ONE[code]
    expression = symbolic(X)
    assert code in {o.code for o in record([expression]).operations}
    for lanes in (2, 4, 8):
        found = evaluate(expression, [X], [values], lanes)
        assert_array_max_ulp(found, np.asarray(expected(values), dtype=float), maxulp=4)
    machine = Machine(program_of([], [expression], uniforms=[X]), 2)
    for value in values[:4]:
        data = blocks_of([np.zeros(3)], 1, 2)
        machine(data, [value], 1, 3)
        assert_array_max_ulp(row_of(data, 0, 3), np.full(3, float(expected(value))), maxulp=4)


@pytest.mark.parametrize("code", TWO, ids=NAMES.get)
def test_two_operands(code):
    """Both on lanes; either one uniform; both uniform."""
    symbolic, expected, a, b = TWO[code]
    expression = symbolic(X, Y)
    assert code in {o.code for o in record([expression]).operations}
    for lanes in (2, 4, 8):
        found = evaluate(expression, [X, Y], [a, b], lanes)
        assert_array_max_ulp(found, np.asarray(expected(a, b), dtype=float), maxulp=4)
    value = 1.25
    for lane, uniform, want in ((X, Y, expected(a, value)), (Y, X, expected(value, b))):
        machine = Machine(program_of([], [expression], lanes=[lane], uniforms=[uniform]), 4)
        column = a if lane is X else b
        data = blocks_of([column], 2, 4)
        machine(data, [value], 1, len(data) - 1)
        assert_array_max_ulp(row_of(data, 1, len(column)), np.asarray(want, dtype=float), maxulp=4)
    both = Machine(program_of([], [expression], uniforms=[X, Y]), 2)
    data = blocks_of([np.zeros(2)], 1, 2)
    both(data, [a[0], b[0]], 1, 2)
    assert_array_max_ulp(row_of(data, 0, 2), np.full(2, float(expected(a[0], b[0]))), maxulp=4)


def test_selection_takes_either_side_in_each_lane():
    expression = ca.if_else(X < Y, ca.sin(X), ca.if_else(X > 2 * Y, -Y, X * Y))
    want = np.where(SIGNED < OTHER, np.sin(SIGNED), np.where(SIGNED > 2 * OTHER, -OTHER, SIGNED * OTHER))
    for lanes in (2, 4, 8):
        assert_allclose(evaluate(expression, [X, Y], [SIGNED, OTHER], lanes), want, rtol=1e-15)


def test_extreme_constants_are_exact():
    """Constants go into the code bit for bit."""
    for value in (1e-300, 1e300, 0.1, 2.0**-1022, -7.0, math.pi):
        found = evaluate(X * 0.0 + value, [X], [np.ones(3)], 4)
        assert found.tolist() == [value] * 3


def test_unknown_operation_is_refused():
    """An operation that CasADi has and the compiler has not is told by its number."""
    expression = ca.erfinv(X)
    with pytest.raises(NotImplementedError, match=f"operation {ca.OP_ERFINV} of the expression"):
        evaluate(expression, [X], [INSIDE], 4)


@pytest.mark.parametrize("seed", range(6))
def test_random_expressions(seed):
    """Deep mixtures with shared parts, of lane and uniform values, against CasADi's own evaluation."""
    rng = np.random.default_rng(seed)
    u = ca.SX.sym("u")
    pool = [X, Y, u, ca.SX(0.7)]
    one = [ca.sin, ca.cos, ca.tanh, ca.fabs, ca.atan, lambda v: ca.sqrt(1 + v * v), lambda v: ca.exp(-v * v), ca.sign]
    two = [lambda a, b: a + b, lambda a, b: a - b, lambda a, b: a * b, lambda a, b: a / (1 + b * b), ca.fmax, ca.fmin]
    two += [ca.atan2, lambda a, b: ca.if_else(a < b, a, b * b), ca.hypot]
    for _ in range(40):
        if rng.random() < 0.4:
            pool.append(one[rng.integers(len(one))](pool[rng.integers(len(pool))]))
        else:
            a, b = (pool[rng.integers(len(pool))] for _ in range(2))
            pool.append(two[rng.integers(len(two))](a, b))
    values = pool[-4:]
    program = program_of([Assign((ca.SX.sym("unused"),), (values[0],))], values, lanes=[X, Y], uniforms=[u])
    want = np.array(ca.Function("f", [X, Y, u], [ca.vertcat(*values)]).map(24)(SIGNED, OTHER, np.full(24, 0.3)))
    for lanes in (2, 4, 8):
        data = blocks_of([SIGNED, OTHER], program.rows, lanes)
        Machine(program, lanes)(data, [0.3], 1, len(data) - 1)
        for k in range(4):
            assert_allclose(row_of(data, 2 + k, 24), want[k], rtol=1e-11, atol=1e-13)
