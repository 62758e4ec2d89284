"""Clamped rods under loads: what the published static problems have in common."""

import numpy as np

import cayley as cy

SCREW, MIDPOINT = cy.rules.screw, cy.rules.midpoint
CUBIC, SEXTIC = cy.rules.galerkin(time=1, space=3), cy.rules.galerkin(time=1, space=6)


def given(stiffness):
    """A section of given stiffness, six numbers of the diagonal or a matrix; its inertia plays no part."""
    matrix = np.diag(stiffness) if np.ndim(stiffness) == 1 else stiffness
    return cy.Section.given(stiffness=matrix, mass_per_length=1.0, inertia=np.eye(3))


def published(stiffness):
    """A section from a matrix or diagonal in the usual order: axial, shear 2 and 3, torsion, bending 2 and 3."""
    matrix = np.diag(stiffness) if np.ndim(stiffness) == 1 else np.asarray(stiffness)
    ours = [1, 2, 0, 4, 5, 3]
    return given(matrix[np.ix_(ours, ours)])


def straight(section, length, elements, **options):
    """A rod along x whose section's axes are y and z."""
    return cy.Rod(section, length=length, elements=elements, direction=(1, 0, 0), normal=(0, 1, 0), **options)


def rest(rod, *loads, rule=SCREW, **options):
    """The equilibrium of a rod that is clamped at its start."""
    model = cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=list(loads))
    return cy.equilibrium(model, rule=rule, **options)


def places(rod, *loads, **options):
    """Positions of the nodes at rest, shape (nodes, 3)."""
    return rest(rod, *loads, **options)[rod].position.values


def tip(rod, *loads, **options):
    """Position of the last node at rest."""
    return places(rod, *loads, **options)[-1]


def richardson(tip_of, elements):
    """The limit of tips of 1, 2 and 4 times so many elements whose errors are of orders 2 and 4."""
    coarse, middle, fine = (tip_of(n * elements) for n in (1, 2, 4))
    return (64.0 * fine - 20.0 * middle + coarse) / 45.0
