"""`cayley advise`, and scenarios that give an accuracy."""

import pytest
from typer.testing import CliRunner

from cayley.cli.main import app
from cayley.cli.scenario import parse
from cayley.results.trajectory import Trajectory


@pytest.fixture
def call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(app, list(arguments), env={"COLUMNS": "120"})


@pytest.fixture
def accurate(spoiled):
    return spoiled('rule = "nodal"', "accuracy = 1e-2")


def test_advise_prints_a_table_and_runs_nothing(call, accurate, tmp_path):
    (tmp_path / "small.toml").write_text(accurate)
    result = call("advise", "small.toml")
    assert result.exit_code == 0, result.output
    lines = result.stdout.splitlines()
    assert lines[0].startswith("Rules for an accuracy of 0.01")
    assert lines[1].split() == ["rule", "step", "[s]", "steps", "time", "[s]", "error"]
    assert {line.split()[0] for line in lines[2:6]} == {"verlet", "midpoint", "galerkin(time=2)", "galerkin(time=3)"}
    assert lines[2].rstrip().endswith("the cheapest")
    assert [path.name for path in tmp_path.iterdir()] == ["small.toml"]


@pytest.mark.parametrize("given", ["0", "-1", "0.5"])
def test_advise_for_no_accuracy(call, accurate, tmp_path, given):
    (tmp_path / "small.toml").write_text(accurate)
    result = call("advise", "small.toml", "--accuracy", given)
    assert result.exit_code == 2
    assert result.stderr.startswith("small.toml: accuracy is ")
    assert result.stderr.count("\n") == 1


def test_advise_of_a_file_that_is_wrong(call):
    result = call("advise", "nosuch.toml")
    assert result.exit_code == 2
    assert result.stderr.startswith("nosuch.toml: no such file; ")


def test_run_with_an_accuracy(call, accurate, tmp_path):
    (tmp_path / "small.toml").write_text(accurate)
    result = call("run", "small.toml", "--no-report")
    assert result.exit_code == 0, result.output
    assert "verlet with dt = " in result.stdout
    assert Trajectory.open(tmp_path / "runs" / "small" / "run.zarr").error_estimate <= 1e-2


def test_a_rule_beside_the_accuracy_is_kept(spoiled):
    options = parse(spoiled("save_every", "accuracy = 1e-4\nsave_every"), name="some", file="some.toml").options()
    assert (options["rule"].name, options["accuracy"], options["dt"]) == ("nodal", 1e-4, None)


def test_accuracy_beside_dt(call, spoiled, tmp_path):
    (tmp_path / "bad.toml").write_text(spoiled("save_every", "dt = 1e-4\naccuracy = 1e-4\nsave_every"))
    result = call("run", "bad.toml")
    assert (result.exit_code, result.stderr) == (
        2,
        "bad.toml: run.accuracy: is given beside dt; allowed: one of the two\n",
    )
