"""Answers to harmonic loads: complex amplitudes over the frequency, by one sparse solve for each."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.model import Model
from cayley.model.loads import LineLoad, PointLoad
from cayley.model.rod_loads import RodLoad
from cayley.steppers.still import Still
from cayley.system.discretize import discretize
from cayley.vibration.eigen import eigenpairs
from cayley.vibration.linear import Linear, find_equilibrium
from cayley.vibration.result import moved

if TYPE_CHECKING:
    import xarray as xr

MODES = 20
"""Modes that get a damping ratio where none are counted."""


def frequency_response(
    model: Model,
    *,
    load: Any,
    frequencies: Any,
    at: Any,
    about: Any = None,
    phase: Any = 0.0,
    damping_ratio: float | None = None,
    count: int = MODES,
) -> "xr.Dataset":
    """Steady small motions under a harmonic load, v(t) = Re(a exp(iωt)).

    (K − ω² M + iω (C + G)) a + Aᵀ λ = f,   A a = 0

    Args:
        model: the model.
        load: a load or several, as in the model, of which the amplitudes are taken at the time of the equilibrium, such
            as ``loads.force(rod.end, (0, 0, 1.0))``.
        frequencies: [Hz], shape (k,).
        at: where the motion is wanted: a port, a rod or a body.
        about: the equilibrium, as for cy.modes.
        phase: by which each load is ahead [rad], one number or one a load.
        damping_ratio: ζ, added to the damping of the model for the lowest modes: C + M Φ (2 ζ ω) Φᵀ M.
        count: number of these modes.

    Returns: complex displacement (in space) [m] and rotation (about the body's axes) [rad], dims (frequency, axis) or,
    for a rod, (frequency, node, axis).

    Raises:
        ValueError: if an argument does not fit.
    """
    hertz = _frequencies(frequencies)
    linear = Linear.of(find_equilibrium(model, about))
    force = _amplitude(linear, load, phase)
    damper = _damper(linear, damping_ratio, count)
    found = np.empty((linear.size, len(hertz)), dtype=complex)
    for k, omega in enumerate(2.0 * np.pi * hertz):
        found[:, k] = _answer(linear, force, float(omega), damper)
    coordinates = {"frequency": ("frequency", hertz, {"units": "Hz"})}
    return moved(linear, found, at, "frequency", coordinates)


def _answer(
    linear: Linear, force: np.ndarray, omega: float, damper: tuple[np.ndarray, np.ndarray] | None
) -> np.ndarray:
    """One solve; modal dampers are of low rank, (Z + U D Uᵀ)⁻¹ = Z⁻¹ − Z⁻¹ U (D⁻¹ + Uᵀ Z⁻¹ U)⁻¹ Uᵀ Z⁻¹."""
    try:
        factors = linear.factorized(1j * omega)
        if damper is None:
            return factors.solve(force)
        spread, rates = damper
        both = factors.solve(np.column_stack([force, spread]).astype(complex))
    except RuntimeError:
        raise ValueError(
            f"frequency_response: {omega / (2.0 * np.pi):.6g} Hz is a frequency of the undamped model itself, where "
            "the answer is infinite; give damping, or another frequency"
        ) from None
    alone, across = both[:, 0], both[:, 1:]
    if omega == 0.0:
        return alone
    small = np.diag(1.0 / (1j * omega * rates)) + spread.T @ across
    return alone - across @ np.linalg.solve(small, spread.T @ alone)


def _damper(linear: Linear, ratio: float | None, count: int) -> tuple[np.ndarray, np.ndarray] | None:
    if ratio is None:
        return None
    if not np.isfinite(ratio) or ratio < 0.0:
        raise ValueError(f"frequency_response: damping_ratio is {ratio!r}; give a number not below 0, such as 0.02")
    if not linear.conservative:
        raise ValueError(
            "frequency_response: damping_ratio is for models without damping and spin, whose modes are real; give the "
            "damping of rods and springs instead"
        )
    pairs = eigenpairs(linear, count)
    rates = 2.0 * ratio * pairs.values.imag
    kept = rates > 0.0
    return (linear.mass @ pairs.vectors[:, kept], rates[kept]) if kept.any() else None


def _amplitude(linear: Linear, load: Any, phase: Any) -> np.ndarray:
    """Generalized forces of the loads, complex, shape (n,): how much they add to those of the equilibrium."""
    given: Sequence[Any] = load if isinstance(load, list | tuple) else [load]
    for one in given:
        if not isinstance(one, PointLoad | LineLoad | RodLoad):
            raise ValueError(f"frequency_response: load is {one!r}; give loads such as loads.force(rod.end, (0, 0, 1))")
    try:
        phases = np.broadcast_to(np.asarray(phase, dtype=float), (len(given),))
    except ValueError:
        raise ValueError(f"frequency_response: phase is {phase!r}; give one number or one a load [rad]") from None
    about = linear.about
    model, still, rule = about.model, about.still, about.system.equations.rule
    before, free = still.force()[still.free], still.free
    found = np.zeros(linear.size, dtype=complex)
    for one, angle in zip(given, phases, strict=True):
        more = discretize(model.replace(loads=[*model.loads, one]), rule)
        loaded = Still.at(more, still.values, still.time, still.spin)
        loaded.put(still.values, still.multipliers)
        found += np.exp(1j * angle) * (loaded.force()[free] - before)
    return found


def _frequencies(given: Any) -> np.ndarray:
    try:
        found = np.atleast_1d(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.ndim != 1 or not len(found) or not np.all(np.isfinite(found)) or np.any(found < 0.0):
        raise ValueError(f"frequency_response: frequencies is {given!r}; give numbers not below 0 [Hz]")
    return found
