"""What saved frames say: velocities, energies, momenta and stress resultants, by the compiled kernel of the density."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from cayley.results.beside import ForcesBeside, forces_beside
from cayley.results.contact import contact_energy, contact_forces
from cayley.results.elements import element_starts
from cayley.results.frames import Frames, by_group
from cayley.results.held import held_nodes, support_forces
from cayley.results.interpolated import interpolated
from cayley.results.multipliers import constraint_forces
from cayley.results.resultants import resultants, timed_loads
from cayley.results.springs import spring_energy, spring_forces
from cayley.system.stability import decay_limit
from cayley.system.system import State, System, aligned, by_node, joined, pack, put_state
from cayley.system.turned import as_quaternions, embedded

BATCH_BYTES = 2**21
"""Of the blocks of frames that are observed together: they stay in a cache."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Observations:
    """Quantities that follow from saved states; of a system without interval, slopes and resultants are zero.

    Args:
        velocity: ẋ and ω by the Legendre transform of the momenta, shape (m, nodes, dofs).
        kinetic: kinetic energy [J], shape (m,).
        strain: strain energy, with that of springs and contacts [J], shape (m,).
        load: energy of the load terms of the density [J], shape (m,).
        resultants: spatial momenta σ and Σ at the nodes, shape (m, nodes, dofs).
        slopes: derivatives along the interval at the first point of each element, shape (m, nodes, dofs), that of an
            element at its left node.
        reactions: of each joint on its first node, body moment and force in space, shape (m, joints, dofs); None where
            there are no joints.
        held: nodes with held degrees of freedom, in rising order, shape (held,); None where there are none.
        supports: of what holds these on them, body moment and force in space, shape (m, held, dofs), or None.
    """

    velocity: np.ndarray
    kinetic: np.ndarray
    strain: np.ndarray
    load: np.ndarray
    resultants: np.ndarray
    slopes: np.ndarray
    reactions: np.ndarray | None = None
    held: np.ndarray | None = None
    supports: np.ndarray | None = None

    def at_nodes(self, nodes: np.ndarray) -> "Observations":
        """The same of some nodes; energies, forces of joints and supports are of all."""
        found = {name: getattr(self, name)[:, nodes] for name in ("velocity", "resultants", "slopes")}
        return replace(self, **found)

    def then(self, later: "Observations") -> "Observations":
        """These, and those of frames behind them."""
        found = {}
        for one in fields(self):
            first, second = getattr(self, one.name), getattr(later, one.name)
            found[one.name] = first if first is None or one.name == "held" else np.concatenate([first, second])
        return replace(self, **found)


def observe(system: System, frames: Frames) -> Observations:
    """Evaluate the kernel "observe" on every frame.

    Args:
        system: the system.
        frames: its saved states.

    Returns: the Observations.
    """
    of_groups = [_by_kernel(*pair) for pair in by_group(system, frames)]
    part = {name: joined([own[name] for own in of_groups], axis=1) for name in of_groups[0]}
    kinetic, strain, load = np.moveaxis(part["energies"].sum(axis=1), -1, 0)
    acting, nothing = part["velocity"], np.zeros_like(part["velocity"])
    spatial, slopes = nothing, part.get("slopes", nothing)
    exerted: dict[str, np.ndarray] = {}
    multipliers: Sequence[np.ndarray | None] = [None] * len(system.groups)
    if "length" in system.named:
        acting = acting_velocity(system, frames, acting)
        exerted, multipliers = _complete(system, frames, part, acting)
        if system.equations.rule.degree == 1:
            spatial = resultants(system, frames, part)
    if system.equations.rule.degree > 1:
        strain, spatial, slopes = _interpolated(system, frames, acting, multipliers)
    return Observations(
        velocity=part["velocity"],
        kinetic=kinetic,
        strain=strain + spring_energy(*_tied(system, frames)) + contact_energy(frames),
        load=load,
        resultants=spatial,
        slopes=slopes,
        **exerted,
    )


def _by_kernel(system: System, frames: Frames) -> dict[str, np.ndarray]:
    """What the kernel of one density says, shape (m, nodes, width) each."""
    rows, count = system.equations.rows, len(frames.times)
    widths = {name: (own.stop - own.start) // rows.cell for name, own in rows.observed.items()}
    part = {name: np.empty((count, system.size, width)) for name, width in widths.items()}
    blank = pack(system, State(values=system.reference, momenta=np.zeros((system.size, system.layout.dofs))))
    batch = max(1, BATCH_BYTES // blank.nbytes)
    for first in range(0, count, batch):
        some = slice(first, min(first + batch, count))
        seen = _blocks(system, frames.part(some), blank)
        for name, own in rows.observed.items():
            part[name][some] = by_node(system, seen, own)
    return part


def _blocks(system: System, frames: Frames, blank: np.ndarray) -> np.ndarray:
    """Blocks of some frames after the kernel, shape (m, blocks, rows, lanes), from one with constants but no state."""
    kernel = system.kernels["observe"]
    predict = system.kernels["predict"] if system.equations.forced else None
    uniforms = np.zeros(kernel.width)  # its inputs, and room behind them
    uniforms[: len(system.uniforms)] = system.uniforms
    data, end = aligned((len(frames.times), *blank.shape)), len(blank) - 1
    data[:] = blank
    for k, time in enumerate(frames.times):
        put_state(system, data[k], frames.state(k))
        uniforms[1] = uniforms[2] = time
        if predict is not None:  # with a step of 0 the velocities are those of the frame
            asked = np.zeros(predict.width)
            asked[: len(system.uniforms)] = uniforms[: len(system.uniforms)]
            predict(data[k], asked, 1, end)
        kernel(data[k], uniforms, 1, end)
    return data[:, 1:-1]


def _interpolated(
    system: System, frames: Frames, velocity: np.ndarray, multipliers: Sequence[np.ndarray | None]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Strain energy, resultants and slopes of elements of a degree above 1."""
    found = [
        interpolated(group, own, velocity[:, nodes], pulls)
        for (group, own), (_, nodes), pulls in zip(by_group(system, frames), system.spans, multipliers, strict=True)
    ]
    energy, spatial, slopes = zip(*found, strict=True)
    return joined([one[None] for one in energy]).sum(axis=0), joined(spatial, axis=1), joined(slopes, axis=1)


def acting_velocity(system: System, frames: Frames, velocity: np.ndarray) -> np.ndarray:
    """Velocities that forces at the frames are told, where they depend on them.

    A step h over 2/δ does not resolve what decays at the rate δ. The momenta of implicit rules then go on with it, its
    sign the same or another in every step: small in itself, but not when δ multiplies it. Viscous forces of that
    velocity would be many times the true ones, and with them those of joints and supports, which keep the balance. So
    where h > 2/δ_max the velocities are those that the last three steps say together (see Frames), from the third step
    of a run on. What oscillates fast without decay is no error: the motion has it, if at another frequency.

    Args:
        system: the system.
        frames: its saved states.
        velocity: of the momenta, shape (m, nodes, dofs).

    Returns: shape (m, nodes, dofs).
    """
    if frames.rates is None or _resolved(system, frames):
        return velocity
    return np.where(np.isfinite(frames.rates), frames.rates, velocity)


def _resolved(system: System, frames: Frames) -> bool:
    """Whether steps resolve all decay; those of elements of higher degree, which are about rods as stiff, do not."""
    if system.equations.rule.degree > 1:
        return False
    key = f"resolved with {frames.h!r}"  # frames may come some at a time
    if key not in system.plans:
        system.plans[key] = not frames.h > decay_limit(system, system.reference, enough=frames.h)
    return bool(system.plans[key])


def energy_of(system: System, state: State) -> float:
    """Total energy of a state [J]."""
    seen = observe(system, Frames.of(state))
    return float(seen.kinetic[0] + seen.strain[0] + seen.load[0])


def _complete(
    system: System, frames: Frames, part: dict[str, np.ndarray], acting: np.ndarray
) -> tuple[dict[str, np.ndarray], Sequence[np.ndarray | None]]:
    """Complete the forces that the kernel observes: "left", "right", "load", and "point" on nodes alone.

    Returns: reactions, held and supports of the Observations, and multipliers of the constraints of each density.
    """
    velocity, degree = part["velocity"], system.equations.rule.degree
    beside = _beside(system, frames, acting)
    part["load"] += beside.outer
    tied, seen = _tied(system, frames)
    part["point"] = spring_forces(tied, seen, acting)
    part["point"] += contact_forces(system, frames)
    total = part["load"] + part["point"] + sum(timed_loads(system, frames))
    if degree == 1:
        part["left"] += beside.inner[:, :, 0]
        part["right"] += beside.inner[:, :, 1]
        _add_ends(system, total, np.stack([part["left"], part["right"]], axis=2))
    else:
        _add_ends(system, total, beside.inner)
    found: dict[str, np.ndarray] = {}
    multipliers: Sequence[np.ndarray | None] = [None] * len(system.groups)
    if system.joints or system.with_constraints:
        pulled = constraint_forces(tied, seen, velocity, total)
        part["point"] += pulled.point
        total += pulled.point
        multipliers = pulled.multipliers
        _add_ends(system, total, pulled.inner)
        if degree == 1:
            part["left"] += pulled.inner[:, :, 0]
            part["right"] += pulled.inner[:, :, 1]
        if system.joints:
            found["reactions"] = pulled.joints
    held = held_nodes(system)
    if len(held):
        found |= {"held": held, "supports": support_forces(system, frames, velocity, total)}
    return found, multipliers


def _beside(system: System, frames: Frames, velocity: np.ndarray) -> ForcesBeside:
    found = [
        forces_beside(group, own, velocity[:, nodes])
        for (group, own), (_, nodes) in zip(by_group(system, frames), system.spans, strict=True)
    ]
    return ForcesBeside(joined([one.inner for one in found], axis=1), joined([one.outer for one in found], axis=1))


def _tied(system: System, frames: Frames) -> tuple[System, Frames]:
    """What joints, springs and constraints are asked with: rotations as quaternions."""
    if not (system.joints or system.springs):  # constraints of densities are there for quaternions only
        return system, frames
    return embedded(system), replace(frames, values=as_quaternions(system.layout, frames.values))


def _add_ends(system: System, total: np.ndarray, ends: np.ndarray) -> None:
    """Add forces of the elements on their nodes, each at its first one, (m, nodes, degree + 1, dofs)."""
    starts = element_starts(system)
    for end in range(ends.shape[2]):
        total[:, starts + end] += ends[:, starts, end]


__all__ = ["Frames", "Observations", "energy_of", "observe"]
