"""Sums over all nodes of a run, and all its fields as one Dataset."""

from typing import Any

import numpy as np
import xarray as xr

from cayley.lie import quaternion
from cayley.results.series import Series

AXES = ["x", "y", "z"]


def series(run: Any, values: np.ndarray, long_name: str, units: str) -> xr.DataArray:
    """Values over the time of a run, shape (m,) or (m, 3), with their name and unit."""
    coordinates: dict[str, Any] = {"time": ("time", run.time, {"units": "s"})}
    dims: tuple[str, ...] = ("time",)
    if values.ndim == 2:
        dims, coordinates["axis"] = ("time", "axis"), AXES
    attributes = {"long_name": long_name, "units": units}
    return Series(values, coordinates, dims, name=long_name.replace(" ", "_"), attrs=attributes)


def account(run: Any, column: int) -> np.ndarray:
    """Work (0) or loss (1) since the first frame, shape (m,).

    Raises:
        ValueError: if the run kept no account of it.
    """
    if run.frames.work is None:
        raise ValueError(
            "this run kept no account of work: there are no forces beside the Lagrangian, and with balance=True a "
            "run keeps it for loads alone"
        )
    total: np.ndarray = run.frames.work[..., column].sum(axis=-1)
    return total - total[0]


def linear_momentum(run: Any) -> np.ndarray:
    """Σ μ_x [kg m/s], shape (m, 3).

    Raises:
        ValueError: if the run saved some nodes only.
    """
    _want_all(run)
    zero = np.zeros((len(run.time), 3))
    return sum((run._momenta(name).sum(axis=1) for name in run._vectors()), start=zero)


def angular_momentum(run: Any) -> np.ndarray:
    """Σ x × μ_x + Λ(p) μ_p about the origin [kg m²/s], shape (m, 3).

    Raises:
        ValueError: if the run saved some nodes only.
    """
    _want_all(run)
    total = np.zeros((len(run.time), 3))
    for name in run._vectors():
        total += np.cross(run._values(name), run._momenta(name)).sum(axis=1)
    for name in run.outline.layout.rotations:
        total += np.asarray(quaternion.rotate(run._rotation(name), run._momenta(name)), dtype=float).sum(axis=1)
    return total


def all_fields(run: Any) -> xr.Dataset:
    """Values, velocities (NAME_t) and momenta (NAME_momentum) of all fields."""
    layout, interval = run.outline.layout, run.outline.interval
    place = () if interval is None else ("node",)

    def squeezed(values: np.ndarray) -> np.ndarray:
        return values[:, 0] if interval is None else values

    fields: dict[str, Any] = {}
    for name in layout.fields:
        turns = name in layout.rotations
        width = run._values(name).shape[-1]
        own = "axis" if width == 3 else f"{name}_component"
        value = run._rotation(name) if turns else run._values(name)
        fields[name] = (("time", *place, "wxyz" if turns else own), squeezed(value))
        rate = run.observed.velocity[..., layout.dofs_of(name)]
        own = "axis" if turns or width == 3 else f"{name}_component"
        fields[f"{name}_t"] = (("time", *place, own), squeezed(rate))
        fields[f"{name}_momentum"] = (("time", *place, own), squeezed(run._momenta(name)))
    coordinates: dict[str, Any] = {"time": ("time", run.time, {"units": "s"})}
    if interval is not None:
        coordinates[interval] = ("node", run.outline.nodes, {"units": "m"})
    data = xr.Dataset(fields, coordinates)
    return data.assign_coords({d: c for d, c in (("axis", AXES), ("wxyz", list("wxyz"))) if d in data.dims})


def _want_all(run: Any) -> None:
    if run.only is not None:
        raise ValueError("momenta are sums over all nodes, and this run saved some of them only (save_only)")
