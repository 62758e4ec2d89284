"""Damping and loads along rods as plain numbers and words, and back."""

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from cayley.model import Rod
from cayley.model.damping import Damping
from cayley.model.rod_loads import KINDS, RodLoad


class Unstored:
    """A function that was not kept in a store, only its name and what it takes.

    Args:
        name: of the function.
        arguments: names of its arguments.
    """

    def __init__(self, name: str, arguments: list[str]) -> None:
        """Hold the name."""
        self.__name__, self.arguments = name, tuple(arguments)

    def __call__(self, *values: Any) -> Any:
        """Refuse.

        Raises:
            ValueError: always.
        """
        raise ValueError(
            f"the function {self.__name__} is not in the store, only its name; open the run with model=... to give it "
            f"again"
        )


_ARGUMENTS = {"velocity": ["x", "t"], "tension": ["t"], "offset": ["s"], "force": ["q", "c"]}
"""Of functions that are attributes of loads; others take (s, t)."""


def damping_record(damping: Damping) -> dict[str, Any]:
    """Damping as a dictionary that JSON can hold."""
    viscosity = None if damping.viscosity is None else damping.viscosity.tolist()
    return {"retardation": list(damping.retardation), "viscosity": viscosity, "decay": damping.decay}


def damping_from(record: Mapping[str, Any]) -> Damping:
    """Damping of its record."""
    return Damping(**record)


def rod_load_record(load: RodLoad, rod: int) -> dict[str, Any]:
    """A load along a rod as a dictionary that JSON can hold; rod is the number of the rod."""
    found: dict[str, Any] = {"kind": load.kind, "rod": rod}
    for one in fields(load):  # type: ignore[arg-type]
        if one.name != "rod":
            found[one.name] = _plain(getattr(load, one.name))
    return found


def rod_load_from(record: Mapping[str, Any], rods: list[Rod]) -> RodLoad:
    """A load along a rod of its record."""
    values = {name: value for name, value in record.items() if name not in ("kind", "rod")}
    for name, value in values.items():
        if isinstance(value, Mapping) and "function" in value:
            values[name] = Unstored(str(value["function"]), _ARGUMENTS.get(name, ["s", "t"]))
    values["until"] = math.inf if values["until"] is None else values["until"]
    return KINDS[record["kind"]](rod=rods[record["rod"]], **values)  # type: ignore[call-arg]


def _plain(value: Any) -> Any:
    if callable(value):
        return {"function": str(getattr(value, "__name__", type(value).__name__))}
    if isinstance(value, Mapping):
        return {name: _plain(own) for name, own in value.items()}
    if isinstance(value, np.ndarray | tuple):
        return np.asarray(value).tolist()
    return None if value == math.inf else value
