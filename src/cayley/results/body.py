"""The fields of a rigid body and of ports as labeled Datasets."""

from typing import Any

import numpy as np
import xarray as xr

from cayley.discrete.rules import by_name
from cayley.lie import quaternion
from cayley.model import Body, LagrangianPart, Port
from cayley.model.loads import Gravity

_META = {
    "position": ("position", "m"),
    "rotation": ("unit quaternion, body to space", "1"),
    "velocity": ("velocity", "m/s"),
    "angular_velocity": ("angular velocity, body frame", "rad/s"),
    "kinetic_energy": ("kinetic energy", "J"),
    "potential_energy": ("potential energy of gravity", "J"),
    "force": ("force, space frame", "N"),
    "moment": ("moment about the place where the force acts, space frame", "N m"),
    "momentum": ("momentum dL/dv, space frame", "kg m/s"),
    "angular_momentum": ("angular momentum dL/domega, body frame", "kg m^2/s"),
    "energy": ("kinetic energy and potential energy of gravity", "J"),
}


def body_dataset(run: Any, node: int, name: str) -> xr.Dataset:
    """Fields of a rigid body or point mass, dims (time, axis), (time, wxyz) and (time,).

    T = ½ m ẋ·ẋ + ½ ω·Jω,   V = −m g·x

    Args:
        run: the Trajectory.
        node: its node among those of the system.
        name: its name.

    Returns: a Dataset with position, rotation, velocity, angular_velocity (about the body's axes), kinetic_energy,
    potential_energy and energy.
    """
    part = run.model.parts[run.model.names.index(name)]
    x, p, v, omega = motion(run, node)
    inertia = part.inertia if isinstance(part, Body) else np.zeros((3, 3))
    gravity = sum((load.at(0.0) for load in run.model.loads if isinstance(load, Gravity)), start=np.zeros(3))
    kinetic = 0.5 * part.mass * np.sum(v * v, axis=-1) + 0.5 * np.sum(omega * (omega @ inertia), axis=-1)
    potential = -part.mass * x @ gravity
    fields = {"position": x, "rotation": p, "velocity": v, "angular_velocity": omega, "kinetic_energy": kinetic}
    return dataset(run, fields | {"potential_energy": potential, "energy": kinetic + potential}, name)


def own_dataset(run: Any, nodes: slice, name: str) -> xr.Dataset:
    """Fields of a part with a Lagrangian of its own, dims (time, axis) and (time, wxyz), on an interval with node.

    Args:
        run: the Trajectory.
        nodes: its nodes among those of the system.
        name: its name.

    Returns: a Dataset with position, rotation, velocity, angular_velocity, momentum ∂L/∂ẋ (in space) and
    angular_momentum ∂L/∂ω (about the body's axes), those of a node on an interval times its part of the length.
    """
    layout, part = run.outline.layout, run.model.parts[run.model.names.index(name)]
    momenta, rates = run.frames.momenta[:, nodes], run.observed.velocity[:, nodes]
    x, p = layout.dofs_of("x"), layout.dofs_of("p")
    fields = {
        "position": run._values("x")[:, nodes],
        "rotation": run._rotation("p")[:, nodes],
        "velocity": rates[..., x],
        "angular_velocity": rates[..., p],
        "momentum": momenta[..., x],
        "angular_momentum": momenta[..., p],
    }
    if part.domain is None:
        return dataset(run, {key: values[:, 0] for key, values in fields.items()}, name)
    return dataset(run, fields, name).assign_coords(s=("node", run.outline.nodes[nodes], {"units": "m"}))


def port_dataset(run: Any, port: Port, name: str) -> xr.Dataset:
    """Motion of a place on a part and of its frame, dims (time, axis) and (time, wxyz).

    P = x + Λ(p) o,   Ṗ = ẋ + Λ(p)(ω × o),   F = p f,   its angular velocity Λ(f)ᵀω

    Args:
        run: the Trajectory.
        port: the port, on a part of the model that ran.
        name: what to call it.

    Returns: a Dataset with position, rotation, velocity and angular_velocity (about the axes of the port).
    """
    x, p, v, omega = motion(run, node_of(run, port))
    shift, turn = np.array(port.shift), np.array(port.turn)
    fields = {
        "position": x + rotate(p, shift),
        "rotation": np.asarray(quaternion.multiply(p, turn), dtype=float),
        "velocity": v + rotate(p, np.cross(omega, shift)),
        "angular_velocity": np.asarray(quaternion.inverse_rotate(turn, omega), dtype=float),
    }
    return dataset(run, fields, name)


def port_of(run: Any, part: Any, name: str | None) -> tuple[Port, str]:
    """The port meant by a part (or its name) and a name, or by a port; of the model that ran.

    Raises:
        KeyError: there is no such part or port.
    """
    from cayley.results.record import name_of

    if run.model is None:
        raise KeyError("a run of a Lagrangian of your own has no parts; use run.data")
    own = part.part if isinstance(part, Port) else part
    called = own if isinstance(own, str) else name_of(own, run.model)
    if called not in run.model.names:
        raise KeyError(f"the run has no part {own!r}; it has {', '.join(run.model.names)}")
    found = run.model.parts[run.model.names.index(called)]
    if isinstance(part, Port):
        port = Port(found, part.node, shift=part.shift, turn=part.turn, name=part.name)
    elif isinstance(found, Body | LagrangianPart):
        try:
            port = found.port(str(name))
        except ValueError as error:
            raise KeyError(str(error)) from None
    else:
        ports = {found.node_name(node): Port(found, node) for node in (0, found.node_count - 1)}
        if name not in ports:
            has = ", ".join(ports)
            raise KeyError(f"{called} has no port {name!r}; it has {has}, or give a port such as rod.node(3)")
        port = ports[str(name)]
    return port, port.called(str(called))


def node_of(run: Any, port: Port) -> int:
    """The node of a port among all nodes."""
    first = int(run.spans[run.model.name_of(port.part)].start)
    return int(run.index_of(first + port.node * by_name(run.rule).degree))


def motion(run: Any, node: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Position, rotation, velocity and angular velocity of a node over the time."""
    layout, rates = run.outline.layout, run.observed.velocity[:, node]
    turned = run.outline.layout.representation.to_quaternion(run._values("p")[:, node])
    return run._values("x")[:, node], turned, rates[:, layout.dofs_of("x")], rates[:, layout.dofs_of("p")]


def rotate(p: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vectors turned by rotations."""
    return np.asarray(quaternion.rotate(p, v), dtype=float)


def dataset(run: Any, fields: dict[str, np.ndarray], name: str) -> xr.Dataset:
    """Fields over the time with names and units, shape (m,), (m, 3) or (m, 4) each, or (m, nodes, 3), (m, nodes, 4)."""
    last = {3: ("axis",), 4: ("wxyz",)}
    variables = {
        key: (
            ("time", "node")[: max(values.ndim - 1, 1)] + (last[values.shape[-1]] if values.ndim > 1 else ()),
            np.ascontiguousarray(values),
            {"long_name": _META[key][0], "units": _META[key][1]},
        )
        for key, values in fields.items()
    }
    coordinates = {"time": ("time", run.time, {"units": "s"}), "axis": ["x", "y", "z"], "wxyz": list("wxyz")}
    return xr.Dataset(variables, coordinates, {"name": name})
