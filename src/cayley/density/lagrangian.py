"""The decorator that turns a Python function into a Lagrangian or Lagrangian density."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from cayley.density.fields import Field, Interval, Rotation, Vector


@dataclass(frozen=True, slots=True)
class Lagrangian:
    """A Lagrangian L(q, q̇, t), or a Lagrangian density L(q, q̇, q′, s, t) on an interval.

    Args:
        function: function (q, c) -> L; q gives the fields and their derivatives, c the constants.
        fields: the fields by name, in order.
        interval: name of the interval's coordinate, or None for a system without one.
        name: name used in messages and listings.
        pose: a rotation and a vector of size 3 that together are the pose of a frame, for the screw rules; or None.
        constraint: function (q, c) -> g(q, q′, s), zero at the strain points of every element; or None.
        defaults: constants that need not be given, with their values.
        force: function (q, c) -> pairs (F, e) of non-conservative forces, δW = Σ F·δe; or None.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), section 4.
    """

    function: Callable[[Any, Any], Any]
    fields: Mapping[str, Field]
    interval: str | None
    name: str
    pose: tuple[str, str] | None = None
    constraint: Callable[[Any, Any], Any] | None = None
    defaults: Mapping[str, Any] = field(default_factory=dict)
    force: Callable[[Any, Any], Any] | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Every name that q offers: fields, their derivatives, the coordinate and the time."""
        suffixes = ("", "_t") if self.interval is None else ("", "_t", f"_{self.interval}")
        places = ("t",) if self.interval is None else (self.interval, "t")
        return tuple(name + suffix for name in self.fields for suffix in suffixes) + places

    def __str__(self) -> str:
        """Describe the fields in one line."""
        kinds = [
            f"{k}: {'rotation' if isinstance(f, Rotation) else f'vector({f.size})'}" for k, f in self.fields.items()
        ]
        place = "" if self.interval is None else f" on the interval {self.interval}"
        return f"Lagrangian {self.name} ({', '.join(kinds)}){place}"


def lagrangian(
    *,
    pose: tuple[str, str] | None = None,
    constraint: Callable[[Any, Any], Any] | None = None,
    defaults: Mapping[str, Any] | None = None,
    force: Callable[[Any, Any], Any] | None = None,
    **fields: Any,
) -> Callable[[Callable[[Any, Any], Any]], Lagrangian]:
    """Declare the fields of a Lagrangian written as a function of q and c.

    L = f(q, c), with q.x, q.x_t = ẋ, q.x_s = x′, q.p (a rotation), q.p_t = ω = 2 p̄ ṗ, q.p_s = Ω = 2 p̄ p′, q.s, q.t
    and constants c.name. With an interval, L is a density per length [J/m]; without one, an energy [J].

    Args:
        pose: names of a rotation and of a vector of size 3 that together are a frame's pose; the screw rules need it.
        constraint: function (q, c) of fields and their derivatives along the interval, a number or a vector, kept zero
            at the strain points of every element by Lagrange multipliers; just for a density on an interval.
        defaults: values of the constants that may be left out.
        force: function (q, c) that returns a list of pairs (F, e): the force F, which may depend on velocities and on
            cy.rate of anything, works on the quantity e of fields and slopes, δW = Σ F·δe [J/m; without an interval J].
            With a rotation itself as e, (M, q.p), M is a moment in the body frame.
        fields: name=cy.Rotation(), name=cy.Vector(n), and at most one name=cy.Interval.

    Returns: a decorator that makes a Lagrangian of the function.

    Raises:
        TypeError: if a field is of no known kind, or the function does not take (q, c).

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), section 4.
    """
    interval = None
    declared: dict[str, Field] = {}
    for name, kind in fields.items():
        if kind is Interval or isinstance(kind, Interval):
            if interval is not None:
                raise TypeError(f"lagrangian: {interval} and {name} are both intervals; declare at most one")
            interval = name
        elif kind is Rotation or isinstance(kind, Rotation):
            declared[name] = Rotation()
        elif isinstance(kind, Vector):
            declared[name] = kind
        else:
            raise TypeError(f"lagrangian: {name} is {kind!r}; give cy.Rotation(), cy.Vector(n) or cy.Interval")
    if not declared:
        raise TypeError("lagrangian: no field declared; give at least one, such as x=cy.Vector(3)")

    if pose is not None and not _is_pose(pose, declared):
        raise TypeError(f"lagrangian: pose is {pose!r}; give the names of a rotation and of a vector of size 3")

    if constraint is not None and interval is None:
        raise TypeError("lagrangian: a constraint needs an interval, on whose elements it holds; declare s=cy.Interval")

    for word, given in (("constraint", constraint), ("force", force)):
        if given is not None and (not callable(given) or len(inspect.signature(given).parameters) != 2):
            raise TypeError(f"lagrangian: {word} is {given!r}; give a function of (q, c)")

    def decorate(function: Callable[[Any, Any], Any]) -> Lagrangian:
        if not callable(function) or len(inspect.signature(function).parameters) != 2:
            raise TypeError(f"lagrangian: {function!r} must be a function of (q, c)")
        name = getattr(function, "__name__", "L")
        made = Lagrangian(function, declared, interval, name, pose, constraint, defaults or {}, force)
        twice = sorted(n for n in set(made.names) if made.names.count(n) > 1)
        if twice:
            raise TypeError(f"lagrangian {made.name}: the name {twice[0]} has two meanings; rename a field")
        return made

    return decorate


def _is_pose(pose: Any, declared: Mapping[str, Field]) -> bool:
    two = isinstance(pose, tuple) and len(pose) == 2
    return two and isinstance(declared.get(pose[0]), Rotation) and declared.get(pose[1]) == Vector(3)
