"""Pages that show the files of the repository, so that a link to a formula's file leads to it within the site."""

import importlib
import inspect
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

from docutils import nodes
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import TextLexer, get_lexer_for_filename
from pygments.util import ClassNotFound
from sphinx.util import logging

ROOT = Path(__file__).resolve().parents[2]
SHOWN = ("src/cayley", "examples")
"""Folders whose files all have a page; others have one if a document links to them."""
LINKED: set[Path] = set()
KINDS = (".py", ".c", ".h", ".toml", ".txt")
SCHEME = "source:"
_LOG = logging.getLogger(__name__)


def files() -> list[Path]:
    """All files that have a page."""
    inside = (path for folder in SHOWN for path in (ROOT / folder).rglob("*") if path.suffix in KINDS)
    found = [path for path in inside if not any(part.startswith((".", "__pycache__")) for part in path.parts[-3:])]
    return sorted({*found, *(path for path in LINKED if path.is_file())})


def folders() -> list[Path]:
    """All folders with such files in them, however deep."""
    above = {parent for path in files() for parent in path.parents if parent.is_relative_to(ROOT)}
    return sorted(above | {path for path in LINKED if path.is_dir()})


def page_of(path: Path) -> str:
    """Name of the page of a file or folder."""
    inside = path.resolve().relative_to(ROOT).as_posix()
    return f"source/{inside}" if path.is_file() else f"source/{inside}/index"


def of_object(module: str, name: str) -> str | None:
    """Page and line of an object, as seen from the pages of the API, which are one folder deep."""
    if not module:
        return None
    try:
        found: Any = importlib.import_module(module)
        for part in name.split("."):
            found = getattr(found, part)
        found = inspect.unwrap(found.fget if isinstance(found, property) else found)
        path, line = inspect.getsourcefile(found), inspect.getsourcelines(found)[1]
    except (AttributeError, ImportError, OSError, TypeError):
        return None
    if path is None or not Path(path).resolve().is_relative_to(ROOT / "src"):
        return None
    return f"../{page_of(Path(path))}.html#L-{line}"


def resolve(app: Any, doctree: nodes.document, docname: str) -> None:
    """Turn links of the scheme into links to the pages."""
    for link in doctree.findall(nodes.reference):
        target = link.get("refuri", "")
        if not target.startswith(SCHEME):
            continue
        path = ROOT / target.removeprefix(SCHEME).partition("#")[0]
        if not path.exists():
            _LOG.warning("%s: %s is no file or folder", docname, target, location=link)
        LINKED.add(path)
        if app.builder.format == "html":
            link["refuri"] = app.builder.get_relative_uri(docname, page_of(path))


def pages(app: Any) -> Iterator[tuple[str, dict[str, str], str]]:
    """The pages, for Sphinx to write."""
    style = HtmlFormatter(linenos="inline", lineanchors="L", anchorlinenos=True, cssclass="highlight")
    for path in files():
        name = path.relative_to(ROOT).as_posix()
        try:
            lexer = get_lexer_for_filename(path.name)
        except ClassNotFound:
            lexer = TextLexer()
        code = highlight(path.read_text(encoding="utf-8"), lexer, style)
        up = f'<p><a href="index.html">{escape(path.parent.relative_to(ROOT).as_posix())}/</a></p>'
        yield (
            page_of(path),
            {"title": name, "body": f"<h1>{escape(name)}</h1>{up}<div class='source-file'>{code}</div>"},
            "page.html",
        )
    known = {*files(), *folders()}
    for folder in folders():
        inside = [path for path in sorted(folder.iterdir()) if path in known]
        items = "".join(
            f'<li><a href="{path.name}{"" if path.is_file() else "/index"}.html">{escape(path.name)}</a>'
            f"{_first_line(path)}</li>"
            for path in inside
        )
        name = folder.relative_to(ROOT).as_posix()
        yield page_of(folder), {"title": name, "body": f"<h1>{escape(name)}/</h1><ul>{items}</ul>"}, "page.html"


def _first_line(path: Path) -> str:
    """What a file says about itself."""
    path = path / "__init__.py" if path.is_dir() else path
    text = path.read_text(encoding="utf-8") if path.suffix == ".py" and path.exists() else ""
    first = text.removeprefix('"""').partition("\n")[0].rstrip('"') if text.startswith('"""') else ""
    return f": {escape(first)}" if first else ""


def setup(app: Any) -> dict[str, bool]:
    """Links when a page is resolved, pages at the end."""
    app.connect("doctree-resolved", resolve)
    app.connect("html-collect-pages", pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
