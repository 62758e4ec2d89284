"""Parts with a Lagrangian of their own in scenario files: they run as in Python, and problems are told in place."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import joints, loads, supports
from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import parse
from cayley.results.export import export

PART = """
[[part]]
name = "top"
lagrangian = "0.5*m*(vx**2 + vy**2 + vz**2) + 0.5*(a*wx**2 + a*wy**2 + c*wz**2) - 9.81*m*(z + b*r33)"
constants = { m = 2.0, a = 0.05, c = 0.09, b = 0.1 }
position = [1.0, 0.1, -0.2]
ports.eye = [0.0, -0.1, 0.2]
"""
LINE = """
[[part]]
name = "line"
lagrangian = "0.5*m*(vx**2 + vy**2 + vz**2) - 0.5*k*(sqrt(dx**2 + dy**2 + dz**2) - 1)**2"
fields = "position"
constants = { m = 0.3, k = 2000.0 }
length = 1.0
elements = 4
position = [0.0, 0.0, -1.2]
"""
FILE = (
    """
[material.rubber]
density = 1100.0
youngs_modulus = 2e6
poisson_ratio = 0.5

[section.thick]
shape = "circle"
radius = 0.05
material = "rubber"

[[rod]]
name = "a"
section = "thick"
length = 1.0
elements = 4
direction = [1, 0, 0]
"""
    + PART
    + LINE
    + """
[[support]]
kind = "pin"
at = "a.start"

[[joint]]
kind = "hinge"
first = "a.end"
second = "top.eye"
axis = [0, 1, 0]

[[joint]]
kind = "ball"
first = "line.node 4"
second = "top.centre + (-1.0, -0.1, 0.0)"

[[load]]
kind = "gravity"
acceleration = [0, 0, -9.81]

[[initial]]
part = "line"
momentum = [0.0, 0.05, 0.0]

[run]
t_end = 0.2
dt = 5e-4
save_every = 0.02
"""
)


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3))
def top(q, c):
    inertia = np.diag([0.05, 0.05, 0.09])
    kinetic = 0.5 * 2.0 * cy.dot(q.x_t, q.x_t) + 0.5 * cy.dot(q.p_t, inertia @ q.p_t)
    return kinetic - 9.81 * 2.0 * (q.x[2] + 0.1 * q.p.rotate(cy.E3)[2])


@cy.lagrangian(x=cy.Vector(3), s=cy.Interval)
def line(q, c):
    return 0.5 * 0.3 * cy.dot(q.x_t, q.x_t) - 0.5 * 2000.0 * (cy.norm(q.x_s) - 1.0) ** 2


def written():
    """The model of the file, in Python."""
    rubber = cy.Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.5)
    a = cy.Rod(cy.Section.circle(0.05, rubber), length=1.0, elements=4, direction=(1, 0, 0), name="a")
    one = cy.LagrangianPart(lagrangian=top, position=(1, 0.1, -0.2), ports={"eye": (0, -0.1, 0.2)}, name="top")
    domain = cy.Interval(0.0, 1.0, elements=4)
    other = cy.LagrangianPart(lagrangian=line, domain=domain, position=(0, 0, -1.2), name="line")
    ties = [
        joints.hinge(a.end, one.port("eye"), axis=(0, 1, 0)),
        joints.ball(other.end, one.centre.offset((-1.0, -0.1, 0.0))),
    ]
    return cy.Model(a, one, other, supports=[supports.pin(a.start)], joints=ties, loads=[loads.gravity((0, 0, -9.81))])


def test_a_file_runs_as_python(tmp_path):
    scenario = parse(FILE, name="own", file="own.toml")
    run = cy.simulate(scenario.model(), **scenario.options())
    initial = {"line": {"momentum": (0.0, 0.05, 0.0)}}
    other = cy.simulate(written(), 0.2, 5e-4, initial=initial, save_every=0.02)
    for name in ("a", "top", "line"):
        assert_allclose(run[name].position.values, other[name].position.values, atol=1e-13)
    assert "top: Lagrangian top" in str(scenario.model())
    meshio = pytest.importorskip("meshio")
    export(run, "vtk", tmp_path)
    mesh = meshio.read(tmp_path / "line_000010.vtu")
    assert_allclose(mesh.points, run["line"].position.values[-1])
    assert [len(block.data) for block in mesh.cells] == [4]


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("b*r33", "b*q33", 'part #1.lagrangian: "0.5*m*(vx**2 + vy'),
        ("b = 0.1 }", "b = 0.1, g = 9.81 }", 'part #1.constants: has "g", which lagrangian does not use'),
        ("b = 0.1 }", "b = 0.1, wx = 1.0 }", 'part #1.constants: has "wx"; allowed: names other than t, x, y'),
        ("elements = 4\nposition = [0.0", "position = [0.0", "part #2.elements: is missing; allowed: length and"),
        ('name = "line"', 'name = "top"', 'part #2.name: is "top" again; allowed: a name of its own'),
        ('fields = "position"', 'fields = "places"', 'part #2.fields: is "places"; allowed: "both", "position"'),
        ('part = "line"', 'part = "lime"', 'initial #1.part: is "lime" (did you mean "line"?)'),
        ('part = "line"', 'part = "line"\nrod = "a"', "initial #1.part: is given beside rod; allowed: one of the two"),
        ("line.node 4", "line.centre", 'joint #2.first: is "line.centre"'),
    ],
)
def test_problems(old, new, line):
    assert FILE.count(old) == 1
    with pytest.raises(ScenarioError) as told:
        parse(FILE.replace(old, new), name="own", file="own.toml")
    assert line in str(told.value)
