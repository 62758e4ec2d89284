"""`cayley trace` and its table."""

import pytest
from typer.testing import CliRunner

from cayley.cli.main import app
from cayley.results.trajectory import Trajectory

COLUMN = """
[material.rubber]
density = 1000.0
youngs_modulus = 5e6
poisson_ratio = 0.35

[section.strip]
shape = "rectangle"
width = 0.01
height = 0.02
material = "rubber"

[[rod]]
name = "column"
section = "strip"
length = 0.2
elements = 8

[[support]]
kind = "clamp"
at = "column.start"

[[load]]
kind = "gravity"
acceleration = [0, 0, -9.81]

[[load]]
kind = "force"
at = "column.end"
value = [0, 0, -0.01]

[run]
t_end = 1.0

[trace]
parameter = "load #2"
range = [0.0, 60.0]
points = 30
branches = 1
of = "column.end"
"""


@pytest.fixture
def call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def called(text):
        (tmp_path / "column.toml").write_text(text)
        return CliRunner().invoke(app, ["trace", "column.toml"], env={"COLUMNS": "120"})

    return called


def test_trace_follows_a_path_and_its_branches(call, tmp_path):
    result = call(COLUMN)
    assert result.exit_code == 0, result.output
    lines = [line.split() for line in result.stdout.splitlines()]
    assert lines[0] == ["Paths", "of", "equilibria"]
    assert lines[2] == ["path", "0", "0", "begin", "0"]
    assert lines[3][0] == "path"
    assert lines[3][3:] == ["bifurcation", "1"]
    assert [line[0] for line in lines[5:9]] == ["branch-1-plus"] * 2 + ["branch-1-minus"] * 2
    folder = tmp_path / "runs" / "column"
    names = {"path.zarr", "branch-1-plus.zarr", "branch-1-minus.zarr", "trace.png", "scenario.toml"}
    assert {file.name for file in folder.iterdir()} == names
    assert (folder / "trace.png").read_bytes().startswith(b"\x89PNG")
    run = Trajectory.open(folder / "path.zarr")
    assert run.time[int(lines[3][1])] == pytest.approx(float(lines[3][2]), rel=1e-7)
    bent = Trajectory.open(folder / "branch-1-plus.zarr")
    assert abs(bent["column"].position.values[-1, -1, 0]) > 0.05


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            '"load #2"',
            '"load #3"',
            'parameter: is "load #3" (did you mean "load #2"?); allowed: time, load #1, load #2',
        ),
        ('"load #2"', '["time", "load #2"]', 'parameter: is "time"; allowed: load #1, load #2'),
        ("[0.0, 60.0]", "[1.0, 1.0]", "range: is [1.0, 1.0]; allowed: two different numbers in brackets"),
        ("points = 30", "begin = 70.0", "begin: is 70; allowed: a number in the range, 0 to 60"),
        ("points = 30", "points = 1", "points: is 1; allowed: a whole number, at least 2"),
        ("points = 30", "pointz = 30", 'pointz: is no key (did you mean "points"?); allowed: parameter, range'),
        (
            '"column.end"\n',
            '"column.eend"\n',
            'of: is "column.eend" (did you mean "column.end"?); allowed: ',
        ),
    ],
)
def test_what_is_wrong_is_told_by_its_place(call, old, new, line):
    head, tail = COLUMN.split("[trace]")
    assert old in tail
    result = call(f"{head}[trace]{tail.replace(old, new)}")
    assert result.exit_code == 2
    assert result.stderr.startswith(f"column.toml: trace.{line}"), result.stderr
    assert result.stderr.count("\n") == 1


def test_a_file_without_a_table_and_one_without_an_equilibrium(call):
    result = call(COLUMN.split("[trace]")[0])
    assert result.exit_code == 2
    assert result.stderr == "column.toml: trace is missing; allowed: a [trace] table with a parameter\n"
    free = COLUMN.replace('[[support]]\nkind = "clamp"\nat = "column.start"\n', "")
    result = call(free)
    assert result.exit_code == 3
    assert result.stderr.startswith("column.toml: trace: no equilibrium found at load factor = 0 to begin at")
