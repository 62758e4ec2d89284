"""From a scenario of the suite to a model."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cosseratbench.scenario as suite
import numpy as np
from cosseratbench.scenario import End, EndCondition

import cayley as cy
from cayley.lie import quaternion
from cayley_cosseratbench.start import node_frames

PENETRATION = 0.001
"""Depth of contacts that is wanted, in radii: rods overlap less than those of the peers."""
IMPACT = 1.0
"""Depth of impacts, in radii, that is good enough: twist goes on when the rod has snapped, all that it asks."""
MEETS = 1e-9
"""Distance and angle up to which the straight rod stands where the scenario has a driven end [m, rad]."""


@dataclass(frozen=True, slots=True)
class Translation:
    """A scenario as a model.

    Args:
        model: rods without stress where the suite has a straight one, and what holds and loads them.
        rods: in the order of the scenario.
        initial: where rods begin, as cy.simulate takes it.
    """

    model: cy.Model
    rods: tuple[cy.Rod, ...]
    initial: Mapping[cy.Rod, Mapping[str, Any]]


def translate(scenario: suite.Scenario, elements: int, degree: int) -> Translation:
    """Make a model of a scenario.

    Args:
        scenario: the scenario.
        elements: of every rod.
        degree: of the elements.

    Raises:
        NotImplementedError: what the scenario asks for is not there.
    """
    rods, held, loads, initial = [], [], [], {}
    for k, spec in enumerate(scenario.rods):
        positions, rotations = node_frames(spec, elements, degree)
        rod = _rod(spec, f"rod{k}", elements, positions, rotations)
        rods.append(rod)
        held += _supports(spec, rod, positions, rotations)
        loads += _loads(spec, rod)
        initial[rod] = {"position": positions, "rotation": rotations}
    if any(scenario.gravity):
        loads.append(cy.loads.gravity(scenario.gravity))
    touching: dict[str, Any] = {"contact": _contact(scenario), "obstacles": [_obstacle(o) for o in scenario.obstacles]}
    if touching["contact"] is None:
        touching = {}
    model = cy.Model(*rods, supports=held, loads=loads, **touching)
    return Translation(model, tuple(rods), initial)


def touches(scenario: suite.Scenario) -> bool:
    """Whether anything can touch anything."""
    return bool(scenario.obstacles) or len(scenario.rods) > 1 or scenario.self_contact


def driven(scenario: suite.Scenario) -> bool:
    """Whether any end is moved."""
    return any(rod.start_motion or rod.end_motion for rod in scenario.rods)


def _rod(spec: suite.Rod, name: str, elements: int, positions: np.ndarray, rotations: np.ndarray) -> cy.Rod:
    """The rod without stress, straight, laid where a driven end is at the start, else at its first node."""
    given = spec.material
    try:
        material = cy.Material(
            density=given.density, youngs_modulus=given.youngs_modulus, shear_modulus=given.shear_modulus
        )
    except ValueError as error:
        raise NotImplementedError(f"a material that is not isotropic: {error}") from None
    at = 0 if spec.end_motion is None or spec.start_motion is not None else -1
    d1, _, d3 = np.asarray(quaternion.to_matrix(rotations[at]), dtype=float).T
    return cy.Rod(
        cy.Section.circle(spec.radius, material),
        length=spec.length,
        elements=elements,
        origin=tuple(positions[at] - (0.0 if at == 0 else spec.length) * d3),
        direction=tuple(d3),
        normal=tuple(d1),
        name=name,
    )


def _supports(spec: suite.Rod, rod: cy.Rod, positions: np.ndarray, rotations: np.ndarray) -> list[Any]:
    found: list[Any] = []
    for end, port, at in ((End.START, rod.start, 0), (End.END, rod.end, -1)):
        motion, condition = spec.motion(end), spec.condition(end)
        if motion is not None:
            _check_driven(rod, end, at, positions[at], rotations[at], motion)
            found.append(_driven(port, motion))
        elif condition is EndCondition.CLAMPED:
            found.append(cy.supports.clamp(port))
        elif condition is EndCondition.PINNED:
            found.append(cy.supports.pin(port))
    return found


def _driven(port: Any, motion: suite.Motion) -> Any:
    """A clamp that moves: piecewise linear displacements and rotation vectors, as the suite has them."""
    table = {
        name: cy.joints.Table(motion.times, np.asarray(values, dtype=float), "linear")
        for name, values in (("position", motion.displacement), ("rotation", motion.rotation))
    }
    return cy.supports.drive(port, **table, along=motion.slides_along)


def _check_driven(
    rod: cy.Rod, end: End, at: int, position: np.ndarray, rotation: np.ndarray, motion: suite.Motion
) -> None:
    """Refuse a driven end that the straight rod does not meet: drives count from where the model stands."""
    miss = np.asarray(position - rod.positions[at], dtype=float)
    if motion.slides_along is not None:
        miss = miss - (miss @ motion.axis) * motion.axis
    turn = 2.0 * np.linalg.norm(quaternion.relative(rod.rotations[at], rotation)[1:])
    if np.linalg.norm(miss) > MEETS or turn > MEETS:
        raise NotImplementedError(f"a driven {end.value} of a rod that starts bent, its other end driven as well")


def _loads(spec: suite.Rod, rod: cy.Rod) -> list[Any]:
    """Forces on ends that are not held for good; on others they change nothing."""
    ports = {End.START: rod.start, End.END: rod.end}
    return [
        cy.loads.force(ports[load.at], load.force)
        for load in spec.loads
        if spec.condition(load.at) is EndCondition.FREE or spec.motion(load.at) is not None
    ]


def _contact(scenario: suite.Scenario) -> Any:
    """Contact of all that can touch, with the friction of the rods; None where nothing can."""
    if not touches(scenario):
        return None
    frictions = {rod.friction for rod in scenario.rods}
    if len(frictions) > 1:
        raise NotImplementedError("rods of different friction")
    depths = {"penetration": PENETRATION, "impact_depth": IMPACT}
    return cy.Contact(friction=frictions.pop(), self_contact=scenario.self_contact, **depths)


def _obstacle(given: suite.Obstacle) -> Any:
    if isinstance(given, suite.Plane):
        return cy.Plane(point=given.point, normal=given.normal, friction=given.friction)
    return cy.Cylinder(given.radius, given.length, center=given.center, axis=given.axis, friction=given.friction)
