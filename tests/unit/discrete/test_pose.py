"""The strain of a screw motion through the relative pose against the differentiated whole."""

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.codegen.tape import record
from cayley.density import Density, library, trace
from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.element import element_points
from cayley.discrete.embedded import embedded_point, normalized
from cayley.discrete.jet import Jet, jet
from cayley.discrete.layout import Layout
from cayley.discrete.pose import screw_jet, strain_jet, strains_only
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import CORNERS, SCREW, Points, gauss
from cayley.lie import exponential, quaternion
from unit.density.examples import EXAMPLES, INERTIA

CONSTANTS = {"mass": 0.7, "inertia": INERTIA, "gravity": np.array([0.3, -0.2, -9.81])}
UNSHEARABLE = CONSTANTS | {"stiffness": np.diag([4.0, 5.0, 6.0, 1.0]) + 0.1}
INEXTENSIBLE = CONSTANTS | {"stiffness": np.diag([4.0, 5.0, 6.0]) + 0.1}


@cy.lagrangian(x=cy.Vector(3), p=cy.Rotation(), s=cy.Interval, pose=("p", "x"))
def graded(q, c):
    """A strain energy that is not quadratic, knows its place and has its fields the other way round."""
    gamma = q.p.inverse_rotate(q.x_s) - cy.E3
    stored = (1.0 + q.s**2) * (gamma @ gamma) * (1.0 + 0.3 * q.p_s @ q.p_s) + np.exp(0.2 * q.p_s[0]) * (q.p_s @ q.p_s)
    return 0.5 * c.m * (q.x_t @ q.x_t + q.p_t @ q.p_t) - c.k * stored


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), s=cy.Interval, pose=("p", "x"))
def placed(q, c):
    """A strain energy that depends on the position, so not on the strains alone."""
    return 0.5 * c.m * (q.x_t @ q.x_t + q.p_t @ q.p_t) - c.k * (1.0 + q.x[2] ** 2) * (q.p_s @ q.p_s + q.x_s @ q.x_s)


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), s=cy.Interval, pose=("p", "x"))
def oriented(q, c):
    """A strain energy of the tangent in space."""
    return 0.5 * c.m * (q.x_t @ q.x_t + q.p_t @ q.p_t) - c.k * (q.p_s @ q.p_s + q.x_s[2] ** 2)


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), s=cy.Interval, pose=("p", "x"))
def hardly(q, c):
    """A strain energy whose dependence on the direction in space is far below round-off of the rest."""
    gamma = q.p.inverse_rotate(q.x_s) - cy.E3
    stored = gamma @ gamma + q.p_s @ q.p_s + 1e-25 * q.x_s[2] ** 2
    return 0.5 * c.m * (q.x_t @ q.x_t + q.p_t @ q.p_t) - c.k * stored


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), warmth=cy.Vector(1), s=cy.Interval, pose=("p", "x"))
def warm(q, c):
    """A rod with another field."""
    gamma = q.p.inverse_rotate(q.x_s) - (1.0 + 0.1 * q.warmth[0]) * cy.E3
    kinetic = 0.5 * c.m * (q.x_t @ q.x_t + q.p_t @ q.p_t + q.warmth_t @ q.warmth_t)
    return kinetic - c.k * (gamma @ gamma + q.p_s @ q.p_s + q.warmth_s @ q.warmth_s)


TERMS = {
    "rod": (trace(*EXAMPLES["rod"]), "strain"),
    "graded": (trace(graded, {"m": 1.0, "k": 2.0}), "strain"),
    "unshearable": (trace(library.unshearable_rod, UNSHEARABLE), "strain"),
    "no shear": (trace(library.unshearable_rod, UNSHEARABLE), "constraint"),
    "inextensible": (trace(library.inextensible_rod, INEXTENSIBLE), "strain"),
    "rigid axis": (trace(library.inextensible_rod, INEXTENSIBLE), "constraint"),
}
HERE, INVERSE, TIME = 0.6, 2.5, 0.4


def term_of(density: Density, part: str) -> Callable[[dict[str, Any]], ca.SX]:
    return density.constraint if part == "constraint" else lambda point: density.value(part, point)


class Both:
    """A term and its derivatives in both ways, as functions of the rows of two ends or of value and slope."""

    def __init__(self, name: str, points: Points = SCREW) -> None:
        density, part = TERMS[name]
        term = term_of(density, part)
        self.layout = Layout(density.lagrangian.fields, REPRESENTATIONS["quaternion"])
        ends = symbols("z", self.layout.rows), symbols("dz", self.layout.rows)
        self.column = ca.vertcat(*[to_sx(end) for end in ends])
        weights = ca.SX([[1.0], [-0.4], [2.3]][: density.constraints.numel() if part == "constraint" else 1])
        inverse, t, here = (wrap(ca.SX(v)) for v in (INVERSE, TIME, HERE))
        along = str(density.lagrangian.interval)
        if points.between_ends:
            place = {"inverse": inverse, "t": t, "left": here, "right": here + 1.0 / inverse}
            unit = tuple(normalized(self.layout, end) for end in ends)
            found = element_points(density, points, self.layout, unit, place)
        else:
            found = [(1.0, embedded_point(self.layout, *ends, along) | {"t": t, along: here})]
        value = sum((weight * term(point) for weight, point in found[1:]), start=found[0][0] * term(found[0][1]))
        plain = jet(value, self.column, self.column, weights=weights, second=True)
        if points.screw:
            middle = {"inverse": inverse, "t": t, along: here + 0.5 / inverse}
            quick = screw_jet(density, self.layout, term, ends, middle, weights=weights, second=True)
        else:
            quick = strain_jet(density, term, found, self.column, weights=weights, second=True)
        self.jets = (quick, plain)
        self.functions = [self._function(found, density) for found in self.jets]

    def _function(self, found: Jet, density: Density) -> ca.Function:
        outputs = [ca.densify(m) for m in (found.values, found.slope, found.curvature)]
        known = ca.substitute(outputs, [density.parameters], [ca.SX(density.values)])
        return ca.Function("jet", [self.column], known)

    def __call__(self, z: np.ndarray) -> list[list[np.ndarray]]:
        return [[np.array(m) for m in function(z)] for function in self.functions]

    def ends(self, angle: float, seed: int) -> np.ndarray:
        """Two nodes with an angle between them, quaternions of length 0.5 to 2."""
        rng = np.random.default_rng(seed)
        z = rng.normal(size=2 * self.layout.rows)
        turns, more = self.layout.rows_of("p"), self.layout.rows
        axis = rng.normal(size=3)
        p = quaternion.normalize(rng.normal(size=4))
        q = quaternion.multiply(p, exponential.exp(angle * axis / np.linalg.norm(axis)))
        z[turns] = p * rng.uniform(0.5, 2.0)
        z[turns.start + more : turns.stop + more] = q * rng.uniform(0.5, 2.0)
        return z


def close(both: Both, z: np.ndarray) -> None:
    """Values and derivatives agree to round-off."""
    for one, other in zip(*both(z), strict=True):
        assert_allclose(one, other, rtol=1e-12, atol=1e-12 * (1.0 + np.abs(other).max()))


@pytest.mark.parametrize("name", TERMS)
def test_agrees_with_the_differentiated_whole(name):
    """From equal ends to almost a half turn, to round-off."""
    both = Both(name)
    for seed, angle in enumerate([0.0, 1e-14, 1e-9, 1e-5, 1e-2, 0.3, 1.0, 2.0, 3.0, 3.1]):
        close(both, both.ends(angle, seed))


@pytest.mark.parametrize("points", [gauss(1), CORNERS], ids=lambda points: points.name)
@pytest.mark.parametrize("name", TERMS)
def test_by_way_of_the_strains(name, points):
    """Polynomials and corners: at random points, those of a polynomial with slopes of any size."""
    both = Both(name, points)
    for seed in range(5):
        close(both, both.ends(3.0 * seed / 5.0, seed))


@pytest.mark.parametrize("name", TERMS)
def test_takes_a_fraction_of_its_operations(name):
    """What it is for; measured are 18 to 34 hundredths, the most where the strain does not depend on y."""
    sizes = []
    for found in Both(name).jets:
        size = found.curvature.size1()
        upper = [found.curvature[i, k] for i in range(size) for k in range(i, size)]
        sizes.append(len(record([*ca.vertsplit(ca.vec(ca.densify(found.slope))), *upper]).operations))
    assert sizes[0] < 0.4 * sizes[1]


def test_which_terms_depend_on_strains_alone():
    for density, part in TERMS.values():
        assert strains_only(density, part)
    for lagrangian in (placed, oriented, hardly, warm):
        density = trace(lagrangian, {"m": 1.0, "k": 2.0})
        assert not strains_only(density, "strain")
