"""A model as plain numbers and words, and back."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from cayley.model import Model, Port, Rod, Section
from cayley.model.loads import Gravity, LineLoad, Load, PointLoad
from cayley.model.rod_loads import KINDS, RodLoad
from cayley.model.supports import Support
from cayley.results.forces_record import damping_from, damping_record, rod_load_from, rod_load_record


class Sampled:
    """A load that was a function of time, of which the values at the saved frames are left.

    Args:
        name: name of the function.
        times: of the frames [s], shape (m,), rising.
        values: of the load, shape (m, 3).
    """

    def __init__(self, name: str, times: np.ndarray, values: np.ndarray) -> None:
        """Hold the table."""
        self.__name__, self.times, self.values = name, times, values

    def __call__(self, t: float) -> np.ndarray:
        """The value at the time of a frame.

        Raises:
            ValueError: for another time; nothing is interpolated, for a run that goes on must not differ silently.
        """
        time = float(t)
        k = int(np.searchsorted(self.times, time))
        if k == len(self.times) or self.times[k] != time:
            raise ValueError(
                f"the load function {self.__name__} is not in the store, only its values at the saved frames, and "
                f"t = {time:g} s is none of them; open the run with model=... to give the function again"
            )
        return self.values[k].copy()


def model_record(model: Model) -> dict[str, Any]:
    """A model as a dictionary that JSON can hold; functions of time are there by name only.

    Numbers are those of the model, bit for bit: JSON writes the shortest decimals that read back the same.
    """
    sections: list[Section] = []
    for rod in model.rods:
        if not any(rod.section is section for section in sections):
            sections.append(rod.section)
    return {
        "sections": [_section_record(section) for section in sections],
        "rods": [
            _rod_record(rod) | {"section": next(k for k, s in enumerate(sections) if s is rod.section)}
            for rod in model.rods
        ],
        "supports": [
            {
                **_port_record(support.port, model),
                "position": list(support.held_position),
                "rotation": list(support.held_rotation),
            }
            for support in model.supports
        ],
        "loads": [_load_record(load, model) for load in model.loads],
    }


def model_from(record: Mapping[str, Any], functions: Sequence[Callable[[float], Any] | None]) -> Model:
    """Make a model of its record.

    Args:
        record: made by model_record.
        functions: for every load the function of time it was, or None.
    """
    sections = [Section(**(given | {"name": str(given["name"])})) for given in record["sections"]]
    rods = [_rod_from(given, sections) for given in record["rods"]]
    supports = [
        Support(Port(rods[s["rod"]], s["node"]), tuple(s["position"]), tuple(s["rotation"])) for s in record["supports"]
    ]
    pairs = zip(record["loads"], functions, strict=True)
    loads = [_load_from(given, rods, function) for given, function in pairs]
    return Model(*rods, supports=supports, loads=loads)


def name_of(part: Any, model: Model | None) -> str | None:
    """The name of a rod in a model, or None: of the rod itself, else of the one rod that equals it in every number.

    An opened run has rods of its own, which a user's rods can only equal.
    """
    if model is None or not isinstance(part, Rod):
        return None
    pairs = list(zip(model.rods, model.names, strict=True))
    same = [name for rod, name in pairs if rod is part]
    if not same:
        own = _rod_record(part), _section_record(part.section)
        same = [name for rod, name in pairs if (_rod_record(rod), _section_record(rod.section)) == own]
    return same[0] if len(same) == 1 else None


def _section_record(section: Section) -> dict[str, Any]:
    return {
        "name": section.name,
        "stiffness": section.stiffness.tolist(),
        "mass_per_length": section.mass_per_length,
        "inertia": section.inertia.tolist(),
        "outline": section.outline.tolist(),
    }


def _rod_record(rod: Rod) -> dict[str, Any]:
    return {
        "name": rod.name,
        "length": rod.length,
        "elements": rod.elements,
        "origin": list(rod.origin),
        "direction": list(rod.direction),
        "normal": None if rod.normal is None else list(rod.normal),
        **({} if rod.kinematics == "shearable" else {"kinematics": rod.kinematics}),
        **({} if rod.damping is None else {"damping": damping_record(rod.damping)}),
    }


def _rod_from(record: Mapping[str, Any], sections: Sequence[Section]) -> Rod:
    damping = {"damping": damping_from(record["damping"])} if "damping" in record else {}
    return Rod(**({**record} | {"section": sections[record["section"]]} | damping))


def _port_record(port: Port, model: Model) -> dict[str, Any]:
    return {"rod": _index(port.part, model), "node": port.node}


def _index(rod: Rod, model: Model) -> int:
    return next(k for k, other in enumerate(model.rods) if other is rod)


def _load_record(load: Load, model: Model) -> dict[str, Any]:
    if isinstance(load, Gravity):
        return {"kind": "gravity", "acceleration": list(load.acceleration)}
    if isinstance(load, RodLoad):
        return rod_load_record(load, _index(load.rod, model))
    place = _port_record(load.port, model) if isinstance(load, PointLoad) else {"rod": _index(load.rod, model)}
    named = getattr(load.value, "__name__", type(load.value).__name__)
    return {
        "kind": load.kind,
        **place,
        "value": {"function": str(named)} if callable(load.value) else list(load.value),
        "frame": load.frame,
        "start": load.start,
        "until": None if load.until == math.inf else load.until,
    }


def _load_from(record: Mapping[str, Any], rods: Sequence[Rod], function: Callable[[float], Any] | None) -> Load:
    if record["kind"] == "gravity":
        return Gravity(tuple(record["acceleration"]))
    if record["kind"] in KINDS:
        return rod_load_from(record, list(rods))
    shared = {
        "kind": record["kind"],
        "value": tuple(record["value"]) if function is None else function,
        "frame": record["frame"],
        "start": record["start"],
        "until": math.inf if record["until"] is None else record["until"],
    }
    rod = rods[record["rod"]]
    return PointLoad(port=Port(rod, record["node"]), **shared) if "node" in record else LineLoad(rod=rod, **shared)


__all__ = ["Sampled", "model_from", "model_record", "name_of"]
