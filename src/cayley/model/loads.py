"""Loads: weight, forces and moments at nodes, and forces and moments spread along rods."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from cayley.model import validate
from cayley.model.part import Part
from cayley.model.port import Port
from cayley.model.rod import Rod
from cayley.model.rod_loads import RodLoad
from cayley.model.spread import (
    buoyancy,
    decay,
    density,
    distributed,
    drag,
    imposed_strain,
    pressure,
    temperature,
    tendon,
)
from cayley.model.validate import Array, Triple

__all__ = [
    "Gravity",
    "LineLoad",
    "PointLoad",
    "RodLoad",
    "buoyancy",
    "decay",
    "density",
    "distributed",
    "drag",
    "force",
    "gravity",
    "imposed_strain",
    "line_force",
    "line_moment",
    "moment",
    "pressure",
    "temperature",
    "tendon",
]

Value = Triple | Callable[[float], ArrayLike]

_KINDS = {"force": "N", "moment": "N m"}


@dataclass(frozen=True, slots=True)
class Gravity:
    """A uniform field of gravity on every part, for all time; made by `gravity`. Several add up.

    Attributes:
        acceleration: g [m/s^2], in space.

    Raises:
        TypeError: not numbers.
        ValueError: not three of them, or not finite.
    """

    acceleration: Triple

    def __post_init__(self) -> None:
        """Check the acceleration."""
        g = validate.vector("gravity", "acceleration", self.acceleration, "m/s^2")
        object.__setattr__(self, "acceleration", g)

    def __str__(self) -> str:
        """The acceleration in one line."""
        return f"gravity {_shown(self.acceleration)} m/s^2"

    def at(self, t: float) -> Array:
        """Acceleration at time t [m/s^2], shape (3,); always the same."""
        return np.array(self.acceleration)


class _Timed(ABC):
    """What loads on a part have in common: a value, constant or a function of the time, its frame and its time."""

    __slots__ = ()  # the dataclasses below hold the values
    kind: str
    value: Value
    frame: str
    start: float
    until: float

    @property
    @abstractmethod
    def part(self) -> Part:
        """The part it acts on."""

    @property
    @abstractmethod
    def unit(self) -> str:
        """Unit of its value."""

    @abstractmethod
    def called(self, name: str) -> str:
        """Kind and place, in one line, if the part has that name."""

    def __str__(self) -> str:
        """Kind and place, in one line."""
        return self.called(self.part.name or self.part.noun)

    def at(self, t: float) -> Array:
        """The load at time t [s] in its frame, shape (3,); zero outside start <= t < until.

        Raises:
            TypeError: the load's function did not return numbers.
            ValueError: it did not return three, or not finite ones, or t is NaN.
        """
        if not self.start <= t < self.until:
            if math.isnan(t):
                raise ValueError(validate.wrong(str(self), "t", t, "a time [s]"))
            return np.zeros(3)
        return self.value_at(t)

    def value_at(self, t: float) -> Array:
        """The value at time t [s] whether or not the load is active, shape (3,).

        Raises:
            TypeError: the load's function did not return numbers.
            ValueError: it did not return three, or not finite ones.
        """
        if not callable(self.value):
            return np.array(self.value)
        right = f"3 finite numbers (x, y, z) [{self.unit}]"
        return validate.array(str(self), f"value(t = {t:g} s)", self.value(t), (3,), right)

    def described(self, name: str) -> str:
        """Kind, place, value, frame and time, in one line, if the part has that name."""
        if callable(self.value):
            value = f"function {getattr(self.value, '__name__', type(self.value).__name__)} [{self.unit}]"
        else:
            value = f"{_shown(self.value)} {self.unit}"
        until = "" if self.until == math.inf else f" < {self.until:g} s"
        window = "" if self.start == 0.0 and not until else f", {self.start:g} s <= t{until}"
        return f"{self.called(name)}: {value}, {self.frame} frame{window}"

    def _settle(self) -> None:
        """Check value, frame and times and bring them to their standard types."""
        owner = str(self)
        if not callable(self.value):
            right = f"3 finite numbers (x, y, z) [{self.unit}], or a function of the time [s] that returns them"
            constant = validate.array(owner, "value", self.value, (3,), right)
            object.__setattr__(self, "value", tuple(constant.tolist()))
        validate.option(owner, "frame", self.frame, ("space", "body"))
        start = validate.number(owner, "start", self.start, "s")
        until = math.inf if self.until == math.inf else validate.number(owner, "until", self.until, "s")
        if until <= start:
            raise ValueError(validate.wrong(owner, "until", self.until, f"later than start = {start:g} s"))
        object.__setattr__(self, "start", start)
        object.__setattr__(self, "until", until)


@dataclass(frozen=True, slots=True, kw_only=True)
class PointLoad(_Timed):
    """A force or moment on a node; made by `force` and `moment`.

    Attributes:
        kind: "force" or "moment".
        port: the node.
        value: (3,) [N or N m], or a function of the time [s] that returns it.
        frame: "space", or "body" for a load that turns with the node.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].
    """

    kind: str
    port: Port
    value: Value
    frame: str = "space"
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        validate.option("PointLoad", "kind", self.kind, _KINDS)
        if not isinstance(self.port, Port):
            right = "a node of a rod, such as rod.start, rod.end or rod.node(k), or body.centre"
            raise TypeError(validate.wrong(self.kind, "port", self.port, right))
        self._settle()

    @property
    def part(self) -> Part:
        """The part it acts on."""
        return self.port.part

    @property
    def unit(self) -> str:
        """N or N m."""
        return _KINDS[self.kind]

    def called(self, name: str) -> str:
        """Kind and node, in one line, if the part has that name."""
        return f"{self.kind} on {self.port.called(name)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class LineLoad(_Timed):
    """A force or moment per unstressed length, the same all along a rod; made by `line_force` and `line_moment`.

    Attributes:
        kind: "force" or "moment".
        rod: the rod.
        value: (3,) [N/m or N m/m], or a function of the time [s] that returns it.
        frame: "space", or "body" for a load that turns with each node.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].
    """

    kind: str
    rod: Rod
    value: Value
    frame: str = "space"
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        validate.option("LineLoad", "kind", self.kind, _KINDS)
        if not isinstance(self.rod, Rod):
            raise TypeError(validate.wrong(f"line {self.kind}", "rod", self.rod, "a Rod"))
        self._settle()

    @property
    def part(self) -> Rod:
        """The rod it acts on."""
        return self.rod

    @property
    def unit(self) -> str:
        """N/m or N m/m."""
        return f"{_KINDS[self.kind]}/m"

    def called(self, name: str) -> str:
        """Kind and rod, in one line, if the rod has that name."""
        return f"line {self.kind} on {name}"


Load = Gravity | PointLoad | LineLoad | RodLoad


def gravity(acceleration: ArrayLike) -> Gravity:
    """A uniform field of gravity on every part, such as (0, 0, -9.81).

    Args:
        acceleration: g [m/s^2], in space, shape (3,).

    Raises:
        TypeError: not numbers.
        ValueError: not three of them, or not finite.
    """
    return Gravity(validate.vector("gravity", "acceleration", acceleration, "m/s^2"))


def force(
    port: Port,
    value: ArrayLike | Callable[[float], ArrayLike],
    *,
    frame: str = "space",
    start: float = 0.0,
    until: float = math.inf,
) -> PointLoad:
    """A force F on a node, active for start <= t < until.

    Args:
        port: the node, such as rod.end.
        value: F [N], shape (3,), or a function of the time [s] that returns it.
        frame: "space", or "body" for a force that turns with the node.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: not three finite numbers, an unknown frame, or until <= start.
    """
    return PointLoad(kind="force", port=port, value=cast("Value", value), frame=frame, start=start, until=until)


def moment(
    port: Port,
    value: ArrayLike | Callable[[float], ArrayLike],
    *,
    frame: str = "space",
    start: float = 0.0,
    until: float = math.inf,
) -> PointLoad:
    """A moment on a node, active for start <= t < until.

    δW = M·η, M in the body frame of the node

    Args:
        port: the node, or another port, to whose node it is handed.
        value: M [N m], shape (3,), or a function of the time [s] that returns it.
        frame: "space" keeps its direction, "body" turns with the cross-section.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value or time is out of range.
    """
    return PointLoad(kind="moment", port=port, value=cast("Value", value), frame=frame, start=start, until=until)


def line_force(
    rod: Rod,
    value: ArrayLike | Callable[[float], ArrayLike],
    *,
    frame: str = "space",
    start: float = 0.0,
    until: float = math.inf,
) -> LineLoad:
    """A force per unstressed length on a whole rod.

    δW = ∫ f·δx ds

    Args:
        rod: the rod.
        value: f [N/m], shape (3,), or a function of the time [s] that returns it.
        frame: "space" keeps its direction, "body" turns with the cross-section.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value or time is out of range.
    """
    return LineLoad(kind="force", rod=rod, value=cast("Value", value), frame=frame, start=start, until=until)


def line_moment(
    rod: Rod,
    value: ArrayLike | Callable[[float], ArrayLike],
    *,
    frame: str = "space",
    start: float = 0.0,
    until: float = math.inf,
) -> LineLoad:
    """A moment per unstressed length on a whole rod.

    δW = ∫ m·η ds, m in the body frame of the sections

    Args:
        rod: the rod.
        value: m [N m/m], shape (3,), or a function of the time [s] that returns it.
        frame: "space" keeps its direction, "body" turns with the cross-section.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value or time is out of range.
    """
    return LineLoad(kind="moment", rod=rod, value=cast("Value", value), frame=frame, start=start, until=until)


def _shown(value: Triple) -> str:
    return "(" + ", ".join(f"{component:g}" for component in value) + ")"
