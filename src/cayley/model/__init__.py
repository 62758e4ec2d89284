"""What a structure is made of: materials, sections, rods, bodies, what connects and moves them (NumPy, SI units)."""

from cayley.model import damping, joints, loads, springs, supports
from cayley.model.body import Body, PointMass
from cayley.model.contact import Contact, contact_radius
from cayley.model.lagrangian_part import LagrangianPart
from cayley.model.material import Material
from cayley.model.model import Model
from cayley.model.part import Part
from cayley.model.port import Port, ground
from cayley.model.rod import Rod
from cayley.model.section import Section
from cayley.model.shapes import Box, Capsule, Cylinder, Mesh, Obstacle, Plane, Sphere

__all__ = [
    "Body",
    "Box",
    "Capsule",
    "Contact",
    "Cylinder",
    "LagrangianPart",
    "Material",
    "Mesh",
    "Model",
    "Obstacle",
    "Part",
    "Plane",
    "PointMass",
    "Port",
    "Rod",
    "Section",
    "Sphere",
    "contact_radius",
    "damping",
    "ground",
    "joints",
    "loads",
    "springs",
    "supports",
]
