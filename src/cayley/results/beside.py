"""Forces of elements and nodes at saved frames that the kernel "observe" does not give."""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from cayley.density.expression import to_sx
from cayley.density.force import KINDS, SPREAD, STRAIN
from cayley.discrete.forcing import element_forcing, node_forcing
from cayley.discrete.polynomial import polynomial_forces
from cayley.results.elements import ElementSymbols, element_inputs, element_starts, element_symbols
from cayley.results.frames import Frames
from cayley.system.system import System


@dataclass(frozen=True, slots=True)
class ForcesBeside:
    """Body moments and forces in space.

    Args:
        inner: of the element that begins at a node on its nodes, by stresses: of those beside the Lagrangian, unless
            observed, and in elements of a degree above 1 of all; shape (m, nodes, degree + 1, dofs).
        outer: other forces beside the Lagrangian, such as drag, on the nodes, shape (m, nodes, dofs).
    """

    inner: np.ndarray
    outer: np.ndarray


def forces_beside(system: System, frames: Frames, velocity: np.ndarray) -> ForcesBeside:
    """Evaluate them on every frame.

    Args:
        system: the system, with an interval.
        frames: its saved states.
        velocity: ω and ẋ, shape (m, nodes, dofs).
    """
    count, size, dofs = velocity.shape
    ends = system.equations.rule.degree + 1
    found = ForcesBeside(np.zeros((count, size, ends, dofs)), np.zeros_like(velocity))
    if ends == 2 and system.equations.density.force is None:
        return found
    known, starts = element_symbols(system), element_starts(system)
    inner, outer = _inner(system, known), _forcing(system, known, (SPREAD,))
    between = ca.Function("between", [known.inputs], [inner, outer]), element_inputs(system, starts)
    on_node = ca.Function("on_node", [known.inputs], [_on_node(system, known)]), element_inputs(system, np.arange(size))
    for k, time in enumerate(map(float, frames.times)):
        now = frames.values[k], velocity[k], time
        stress, other = (np.asarray(f).T.reshape(-1, ends, dofs) for f in between[0](between[1](*now)))
        found.inner[k, starts] = stress
        found.outer[k] = np.asarray(on_node[0](on_node[1](*now))).T
        for end in range(ends):
            found.outer[k, starts + end] += other[:, end]
    return found


def _inner(system: System, known: ElementSymbols) -> ca.SX:
    """The inner forces of an element, a column."""
    equations = system.equations
    total = ca.SX.zeros(len(known.ends) * system.layout.dofs)
    if not equations.forced:  # explicit rules observe them, at the velocities of their predictor
        total += _forcing(system, known, (STRAIN,))
    if equations.rule.degree > 1:
        of_ends = polynomial_forces(equations.density, equations.rule.strain, system.layout, known.ends, known.place)
        total += ca.vertcat(*[to_sx(f) for f in of_ends]) * to_sx(known.place["length"])
    return ca.densify(total)


def _forcing(system: System, known: ElementSymbols, where: tuple[str, ...]) -> ca.SX:
    """Forces beside the Lagrangian of an element that stand at some places, a column."""
    density, points, layout = system.equations.density, system.equations.rule.strain, system.layout
    total = ca.SX.zeros(len(known.ends) * layout.dofs)
    for kind in KINDS if density.force is not None else ():
        found = element_forcing(density, points, layout, known.ends, known.rates, known.place, kind, where=where)
        total += ca.vertcat(*[to_sx(f) for f in found])
    return ca.densify(total * to_sx(known.place["length"]))


def _on_node(system: System, known: ElementSymbols) -> ca.SX:
    """Forces beside the Lagrangian on a node."""
    density, layout = system.equations.density, system.layout
    parts = [to_sx(node_forcing(density, layout, known.ends[0], known.rates[0], known.place, kind)) for kind in KINDS]
    return ca.densify((parts[0] + parts[1]) * to_sx(known.place["weight"]))


__all__ = ["ForcesBeside", "forces_beside"]
