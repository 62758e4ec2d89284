"""Rules: where in a step and in an element the terms of a Lagrangian are evaluated, as data."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, slots=True)
class Points:
    """Where along one side of a space-time cell a density is evaluated, on the unit interval.

    Args:
        name: word used in listings.
        at: positions in [0, 1].
        weights: quadrature weights, of sum 1.
        corners: True where values are those of the corners and derivatives difference quotients between them
            (ω = (2/h) Im(p̄ p⁺)); False where both come from the normalized polynomial through the nodes.
        screw: True where the strain of an element is that of the screw motion between the poses of its ends.

    Raises:
        ValueError: if positions and weights do not match or the weights do not sum to 1.
    """

    name: str
    at: tuple[float, ...]
    weights: tuple[float, ...]
    corners: bool
    screw: bool = False

    @property
    def between_ends(self) -> bool:
        """Whether the points are about two end nodes as they are, not about a polynomial."""
        return self.corners or self.screw

    def __post_init__(self) -> None:
        """Check the weights."""
        if len(self.at) != len(self.weights) or abs(sum(self.weights) - 1.0) > 1e-14:
            raise ValueError(f"Points {self.name}: give as many weights as positions, of sum 1")


def gauss(count: int) -> Points:
    """Gauss points on [0, 1], exact for polynomials of degree 2 count − 1.

    Args:
        count: number of points, which is the degree of the polynomials that they are used with.
    """
    at, weights = np.polynomial.legendre.leggauss(count)
    name = "middle" if count == 1 else f"{count} Gauss points"
    return Points(name, tuple(0.5 + 0.5 * at), tuple(0.5 * weights), corners=False)


def lobatto(degree: int) -> np.ndarray:
    """The Gauss-Lobatto points of [0, 1]: nodes of a polynomial that has both ends among them.

    (1 − x²) Pₙ′(x) = 0 with n the degree, brought from [−1, 1] to [0, 1]

    Args:
        degree: of the polynomial, 1 or more.

    Returns: points [-], shape (degree + 1,).
    """
    inner = np.polynomial.legendre.Legendre.basis(degree).deriv().roots() if degree > 1 else np.zeros(0)
    return 0.5 + 0.5 * np.concatenate([[-1.0], np.sort(np.real(inner)), [1.0]])


def lobatto_weights(degree: int) -> np.ndarray:
    """Weights of the Gauss-Lobatto points of [0, 1].

    wᵢ = 1/(n (n + 1) Pₙ(xᵢ)²) with n the degree and xᵢ the points on [−1, 1]

    Args:
        degree: of the polynomial, 1 or more.

    Returns: weights [-] of sum 1, shape (degree + 1,).
    """
    values = np.polynomial.legendre.Legendre.basis(degree)(2.0 * lobatto(degree) - 1.0)
    return 1.0 / (degree * (degree + 1) * values**2)


def lagrange(nodes: np.ndarray, at: Any) -> tuple[np.ndarray, np.ndarray]:
    """Lagrange polynomials of the nodes and their derivatives.

    ℓᵢ(x) = Π_(k≠i) (x − x_k)/(xᵢ − x_k)

    Args:
        nodes: x_k [-], shape (n,).
        at: places to evaluate at [-], shape (m,).

    Returns: ℓ and ℓ′ there, shape (m, n) each.
    """
    basis = []
    for i, node in enumerate(nodes):
        others = np.delete(nodes, i)
        basis.append(
            np.polynomial.Polynomial.fromroots(others) / float(np.prod(node - others))
            if len(others)
            else np.polynomial.Polynomial([1.0])
        )
    points = np.asarray(at, dtype=float)
    values = np.column_stack([p(points) for p in basis])
    return np.ascontiguousarray(values), np.ascontiguousarray(np.column_stack([p.deriv()(points) for p in basis]))


CORNERS = Points("corners", (0.0, 1.0), (0.5, 0.5), corners=True)
MIDDLE = gauss(1)
SCREW = Points("screw", (0.5,), (1.0,), corners=False, screw=True)


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

    @property
    def implicit(self) -> bool:
        """Whether the nodes of a step are coupled: everything but corners in time."""
        return not self.time.corners

    @property
    def degree(self) -> int:
        """Degree of the polynomials in space: nodes of an element less one."""
        return 1 if self.strain.between_ends else len(self.strain.at)

    @property
    def cell(self) -> int:
        """Nodes that a lane of an explicit kernel holds: an element without its right end."""
        return 1 if self.implicit else self.degree

    def __str__(self) -> str:
        """Name the rule."""
        return self.name


nodal = Rule("nodal", time=CORNERS, strain=CORNERS)
"""The paper's rule, eq. 7 to 9: everything at the corners. Explicit-like; locks in shear on coarse meshes."""

verlet = Rule("verlet", time=CORNERS, strain=MIDDLE)
"""Corners in time, strain at the middle of the element: explicit-like and free of shear locking."""

midpoint = Rule("midpoint", time=MIDDLE, strain=MIDDLE)
"""Everything at the middle, inertia and loads lumped at the nodes: implicit, no step limit from stiffness."""

nodal_midpoint = Rule("nodal_midpoint", time=MIDDLE, strain=CORNERS)
"""Corners in space, middle in time (the paper's footnote 1): locks like nodal, without its step limit."""

screw = Rule("screw", time=CORNERS, strain=SCREW)
"""Strain of the screw motion between the poses of an element's ends (Demoures et al. 2015, Hante et al. 2021): constant
along the element, so nothing locks and circles and helices are exact with any number of elements. Explicit-like."""

screw_midpoint = Rule("screw_midpoint", time=MIDDLE, strain=SCREW)
"""The same, middle in time: implicit."""

RULES = {rule.name: rule for rule in (nodal, verlet, midpoint, nodal_midpoint, screw, screw_midpoint)}


def by_name(name: str) -> Rule:
    """The rule of a name.

    Args:
        name: such as "verlet" or "galerkin(time=2, space=3)", as rules print themselves.

    Raises:
        ValueError: if there is no such rule.
    """
    found = re.fullmatch(r"galerkin\(time=(\d+)(?:, space=(\d+))?\)", name)
    if found:
        return galerkin(time=int(found[1]), space=int(found[2] or 1))
    found = re.fullmatch(r"spectral\(space=(\d+)\)", name)
    if found:
        return spectral(space=int(found[1]))
    if name not in RULES:
        families = "galerkin(time=..., space=...) or spectral(space=...)"
        raise ValueError(f"there is no rule {name!r}; give one of {', '.join(RULES)}, {families}")
    return RULES[name]


def galerkin(*, time: int, space: int = 1) -> Rule:
    """Polynomials in time and space, those of quaternions normalized where they are used, with as many Gauss points.

    Args:
        time: degree and number of Gauss points in time, r >= 1: order 2r.
        space: degree and number of Gauss points along an element, m >= 1: order 2m; inertia and loads take its m + 1
            Lobatto points, which are its nodes.

    Raises:
        ValueError: if a degree is no whole number from 1 to 8.

    Source: Leok and Shingel (2012), General techniques for constructing variational integrators; degree 1 in both is
    the rule midpoint.
    """
    _check_degrees("galerkin", time=time, space=space)
    name = f"galerkin(time={time})" if space == 1 else f"galerkin(time={time}, space={space})"
    return Rule(name, time=gauss(time), strain=gauss(space), order=2 * time)


def spectral(*, space: int) -> Rule:
    """Corners in time, polynomials in space: explicit steps, order 2 in time and 2m in space.

    Args:
        space: degree and number of Gauss points along an element, m >= 1; inertia and loads take its m + 1 Lobatto
            points, which are its nodes. Degree 1 is verlet.

    Raises:
        ValueError: if the degree is no whole number from 1 to 8.

    Source: spectral elements with lumped masses, Patera (1984), Maday and Patera (1989); normalized polynomials: Leok
    and Shingel (2012).
    """
    _check_degrees("spectral", space=space)
    return Rule(f"spectral(space={space})", time=CORNERS, strain=gauss(space))


def _check_degrees(family: str, **degrees: int) -> None:
    for word, degree in degrees.items():
        if isinstance(degree, bool) or not isinstance(degree, int) or not 1 <= degree <= 8:
            raise ValueError(f"{family}: {word} is {degree!r}; give a whole number from 1 to 8")
