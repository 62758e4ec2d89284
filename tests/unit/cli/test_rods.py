"""Sections and rods of scenario files are those of the same calls in Python, and come back from a store bit for bit."""

import numpy as np
import pytest

import cayley as cy
from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import parse

STEEL = cy.Material(density=7850.0, youngs_modulus=2.1e11, poisson_ratio=0.3)
HEAD = """
[material.steel]
density = 7850.0
youngs_modulus = 2.1e11
poisson_ratio = 0.3
"""
TAIL = """
[run]
t_end = 1e-5
save_every = 5e-6
"""
ROUND = '[section.round]\nshape = "circle"\nmaterial = "steel"\nradius = 0.02\n'
OFF = (
    '[section.off]\nshape = "given"\nstiffness = [1e6, 1e6, 1e6, 1e3, 1e3, 1e3]\nmass_per_length = 2.0\n'
    "inertia = [0.1, 0.1, 0.2]\nmass_center = [0.01, 0.02]\n"
)
THIN = '[section.thin]\nshape = "circle"\nmaterial = "steel"\nradius = 0.01\n'


def model(text):
    return parse(HEAD + text + TAIL, name="test", file="test.toml").model()


def section(keys):
    text = f'[section.s]\n{keys}\n[[rod]]\nsection = "s"\nlength = 1.0\nelements = 1\n'
    return model(text).rods[0].section


C6 = np.diag([3.0, 4.0, 5.0, 1.0, 2.0, 1.5]) + np.eye(6)[[0, 1, 3, 2, 4, 5]] * 0.1
SECTIONS = {
    "ellipse": (
        'shape = "ellipse"\nmaterial = "steel"\nhalf_width = 0.02\nhalf_height = 0.01\nshear_correction = "none"',
        lambda: cy.Section.ellipse(0.02, 0.01, STEEL, shear_correction="none"),
    ),
    "i_beam": (
        'shape = "i_beam"\nmaterial = "steel"\nwidth = 0.1\nheight = 0.2\nflange = 0.01\nweb = 0.006\n'
        'torsion = "thin-wall"',
        lambda: cy.Section.i_beam(width=0.1, height=0.2, flange=0.01, web=0.006, material=STEEL, torsion="thin-wall"),
    ),
    "box": (
        'shape = "box"\nmaterial = "steel"\nwidth = 0.1\nheight = 0.2\nflange = 0.01\nweb = 0.006\ntorsion = 2e-5',
        lambda: cy.Section.box(width=0.1, height=0.2, flange=0.01, web=0.006, material=STEEL, torsion=2e-5),
    ),
    "polygon": (
        'shape = "polygon"\nmaterial = "steel"\noutline = [[0, 0], [0.03, 0], [0, 0.02]]\naxes = "principal"\n'
        "holes = [[[0.005, 0.005], [0.01, 0.005], [0.005, 0.01]]]\nshear_correction = [0.7, 0.8]\ntorsion = 1e-8",
        lambda: cy.Section.polygon(
            [(0, 0), (0.03, 0), (0, 0.02)],
            STEEL,
            holes=[[(0.005, 0.005), (0.01, 0.005), (0.005, 0.01)]],
            axes="principal",
            shear_correction=(0.7, 0.8),
            torsion=1e-8,
        ),
    ),
    "given": (
        f'shape = "given"\nstiffness = {C6.tolist()}\nmass_per_length = 2.0\ninertia = [0.3, 0.2, 0.5]\n'
        "mass_center = [0.1, 0.2]\nshear_center = [0.05, 0.0]",
        lambda: cy.Section.given(
            stiffness=C6,
            mass_per_length=2.0,
            inertia=np.diag([0.3, 0.2, 0.5]),
            mass_center=(0.1, 0.2),
            shear_center=(0.05, 0.0),
        ),
    ),
}


@pytest.mark.parametrize("name", SECTIONS)
def test_a_section_of_a_file_is_that_of_the_call(name):
    text, call = SECTIONS[name]
    found, wanted = section(text), call()
    for key in ("stiffness", "inertia", "outline", "mass_per_length", "mass_center", "name"):
        np.testing.assert_array_equal(getattr(found, key), getattr(wanted, key))


def cone(s):
    return cy.Section.circle((1 - s / 2.0) * 0.02 + s / 2.0 * 0.01, STEEL)


SOLID, SLIM = cy.Section.circle(0.02, STEEL), cy.Section.circle(0.01, STEEL)
RODS = {
    "curve": (
        'section = "round"\ncurve = ["cos(t)", "sin(t)", 0.2]\nspan = [0, 3]\nelements = 4\ntwist = 0.5\n'
        "normal = [0, 0, 1]\nspacing = [1, 2, 2, 1]",
        lambda: cy.Rod.along(
            SOLID,
            lambda t: (np.cos(t), np.sin(t), 0.2),
            span=(0.0, 3.0),
            elements=4,
            twist=0.5,
            normal=(0, 0, 1),
            spacing=(1, 2, 2, 1),
        ),
    ),
    "lines": (
        'section = "round"\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\nelements = 5',
        lambda: cy.Rod.polyline(SOLID, [(0, 0, 0), (1, 0, 0), (1, 1, 0)], elements=5),
    ),
    "spline": (
        'section = "round"\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\npath = "spline"\nelements = 5',
        lambda: cy.Rod.through(SOLID, [(0, 0, 0), (1, 0, 0), (1, 1, 0)], elements=5),
    ),
    "by element": (
        'section = ["round", "thin", "thin"]\nlength = 2.0\nelements = 3\nstretched = 1.01',
        lambda: cy.Rod([SOLID, SLIM, SLIM], length=2.0, elements=3, stretched=1.01),
    ),
    "off axis": (
        'section = "off"\nlength = 1.0\nelements = 2',
        lambda: cy.Rod(
            cy.Section.given(
                stiffness=np.diag([1e6, 1e6, 1e6, 1e3, 1e3, 1e3]),
                mass_per_length=2.0,
                inertia=np.diag([0.1, 0.1, 0.2]),
                mass_center=(0.01, 0.02),
            ),
            length=1.0,
            elements=2,
        ),
    ),
    "tapered": (
        'section = "round"\ntip_section = "thin"\nlength = 2.0\nelements = 3\ndirection = [1, 0, 0]',
        lambda: cy.Rod(cone, length=2.0, elements=3, direction=(1, 0, 0)),
    ),
    "twisted": (
        'section = "round"\nlength = 2.0\nelements = 3\ndirection = [2, 0, 0]\norigin = [0, 1, 0]\ntwist = 1.0',
        lambda: cy.Rod.along(SOLID, lambda s: (s, 1.0, 0.0), span=(0.0, 2.0), elements=3, twist=1.0),
    ),
}


def assert_same(found, wanted, **close):
    for key in ("positions", "rotations", "nodes", "element_lengths"):
        np.testing.assert_allclose(getattr(found, key), getattr(wanted, key), **close)
    assert (found.length, found.mass, found.elements) == pytest.approx((wanted.length, wanted.mass, wanted.elements))
    for one, other in zip(found.sections, wanted.sections, strict=True):
        np.testing.assert_allclose(one.stiffness, other.stiffness, **close)
        np.testing.assert_allclose(one.first_moment, other.first_moment, **close)


@pytest.mark.parametrize("name", RODS)
def test_a_rod_of_a_file_is_that_of_the_call(name):
    text, call = RODS[name]
    assert_same(model(f"{ROUND}{THIN}{OFF}[[rod]]\n{text}\n").rods[0], call(), rtol=0, atol=1e-14)


@pytest.mark.parametrize("name", RODS)
def test_a_stored_rod_comes_back_bit_for_bit_and_goes_on(name, tmp_path):
    rod = RODS[name][1]()
    assembly = cy.Model(rod)
    run = cy.simulate(assembly, t_end=1e-6, rule=cy.rules.verlet, save_every=5e-7)
    run.save(tmp_path / "run.zarr")
    again = cy.Trajectory.open(tmp_path / "run.zarr")
    assert_same(again.model.rods[0], rod, rtol=0, atol=0)
    np.testing.assert_array_equal(again[rod].position, run[rod].position)
    on, further = (cy.integrate(r.system, r.state, t_end=2e-6, dt=r.dt) for r in (run, again))
    np.testing.assert_array_equal(on.frames.values, further.frames.values)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (
            f'{ROUND}[[rod]]\nsection = "round"\nelements = 2\ncurve = ["t", 0, 0]\npoints = [[0,0,0],[1,0,0]]\n',
            "rod #1: curve and points are both given; allowed: one of the two",
        ),
        (
            f'{ROUND}[[rod]]\nsection = "round"\nelements = 2\nlength = 1.0\ncurve = ["t", 0, 0]\n',
            "rod #1: length is given beside a curve, which says it; leave it out",
        ),
        (
            f'{ROUND}[[rod]]\nsection = "round"\nelements = 2\ncurve = ["x", 0, 0]\n',
            'rod #1.curve #1: "x" uses the unknown name "x"; allowed: ',
        ),
        (
            f'{ROUND}[[rod]]\nsection = ["round", "rond"]\nelements = 2\nlength = 1.0\n',
            'rod #1.section: is "rond" (did you mean "round"?); allowed: round',
        ),
        (
            f'{ROUND}[section.bar]\nshape = "rectangle"\nmaterial = "steel"\nwidth = 0.1\nheight = 0.1\n'
            '[[rod]]\nsection = "round"\ntip_section = "bar"\nelements = 2\nlength = 1.0\n',
            "rod #1: tip_section has another shape than section; allowed: other numbers only",
        ),
        (
            f'{ROUND}[[rod]]\nsection = "round"\nelements = 2\nlength = 1.0\nspacing = [1, -1]\n',
            "rod #1.spacing: holds -1; allowed: positive numbers in brackets, one an element",
        ),
    ],
)
def test_one_line_says_what_is_wrong(text, line):
    with pytest.raises(ScenarioError) as caught:
        model(text)
    assert str(caught.value).startswith(f"test.toml: {line}")
