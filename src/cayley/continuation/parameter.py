"""What is multiplied: a model in which the time stands for the parameter, and all else is held at one time."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cayley.model import LagrangianPart, Model
from cayley.model.joints import Joint
from cayley.model.loads import Gravity, LineLoad, Load, PointLoad, RodLoad
from cayley.model.rod_loads import Buoyancy, Decay, Density, Distributed, Drag, ImposedStrain, Pressure, Tendon
from cayley.steppers.still import Still
from cayley.system.groups import groups_of
from cayley.system.system import System

BEFORE = -1e30
"""Start of a load on nodes that acts whatever the parameter [s]."""
_VALUES: Mapping[type[RodLoad], str] = {
    Distributed: "value",
    Pressure: "value",
    ImposedStrain: "amount",
    Tendon: "tension",
    Drag: "velocity",
}
"""What of a load along a rod is a function of the time."""


@dataclass(frozen=True, slots=True)
class Scaled:
    """A model whose time is the parameter λ.

    Args:
        model: loads that are multiplied are λ times their value; other loads and motions are those at one time.
        name: of the parameter.
        unit: of the parameter.
        base: gravity that is not multiplied [m/s²], shape (3,).
        gravity: gravity that is multiplied by λ [m/s²], shape (3,), or None.
        heavy: of every density of the model whether loads of gravity act on it, where some is multiplied.
    """

    model: Model
    name: str
    unit: str
    base: np.ndarray
    gravity: np.ndarray | None = None
    heavy: tuple[bool, ...] = ()

    def put(self, still: Still, parameter: float) -> None:
        """Take loads and motions of a system at a value of the parameter."""
        still.set_time(parameter)
        if self.gravity is not None:
            still.set_constants(self._gravity_at(still.system, parameter))

    def system_at(self, system: System, parameter: float) -> System:
        """The system with what it has instead of functions of the time at a value of the parameter: its gravity."""
        if self.gravity is None:
            return system
        made = []
        for group, given in zip(system.groups, self._gravity_at(system, parameter), strict=True):
            known = zip(group.equations.uniforms, group.uniforms, strict=True)
            made.append(replace(group, uniforms=np.array([given.get(name, value) for name, value in known])))
        return replace(system, members=tuple(made)) if system.members else made[0]

    def _gravity_at(self, system: System, parameter: float) -> list[dict[str, float]]:
        """Constants of each density; parts with a Lagrangian of their own may call something else gravity."""
        total = {f"c.gravity[{k}]": g for k, g in enumerate(self.base + parameter * np.asarray(self.gravity))}
        pairs = zip(system.groups, self.heavy, strict=True)
        return [
            {name: g for name, g in total.items() if heavy and name in group.equations.uniforms}
            for group, heavy in pairs
        ]


def scaled(owner: str, model: Model, parameter: Any, time: float) -> Scaled:
    """The model whose time is the parameter.

    Args:
        owner: for messages.
        model: the model.
        parameter: "time"; or a load, a joint with a prescribed motion or its name, or several.
        time: at which the values of loads are taken, and all that is not chosen [s].

    Raises:
        TypeError: it is none of these.
        ValueError: it is not in the model, or cannot be multiplied.
    """
    if isinstance(parameter, str) and parameter == "time":
        return Scaled(model, "time", "s", np.zeros(3))
    loads, joints = _chosen(owner, model, parameter)

    def among(one: Any, many: Sequence[Any]) -> bool:
        return any(one is other for other in many)

    gravities = [load for load in model.loads if isinstance(load, Gravity)]
    total = [sum((g.at(time) for g in gravities if among(g, loads) == own), start=np.zeros(3)) for own in (False, True)]
    pulled = bool(np.any(total[1]))
    if pulled and any(isinstance(load, Buoyancy) for load in model.loads):
        raise ValueError(f"{owner}: gravity is multiplied, but there is buoyancy; give that as a line_force")
    if pulled and np.any((total[1] != 0.0) & (total[0] + total[1] == 0.0)):
        raise ValueError(f"{owner}: the gravity that is multiplied cancels that which stays; leave both out")
    acting = [_multiplied(owner, model, one, time) if among(one, loads) else _at(one, time) for one in model.loads]
    held = {id(joint): joint if among(joint, joints) else _still(joint, time) for joint in model.connections}
    made = model.replace(
        loads=[load for load in acting if load is not None],
        supports=(*model.supports, *(held[id(joint)] for joint in model.guides)),
        joints=[held[id(joint)] for joint in model.joints],
    )
    name, unit = ("load factor", "-") if loads else ("time of the motion", "s")
    heavy = tuple(not isinstance(group.parts[0], LagrangianPart) for group in groups_of(made))
    return Scaled(made, name, unit, total[0], total[1] if pulled else None, heavy)


def _chosen(owner: str, model: Model, parameter: Any) -> tuple[list[Load], list[Joint]]:
    """The loads and joints meant."""
    given = list(parameter) if isinstance(parameter, list | tuple) else [parameter]
    named = dict(zip(model.connection_names, model.connections, strict=True))
    found: list[Any] = [named.get(one, one) if isinstance(one, str) else one for one in given]
    for one in found:
        known = [*model.loads, *model.connections]
        if not any(one is other for other in known):
            if not isinstance(one, Gravity | PointLoad | LineLoad | RodLoad | Joint):
                right = 'a load or driven joint of the model, several, or "time"'
                raise TypeError(f"{owner}: parameter is {one!r}; give {right}")
            raise ValueError(f"{owner}: {one} is not in the model; give one of its loads or driven joints")
        if isinstance(one, Joint) and not one.driven:
            raise ValueError(f"{owner}: no motion of {one} is prescribed; give a joint or support with one")
    if not found:
        raise ValueError(f"{owner}: parameter is empty; give a load, a driven joint, or several")
    loads: list[Load] = [one for one in found if not isinstance(one, Joint)]
    return loads, [one for one in found if isinstance(one, Joint)]


class _Constant:
    """A motion that stays as it is at one time."""

    sampled = True  # it need not be zero at t = 0

    def __init__(self, value: np.ndarray) -> None:
        self.value = value

    def __call__(self, t: float) -> np.ndarray:
        return self.value


class _Growing:
    """A load that is the time times a value; not for symbols, for it is asked for one time only, again and again."""

    def __init__(self, value: np.ndarray) -> None:
        self.value = value

    def __call__(self, t: float) -> np.ndarray:
        return float(t) * self.value


def _still(joint: Joint, time: float) -> Joint:
    """A joint whose prescribed motions stay as they are at one time."""
    if not joint.driven:
        return joint
    held: dict[str, Any] = {q: _Constant(joint.motion(q, np.array([time]))[0]) for q in joint.driven}
    return replace(joint, **held)


def _at(load: Load, time: float) -> Load | None:
    """A load as it is at one time, for all times; None where it does not act."""
    if isinstance(load, Gravity):
        return load
    if isinstance(load, PointLoad | LineLoad):
        return replace(load, value=tuple(load.at(time).tolist()), start=BEFORE, until=np.inf)
    if not load.start <= time < load.until:
        return None
    if isinstance(load, Density):
        return replace(load, force=lambda q, c: _pairs(load, q, c, time, 1.0), start=0.0, until=np.inf)
    if isinstance(load, Buoyancy | Decay):
        return _changed(load, {})
    name = _VALUES[type(load)]
    kept = getattr(load, name)
    if callable(kept):
        function = (lambda t: kept(time)) if name == "tension" else (lambda s, t: kept(s, time))
        return _changed(load, {name: function})
    return _changed(load, {})


def _multiplied(owner: str, model: Model, load: Load, time: float) -> Load:
    """A load that is the time times what it is at one time."""
    if isinstance(load, Gravity):
        return load  # its part in the uniforms of the kernels is multiplied, see Scaled
    if isinstance(load, PointLoad | LineLoad):
        return replace(load, value=_Growing(load.value_at(time)), start=BEFORE, until=np.inf)
    if isinstance(load, Density):
        return replace(load, force=lambda q, c: _pairs(load, q, c, time, q.t), start=0.0, until=np.inf)
    if isinstance(load, Buoyancy):
        gravity = sum((g.at(time) for g in model.loads if isinstance(g, Gravity)), start=np.zeros(3))
        lift = -load.density * load.area * gravity
        return Distributed(rod=load.rod, value=lambda s, t: t * lift)
    if isinstance(load, Decay):
        return _changed(load, {})  # nothing at rest
    if isinstance(load, Drag):
        raise ValueError(f'{owner}: {load} has no value to multiply; let its velocity depend on t and give "time"')
    assert isinstance(load, RodLoad)
    name = _VALUES[type(load)]
    given = getattr(load, name)

    def amount(*arguments: Any) -> Any:
        found = given(*arguments[:-1], time) if callable(given) else np.asarray(given)
        return arguments[-1] * found

    function: Callable[..., Any] = (lambda t: amount(t)) if name == "tension" else (lambda s, t: amount(s, t))
    return _changed(load, {name: function})


def _changed(load: RodLoad, values: Mapping[str, Any]) -> RodLoad:
    """A load along a rod with other values, that acts for all times."""
    found: RodLoad = replace(load, **values, start=0.0, until=np.inf)  # type: ignore[type-var]
    return found


class _Frozen:
    """Symbols of a density with another time."""

    def __init__(self, q: Any, time: float) -> None:
        self._q, self.t = q, time

    def __getattr__(self, name: str) -> Any:
        return getattr(self._q, name)


def _pairs(load: Density, q: Any, c: Any, time: float, factor: Any) -> list[tuple[Any, Any]]:
    """Pairs (F, e) of a load at one time, times a factor."""
    return [(factor * force, quantity) for force, quantity in load.force(_Frozen(q, time), c)]
