"""Motions of a model, such as those by which it buckles, part by part."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.lie import quaternion
from cayley.model import Model
from cayley.results.record import name_of
from cayley.steppers.still import Still

if TYPE_CHECKING:
    import xarray as xr

STILL = 1e-9
"""Displacement over extent and turns below which nothing is displaced."""


class Mode:
    """A small motion of a model: ``mode[part]`` has displacement [m] and turn [rad] of its nodes, in space.

    The largest component of all displacements is 1 m, or, where nothing is displaced, that of the turns 1 rad.
    """

    def __init__(self, model: Model, parts: Mapping[str, slice], still: Still, vector: np.ndarray) -> None:
        """Take it apart.

        Args:
            model: the model.
            parts: nodes of each part by name.
            still: the system, at the values about which it moves.
            vector: motion of the unknowns.
        """
        layout, moves, values = still.system.layout, vector[still.dofs], still.values
        self.model, self.parts, self.nodes = model, dict(parts), still.system.nodes
        shift = moves[:, layout.dofs_of("x")]
        turned = layout.representation.to_quaternion(values[:, layout.rows_of("p")])
        turn = np.asarray(quaternion.rotate(turned, moves[:, layout.dofs_of("p")]), dtype=float)
        largest = shift.flat[np.argmax(np.abs(shift))]
        if abs(largest) * still.made.struct.extent < STILL * np.abs(turn).max():
            largest = turn.flat[np.argmax(np.abs(turn))]
        self.displacement, self.turn = shift / largest, turn / largest

    def __getitem__(self, part: Any) -> "xr.Dataset":
        """Displacement and turn of a part, given itself or by name, dims (node, axis).

        Raises:
            KeyError: there is no such part.
        """
        import xarray as xr

        name = part if isinstance(part, str) else name_of(part, self.model)
        if name not in self.parts:
            raise KeyError(f"the model has no part {part!r}; it has {', '.join(self.parts)}")
        own = self.parts[str(name)]
        fields = {
            key: (("node", "axis"), values[own], {"units": unit})
            for key, values, unit in (("displacement", self.displacement, "m"), ("turn", self.turn, "rad"))
        }
        return xr.Dataset(fields, {"s": ("node", self.nodes[own], {"units": "m"}), "axis": list("xyz")})

    def __repr__(self) -> str:
        """Which parts move most."""
        sizes = {name: float(np.abs(self.displacement[own]).max()) for name, own in self.parts.items()}
        return f"<Mode: largest displacement in {max(sizes, key=lambda name: sizes[name])}>"
