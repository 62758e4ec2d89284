"""The examples and the README's snippets run as they stand; the examples assert their own reference values."""

import re
import runpy
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
GALLERY = sorted((ROOT / "examples" / "gallery").glob("plot_*.py"))
SNIPPETS = re.findall(r"^```python\n(.*?)^```$", (ROOT / "README.md").read_text(encoding="utf-8"), re.M | re.S)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out


@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_gallery(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each page asserts its own values, prints them beside the published ones, and ends with a figure."""
    with mpl.rc_context(), plt.ioff():
        mpl.use("agg")
        found = runpy.run_path(str(path), run_name="__main__")
    plt.close("all")
    assert found["figure"].axes
    assert capsys.readouterr().out


def test_there_are_examples_and_snippets() -> None:
    assert {"paper_beam", "own_density_string", "heavy_top", "rubber_pendulum"} <= {path.stem for path in EXAMPLES}
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
