"""`cayley modes`: what it prints, writes and refuses."""

import pytest
import xarray as xr
from typer.testing import CliRunner

from cayley.cli.main import app

SCENARIO = """
title = "Blade"
[material.steel]
density = 7850.0
youngs_modulus = 2e11
poisson_ratio = 0.3
[section.plate]
shape = "rectangle"
material = "steel"
width = 0.06
height = 0.03
[[rod]]
name = "blade"
section = "plate"
length = 2.0
elements = 4
direction = [1.0, 0.0, 0.0]
[[support]]
kind = "clamp"
at = "blade.start"
[run]
t_end = 1.0
"""


@pytest.fixture
def cayley(tmp_path):
    def call(text, *arguments):
        file = tmp_path / "blade.toml"
        file.write_text(SCENARIO + text)
        options = ["--out", str(tmp_path / "out"), *arguments]
        return CliRunner().invoke(app, ["modes", str(file), *options], env={"COLUMNS": "120"})

    return call


def test_a_table_a_store_a_picture_and_a_page(cayley, tmp_path):
    result = cayley("[modes]\ncount = 3\nspeeds = [0.0, 20.0]\n")
    assert result.exit_code == 0, result.output
    assert "frequency" in result.stdout
    assert "blade along z" in result.stdout
    folder = tmp_path / "out"
    store = xr.open_zarr(folder / "modes.zarr", consolidated=False)
    assert store["frequency"].shape == (3,)
    assert store["blade.displacement"].shape == (3, 5, 3)
    assert (folder / "modes.png").read_bytes()[:4] == b"\x89PNG"
    assert (folder / "campbell.png").read_bytes()[:4] == b"\x89PNG"
    page = (folder / "modes.html").read_text(encoding="utf-8")
    assert page.count("<tr data-scene=") == 3
    assert "Campbell diagram" in page
    assert "mode 2: " in page


def test_options_come_before_the_file(cayley, tmp_path):
    result = cayley("", "--count", "1", "--no-report", "--quiet")
    assert result.exit_code == 0
    assert result.stdout == ""
    assert not (tmp_path / "out" / "modes.html").exists()
    assert xr.open_zarr(tmp_path / "out" / "modes.zarr", consolidated=False)["frequency"].shape == (1,)


def test_problems_are_told_in_a_line(cayley):
    wrong = cayley("[modes]\ncont = 3\n")
    assert wrong.exit_code == 2
    assert 'modes.cont: is no key (did you mean "count"?)' in wrong.stderr
    across = cayley('[modes]\nspin = [0.0, 1.0, 0.0]\n[[load]]\nkind = "gravity"\nacceleration = [0.0, 0.0, -9.81]\n')
    assert across.exit_code == 2
    assert "is not along the spin" in across.stderr
    nowhere = cayley('[modes]\nabout = "reference"\n[[load]]\nkind = "gravity"\nacceleration = [0.0, 0.0, -9.81]\n')
    assert nowhere.exit_code == 0
