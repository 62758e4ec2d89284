"""Rules: where in a step and in an element the terms of a Lagrangian are evaluated, as data."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Points:
    """Where along one side of a space-time cell a density is evaluated, on the unit interval.

    Args:
        name: word used in listings.
        at: positions in [0, 1].
        weights: quadrature weights, of sum 1.
        corners: True where values are those of the corners and derivatives difference quotients between them
            (ω = (2/h) Im(p̄ p⁺)); False where both come from the normalized polynomial through the nodes.

    Raises:
        ValueError: if positions and weights do not match or the weights do not sum to 1.
    """

    name: str
    at: tuple[float, ...]
    weights: tuple[float, ...]
    corners: bool

    def __post_init__(self) -> None:
        """Check the weights."""
        if len(self.at) != len(self.weights) or abs(sum(self.weights) - 1.0) > 1e-14:
            raise ValueError(f"Points {self.name}: give as many weights as positions, of sum 1")


CORNERS = Points("corners", (0.0, 1.0), (0.5, 0.5), corners=True)
MIDDLE = Points("middle", (0.5,), (1.0,), corners=False)


@dataclass(frozen=True, slots=True)
class Rule:
    """A quadrature rule for the action of one space-time cell.

    L_d = Σ over points in time, Σ over points in space, of weight × h × ds × term; inertia and loads are lumped at the
    nodes (corners in space), the strain terms stand where ``strain`` says.

    Args:
        name: name of the rule.
        time: points along the step.
        strain: points along the element for the terms with derivatives along the interval.
        order: order in the step and in the element length.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), section 5.2 and its footnote 1.
    """

    name: str
    time: Points
    strain: Points
    order: int = 2

    def __str__(self) -> str:
        """Name the rule."""
        return self.name


nodal = Rule("nodal", time=CORNERS, strain=CORNERS)
"""The paper's rule, eq. 7 to 9: everything at the corners. Explicit-like; locks in shear on coarse meshes."""

verlet = Rule("verlet", time=CORNERS, strain=MIDDLE)
"""Corners in time, strain at the middle of the element: explicit-like and free of shear locking."""

RULES = {rule.name: rule for rule in (nodal, verlet)}
