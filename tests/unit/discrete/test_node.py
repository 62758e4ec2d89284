"""Inertia and loads of one node: both Legendre transforms of the discrete kinetic Lagrangian by differences."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley.density import trace
from cayley.density.expression import symbols
from cayley.discrete.layout import Layout
from cayley.discrete.node import corner_inertia, mass_matrix, node_load, node_point
from cayley.discrete.representation import REPRESENTATIONS
from cayley.lie import cayley, quaternion
from unit.density.evaluation import numbers, slopes, turned, unit_quaternions, value_of
from unit.density.examples import EXAMPLES

H, TIME, HERE = 0.05, 0.7, 0.4
PLACE = {"h": H, "t": TIME, "t_next": TIME + H, "here": HERE}
NAMES = [name for name in EXAMPLES if name not in ("rod", "string", "shifted")]


class Node:
    """One step of one node of an example, in numbers."""

    def __init__(self, name, form):
        self.lagrangian, self.constants = EXAMPLES[name]
        self.density = trace(self.lagrangian, self.constants)
        self.layout = Layout(self.lagrangian.fields, REPRESENTATIONS[form])
        rng = np.random.default_rng(6)
        kinds = self.lagrangian.fields.items()
        turns = self.layout.rotations
        self.before = {k: unit_quaternions(rng) if k in turns else rng.normal(size=kind.size) for k, kind in kinds}
        self.unknown = rng.normal(scale=0.1, size=self.layout.dofs)
        self.after = {}
        for name_, value in self.before.items():
            step = self.unknown[self.layout.dofs_of(name_)]
            turns = name_ in self.layout.rotations
            self.after[name_] = quaternion.multiply(value, cayley.cay(step)) if turns else value + step

    def rows(self, values):
        form, turns = self.layout.representation, self.layout.rotations
        return np.concatenate([form.from_quaternion(v) if k in turns else v for k, v in values.items()])

    def moved(self, values, by):
        turns = self.layout.rotations
        parts = {k: by[self.layout.dofs_of(k)] for k in values}
        return {k: turned(v, parts[k]) if k in turns else v + parts[k] for k, v in values.items()}

    def inertia(self):
        """D₀, D₁ and the rows after the step, as the equations have them."""
        node, unknown = symbols("q", self.layout.rows), symbols("u", self.layout.dofs)
        i = corner_inertia(self.density, self.layout, node, unknown, PLACE)
        inputs = [node, unknown, self.density.parameters]
        given = [self.rows(self.before), self.unknown, self.density.values]
        before, total, scale, after = numbers([i.before, i.total, i.scale, i.after], inputs, given)
        return before / scale, total - before / scale, after

    def discrete_lagrangian(self, before, after):
        """T_d = h/2 (T(qʲ, v) + T(qʲ⁺¹, v)) with T = L − L(v = 0) from the user's function."""
        velocity = {}
        for name, a in before.items():
            b = after[name]
            relative = (
                quaternion.multiply(quaternion.conjugate(a), b)[1:] * 2.0 if name in self.layout.rotations else b - a
            )
            velocity[f"{name}_t"] = relative / H
        along = self.lagrangian.interval
        rest = {k: np.zeros_like(v) for k, v in velocity.items()}
        slope = {f"{k}_{along}": np.full(f.size, 0.2) for k, f in self.lagrangian.fields.items()}
        total = 0.0
        for values, time in ((before, TIME), (after, TIME + H)):
            point = values | slope | {"t": time, str(along): HERE}
            total += value_of(self.lagrangian, point | velocity, self.constants)
            total -= value_of(self.lagrangian, point | rest, self.constants)
        return 0.5 * H * total


@pytest.mark.parametrize("form", REPRESENTATIONS)
@pytest.mark.parametrize("name", NAMES)
def test_momenta_before_and_after(name, form):
    """D₀ T_d and D₁ T_d, left-trivialized, against central differences; the step is p Cay f, x + u."""
    node = Node(name, form)
    first, second, after = node.inertia()
    dofs = node.layout.dofs
    d0 = slopes(lambda by: node.discrete_lagrangian(node.moved(node.before, by), node.after), dofs)
    d1 = slopes(lambda by: node.discrete_lagrangian(node.before, node.moved(node.after, by)), dofs)
    assert_allclose(first, d0, atol=1e-8 * max(1.0, np.abs(d0).max()))
    assert_allclose(second, d1, atol=1e-8 * max(1.0, np.abs(d1).max()))
    assert_allclose(after, node.rows(node.after), atol=2e-15)


@pytest.mark.parametrize("name", NAMES)
def test_both_forms_agree_to_round_off(name):
    found = [Node(name, form).inertia()[:2] for form in REPRESENTATIONS]
    for one, other in zip(*found, strict=True):
        assert_allclose(one, other, atol=1e-14 * max(1.0, np.abs(one).max()))


@pytest.mark.parametrize("name", ["rigid_body", "rod"])
def test_free_rotation_is_stated_without_square_roots(name):
    """Where ∂T/∂ω is linear in ω alone the residual is polynomial: rows are scaled by 1 + f·f."""
    density = trace(*EXAMPLES[name])
    layout = Layout(density.lagrangian.fields, REPRESENTATIONS["quaternion"])
    unknown = symbols("u", 6)
    scale = corner_inertia(density, layout, symbols("q", 7), unknown, PLACE).scale
    u = np.array([0.1, -0.2, 0.3, 0.4, 0.5, 0.6])
    (found,) = numbers([scale], [unknown], [u])
    assert_allclose(found, [1.0 + u[:3] @ u[:3]] * 3 + [1.0] * 3, rtol=1e-15)


@pytest.mark.parametrize("form", REPRESENTATIONS)
@pytest.mark.parametrize("name", NAMES)
def test_load_is_minus_the_gradient_of_its_energy(name, form):
    node = Node(name, form)
    rows = symbols("q", node.layout.rows)
    load = node_load(node.density, node.layout, rows, PLACE)
    energy = node.density.value("load", node_point(node.layout, rows, node.lagrangian.interval, PLACE))
    inputs = [rows, node.density.parameters]

    def evaluated(values):
        return numbers([load, energy], inputs, [node.rows(values), node.density.values])

    expected = -slopes(lambda by: evaluated(node.moved(node.before, by))[1].item(), node.layout.dofs)
    assert_allclose(evaluated(node.before)[0], expected, atol=1e-8 * max(1.0, np.abs(expected).max()))


@pytest.mark.parametrize("name", NAMES)
def test_mass_matrix_is_the_second_derivative_at_rest(name):
    node = Node(name, "quaternion")
    rows = symbols("q", node.layout.rows)
    matrix = mass_matrix(node.density, node.layout, node_point(node.layout, rows, node.lagrangian.interval, PLACE))
    (found,) = numbers([matrix], [rows, node.density.parameters], [node.rows(node.before), node.density.values])
    names = {f"{k}_t": node.layout.dofs_of(k) for k in node.before}
    slope = {f"{k}_{node.lagrangian.interval}": np.zeros(f.size) for k, f in node.lagrangian.fields.items()}
    point = node.before | slope | {"t": TIME, str(node.lagrangian.interval): HERE}

    def kinetic(v):
        return value_of(node.lagrangian, point | {k: v[part] for k, part in names.items()}, node.constants)

    def gradient(v):
        return slopes(lambda by: kinetic(v + by), node.layout.dofs, step=1e-3)

    expected = slopes(gradient, node.layout.dofs, step=1e-3)
    assert_allclose(found.reshape(expected.shape), expected, atol=2e-6)
