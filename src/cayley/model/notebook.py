"""Small tables that notebooks show instead of a repr."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape


def html_table(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """A table of two columns, as HTML; both are plain text. A first cell that is the same as above is left empty."""
    lines, before = [], None
    for name, value in rows:
        shown = "" if name == before else escape(name)
        cell = '<td style="text-align: left">'
        lines.append(f"<tr>{cell}{shown}</td>{cell}{escape(value)}</td></tr>")
        before = name
    return f'<table><caption style="text-align: left">{escape(title)}</caption>{"".join(lines)}</table>'
