"""Rods and models for tests: small, soft, of several sections and lengths."""

import itertools

import numpy as np

import cayley as cy
from cayley import loads, supports


def rubber(modulus: float = 5e6) -> cy.Material:
    return cy.Material(density=1100.0, youngs_modulus=modulus, poisson_ratio=0.4)


def round_rod(elements: int = 8, *, length: float = 1.0, radius: float = 0.01, modulus: float = 5e6, **place) -> cy.Rod:
    place = {"direction": (1, 0, 0), "normal": (0, 1, 0)} | place
    return cy.Rod(cy.Section.circle(radius, rubber(modulus)), length=length, elements=elements, **place)


def pendulum(elements: int = 8, **options) -> cy.Model:
    """A rod pinned at its start, horizontal, under its weight."""
    rod = round_rod(elements, **options)
    return cy.Model(rod, supports=[supports.pin(rod.start)], loads=[loads.gravity((0, 0, -9.81))])


def three_rods() -> tuple[cy.Model, list[cy.Model]]:
    """Three rods of different sections, materials, lengths and supports in one model, and each in one of its own."""
    a = round_rod(10, name="a")
    flat = cy.Section.rectangle(0.02, 0.01, rubber(8e6))
    b = cy.Rod(flat, length=0.7, elements=5, direction=(0, 1, 0), origin=(0, 0, 1), name="b")
    tube = cy.Section.tube(outer_radius=0.02, thickness=0.003, material=rubber(3e6))
    c = cy.Rod(tube, length=1.3, elements=17, direction=(0, 1, 1), origin=(1, 0, 0), name="c")
    held = [[supports.clamp(a.start)], [supports.pin(b.end), supports.hold(b.start, position="y")], []]
    acting = [
        [loads.force(a.end, (0.0, 1.0, 0.0), until=0.02)],
        [loads.line_force(b, (0.1, 0.0, 0.2), frame="body")],
        [loads.moment(c.node(3), lambda t: np.array([0.0, 0.1 * np.sin(30 * t), 0.05]))],
    ]
    weight = loads.gravity((0, 0, -9.81))
    together = cy.Model(a, b, c, supports=[*itertools.chain(*held)], loads=[weight, *itertools.chain(*acting)])
    alone = [
        cy.Model(r, supports=s, loads=[weight, *extra]) for r, s, extra in zip((a, b, c), held, acting, strict=True)
    ]
    return together, alone
