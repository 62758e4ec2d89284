"""The code of every page of the documents runs, block after block, as a reader would type it.

Blocks marked `python` run; those of other programs are marked `py`. A block with prompts is a doctest.
"""

import doctest
import logging
import re
import runpy
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = [page for page in sorted(DOCS.glob("*.md")) if "```python" in page.read_text(encoding="utf-8")]
matplotlib.use("Agg")


def blocks(page: Path) -> tuple[list[str], list[str]]:
    """Blocks of Python on a page: plain ones, and doctests."""
    found = re.findall(r"^```python\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)
    return [code for code in found if ">>> " not in code], [code for code in found if ">>> " in code]


def test_there_are_pages() -> None:
    names = {page.stem for page in PAGES}
    assert {"tutorial", "howto-drive", "howto-joints", "howto-restart", "from-pyelastica"} <= names


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_page(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All blocks of a page in one file: a Lagrangian's source is looked up when it fails."""
    plain, prompted = blocks(page)
    assert bool(plain) != bool(prompted), "blocks with prompts and without do not mix: they share no names"
    if prompted:
        found = doctest.testfile(
            str(page), module_relative=False, optionflags=doctest.ELLIPSIS, globs={"folder": tmp_path}
        )
        assert found.attempted >= len(prompted)
        assert not found.failed
        return
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "page.py"
    path.write_text("\n".join(plain), encoding="utf-8")
    handlers, level = list(logging.root.handlers), logging.root.level
    names = runpy.run_path(str(path))
    logging.root.handlers, logging.root.level = handlers, level  # a page may turn on messages
    plt.close("all")
    assert np.isfinite(names["run"].energy).all() if "run" in names else names
