"""Forces that no Lagrangian has: pairs (F, e) of a force and the quantity whose variation it works on."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from cayley.density.expression import Expression, from_sx, symbols, to_sx, wrap

NODE, STRAIN, SPREAD = "node", "strain", "spread"
"""Where a pair stands: at the nodes if it has no slope in it, else at the strain points of elements, as an internal
force (STRAIN) if e has slopes, as an outer one (SPREAD) if only F has."""
KINDS = STILL, MOVING = "still", "moving"
"""Whether F depends on velocities."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Force:
    """Virtual work of non-conservative forces, δW = Σ F·δe = Σ over slots f·δ(slot).

    Args:
        rates: d/dt of every derivative along the interval ("x_s", "p_s"), as symbols; for rotations dΩ/dt.
        terms: (place, kind) -> slot -> f, a column; place is NODE, STRAIN or SPREAD, kind STILL or MOVING.
    """

    rates: Mapping[str, Expression]
    terms: Mapping[tuple[str, str], Mapping[str, ca.SX]]
    _cache: dict = field(default_factory=dict, repr=False)

    def between_nodes(self, kind: str) -> bool:
        """Tell whether any force of a kind stands at strain points."""
        return (STRAIN, kind) in self.terms or (SPREAD, kind) in self.terms

    @property
    def columns(self) -> list[ca.SX]:
        """Every expression with a word for its place, for signatures."""
        return [value for key in sorted(self.terms) for _, value in sorted(self.terms[key].items())]

    @property
    def words(self) -> str:
        """What the columns are, for signatures."""
        return ";".join(f"{'.'.join(key)}:{slot}" for key in sorted(self.terms) for slot in sorted(self.terms[key]))


class ForceError(ValueError):
    """A force that cannot be traced; its message says all, so nothing is put around it."""


_RATES: ContextVar[Callable[[Any], Any] | None] = ContextVar("rates", default=None)


def rate(e: Any) -> Any:
    """Rate de/dt of an expression of fields and their slopes, for use in a force.

    de/dt = Σ ∂e/∂q · q̇ + Σ ∂e/∂q′ · q̇′ + ∂e/∂t,    dΩ/dt = ω′ + Ω × ω

    Args:
        e: a number or a vector, such as a strain, in the body of a force function.

    Returns: its rate, of the same shape.

    Raises:
        TypeError: outside a force function.
        ValueError: if e depends on velocities.
    """
    found = _RATES.get()
    if found is None:
        raise TypeError("cy.rate: there is no motion here; use it in a force=function(q, c) of cy.lagrangian")
    return found(e)


def trace_force(
    function: Callable[[Any, Any], Any],
    q: Any,
    c: Any,
    where: str,
    *,
    fields: tuple[str, ...],
    slots: Mapping[str, Expression],
    rotations: Mapping[str, Any],
    places: Mapping[str, Expression],
    along: str | None,
) -> Force:
    """Call a force function once on symbols.

    Args:
        function: function (q, c) -> pairs (F, e).
        q: the names it may use.
        c: the constants.
        where: what messages begin with.
        fields: names of the fields.
        slots: symbols of fields and derivatives.
        rotations: what q gives for each rotation; as e it stands for the variation η, δp = ½ p η.
        places: symbols of coordinate and time.
        along: name of the coordinate, or None.

    Returns: the Force.

    Raises:
        ValueError: if what it returns is no list of pairs, shapes differ, or some e depends on velocities.
    """
    slopes = [f"{name}_{along}" for name in fields] if along else []
    rates = {name: symbols(f"{name}_rate", slots[name].size) for name in slopes}
    velocities = ca.vertcat(*[to_sx(slots[f"{n}_t"]) for n in fields], *[to_sx(r) for r in rates.values()])
    with _rates(fields, slots, rates, places["t"], velocities, where):
        pairs = function(q, c)
    if not isinstance(pairs, list | tuple) or not all(isinstance(p, list | tuple) and len(p) == 2 for p in pairs):
        raise ValueError(f"{where} returns {type(pairs).__name__}; it must return a list of pairs (F, e)")
    varied = ca.vertcat(*[to_sx(slots[name]) for name in slopes])
    sums: dict[tuple[str, str], dict[str, ca.SX]] = {}
    for k, (given, on) in enumerate(pairs):
        force, quantity = _pair(given, on, slots, rotations, f"{where}, its pair {k}")
        if ca.depends_on(quantity, velocities):
            raise ValueError(
                f"{where}, its pair {k}: the quantity depends on a velocity; it may depend on fields and slopes only"
            )
        place = NODE
        if slopes and ca.depends_on(quantity, varied):
            place = STRAIN
        elif slopes and ca.depends_on(force, ca.vertcat(varied, *[to_sx(r) for r in rates.values()])):
            place = SPREAD
        own = sums.setdefault((place, MOVING if ca.depends_on(force, velocities) else STILL), {})
        for name in (*fields, *slopes):
            pulled = ca.jacobian(quantity, to_sx(slots[name])).T @ force
            if not pulled.is_zero():
                own[name] = own.get(name, ca.SX.zeros(pulled.shape)) + ca.densify(pulled)
    return Force(rates=rates, terms={key: own for key, own in sums.items() if own})


@contextmanager
def _rates(
    fields: tuple[str, ...],
    slots: Mapping[str, Expression],
    rates: Mapping[str, Expression],
    time: Expression,
    velocities: ca.SX,
    where: str,
) -> Iterator[None]:
    """Let cy.rate work: the direction in which time takes every slot."""
    at = ca.vertcat(*[to_sx(slots[n]) for n in (*fields, *rates)], to_sx(time))
    direction = ca.vertcat(*[to_sx(slots[f"{n}_t"]) for n in fields], *[to_sx(r) for r in rates.values()], 1)

    def of(e: Any) -> Any:
        column = to_sx(np.atleast_1d(np.asarray(e, dtype=object)).reshape(-1))
        if ca.depends_on(column, velocities):
            raise ValueError(f"{where}: cy.rate of what depends on a velocity would be an acceleration")
        found = wrap(np.atleast_1d(from_sx(ca.densify(ca.jtimes(column, at, direction)))))
        return found[0] if np.ndim(e) == 0 else found.reshape(np.shape(e))

    token = _RATES.set(of)
    try:
        yield
    finally:
        _RATES.reset(token)


def _pair(
    given: Any, on: Any, slots: Mapping[str, Expression], rotations: Mapping[str, Any], where: str
) -> tuple[ca.SX, ca.SX]:
    """Columns of F and e, of one length."""
    for name, rotation in rotations.items():
        if on is rotation:
            on = slots[name]
        if given is rotation:
            raise ValueError(f"{where}: the force is the rotation q.{name}; give a vector")
    if np.ndim(on) > 1 or np.shape(given) != np.shape(on):
        shapes = f"the force has shape {np.shape(given)}, the quantity {np.shape(on)}"
        raise ValueError(f"{where}: {shapes}; give two numbers or two vectors of one length")
    return (ca.densify(to_sx(np.atleast_1d(np.asarray(v, dtype=object)))) for v in (given, on))  # type: ignore


__all__ = ["KINDS", "MOVING", "NODE", "SPREAD", "STILL", "STRAIN", "Force", "ForceError", "rate", "trace_force"]
