"""The examples and the README's snippets run as they stand; the examples assert their own reference values."""

import re
import runpy
import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").rglob("*.py"))
matplotlib.use("Agg")  # no window, whatever the screen
SNIPPETS = re.findall(r"^```python\n(.*?)^```$", (ROOT / "README.md").read_text(encoding="utf-8"), re.M | re.S)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example(path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """It runs, says something and draws something: these are the pages of the gallery."""
    monkeypatch.setattr(plt, "show", lambda: None)
    monkeypatch.setattr(sys, "argv", [str(path)])
    found = runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out
    assert plt.get_fignums() or found["figure"].axes
    plt.close("all")


def test_there_are_examples_and_snippets() -> None:
    assert {"paper_beam", "own_density_string", "heavy_top", "rubber_pendulum"} <= {path.stem for path in EXAMPLES}
    assert len(EXAMPLES) >= 20
    assert len(SNIPPETS) >= 2


@pytest.mark.parametrize("k", range(len(SNIPPETS)))
def test_readme_snippet(k: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "snippet.py"  # a file, for a Lagrangian's source is looked up when it fails
    path.write_text(SNIPPETS[k], encoding="utf-8")
    found = runpy.run_path(str(path))
    assert np.isfinite(found["run"].energy).all()


def test_first_readme_snippet_drops_the_rod(tmp_path: Path) -> None:
    """Let go from the horizontal, the tip of a soft rod has after one second nearly swung through and back up."""
    path = tmp_path / "snippet.py"
    path.write_text(SNIPPETS[0], encoding="utf-8")
    found = runpy.run_path(str(path))
    run, rod = found["run"], found["rod"]
    start, end = (run[rod].position.isel(time=k, node=-1).values for k in (0, -1))
    assert np.allclose(start, (1.0, 0.0, 0.0))
    assert np.abs(end - (-0.939, 0.0, -0.102)).max() < 2e-3
    assert np.ptp(run.energy) < 1e-5 * float(run.kinetic_energy.max())
