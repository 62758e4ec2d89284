"""The parts of a traced density against the user's own function called on numbers."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.density import Density, trace
from cayley.lie import quaternion
from unit.density.evaluation import moved, numbers, random_point, slopes, value_of
from unit.density.examples import EXAMPLES, Example

PARTS = ("inertia", "strain", "load")


def at(density: Density, point: dict) -> dict:
    """The point as a density takes it: matrices for the frames, no variation."""
    turns = density.frames
    return {
        f"frame of {k}" if k in turns else k: quaternion.to_matrix(v) if k in turns else v for k, v in point.items()
    }


def gradients(example: Example, point: dict) -> dict[str, dict[str, np.ndarray]]:
    density = trace(example.lagrangian, example.constants)
    found = {}
    for part in PARTS:
        gradient = density.gradient(part, at(density, point))
        values = numbers(list(gradient.values()), [density.parameters], [density.values])
        found[part] = dict(zip(gradient, values, strict=True))
    return found


def values(example: Example, point: dict) -> dict[str, float]:
    density = trace(example.lagrangian, example.constants)
    found = numbers([density.value(p, at(density, point)) for p in PARTS], [density.parameters], [density.values])
    return {part: v.item() for part, v in zip(PARTS, found, strict=True)}


def at_rest(example: Example, point: dict) -> dict:
    return point | {f"{n}_t": np.zeros(f.size) for n, f in example.lagrangian.fields.items()}


@pytest.fixture(params=EXAMPLES)
def example(request) -> Example:
    return EXAMPLES[request.param]


def test_parts_add_up_to_the_lagrangian(example):
    point = random_point(example.lagrangian, np.random.default_rng(1))
    part = values(example, point)
    whole = value_of(example.lagrangian, point, example.constants)
    rest = value_of(example.lagrangian, at_rest(example, point), example.constants)
    assert_allclose(part["inertia"], whole - rest, rtol=1e-12, atol=1e-13)
    assert_allclose(-part["strain"] - part["load"], rest, rtol=1e-12, atol=1e-13)
    assert values(example, at_rest(example, point))["inertia"] == pytest.approx(0.0, abs=1e-15)


def test_gradient_against_differences(example):
    """∂T and −∂(W + U) by central differences of L, rotations moved as p exp(η/2)."""
    lagrangian, constants = example.lagrangian, example.constants
    point = random_point(lagrangian, np.random.default_rng(2))
    found = gradients(example, point)

    def whole(name, by):
        return value_of(lagrangian, moved(lagrangian, point, name, by), constants)

    def rest(name, by):
        return value_of(lagrangian, at_rest(example, moved(lagrangian, point, name, by)), constants)

    for name in found["inertia"]:
        size = found["inertia"][name].size
        stored = slopes(lambda by, name=name: -rest(name, by), size)
        moving = slopes(lambda by, name=name: whole(name, by), size) + stored
        assert_allclose(found["inertia"][name], moving, atol=2e-8, rtol=1e-8, err_msg=name)
        if name.endswith("_t"):
            assert not np.any(found["strain"][name])
            assert not np.any(found["load"][name])
        else:
            assert_allclose(found["strain"][name] + found["load"][name], stored, atol=2e-8, rtol=1e-8, err_msg=name)


def test_load_knows_no_derivatives(example):
    """U is what W, the terms with derivatives along the interval, leaves over."""
    point = random_point(example.lagrangian, np.random.default_rng(3))
    along = example.lagrangian.interval
    found = gradients(example, point)
    for name, gradient in found["load"].items():
        if name.endswith(("_t", f"_{along}")):
            assert not np.any(gradient)
    if along is None:
        assert not any(np.any(g) for g in found["strain"].values())


def test_strain_gradient_in_two_parts(example):
    """The terms of difference quotients alone and the others make the whole."""
    density = trace(example.lagrangian, example.constants)
    point = at(density, random_point(example.lagrangian, np.random.default_rng(4)))
    whole, alone, other = (density.gradient("strain", point, only=only) for only in ("all", "quotients", "values"))
    for name in density.slots:
        a, b, c = numbers([whole[name], alone[name], other[name]], [density.parameters], [density.values])
        assert_allclose(a, b + c, rtol=1e-12, atol=1e-14)
        if name in example.lagrangian.fields:
            assert not np.any(b)


def test_square_of_one_plus_velocity_is_split():
    """½ (1 + v)² = (v + ½ v²) + ½: the constant belongs to the load, so at rest there is no inertia."""
    example, v, x = EXAMPLES["shifted"], 0.3, 0.5
    found = gradients(example, {"x": np.array([x]), "x_t": np.array([v]), "t": 0.0})
    part = values(example, {"x": np.array([x]), "x_t": np.array([v]), "t": 0.0})
    assert_allclose(part["inertia"], 1.3 * (v + 0.5 * v**2) * (1 + x**2), rtol=1e-14)
    assert_allclose(part["load"], -0.5 * 1.3 * (1 + x**2), rtol=1e-14)
    assert_allclose(found["inertia"]["x_t"], 1.3 * (1 + v) * (1 + x**2), rtol=1e-14)
    assert_allclose(found["load"]["x"], -1.3 * x, rtol=1e-14)


def test_sums_of_every_form():
    """Terms are found behind signs, doublings and constant factors."""

    @cy.lagrangian(x=cy.Vector(2), s=cy.Interval)
    def tangled(q, c):
        v, u, w = q.x_t[0] ** 2, np.cos(q.x[0]), q.x_s[1] ** 2
        mixed = -(0.25 * (u - w) - 0.5 * v)
        return mixed + mixed - 3.0 * (-(q.x_t[1] ** 2) + 0.5 * (w + u)) - (-u)

    example = Example(tangled, {})
    point = random_point(tangled, np.random.default_rng(9))
    v, u, w = point["x_t"] ** 2, np.cos(point["x"][0]), point["x_s"][1] ** 2
    part = values(example, point)
    assert_allclose(part["inertia"], v[0] + 3.0 * v[1], rtol=1e-14)
    assert_allclose(part["strain"], w, rtol=1e-14)
    assert_allclose(part["load"], u, rtol=1e-14)


def test_gyroscopic_momentum_at_rest():
    """∂L/∂ẋ of a charge at rest is ½ e B × x, and its gradient in x is there although T vanishes."""
    example = EXAMPLES["charge"]
    x, b = np.array([0.3, -0.2, 0.5]), example.constants["field"]
    found = gradients(example, {"x": x, "x_t": np.zeros(3), "t": 0.0})
    assert_allclose(found["inertia"]["x_t"], 0.5 * 0.8 * np.cross(b, x), rtol=1e-14)
    moving = gradients(example, {"x": x, "x_t": np.array([1.0, 0.0, 0.0]), "t": 0.0})
    assert_allclose(moving["inertia"]["x"], 0.5 * 0.8 * np.cross([1.0, 0.0, 0.0], b), rtol=1e-14)


def test_rotation_answers_like_its_matrix():
    """rotate, inverse_rotate, matrix, @, T and indexing are one and the same Λ(p), and vary in the same way."""

    def lagrangian(form):
        @cy.lagrangian(p=cy.Rotation())
        def L(q, c):
            return 0.5 * q.p_t @ q.p_t - form(q.p, c.a, c.b)

        return L

    a, b = np.array([0.3, -1.0, 0.7]), np.array([1.1, 0.2, -0.4])
    forms = [
        lambda p, a, b: a @ p.rotate(b),
        lambda p, a, b: p.inverse_rotate(a) @ b,
        lambda p, a, b: a @ (p @ b),
        lambda p, a, b: b @ (p.T @ a),
        lambda p, a, b: a @ p.matrix @ b,
        lambda p, a, b: sum(a[i] * p[i, k] * b[k] for i in range(3) for k in range(3)),
        lambda p, a, b: cy.dot(a, np.asarray(p) @ b),
        lambda p, a, b: p.rotate(b) @ a,
    ]
    p = np.array([0.5, -0.1, 0.7, 0.5]) / np.linalg.norm([0.5, -0.1, 0.7, 0.5])
    expected = np.cross(b, quaternion.to_matrix(p).T @ a)  # δ(a·Λb) = a·Λ(η × b) = η·(b × Λᵀa)
    for form in forms:
        found = gradients(Example(lagrangian(form), dict(a=a, b=b)), {"p": p, "p_t": np.zeros(3), "t": 0.0})
        assert_allclose(found["load"]["p"], expected, rtol=1e-13)


def test_zero_entries_of_constants_vanish_and_symmetric_ones_are_one():
    inertia = np.array([[2.0, 0.5, 0.0], [0.5, 3.0, 0.0], [0.0, 0.0, 4.0]])
    density = trace(EXAMPLES["rigid_body"].lagrangian, dict(mass=1.0, inertia=inertia, gravity=(0.0, 0.0, -9.81)))
    entries = ("mass", "inertia[0,0]", "inertia[0,1]", "inertia[1,1]", "inertia[2,2]", "gravity[2]")
    assert density.names == tuple(f"c.{entry}" for entry in entries)
    assert_allclose(density.values, [1.0, 2.0, 0.5, 3.0, 4.0, -9.81])


def test_signature_tells_densities_apart():
    """The same text for the same mathematics, another for another density, pattern or name of a constant."""
    rod = EXAMPLES["rod"]
    other = rod.constants | {"inertia": np.eye(3)}
    same = trace(rod.lagrangian, rod.constants | {"mass": 33.0}).signature
    assert trace(rod.lagrangian, rod.constants).signature == same
    assert trace(rod.lagrangian, other).signature != same

    def spring(factor, name):
        @cy.lagrangian(x=cy.Vector(1))
        def L(q, c):
            return 0.5 * q.x_t[0] ** 2 - factor * getattr(c, name) * q.x[0] ** 2

        return trace(L, {name: 1.0}).signature

    assert spring(0.5, "k") == spring(0.5, "k")
    assert len({spring(0.5, "k"), spring(0.25, "k"), spring(0.5, "stiffness")}) == 3


def test_depends():
    density = trace(EXAMPLES["bent"].lagrangian, EXAMPLES["bent"].constants)
    assert density.depends("strain", "x")
    assert density.depends("inertia", "p")
    assert density.depends("load", "p", "x")
    assert not density.depends("load", "x_s", "p_s", "x_t")
    assert not density.depends("inertia", "x", "x_s")
    assert density.velocities == ("p_t", "x_t")
