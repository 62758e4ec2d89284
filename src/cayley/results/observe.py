"""What saved frames say: velocities, energies, momenta and stress resultants, by the compiled kernel of the density."""

from dataclasses import dataclass

import numpy as np

from cayley.results.frames import Frames
from cayley.results.interpolated import interpolated
from cayley.results.multipliers import constraint_forces
from cayley.results.resultants import resultants, timed_loads
from cayley.results.springs import spring_energy, spring_forces
from cayley.system.system import System, by_node, pack


@dataclass(frozen=True, slots=True, kw_only=True)
class Observations:
    """Quantities that follow from saved states; of a system without interval, slopes and resultants are zero.

    Args:
        velocity: ẋ and ω by the Legendre transform of the momenta, shape (m, nodes, dofs).
        kinetic: kinetic energy [J], shape (m,).
        strain: strain energy, with that of springs [J], shape (m,).
        load: energy of the load terms of the density [J], shape (m,).
        resultants: spatial momenta σ and Σ at the nodes, shape (m, nodes, dofs).
        slopes: derivatives along the interval at the first point of each element, shape (m, nodes, dofs), that of an
            element at its left node.
        reactions: of each joint on its first node, body moment and force in space, shape (m, joints, dofs); None where
            there are no joints, or elements have a degree above 1.
    """

    velocity: np.ndarray
    kinetic: np.ndarray
    strain: np.ndarray
    load: np.ndarray
    resultants: np.ndarray
    slopes: np.ndarray
    reactions: np.ndarray | None = None


def observe(system: System, frames: Frames) -> Observations:
    """Evaluate the kernel "observe" on every frame.

    Args:
        system: the system.
        frames: its saved states.

    Returns: the Observations.
    """
    rows = system.equations.rows
    kernel = system.kernels["observe"]
    predict = system.kernels["predict"] if system.equations.forced else None
    uniforms = np.zeros(kernel.width)  # its inputs, and room behind them
    uniforms[: len(system.uniforms)] = system.uniforms
    widths = {name: (own.stop - own.start) // rows.cell for name, own in rows.observed.items()}
    part = {name: np.empty((len(frames.times), system.size, width)) for name, width in widths.items()}
    for k, time in enumerate(frames.times):
        data = pack(system, frames.state(k))
        uniforms[1] = uniforms[2] = time
        if predict is not None:  # with a step of 0 the velocities are those of the frame
            asked = np.zeros(predict.width)
            asked[: len(system.uniforms)] = uniforms[: len(system.uniforms)]
            predict(data, asked, 1, data.shape[0] - 1)
        kernel(data, uniforms, 1, data.shape[0] - 1)
        for name, own in rows.observed.items():
            part[name][k] = by_node(system, data[1:-1], own)
    kinetic, strain, load = np.moveaxis(part["energies"].sum(axis=1), -1, 0)
    nothing = np.zeros_like(part["velocity"])
    spatial, slopes = nothing, part.get("slopes", nothing)
    reactions = None
    if system.equations.rule.degree > 1:
        strain, spatial, slopes = interpolated(system, frames, part["velocity"])
    elif "left" in part:
        part["point"] = spring_forces(system, frames, part["velocity"])
        if system.equations.density.constraints.numel() or system.joints:
            reactions = _add_constraint_forces(system, frames, part)
        spatial = resultants(system, frames, part)
    return Observations(
        velocity=part["velocity"],
        kinetic=kinetic,
        strain=strain + spring_energy(system, frames),
        load=load,
        resultants=spatial,
        slopes=slopes,
        reactions=reactions if system.joints else None,
    )


def _add_constraint_forces(system: System, frames: Frames, part: dict[str, np.ndarray]) -> np.ndarray:
    """Add the forces of the multipliers to those of the elements and of points; returns those of joints."""
    from_left = np.zeros_like(part["right"])
    from_left[:, 1:] = part["right"][:, :-1]
    total = part["left"] + from_left + part["load"] + part["point"] + sum(timed_loads(system, frames))
    found = constraint_forces(system, frames, part["velocity"], total)
    part["left"], part["right"] = part["left"] + found.left, part["right"] + found.right
    part["point"] = part["point"] + found.point
    return found.joints


__all__ = ["Frames", "Observations", "observe"]
