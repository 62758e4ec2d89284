"""What a structure is made of: materials, sections, rods, supports and loads (NumPy only, SI units throughout)."""

from cayley.model import loads, supports
from cayley.model.material import Material
from cayley.model.model import Model
from cayley.model.rod import Port, Rod
from cayley.model.section import Section

__all__ = ["Material", "Model", "Port", "Rod", "Section", "loads", "supports"]
