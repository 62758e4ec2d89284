"""How to cite the library, the paper behind it, and the methods that a run used."""

from __future__ import annotations

import re
from importlib import resources
from typing import Any

import cayley
from cayley.model import rod_loads

_SOFTWARE = (
    "cayley developers, cayley: variational Lie-group integrators from a Lagrangian, version {version}, MIT license."
)
_PAPER = (
    "T. Leitz, S. Ober-Blöbaum, S. Leyendecker, Variational integrators for dynamical systems with rotational degrees "
    "of freedom, 11th World Congress on Computational Mechanics (WCCM XI), 2014."
)
_SOFTWARE_ENTRY = """@software{{cayley,
  author  = {{{{cayley developers}}}},
  title   = {{cayley: variational {{Lie}}-group integrators from a {{Lagrangian}}}},
  version = {{{version}}},
  license = {{MIT}}
}}"""


def citation() -> tuple[str, str]:
    """The reference of this software, and that of the paper whose integrator is the rule `nodal`."""
    return _SOFTWARE.format(version=cayley.__version__), _PAPER


def cite(run: Any = None) -> str:
    """BibTeX of the software and of the methods that a run, or an equilibrium, really used.

    Args:
        run: a Trajectory or an Equilibrium; without one, software and paper alone.
    """
    entries = references()
    chosen = [entries[key] for key in (used(run) if run is not None else ["leitz2014"])]
    return "\n\n".join([_SOFTWARE_ENTRY.format(version=cayley.__version__), *chosen])


def references() -> dict[str, str]:
    """BibTeX entries of all methods, by their keys."""
    text = resources.files("cayley.report").joinpath("references.bib").read_text(encoding="utf-8")
    return {re.match(r"@\w+{(\w+)", entry)[1]: entry for entry in text.strip().split("\n\n")}  # type: ignore[index]


def used(run: Any) -> list[str]:
    """Keys of the methods of a run or an equilibrium."""
    still = hasattr(run, "still")
    rule = str(run.system.equations.rule) if still else run.rule
    model = run.model
    rods = [] if model is None else model.rods
    found = ["leitz2014", "simo1986" if still else "marsden2001"]
    found += ["simo1985"] if rods else []
    found += ["leok2012"] if rule.startswith(("galerkin", "spectral")) else []
    found += ["patera1984"] if rule.startswith("spectral") else []
    found += ["hante2022"] if rule.startswith("screw") else []
    if model is not None:
        constrained = bool(model.connections) or any(rod.kinematics != "shearable" for rod in rods)
        found += ["leyendecker2008"] if constrained else []
        found += ["rucker2011"] if any(isinstance(load, rod_loads.Tendon) for load in model.loads) else []
    return found
