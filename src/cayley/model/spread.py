"""Functions that make loads along rods (model.rod_loads); users have them as `loads.drag`, `loads.tendon`, ..."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from numpy.typing import ArrayLike

from cayley.model import rod_loads, validate
from cayley.model.rod import Rod

__all__ = ["buoyancy", "decay", "density", "distributed", "drag", "imposed_strain", "pressure", "temperature", "tendon"]


def distributed(
    rod: Rod,
    value: ArrayLike | Callable[[Any, Any], Any],
    *,
    moment: bool = False,
    frame: str = "space",
    start: float = 0.0,
    until: float = math.inf,
) -> rod_loads.Distributed:
    """A force or moment per unstressed length that depends on the place s along a rod and the time t.

    Args:
        rod: the rod.
        value: (3,) [N/m or N m/m], or a function of (s [m], t [s]) that returns it, written with NumPy.
        moment: True for a moment.
        frame: "space", or "body" for one that turns with the rod.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range.
    """
    return rod_loads.Distributed(rod=rod, value=value, moment=moment, frame=frame, start=start, until=until)


def pressure(
    rod: Rod,
    value: float | Callable[[Any, Any], Any],
    *,
    axis: str = "d1",
    start: float = 0.0,
    until: float = math.inf,
) -> rod_loads.Pressure:
    """A force q d2 × x′ (axis "d1") or q x′ × d1 (axis "d2") per unstressed length, always normal to the axis.

    Args:
        rod: the rod.
        value: q [N/m], pressure times width, or a function of (s [m], t [s]) that returns it.
        axis: the director it points along on a straight rod, "d1" or "d2".
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range.
    """
    return rod_loads.Pressure(rod=rod, value=value, axis=axis, start=start, until=until)


def drag(
    rod: Rod,
    *,
    density: float,
    diameter: float,
    normal: float = 1.2,
    tangential: float = 0.0,
    velocity: ArrayLike | Callable[[Any, Any], Any] = (0.0, 0.0, 0.0),
    start: float = 0.0,
    until: float = math.inf,
) -> rod_loads.Drag:
    """Quadratic drag of a fluid, −½ ρ d (C_n ‖u_n‖ u_n + π C_t ‖u_t‖ u_t) per length, u the velocity against it.

    Args:
        rod: the rod.
        density: ρ of the fluid [kg/m³].
        diameter: d [m].
        normal: C_n, of flow across the axis [-]; 1.2 for a circular cylinder at Reynolds numbers from 1e3 to 1e5.
        tangential: C_t, of flow along it [-], about 0.01.
        velocity: of the fluid [m/s], (3,) in space, or a function of (x (3,) [m], t [s]) that returns it.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range.
    """
    return rod_loads.Drag(
        rod=rod,
        density=density,
        diameter=diameter,
        normal=normal,
        tangential=tangential,
        velocity=velocity,
        start=start,
        until=until,
    )


def decay(rod: Rod, rate: float, *, start: float = 0.0, until: float = math.inf) -> rod_loads.Decay:
    """Damping −α m ẋ, −α J ω for some time, as damping.mass_proportional has it for all times.

    Args:
        rod: the rod.
        rate: α [1/s]; motion of a frequency ω decays fastest with α = 2ω.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is not positive.
    """
    return rod_loads.Decay(rod=rod, rate=rate, start=start, until=until)


def buoyancy(
    rod: Rod, *, density: float, area: float, start: float = 0.0, until: float = math.inf
) -> rod_loads.Buoyancy:
    """Lift −ρ A g per length of a rod all around which there is a fluid, with the gravity g of the model.

    Args:
        rod: the rod.
        density: ρ of the fluid [kg/m³].
        area: A, the volume a unit of length displaces [m²].
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is not positive.
    """
    return rod_loads.Buoyancy(rod=rod, density=density, area=area, start=start, until=until)


def imposed_strain(
    rod: Rod,
    strain: ArrayLike,
    *,
    amount: float | Callable[[Any, Any], Any] = 1.0,
    start: float = 0.0,
    until: float = math.inf,
) -> rod_loads.ImposedStrain:
    """A strain ε⁰ = amount × strain that the rod takes without stress: growth, swelling, a muscle.

    Args:
        rod: the rod.
        strain: (Γ1, Γ2, Γ3, Ω1, Ω2, Ω3) [-, 1/m]: shears, stretch, bending, twist.
        amount: a number [-], or a function of (s [m], t [s]) that returns it, such as an activation.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range, or the rod's kinematics has no such strain.
    """
    return rod_loads.ImposedStrain(rod=rod, strain=strain, amount=amount, start=start, until=until)  # type: ignore[arg-type]


def temperature(
    rod: Rod,
    change: float | Callable[[Any, Any], Any],
    *,
    expansion: float,
    start: float = 0.0,
    until: float = math.inf,
) -> rod_loads.ImposedStrain:
    """A change of temperature ΔT, which stretches a rod by β ΔT without stress.

    Args:
        rod: the rod.
        change: ΔT [K], or a function of (s [m], t [s]) that returns it.
        expansion: β [1/K], 1.2e-5 for steel.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range, or the rod is inextensible.
    """
    rate = validate.number("temperature", "expansion", expansion, "1/K")
    return imposed_strain(rod, (0.0, 0.0, rate, 0.0, 0.0, 0.0), amount=change, start=start, until=until)


def tendon(
    rod: Rod,
    tension: float | Callable[[Any], Any],
    *,
    offset: ArrayLike | Callable[[Any], Any],
    start: float = 0.0,
    until: float = math.inf,
) -> rod_loads.Tendon:
    """A tendon of tension T along a whole rod, fixed to both ends, sliding without friction between them.

    Args:
        rod: the rod.
        tension: T [N], or a function of the time [s] that returns it.
        offset: from the axis, (3,) along d1, d2, d3 [m], or a function of s [m] that returns it.
        start: first time at which it acts [s].
        until: time from which it acts no more [s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range.
    """
    return rod_loads.Tendon(rod=rod, tension=tension, offset=offset, start=start, until=until)


def density(
    rod: Rod,
    force: Callable[[Any, Any], Any],
    *,
    start: float = 0.0,
    until: float = math.inf,
    **constants: Any,
) -> rod_loads.Density:
    """Any forces: virtual work Σ F·δe per length of a rod.

    Args:
        rod: the rod.
        force: function (q, c) that returns pairs (F, e): e is what F works on, such as q.x (a force in space), q.p (a
            moment in the body frame) or q.p_s (a stress); F may depend on q.x, q.p, q.x_t, q.p_t, q.x_s, q.p_s, q.s,
            q.t and on cy.rate of a strain. It is called once, on symbols.
        start: first time at which they act [s].
        until: time from which they act no more [s].
        constants: numbers, vectors and matrices, which c has by their names.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range.
    """
    return rod_loads.Density(rod=rod, force=force, constants=constants, start=start, until=until)
