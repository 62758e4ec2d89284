"""From the tables of damping and of loads along rods to objects of the model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cayley.cli import expressions
from cayley.cli.force_tables import DENSITY_NAMES, DampingTable, DensityTable
from cayley.model import Rod, damping, loads
from cayley.model.damping import Damping
from cayley.model.loads import Load

_NAMES = {
    "velocity": ("x", "y", "z", "t"),
    "tension": ("t",),
    "offset": ("s",),
    "value": ("s", "t"),
    "amount": ("s", "t"),
    "change": ("s", "t"),
}
"""What the expressions under a key may name."""


def damping_of(table: DampingTable | None) -> Damping | None:
    """The damping of a rod.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value does not fit, or one of ratio and frequency is there without the other.
    """
    if table is None:
        return None
    if (table.ratio is None) != (table.frequency is None):
        raise ValueError("damping: ratio and frequency must be given together")
    parts = []
    if table.retardation is not None:
        parts.append(damping.retardation(table.retardation))
    if table.decay is not None:
        parts.append(damping.mass_proportional(table.decay))
    if table.viscosity is not None:
        parts.append(damping.viscous(table.viscosity))
    if table.ratio is not None and table.frequency is not None:
        parts.append(damping.ratio(table.ratio, frequency=table.frequency))
    if table.rayleigh is not None:
        (z1, f1), (z2, f2) = table.rayleigh
        parts.append(damping.rayleigh((z1, f1), (z2, f2)))
    if not parts:
        raise ValueError("damping: is empty; give retardation, decay, viscosity, ratio or rayleigh")
    return sum(parts[1:], start=parts[0])


def wrong_parts(table: Any) -> list[tuple[tuple[str | int, ...], str, str]]:
    """Expressions of a load along a rod that cannot be used: key, what is written, and what is wrong."""
    found: list[tuple[tuple[str | int, ...], str, str]] = []
    for key, names in _keys(table).items():
        value = getattr(table, key)
        for k, part in enumerate(value if isinstance(value, list) else [value]):
            wrong = expressions.check_fields(part, names) if isinstance(part, str) else None
            if wrong:
                place = (key, k) if isinstance(value, list) else (key,)
                found.append((place, part, f"{wrong}; allowed: {expressions.language(names)}"))
    return found


def rod_load(table: Any, rod: Rod) -> Load:
    """The load that a table describes.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value does not fit.
    """
    window = {"start": table.start, "until": table.until}
    if isinstance(table, DensityTable):
        return loads.density(rod, _Written(tuple(table.force), table.on), **window)
    values = table.model_dump(exclude={"kind", "rod", "start", "until"})
    for key, names in _keys(table).items():
        values[key] = _function(values[key], names, ("x", "t") if key == "velocity" else names)
    first = {"temperature": "change", "tendon": "tension", "imposed_strain": "strain"}.get(table.kind, "value")
    given = [values.pop(first)] if first in values else []
    made: Load = getattr(loads, table.kind)(rod, *given, **values, **window)
    return made


def _keys(table: Any) -> dict[str, Sequence[str]]:
    if isinstance(table, DensityTable):
        return {"force": DENSITY_NAMES[table.on]}
    return {key: names for key, names in _NAMES.items() if key in type(table).model_fields}


def _function(given: Any, names: Sequence[str], arguments: Sequence[str]) -> Any:
    """Numbers as they are; with an expression among them a function."""
    several = given if isinstance(given, list) else [given]
    if not any(isinstance(part, str) for part in several):
        return given
    return expressions.Fields(tuple(several), tuple(names), tuple(arguments), vector=isinstance(given, list))


class _Written:
    """A force density of expressions: a function (q, c) -> [(F, e)]."""

    arguments = ("q", "c")

    def __init__(self, sources: tuple[str | float, ...], on: str) -> None:
        """Parse the expressions.

        Raises:
            ValueError: there are not as many as components.
        """
        wanted = 6 if on == "strain" else 3
        if len(sources) != wanted:
            raise ValueError(f"density: force holds {len(sources)} components, but on = {on!r} takes {wanted}")
        self._on = on
        self._fields = expressions.Fields(sources, DENSITY_NAMES[on], DENSITY_NAMES[on], vector=True)

    @property
    def __name__(self) -> str:
        """The expressions, and what they work on."""
        return f"{self._fields.__name__} on {self._on}"

    def __call__(self, q: Any, c: Any) -> list[tuple[Any, Any]]:
        """The pair of the force and what it works on."""
        from cayley.density.force import rate  # with CasADi behind it, which checking a file does not need

        if self._on != "strain":
            found = self._fields(q.s, q.t, *q.x, *q.x_t, *q.p_t)
            return [(found, q.x if self._on == "position" else q.p)]
        strain = np.concatenate([q.p.inverse_rotate(q.x_s) - np.array([0.0, 0.0, 1.0]), q.p_s])
        return [(self._fields(q.s, q.t, *strain, *rate(strain)), strain)]


__all__ = ["damping_of", "rod_load", "wrong_parts"]
