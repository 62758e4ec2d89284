"""How to cite the library and the paper behind it."""

from __future__ import annotations

import cayley

_SOFTWARE = (
    "cayley developers, cayley: variational Lie-group integrators from a Lagrangian, version {version}, MIT license."
)
_PAPER = (
    "T. Leitz, S. Ober-Blöbaum, S. Leyendecker, Variational integrators for dynamical systems with rotational degrees "
    "of freedom, 11th World Congress on Computational Mechanics (WCCM XI), 2014."
)


def citation() -> tuple[str, str]:
    """The reference of this software, and that of the paper whose integrator is the rule `nodal`."""
    return _SOFTWARE.format(version=cayley.__version__), _PAPER
