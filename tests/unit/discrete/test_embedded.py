"""Terms of a density at points of the embedding space: value, gradient, Hessian, and what normalization does."""

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.density import Density, library, trace
from cayley.discrete.embedded import point_program
from cayley.discrete.layout import Layout
from cayley.discrete.program import Program
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import CORNERS, MIDDLE, SCREW, Points
from cayley.lie import quaternion
from unit.density.evaluation import Turn, slopes, value_of
from unit.density.examples import EXAMPLES, STRAIN

HERE, TIME, INVERSE = 0.6, 0.4, 2.5
ON_INTERVAL = [name for name, example in EXAMPLES.items() if example.lagrangian.interval is not None]
CASES = [(name, "inertia_point", MIDDLE) for name in EXAMPLES]
CASES += [(name, "strain_point", points) for name in ON_INTERVAL if name in STRAIN for points in (MIDDLE, CORNERS)]
CASES += [("rod", "strain_point", SCREW)]


def word(value: object) -> str:
    """Name of a parameter of a test."""
    return value.name if isinstance(value, Points) else str(value)


class Term:
    """A point program as functions of (z, z′) in one vector."""

    def __init__(self, name: str, kind: str, points: Points, varying: tuple[str, ...] = ()) -> None:
        self.lagrangian, self.constants = EXAMPLES[name]
        self.density = trace(self.lagrangian, self.constants)
        self.layout = Layout(self.lagrangian.fields, REPRESENTATIONS["quaternion"])
        self.program = point_program(self.density, self.layout, kind, points, varying)
        rows = [symbol for symbol, _, _ in self.program.lanes]
        outputs = ca.vertcat(*[value for _, value in self.program.stores])
        column = ca.vertcat(*self.program.uniforms, *rows)
        self._function = ca.Function("point", [column], [outputs])
        numbers = dict(zip(self.density.names, self.density.values, strict=True))
        known = {"t": TIME, "here": HERE, "inverse": INVERSE} | numbers
        self._uniforms = [known[s.name()] for s in self.program.uniforms]
        self._rest = [known[s.name()] for s in rows[2 * self.layout.rows :]]
        self.size = 2 * self.layout.rows

    def __call__(self, z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Value, gradient and the whole Hessian."""
        found = np.array(self._function(np.concatenate([self._uniforms, z, self._rest])))[:, 0]
        hessian = np.zeros((self.size, self.size))
        hessian[np.triu_indices(self.size)] = found[1 + self.size :]
        return found[0], found[1 : 1 + self.size], hessian + np.triu(hessian, 1).T

    def start(self, seed: int = 3) -> np.ndarray:
        """A point with rotations of length 0.8 to 1.2 and slopes of every kind."""
        rng = np.random.default_rng(seed)
        z = rng.normal(size=self.size)
        for field in self.layout.rotations:
            for rows in self.turning(field):
                z[rows] *= rng.uniform(0.8, 1.2) / np.linalg.norm(z[rows])
        return z

    def turning(self, field: str) -> tuple[slice, slice]:
        """Rows of a field in z and in z′."""
        rows = self.layout.rows_of(field)
        return rows, slice(rows.start + self.layout.rows, rows.stop + self.layout.rows)


def stepped(function: Callable[[np.ndarray], np.ndarray], z: np.ndarray) -> np.ndarray:
    """Derivatives of a function of z by central differences."""
    return slopes(lambda by: np.asarray(function(z + by)), z.size, step=2e-5)


@pytest.mark.parametrize(("name", "kind", "points"), CASES, ids=word)
def test_gradient_and_hessian(name, kind, points):
    term = Term(name, kind, points)
    z = term.start()
    _, gradient, hessian = term(z)
    scale = max(1.0, np.abs(hessian).max())
    assert_allclose(gradient, stepped(lambda at: term(at)[0], z), atol=1e-7 * scale)
    assert_allclose(hessian, stepped(lambda at: term(at)[1], z), atol=1e-7 * scale)
    assert np.abs(gradient).max() > 1e-2


def seen(term: Term, z: np.ndarray, suffix: str) -> dict[str, np.ndarray]:
    """What the Lagrangian is asked at: p = z/‖z‖ and ω = 2 Im(z̄ ż)/‖z‖² by hand."""
    found = {}
    for field in term.layout.fields:
        rows, rates = term.turning(field)
        if field in term.layout.rotations:
            found[field] = z[rows] / np.linalg.norm(z[rows])
            product = quaternion.multiply(quaternion.conjugate(z[rows]), z[rates])
            found[f"{field}_{suffix}"] = 2.0 * product[1:] / (z[rows] @ z[rows])
        else:
            found[field], found[f"{field}_{suffix}"] = z[rows], z[rates]
    return found


def strain_of(term: Term, point: dict[str, np.ndarray]) -> float:
    turns = term.layout.rotations
    q = type("Point", (), {k: Turn(v) if k in turns else v for k, v in point.items()})
    c = type("Constants", (), {k: np.asarray(v, dtype=float) for k, v in term.constants.items()})
    return float(STRAIN[term.lagrangian.name](q, c))


@pytest.mark.parametrize("name", EXAMPLES)
def test_inertia_and_load_are_those_of_the_lagrangian(name):
    """T − U is L, or L + W where there is a strain W, at any slope."""
    term = Term(name, "inertia_point", MIDDLE)
    z, along = term.start(), term.lagrangian.interval
    point = seen(term, z, "t") | {"t": TIME}
    expected = 0.0
    if along is not None:
        rng = np.random.default_rng(8)
        point |= {f"{k}_{along}": rng.normal(size=f.size) for k, f in term.layout.fields.items()} | {along: HERE}
        expected = strain_of(term, point)
    assert_allclose(term(z)[0], expected + value_of(term.lagrangian, point, term.constants), rtol=1e-12)


@pytest.mark.parametrize("name", STRAIN)
def test_strain_is_that_of_the_lagrangian(name):
    term = Term(name, "strain_point", MIDDLE)
    z, along = term.start(), term.lagrangian.interval
    point = seen(term, z, along) | {"t": TIME, along: HERE}
    assert_allclose(term(z)[0], strain_of(term, point), rtol=1e-12)


@pytest.mark.parametrize("name", STRAIN)
def test_strain_of_corners_is_that_of_two_ends(name):
    """W of either end with x′ = (x_b − x_a)/ds and Ω = (2/ds) Im(p̄ₐ p_b), in the mean."""
    term = Term(name, "strain_point", CORNERS)
    z, along = term.start(), term.lagrangian.interval
    ends, slope = [{}, {}], {}
    for field in term.layout.fields:
        a, b = (z[rows] for rows in term.turning(field))
        if field in term.layout.rotations:
            a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
            slope[f"{field}_{along}"] = 2.0 * INVERSE * quaternion.multiply(quaternion.conjugate(a), b)[1:]
        else:
            slope[f"{field}_{along}"] = INVERSE * (b - a)
        ends[0][field], ends[1][field] = a, b
    places = HERE, HERE + 1.0 / INVERSE
    found = [strain_of(term, end | slope | {"t": TIME, along: s}) for end, s in zip(ends, places, strict=True)]
    expected = np.mean(found)
    assert_allclose(term(z)[0], expected, rtol=1e-12)


TURNING = [
    case for case in CASES if any(isinstance(f, cy.Rotation) for f in EXAMPLES[case[0]].lagrangian.fields.values())
]


@pytest.mark.parametrize(("name", "kind", "points"), TURNING, ids=word)
@pytest.mark.parametrize("factor", [0.25, 0.9, 3.0])
def test_length_of_a_rotation_does_not_matter(name, kind, points, factor):
    """Homogeneous of degree 0 in (z, z′); so the gradient has no part along (z, z′) and falls with the length."""
    term = Term(name, kind, points)
    z = term.start()
    value, gradient, hessian = term(z)
    for field in term.layout.rotations:
        both = np.r_[term.turning(field)]
        scaled = z.copy()
        scaled[both] *= factor
        other, pulled, _ = term(scaled)
        size = np.abs(gradient).max()
        assert_allclose(other, value, rtol=1e-11, atol=1e-12)
        assert_allclose(pulled[both] * factor, gradient[both], rtol=1e-9, atol=1e-11 * size)
        assert abs(gradient[both] @ z[both]) < 1e-11 * size
        assert_allclose(hessian[np.ix_(both, both)] @ z[both], -gradient[both], atol=1e-10 * np.abs(hessian).max())


@pytest.mark.parametrize(("name", "kind"), [(n, k) for n, k, p in TURNING if p is MIDDLE], ids=word)
def test_growth_of_a_rotation_does_not_matter(name, kind):
    """A slope along z itself changes its length, not its rotation."""
    term = Term(name, kind, MIDDLE)
    z = term.start()
    value = term(z)[0]
    for field in term.layout.rotations:
        rows, rates = term.turning(field)
        grown = z.copy()
        grown[rates] += 0.7 * z[rows]
        assert_allclose(term(grown)[0], value, rtol=1e-11, atol=1e-12)


def test_varying_constants_are_rows():
    """In the order they are named, behind place and 1/length; the others stay uniform."""
    varying = ("c.mass", "c.stiffness[2,2]")
    term, plain = Term("rod", "strain_point", MIDDLE, varying), Term("rod", "strain_point", MIDDLE)
    names = [symbol.name() for symbol, _, _ in term.program.lanes[term.size :]]
    assert names == ["here", "inverse", *varying]
    assert not set(varying) & {symbol.name() for symbol in term.program.uniforms}
    assert [row for _, row, _ in term.program.lanes] == list(range(term.size + 4))
    assert term.program.rows == term.size + 4 + 1 + term.size + term.size * (term.size + 1) // 2
    z = term.start()
    for one, other in zip(term(z), plain(z), strict=True):
        assert_allclose(one, other, rtol=1e-13)


CONSTRAINED = {"unshearable": (library.unshearable_rod, 4), "inextensible": (library.inextensible_rod, 3)}
LIGHT = {"inertia_point": "inertia_point_force", "strain_point": "strain_point_force"}
LIGHT |= {"constraint_point": "constraint_point_slope"}


def traced(name: str) -> Density:
    """An example or a constrained rod with numbers."""
    if name not in CONSTRAINED:
        return trace(*EXAMPLES[name])
    lagrangian, size = CONSTRAINED[name]
    constants = {"mass": 1.2, "inertia": np.diag([0.3, 0.4, 0.6]), "gravity": [0.0, 0.0, -9.81]}
    return trace(lagrangian, constants | {"stiffness": np.diag(np.arange(2.0, 2.0 + size)) + 0.1})


def outputs(density: Density, program: Program, seed: int) -> np.ndarray:
    """What a program stores at random inputs, constants as they are."""
    rng = np.random.default_rng(seed)
    known = dict(zip(density.names, density.values, strict=True)) | {"t": TIME, "here": HERE, "inverse": INVERSE}
    inputs = [*program.uniforms, *(symbol for symbol, _, _ in program.lanes)]
    numbers = [known[s.name()] if s.name() in known else rng.normal() for s in inputs]
    column = ca.vertcat(*[value for _, value in program.stores])
    return np.array(ca.Function("point", [ca.vertcat(*inputs)], [column])(numbers))[:, 0]


LIGHT_CASES = [("rod", term, points) for term in list(LIGHT)[:2] for points in (MIDDLE, CORNERS, SCREW)]
LIGHT_CASES += [(name, term, points) for name in CONSTRAINED for term in LIGHT for points in (MIDDLE, SCREW)]


@pytest.mark.parametrize(("name", "term", "points"), LIGHT_CASES, ids=word)
def test_light_variant_is_all_but_the_hessian_of_the_same_rows(name, term, points):
    density = traced(name)
    layout = Layout(density.lagrangian.fields, REPRESENTATIONS["quaternion"])
    whole, light = (point_program(density, layout, given, points, ()) for given in (term, LIGHT[term]))
    assert [row for _, row, _ in light.lanes] == [row for _, row, _ in whole.lanes]
    found, less = (outputs(density, program, seed=2) for program in (whole, light))
    count = density.constraints.numel() if term == "constraint_point" else 1
    assert len(less) == count * (1 + 2 * layout.rows)
    assert_allclose(less, found[: len(less)], rtol=1e-13)


@pytest.mark.parametrize("points", [MIDDLE, SCREW], ids=word)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_constraints_and_their_derivatives(name, points):
    """∂g and the Hessian of λ·g by central differences."""
    density = traced(name)
    layout = Layout(density.lagrangian.fields, REPRESENTATIONS["quaternion"])
    program = point_program(density, layout, "constraint_point", points, ())
    size, count = 2 * layout.rows, density.constraints.numel()
    inputs = ca.vertcat(*program.uniforms, *(symbol for symbol, _, _ in program.lanes))
    function = ca.Function("point", [inputs], [ca.vertcat(*[value for _, value in program.stores])])
    rng = np.random.default_rng(5)
    first, multiplier = len(program.uniforms), rng.normal(size=count)
    numbers = rng.normal(size=inputs.numel())
    numbers[-count:] = multiplier

    def at(z: np.ndarray) -> np.ndarray:
        numbers[first : first + size] = z
        return np.array(function(numbers))[:, 0]

    z = numbers[first : first + size].copy()
    whole = at(z)
    jacobian = whole[count : count * (1 + size)].reshape(count, size)
    hessian = np.zeros((size, size))
    hessian[np.triu_indices(size)] = whole[count * (1 + size) :]
    hessian += np.triu(hessian, 1).T
    assert_allclose(jacobian, stepped(lambda z: at(z)[:count], z), atol=1e-7 * np.abs(jacobian).max())
    pulled = stepped(lambda z: multiplier @ at(z)[count : count * (1 + size)].reshape(count, size), z)
    assert_allclose(hessian, pulled, atol=1e-7 * np.abs(hessian).max())
