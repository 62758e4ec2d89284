"""What crosses lanes and blocks: shifts, carries, Newton loops with a mask, uniform values."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.codegen.llvm import ITERATIONS
from cayley.density import trace
from cayley.discrete.equations import derive
from cayley.discrete.program import Assign, Carry, Newton
from cayley.discrete.rules import RULES
from cayley.system.system import aligned
from unit.codegen.machine import Machine, blocks_of, program_of, row_of
from unit.density.examples import EXAMPLES
from unit.discrete.interpreter import interpret

LANES = [2, 4, 8]
NODES = 19


def sym(*names):
    return [ca.SX.sym(name) for name in names]


def differences():
    """Row 2 becomes h (x[k+1] − x[k]) − h (x[k] − x[k−1]), the right element's value carried over row 1."""
    x, following, h, right, carried, total = sym("x", "x_next", "h", "right", "carried", "total")
    steps = [
        Assign((right,), (h * (following - x),)),
        Carry((carried,), (right,), (1,)),
        Assign((total,), (right - carried,)),
    ]
    return program_of(steps, [total], lanes=[x], shifted=[(following, 0)], uniforms=[h], extra=1)


@pytest.mark.parametrize("lanes", LANES)
def test_carry_and_shift_across_blocks(lanes):
    x = np.random.default_rng(1).normal(size=NODES)
    data = blocks_of([x], 3, lanes)
    count = len(data) - 2
    padded = np.zeros(count * lanes + 2)
    padded[1 : NODES + 1] = x
    want = 0.5 * np.diff(padded, 2)
    data[0, 1, -1] = 0.5 * x[0]  # what the padding in front hands over
    Machine(differences(), lanes)(data, [0.5], 1, count + 1)
    assert_allclose(row_of(data, 2, NODES), want[:NODES], rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("lanes", LANES)
def test_tiles_give_what_the_whole_gives(lanes):
    """A kernel called block by block does bit for bit what one call does."""
    x = np.random.default_rng(2).normal(size=NODES)
    machine = Machine(differences(), lanes)
    whole, parts = blocks_of([x], 3, lanes), blocks_of([x], 3, lanes)
    count = len(whole) - 2
    machine(whole, [0.5], 1, count + 1)
    for block in range(1, count + 1):
        machine(parts, [0.5], block, block + 1)
    assert np.array_equal(whole, parts)
    before = whole.copy()
    assert machine(whole, [0.5], 2, 2) == 0
    assert np.array_equal(whole, before)


def counting():
    """A loop that adds 1 until a lane has reached its own n: it shows how often each lane took part."""
    n, u, begin, zero = sym("n", "u", "u_start", "zero")
    steps = [
        Assign((begin,), (zero * n,)),
        Newton((u,), (begin,), (u + 1,), n - (u + 1), ca.SX(0.5)),
    ]
    return program_of(steps, [u], lanes=[n], uniforms=[zero])


@pytest.mark.parametrize("lanes", LANES)
def test_lanes_stop_at_different_passes(lanes):
    """A lane that has converged keeps its value while its neighbors go on."""
    n = np.array([3, 1, ITERATIONS, 7, 2, 2, 9, 5, 1, 1, 4, 11, 6, 8, 10, 1], dtype=float)
    data = blocks_of([n], 2, lanes)
    assert Machine(counting(), lanes)(data, [0.0], 1, len(data) - 1) == 0
    assert row_of(data, 1, len(n)).tolist() == n.tolist()


@pytest.mark.parametrize("lanes", LANES)
def test_blocks_with_a_lane_that_fails_are_counted(lanes):
    n = np.full(3 * lanes, 4.0)
    n[1] = 1e6
    n[2 * lanes] = n[-1] = ITERATIONS + 1
    data = blocks_of([n], 2, lanes)
    assert Machine(counting(), lanes)(data, [0.0], 1, len(data) - 1) == 2
    found = row_of(data, 1, len(n))
    assert found[n == 4.0].tolist() == [4.0] * int(np.sum(n == 4.0))
    assert found[n > ITERATIONS].tolist() == [ITERATIONS] * int(np.sum(n > ITERATIONS))


@pytest.mark.parametrize("lanes", LANES)
def test_an_error_that_is_no_number_is_a_failure(lanes):
    u, begin, error = sym("u", "u_start", "error")
    steps = [Assign((begin,), (0.0 * error,)), Newton((u,), (begin,), (u,), error, ca.SX(1.0))]
    machine = Machine(program_of(steps, [u], lanes=[error]), lanes)
    errors = np.zeros(2 * lanes)
    data = blocks_of([errors], 2, lanes)
    assert machine(data, [], 1, 3) == 0
    errors[-1] = np.nan
    assert machine(blocks_of([errors], 2, lanes), [], 1, 3) == 1


@pytest.mark.parametrize("lanes", LANES)
def test_two_loops_in_one_kernel(lanes):
    """Cube roots by Newton, then roots of these; values of the first loop reach the second."""
    b, u, v, u0, v0, w = sym("b", "u", "v", "u0", "v0", "w")
    one = (u * u * u - b) / (3 * u * u)
    two = (v * v - u) / (2 * v)
    steps = [
        Assign((u0,), (1 + b / 3,)),
        Newton((u,), (u0,), (u - one,), one * one, ca.SX(1e-28)),
        Assign((v0, w), (1 + u / 2, u * b)),
        Newton((v,), (v0,), (v - two,), two * two, ca.SX(1e-28)),
    ]
    values = np.array([0.5, 2.0, 3.0, 10.0, 27.0, 0.9, 1.0, 5.0])
    data = blocks_of([values], 4, lanes)
    assert Machine(program_of(steps, [u, v, w], lanes=[b]), lanes)(data, [], 1, len(data) - 1) == 0
    assert_allclose(row_of(data, 1, 8), np.cbrt(values), rtol=1e-14)
    assert_allclose(row_of(data, 2, 8), values ** (1 / 6), rtol=1e-14)
    assert_allclose(row_of(data, 3, 8), values ** (4 / 3), rtol=1e-14)


def test_uniform_values_are_set_up_once():
    """They live behind the uniform inputs; the width says how much room that takes; new inputs need a new setup."""
    h, k, x = sym("h", "k", "x")
    machine = Machine(program_of([], [x * ca.sin(h) / (k + 1), h * k], lanes=[x], uniforms=[h, k]), 4)
    assert machine.width > 2
    for values in ((0.3, 2.0), (0.7, -3.0)):
        data = blocks_of([np.arange(4.0)], 3, 4)
        machine(data, values, 1, 2)
        assert_allclose(row_of(data, 1, 4), np.arange(4.0) * np.sin(values[0]) / (values[1] + 1), rtol=1e-15)
        assert_allclose(row_of(data, 2, 4), values[0] * values[1], rtol=1e-15)


KERNELS = [(name, kernel) for name in ("rod", "string", "mixed") for kernel in ("step", "step_held", "kick", "observe")]
KERNELS += [("two_bodies", "step"), ("double_pendulum", "step_held"), ("bent", "observe")]


@pytest.mark.parametrize(("name", "kernel"), KERNELS, ids=lambda v: v)
def test_kernels_of_densities_do_what_their_programs_say(name, kernel):
    """Machine code against the steps run one lane at a time; a chain ends in the middle of the second block."""
    lanes, rng = 2, np.random.default_rng(4)
    density = trace(*EXAMPLES[name])
    equations = derive(density, RULES["verlet"], varying=[density.names[0]])
    rows, layout = equations.rows, equations.layout
    data = aligned((4, rows.count, lanes))
    data[:] = rng.normal(scale=0.1, size=data.shape)
    for field in layout.rotations:
        first = layout.rows_of(field).start
        data[:, first] = np.sqrt(1.0 - np.sum(data[:, first + 1 : first + 4] ** 2, axis=1))
    data[:, rows.held] = rng.integers(2, size=data[:, rows.held].shape) if kernel == "step_held" else 1.0
    for row in rows.named.values():
        data[:, row] = rng.uniform(0.5, 1.5, size=(4, lanes))
    data[:, rows.named["1/weight"]] = 1.0 / data[:, rows.named["weight"]]
    if "length" in rows.named:
        data[2, rows.named["length"], 1] = 0.0
    known = dict(zip(density.names, density.values, strict=True)) | {
        "h": 0.01,
        "t": 0.3,
        "t_next": 0.31,
        "inverse": 2.5,
    }
    uniforms = np.array([known[name] for name in equations.uniforms])
    want = data.copy()
    program = equations.program(kernel)
    assert interpret(program, want, uniforms, 1, 3) == 0
    assert Machine(program, lanes)(data, uniforms, 1, 3) == 0
    assert_allclose(data, want, rtol=1e-11, atol=1e-12)
