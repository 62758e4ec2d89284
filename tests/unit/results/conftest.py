"""Runs that several tests look at: a moving rod in space under each rule and in each rotation form."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import cayley as cy
from cayley.results.trajectory import Trajectory

FORMS = [("nodal", "quaternion"), ("verlet", "quaternion"), ("nodal", "matrix"), ("verlet", "matrix")]
GRAVITY = np.array([0.3, -0.2, -9.81])


@dataclass(frozen=True)
class Case:
    run: Trajectory
    rod: Any
    rule: str
    rotation: str


def section() -> Any:
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
    return cy.Section.rectangle(0.02, 0.03, rubber)


def throw(s: float) -> tuple[float, float, float]:
    return (np.sin(3 * s), 0.5 + s, -0.3 * s**2)


def tumble(s: float) -> tuple[float, float, float]:
    return (2.0 - s, 1.0 + np.cos(2 * s), 3.0 * s)


@pytest.fixture(scope="session", params=FORMS, ids="-".join)
def thrown(request: pytest.FixtureRequest) -> Case:
    """An oblique rod, thrown and spinning, not held; every step saved."""
    rule, rotation = request.param
    rod = cy.Rod(section(), length=0.8, elements=10, origin=(0.1, 0.2, 0.3), direction=(1, 2, 2), normal=(0, 0, 1))
    model = cy.Model(rod, loads=[cy.loads.gravity(GRAVITY)])
    run = cy.simulate(
        model,
        t_end=0.02,
        dt=1e-4,
        rule=getattr(cy.rules, rule),
        rotation=rotation,
        save_every=1e-4,
        initial={rod: {"velocity": throw, "angular_velocity": tumble}},
    )
    return Case(run, rod, rule, rotation)


@pytest.fixture
def hanging() -> Callable[..., tuple[Any, Any, dict[str, np.ndarray]]]:
    """A rod that hangs in equilibrium, every element stretched by the weight below its middle."""

    def make(load: float = 0.0, elements: int = 8) -> tuple[Any, Any, dict[str, np.ndarray]]:
        rod = cy.Rod(section(), length=2.0, elements=elements, direction=(0, 0, -1))
        middle = 0.5 * (rod.nodes[1:] + rod.nodes[:-1])
        below = rod.section.mass_per_length * 9.81 * (rod.length - middle) + load
        stretch = 1.0 + below / rod.section.stiffness[2, 2]
        depth = np.append(0.0, np.cumsum(stretch * rod.element_length))
        return rod, below, {"position": np.outer(depth, (0.0, 0.0, -1.0))}

    return make
