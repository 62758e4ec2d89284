"""Energy and forces of the springs and dampers of a system at saved frames."""

import casadi as ca
import numpy as np

from cayley.density.expression import symbols, to_sx
from cayley.discrete.joint import Evaluator, evaluator, once
from cayley.discrete.layout import Layout
from cayley.discrete.node import tangent
from cayley.discrete.spring import damper_program, spring_program
from cayley.results.frames import Frames
from cayley.system.couplings import Elastic
from cayley.system.redundancy import ground_values
from cayley.system.system import System


def spring_energy(system: System, frames: Frames) -> np.ndarray:
    """Energy of all springs together [J], shape (m,)."""
    total = np.zeros(len(frames.times))
    for spring in system.springs:
        function = _functions(spring.kind, system.layout, grounded=spring.grounded)[0]
        total += function(np.hstack([*_sides(system, frames.values, spring), _numbers(spring, len(total))]))[:, 0]
    return total


def spring_forces(system: System, frames: Frames, velocity: np.ndarray) -> np.ndarray:
    """Forces of springs and dampers on the nodes, left-trivialized, −Tᵀ(∂V/∂z + Gᵀ C G T v).

    Args:
        system: the system.
        frames: its saved states.
        velocity: ω and ẋ, shape (m, nodes, dofs).

    Returns: body moments and forces in space, shape (m, nodes, dofs).
    """
    layout, found = system.layout, np.zeros_like(velocity)
    turn = node_tangents(layout, frames.values) if system.springs else found
    still = np.zeros((len(velocity), layout.rows))
    for spring in system.springs:
        sides, numbers = _sides(system, frames.values, spring), _numbers(spring, len(velocity))
        energy, damper = _functions(spring.kind, layout, grounded=spring.grounded)
        pull = -energy(np.hstack([*sides, numbers]))[:, 1 : 1 + 2 * layout.rows]
        ends = [spring.first] if spring.grounded else [spring.first, spring.second]
        rates = [np.einsum("trd,td->tr", turn[:, node], velocity[:, node]) for node in ends]
        moving = [*rates, still][:2]
        pull += damper(np.hstack([*sides, *moving, numbers]))[:, : 2 * layout.rows]
        for k, node in enumerate(ends):
            own = pull[:, k * layout.rows : (k + 1) * layout.rows]
            found[:, node] += np.einsum("trd,tr->td", turn[:, node], own)
    return found


def node_tangents(layout: Layout, values: np.ndarray) -> np.ndarray:
    """Derivative of the rows of nodes along their degrees of freedom, (m, nodes, rows) -> (m, nodes, rows, dofs)."""
    node = symbols("q", layout.rows)
    function = ca.Function("tangent", [to_sx(node)], [ca.vec(ca.densify(tangent(layout, node)).T)])
    flat = np.array(function(values.reshape(-1, layout.rows).T)).T
    return flat.reshape(*values.shape[:2], layout.rows, layout.dofs)


@once
def _functions(kind: str, layout: Layout, *, grounded: bool) -> tuple[Evaluator, Evaluator]:
    """Energy and damping of springs of a kind."""
    energy, damper = (program(kind, layout, grounded=grounded) for program in (spring_program, damper_program))
    return evaluator(energy), evaluator(damper)


def _sides(system: System, values: np.ndarray, spring: Elastic) -> list[np.ndarray]:
    """Values of both sides, shape (m, rows) each."""
    ground = np.tile(ground_values(system.layout), (len(values), 1))
    return [values[:, spring.first], ground if spring.grounded else values[:, spring.second]]


def _numbers(spring: Elastic, count: int) -> np.ndarray:
    return np.tile(spring.parameters, (count, 1))
