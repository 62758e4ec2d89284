"""One line for each thing that is wrong with a scenario file: where it is, what is wrong, what is allowed."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import ValidationError

from cayley.cli.schema import Place, discriminator, located


class ScenarioError(ValueError):
    """A scenario file that cannot be run.

    Attributes:
        problems: one line each, `FILE: key.path: what is wrong; allowed: ...`.
    """

    def __init__(self, file: str, problems: Iterable[str]) -> None:
        """Put the name of the file before each problem."""
        self.problems = tuple(f"{file}: {problem}" for problem in problems)
        super().__init__("\n".join(self.problems))


def of_validation(error: ValidationError) -> list[str]:
    """The problems pydantic found, one line for each key."""
    unknown: dict[Place, str] = {}
    wrong: dict[Place, str] = {}
    meant: set[Place] = set()
    for entry in error.errors(include_url=False):
        kind, value = entry["type"], entry["input"]
        place, table = located(entry["loc"])
        if kind == "extra_forbidden" and table is not None:
            near = nearest(place[-1], table.model_fields)
            meant |= {(*place[:-1], near)} if near else set()
            unknown[place] = f"is no key{_hint(near)}; allowed: {', '.join(table.model_fields)}"
        elif kind.startswith("union_tag"):
            key, words = discriminator(place)
            text = unlike(value[key], words) if key in value else f"is missing; allowed: {', '.join(words)}"
            wrong[(*place, key)] = text
        else:
            right = "a table" if table is None else table.model_fields[str(place[-1])].description
            is_part = isinstance(entry["loc"][-1], int) and not isinstance(place[-1], int)  # of a list
            found = "is missing" if kind == "missing" else f"{'holds' if is_part else 'is'} {shown(value)}"
            wrong.setdefault(place, f"{found}; allowed: {right}")
    # a misspelt key that is needed is missing as well: say it once
    lines = unknown | {place: text for place, text in wrong.items() if place not in meant}
    return [f"{path(place)}: {text}" for place, text in lines.items()]


def path(place: Place) -> str:
    """A place as text; entries of an array of tables are numbered from 1, as in `load #2.value`."""
    text = ""
    for part in place:
        text += f" #{part + 1}" if isinstance(part, int) else f".{part}" if text else part
    return text


def unlike(value: Any, allowed: Iterable[str]) -> str:
    """What to say of a word that is none of those allowed."""
    words = list(allowed)
    return f"is {shown(value)}{_hint(nearest(value, words))}; allowed: {', '.join(words) or 'none, for there are none'}"


def nearest(value: Any, words: Iterable[str]) -> str | None:
    """The word that was probably meant."""
    return next(iter(difflib.get_close_matches(str(value), list(words), n=1)), None)


def shown(value: Any) -> str:
    """A value about as TOML writes it, shortened."""
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        return "an array of tables"
    text = json.dumps(value, default=str, ensure_ascii=False).replace("Infinity", "inf").replace("NaN", "nan")
    return text if len(text) <= 60 else f"{text[:57]}..."


def _hint(near: str | None) -> str:
    return f' (did you mean "{near}"?)' if near else ""
