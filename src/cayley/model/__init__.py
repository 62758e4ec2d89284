"""What a structure is made of: materials, sections, rods, bodies, what connects and moves them (NumPy, SI units)."""

from cayley.model import damping, joints, loads, springs, supports
from cayley.model.body import Body, PointMass
from cayley.model.lagrangian_part import LagrangianPart
from cayley.model.material import Material
from cayley.model.model import Model
from cayley.model.part import Part
from cayley.model.port import Port, ground
from cayley.model.rod import Rod
from cayley.model.section import Section

__all__ = [
    "Body",
    "LagrangianPart",
    "Material",
    "Model",
    "Part",
    "PointMass",
    "Port",
    "Rod",
    "Section",
    "damping",
    "ground",
    "joints",
    "loads",
    "springs",
    "supports",
]
