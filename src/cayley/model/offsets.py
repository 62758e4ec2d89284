"""Sections whose mass center or shear center lies beside the axis."""

from __future__ import annotations

from typing import Any

import numpy as np

from cayley.model import validate
from cayley.model.validate import Array

MASS_ROWS = "velocity 1, 2, 3, angular velocity 1, 2, 3 [kg/m, kg, kg m]"
INERTIA_ROWS = "about e1, e2, e3 [kg m]"


def moved_shear(stiffness: Array, center: tuple[float, float]) -> Array:
    """Stiffness at the axis of one whose shear and twist are about a center a.

    Γ at the center = (Γ1 − a2 Ω3, Γ2 + a1 Ω3, Γ3)
    """
    shift = np.eye(6)
    shift[0, 5], shift[1, 5] = -center[1], center[0]
    moved: Array = shift.T @ stiffness @ shift
    return 0.5 * (moved + moved.T)


def section_inertia(
    owner: str, mass_per_length: Any, inertia: Any, mass: Any, mass_center: Any
) -> tuple[float, Array, Array]:
    """Mass per length, mass center (3,) and inertia about the axis, from one way or the other."""
    if mass is None:
        if mass_per_length is None or inertia is None:
            raise ValueError(f"{owner}: mass_per_length or inertia is missing; give both, or mass (6 x 6)")
        m = validate.positive(owner, "mass_per_length", mass_per_length, "kg/m")
        about = validate.positive_definite(owner, "inertia", inertia, 3, INERTIA_ROWS)
        center = np.array([*pair(owner, "mass_center", mass_center), 0.0])
        return m, center, about + m * (center @ center * np.eye(3) - np.outer(center, center))
    if mass_per_length is not None or inertia is not None or any(pair(owner, "mass_center", mass_center)):
        raise ValueError(f"{owner}: mass is given beside mass_per_length, inertia or mass_center; give one of the two")
    whole = validate.positive_definite(owner, "mass", mass, 6, MASS_ROWS)
    m = float(whole[0, 0])
    s1, s2 = float(whole[1, 5]), -float(whole[0, 5])
    coupled = np.array([[0.0, 0.0, -s2], [0.0, 0.0, s1], [s2, -s1, 0.0]])
    scale = float(np.sqrt(m * whole[3:, 3:].trace()))
    same = np.abs(whole[:3, :3] - m * np.eye(3)).max() <= 1e-9 * m
    if not same or np.abs(whole[:3, 3:] - coupled).max() > 1e-9 * scale:
        right = "that of a body: ((m 1, -hat S), (hat S, J)) with S = m (c1, c2, 0)"
        raise ValueError(validate.wrong(owner, "mass", mass, right))
    return m, np.array([s1, s2, 0.0]) / m, whole[3:, 3:].copy()


def pair(owner: str, name: str, value: Any) -> tuple[float, float]:
    """Two finite numbers."""
    first, second = validate.array(owner, name, value, (2,), "2 finite numbers (along e1, e2) [m]").tolist()
    return (first, second)


__all__ = ["INERTIA_ROWS", "moved_shear", "pair", "section_inertia"]
