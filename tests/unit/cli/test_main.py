"""Commands from end to end, and that the help stays quick."""

import re
import subprocess
import sys
import threading
import urllib.request
from http.server import ThreadingHTTPServer

import pytest
from typer.main import get_command
from typer.testing import CliRunner

import cayley
from cayley.cli.main import app
from cayley.results.trajectory import Trajectory


@pytest.fixture
def call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(app, list(arguments), env={"COLUMNS": "120"})


def test_version(call):
    assert call("--version").stdout == f"cayley {cayley.__version__}\n"


def test_cite(call):
    software, paper = call("cite").stdout.splitlines()
    assert cayley.__version__ in software
    assert "Leitz" in paper


def test_run_writes_store_scenario_and_report(call, small, tmp_path):
    (tmp_path / "small.toml").write_text(small)
    result = call("run", "small.toml")
    assert result.exit_code == 0, result.output
    folder = tmp_path / "runs" / "small"
    assert sorted(file.name for file in folder.iterdir()) == ["report.html", "run.zarr", "scenario.toml"]
    for part in ("energy, ripple", "angular momentum z, spread", "time per node and step", "runs/small/report.html"):
        assert part in result.stdout
    assert (folder / "scenario.toml").read_text() == small
    assert "A small one" in (folder / "report.html").read_text()
    run = Trajectory.open(folder / "run.zarr")
    assert run["beam"].sizes["time"] == 21


def test_quiet_run_again_replaces_the_store(call, small, tmp_path):
    (tmp_path / "small.toml").write_text(small)
    for _ in range(2):
        result = call("run", "small.toml", "--no-report", "--quiet", "--out", "there")
        assert (result.exit_code, result.output) == (0, "")
    assert sorted(file.name for file in (tmp_path / "there").iterdir()) == ["run.zarr", "scenario.toml"]


def test_run_that_stops_has_code_3_and_keeps_what_it_has(call, spoiled, tmp_path):
    (tmp_path / "wild.toml").write_text(spoiled("t_end = 0.02", "t_end = 0.2\ndt = 1e-3\nallow_unstable = true"))
    result = call("run", "wild.toml", "--quiet")
    assert result.exit_code == 3
    assert result.stderr.startswith("wild.toml: stopped at t = ")
    assert "runs/wild/run.zarr" in result.stderr
    assert result.stderr.count("\n") == 1
    assert (tmp_path / "runs" / "wild" / "run.zarr").is_dir()


def test_a_report_and_a_view_of_a_run_that_is_there(call, small, tmp_path, monkeypatch):
    """Both know the scenario beside the store; the view ends by Ctrl+C."""
    (tmp_path / "small.toml").write_text(small)
    assert call("run", "small.toml", "--no-report", "--quiet", "--out", "there").exit_code == 0
    for given in ("there", "there/run.zarr"):
        result = call("report", given)
        assert (result.exit_code, result.output) == (0, "Report:  there/report.html\n")
    assert "A small one" in (tmp_path / "there" / "report.html").read_text()
    titles = []

    def look_once(serving):
        asked = threading.Thread(target=serving.handle_request)
        asked.start()
        with urllib.request.urlopen(f"http://127.0.0.1:{serving.server_port}/", timeout=10) as answer:
            titles.append(re.search(r"<title>(.*)</title>", answer.read().decode()).group(1))
        asked.join()
        raise KeyboardInterrupt

    monkeypatch.setattr(ThreadingHTTPServer, "serve_forever", look_once)
    result = call("view", "there", "--no-browser")
    assert result.exit_code == 0, result.output
    assert result.output.startswith("there/run.zarr: http://127.0.0.1:")
    assert titles == ["A small one"]


@pytest.mark.parametrize("command", ["report", "view"])
def test_nothing_to_look_at(call, command):
    result = call(command, "nowhere")
    assert (result.exit_code, result.stderr) == (2, "there is no run at nowhere/run.zarr\n")


@pytest.mark.parametrize("command", sorted(get_command(app).commands))
def test_help_has_an_example(call, command):
    """The example begins with the command, or ends with it, after what it needs; and all is one paragraph."""
    shown = " ".join(call(command, "--help").stdout.split())
    assert re.search(rf"Example: (cayley new \w+ --template \w+; )?cayley {command}\b", shown)


def test_help_loads_nothing_heavy():
    code = (
        "import sys; from cayley.cli.main import app; app(['--help'], standalone_mode=False);"
        "print({'numpy', 'pydantic', 'casadi', 'xarray', 'matplotlib'} & set(sys.modules), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "set()"
    assert "run" in done.stdout
