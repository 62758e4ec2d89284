"""Sections that change along a rod: one for each element, or a function of the arc length."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.model import validate
from cayley.model.samples import basis, chebyshev
from cayley.model.section import Section
from cayley.model.validate import Array

PER_ELEMENT = 5
"""Sections that a function is asked for in every element: a straight taper has area moments of degree 4."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Stations:
    """The sections of a rod whose section changes, at stations in every element.

    One station: the section is constant in an element. Several: they stand at its Chebyshev points, ends included, and
    stiffness, mass and inertia are the polynomials through them.

    Attributes:
        sections: of each element, at each of its stations, shape (elements, stations).
        name: a few words that name them in listings.

    Raises:
        TypeError: something is no Section.
        ValueError: elements with different numbers of stations, or outlines with different numbers of points.
    """

    sections: tuple[tuple[Section, ...], ...]
    name: str = ""

    def __post_init__(self) -> None:
        """Check the sections."""
        for e, own in enumerate(self.sections):
            for section in own:
                if not isinstance(section, Section):
                    raise TypeError(validate.wrong("Rod", f"section of element {e}", section, "a Section"))
        if len({len(own) for own in self.sections}) != 1:
            raise ValueError("Rod: its elements have different numbers of sections; give all the same number")
        corners = sorted({len(section.outline) for own in self.sections for section in own})
        if len(corners) > 1:
            raise ValueError(
                f"Rod: the outlines of its sections have {' and '.join(str(n) for n in corners)} points; give sections "
                "of one shape"
            )
        if not self.name:
            first, last = self.sections[0][0].name, self.sections[-1][-1].name
            object.__setattr__(self, "name", first if first == last else f"{first} to {last}")

    def __repr__(self) -> str:
        """The first and the last, in one line."""
        return f"Stations({self.name!r}, elements={len(self.sections)})"

    @property
    def count(self) -> int:
        """Stations of an element."""
        return len(self.sections[0])

    def samples(self, name: str) -> Array:
        """An attribute of the sections at all stations, shape (elements, stations, *shape of it)."""
        return np.array([[getattr(section, name) for section in own] for own in self.sections])

    def at(self, name: str, places: Array) -> Array:
        """An attribute of the sections at places in [0, 1] of every element, shape (elements, places, *shape of it)."""
        found: Array = np.einsum("pk,ek...->ep...", basis(self.count, places), self.samples(name))
        return found


def stations(owner: str, given: Any, ends: Array) -> Section | Stations:
    """A section, or sections along a rod, from what a user gives.

    Args:
        owner: the rod, for messages.
        given: a Section; one for each element; or a function of the arc length s [m] that returns one.
        ends: arc length of the nodes [m], shape (elements + 1,).

    Raises:
        TypeError: none of these.
        ValueError: another number of sections than of elements, or outlines of different shape.
    """
    if isinstance(given, (Section, Stations)):
        elements = len(ends) - 1
        if isinstance(given, Stations) and len(given.sections) != elements:
            right = f"one for each of the {elements} elements"
            raise ValueError(f"{owner}: section has stations for {len(given.sections)} elements, but must have {right}")
        return given
    if callable(given):
        return _sampled(given, ends)
    right = "a Section, one for each element, or a function of s that returns one"
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise TypeError(validate.wrong(owner, "section", given, right))
    for section in given:
        if not isinstance(section, Section):
            raise TypeError(validate.wrong(owner, "section", section, right))
    if len(given) != len(ends) - 1:
        raise ValueError(f"{owner}: section has {len(given)} sections, but must have {len(ends) - 1}, one an element")
    if all(section is given[0] for section in given):
        return given[0]
    return Stations(tuple((section,) for section in given))


def _sampled(function: Callable[[float], Section], ends: Array) -> Stations:
    """The sections that a function gives at the stations of every element."""
    places = chebyshev(PER_ELEMENT)
    found: dict[float, Section] = {}  # neighbors share a station
    rows = []
    for a, b in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        at = [*(a + (b - a) * float(u) for u in places[:-1]), b]
        for s in at:
            if s not in found:
                found[s] = function(s)
        rows.append(tuple(found[s] for s in at))
    return Stations(tuple(rows))


__all__ = ["PER_ELEMENT", "Stations", "stations"]
