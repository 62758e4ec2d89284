"""What accelerations and velocities ask of the nodes: M and b of d/dt ∂T/∂v − ∂T/∂q = M v̇ + b."""

import casadi as ca
import numpy as np

from cayley.density.expression import to_sx
from cayley.discrete.node import node_point, tangent
from cayley.results.elements import element_inputs, element_symbols
from cayley.system.system import System, joined


class NodeInertia:
    """M = ∂²T/∂v² and b of nodes, in rising order, T by their weight; for a rotation b has ω × Jω."""

    def __init__(self, system: System, nodes: np.ndarray) -> None:
        """Derive the functions of all densities."""
        chosen = [(group, nodes[(nodes >= own.start) & (nodes < own.stop)], own) for group, own in system.spans]
        self.groups = [(_Inertia(group, some - own.start), own) for group, some, own in chosen if len(some)]

    def __call__(self, values: np.ndarray, velocity: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
        """For values and velocities of all nodes at a time.

        Returns: b, shape (n, dofs), and M, shape (n, dofs, dofs), of the n nodes asked for.
        """
        found = [function(values[own], velocity[own], time) for function, own in self.groups]
        return joined([bias for bias, _ in found]), joined([mass for _, mass in found])


class _Inertia:
    """M and b of nodes of one density."""

    def __init__(self, system: System, nodes: np.ndarray) -> None:
        self.dofs, self.inputs = system.layout.dofs, element_inputs(system, nodes)
        layout, density = system.layout, system.equations.density
        known = element_symbols(system)
        node, rate, weight = known.ends[0], known.rates[0], to_sx(known.place["weight"])
        point = node_point(layout, node, density.lagrangian.interval, known.place)
        point |= {f"{name}_t": rate[layout.dofs_of(name)] for name in layout.fields}
        gradient = density.gradient("inertia", point)
        momentum = ca.vertcat(*[to_sx(gradient[f"{name}_t"]) for name in layout.fields])
        bias = ca.jtimes(momentum, to_sx(node), tangent(layout, node) @ to_sx(rate))
        bias -= ca.vertcat(*[to_sx(gradient[name]) for name in layout.fields])
        for name in layout.rotations:
            dofs = layout.dofs_of(name)
            bias[dofs] += ca.cross(to_sx(rate)[dofs], momentum[dofs])
        mass = ca.jacobian(momentum, to_sx(rate))
        outputs = [ca.densify(bias * weight), ca.vec(ca.densify(mass * weight))]
        self.function = ca.Function("inertia", [known.inputs], outputs)

    def __call__(self, values: np.ndarray, velocity: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
        bias, mass = self.function(self.inputs(values, velocity, time))
        return np.asarray(bias).T, np.asarray(mass).T.reshape(-1, self.dofs, self.dofs)  # symmetric


__all__ = ["NodeInertia"]
