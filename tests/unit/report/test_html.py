"""The page as a whole: self-contained, complete, escaped."""

import base64
import re
import subprocess
import sys
from html.parser import HTMLParser

import pytest

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
def page(make_run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    path = write_report(
        make_run(),
        folder / "report.html",
        title="Rods & <beams>",
        scenario_text='[run]\nvalue = "<t>"',
        notes=("What we found", "One < two.", "Three."),
        times=[0.0, 0.3],
        nodes=[0, 5, 11],
    )
    assert list(folder.iterdir()) == [path]
    return path.read_text(encoding="utf-8")


def test_nothing_is_loaded(page):
    parsed = Page(page)
    assert not {"script", "link", "iframe"} & set(parsed.tags)
    sources = [value for name, value in parsed.attributes if name in ("src", "href")]
    assert len(sources) == 4
    assert all(value.startswith("data:image/svg+xml;base64,") for value in sources)
    assert "url(" not in page
    assert "@import" not in page


def test_pictures_are_whole_and_do_not_depend_on_fonts(page):
    for data in re.findall(r"base64,([A-Za-z0-9+/=]+)", page):
        picture = base64.b64decode(data).decode("utf-8")
        assert picture.rstrip().endswith("</svg>")
        assert "<text" not in picture


def test_what_is_in_it(page):
    text = Page(page).text
    for part in (
        "Rods & <beams>",
        "angular momentum z, spread",
        "Energy and momenta",
        "Snapshots",
        "Stress resultants",
        "What we found",
        "One < two.",
        "pin at rod.start",
        'value = "<t>"',
        *citation(),
        "casadi 3",
    ):
        assert part in text
    assert page.index("What we found") > page.index("Stress resultants")


def test_several_rods(make_run, tmp_path):
    text = Page(write_report(make_run(count=2), tmp_path / "r.html", nodes=[11]).read_text(encoding="utf-8")).text
    assert "Stress resultants of rod2" in text


def test_without_rods(own_run, tmp_path):
    text = Page(write_report(own_run, tmp_path / "r.html").read_text(encoding="utf-8")).text
    assert "Energy and momenta" in text
    assert "Stress resultants" not in text


def test_the_same_run_gives_the_same_file(own_run, tmp_path):
    first, second = (write_report(own_run, tmp_path / name).read_bytes() for name in ("a.html", "b.html"))
    assert first == second


def test_the_table_needs_no_matplotlib():
    code = "import sys, cayley.cli.execute; print({'matplotlib', 'plotly'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
