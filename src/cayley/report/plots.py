"""`run.plot`: figures of a run for papers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from cayley.report import figures


class Plots:
    """Figures of one run, as Matplotlib figures: `run.plot.energy().savefig("energy.pdf")`."""

    def __init__(self, run: Any) -> None:
        """Of a Trajectory."""
        self._run = run

    def energy(self) -> Figure:
        """Kinetic, potential and total energy over the time."""
        return figures.energy(self._run)

    def momenta(self) -> Figure:
        """Linear and angular momentum over the time."""
        return figures.momenta(self._run)

    def balance(self) -> Figure:
        """Change of energy, work, loss, and the defect of their balance over the time.

        Raises:
            ValueError: if the run kept no account of work.
        """
        return figures.balance(self._run)

    def snapshots(self, part: Any = None, *, times: Sequence[float] | None = None) -> Figure:
        """Rods and bodies in space at some times, colored by the moment.

        Args:
            part: a rod, its name, or a list of them; by default all rods, bodies and joints.
            times: [s]; by default four of equal distance.
        """
        return figures.snapshots(self._run, part, times)

    def along(self, quantity: str, part: Any = None, *, times: Sequence[float] | None = None) -> Figure:
        """A field along a rod at some times.

        Args:
            quantity: a variable of `run[rod]`, such as "moment".
            part: a rod or its name; the first one by default.
            times: [s]; by default four of equal distance.

        Raises:
            KeyError: no such rod or field.
        """
        return figures.along(self._run, quantity, part, times)

    def over_time(self, part: Any, quantity: str, *, node: int | None = None) -> Figure:
        """A field of a part over the time.

        Args:
            part: a rod or body, or its name.
            quantity: a variable of `run[part]`, such as "moment".
            node: of a rod, or the number of the element; by default the middle one.

        Raises:
            KeyError: no such part or field.
        """
        return figures.over_time(self._run, part, quantity, node)

    def resultants(self, part: Any = None, *, nodes: Sequence[int] | None = None, impulse: bool = False) -> Figure:
        """Stress resultants of a rod over the time at some nodes, as in the paper's Figure 5.

        Args:
            part: a rod or its name; the first one by default.
            nodes: node numbers; by default the first, the middle and the last.
            impulse: the discrete momenta over one step instead.
        """
        return figures.resultants(self._run, part, nodes, impulse=impulse)
