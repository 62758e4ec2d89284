"""cayley: from a Lagrangian with rotations to a compiled, structure-preserving integrator; and a simulator of rods.

Everything public is an attribute of this package; the heavy parts load when first used.
"""

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOMES = {
    "lagrangian": "density.lagrangian",
    "Lagrangian": "density.lagrangian",
    "Rotation": "density.fields",
    "Vector": "density.fields",
    "Interval": "density.fields",
    "dot": "density.expression",
    "cross": "density.expression",
    "norm": "density.expression",
    "where": "density.expression",
    "E1": "density.library",
    "E2": "density.library",
    "E3": "density.library",
    "Material": "model",
    "Section": "model",
    "Rod": "model",
    "Model": "model",
    "simulate": "simulation",
    "integrate": "simulation",
    "SimulationError": "simulation",
    "Trajectory": "results.trajectory",
}
_RENAMED = {"compile": ("system.compile", "compile_lagrangian")}
_MODULES = {
    "rules": "discrete.rules",
    "loads": "model.loads",
    "supports": "model.supports",
    "densities": "density.library",
}

__all__ = ["__version__", *_HOMES, *_RENAMED, *_MODULES]


def __getattr__(name: str) -> Any:
    """Import what is asked for."""
    if name in _MODULES:
        value: Any = importlib.import_module(f"cayley.{_MODULES[name]}")
    elif name in _HOMES:
        value = getattr(importlib.import_module(f"cayley.{_HOMES[name]}"), name)
    elif name in _RENAMED:
        module, own = _RENAMED[name]
        value = getattr(importlib.import_module(f"cayley.{module}"), own)
    else:
        raise AttributeError(f"module 'cayley' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Public names."""
    return sorted(__all__)


if TYPE_CHECKING:
    from cayley.density.expression import cross, dot, norm, where
    from cayley.density.fields import Interval, Rotation, Vector
    from cayley.density.lagrangian import Lagrangian, lagrangian
    from cayley.density.library import E1, E2, E3
    from cayley.discrete import rules
    from cayley.model import Material, Model, Rod, Section, loads, supports
    from cayley.results.trajectory import Trajectory
    from cayley.simulation import SimulationError, integrate, simulate
    from cayley.system.compile import compile_lagrangian as compile
