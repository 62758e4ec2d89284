"""Parts with a Lagrangian of their own as plain numbers and words, and back; the Lagrangian is there by name only."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cayley.density import Interval, Lagrangian, Rotation, Vector
from cayley.density.fields import Field
from cayley.model import LagrangianPart
from cayley.results.forces_record import Unstored
from cayley.results.sampled import Sampled


def own_record(part: LagrangianPart) -> dict[str, Any]:
    """A part as a dictionary that JSON can hold."""
    own, domain = part.lagrangian, part.domain
    places = [part.place(node) for node in range(part.node_count)]
    return {
        "name": part.name,
        "lagrangian": own.name,
        "fields": list(own.fields),
        "interval": own.interval,
        "constants": {name: np.asarray(value).tolist() for name, value in part.constants.items()},
        "domain": None if domain is None else [domain.start, domain.stop, domain.elements],
        "position": _place_record(part.position, [position for position, _ in places]),
        "rotation": _place_record(part.rotation, [rotation for _, rotation in places]),
        "ports": {name: [list(shift), list(turn)] for name, (shift, turn) in part.ports.items()},
    }


def own_from(record: Mapping[str, Any]) -> LagrangianPart:
    """A part of its record; what needs its Lagrangian asks for the model."""
    kinds: dict[str, Field] = {"p": Rotation(), "x": Vector(3)}
    lagrangian = Lagrangian(
        function=Unstored(str(record["lagrangian"]), ["q", "c"]),
        fields={name: kinds[name] for name in record["fields"]},
        interval=record["interval"],
        name=str(record["lagrangian"]),
    )
    domain = None if record["domain"] is None else Interval(*record["domain"])
    nodes = np.zeros(1) if domain is None else np.linspace(domain.start, domain.stop, domain.elements + 1)
    return LagrangianPart(
        lagrangian=lagrangian,
        constants=record["constants"],
        domain=domain,
        position=_place_from(record["position"], nodes, "position"),
        rotation=_place_from(record["rotation"], nodes, "rotation"),
        ports={name: (shift, turn) for name, (shift, turn) in record["ports"].items()},
        name=record["name"],
    )


def _place_record(given: Any, places: list[np.ndarray]) -> Any:
    """As given; of a function its name and values at the nodes."""
    if not callable(given):
        return list(given)
    name = str(getattr(given, "__name__", type(given).__name__))
    return {"function": name, "values": [place.tolist() for place in places]}


def _place_from(record: Any, nodes: np.ndarray, what: str) -> Callable[[float], Any] | Any:
    if not isinstance(record, Mapping):
        return record
    return Sampled(str(record["function"]), nodes, np.array(record["values"]), what, "s")


__all__ = ["own_from", "own_record"]
