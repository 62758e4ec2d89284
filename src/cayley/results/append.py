"""What of a run stands in which array of its store, written at once or chunk by chunk (see results.store)."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cayley import __version__
from cayley.discrete.layout import Layout
from cayley.model import Model
from cayley.model.loads import LineLoad, PointLoad
from cayley.results.arrays import Arrays
from cayley.results.frames import Frames
from cayley.results.observe import Observations
from cayley.results.outline import Outline
from cayley.results.record import model_record
from cayley.results.tie_record import driven_functions
from cayley.steppers.contacts import TOLD

FORMAT = "cayley run"
VERSION = 2
ENERGIES = {"kinetic": "kinetic_energy", "strain": "strain_energy", "load": "load_energy"}
ON_INTERVAL = {"slope": "slopes", "resultant": "resultants"}
_UNITS = {  # of a rod; what the fields of a Lagrangian of one's own mean, its author knows
    "x": {"value": "m", "velocity": "m/s", "momentum": "kg m/s", "slope": "1", "resultant": "N"},
    "p": {"value": "1", "velocity": "rad/s", "momentum": "kg m^2/s", "slope": "1/m", "resultant": "N m"},
}


def about_run(
    outline: Outline,
    parts: Mapping[str, slice],
    model: Model | None,
    h: float,
    origin: float,
    only: Sequence[int] | None = None,
) -> dict[str, Any]:
    """Attributes of a store, without "info"; only: the nodes it has, if not all."""
    layout = outline.layout
    some: dict[str, Any] = {} if only is None else {"only": [int(node) for node in only], "size": len(outline.nodes)}
    if model is not None and model.contact is not None:  # numbers of a frame
        some["contact"] = TOLD + len(outline.nodes) * layout.dofs
    return some | {
        "format": FORMAT,
        "version": VERSION,
        "cayley": __version__,
        "rule": outline.rule,
        "dt": h,
        "origin": origin,
        "fields": [[n, "rotation" if n in layout.rotations else kind.size] for n, kind in layout.fields.items()],
        "rotation": layout.representation.name,
        "interval": outline.interval,
        "parts": {name: [nodes.start, nodes.stop] for name, nodes in parts.items()},
        "model": None if model is None else model_record(model),
    }


def attributes(path: Path) -> Mapping[str, Any]:
    """Attributes of the group at a path; none where there is no group."""
    try:
        found = json.loads((path / "zarr.json").read_text(encoding="utf-8"))["attributes"]
    except (OSError, ValueError, KeyError, TypeError):
        return {}
    return found if isinstance(found, dict) else {}


def check_replaceable(path: Path, *, overwrite: bool) -> None:
    """Refuse to write over what is at a path.

    Raises:
        FileExistsError: without overwrite; with it, something that is no run.
    """
    if not overwrite:
        raise FileExistsError(f"{path} is there already; give another path, or overwrite=True to replace it")
    if attributes(path).get("format") != FORMAT:
        raise FileExistsError(f"{path} is no run of cayley, so it is not overwritten; remove it or give another path")


def plain(info: Mapping[str, Any]) -> dict[str, Any]:
    """Facts of a run as JSON holds them."""
    return dict(json.loads(json.dumps(dict(info), default=float)))


def append_frames(arrays: Arrays, outline: Outline, frames: Frames, model: Model | None, start: int = 0) -> None:
    """Write states, and what loads and motions are then, behind the first ``start`` frames."""
    layout = outline.layout
    times = {"time": ("s", frames.times)}
    for name in layout.fields:
        group = f"fields/{name}"
        arrays.put(group, times, ("time",), start=start)
        if outline.interval is not None and start == 0:
            arrays.put(group, {outline.interval: ("m", outline.nodes)}, ("node",))
        units = _UNITS[name] if model is not None else {}
        for key, values in states_of_field(layout, name, frames).items():
            turns = key == "value" and name in layout.rotations
            component = {4: "wxyz", 9: "entry"}[layout.representation.rows] if turns else "axis"
            own = {key: (units.get(key), values)}
            arrays.put(group, own, ("time", "node", component), along=outline.interval, start=start)
    if frames.work is not None:
        arrays.put("", {"work": ("J", frames.work)}, ("time", "cell", "account"), start=start)
    if frames.rates is not None and (start == 0 or "rates" in arrays.root):
        arrays.put("", {"rates": (None, frames.rates)}, ("time", "node", "component"), start=start)
    if frames.contact is not None and (start == 0 or "contact" in arrays.root):
        arrays.put("", {"contact": (None, frames.contact)}, ("time", "contact_row"), start=start)
    for k, load in enumerate(model.loads if model is not None else ()):
        if isinstance(load, PointLoad | LineLoad) and callable(load.value):
            table = np.array([load.at(float(t)) for t in frames.times])
            arrays.put(f"loads/{k}", times, ("time",), start=start)
            arrays.put(f"loads/{k}", {"value": (load.unit, table)}, ("time", "axis"), start=start)
    for name, quantity, joint in driven_functions(model) if model is not None else ():
        unit = "m" if quantity in ("displacement", "position") else "rad"
        motion = {quantity: (unit, joint.motion(quantity, frames.times))}
        arrays.put(f"motions/{name}", motion, ("time", "axis"), start=start)
    arrays.put("", {"step": ("1", frames.steps)}, ("time",), start=start)
    arrays.put("", times, ("time",), start=start)


def append_observed(arrays: Arrays, outline: Outline, observed: Observations, start: int = 0) -> None:
    """Write what was observed of frames behind the first ``start`` ones."""
    energies = {name: ("J", getattr(observed, key)) for key, name in ENERGIES.items()}
    arrays.put("", energies, ("time",), start=start)
    if observed.reactions is not None:
        arrays.put("", {"reactions": (None, observed.reactions)}, ("time", "joint", "component"), start=start)
    if observed.held is not None and observed.supports is not None:
        if start == 0:
            arrays.put("", {"held": (None, observed.held)}, ("support",))
        arrays.put("", {"supports": (None, observed.supports)}, ("time", "support", "component"), start=start)
    own_model = arrays.root.attrs["model"] is not None
    for name in outline.layout.fields:
        for key, values in observed_of_field(outline, name, observed).items():
            own = {key: (_UNITS[name].get(key) if own_model else None, values)}
            arrays.put(f"fields/{name}", own, ("time", "node", "axis"), along=outline.interval, start=start)


def states_of_field(layout: Layout, name: str, frames: Frames) -> dict[str, np.ndarray]:
    """Parts of the arrays of frames that belong to a field, shape (m, nodes, components) each."""
    return {
        "value": frames.values[..., layout.rows_of(name)],
        "momentum": frames.momenta[..., layout.dofs_of(name)],
    }


def observed_of_field(outline: Outline, name: str, observed: Observations) -> dict[str, np.ndarray]:
    """Parts of the arrays of observations that belong to a field, shape (m, nodes, components) each."""
    along = ON_INTERVAL if outline.interval is not None else {}
    names = {"velocity": "velocity"} | along
    return {key: getattr(observed, own)[..., outline.layout.dofs_of(name)] for key, own in names.items()}
