"""resume, check, schema, new, export, doctor: from end to end."""

import json
import tomllib

import jsonschema
import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from cayley.cli.files import TEMPLATES
from cayley.cli.main import app
from cayley.cli.scenario import shipped
from cayley.results.trajectory import Trajectory


@pytest.fixture
def call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(app, list(arguments), env={"COLUMNS": "120"})


def test_resume_goes_on_as_if_it_had_never_stopped(call, small, spoiled, tmp_path):
    (tmp_path / "whole.toml").write_text(small)
    (tmp_path / "half.toml").write_text(spoiled("t_end = 0.02", "t_end = 0.01"))
    for name in ("whole", "half"):
        assert call("run", f"{name}.toml", "--no-report", "--quiet").exit_code == 0
    result = call("resume", "runs/half", "--until", "0.02", "--no-report", "--json")
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert (told["frames"], told["t_end"]) == (21, 0.02)
    half, whole = (Trajectory.open(tmp_path / "runs" / name / "run.zarr") for name in ("half", "whole"))
    assert np.array_equal(half.frames.values, whole.frames.values)
    again = call("resume", "runs/half")
    assert again.exit_code == 2
    assert "give a later t_end" in again.stderr
    assert call("resume", "nowhere").exit_code == 2


def test_check(call, small, spoiled, tmp_path):
    (tmp_path / "good.toml").write_text(small)
    (tmp_path / "bad.toml").write_text(spoiled("elements", "element"))
    good = call("check", "good.toml")
    assert (good.exit_code, good.stdout.splitlines()[-1]) == (0, "good.toml: nothing is wrong")
    bad = call("check", "bad.toml")
    assert bad.exit_code == 2
    assert 'did you mean "elements"?' in bad.stderr
    told = json.loads(call("check", "bad.toml", "--json").stdout)
    assert len(told["problems"]) == 1


def test_the_schema_accepts_what_is_shipped_and_refuses_a_wrong_key(call):
    schema = json.loads(call("schema").stdout)
    checker = jsonschema.Draft202012Validator(schema)
    for file in shipped().values():
        assert not list(checker.iter_errors(tomllib.loads(file.read_text())))
    wrong = tomllib.loads(next(iter(shipped().values())).read_text()) | {"rodd": []}
    assert list(checker.iter_errors(wrong))


@pytest.mark.parametrize("template", TEMPLATES)
def test_new_files_are_right(call, template, tmp_path):
    made = call("new", "mine", "--template", template)
    assert made.exit_code == 0, made.output
    assert made.stdout.split(": ")[-1] == f"cayley {'trace' if template == 'column' else 'run'} mine.toml\n"
    assert call("check", "mine.toml").exit_code == 0
    assert call("new", "mine").exit_code == 2


def test_new_refuses(call):
    assert 'did you mean "cantilever"?' in call("new", "mine", "--template", "cantilver").stderr
    assert call("new", "mine?").exit_code == 2


def test_export(call, small, tmp_path):
    meshio = pytest.importorskip("meshio")
    (tmp_path / "small.toml").write_text(small)
    assert call("run", "small.toml", "--no-report", "--quiet").exit_code == 0
    run = Trajectory.open(tmp_path / "runs" / "small" / "run.zarr")
    for kind in ("csv", "netcdf", "vtk"):
        result = call("export", "runs/small", "--to", kind)
        assert result.exit_code == 0, result.output
    table = np.genfromtxt(tmp_path / "runs/small/csv/beam.csv", delimiter=",", names=True)
    assert len(table) == run["beam"].position.sizes["time"] * run["beam"].position.sizes["node"]
    assert np.array_equal(table["position_z"], run["beam"].position.sel(axis="z").values.reshape(-1))
    stored = xr.open_dataset(tmp_path / "runs/small/netcdf.nc", group="beam", engine="h5netcdf")
    assert np.array_equal(stored.moment, run["beam"].moment)
    mesh = meshio.read(tmp_path / "runs/small/vtk/beam_000003.vtu")
    middle = mesh.points.reshape(run["beam"].sizes["node"], -1, 3).mean(axis=1)
    assert np.abs(middle - run["beam"].position.values[3]).max() < 1e-12
    assert (tmp_path / "runs/small/vtk/beam.pvd").read_text().count("<DataSet") == 21
    refused = call("export", "runs/small", "--to", "excel")
    assert (refused.exit_code, "allowed: csv, netcdf, vtk" in refused.stderr) == (2, True)


def test_doctor(call):
    result = call("doctor")
    assert result.exit_code == 0, result.output
    assert "doubles side by side" in result.stdout


def test_sweep_runs_all_combinations(call, small, tmp_path):
    (tmp_path / "small.toml").write_text(small)
    result = call(
        "sweep", "small.toml", "--set", "material.rubber.youngs_modulus=4e6,5e6", "--set", "run.t_end=0.01,0.02"
    )
    assert result.exit_code == 0, result.output
    table = np.genfromtxt(
        tmp_path / "runs/small_sweep/sweep.csv", delimiter=",", names=True, dtype=None, encoding="utf-8"
    )
    assert sorted(table["runt_end"].tolist()) == [0.01, 0.01, 0.02, 0.02]
    assert set(table["outcome"]) == {"finished"}
    last = Trajectory.open(tmp_path / "runs/small_sweep/0004/run.zarr")
    assert table["beam_end_x_m"][3] == last["beam"].position.values[-1, -1, 0]


def test_sweep_refuses(call, small, tmp_path):
    (tmp_path / "small.toml").write_text(small)
    for setting, text in {
        "run.t_end": "give KEY=V1,V2",
        "run.t_end=-1": "run.t_end: is -1",
        "section.nothing.radius=1": "there is no 'nothing'",
        "load.7.until=1": "neither a name nor a number from 1",
    }.items():
        result = call("sweep", "small.toml", "--set", setting)
        assert (result.exit_code, text in result.stderr) == (2, True), result.stderr
    assert not (tmp_path / "runs").exists()


def test_cite_names_the_methods_of_a_run(call, small, spoiled, tmp_path):
    (tmp_path / "small.toml").write_text(spoiled('"nodal"', '"screw"'))
    assert call("run", "small.toml", "--no-report", "--quiet").exit_code == 0
    told = call("cite", "runs/small").stdout
    for key in ("@software{cayley", "leitz2014", "marsden2001", "simo1985", "hante2022"):
        assert key in told
    assert "leok2012" not in told


def test_saves_by_steps_at_times_and_of_some_places(call, small, spoiled, tmp_path):
    every = "save_every = 0.001"
    for name, text in {
        "steps": "save_steps = 7",
        "at": "save_at = [0.004, 0.01]",
        "only": 'save_only = ["beam.end"]',
    }.items():
        (tmp_path / f"{name}.toml").write_text(spoiled(every, text))
        result = call("run", f"{name}.toml", "--quiet")
        assert result.exit_code == 0, result.output
    assert Trajectory.open(tmp_path / "runs/steps/run.zarr").frames.steps[1] == 7
    assert len(Trajectory.open(tmp_path / "runs/at/run.zarr").time) == 4
    only = Trajectory.open(tmp_path / "runs/only/run.zarr")
    assert only.frames.values.shape[1] == 1
    assert '"name":"beam.end"' in (tmp_path / "runs/only/report.html").read_text()
    (tmp_path / "both.toml").write_text(spoiled(every, every + "\nsave_steps = 7"))
    assert "save_steps: is given beside save_every" in call("check", "both.toml").stderr
    (tmp_path / "none.toml").write_text(spoiled(every, 'save_only = ["mast"]'))
    assert call("check", "none.toml").exit_code == 2
