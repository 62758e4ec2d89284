"""The strain terms of an element between the nodes of a polynomial: kinematics and forces, unrolled."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.density import Density
from cayley.density.expression import Expression, cross, dot, wrap, zeros
from cayley.discrete.layout import Layout
from cayley.discrete.representation import homogeneous
from cayley.discrete.rules import Points, lagrange, lobatto
from cayley.lie import quaternion

ONE = np.array([1.0, 0.0, 0.0, 0.0])


def polynomial_forces(
    density: Density, points: Points, layout: Layout, nodes: list[Expression], place: Mapping[str, Any]
) -> list[Expression]:
    """Forces on the m + 1 Lobatto nodes of an element per unit of its length, f = −D Σ weight W, left-trivialized.

    At each Gauss point z = Σ φ_a p_a, p = z/‖z‖, z⁻¹z′ = λ + ½Ω. With N = ∂W/∂ε and M = ∂W/∂Ω there, a variation
    δW = N·2 Im(z⁻¹δz) + M·δΩ is that of the gradients

        γ′ = 2 z M/‖z‖²,   γ = z (−M·Ω + 2N − 2λM − Ω × M)/‖z‖²        in R⁴,

    and a node's torque is −½ Im(p̄_a Σ weight (φ_a γ + φ′_a γ′)). Sums over the nodes are of differences to the first,
    which gets minus what the others get: so forces balance to round-off.

    Args:
        density: what is evaluated.
        points: Gauss points, as many as the degree m.
        layout: rows of a node.
        nodes: values at the nodes, m + 1 of shape (layout.rows,).
        place: "inverse" 1/ds, "t", the coordinate "left" of the first node, and "at points", if given the constants
            that each point has of its own.

    Returns: forces on the nodes, m + 1 of shape (layout.dofs,).

    Source: Leok and Shingel (2012), General techniques for constructing variational integrators; the gradient is by
    hand.
    """
    along = str(density.lagrangian.interval)
    values, slopes = lagrange(lobatto(len(nodes) - 1), points.at)
    controls = {name: _controls(layout, name, nodes) for name in layout.fields}
    pulled = {name: [np.zeros(len(c[0]))] * len(nodes) for name, c in controls.items()}
    own_constants = place.get("at points", [{}] * len(points.at))
    table = zip(points.weights, points.at, values, slopes, own_constants, strict=True)
    for weight, at, phi, slope, constants in table:
        point: dict[str, Any] = {"t": place["t"], along: place["left"] + at / place["inverse"], **constants}
        turns: dict[str, _Turn] = {}
        for name, own in controls.items():
            z, dz = _polynomial(own, phi), _polynomial(own, slope * place["inverse"], derivative=True)
            if name in layout.rotations:
                turns[name] = turn = _Turn.of(z, dz)
                z, dz = _frame(layout, name, nodes, turn), 2.0 * turn.half
            point[f"frame of {name}" if name in turns else name], point[f"{name}_{along}"] = z, dz
        gradient = density.gradient("strain", point)
        for name, own in pulled.items():
            value, derivative = gradient[name], gradient[f"{name}_{along}"]
            if name in turns:
                value, derivative = turns[name].gradients(value, derivative)
            for a in range(1, len(nodes)):
                own[a] = own[a] + (weight * phi[a]) * value + (weight * slope[a] * place["inverse"]) * derivative
            own[0] = own[0] + weight * value
    forces = [zeros(layout.dofs) for _ in nodes]
    for name, own in pulled.items():
        own[0] = own[0] - sum(own[1:])
        for a, pull in enumerate(own):
            if name in layout.rotations:
                pull = quaternion.multiply(quaternion.conjugate(controls[name][a]), pull)[1:]
            forces[a][layout.dofs_of(name)] -= wrap(np.asarray(pull))
    return forces


def polynomial_points(
    density: Density, points: Points, layout: Layout, nodes: list[Expression], place: Mapping[str, Any]
) -> list[tuple[float, dict[str, Any]]]:
    """Weight and values of every slot at the Gauss points of an element; arguments as of polynomial_forces."""
    along = str(density.lagrangian.interval)
    values, slopes = lagrange(lobatto(len(nodes) - 1), points.at)
    controls = {name: _controls(layout, name, nodes) for name in layout.fields}
    found = []
    own_constants = place.get("at points", [{}] * len(points.at))
    table = zip(points.weights, points.at, values, slopes, own_constants, strict=True)
    for weight, at, phi, slope, constants in table:
        point: dict[str, Any] = {"t": place["t"], along: place["left"] + at / place["inverse"], **constants}
        for name, own in controls.items():
            z, dz = _polynomial(own, phi), _polynomial(own, slope * place["inverse"], derivative=True)
            if name in layout.rotations:
                turn = _Turn.of(z, dz)
                z, dz = _frame(layout, name, nodes, turn), 2.0 * turn.half
            point[f"frame of {name}" if name in layout.rotations else name], point[f"{name}_{along}"] = z, dz
        found.append((weight, point))
    return found


@dataclass(frozen=True, slots=True)
class _Turn:
    """A rotation at a point of an element: z, 1/‖z‖² and z⁻¹z′ = growth + half, half = ½Ω."""

    z: Any
    inverse: Any
    growth: Any
    half: Any

    @classmethod
    def of(cls, z: Any, dz: Any) -> "_Turn":
        """From z and z′, shape (4,) each."""
        inverse = 1.0 / dot(z, z)
        turned = quaternion.multiply(quaternion.conjugate(z), dz)
        return cls(z, inverse, turned[0] * inverse, turned[1:] * inverse)

    def gradients(self, turning: Any, moment: Any) -> tuple[Any, Any]:
        """½γ and ½γ′ from N and M (see polynomial_forces)."""
        m = moment * self.inverse
        value = turning * self.inverse - self.growth * m - cross(self.half, m)
        pairs = ((-dot(m, self.half), value), (0.0, m))
        return tuple(quaternion.multiply(self.z, _quaternion(*pair)) for pair in pairs)  # type: ignore[return-value]


def _polynomial(controls: list[Any], basis: Any, *, derivative: bool = False) -> Any:
    """Σ basis_a p_a, as a sum of differences to the first, which the derivative is without."""
    total = sum(f * (c - controls[0]) for f, c in zip(basis[1:], controls[1:], strict=True))
    return total if derivative else controls[0] + total


def _frame(layout: Layout, name: str, nodes: list[Expression], turn: _Turn) -> Any:
    """The frame Λ(z/‖z‖) in space."""
    frame = homogeneous(turn.z, 2.0 * turn.inverse)
    if layout.representation.rows == 4:
        return frame
    return layout.representation.matrix(nodes[0][layout.rows_of(name)]) @ frame


def _controls(layout: Layout, name: str, nodes: list[Expression]) -> list[Any]:
    """Control values of a field: quaternions, seen from the first node where rotations are stored as matrices."""
    rows = layout.rows_of(name)
    own = [node[rows] for node in nodes]
    if name not in layout.rotations or layout.representation.rows == 4:
        return own
    relative = [layout.representation.relative(own[0], other) for other in own[1:]]
    return [wrap(ONE), *(wrap(np.concatenate([np.atleast_1d(r0), v])) for r0, v in relative)]


def _quaternion(real: Any, imaginary: Any) -> Expression:
    return wrap(np.concatenate([np.atleast_1d(np.asarray(real, dtype=object)), np.asarray(imaginary, dtype=object)]))
