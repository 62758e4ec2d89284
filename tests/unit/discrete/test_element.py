"""Strain energy of an element and its forces: the formulas of the rules, and f = −∇W by differences on the group."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.density import trace
from cayley.density.expression import symbols
from cayley.discrete.element import element_energy, element_forces
from cayley.discrete.layout import Layout
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import CORNERS, MIDDLE, SCREW
from cayley.lie import cayley, quaternion
from unit.density.evaluation import Turn, numbers, slopes, turned, unit_quaternions
from unit.density.examples import EXAMPLES, STRAIN, Example

LENGTH, START, TIME = 0.4, 0.3, 0.7
PLACE = {"inverse": 1.0 / LENGTH, "left": START, "right": START + LENGTH, "t": TIME}


class Element:
    """Two nodes of an example in numbers, with energy and forces as functions of their fields."""

    def __init__(self, name, points, form, constants=None):
        self.lagrangian, own = WITH_POSE.get(name) or EXAMPLES[name]
        self.constants = constants or own
        self.density, self.points = trace(self.lagrangian, self.constants), points
        self.layout = Layout(self.lagrangian.fields, REPRESENTATIONS[form])
        rng = np.random.default_rng(5)
        self.ends = [{}, {}]
        for field, kind in self.lagrangian.fields.items():
            turns = field in self.layout.rotations
            first = unit_quaternions(rng) if turns else rng.normal(size=kind.size)
            step = rng.normal(scale=0.3, size=3) if turns else rng.normal(size=kind.size)
            self.ends[0][field] = first
            self.ends[1][field] = quaternion.multiply(first, cayley.cay(step)) if turns else first + step

    def rows(self, ends):
        form = self.layout.representation
        turns = self.layout.rotations
        return [np.concatenate([form.from_quaternion(v) if k in turns else v for k, v in end.items()]) for end in ends]

    def moved(self, by):
        """The two ends moved by 2 × dofs numbers."""
        found, at = [], 0
        for end in self.ends:
            new = {}
            for field, value in end.items():
                step = by[at : at + self.lagrangian.fields[field].size]
                new[field] = turned(value, step) if field in self.layout.rotations else value + step
                at += step.size
            found.append(new)
        return found

    def evaluate(self, function, ends):
        a, b = symbols("a", self.layout.rows), symbols("b", self.layout.rows)
        outputs = function(self.density, self.points, self.layout, (a, b), PLACE)
        outputs = outputs if isinstance(outputs, tuple) else (outputs,)
        return numbers(outputs, [a, b, self.density.parameters], [*self.rows(ends), self.density.values])

    def energy(self, ends):
        return self.evaluate(element_energy, ends)[0].item()

    def forces(self):
        return np.concatenate(self.evaluate(element_forces, self.ends))

    def energy_by_hand(self):
        """Σ weight W with W and the kinematics in plain NumPy."""
        a, b = self.ends
        along = self.lagrangian.interval
        quotients, middle = {}, {}
        for field in a:
            if field in self.layout.rotations:
                r = quaternion.multiply(quaternion.conjugate(a[field]), b[field])
                omega = 2.0 * r[1:] if self.points.corners else 4.0 * r[1:] / (1.0 + r[0])
                quotients[f"{field}_{along}"] = omega / LENGTH
                middle[field] = (a[field] + b[field]) / np.linalg.norm(a[field] + b[field])
            else:
                quotients[f"{field}_{along}"] = (b[field] - a[field]) / LENGTH
                middle[field] = 0.5 * (a[field] + b[field])
        places = [(0.5, a, START), (0.5, b, START + LENGTH)]
        if not self.points.corners:
            places = [(1.0, middle, START + 0.5 * LENGTH)]
        total, c = 0.0, SimpleNamespace(**(self.lagrangian.defaults | self.constants))
        for weight, values, s in places:
            turned_values = {k: Turn(v) if k in self.layout.rotations else v for k, v in values.items()}
            total += weight * STRAIN[self.lagrangian.name](
                SimpleNamespace(**turned_values, **quotients, s=s, t=TIME), c
            )
        return total


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), s=cy.Interval, pose=("p", "x"))
def placed(q, c):
    """A rod whose strain energy depends on its place and its direction in space too, and on another tangent."""
    stored = (1.0 + q.x[2] ** 2 + q.s) * (q.p_s @ q.p_s) + q.x_s @ q.x_s + q.p.matrix[0, 1] * q.x_s[2] ** 2
    return 0.5 * c.m * (q.x_t @ q.x_t + q.p_t @ q.p_t) - c.k * stored


WITH_POSE = {"placed": Example(placed, {"m": 1.0, "k": 2.0})}
SCREWS = [(name, SCREW, form) for name in ("rod", *WITH_POSE) for form in REPRESENTATIONS]
CASES = [(name, points, form) for name in STRAIN for points in (CORNERS, MIDDLE) for form in REPRESENTATIONS]
IDS = [f"{name}-{points.name}-{form}" for name, points, form in [*CASES, *SCREWS]]


@pytest.mark.parametrize(("name", "points", "form"), [*CASES, *SCREWS], ids=IDS)
def test_forces_are_minus_the_gradient_of_the_energy(name, points, form):
    element = Element(name, points, form)
    expected = -slopes(lambda by: element.energy(element.moved(by)), 2 * element.layout.dofs)
    assert_allclose(element.forces(), expected, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize(("name", "points", "form"), CASES, ids=IDS[: len(CASES)])
def test_energy_is_that_of_the_rule(name, points, form):
    element = Element(name, points, form)
    assert_allclose(element.energy(element.ends), element.energy_by_hand(), rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "points"),
    [(name, points) for name in ("rod", "mixed", "bent") for points in (CORNERS, MIDDLE)]
    + [(name, SCREW) for name in ("rod", *WITH_POSE)],
    ids=lambda p: getattr(p, "name", p),
)
def test_both_forms_agree_to_round_off(name, points):
    one, other = (Element(name, points, form).forces() for form in REPRESENTATIONS)
    assert_allclose(one, other, atol=1e-13 * np.abs(one).max())


@pytest.mark.parametrize("points", [CORNERS, MIDDLE, SCREW], ids=lambda p: p.name)
def test_rigid_motion_of_a_rod_element_turns_its_forces(points):
    """Turned and moved as a whole the element has the same energy; forces turn with it, moments stay (body frame)."""
    element = Element("rod", points, "quaternion")
    turn, shift = unit_quaternions(np.random.default_rng(8)), np.array([3.0, -1.0, 2.0])
    before, energy = element.forces().reshape(2, 2, 3), element.energy(element.ends)
    element.ends = [
        {"p": quaternion.multiply(turn, e["p"]), "x": quaternion.rotate(turn, e["x"]) + shift} for e in element.ends
    ]
    after = element.forces().reshape(2, 2, 3)
    assert_allclose(element.energy(element.ends), energy, rtol=1e-12)
    assert_allclose(after[:, 0], before[:, 0], rtol=1e-11, atol=1e-11)
    assert_allclose(after[:, 1], quaternion.rotate(turn, before[:, 1]), rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("points", [CORNERS, MIDDLE, SCREW], ids=lambda p: p.name)
def test_forces_of_a_rod_element_are_in_equilibrium(points):
    """Internal forces sum to zero, and so do their moments about the origin: momentum maps are exact."""
    element = Element("rod", points, "quaternion")
    (m1, f1), (m2, f2) = element.forces().reshape(2, 2, 3)
    a, b = element.ends
    moment = np.cross(a["x"], f1) + np.cross(b["x"], f2)
    moment += quaternion.rotate(a["p"], m1) + quaternion.rotate(b["p"], m2)
    assert_allclose(f1 + f2, 0.0, atol=1e-12)
    assert_allclose(moment, 0.0, atol=1e-11)


def test_middle_is_free_of_shear_locking_and_corners_are_not():
    """An arc of constant curvature, nodes on the arc: the middle sees no shear, the corners see Ω ds/2."""
    angle, energies = 0.1, {}
    radius = LENGTH / angle
    for points in (CORNERS, MIDDLE):
        shear = np.diag([2.0, 2.0, 0.0, 0.0, 0.0, 0.0])
        element = Element("rod", points, "quaternion", constants=EXAMPLES["rod"].constants | {"stiffness": shear})
        element.ends = [
            {"p": np.array([1.0, 0.0, 0.0, 0.0]), "x": np.zeros(3)},
            {
                "p": np.array([np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0]),
                "x": radius * np.array([1.0 - np.cos(angle), 0.0, np.sin(angle)]),
            },
        ]
        energies[points.name] = element.energy(element.ends)
    assert energies["middle"] < 1e-30
    assert energies["corners"] == pytest.approx((angle / 2) ** 2, rel=2e-3)
