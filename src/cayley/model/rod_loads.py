"""Loads along rods that follow shape, motion, place or time: drag, buoyancy, pressure, actuation, own densities."""

from __future__ import annotations

import inspect
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from cayley.model import validate
from cayley.model.rod import Rod

__all__ = ["Buoyancy", "Decay", "Density", "Distributed", "Drag", "ImposedStrain", "Pressure", "RodLoad", "Tendon"]

Function = Callable[..., Any]


class RodLoad(ABC):
    """What loads along a rod have in common: a kind, a rod, and the time in which they act, start <= t < until.

    Functions of theirs are written with NumPy: they are called once, on symbols, and compiled.
    """

    __slots__ = ()  # the dataclasses below hold the values
    kind: ClassVar[str]
    rod: Rod
    start: float
    until: float

    @property
    def part(self) -> Rod:
        """The rod it acts on."""
        return self.rod

    @property
    def functions(self) -> dict[str, Function]:
        """What is a function, by the name of its attribute."""
        found = {name: getattr(self, name) for name in self._functional}
        return {name: value for name, value in found.items() if callable(value)}

    _functional: ClassVar[tuple[str, ...]] = ()

    def called(self, name: str) -> str:
        """Kind and rod, in one line, if the rod has that name."""
        return f"{self.kind.replace('_', ' ')} on {name}"

    def __str__(self) -> str:
        """Kind and rod, in one line."""
        return self.called(self.rod.name or "rod")

    def described(self, name: str) -> str:
        """Kind, rod, values and time, in one line, if the rod has that name."""
        until = "" if self.until == math.inf else f" < {self.until:g} s"
        window = "" if self.start == 0.0 and not until else f", {self.start:g} s <= t{until}"
        return f"{self.called(name)}: {self._values()}{window}"

    @abstractmethod
    def _values(self) -> str:
        """Values in a few words."""

    def _settle(self) -> None:
        """Check the rod and the times."""
        owner = type(self).__name__
        if not isinstance(self.rod, Rod):
            raise TypeError(validate.wrong(owner, "rod", self.rod, "a Rod"))
        start = validate.number(owner, "start", self.start, "s")
        until = math.inf if self.until == math.inf else validate.number(owner, "until", self.until, "s")
        if until <= start:
            raise ValueError(validate.wrong(owner, "until", self.until, f"later than start = {start:g} s"))
        self._set(start=start, until=until)

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _check(self, name: str, shape: tuple[int, ...], right: str, *arguments: str) -> None:
        """Check an attribute: numbers of a shape, or a function of some arguments that returns them."""
        value, owner = getattr(self, name), str(self)
        words = f"{right}, or a function of ({', '.join(arguments)}) that returns them" if arguments else right
        if not callable(value):
            if arguments and shape == ():
                self._set(**{name: validate.number(owner, name, value, right.partition("[")[2].rstrip("]"))})
            else:
                array = validate.array(owner, name, value, shape, words)
                self._set(**{name: tuple(array.tolist()) if len(shape) == 1 else validate.frozen(array)})
            return
        if not arguments or _count(value) != len(arguments):
            raise TypeError(validate.wrong(owner, name, value, words))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Distributed(RodLoad):
    """A force or moment per unstressed length that depends on place and time; made by `loads.distributed`.

    Attributes:
        rod: the rod.
        value: function of (s [m], t [s]) that returns (3,) [N/m or N m/m].
        moment: whether it is a moment.
        frame: "space", or "body" for one that turns with the rod.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].
    """

    kind: ClassVar[str] = "distributed"
    _functional: ClassVar[tuple[str, ...]] = ("value",)
    rod: Rod
    value: Any
    moment: bool = False
    frame: str = "space"
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        self._settle()
        validate.option(str(self), "frame", self.frame, ("space", "body"))
        if not isinstance(self.moment, bool):
            raise TypeError(validate.wrong(str(self), "moment", self.moment, "True or False"))
        self._check("value", (3,), "3 finite numbers (x, y, z)", "s", "t")

    def _values(self) -> str:
        return f"{_shown(self.value)} {'N m/m' if self.moment else 'N/m'}, {self.frame} frame"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pressure(RodLoad):
    """A force on the surface of a rod, perpendicular to its axis and to one of its directors; made by `loads.pressure`.

    f = q d2 × x′ (axis "d1") or q x′ × d1 (axis "d2"), per unstressed length

    Attributes:
        rod: the rod.
        value: q [N/m], pressure times width, or a function of (s [m], t [s]) that returns it.
        axis: the director it points along on a straight rod, "d1" or "d2".
        start: first time at which it acts [s].
        until: time from which it acts no more [s].
    """

    kind: ClassVar[str] = "pressure"
    _functional: ClassVar[tuple[str, ...]] = ("value",)
    rod: Rod
    value: Any
    axis: str = "d1"
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        self._settle()
        validate.option(str(self), "axis", self.axis, ("d1", "d2"))
        self._check("value", (), "a finite number [N/m]", "s", "t")

    def _values(self) -> str:
        return f"{_shown(self.value)} N/m along {self.axis}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drag(RodLoad):
    """Drag of a fluid, quadratic in the velocity, different across and along the axis; made by `loads.drag`.

    f = −½ ρ d (C_n ‖u_n‖ u_n + π C_t ‖u_t‖ u_t),  u = ẋ − v,  u_t = (u·t) t,  u_n = u − u_t,  t = x′/‖x′‖

    per unstressed length.

    Attributes:
        rod: the rod.
        density: ρ of the fluid [kg/m³].
        diameter: d [m].
        normal: C_n [-].
        tangential: C_t [-], of skin friction.
        velocity: v of the fluid [m/s], (3,) in space, or a function of (x (3,) [m], t [s]) that returns it.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Source: Morison et al. (1950); tangential part as in DNV-RP-C205, section 6.
    """

    kind: ClassVar[str] = "drag"
    _functional: ClassVar[tuple[str, ...]] = ("velocity",)
    rod: Rod
    density: float
    diameter: float
    normal: float = 1.2
    tangential: float = 0.0
    velocity: Any = (0.0, 0.0, 0.0)
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        self._settle()
        owner = str(self)
        for name, unit in (("density", "kg/m^3"), ("diameter", "m")):
            self._set(**{name: validate.positive(owner, name, getattr(self, name), unit)})
        for name in ("normal", "tangential"):
            value = validate.number(owner, name, getattr(self, name), "-")
            if value < 0.0:
                raise ValueError(validate.wrong(owner, name, value, "a number, not negative [-]"))
            self._set(**{name: value})
        if self.normal == 0.0 == self.tangential:
            raise ValueError(f"{owner}: normal and tangential are both 0; give at least one coefficient")
        self._check("velocity", (3,), "3 finite numbers (x, y, z) [m/s]", "x", "t")

    def _values(self) -> str:
        stream = "" if self.velocity == (0.0, 0.0, 0.0) else f", stream {_shown(self.velocity)} m/s"
        return f"normal {self.normal:g}, tangential {self.tangential:g}{stream}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Decay(RodLoad):
    """Forces −α m ẋ and moments −α J ω, under which all motion of a rod decays; made by `loads.decay`.

    Attributes:
        rod: the rod.
        rate: α [1/s].
        start: first time at which it acts [s].
        until: time from which it acts no more [s].
    """

    kind: ClassVar[str] = "decay"
    rod: Rod
    rate: float
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        self._settle()
        self._set(rate=validate.positive(str(self), "rate", self.rate, "1/s"))

    def _values(self) -> str:
        return f"{self.rate:g} 1/s"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Buoyancy(RodLoad):
    """Lift of a fluid all around the rod, f = −ρ A g per unstressed length, g of the model; made by `loads.buoyancy`.

    Attributes:
        rod: the rod.
        density: ρ of the fluid [kg/m³].
        area: A, displaced volume per length [m²].
        start: first time at which it acts [s].
        until: time from which it acts no more [s].
    """

    kind: ClassVar[str] = "buoyancy"
    rod: Rod
    density: float
    area: float
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        self._settle()
        for name, unit in (("density", "kg/m^3"), ("area", "m^2")):
            self._set(**{name: validate.positive(str(self), name, getattr(self, name), unit)})

    def _values(self) -> str:
        return f"{self.density:g} kg/m^3 on {self.area:g} m^2"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ImposedStrain(RodLoad):
    """A strain the rod would take without stress: temperature, growth, muscles; made by `loads.imposed_strain`.

    stress = C (ε − ε⁰),  ε⁰ = amount × strain

    Attributes:
        rod: the rod.
        strain: (Γ1, Γ2, Γ3, Ω1, Ω2, Ω3) [-, 1/m] for an amount of 1.
        amount: a number [-], or a function of (s [m], t [s]) that returns it.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].
    """

    kind: ClassVar[str] = "imposed_strain"
    _functional: ClassVar[tuple[str, ...]] = ("amount",)
    rod: Rod
    strain: tuple[float, ...]
    amount: Any = 1.0
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        self._settle()
        self._check("strain", (6,), "6 finite numbers (shear 1, shear 2, stretch, bend 1, bend 2, twist) [-, 1/m]")
        self._check("amount", (), "a finite number [-]", "s", "t")
        fixed = {"shearable": 0, "unshearable": 2, "inextensible": 3}.get(self.rod.kinematics, 0)
        if any(self.strain[:fixed]):
            right = f"zero in its first {fixed} numbers: a rod that is {self.rod.kinematics} has no such strains"
            raise ValueError(validate.wrong(str(self), "strain", self.strain, right))

    def _values(self) -> str:
        return f"{_shown(self.strain)} times {_shown(self.amount)}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tendon(RodLoad):
    """A tendon along a whole rod, fixed to its ends and free to slide between; made by `loads.tendon`.

    δW = −T δ∫ ‖y′‖ ds,   y = x + Λ r,   y′ = x′ + Λ (Ω × r + r′)

    Attributes:
        rod: the rod.
        tension: T [N], or a function of the time [s] that returns it.
        offset: r, from the axis, (3,) in the frame of the section [m], or a function of s [m] that returns it.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Source: Renda, Cacucciolo, Dias, Seneviratne (2016); Rucker and Webster (2011).
    """

    kind: ClassVar[str] = "tendon"
    _functional: ClassVar[tuple[str, ...]] = ("tension", "offset")
    rod: Rod
    tension: Any
    offset: Any
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        self._settle()
        self._check("tension", (), "a finite number [N]", "t")
        self._check("offset", (3,), "3 finite numbers along d1, d2, d3 [m]", "s")

    def _values(self) -> str:
        return f"tension {_shown(self.tension)} N at {_shown(self.offset)} m"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Density(RodLoad):
    """Any forces on a rod: pairs (F, e) of a force per length and what it works on; made by `loads.density`.

    Attributes:
        rod: the rod.
        force: function (q, c) -> [(F, e), ...] of q.x, q.p, their derivatives (q.x_t, q.x_s, ...), q.s and q.t.
        constants: numbers, vectors and matrices by the names c has for them.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].
    """

    kind: ClassVar[str] = "density"
    _functional: ClassVar[tuple[str, ...]] = ("force",)
    rod: Rod
    force: Function
    constants: Mapping[str, Any] = field(default_factory=dict)
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        """Check all values."""
        self._settle()
        if not callable(self.force) or _count(self.force) != 2:
            raise TypeError(validate.wrong(str(self), "force", self.force, "a function of (q, c)"))
        made = {}
        for name, value in dict(self.constants).items():
            if not name.isidentifier() or name.startswith("_"):
                raise ValueError(validate.wrong(str(self), "constants", name, "named like variables, without _ first"))
            made[name] = validate.array(str(self), name, value, (-1,) * np.ndim(value), "finite numbers")
        self._set(constants=made)

    def _values(self) -> str:
        return _shown(self.force)


KINDS: dict[str, type[RodLoad]] = {
    made.kind: made for made in (Distributed, Pressure, Drag, Decay, Buoyancy, ImposedStrain, Tendon, Density)
}
"""Loads along rods by their kind."""


def _count(function: Any) -> int:
    """How many positional arguments a function takes; a callable that has `arguments` says so itself."""
    told = getattr(function, "arguments", None)
    if told is not None:
        return len(told)
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return -1
    return sum(p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD) and p.default is p.empty for p in parameters)


def _shown(value: Any) -> str:
    if callable(value):
        return f"function {getattr(value, '__name__', type(value).__name__)}"
    return "(" + ", ".join(f"{v:g}" for v in value) + ")" if np.ndim(value) else f"{value:g}"
