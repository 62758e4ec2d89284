"""Contacts of a run as labeled Datasets."""

from typing import Any

import numpy as np
import xarray as xr

from cayley.steppers.contacts import view

AXES = ["x", "y", "z"]


def contacts_dataset(run: Any) -> xr.Dataset:
    """Contacts over time: number, energy, depth and the deepest so far, dims (time,).

    Args:
        run: the Trajectory.

    Raises:
        ValueError: nothing can touch in its model, or its frames have some nodes only.
    """
    told = _told(run)
    meta = {
        "number": (told[:, 3].astype(np.int64), "contacts", "1"),
        "energy": (told[:, 0], "energy of contacts, with that of sticking friction", "J"),
        "depth": (told[:, 2], "largest depth, in radii of the thinner partner", "1"),
        "deepest": (np.maximum.accumulate(told[:, 6]), "largest depth of all steps so far, in radii", "1"),
    }
    variables = {
        key: (("time",), np.ascontiguousarray(values), {"long_name": name, "units": units})
        for key, (values, name, units) in meta.items()
    }
    return xr.Dataset(variables, {"time": ("time", run.time, {"units": "s"})})


def contacts_at(run: Any, frame: int) -> xr.Dataset:
    """All contacts at a frame, dims (contact,) and (contact, axis).

    Args:
        run: the Trajectory.
        frame: its number; -1 is the last.

    Returns: a Dataset of names of the two partners, their elements (-1 for what has none), the place where they touch,
    the normal from the second to the first, the depth and the normal force on the first.

    Raises:
        ValueError: as contacts_dataset.
        IndexError: there is no such frame.
    """
    _told(run)
    touching, count = run.system.contact, run.system.contact.segments
    seen = view(run.system, run.frames.values[frame], run.frames.h)
    partners = seen[:, :2].astype(np.int64)

    def element(item: int) -> int:
        return int(touching.arrays["along"][item]) if item < count else -1

    def names(column: int) -> np.ndarray:
        return np.array([touching.owner_of(int(k)) for k in partners[:, column]], dtype=str)

    each, space = ("contact",), ("contact", "axis")
    return xr.Dataset(
        {
            "first": (each, names(0)),
            "second": (each, names(1)),
            "first_element": (each, np.array([element(int(k)) for k in partners[:, 0]], dtype=np.int64)),
            "second_element": (each, np.array([element(int(k)) for k in partners[:, 1]], dtype=np.int64)),
            "place": (space, seen[:, 8:11], {"units": "m"}),
            "normal": (space, seen[:, 5:8], {"units": "1"}),
            "depth": (each, seen[:, 3], {"units": "m"}),
            "force": (each, seen[:, 11], {"units": "N", "long_name": "normal force"}),
        },
        {"axis": AXES, "time": ((), run.time[frame], {"units": "s"})},
    )


def _told(run: Any) -> np.ndarray:
    told: np.ndarray | None = run.frames.contact
    if told is None:
        what = "its frames have some nodes only (save_only)" if run.only is not None else "nothing can touch in its model"
        raise ValueError(f"the run tells no contacts: {what}")
    return told


__all__ = ["contacts_at", "contacts_dataset"]
