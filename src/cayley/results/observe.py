"""What saved frames say: velocities, energies, momenta and stress resultants, by the compiled kernel of the density."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from cayley.lie import quaternion
from cayley.steppers.calls import call_kernel
from cayley.system.system import State, System, gather, pack


@dataclass(frozen=True, slots=True, kw_only=True)
class Frames:
    """Saved states of a run.

    Args:
        times: [s], shape (m,).
        steps: step number of each frame, shape (m,).
        values: shape (m, nodes, rows).
        momenta: shape (m, nodes, dofs).
        origin: time of step 0 [s].
        h: time step [s].
    """

    times: np.ndarray
    steps: np.ndarray
    values: np.ndarray
    momenta: np.ndarray
    origin: float
    h: float

    def state(self, k: int = -1) -> State:
        """The state of a frame, to go on from."""
        return State(
            values=self.values[k].copy(),
            momenta=self.momenta[k].copy(),
            origin=self.origin,
            step=int(self.steps[k]),
            h=self.h,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Observations:
    """Quantities that follow from saved states.

    Args:
        velocity: ẋ and ω by the Legendre transform of the momenta, shape (m, nodes, dofs).
        kinetic: kinetic energy [J], shape (m,).
        strain: strain energy [J], shape (m,).
        load: energy of the load terms of the density [J], shape (m,).
        left: force of each element on its left node, shape (m, nodes, dofs); zero where there is no element.
        right: force of each element on its right node, shape (m, nodes, dofs).
        body: force of the load terms of the density on each node, shape (m, nodes, dofs).
        applied: force of time-dependent loads on each node, shape (m, nodes, dofs).
        slopes: derivatives along the interval at the first point of each element, shape (m, nodes, dofs).
    """

    velocity: np.ndarray
    kinetic: np.ndarray
    strain: np.ndarray
    load: np.ndarray
    left: np.ndarray
    right: np.ndarray
    body: np.ndarray
    applied: np.ndarray
    slopes: np.ndarray


def observe(system: System, frames: Frames) -> Observations:
    """Evaluate the kernel "observe" on every frame.

    Args:
        system: the system.
        frames: its saved states.

    Returns: the Observations.
    """
    rows, size = system.equations.rows, system.size
    kernel = system.kernels.address("observe")
    first = min(part.start for part in rows.observed.values())
    uniforms = system.uniforms.copy()
    found = np.empty((len(frames.times), size, rows.count - first))
    data = pack(system, frames.state(0))
    for k, time in enumerate(frames.times):
        data = pack(system, frames.state(k)) if k else data
        uniforms[1] = uniforms[2] = time
        _call(kernel, data, uniforms)
        found[k] = gather(data[1:-1], slice(first, rows.count), size)
    part = {name: found[..., p.start - first : p.stop - first] for name, p in rows.observed.items()}
    nothing = np.zeros_like(part["velocity"])
    kinetic, strain, load = np.moveaxis(part["energies"].sum(axis=1), -1, 0)
    return Observations(
        velocity=part["velocity"],
        kinetic=kinetic,
        strain=strain,
        load=load,
        left=part.get("left", nothing),
        right=part.get("right", nothing),
        body=part["load"],
        applied=timed_loads(system, frames),
        slopes=part.get("slopes", nothing),
    )


def timed_loads(system: System, frames: Frames) -> np.ndarray:
    """Forces of the time-dependent loads on every node, shape (m, nodes, dofs)."""
    found = np.zeros((len(frames.times), system.size, system.layout.dofs))
    loads = system.loads
    if loads is None:
        return found
    table = loads.table(frames.times, frames.h, frames.origin)
    to_quaternion = system.layout.representation.to_quaternion
    turn_rows = system.layout.representation.rows
    for e, node in enumerate(loads.node):
        vector = loads.scale[e] * table[:, loads.column[e] : loads.column[e] + 3]
        if loads.form[e]:
            turn = loads.turn[e]
            p = to_quaternion(frames.values[:, node, turn : turn + turn_rows])
            turned = quaternion.inverse_rotate if loads.form[e] == 1 else quaternion.rotate
            vector = np.asarray(turned(p, vector), dtype=float)
        found[:, node, loads.dof[e] : loads.dof[e] + 3] += vector
    return found


def resultants(system: System, observed: Observations) -> np.ndarray:
    """Spatial momenta at the nodes: the discrete Legendre transform along the interval, per unit of time.

    σ_aʲ = (1/h) Σ over the two steps at j of D_(a,j) L_d(cells left of a) = −(1/h) Σ D_(a,j) L_d(cells right of a)

    (equal by the discrete Euler-Lagrange equations where no time-dependent load acts at a; their mean is taken inside,
    the side that exists at the ends). The inertia of a node that moves is the total force on it, shared between left
    and right by weight; a held one has none. So a free end gives exactly zero, and a loaded or held one its force.

    Returns: in the paper's sign (σ = ∂L/∂x′ = −internal force), x in space, rotations in the body frame,
    shape (m, nodes, dofs), in N and N m; times h these are the raw discrete momenta.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 2 and figure 5.
    """
    length, weight = system.named["length"], system.named["weight"]
    before = np.concatenate([[0.0], length[:-1]])
    share = (0.5 * before / weight)[None, :, None]
    from_left = np.concatenate([np.zeros_like(observed.right[:, :1]), observed.right[:, :-1]], axis=1)
    from_left = from_left * (before > 0.0)[None, :, None]
    inertia = np.where(system.free[None], from_left + observed.left + observed.body + observed.applied, 0.0)
    left = from_left + share * (observed.body - inertia)
    right = -observed.left - (1.0 - share) * (observed.body - inertia)
    return np.where(share == 0.0, right, np.where(share == 1.0, left, 0.5 * (left + right)))


@njit(cache=True)
def _call(kernel: int, data: np.ndarray, uniforms: np.ndarray) -> int:
    return call_kernel(kernel, data.ctypes.data, uniforms.ctypes.data, 1, data.shape[0] - 1)


__all__ = ["Frames", "Observations", "observe", "resultants", "timed_loads"]
