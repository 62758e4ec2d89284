"""Damping of rods: viscosity of the material, and a decay of all motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cayley.model import validate
from cayley.model.validate import Array

__all__ = ["Damping", "mass_proportional", "ratio", "rayleigh", "retardation", "viscous"]

_ROWS = "shear 1, shear 2, axial, bend 1, bend 2, twist [N s, N m^2 s]"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Damping:
    """Damping of a rod; made by `retardation`, `viscous`, `mass_proportional`, `ratio` and `rayleigh`, and added up.

    δW = −∫ ε̇·(D + T C T) δε + α (m ẋ·δx + ω·J η) ds,    T = diag(√τ)

    with ε = (Γ, Ω) the strains, C the stiffness and J the inertia of the section.

    Attributes:
        retardation: τ [s], one for each strain, in the order of the stiffness.
        viscosity: D, shape (6, 6), symmetric, positive semidefinite, read-only, or None.
        decay: α [1/s].

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is negative, infinite or NaN, or D is not symmetric and positive semidefinite.
    """

    retardation: tuple[float, ...] = (0.0,) * 6
    viscosity: Array | None = None
    decay: float = 0.0

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        right = "6 numbers, not negative [s], one for each strain"
        times = validate.array("Damping", "retardation", self.retardation, (6,), right)
        if times.min() < 0.0:
            raise ValueError(validate.wrong("Damping", "retardation", self.retardation, right))
        object.__setattr__(self, "retardation", tuple(times.tolist()))
        if self.viscosity is not None:
            object.__setattr__(self, "viscosity", _semidefinite(self.viscosity))
        decay = validate.number("Damping", "decay", self.decay, "1/s")
        if decay < 0.0:
            raise ValueError(validate.wrong("Damping", "decay", self.decay, "a number, not negative [1/s]"))
        object.__setattr__(self, "decay", decay)

    def __add__(self, other: Damping) -> Damping:
        """Both together: Damping of the sum of their forces.

        Raises:
            ValueError: both have retardation times of strains that are not proportional, which have no sum.
        """
        if not isinstance(other, Damping):
            return NotImplemented
        mine, more = np.array(self.retardation), np.array(other.retardation)
        if np.any(mine) and np.any(more) and not all(np.ptp(times) == 0.0 for times in (mine, more)):
            raise ValueError("Damping: retardation times of single strains do not add up; give them in one Damping")
        parts = [d.viscosity for d in (self, other) if d.viscosity is not None]
        total = sum(parts[1:], start=parts[0]) if parts else None
        return Damping(retardation=tuple(mine + more), viscosity=total, decay=self.decay + other.decay)

    def __str__(self) -> str:
        """What it is, in one line."""
        parts = []
        if any(self.retardation):
            same = len(set(self.retardation)) == 1
            times = f"{self.retardation[0]:g}" if same else "(" + ", ".join(f"{t:g}" for t in self.retardation) + ")"
            parts.append(f"retardation {times} s")
        if self.viscosity is not None:
            parts.append("viscosity given")
        if self.decay:
            parts.append(f"decay {self.decay:g} 1/s")
        return ", ".join(parts) or "none"

    def ratio_at(self, frequency: float) -> float:
        """ζ = ½ (α/ω + τ ω) of a mode of a frequency [Hz], without what viscosity adds and for the largest τ."""
        omega = 2.0 * math.pi * validate.positive("Damping", "frequency", frequency, "Hz")
        return 0.5 * (self.decay / omega + max(self.retardation) * omega)


def retardation(time: float | ArrayLike) -> Damping:
    """Kelvin-Voigt material: stress C (ε + τ ε̇), D = τ C.

    Args:
        time: τ [s], one number, or six, one for each strain in the order of the stiffness; D_ij = √(τᵢ τⱼ) C_ij.

    Raises:
        TypeError: not numbers.
        ValueError: negative, infinite or NaN, or neither one nor six.
    """
    given = [time] * 6 if np.ndim(time) == 0 else time
    return Damping(retardation=given)  # type: ignore[arg-type]


def viscous(viscosity: ArrayLike) -> Damping:
    """Kelvin-Voigt material of given viscosity: stress C ε + D ε̇.

    Args:
        viscosity: D, shape (6, 6), or the six numbers of its diagonal [N s, N m² s], in the order of the stiffness.

    Raises:
        TypeError: not numbers.
        ValueError: another shape, not symmetric, or not positive semidefinite.
    """
    given = np.asarray(viscosity)
    return Damping(viscosity=np.diag(given) if given.ndim == 1 else given)


def mass_proportional(decay: float) -> Damping:
    """Forces −α m ẋ and moments −α J ω: all motion decays, of a rigid body as well, ζ = α/(2ω).

    Args:
        decay: α [1/s].

    Raises:
        TypeError: not a number.
        ValueError: negative, infinite or NaN.
    """
    return Damping(decay=decay)


def ratio(zeta: float, *, frequency: float) -> Damping:
    """Retardation that gives modes of a frequency f a damping ratio ζ: τ = 2ζ/(2πf); others get ζ f'/f.

    Args:
        zeta: ζ [-], such as 0.02.
        frequency: f [Hz].

    Raises:
        TypeError: not a number.
        ValueError: negative, infinite or NaN.
    """
    omega = 2.0 * math.pi * validate.positive("damping.ratio", "frequency", frequency, "Hz")
    return retardation(2.0 * validate.positive("damping.ratio", "zeta", zeta, "-") / omega)


def rayleigh(first: tuple[float, float], second: tuple[float, float]) -> Damping:
    """Decay α and retardation τ that give two frequencies their damping ratios: ζ = ½ (α/ω + τ ω) at both.

    Args:
        first: (ζ, f [Hz]).
        second: the same of another frequency.

    Raises:
        TypeError: not numbers.
        ValueError: frequencies that are equal or not positive, or ratios that would need a negative α or τ.
    """
    right = "(ratio, frequency [Hz]), both positive"
    pairs = [validate.array("damping.rayleigh", n, v, (2,), right) for n, v in (("first", first), ("second", second))]
    for name, pair in zip(("first", "second"), pairs, strict=True):
        if pair.min() <= 0.0:
            raise ValueError(validate.wrong("damping.rayleigh", name, tuple(pair.tolist()), right))
    (z1, w1), (z2, w2) = ((p[0], 2.0 * math.pi * p[1]) for p in pairs)
    if w1 == w2:
        raise ValueError(validate.wrong("damping.rayleigh", "second", second, "of another frequency than first"))
    time = 2.0 * (z2 * w2 - z1 * w1) / (w2**2 - w1**2)
    decay = 2.0 * z1 * w1 - time * w1**2
    if time < 0.0 or decay < 0.0:
        raise ValueError(
            f"damping.rayleigh: {tuple(first)!r} and {tuple(second)!r} need decay {decay:.3g} 1/s and retardation "
            f"{time:.3g} s, but both must not be negative; give ratios that are closer to each other"
        )
    return Damping(retardation=(time,) * 6, decay=decay)


def _semidefinite(value: ArrayLike) -> Array:
    """A symmetric positive semidefinite 6 × 6 matrix, read-only."""
    right = f"a symmetric, positive semidefinite 6 x 6 matrix ({_ROWS})"
    given = validate.array("Damping", "viscosity", value, (6, 6), right)
    diagonal = np.diagonal(given)
    scale = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaled = given / scale[:, None] / scale
    if np.abs(scaled - scaled.T).max() > 1e-9 or np.linalg.eigvalsh(0.5 * (scaled + scaled.T))[0] < -1e-9:
        raise ValueError(validate.wrong("Damping", "viscosity", given.tolist(), right))
    return validate.frozen(0.5 * (given + given.T))
