"""A part with a Lagrangian of its own as the arrays of a chain, and that Lagrangian for nodes with a pose."""

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from cayley.density import trace
from cayley.density.expression import dot, to_sx
from cayley.density.fields import Field, Rotation, Vector
from cayley.density.lagrangian import Lagrangian
from cayley.discrete.layout import Layout
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import Rule
from cayley.model import LagrangianPart
from cayley.system.compile import chain_arrays, chain_nodes, check_inertia, straight
from cayley.system.rod_arrays import PartArrays

ROUND_OFF = 1e-12
"""Changes of a mass matrix below this, relative to it, are rounding."""
_POSE: dict[str, Field] = {"p": Rotation(), "x": Vector(3)}


def posed(lagrangian: Lagrangian) -> Lagrangian:
    """The same Lagrangian on nodes with rotation and position, and on an interval.

    L + ½ v·v,   v the velocity of the field it does not have, if any, which is held

    One without an interval becomes a density: its part is one node of weight 1, where no element begins.
    """
    missing = [name for name in _POSE if name not in lagrangian.fields]

    def function(q: Any, c: Any) -> Any:
        rates = [getattr(q, f"{name}_t") for name in missing]
        return sum((0.5 * dot(v, v) for v in rates), start=lagrangian.function(q, c))

    along = lagrangian.interval or "s"
    return replace(lagrangian, function=function, fields=_POSE, interval=along, pose=("p", "x"))


def own_arrays(part: LagrangianPart, rule: Rule) -> PartArrays:
    """The arrays of a part with a Lagrangian of its own.

    Raises:
        ValueError: the Lagrangian does not work with its constants, or some velocity has no inertia.
    """
    _check(part)
    if part.domain is None:
        coordinates, inverse = np.zeros(1), 1.0
        named = {"weight": np.ones(1), "1/weight": np.ones(1), "length": np.zeros(1), "here": np.zeros(1)}
    else:
        coordinates = chain_nodes(part.nodes, rule.degree)
        inverse = part.domain.elements / (part.domain.stop - part.domain.start)
        named = chain_arrays(coordinates, rule.degree)
    count = len(coordinates)
    constants = {name: np.asarray(value, dtype=float) for name, value in _constants(part).items()}
    places = [part.place_at(float(s)) for s in coordinates]
    return PartArrays(
        named=named | {"inverse": np.full(count, inverse)},
        constants={name: np.broadcast_to(value, (count, *value.shape)).copy() for name, value in constants.items()},
        position=np.array([position for position, _ in places]),
        rotation=np.array([rotation for _, rotation in places]),
    )


def _constants(part: LagrangianPart) -> dict[str, Any]:
    return {**part.lagrangian.defaults, **part.constants}


def _check(part: LagrangianPart) -> None:
    """Trace the Lagrangian as it was written, so that what it gets wrong is told of in its own words.

    Raises:
        ValueError: it does not work with its constants, some velocity has no inertia, or momenta are not linear in
            velocities, which joints and springs of explicit rules and projections of momenta take them to be.
    """
    density = trace(part.lagrangian, part.constants)
    layout = Layout(density.lagrangian.fields, REPRESENTATIONS["quaternion"])
    check_inertia(density, layout, straight(layout, np.zeros(1))[0], part.label)
    rates = {name: density.slots[name] for name in density.velocities}
    gradient = density.gradient("inertia", rates)
    momenta, velocities = (ca.vertcat(*[to_sx(own[name]) for name in rates]) for own in (gradient, rates))
    mass = ca.Function("mass", [velocities, density.parameters], [ca.jacobian(momenta, velocities)])
    still, moving = (np.asarray(mass(v, density.values)) for v in (np.zeros(layout.dofs), 1.0 + np.arange(layout.dofs)))
    if np.abs(moving - still).max() > ROUND_OFF * np.abs(still).max():
        raise ValueError(
            f"{part.label}: {part.lagrangian.name} has terms of higher than second order in velocities, which parts of "
            "a model may not have; use cy.compile for it alone"
        )


__all__ = ["own_arrays", "posed"]
