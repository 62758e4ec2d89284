"""The page as a whole: self-contained, complete, escaped."""

import base64
import re
import subprocess
import sys
from html.parser import HTMLParser

import pytest

from cayley import Trajectory
from cayley.report import citation, write_report


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.text = [], [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_data(self, data):
        self.text += data


@pytest.fixture(scope="module")
def page(crane_report):
    assert list(crane_report.parent.iterdir()) == [crane_report]
    return crane_report.read_text(encoding="utf-8")


@pytest.fixture
def own(crane):
    """A run of a Lagrangian of one's own: no model, no parts."""
    return Trajectory(frames=crane.frames, info=crane.info, outline=crane.outline, observed=crane.observed)


def test_nothing_is_loaded(page):
    parsed = Page(page)
    assert "iframe" not in parsed.tags
    sources = [value for name, value in parsed.attributes if name in ("src", "href")]
    assert len([value for value in sources if value.startswith("data:image/svg+xml;base64,")]) == 5
    assert all(value.startswith("data:") for value in sources)
    assert "url(" not in page
    assert "@import" not in page
    assert "fetch(`frames?" in page  # by the page of `cayley view` alone
    assert '"live":false' in page


def test_pictures_are_whole_and_do_not_depend_on_fonts(page):
    for data in re.findall(r"svg\+xml;base64,([A-Za-z0-9+/=]+)", page):
        picture = base64.b64decode(data).decode("utf-8")
        assert picture.rstrip().endswith("</svg>")
        assert "<text" not in picture


def test_what_is_in_it(page):
    text = Page(page).text
    for part in (
        "A <crane> & more",
        "energy balance, largest defect",
        "Snapshots and stress resultants",
        "Stress resultants of boom over the time.",
        "What we found",
        "One < two.",
        "clamp at mast.start",
        'value = "<t>"',
        *citation(),
        "casadi 3",
    ):
        assert part in text
    assert page.index("What we found") > page.index("Figures for print")


def test_without_a_model(own, tmp_path):
    """Graphs and the table, but no figures of parts; the same run gives the same file."""
    first, second = (write_report(own, tmp_path / name).read_bytes() for name in ("a.html", "b.html"))
    assert first == second
    assert b"Linear momentum" in first
    assert b"Figures for print" not in first


def test_the_table_needs_no_matplotlib():
    code = "import sys, cayley.cli.execute; print({'matplotlib'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
