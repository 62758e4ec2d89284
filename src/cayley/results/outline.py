"""What results need to know of a system besides its states: fields, rows, nodes and the name of the rule."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cayley.discrete.layout import Layout
from cayley.system.system import System


@dataclass(frozen=True, slots=True, kw_only=True)
class Outline:
    """A system without its equations: plain enough to be stored, and enough to label what was observed.

    Args:
        layout: fields, and rows of a node.
        rule: name of the rule.
        interval: name of the coordinate along the interval, or None for a system without one.
        nodes: coordinates of the nodes [m], shape (nodes,); of a system without interval, one zero.
    """

    layout: Layout
    rule: str
    interval: str | None
    nodes: np.ndarray

    def at_nodes(self, nodes: Sequence[int] | np.ndarray | None) -> "Outline":
        """That of some nodes; of all if None."""
        return self if nodes is None else replace(self, nodes=self.nodes[np.asarray(nodes)])

    @classmethod
    def of(cls, system: System) -> "Outline":
        """The outline of a system."""
        interval = system.groups[0].equations.density.lagrangian.interval  # of a model all have one
        nodes = np.zeros(system.size) if interval is None else system.nodes
        return cls(layout=system.layout, rule=system.equations.rule.name, interval=interval, nodes=nodes)
