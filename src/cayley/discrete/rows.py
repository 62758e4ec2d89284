"""Rows of a block of lanes: where values, momenta and everything else of its nodes stand."""

from dataclasses import dataclass, field

from cayley.density.force import KINDS
from cayley.discrete.layout import Layout


@dataclass(frozen=True, slots=True)
class Rows:
    """Where things stand in a block: one row of lanes each.

    Args:
        values: values of the nodes of a lane, one after the other.
        momenta: their momenta.
        carried: forces handed from an element to its right node.
        held: 1 where a degree of freedom is free, 0 where it is held.
        named: single rows, of the first node of a lane: "weight" and "1/weight" of the node [m], "length" of the
            element to its right (0 where there is none), and, where they are not uniform, "inverse", "here" and
            constants.
        observed: velocities, loads and energies of the nodes; for one node a lane also forces on the left and right
            node of the element and slopes.
        count: number of rows.
        cell: nodes of a lane: those of the element to its right without the end, m for degree m.
        forced: what those of densities with non-conservative forces do (see discrete.forced): "account", work and
            loss of the nodes of a lane since the start; "pushed", time-dependent loads; "still", forces that are not in
            the Lagrangian and do not depend on velocities; "force", all that do not; "rate", M⁻¹P; "predicted", v*;
            "carried still" and "carried moving", handed from an element to its right node.
    """

    values: slice
    momenta: slice
    carried: slice
    held: slice
    named: dict[str, int]
    observed: dict[str, slice]
    count: int
    cell: int = 1
    forced: dict[str, slice] = field(default_factory=dict)

    @property
    def kept(self) -> int:
        """How many rows, the first ones, make a frame."""
        return self.forced["account"].stop if self.forced else self.momenta.stop


def assign_rows(layout: Layout, varying: list[str], cell: int = 1, *, interval: bool, forced: bool = False) -> Rows:
    """Give everything a lane stores its row."""
    at = 0

    def take(size: int) -> slice:
        nonlocal at
        at += size
        return slice(at - size, at)

    values, momenta = take(cell * layout.rows), take(cell * layout.dofs)
    more = {"account": take(2)} if forced else {}
    carried = take(layout.dofs if interval else 0)
    held = take(cell * layout.dofs)
    named = {
        name: take(1).start for name in ["weight", "1/weight", *(["length", "here"] if interval else []), *varying]
    }
    observed = {"velocity": take(cell * layout.dofs), "load": take(cell * layout.dofs), "energies": take(cell * 3)}
    if interval and cell == 1:
        observed |= {"left": take(layout.dofs), "right": take(layout.dofs), "slopes": take(layout.dofs)}
    if forced:
        more |= {name: take(cell * layout.dofs) for name in ("pushed", "still", "force", "rate", "predicted")}
        more |= {f"carried {kind}": take(layout.dofs if interval else 0) for kind in KINDS}
    return Rows(values, momenta, carried, held, named, observed, at, cell, forced=more)
