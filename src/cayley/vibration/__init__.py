"""Vibration about equilibria: modes, their matrices, frequency responses and Campbell diagrams."""

from typing import Any

from cayley.model import Model
from cayley.vibration.diagram import Campbell, campbell
from cayley.vibration.eigen import eigenpairs
from cayley.vibration.linear import Linear, find_equilibrium
from cayley.vibration.response import frequency_response
from cayley.vibration.result import Modes


def modes(model: Model, *, about: Any = None, count: int = 10, spin: Any = None) -> Modes:
    """Find the lowest modes of small motions about an equilibrium.

    (s² M + s (C + G) + K) φ + Aᵀ λ = 0,   A φ = 0

    All matrices are derivatives of the action at the equilibrium, so prestress, loads, damping and rotation count.
    Motions that nothing resists have 0 Hz. Without damping and spin a count by inertia tells whether one is missing.

    Args:
        model: rods, bodies, joints, supports and loads.
        about: an Equilibrium; or a Trajectory, State or Equilibrium of a similar model, from which one is searched;
            None: searched from the reference. Its rule says how strain is measured along an element.
        count: how many, by rising |s|; a pair of complex conjugates is one.
        spin: angular velocity about the origin of a frame in which the model rests [rad/s], as of cy.equilibrium, where
            about is no Equilibrium.

    Returns: the Modes; fewer than count where there are fewer motions.

    Raises:
        ValueError: if an argument does not fit.
        EquilibriumError: if no equilibrium is found.
    """
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise ValueError(f"modes: count is {count!r}; give a whole number, at least 1")
    linear = Linear.of(find_equilibrium(model, about, spin))
    return Modes(linear, eigenpairs(linear, count))


def matrices(model: Model, *, about: Any = None, spin: Any = None) -> Linear:
    """The matrices of small motions about an equilibrium, M v̈ + (C + G) v̇ + K v + Aᵀ λ = f, A v = 0.

    Args:
        model: the model.
        about: the equilibrium, as for cy.modes.
        spin: as for cy.modes.

    Returns: mass, damping, gyroscopic, stiffness and constraint as scipy.sparse arrays, and table(): part, node and
    degree of freedom of each row.
    """
    return Linear.of(find_equilibrium(model, about, spin))


__all__ = ["Campbell", "Linear", "Modes", "campbell", "frequency_response", "matrices", "modes"]
