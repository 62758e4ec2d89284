"""Forces of joints and supports as labeled Datasets."""

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from cayley.model import Port
from cayley.model.joints import Joint
from cayley.model.supports import Support
from cayley.results.body import dataset, motion, node_of, port_of, rotate

Wrench = tuple[np.ndarray, np.ndarray]
"""Force, and moment about the position of a node, in space, shape (m, 3) each."""


def joint_dataset(run: Any, joint: Any) -> xr.Dataset:
    """What a joint exerts on its second side, at its place there, dims (time, axis).

    f₂ = −f₁,   m₂ = −m₁ − (P₁ − P₂) × f₁        (a joint as a whole exerts nothing)

    Args:
        run: the Trajectory.
        joint: a joint, guide or drive of the model, or its name.

    Returns: a Dataset with force and moment, both in space.

    Raises:
        KeyError: there is no such joint.
    """
    k = _number(run, joint)
    found = run.model.connections[k]
    force, moment = _of_joint(run, k)
    place = found.points[1] if found.grounded else _place(run, found.second)
    lever = motion(run, node_of(run, found.first))[0] - place
    return dataset(run, {"force": -force, "moment": -moment - np.cross(lever, force)}, run.model.connection_names[k])


def reaction_dataset(run: Any, support: Any, name: str | None = None) -> xr.Dataset:
    """What the ground exerts on a part, at the held place, dims (time, axis).

    Args:
        run: the Trajectory.
        support: a support, a joint to the ground or its name; or a place: a port, or a part or its name, with a name.
        name: of a port.

    Returns: a Dataset with force and moment, both in space. Components that several supports hold are in that of each.

    Raises:
        KeyError: there is no such support or place, it is a joint of two parts, or nothing holds the place.
    """
    if run.model is None:
        raise KeyError("a run of a Lagrangian of your own has no supports; run.observed.supports is of its held nodes")
    if isinstance(support, Support):
        port, wrench, called = support.port, _of_support(run, support), str(support)
    elif name is None and not isinstance(support, Port):
        k = _number(run, support)
        joint, called = run.model.connections[k], run.model.connection_names[k]
        if not joint.grounded:
            raise KeyError(f"{called} connects two parts; run.joint({called!r}) is its force on the second")
        port, wrench = joint.first, _of_joint(run, k)
    else:
        port, called = port_of(run, support, name)
        wrench = _of_place(run, port, called)
    port = port_of(run, port, None)[0]  # of the model that ran
    force, moment = wrench
    lever = motion(run, node_of(run, port))[0] - _place(run, port)
    return dataset(run, {"force": force, "moment": moment + np.cross(lever, force)}, called)


def _of_place(run: Any, port: Port, called: str) -> Wrench:
    """All that holds a node to the ground."""
    model, node = run.model, node_of(run, port)
    found = [_of_joint(run, k) for k, j in enumerate(model.connections) if j.grounded and node_of(run, j.first) == node]
    if any(node_of(run, support.port) == node for support in model.supports):
        found.append(_held(run, node))
    if not found:
        places = [support.port.called(model.name_of(support.port.part)) for support in model.supports]
        places += [joint.first.called(model.name_of(joint.first.part)) for joint in model.connections if joint.grounded]
        raise KeyError(f"nothing holds {called} to the ground; held are {', '.join(dict.fromkeys(places)) or 'none'}")
    return sum(force for force, _ in found), sum(moment for _, moment in found)  # type: ignore[return-value]


def _of_support(run: Any, support: Support) -> Wrench:
    """What one support exerts: of the forces on its node the components that it holds."""
    asked = replace(support, port=port_of(run, support.port, None)[0])
    if asked not in run.model.supports:
        held = ", ".join(map(str, run.model.supports)) or "none"
        raise KeyError(f"the run has no {support}; its supports are {held}")
    return _held(run, node_of(run, asked.port), support.held_position, support.held_rotation)


def _held(run: Any, node: int, position: Any = True, rotation: Any = True) -> Wrench:
    """What supports exert on a node; position and rotation tell which components count."""
    layout, observed = run.outline.layout, run.observed
    exerted = observed.supports[:, int(np.searchsorted(observed.held, node))]
    force = np.where(position, exerted[:, layout.dofs_of("x")], 0.0)
    moment = np.where(rotation, exerted[:, layout.dofs_of("p")], 0.0)
    return force, rotate(motion(run, node)[1], moment)


def _of_joint(run: Any, k: int) -> Wrench:
    """What a joint exerts on the node of its first side."""
    layout, exerted = run.outline.layout, run.observed.reactions[:, k]
    turn = motion(run, node_of(run, run.model.connections[k].first))[1]
    return exerted[:, layout.dofs_of("x")], rotate(turn, exerted[:, layout.dofs_of("p")])


def _place(run: Any, port: Port) -> np.ndarray:
    """Where a port is, shape (m, 3)."""
    x, p, _, _ = motion(run, node_of(run, port))
    return x + rotate(p, np.array(port.shift))


def _number(run: Any, joint: Any) -> int:
    """Which of the joints of the model is meant.

    Raises:
        KeyError: there is no such joint.
    """
    model = run.model
    names = () if model is None else model.connection_names
    found = [k for k, name in enumerate(names) if model.connections[k] is joint or name == joint]
    if isinstance(joint, Joint) and not found:
        found = [k for k in range(len(names)) if _same(run, model.connections[k], joint)]
    if not found:
        shown = str(joint) if isinstance(joint, Joint) else repr(joint)
        raise KeyError(f"the run has no joint {shown}; it has {', '.join(names) or 'none'}")
    return found[0]


def _same(run: Any, own: Joint, other: Joint) -> bool:
    """Whether a joint of an opened run is that of the model it was made of, which it can only equal."""
    try:
        ports = tuple(port_of(run, port, None)[0] for port in other.ports)
    except KeyError:
        return False
    words = ("kind", "name", "axis", "other", "length")
    return own.ports == ports and all(getattr(own, word) == getattr(other, word) for word in words)


__all__ = ["joint_dataset", "reaction_dataset"]
