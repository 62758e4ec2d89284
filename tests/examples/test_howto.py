"""The blocks of Python of a how-to page run one after the other, as a reader would type them."""

import re
import runpy
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]


def test_buckling(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "howto-buckling.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```$", page, re.M | re.S)
    assert len(blocks) >= 4
    path = tmp_path / "page.py"
    path.write_text("\n".join(blocks), encoding="utf-8")
    found = runpy.run_path(str(path))
    assert (tmp_path / "column.png").stat().st_size > 10_000
    assert len(found["snap"].limits) == 2


def test_damping_and_loads(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "howto-damping-and-loads.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```$", page, re.M | re.S)
    assert len(blocks) >= 5
    path = tmp_path / "page.py"
    path.write_text("\n".join(blocks), encoding="utf-8")
    found = runpy.run_path(str(path))
    assert np.isfinite(found["run"].energy).all()
    assert float(abs(found["told"].energy_balance.defect[-1])) < 1e-6
