"""The start of a run: values, velocities and momenta of all nodes that agree with supports and constraints."""

import functools
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cayley.discrete.rules import Rule
from cayley.model import Model
from cayley.simulation.failure import name_of
from cayley.steppers.contacts import view
from cayley.steppers.outcome import Outcome
from cayley.steppers.saddle import constrained_nodes, is_constrained, projected, violation
from cayley.system.discretize import discretize, initial_values
from cayley.system.legendre import initial_state
from cayley.system.system import State, System

START_TOLERANCE = 1e-8
"""Largest violation of a constraint at the start; the first step removes it."""
OVERLAP = 0.02
"""Depth at the start, in radii, that is no overlap."""


def start_of_model(
    model: Model,
    rotation: str,
    initial: Mapping[Any, Mapping[str, Any]] | None,
    *,
    start: Any = None,
    account: bool = False,
) -> Callable[[Rule], tuple[System, State]]:
    """A function that makes system and start for a rule, once for each; start is what simulate takes.

    Raises:
        ValueError: if start is no state, or given with initial.
    """
    known = getattr(start, "state", start)
    if start is not None and not isinstance(known, State):
        raise ValueError(f"start is a {type(start).__name__}; give an Equilibrium, a Trajectory or a State")
    if known is not None and initial is not None:
        raise ValueError("start and initial are given; give one of them")

    @functools.cache
    def begin(rule: Rule) -> tuple[System, State]:
        system = discretize(model, rule, rotation=rotation, account=account)
        if known is not None:
            begin = replace(known, origin=known.time, step=0, h=0.0, memory=None, work=None)
            return system, _consistent(system, _fitting(system, begin), check_rates=False)
        values, velocity, momenta = initial_values(model, system, initial or {})
        state = initial_state(system, values, velocity)
        given = np.isfinite(momenta) & system.free
        state = replace(state, momenta=np.where(given, momenta, state.momenta))
        refuse_overlap(system, state.values)
        return system, _consistent(system, state, check_rates=not given.any())

    return begin


def refuse_overlap(system: System, values: np.ndarray) -> None:
    """Refuse a start at which parts overlap, unless the Contact allows it.

    Raises:
        ValueError: it names the two that overlap most, and how much.
    """
    touching = system.contact
    if touching is None or touching.contact.allow_overlap:
        return
    seen, deep = _depths(system, values)
    if deep.max(initial=0.0) <= OVERLAP:
        return
    worst = seen[int(np.argmax(deep))]
    raise ValueError(
        f"at the start {touching.described(int(worst[0]), int(worst[1]))} overlap by {worst[3]:.3g} m "
        f"({deep.max():.3g} radii), {np.count_nonzero(deep > OVERLAP)} pairs in all; move them apart, or give "
        "Contact(allow_overlap=True), which pushes them apart gently"
    )


def start_of_system(system: System, start: Mapping[str, Any] | State, time: float) -> State:
    """The state of a mapping by field, at a time, or a State that fits."""
    if isinstance(start, State):
        return _fitting(system, start)
    values, velocity = _values(system, start)
    return _consistent(system, initial_state(system, values, velocity, time=time))


def _consistent(system: System, state: State, *, check_rates: bool = True) -> State:
    """A start that agrees with the constraints of density and joints, its momenta projected.

    Raises:
        ValueError: if positions violate a constraint, velocities do, or a constraint is redundant.
    """
    if not is_constrained(system):
        return state
    _check_places(system, state)
    momenta, node = projected(system, state)
    if node >= 0:
        raise ValueError(
            f"at node {node} of the model: {Outcome.REDUNDANT.value}; hold less or give another kinematics"
        )
    change = np.abs(momenta - state.momenta).max(axis=0)
    scale = np.abs(state.momenta).max(axis=0)
    driven = any(joint.drive is not None for joint in system.joints)
    if check_rates and not driven and np.any(change > 1e-6 * scale.max(initial=0.0)):
        worst = int(np.argmax(np.abs(momenta - state.momenta).max(axis=1)))
        raise ValueError(
            f"the velocities at the start violate the constraint of {_who(system)}, most at node {worst}; give "
            f"velocities that keep it, such as v = v0 + w x r with the angular velocity w, or momenta, which are "
            f"projected"
        )
    return replace(state, momenta=momenta)


def _check_places(system: System, state: State) -> None:
    """Refuse a start off the constraints."""
    for cells, found in violation(system, state.values, state.time):
        worst = int(np.argmax(np.abs(found).max(axis=1)))
        size = float(np.abs(found[worst]).max())
        if size <= START_TOLERANCE:
            continue
        if cells.names:
            where = f"the start violates the joint {cells.names[worst]}"
        else:
            place = system.nodes[constrained_nodes(system)[int(cells.nodes[worst, 0])]]
            where = f"the start violates the constraint of {name_of(system)} in the element at s = {place:.6g} m"
        raise ValueError(f"{where} by {size:.3g}; give positions and rotations for which it is zero")


def _who(system: System) -> str:
    return name_of(system) if system.with_constraints else "the joints"


def kept_shallow(system: System, values: np.ndarray) -> System:
    """The system, to be run by steps that the library chooses: contacts deeper than an impact may be end the run.

    Args:
        system: the system.
        values: of its nodes at the start; what is deeper there may stay so.
    """
    touching = system.contact
    if touching is None or touching.contact.stiffness is not None:
        return system
    deepest = touching.contact.deepest
    if not touching.contact.allow_overlap:
        deepest = max(deepest, 2.0 * float(_depths(system, values)[1].max(initial=0.0)))
    return replace(system, contact=replace(touching, deepest=deepest))


def _depths(system: System, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All contacts, as ``view`` has them, and their depths in radii."""
    seen = view(system, values, 1.0)
    return seen, seen[:, 3] / seen[:, 4]


def _fitting(system: System, state: State) -> State:
    """The state, if it can be one of the system."""
    sizes = (system.size, system.layout.rows), (system.size, system.layout.dofs)
    if (state.values.shape, state.momenta.shape) != sizes:
        raise ValueError(
            f"start is a state of values {state.values.shape} and momenta {state.momenta.shape}, of another system or "
            f"rotation form; this one has values {sizes[0]} and momenta {sizes[1]}"
        )
    return state


def _values(system: System, start: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Values and velocities of all nodes from a mapping by field."""
    layout = system.layout
    values, velocity = system.reference.copy(), np.zeros((system.size, layout.dofs))
    allowed = [name + suffix for name in layout.fields for suffix in ("", "_t")]
    for key, given in start.items():
        if key not in allowed:
            raise ValueError(f"start names {key!r}; give {', '.join(allowed)}")
        name = key.removesuffix("_t") if key not in layout.fields else key
        turns = name in layout.rotations and key == name
        width = 4 if turns else layout.dofs_of(name).stop - layout.dofs_of(name).start
        try:
            array = np.broadcast_to(np.asarray(given, dtype=float), (system.size, width))
        except (TypeError, ValueError):
            raise ValueError(
                f"start[{key!r}] has shape {np.shape(given)}; give ({system.size}, {width}) or ({width},)"
            ) from None
        if not np.all(np.isfinite(array)):
            raise ValueError(f"start[{key!r}] has an entry that is not finite")
        if key != name:
            velocity[:, layout.dofs_of(name)] = array
        elif turns:
            length = np.linalg.norm(array, axis=1, keepdims=True)
            if np.any(np.abs(length - 1.0) > 1e-6):
                raise ValueError(f"start[{key!r}]: quaternions must have length 1, one has {length.max():.6g}")
            values[:, layout.rows_of(name)] = layout.representation.from_quaternion(array / length)
        else:
            values[:, layout.rows_of(name)] = array
    missing = [
        n for n in layout.fields if n not in start and n not in layout.rotations and "length" not in system.named
    ]
    if missing:
        raise ValueError(
            f"start does not give {missing[0]}; give its values, shape ({layout.fields[missing[0]].size},)"
        )
    return values, velocity
