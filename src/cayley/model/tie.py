"""What joints and springs have in common: two sides, each a port or the ground."""

from __future__ import annotations

import numpy as np

from cayley.model.port import Ground, Port
from cayley.model.validate import Array

Side = Port | Ground


class Tie:
    """Something without mass between two ports, or a port and the ground.

    Attributes:
        first: a port.
        second: another, or the ground.
    """

    __slots__ = ()  # the dataclasses hold the values
    first: Port
    second: Side

    @property
    def grounded(self) -> bool:
        """Whether the second side is the ground."""
        return isinstance(self.second, Ground)

    @property
    def ports(self) -> tuple[Port, ...]:
        """The one or two ports."""
        return (self.first, self.second) if isinstance(self.second, Port) else (self.first,)

    @property
    def points(self) -> tuple[Array, Array]:
        """The points of either side in space at the start [m], shape (3,) each."""
        first = self.first.place[0]
        if isinstance(self.second, Port):
            return first, self.second.place[0]
        return first, first if self.second.position is None else np.array(self.second.position)

    @property
    def distance(self) -> float:
        """Distance of the two points at the start [m]."""
        first, second = self.points
        return float(np.linalg.norm(second - first))
