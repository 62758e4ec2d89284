"""The continuous Euler-Lagrange equations of a Lagrangian: their residual for fields that are smooth functions."""

from collections.abc import Callable, Mapping
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import Lagrangian, trace
from cayley.density.expression import Expression, cross, from_sx, symbols, to_sx, wrap
from cayley.density.fields import Rotation
from cayley.density.trace import PARTS, Density
from cayley.lie import quaternion

SIGNS = {"inertia": 1.0, "strain": -1.0, "load": -1.0}
"""L = T − W − U."""


def euler_lagrange_residual(
    lagrangian: Lagrangian,
    constants: Mapping[str, Any],
    fields: Mapping[str, Callable[..., Any]],
    s: Any,
    t: Any,
) -> dict[str, np.ndarray]:
    """Residual of the continuous Euler-Lagrange equations for given smooth fields: the load that would cause them.

    vectors:    d/dt ∂L/∂ẋ + d/ds ∂L/∂x′ − ∂L/∂x                                  (space frame)
    rotations:  d/dt ∂L/∂ω + ω × ∂L/∂ω + d/ds ∂L/∂Ω + Ω × ∂L/∂Ω − ½ Im(p̄ ∂L/∂p)    (body frame)

    A motion is a solution where this vanishes; elsewhere it is the force and torque per length (without an interval:
    the force and torque) that has to act from outside. The paper's eq. 1 is the negative of it. In the copy we read
    the dots and bars of eq. 1 are lost in extraction, its signs are not: they follow from δω = η̇ + ω × η and
    δΩ = η′ + Ω × η. The rod's form in section 6.1 is another matter: inserting eq. 10 into eq. 1 gives

        ρẍ − ρg − Λ (Ω × C1 Γ) − Λ C1 (Λ′ᵀx′ + Λᵀx″) = 0,

    where the copy prints both terms with a plus and the last without Λᵀ.

    Args:
        lagrangian: made with ``@cy.lagrangian``.
        constants: its constants by name.
        fields: field -> function of (s, t) written with NumPy, or of t alone for a Lagrangian without an interval,
            that returns a vector, or for a rotation a quaternion (w, x, y, z), made unit here. Derivatives are taken
            by automatic differentiation.
        s: places [m], any shape; None without an interval.
        t: times [s], of a shape that broadcasts with s.

    Returns: field -> residual at every point, shape (..., size of the field), rotations in the body frame.

    Raises:
        ValueError: if a field is missing, unknown or of the wrong shape, or s is given without an interval.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 1 and section 6.1.
    """
    density = trace(lagrangian, constants)
    where = f"euler_lagrange_residual of {lagrangian.name}"
    if (s is None) != (lagrangian.interval is None):
        raise ValueError(f"{where}: give s just for a density on an interval, s=None without one")
    places, times = np.broadcast_arrays(
        np.zeros(()) if s is None else np.asarray(s, dtype=float), np.asarray(t, dtype=float)
    )
    at = symbols("s"), symbols("t")
    residual = _residual(density, _point(density, fields, at, where), at)
    function = ca.Function(
        "euler_lagrange",
        [ca.vertcat(*[to_sx(v) for v in at]), density.parameters],
        [to_sx(r) for r in residual.values()],
    )
    columns = np.stack([places.ravel(), times.ravel()])
    found = function.call([columns, np.repeat(density.values[:, None], columns.shape[1], axis=1)])
    return {name: np.array(r).T.reshape(*places.shape, -1) for name, r in zip(residual, found, strict=True)}


def _point(
    density: Density, fields: Mapping[str, Callable[..., Any]], at: tuple[Expression, Expression], where: str
) -> dict[str, Any]:
    """Values of every slot of the density as expressions in s and t."""
    lagrangian = density.lagrangian
    if set(fields) != set(lagrangian.fields):
        raise ValueError(f"{where}: fields are {', '.join(fields)}; give {', '.join(lagrangian.fields)}")
    point: dict[str, Any] = {"t": at[1], str(lagrangian.interval): at[0]}
    along = {"t": at[1]} if lagrangian.interval is None else {"t": at[1], lagrangian.interval: at[0]}
    for name, kind in lagrangian.fields.items():
        turns = isinstance(kind, Rotation)
        value = wrap(np.asarray(fields[name](*(at if lagrangian.interval is not None else at[1:])), dtype=object))
        size = 4 if turns else kind.size
        if value.shape != (size,):
            raise ValueError(f"{where}: the function of {name} returns shape {value.shape}; give ({size},)")
        value = wrap(quaternion.normalize(value)) if turns else value
        for suffix, coordinate in along.items():
            rate = _derivative(value, coordinate)
            point[f"{name}_{suffix}"] = wrap(quaternion.body_rate(value, rate)) if turns else rate
        if turns:
            point[f"frame of {name}"] = wrap(quaternion.to_matrix(value))
        else:
            point[name] = value
    return point


def _residual(density: Density, point: Mapping[str, Any], at: tuple[Expression, Expression]) -> dict[str, Expression]:
    """Insert the slots into the equations."""
    lagrangian = density.lagrangian
    gradients = {part: density.gradient(part, point) for part in PARTS}
    slope = {n: wrap(sum(SIGNS[part] * gradients[part][n] for part in PARTS)) for n in density.slots}
    along = {"t": at[1]} if lagrangian.interval is None else {"t": at[1], lagrangian.interval: at[0]}
    residual = {}
    for name, kind in lagrangian.fields.items():
        total = -slope[name]
        for suffix, coordinate in along.items():
            momentum = slope[f"{name}_{suffix}"]
            total = total + _derivative(momentum, coordinate)
            if isinstance(kind, Rotation):
                total = total + cross(point[f"{name}_{suffix}"], momentum)
        residual[name] = wrap(total)
    return residual


def _derivative(value: Expression, coordinate: Expression) -> Expression:
    """Derivative of every entry with respect to s or t."""
    return wrap(np.atleast_1d(from_sx(ca.densify(ca.jacobian(to_sx(value), to_sx(coordinate))))))


__all__ = ["euler_lagrange_residual"]
