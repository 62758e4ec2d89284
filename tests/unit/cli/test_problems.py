"""Scenario files that are wrong: one line each, with file, key and what is allowed, exit code 2, and no traceback."""

import pytest
from typer.testing import CliRunner

from cayley.cli.main import app

# old text, new text, added text, what the line says after the name of the file
WRONG = [
    (
        "length = 1.0",
        "lengthx = 1.0",
        "",
        'rod #1.lengthx: is no key (did you mean "length"?); allowed: name, section, ',
    ),
    ("length = 1.0", "length = -1.0", "", "rod #1.length: is -1.0; allowed: a positive number [m]"),
    ("length = 1.0", 'length = "1.0"', "", 'rod #1.length: is "1.0"; allowed: a positive number [m]'),
    ("length = 1.0", "length = true", "", "rod #1.length: is true; allowed: a positive number [m]"),
    ("length = 1.0", "length = inf", "", "rod #1.length: is inf; allowed: a positive number [m]"),
    ("length = 1.0", "", "", "rod #1.length: is missing; allowed: a positive number [m], or curve or points"),
    ("elements = 4", "elements = 4.5", "", "rod #1.elements: is 4.5; allowed: a whole number, at least 1"),
    (
        'section = "square"',
        'section = "squar"',
        "",
        'rod #1.section: is "squar" (did you mean "square"?); allowed: square',
    ),
    ('"beam"', '"a/b"', "", 'rod #1.name: is "a/b"; allowed: '),
    ("direction = [0, 0, -1]", "direction = [0, 0, 0]", "", "rod #1: direction = [0.0, 0.0, 0.0] must be "),
    ("direction = [0, 0, -1]", "direction = [0, 0]", "", "rod #1.direction: is [0, 0]; allowed: three numbers"),
    ("direction = [0, 0, -1]", "direction = [0, 0, nan]", "", "rod #1.direction: holds nan; allowed: three numbers"),
    ('material = "rubber"', 'material = "steel"', "", 'section.square.material: is "steel"; allowed: rubber'),
    ('"rectangle"', '"rectanglo"', "", 'section.square.shape: is "rectanglo" (did you mean "rectangle"?); allowed: '),
    ('shape = "rectangle"', "", "", "section.square.shape: is missing; allowed: rectangle, circle, tube, el"),
    ("width = 0.01", "width = 0.01\nradius = 1", "", "section.square.radius: is no key; allowed: shape, material, "),
    ("poisson_ratio = 0.35", "", "", "material.rubber: neither poisson_ratio nor shear_modulus is given; "),
    (
        "poisson_ratio = 0.35",
        "poisson_ratio = 0.6",
        "",
        "material.rubber.poisson_ratio: is 0.6; allowed: a number above",
    ),
    ("[[rod]]", "[rod]", "", "rod: is a table; allowed: [[rod]] tables"),
    (
        'kind = "pin"',
        'kind = "pinn"',
        "",
        'support #1.kind: is "pinn" (did you mean "pin"?); allowed: pin, clamp, hold',
    ),
    ('kind = "pin"', 'kind = "hold"\nposition = "xx"', "", 'support #1.position: is "xx"; allowed: letters out of'),
    ('kind = "pin"', 'kind = "hold"', "", "support #1: nothing is held; "),
    ('kind = "pin"', 'kind = "clamp"', "", "Model: moment on beam.start has no effect, "),
    (
        'at = "beam.start"',
        'at = "baem.start"',
        "",
        'support #1.at: is "baem.start" (did you mean "beam.start"?); allowed: ',
    ),
    ('at = "beam.start"', 'at = "beam.node 9"', "", "support #1.at: node = 9 must be from 0 to 4"),
    ("[0, 0, -9.81]", '[0, 0, "-9.81*t"]', "", 'load #1.acceleration: holds "-9.81*t"; allowed: three numbers'),
    (
        '"0.1*sin(pi*t/2)"',
        '"0.1*sine(t)"',
        "",
        'load #2.value #1: "0.1*sine(t)" uses the unknown function "sine"; allowed: t',
    ),
    ('"0.1*sin(pi*t/2)"', '"1/t"', "", 'load #2.value #1: "1/t" is no finite number at t = 0 s; allowed: t, pi, '),
    ('frame = "body"', 'frame = "bdy"', "", 'load #2.frame: is "bdy"; allowed: "space" or "body"'),
    ("until = 0.01", "until = -1", "", "load #2: until = -1.0 must be later than start = 0 s"),
    ('rule = "nodal"', 'rule = "euler"', "", 'run.rule: is "euler"; allowed: "nodal", "verlet"'),
    ('rule = "nodal"', "foo = 1", "", "run.foo: is no key; allowed: t_end, dt, rule, save_every, "),
    ("t_end = 0.02", "", "", "run.t_end: is missing; allowed: a positive number [s]"),
    ("t_end = 0.02", "t_end = 0.02\ndt = 0.01", "", "dt is 0.01 s, over the step limit "),
    ("t_end = 0.02", "t_end =", "", "TOML syntax: Invalid value (at line "),
    ("", "", "\n[run]\nt_end = 1", "TOML syntax: Cannot declare ('run',) twice"),
    ("", "", "\n[simulation]\nt_end = 1", "simulation: is no key; allowed: title, material, section, rod, "),
    (
        "",
        "",
        '\n[[rod]]\nname = "beam"\nsection = "square"\nlength = 1\nelements = 1',
        'rod #2.name: is "beam" again; ',
    ),
    ("", "", '\n[[initial]]\nrod = "bam"', 'initial #1.rod: is "bam" (did you mean "beam"?); allowed: beam'),
    (
        "",
        "",
        '\n[[initial]]\nrod = "beam"\nvelocity = [1, 0, 0]\nmomentum = [1, 0, 0]',
        "initial #1.momentum: is given beside velocity; allowed: one of the two",
    ),
    ("", "", "\n[report]\nnodes = [0, 5]", "report.nodes: holds 5; allowed: from 0 to 4, or from -1 back to -5"),
    ("", "", "\n[report]\nsnapshots = [1.0]", "report.snapshots: holds 1; allowed: from 0 to t_end = 0.02 s"),
    (
        "",
        "",
        '\n[section.g]\nshape = "given"\nstiffness = [1, 2]\nmass_per_length = 1\ninertia = [1, 1, 1]',
        "section.g.stiffness: is [1, 2]; allowed: 6 rows of 6 numbers, or the 6 numbers of the diagonal",
    ),
]


def call(*arguments):
    result = CliRunner().invoke(app, list(arguments))
    assert result.exception is None or isinstance(result.exception, SystemExit)
    assert "Traceback" not in result.output
    return result


@pytest.mark.parametrize(("old", "new", "added", "line"), WRONG, ids=[entry[3][:40] for entry in WRONG])
def test_one_line_and_exit_code_2(spoiled, tmp_path, old, new, added, line):
    file = tmp_path / "bad.toml"
    file.write_text(spoiled(old, new, added))
    result = call("run", str(file), "--quiet", "--no-report", "--out", str(tmp_path / "out"))
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{file}: {line}")
    assert result.stderr.count("\n") == 1


def test_several_problems_are_a_line_each(spoiled, tmp_path):
    file = tmp_path / "bad.toml"
    file.write_text(spoiled("length = 1.0", "length = 0", "\n[more]\n").replace("elements = 4", "elements = 0"))
    result = call("run", str(file))
    assert [line.split(": ")[1] for line in result.stderr.splitlines()] == ["more", "rod #1.length", "rod #1.elements"]


def test_empty_file(tmp_path):
    file = tmp_path / "empty.toml"
    file.touch()
    places = [line.split(": ")[1] for line in call("run", str(file)).stderr.splitlines()]
    assert places == ["run"]
    file.write_text("[run]\nt_end = 1.0\n")
    line = call("run", str(file)).stderr.strip()
    assert line == f"{file}: rod: is missing; allowed: at least one [[rod]], [[body]] or [[part]] table"


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("nosuch.toml", "no such file; allowed: a TOML file, or a shipped scenario (leitz2014, rubber_pendulum)"),
        ("leitz2041", 'no such file (did you mean "leitz2014"?); allowed: '),
        (".", "is a directory; allowed: "),
    ],
)
def test_no_file(name, line):
    result = call("run", name)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{name}: {line}")
    assert result.stderr.count("\n") == 1


def test_no_text(tmp_path):
    file = tmp_path / "bad.toml"
    file.write_bytes(b"\xff\xfe")
    assert call("run", str(file)).stderr.startswith(f"{file}: is no text in UTF-8 (byte 0); ")


def test_folder_that_cannot_be(small, tmp_path):
    file = tmp_path / "good.toml"
    file.write_text(small)
    result = call("run", str(file), "--out", str(file))
    assert (result.exit_code, result.stderr) == (2, f"{file}: File exists\n")
