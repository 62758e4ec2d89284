"""From a model and a parameter to the system that paths and buckling loads are found of."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cayley.continuation.parameter import Scaled, scaled
from cayley.discrete.rules import Rule
from cayley.model import Model, validate
from cayley.statics import ROUNDING, values_of
from cayley.steppers.still import Still
from cayley.system.discretize import discretize, initial_values, spans
from cayley.system.legendre import in_one_hemisphere


@dataclass(frozen=True, slots=True, kw_only=True)
class Prepared:
    """A system whose time is the parameter.

    Args:
        scaled: the model whose time is the parameter.
        still: its system.
        inertia: mass matrices by which stiffness is raised [1/s²].
        parts: nodes of each part by name.
    """

    scaled: Scaled
    still: Still
    inertia: float
    parts: Mapping[str, slice]


def prepared(
    owner: str, model: Any, parameter: Any, at: float, *, start: Any, initial: Any, time: Any, rule: Rule
) -> Prepared:
    """Check the arguments that trace and buckling share, and put the system where the search begins.

    Args:
        owner: for messages.
        model: the model.
        parameter: see trace.
        at: λ to begin at.
        start: see trace.
        initial: see trace.
        time: see trace.
        rule: see trace.

    Raises:
        TypeError: if the model or parameter is none.
        ValueError: if an argument does not fit.
    """
    if not isinstance(model, Model):
        raise TypeError(f"{owner}: {model!r} is no Model; make one with cy.Model(...)")
    if start is not None and initial is not None:
        raise ValueError(f"{owner}: both start and initial are given; give one")
    made = scaled(owner, model, parameter, validate.number(owner, "time", time, "s"))
    system = discretize(made.model, rule)
    values = initial_values(model, system, initial or {})[0] if start is None else values_of(start, system.reference)
    values = in_one_hemisphere(system, values)
    still = Still.at(system, values, at)
    made.put(still, at)
    if start is not None and hasattr(start, "still") and start.still.multipliers.shape == still.multipliers.shape:
        still.put(values, start.still.multipliers)
    parts = dict(zip(model.names, spans(model, rule.degree), strict=True))
    return Prepared(scaled=made, still=still, inertia=ROUNDING * still.fastest(), parts=parts)
