"""Our docstrings as reStructuredText: formulas stand in blocks, one-line sections become fields."""

import re
from typing import Any

_SECTION = re.compile(r"^(Args|Attributes|Raises|Returns|Yields|Source|Example|Examples|Note):")
_ARRAY = re.compile(
    r"(?:~?numpy\.)?ndarray\[tuple\[(?:~?typing\.)?Any, \.\.\.\], (?:~?numpy\.)?dtype\[(?:~?numpy\.)?float64\]\]"
)
_RELATION = re.compile(r"[=≤≥≈→∝<>]|->")


def process(app: Any, what: str, name: str, found: Any, options: Any, lines: list[str]) -> None:
    """Rewrite a docstring in place, paragraph by paragraph."""
    if name.startswith("cayley") and lines:
        lines[:] = as_rst(lines)
        if what in ("attribute", "data", "property"):  # napoleon takes what stands before a colon for a type
            lines[0] = lines[0].replace(": ", " – ", 1)


def as_rst(lines: list[str]) -> list[str]:
    """A whole docstring."""
    return [line for paragraph in _paragraphs(lines) for line in [*rewritten(paragraph), ""]]


def shorten(
    app: Any, what: str, name: str, found: Any, options: Any, signature: str | None, returns: str | None
) -> tuple[str | None, str | None]:
    """Arrays of floats are Array in signatures, as in the source; shapes stand in the text."""
    return tuple(given and _ARRAY.sub("Array", given) for given in (signature, returns))  # type: ignore[return-value]


def plain(line: str) -> str:
    """A line in which |x| is a magnitude; code in backticks and examples stay as they are."""
    if line.lstrip().startswith((">>>", "...")):
        return line
    return "".join(part if k % 2 else part.replace("|", r"\|") for k, part in enumerate(re.split(r"(`[^`]*`)", line)))


def rewritten(paragraph: list[str]) -> list[str]:
    """One paragraph of a docstring.

    A formula is a paragraph with a relation in it and no full stop at its end; it is kept as it is written.
    "Returns: x" and "Source: x" in one line become fields.
    """
    written, paragraph = paragraph, [plain(line) for line in paragraph]
    first = paragraph[0]
    head = re.match(r"^(Returns|Source): (\S.*)$", first)
    if head:
        field = "returns" if head[1] == "Returns" else "source"
        return [f":{field}: {head[2]}", *(f"    {line.strip()}" for line in paragraph[1:])]
    if first.startswith(" ") or _SECTION.match(first) or first.startswith((">>>", "- ", "* ", ".. ", "1. ")):
        return paragraph
    if _RELATION.search(" ".join(paragraph)) and not paragraph[-1].rstrip().endswith((".", ":", ";", "?")):
        return [".. code-block:: none", "   :class: formula", "", *(f"   {line}" for line in written)]
    return paragraph


def _paragraphs(lines: list[str]) -> list[list[str]]:
    """Runs of lines that are not empty; a section with its indented lines stays together."""
    found: list[list[str]] = []
    fresh = True
    for line in lines:
        if not line.strip():
            fresh = True
            continue
        if fresh and found and line.startswith(" "):
            found[-1] += ["", line]
        elif fresh:
            found.append([line])
        else:
            found[-1].append(line)
        fresh = False
    return found


def setup(app: Any) -> dict[str, bool]:
    """Before napoleon sees them."""
    app.connect("autodoc-process-docstring", process, priority=400)
    app.connect("autodoc-process-signature", shorten)
    return {"parallel_read_safe": True}
