"""The parts of a run: which of them it saved whole, and the fields of one."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.model import Body, LagrangianPart, PointMass

if TYPE_CHECKING:
    import xarray as xr


def saved_spans(parts: Mapping[str, slice], only: np.ndarray) -> dict[str, slice]:
    """Nodes of the parts all of whose nodes were saved, among those that were."""
    found = {}
    for name, nodes in parts.items():
        first = int(np.searchsorted(only, nodes.start))
        if np.array_equal(only[first : first + nodes.stop - nodes.start], np.arange(nodes.start, nodes.stop)):
            found[name] = slice(first, first + nodes.stop - nodes.start)
    return found


def part_dataset(run: Any, part: Any) -> "xr.Dataset":
    """Fields of one rod or body, given itself or by name.

    Raises:
        KeyError: there is none, or it was not saved.
    """
    from cayley.results.body import body_dataset, own_dataset
    from cayley.results.record import name_of
    from cayley.results.rod import rod_dataset

    name = part if isinstance(part, str) else name_of(part, run.model)
    if name not in run._parts:
        raise KeyError(f"the run has no part {part!r}; it has {', '.join(run._parts) or 'none (use run.data)'}")
    nodes = run._parts[name]
    own = run._part(str(name))
    if isinstance(own, LagrangianPart):
        return own_dataset(run, nodes, str(name))
    if isinstance(own, Body | PointMass):
        return body_dataset(run, nodes.start, str(name))
    return rod_dataset(run, nodes, str(name))
