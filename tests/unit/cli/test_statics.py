"""`cayley statics` from end to end."""

import numpy as np
import pytest
from typer.testing import CliRunner

from cayley.cli.main import app
from cayley.results.trajectory import Trajectory

STATICS = "\n[statics]\ntime = 0.005\n"


@pytest.fixture
def call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(app, list(arguments), env={"COLUMNS": "120"})


def without_run(text):
    return text[: text.index("[run]")]


def turned_at_the_end(text):
    """A beam that is clamped, and the moment at its other end."""
    return text.replace('"pin"', '"clamp"').replace('beam.start"\nvalue', 'beam.end"\nvalue')


def test_tables_store_and_picture(call, small, tmp_path):
    text = without_run(turned_at_the_end(small)) + '\n[statics]\nspin = [0, 0, 2]\nrule = "midpoint"\n'
    (tmp_path / "beam.toml").write_text(text)
    result = call("statics", "beam.toml")
    assert result.exit_code == 0, result.output
    folder = tmp_path / "runs" / "beam"
    assert sorted(file.name for file in folder.iterdir()) == ["rest.png", "rest.zarr", "scenario.toml"]
    assert (folder / "rest.png").read_bytes().startswith(b"\x89PNG")
    lines = result.stdout.splitlines()
    assert lines[0].startswith("Model: 1 rod")
    assert any(line.startswith("<Equilibrium: stable") for line in lines)
    assert any(line.startswith("beam  ") and "-1.00098" in line for line in lines)
    held = next(line for line in lines if line.startswith("clamp beam.start"))
    assert held.split()[2:] == ["0", "0", "0.981", "0", "0", "0"]
    opened = Trajectory.open(folder / "rest.zarr")
    assert opened["beam"].sizes["time"] == 1
    assert opened.reaction(opened.model.supports[0]).force.values[0] == pytest.approx([0, 0, 0.981])


def test_a_time_of_loads(call, small, tmp_path):
    (tmp_path / "small.toml").write_text(turned_at_the_end(small) + STATICS)
    assert call("statics", "small.toml", "--no-picture", "--quiet", "--out", "there").output == ""
    assert sorted(file.name for file in (tmp_path / "there").iterdir()) == ["rest.zarr", "scenario.toml"]
    opened = Trajectory.open(tmp_path / "there" / "rest.zarr")
    assert opened.time == pytest.approx([0.005])
    at_end = 0.1 * np.sin(np.pi * 0.005 / 2)
    assert np.abs(opened["beam"].moment.values).max() == pytest.approx(at_end, rel=0.5)


def test_what_is_wrong(call, small, tmp_path):
    (tmp_path / "bad.toml").write_text(without_run(small) + '\n[statics]\nspin = "fast"\n')
    result = call("statics", "bad.toml")
    assert result.exit_code == 2
    assert "statics.spin" in result.stderr
    assert "a number, or three in brackets [rad/s]" in result.stderr
    (tmp_path / "bare.toml").write_text(without_run(small))
    assert "a [run] table with t_end, or one of [statics], [modes], [trace]" in call("statics", "bare.toml").stderr
    (tmp_path / "rest.toml").write_text(without_run(small) + "\n[statics]\n")
    refused = call("run", "rest.toml")
    assert (refused.exit_code, refused.stderr) == (2, "rest.toml: run: is missing; allowed: a [run] table with t_end\n")


def test_no_equilibrium_has_code_3(call, small, tmp_path):
    free = without_run(small).replace('[[support]]\nkind = "pin"\nat = "beam.start"\n', "")
    (tmp_path / "free.toml").write_text(free + "\n[statics]\n")
    result = call("statics", "free.toml")
    assert result.exit_code == 3
    assert "nothing holds the model where its loads push it" in result.stderr
    assert result.stderr.count("\n") == 1
