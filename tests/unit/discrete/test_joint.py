"""Joint constraints: derivatives, rank at every relative pose, independence of the frame, and what each kind allows."""

import ctypes

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.codegen import jit
from cayley.codegen.llvm import print_ir
from cayley.density import library
from cayley.discrete.joint import COUNTS, evaluator, joint_program, parameter_count
from cayley.discrete.layout import Layout
from cayley.discrete.representation import REPRESENTATIONS
from cayley.lie import quaternion
from cayley.system.system import aligned

LAYOUT = Layout(library.rigid_body.fields, REPRESENTATIONS["quaternion"])
R = LAYOUT.rows
FREE = {  # motions of side B each kind allows, seen from side A: (translation, rotation vector)
    "weld": [],
    "ball": [((0, 0, 0), (0.3, -0.8, 1.1))],
    "hinge": [((0, 0, 0), (0, 0, 2.9))],
    "universal": [((0, 0, 0), (0.7, 0, 0)), ((0, 0, 0), (0, -1.2, 0))],
    "slider": [((0, 0, -3.0), (0, 0, 0))],
    "cylindrical": [((0, 0, -3.0), (0, 0, 1.3))],
    "planar": [((1.0, -2.0, 0), (0, 0, 1.3))],
    "guide": [((0, 0, 2.0), (0.5, -0.4, 1.3))],
    "roller": [((1.0, -2.0, 0), (0.5, -0.4, 1.3))],
    "orientation": [((1.0, -2.0, 0.3), (0, 0, 0))],
}
BOTH = pytest.mark.parametrize("grounded", [False, True])
ALL = pytest.mark.parametrize("kind", COUNTS)


def turn(rng: np.random.Generator) -> np.ndarray:
    return quaternion.normalize(rng.normal(size=4))


def pose(rng: np.random.Generator) -> np.ndarray:
    return np.concatenate([turn(rng), rng.normal(size=3)])


def parameters(rng: np.random.Generator, kind: str) -> np.ndarray:
    sides = [np.concatenate([rng.normal(size=3), turn(rng)]) for _ in range(2)]
    return np.concatenate([*sides, [1.7]])[: parameter_count(kind)]


def drive(rng: np.random.Generator) -> np.ndarray:
    return np.concatenate([rng.normal(size=3) * 0.3, turn(rng)])


def side(node: np.ndarray, given: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return node[4:] + quaternion.rotate(node[:4], given[:3]), quaternion.multiply(node[:4], given[3:])


def closed(rng: np.random.Generator, kind: str, driven: np.ndarray, *, grounded: bool, free: tuple) -> np.ndarray:
    """Inputs at which a joint is closed but for a relative motion."""
    given = parameters(rng, kind)
    first, own, other = pose(rng), given[:7], given[7:14]
    if grounded:
        own, other = other, own  # measured from the ground
    point, frame = side(first, own)
    translation, rotation = (np.array(v, dtype=float) for v in free)
    point = point + quaternion.rotate(frame, driven[:3] + translation)
    frame = quaternion.multiply(quaternion.multiply(frame, driven[3:]), quaternion.from_rotation_vector(rotation))
    p = quaternion.multiply(frame, quaternion.conjugate(other[3:]))
    second = np.concatenate([p, point - quaternion.rotate(p, other[:3])])
    nodes = (second, first) if grounded else (first, second)
    return np.concatenate([*nodes, given, driven])


def split(kind: str, found: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    c = COUNTS[kind]
    return found[:c], found[c : c + c * 2 * R].reshape(c, 2 * R)


def trivialized(nodes: np.ndarray) -> np.ndarray:
    """Derivative of both nodes' rows along δp = ½ p η and δx, shape (2R, 12)."""
    found = np.zeros((2 * R, 12))
    for k in range(2):
        p = nodes[k * R : k * R + 4]
        found[k * R : k * R + 4, 6 * k : 6 * k + 3] = np.array([quaternion.tangent(p, e) for e in np.eye(3)]).T
        found[k * R + 4 : k * R + 7, 6 * k + 3 : 6 * k + 6] = np.eye(3)
    return found


@BOTH
@ALL
def test_derivatives(kind, grounded):
    """At quaternions of any length: ∂g and λ·∂²g against central differences."""
    rng = np.random.default_rng(5)
    function = evaluator(joint_program(kind, LAYOUT, grounded=grounded))
    nodes = np.concatenate([pose(rng) * np.repeat([1.2, 1.0], [4, 3]), pose(rng) * np.repeat([0.7, 1.0], [4, 3])])
    rest = np.concatenate([parameters(rng, kind), drive(rng), rng.normal(size=COUNTS[kind])])

    def at(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        found = function(np.concatenate([z, rest]))[0]
        g, slope = split(kind, found)
        return g, slope, found[g.size + slope.size :]

    _, slope, upper = at(nodes)
    hessian = np.zeros((2 * R, 2 * R))
    hessian[np.triu_indices(2 * R)] = upper
    hessian += np.triu(hessian, 1).T
    multiplier = rest[-COUNTS[kind] :]
    for k, step in enumerate(1e-6 * np.eye(2 * R)):
        high, low = at(nodes + step), at(nodes - step)
        assert_allclose((high[0] - low[0]) / 2e-6, slope[:, k], atol=1e-8)
        assert_allclose(multiplier @ (high[1] - low[1]) / 2e-6, hessian[k], atol=1e-7)


@BOTH
@ALL
def test_slope_and_drive(kind, grounded):
    """The lighter programs: the same g and ∂g, and ∂g/∂(d, r) by central differences."""
    rng = np.random.default_rng(6)
    inputs = np.concatenate([pose(rng), pose(rng), parameters(rng, kind), drive(rng)])
    c = COUNTS[kind]
    whole = evaluator(joint_program(kind, LAYOUT, grounded=grounded))(np.append(inputs, np.ones(c)))[0]
    light = evaluator(joint_program(kind, LAYOUT, grounded=grounded, what="slope"))
    assert_allclose(light(inputs)[0], whole[: c + c * 2 * R], atol=1e-15)
    by_drive = evaluator(joint_program(kind, LAYOUT, grounded=grounded, what="drive"))(inputs)[0].reshape(c, 7)
    for k in range(7):
        step = np.zeros_like(inputs)
        step[len(inputs) - 7 + k] = 1e-6
        slope = (light(inputs + step)[0, :c] - light(inputs - step)[0, :c]) / 2e-6
        assert_allclose(slope, by_drive[:, k], atol=1e-8)


@BOTH
@pytest.mark.parametrize("kind", FREE)
def test_zero_where_closed_and_of_full_rank(kind, grounded):
    """Every allowed motion keeps g = 0; there the left-trivialized derivative of the moving side has full rank."""
    rng = np.random.default_rng(7)
    function = evaluator(joint_program(kind, LAYOUT, grounded=grounded, what="slope"))
    for free in [((0, 0, 0), (0, 0, 0)), *FREE[kind]]:
        for _ in range(20):
            inputs = closed(rng, kind, drive(rng), grounded=grounded, free=free)
            g, slope = split(kind, function(inputs)[0])
            assert_allclose(g, 0.0, atol=1e-13)
            own = (slope @ trivialized(inputs[: 2 * R]))[:, :6]
            assert np.linalg.svd(own, compute_uv=False)[-1] > 0.1


@BOTH
@pytest.mark.parametrize("kind", FREE)
def test_not_zero_where_open(kind, grounded):
    """Moved along or about any axis that is not free, g is not zero."""
    rng = np.random.default_rng(11)
    function = evaluator(joint_program(kind, LAYOUT, grounded=grounded, what="slope"))
    free = sum((np.abs(np.concatenate(motion)) for motion in FREE[kind]), start=np.zeros(6)) > 0.0
    assert np.sum(~free) == COUNTS[kind] or kind == "universal"
    for axis in np.flatnonzero(~free):
        step = 0.2 * np.eye(6)[axis]
        inputs = closed(rng, kind, drive(rng), grounded=grounded, free=(step[:3], step[3:]))
        assert np.abs(function(inputs)[0, : COUNTS[kind]]).max() > 0.1


@BOTH
def test_link(grounded):
    """Zero at the distance ℓ = length + d₃, with a derivative of length one on either side."""
    rng = np.random.default_rng(8)
    function = evaluator(joint_program("link", LAYOUT, grounded=grounded, what="slope"))
    driven = np.array([0.0, 0.0, 0.4, 1.0, 0.0, 0.0, 0.0])
    first, second, given = pose(rng), pose(rng), parameters(rng, "link")
    (here, _), (there, _) = side(first, given[:7]), side(second, given[7:14])
    apart = there - here
    second[4:] += apart * (2.1 / np.linalg.norm(apart) - 1.0)
    g, slope = split("link", function(np.concatenate([first, second, given, driven]))[0])
    assert_allclose(g, 0.0, atol=1e-14)
    assert_allclose(np.linalg.norm(slope[0, 4:7]), 1.0, atol=1e-14)
    assert_allclose(slope[0, 4:7], -slope[0, R + 4 : R + 7], atol=1e-14)


@ALL
def test_independent_of_the_frame(kind):
    """Turned and shifted as a whole, and p -> −p of a node (up to the sign of 2 Im u), g stays."""
    rng = np.random.default_rng(9)
    function = evaluator(joint_program(kind, LAYOUT, grounded=False, what="slope"))
    nodes, rest = [pose(rng), pose(rng)], np.concatenate([parameters(rng, kind), drive(rng)])
    before = function(np.concatenate([*nodes, rest]))[0, : COUNTS[kind]]
    q, shift = turn(rng), 5.0 * rng.normal(size=3)
    moved = [np.concatenate([quaternion.multiply(q, n[:4]), quaternion.rotate(q, n[4:]) + shift]) for n in nodes]
    assert_allclose(function(np.concatenate([*moved, rest]))[0, : COUNTS[kind]], before, atol=5e-15)
    moved[0][:4] *= -1.0
    assert_allclose(np.abs(function(np.concatenate([*moved, rest]))[0, : COUNTS[kind]]), np.abs(before), atol=5e-15)


def test_compiles():
    """The program runs as machine code, without uniforms."""
    program = joint_program("hinge", LAYOUT, grounded=False)
    lanes = jit.lanes()
    (run, _), _ = jit.load((program.name, f"{program.name}_setup"), lambda: print_ir(program, lanes), "test of joints")
    inputs = len(program.lanes)
    rng = np.random.default_rng(2)
    data = aligned((1, program.rows, lanes))
    data[0, :inputs] = rng.normal(size=(inputs, lanes))
    uniforms = aligned((8,))
    ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_int64] * 4)(run)(data.ctypes.data, uniforms.ctypes.data, 0, 1)
    assert_allclose(data[0, inputs:].T, evaluator(program)(data[0, :inputs].T), rtol=1e-12, atol=1e-12)


def test_refuses_matrices():
    with pytest.raises(ValueError, match="joints want rotation='quaternion'"):
        joint_program("weld", Layout(library.rigid_body.fields, REPRESENTATIONS["matrix"]), grounded=False)


def test_programs_are_derived_once_and_called_the_same_in_every_process():
    """What names a layout in the cache of kernels has no addresses in it."""
    assert repr(LAYOUT.representation) == "quaternion"
    assert " at 0x" not in repr(LAYOUT)
    first, again, other = (joint_program("ball", LAYOUT, grounded=g) for g in (True, True, False))
    assert first is again
    assert first is not other
