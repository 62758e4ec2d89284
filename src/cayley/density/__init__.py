"""Lagrangians and Lagrangian densities: fields, symbols, the decorator and a library of densities."""

from cayley.density.expression import cross, dot, norm, where
from cayley.density.fields import Interval, Rotation, Vector
from cayley.density.force import rate
from cayley.density.lagrangian import Lagrangian, lagrangian
from cayley.density.trace import Density, trace

__all__ = [
    "Density",
    "Interval",
    "Lagrangian",
    "Rotation",
    "Vector",
    "cross",
    "dot",
    "lagrangian",
    "norm",
    "rate",
    "trace",
    "where",
]
