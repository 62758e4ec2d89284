"""The documents: links lead somewhere, the scenario page runs and names every key, its messages are those one gets.

The blocks of Python of all pages run in tests/examples.
"""

import ast
import re
import runpy
from fnmatch import fnmatch
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import cayley as cy
from cayley.cli import contact_schema, scenario, schema, tie_schema
from cayley.cli.problems import ScenarioError
from cayley.discrete.rules import RULES

ROOT = Path(__file__).parents[2]
DOCS = [*(ROOT / "docs").glob("*.md"), *(ROOT / "docs" / "adr").glob("*.md")]  # not what the site's build makes
PAGES = sorted([*ROOT.glob("*.md"), *DOCS, ROOT / "benchmarks" / "README.md"])
SCENARIO_PAGE = (ROOT / "docs" / "scenario-files.md").read_text(encoding="utf-8")


def links(page: Path) -> list[str]:
    """Targets of all links and pictures on a page, outside of code."""
    text = re.sub(r"^```.*?^```$|^    .*?$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    text = re.sub(r"`[^`\n]*`", "", text)
    return re.findall(r"\]\(([^)\s]+)\)", text)


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def blocks(language: str) -> list[str]:
    """The blocks of code of one language on the scenario page."""
    return re.findall(rf"^```{language}\n(.*?)^```$", SCENARIO_PAGE, re.M | re.S)


def test_there_are_pages() -> None:
    names = {page.relative_to(ROOT).as_posix() for page in PAGES}
    assert {"README.md", "docs/theory.md", "docs/conventions.md", "docs/architecture.md", "CHANGELOG.md"} <= names
    assert sum(len(links(page)) for page in PAGES) > 60


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_relative_links_lead_somewhere(page: Path) -> None:
    for link in links(page):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), f"{link} leads nowhere"
        assert not anchor or anchor in anchors(target), f"{link}: no such heading"


def test_decisions_are_numbered_without_gaps_and_listed_in_the_readme() -> None:
    found = sorted((ROOT / "docs" / "adr").glob("*.md"))
    assert [page.name[:4] for page in found] == [f"{k + 1:04d}" for k in range(len(found))]
    readme = links(ROOT / "README.md")
    for k, page in enumerate(found):
        assert page.read_text(encoding="utf-8").startswith(f"# {k + 1}. ")
        assert page.relative_to(ROOT).as_posix() in readme


def test_every_page_is_in_the_site() -> None:
    """Named in the contents, or matched by a pattern in them."""
    contents = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    patterns = re.findall(r"^[\w*/-]+$", contents, flags=re.M)
    pages = {page.stem for page in (ROOT / "docs").glob("*.md")} - {"index"}
    assert not sorted(name for name in pages if not any(fnmatch(name, pattern) for pattern in patterns))


def test_every_example_has_a_title_for_the_gallery() -> None:
    """What the site's build makes of it is still that script, under a heading."""
    titled = runpy.run_path(str(ROOT / "docs" / "_ext" / "staging.py"))["titled"]
    for path in sorted((ROOT / "examples").rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        made = ast.parse(titled(source))
        title, line, *_ = (ast.get_docstring(made) or "").splitlines()
        assert 3 < len(title) < 75, f"{path.name}: the title is {title!r}"
        assert re.fullmatch(r"=+", line)
        assert ast.dump(ast.Module(made.body[1:], [])) == ast.dump(ast.Module(ast.parse(source).body[1:], []))


def test_the_scenario_of_the_tutorial_runs() -> None:
    (text,) = re.findall(
        r"^```toml\n(.*?)^```$", (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8"), re.M | re.S
    )
    made = scenario.parse(text, name="cord", file="cord.toml")
    assert np.isfinite(cy.simulate(made.model(), **made.options()).energy).all()


def test_the_scenario_on_the_page_runs() -> None:
    (text,) = blocks("toml")
    made = scenario.parse(text, name="page", file="page.toml")
    run = cy.simulate(made.model(), **made.options())
    assert np.isfinite(run.energy).all()
    assert run.time[-1] == pytest.approx(made.run.t_end)


def test_every_key_and_word_of_a_scenario_is_on_the_page() -> None:
    known = [*vars(schema).values(), *vars(tie_schema).values(), *vars(contact_schema).values()]
    tables = [kind for kind in known if isinstance(kind, type) and issubclass(kind, schema.Table)]
    keys = {key for table in tables if table is not schema.ScenarioTables for key in table.model_fields}
    missing = sorted(key for key in keys if f"`{key}`" not in SCENARIO_PAGE)
    assert not missing
    words = {
        word
        for table in tables
        for field in table.model_fields.values()
        for option in (field.annotation, *get_args(field.annotation))
        for word in get_args(option)
        if isinstance(word, str)
    }
    words |= set(RULES)
    assert {"rectangle", "hold", "line_moment", "body", "verlet"} <= words
    assert not sorted(word for word in words if f'"{word}"' not in SCENARIO_PAGE)


def test_messages_on_the_page_are_those_one_gets() -> None:
    base = scenario.shipped()["leitz2014"].read_text(encoding="utf-8")
    edits = (
        ("width =", "with ="),
        ("length = 2.0", "length = -2.0"),
        ('material = "rubber"', 'material = "ruber"'),
        ('at = "beam.start"\nvalue', 'at = "beam.stat"\nvalue'),
        ("1.5*sin(pi*t/2)*cos(pi*t/4)", "sin(w*t)"),
        ("dt = 1e-4", "dt = 4e-4"),
    )
    (page,) = blocks("text")
    told = []
    for old, new in edits:
        assert base.count(old) == 1
        try:
            made = scenario.parse(base.replace(old, new), name="beam", file="beam.toml")
            cy.simulate(made.model(), **made.options())
        except ScenarioError as error:
            told += error.problems
        except ValueError as error:
            told.append(f"beam.toml: {error}")
    assert page.splitlines() == told
