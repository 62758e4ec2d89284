"""Obstacles and contact in scenario files: the model they give, files of meshes, and one line for what is wrong."""

import pytest
from typer.testing import CliRunner

from cayley.cli.main import app
from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import load, parse

TEXT = """
[material.steel]
density = 7850.0
youngs_modulus = 2e11
poisson_ratio = 0.3

[section.wire]
shape = "circle"
material = "steel"
radius = 0.01

[section.strip]
shape = "rectangle"
material = "steel"
width = 0.03
height = 0.04

[[rod]]
name = "rope"
section = "wire"
length = 1.0
elements = 2

[[rod]]
name = "strip"
section = "strip"
length = 1.0
elements = 2

[[body]]
name = "drum"
mass = 1.0
inertia = [1, 1, 1]

[[body]]
name = "point"
mass = 1.0

[[obstacle]]
shape = "plane"
friction = 0.5

[[obstacle]]
shape = "cylinder"
name = "shell"
on = "drum"
radius = 0.1
length = 2.0
axis = [0, 2, 0]

[[obstacle]]
shape = "mesh"
name = "lid"
vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
triangles = [[0, 1, 2]]
scale = 2.0
center = [0, 0, 5]

[contact]
friction = 0.3
self_contact = ["rope"]
radii = { strip = 0.02 }
without = [["strip", "plane"], ["rope", "drum"]]

[run]
t_end = 1.0
"""


def test_model():
    model = parse(TEXT, name="touch", file="touch.toml").model()
    assert str(model).splitlines()[6:-2] == [
        "  obstacles",
        "    plane: through (0, 0, 0), normal (0, 0, 1), friction 0.5",
        "    shell: cylinder, radius 0.1 m, length 2 m, center (0, 0, 0), axis (0, 1, 0), on drum",
        "    lid: mesh, open, 3 vertices, 1 triangle",
        "  contact",
        "    friction 0.3, penetration 0.01 radii, damping 0.05, self-contact of 1 rod",
        "    radius of strip: 0.02 m",
    ]
    rope, strip = model.rods
    floor, shell, lid = model.obstacles
    assert lid.vertices.tolist() == [[0, 0, 5], [2, 0, 5], [0, 2, 5]]
    assert model.contact.excludes(strip, floor)
    assert model.contact.excludes(rope, shell)


def test_a_mesh_file_goes_with_its_scenario(tmp_path, monkeypatch):
    """It is looked for beside the scenario, and copied where that goes."""
    meshio = pytest.importorskip("meshio")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there" / "parts").mkdir(parents=True)
    (tmp_path / "copy").mkdir()
    points = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]
    meshio.write_points_cells(tmp_path / "there/parts/lid.obj", points, [("triangle", [[0, 1, 2]])])
    lines = [line for line in TEXT.splitlines() if not line.startswith(("vertices", "triangles"))]
    text = "\n".join(lines).replace("scale = 2.0", 'scale = 2.0\nfile = "parts/lid.obj"')
    (tmp_path / "there" / "touch.toml").write_text(text)
    scenario = load("there/touch.toml")
    scenario.write(tmp_path / "copy")
    again = load("copy/scenario.toml").model()
    assert str(again) == str(scenario.model())
    assert again.obstacles[2].vertices.tolist() == [[0, 0, 5], [2, 0, 5], [0, 2, 5]]


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ('shape = "plane"', 'shape = "plan"', 'obstacle #1.shape: is "plan" (did you mean "plane"?); allowed: plane'),
        ("[[obstacle]]", "[[obstacles]]", 'obstacles: is no key (did you mean "obstacle"?)'),
        ('on = "drum"', 'on = "drun"', 'obstacle #2.on: is "drun" (did you mean "drum"?); allowed: drum'),
        ('on = "drum"', 'on = "point"', 'obstacle #2.on: is "point"; allowed: a [[body]] with inertia'),
        ("radius = 0.1\n", "radius = 0\n", "obstacle #2.radius: is 0; allowed: a positive number [m]"),
        ("axis = [0, 2, 0]", "axis = [0, 0, 0]", "obstacle #2: axis = [0.0, 0.0, 0.0] must be a vector other"),
        ("[[0, 1, 2]]", "[[0, 1, 3]]", "obstacle #3: triangle 0 is (0, 1, 3), but vertices go from 0 to 2"),
        ("[[0, 1, 2]]", "[[0, 1]]", "obstacle #3.triangles: holds [0, 1]; allowed: three indices of vertices each"),
        ("triangles =", "file =", "obstacle #3.file: is [[0, 1, 2]]; allowed: the name of a file"),
        ("triangles = [[0, 1, 2]]\n", "", "obstacle #3.file: is missing; allowed: the name of a file, or vertices and"),
        ("scale = 2.0", 'file = "a.stl"', "obstacle #3.vertices: is given beside file; allowed: one of the two"),
        ('name = "lid"', 'name = "shell"', 'obstacle #3.name: is "shell" again; allowed: a name of its own'),
        ("radius = 0.01", "radius = 1e300", "section.wire: a number is too large or too small to calculate with"),
        ("friction = 0.3", "friction = -1", "contact.friction: is -1; allowed: a number from 0 [-]"),
        ("friction = 0.3", "frictio = 0.3", 'contact.frictio: is no key (did you mean "friction"?); allowed: friction'),
        ('["rope"]', '["rop"]', 'contact.self_contact: is "rop" (did you mean "rope"?); allowed: rope, strip'),
        ("{ strip = 0.02 }", "{ strip = 0 }", "contact.radii: is 0; allowed: a table of names of rods, with"),
        ("{ strip = 0.02 }", "{ strip = 1, drum = 1 }", "contact.radii.drum: is no rod; allowed: rope, strip"),
        ("{ strip = 0.02 }", "{}", "contact.radii: has no strip, whose section is not round; allowed: such as radii"),
        ('["strip", "plane"]', '["strip", "floor"]', 'contact.without #1: is "floor"; allowed: rope, strip, drum,'),
        ('["strip", "plane"]', '["strip"]', "contact.without: holds ["),
        ('name = "shell"', 'name = "drum"', 'contact.without #2: "drum" is a part and an obstacle; name one'),
    ],
)
def test_what_is_wrong_is_told_in_a_line(old, new, line):
    assert old in TEXT
    with pytest.raises(ScenarioError) as caught:
        parse(TEXT.replace(old, new, 1), name="touch", file="touch.toml")
    assert caught.value.problems[0].startswith(f"touch.toml: {line}")


@pytest.mark.parametrize(
    ("file", "told"), [("none.stl", "there is no file"), ("../a.stl", "allowed: a file in or below the folder of the")]
)
def test_mesh_files_that_are_not_there(tmp_path, file, told):
    lines = [line for line in TEXT.splitlines() if not line.startswith(("vertices", "triangles"))]
    path = tmp_path / "touch.toml"
    path.write_text("\n".join(lines).replace("scale = 2.0", f'file = "{file}"'))
    result = CliRunner().invoke(app, ["check", str(path)])
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert "obstacle #3" in line
    assert told in line
