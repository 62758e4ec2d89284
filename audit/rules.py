"""The rules that are audited, in the order of the page: a new one gets in by one line here."""

from cayley.discrete.rules import (
    galerkin,
    midpoint,
    nodal,
    nodal_midpoint,
    screw,
    screw_midpoint,
    spectral,
    verlet,
)

EVERYWHERE = (nodal, verlet, midpoint, nodal_midpoint, *(galerkin(time=r) for r in (1, 2, 3, 4)))
"""For every problem."""
ON_INTERVALS = (
    screw,
    screw_midpoint,
    spectral(space=2),
    spectral(space=3),
    galerkin(time=1, space=2),
    galerkin(time=2, space=2),
    galerkin(time=3, space=3),
)
"""Beside them for problems on an interval."""
STIFF = (midpoint, *(galerkin(time=r) for r in (2, 3, 4)))
"""For steps that leave fast modes unresolved."""
