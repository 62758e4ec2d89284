"""The fields of one rod as a labeled Dataset."""

from typing import Any

import numpy as np
import xarray as xr

from cayley.lie import quaternion
from cayley.results.contact import forces_on_nodes

_META = {
    "position": ("position", "m"),
    "rotation": ("unit quaternion, body to space", "1"),
    "velocity": ("velocity", "m/s"),
    "angular_velocity": ("angular velocity, body frame", "rad/s"),
    "force": ("internal force, body frame, tension positive", "N"),
    "moment": ("internal moment, body frame", "N m"),
    "sigma": ("spatial momentum dL/dx', space frame", "N"),
    "Sigma": ("spatial momentum dL/dOmega, body frame", "N m"),
    "sigma_impulse": ("discrete spatial momentum over one step, space frame", "N s"),
    "Sigma_impulse": ("discrete spatial momentum over one step, body frame", "N m s"),
    "strain": ("shear and stretch, body frame", "1"),
    "curvature": ("curvature and twist, body frame", "1/m"),
    "contact_force": ("force of contacts on the nodes, space frame", "N"),
}


def rod_dataset(run: Any, nodes: slice, name: str) -> xr.Dataset:
    """Fields of a rod, dims (time, node, axis), (time, node, wxyz) and (time, element, axis).

    Args:
        run: the Trajectory.
        nodes: its nodes among those of the system.
        name: its name.

    Returns: a Dataset with position, rotation, velocity, angular_velocity, force and moment (stress resultants in the
    body frame, Λᵀn and m), sigma and Sigma (the paper's spatial momenta, −n in space and −m) with their impulses over
    one step, and per element strain Γ and curvature Ω, those without stress included; with contact, contact_force.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 2 and section 6.1.
    """
    layout, observed = run.outline.layout, run.observed
    position, turn = run._values("x")[:, nodes], run._rotation("p")[:, nodes]
    spatial = observed.resultants[:, nodes]
    sigma, big_sigma = spatial[..., layout.dofs_of("x")], spatial[..., layout.dofs_of("p")]
    elements = slice(nodes.start, nodes.stop - 1)
    slopes = observed.slopes[:, elements]
    node, element = ("time", "node", "axis"), ("time", "element", "axis")
    fields = {
        "position": (node, position),
        "rotation": (("time", "node", "wxyz"), turn),
        "velocity": (node, observed.velocity[:, nodes, layout.dofs_of("x")]),
        "angular_velocity": (node, observed.velocity[:, nodes, layout.dofs_of("p")]),
        "force": (node, _inverse_rotate(turn, -sigma)),
        "moment": (node, -big_sigma),
        "sigma": (node, sigma),
        "Sigma": (node, big_sigma),
        "sigma_impulse": (node, sigma * run.dt),
        "Sigma_impulse": (node, big_sigma * run.dt),
        "strain": (
            element,
            _inverse_rotate(_middle(turn), slopes[..., layout.dofs_of("x")]) - np.array([0.0, 0.0, 1.0]),
        ),
        "curvature": (element, slopes[..., layout.dofs_of("p")]),
    }
    touched = forces_on_nodes(run, nodes)
    if touched is not None:
        fields["contact_force"] = (node, touched)
    variables = {
        key: (dims, np.ascontiguousarray(values), {"long_name": _META[key][0], "units": _META[key][1]})
        for key, (dims, values) in fields.items()
    }
    coordinates = {
        "time": ("time", run.time, {"units": "s"}),
        "s": ("node", run.outline.nodes[nodes], {"units": "m", "long_name": "arc length in the reference"}),
        "axis": ["x", "y", "z"],
        "wxyz": list("wxyz"),
    }
    return xr.Dataset(variables, coordinates, {"name": name})


def _inverse_rotate(p: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.asarray(quaternion.inverse_rotate(p, v), dtype=float)


def _middle(p: np.ndarray) -> np.ndarray:
    """Rotations at the middle of the elements."""
    total = p[:, 1:] + p[:, :-1]
    return total / np.linalg.norm(total, axis=-1, keepdims=True)
