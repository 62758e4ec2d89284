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
    "rate": "density.force",
    "E1": "density.library",
    "E2": "density.library",
    "E3": "density.library",
    "Material": "model",
    "Section": "model",
    "Rod": "model",
    "Body": "model",
    "PointMass": "model",
    "LagrangianPart": "model",
    "Plane": "model",
    "Sphere": "model",
    "Capsule": "model",
    "Cylinder": "model",
    "Box": "model",
    "Mesh": "model",
    "Contact": "model",
    "ground": "model.port",
    "Model": "model",
    "simulate": "simulation",
    "integrate": "simulation",
    "resume": "simulation",
    "SimulationError": "simulation",
    "Interrupted": "simulation",
    "WriteError": "simulation",
    "DamageWarning": "results.known",
    "ContactDepthWarning": "results.contact",
    "export": "results.export",
    "cite": "report.cite",
    "settle": "simulation",
    "Settled": "simulation",
    "SettleError": "simulation",
    "equilibrium": "statics",
    "Equilibrium": "statics",
    "EquilibriumError": "statics",
    "modes": "vibration",
    "Modes": "vibration",
    "matrices": "vibration",
    "frequency_response": "vibration",
    "campbell": "vibration",
    "trace": "continuation",
    "Path": "continuation",
    "buckling": "continuation",
    "Trajectory": "results.trajectory",
}
_RENAMED = {"compile": ("system.compile", "compile_lagrangian")}
_MODULES = {
    "rules": "discrete.rules",
    "damping": "model.damping",
    "loads": "model.loads",
    "supports": "model.supports",
    "joints": "model.joints",
    "springs": "model.springs",
    "densities": "density.library",
}
_EXTENSIONS = {"plot": ("report.plots", "Plots"), "animate": ("report.film", "film")}

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


def extension(name: str) -> Any:
    """What a layer above the results adds to a Trajectory, loaded when first used: results know no reports."""
    module, own = _EXTENSIONS[name]
    return getattr(importlib.import_module(f"cayley.{module}"), own)


def __dir__() -> list[str]:
    """Public names."""
    return sorted(__all__)


if TYPE_CHECKING:
    from cayley.continuation import Path as Path
    from cayley.continuation import buckling as buckling
    from cayley.continuation import trace as trace
    from cayley.density.expression import cross as cross
    from cayley.density.expression import dot as dot
    from cayley.density.expression import norm as norm
    from cayley.density.expression import where as where
    from cayley.density.fields import Interval as Interval
    from cayley.density.fields import Rotation as Rotation
    from cayley.density.fields import Vector as Vector
    from cayley.density.force import rate as rate
    from cayley.density.lagrangian import Lagrangian as Lagrangian
    from cayley.density.lagrangian import lagrangian as lagrangian
    from cayley.density.library import E1 as E1
    from cayley.density.library import E2 as E2
    from cayley.density.library import E3 as E3
    from cayley.discrete import rules as rules
    from cayley.model import Body as Body
    from cayley.model import Box as Box
    from cayley.model import Capsule as Capsule
    from cayley.model import Contact as Contact
    from cayley.model import Cylinder as Cylinder
    from cayley.model import LagrangianPart as LagrangianPart
    from cayley.model import Material as Material
    from cayley.model import Mesh as Mesh
    from cayley.model import Model as Model
    from cayley.model import Plane as Plane
    from cayley.model import PointMass as PointMass
    from cayley.model import Rod as Rod
    from cayley.model import Section as Section
    from cayley.model import Sphere as Sphere
    from cayley.model import damping as damping
    from cayley.model import ground as ground
    from cayley.model import joints as joints
    from cayley.model import loads as loads
    from cayley.model import springs as springs
    from cayley.model import supports as supports
    from cayley.report.cite import cite as cite
    from cayley.results.contact import ContactDepthWarning as ContactDepthWarning
    from cayley.results.export import export as export
    from cayley.results.known import DamageWarning as DamageWarning
    from cayley.results.trajectory import Trajectory as Trajectory
    from cayley.simulation import Interrupted as Interrupted
    from cayley.simulation import Settled as Settled
    from cayley.simulation import SettleError as SettleError
    from cayley.simulation import SimulationError as SimulationError
    from cayley.simulation import WriteError as WriteError
    from cayley.simulation import integrate as integrate
    from cayley.simulation import resume as resume
    from cayley.simulation import settle as settle
    from cayley.simulation import simulate as simulate
    from cayley.statics import Equilibrium as Equilibrium
    from cayley.statics import EquilibriumError as EquilibriumError
    from cayley.statics import equilibrium as equilibrium
    from cayley.system.compile import compile_lagrangian
    from cayley.vibration import Modes as Modes
    from cayley.vibration import campbell as campbell
    from cayley.vibration import frequency_response as frequency_response
    from cayley.vibration import matrices as matrices
    from cayley.vibration import modes as modes

    compile = compile_lagrangian
