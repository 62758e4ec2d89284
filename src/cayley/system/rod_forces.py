"""Forces of damping and of loads along rods, as pairs (F, e) beside the Lagrangian of a rod (Lagrange-d'Alembert).

Every force is a fragment: pairs written once, with constants that each rod has of its own, zero where it has no such
force. So all rods of a model still run in one sweep, and a model without forces has the density it had.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from cayley.density.expression import cross, dot, from_sx, norm, to_sx, wrap
from cayley.density.force import ForceError, rate
from cayley.density.lagrangian import Lagrangian
from cayley.density.library import E3
from cayley.model import Model, Part, Rod
from cayley.model.damping import Damping
from cayley.model.loads import Gravity
from cayley.model.rod_loads import (
    Buoyancy,
    Decay,
    Density,
    Distributed,
    Drag,
    ImposedStrain,
    Pressure,
    RodLoad,
    Tendon,
)

CALM = 1e-9
"""Speed [m/s] below which drag becomes linear, so that it has a derivative at rest."""
Pairs = list[tuple[Any, Any]]


@dataclass(frozen=True, slots=True)
class Fragment:
    """Forces of one kind on one rod.

    Args:
        key: rods whose keys are equal share the pairs.
        constants: numbers of this rod, by name.
        pairs: function (q, c, own) -> pairs, where c are the constants of the rod and own those of the fragment.
    """

    key: tuple[Any, ...]
    constants: Mapping[str, np.ndarray]
    pairs: Callable[[Any, Any, Any], Pairs]


def with_forces(
    lagrangian: Lagrangian, model: Model, parts: Sequence[Part], constrained: int
) -> tuple[Lagrangian, list[dict[str, np.ndarray]]]:
    """The Lagrangian of some parts with the forces of a model on them, and the constants these take, for every part.

    Args:
        lagrangian: of the parts.
        model: the model.
        parts: parts of it.
        constrained: how many of the six strains the Lagrangian constrains, the first ones.

    Returns: the same Lagrangian if there are no forces.
    """
    by_part = [_labeled(_fragments(model, part, constrained)) for part in parts]
    found: dict[tuple[Any, ...], Fragment] = {}
    for fragments in by_part:
        for key, fragment in fragments.items():
            found.setdefault(key, fragment)
    if not found:
        return lagrangian, [{} for _ in parts]
    labels = {key: f"{key[0]}{k}" for k, key in enumerate(found)}

    def force(q: Any, c: Any) -> Pairs:
        return [
            pair for key, one in found.items() for pair in one.pairs(q, c, _Own(c, labels[key], set(one.constants)))
        ]

    constants = []
    for fragments in by_part:
        own: dict[str, np.ndarray] = {}
        for key, one in found.items():
            given = fragments[key].constants if key in fragments else {n: 0.0 * v for n, v in one.constants.items()}
            own |= {f"{labels[key]}_{name}": value for name, value in given.items()}
        constants.append(own)
    return replace(lagrangian, force=force), constants


class _Own:
    """Constants of one fragment, by their own names."""

    def __init__(self, c: Any, label: str, names: set[str]) -> None:
        self._c, self._label, self._names, self._used = c, label, names, set[str]()

    def _unused(self, names: Iterable[str]) -> str | None:
        """The first of some constants that nobody asked for."""
        return next((name for name in names if name not in self._used), None)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        if name not in self._names:
            known = ", ".join(sorted(n for n in self._names if not n.startswith("_"))) or "none"
            raise ValueError(f"unknown constant c.{name}, there are {known}")
        self._used.add(name)
        return getattr(self._c, f"{self._label}_{name}")


def _labeled(fragments: Sequence[Fragment]) -> dict[tuple[Any, ...], Fragment]:
    """Fragments by key and by how many of that key the rod has already."""
    made: dict[tuple[Any, ...], Fragment] = {}
    for fragment in fragments:
        again = sum(key[: len(fragment.key)] == fragment.key for key in made)
        made[(*fragment.key, again)] = fragment
    return made


def _fragments(model: Model, part: Part, constrained: int) -> list[Fragment]:
    if not isinstance(part, Rod):
        return []
    gravity = sum((np.array(g.acceleration) for g in model.loads if isinstance(g, Gravity)), start=np.zeros(3))
    found = [] if part.damping is None else _damping(part.damping, constrained)
    for load in model.loads:
        if isinstance(load, RodLoad) and load.rod is part:
            found.append(_timed(load, _FRAGMENTS[type(load)](load, constrained, gravity)))
    return found


def _timed(load: RodLoad, fragment: Fragment) -> Fragment:
    """The fragment with a factor for the rod and, if there is one, the time window of its load."""
    windowed = load.start > 0.0 or load.until < math.inf
    constants = dict(fragment.constants) | {"_on": np.asarray(1.0)}
    if windowed:
        constants |= {"_start": np.asarray(load.start), "_until": np.asarray(min(load.until, 1e300))}

    def pairs(q: Any, c: Any, own: Any) -> Pairs:
        on = own._on
        if windowed:
            on = on * np.where(q.t >= own._start, 1.0, 0.0) * np.where(q.t < own._until, 1.0, 0.0)
        return [(on * force, quantity) for force, quantity in fragment.pairs(q, c, own)]

    return Fragment((*fragment.key, windowed), constants, pairs)


def _strain(q: Any, constrained: int) -> Any:
    return np.concatenate([q.p.inverse_rotate(q.x_s) - E3, q.p_s])[constrained:]


def _damping(damping: Damping, constrained: int) -> list[Fragment]:
    """−(D + T C T) ε̇ on ε and −α (momenta ∂T/∂ẋ, ∂T/∂ω) on (x, p)."""
    found = []
    if any(damping.retardation[constrained:]):
        roots = np.sqrt(damping.retardation)[constrained:]

        def kelvin_voigt(q: Any, c: Any, own: Any) -> Pairs:
            strain = _strain(q, constrained)
            return [(-own.roots * (c.stiffness @ (own.roots * rate(strain))), strain)]

        found.append(Fragment(("retardation",), {"roots": roots}, kelvin_voigt))
    if damping.viscosity is not None:
        viscosity = damping.viscosity[constrained:, constrained:]

        def viscous(q: Any, c: Any, own: Any) -> Pairs:
            strain = _strain(q, constrained)
            return [(-(own.viscosity @ rate(strain)), strain)]

        found.append(Fragment(("viscosity",), {"viscosity": viscosity}, viscous))
    if damping.decay:
        found.append(_decaying(damping.decay))
    return found


def _decaying(rate: float) -> Fragment:
    def decay(q: Any, c: Any, own: Any) -> Pairs:
        linear = c.mass * q.x_t + q.p.rotate(cross(q.p_t, c.first_moment))
        angular = c.inertia @ q.p_t + cross(c.first_moment, q.p.inverse_rotate(q.x_t))
        return [(-own.decay * linear, q.x), (-own.decay * angular, q.p)]

    return Fragment(("decay",), {"decay": np.asarray(rate)}, decay)


def _decay(load: Decay, constrained: int, gravity: np.ndarray) -> Fragment:
    return _decaying(load.rate)


def _value(given: Any, name: str, size: int | None, load: RodLoad) -> tuple[Any, dict[str, Any], Callable[..., Any]]:
    """Part of the key, constants, and (own, arguments) -> value, of a number or function."""
    if not callable(given):
        return None, {name: np.asarray(given, dtype=float)}, lambda own, *arguments: getattr(own, name)

    def value(own: Any, *arguments: Any) -> Any:
        where = f"{load}: its {name}"
        try:
            found = wrap(np.asarray(given(*arguments), dtype=object))
        except Exception as error:
            raise ForceError(f"{where} does not work on symbols ({error}); write it with NumPy, without if") from None
        if found.shape != (() if size is None else (size,)):
            wanted = "one number" if size is None else f"{size} numbers"
            raise ForceError(f"{where} returns shape {found.shape}; it must return {wanted}")
        return found

    return given, {}, value


def _distributed(load: Distributed, constrained: int, gravity: np.ndarray) -> Fragment:
    part, constants, value = _value(load.value, "value", 3, load)
    moment, body = load.moment, load.frame == "body"

    def pairs(q: Any, c: Any, own: Any) -> Pairs:
        force = value(own, q.s, q.t)
        if moment:
            return [(force if body else q.p.inverse_rotate(force), q.p)]
        return [(q.p.rotate(force) if body else force, q.x)]

    return Fragment(("distributed", part, moment, body), constants, pairs)


def _pressure(load: Pressure, constrained: int, gravity: np.ndarray) -> Fragment:
    part, constants, value = _value(load.value, "value", None, load)

    def pairs(q: Any, c: Any, own: Any) -> Pairs:
        d1, d2 = (q.p.rotate(e) for e in np.eye(3)[:2])
        normal = cross(d2, q.x_s) if load.axis == "d1" else cross(q.x_s, d1)
        return [(value(own, q.s, q.t) * normal, q.x)]

    return Fragment(("pressure", part, load.axis), constants, pairs)


def _drag(load: Drag, constrained: int, gravity: np.ndarray) -> Fragment:
    part, constants, velocity = _value(load.velocity, "velocity", 3, load)
    shared = 0.5 * load.density * load.diameter
    along = load.tangential > 0.0
    constants |= {"normal": np.asarray(shared * load.normal)}
    if along:
        constants |= {"tangential": np.asarray(shared * math.pi * load.tangential)}

    def pairs(q: Any, c: Any, own: Any) -> Pairs:
        against = q.x_t - velocity(own, q.x, q.t)
        axis = q.x_s / norm(q.x_s)
        slip = dot(against, axis) * axis
        across = against - slip
        force = -own.normal * _speed(across) * across
        return [(force - own.tangential * _speed(slip) * slip if along else force, q.x)]

    return Fragment(("drag", part, along), constants, pairs)


def _speed(v: Any) -> Any:
    return np.sqrt(dot(v, v) + CALM**2)


def _buoyancy(load: Buoyancy, constrained: int, gravity: np.ndarray) -> Fragment:
    lift = -load.density * load.area * gravity
    return Fragment(("buoyancy",), {"lift": lift}, lambda q, c, own: [(own.lift, q.x)])


def _imposed_strain(load: ImposedStrain, constrained: int, gravity: np.ndarray) -> Fragment:
    part, constants, amount = _value(load.amount, "amount", None, load)
    constants |= {"strain": np.asarray(load.strain)[constrained:]}

    def pairs(q: Any, c: Any, own: Any) -> Pairs:
        return [(amount(own, q.s, q.t) * (c.stiffness @ own.strain), _strain(q, constrained))]

    return Fragment(("strain", part), constants, pairs)


def _tendon(load: Tendon, constrained: int, gravity: np.ndarray) -> Fragment:
    pulled, constants, tension = _value(load.tension, "tension", None, load)
    part, more, offset = _value(load.offset, "offset", 3, load)

    def pairs(q: Any, c: Any, own: Any) -> Pairs:
        arm = offset(own, q.s)
        slope = wrap(np.atleast_1d(from_sx(ca.densify(ca.jacobian(to_sx(arm), to_sx(q.s))))))
        along = q.p.inverse_rotate(q.x_s) + cross(q.p_s, arm) + slope
        return [(-tension(own, q.t), norm(along))]

    return Fragment(("tendon", pulled, part), {**constants, **more}, pairs)


def _density(load: Density, constrained: int, gravity: np.ndarray) -> Fragment:
    constants = {name: np.asarray(value, dtype=float) for name, value in load.constants.items()}

    def pairs(q: Any, c: Any, own: Any) -> Pairs:
        try:
            found = [(force, quantity) for force, quantity in load.force(q, own)]
        except Exception as error:
            told = str(error).removeprefix("Lagrangian rod: ")
            raise ForceError(f"{load}: its force does not return pairs (F, e) of symbols: {told}") from None
        unused = own._unused(constants)
        if unused is not None:
            raise ForceError(f"{load}: the constant {unused} is given but its force never uses it; leave it out")
        return found

    return Fragment(("density", load.force, *sorted(constants)), constants, pairs)


_FRAGMENTS: dict[type[RodLoad], Callable[[Any, int, np.ndarray], Fragment]] = {
    Distributed: _distributed,
    Pressure: _pressure,
    Drag: _drag,
    Decay: _decay,
    Buoyancy: _buoyancy,
    ImposedStrain: _imposed_strain,
    Tendon: _tendon,
    Density: _density,
}
