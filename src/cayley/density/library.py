"""A library of densities: the rod with and without shear and stretch, the rigid body, the string."""

from typing import Any

import numpy as np

from cayley.density.expression import cross, dot, norm
from cayley.density.fields import Interval, Rotation, Vector
from cayley.density.lagrangian import lagrangian

E1, E2, E3 = np.eye(3)

_CENTERED_AND_STRAIGHT = {"first_moment": np.zeros(3), "reference": np.zeros(6)}


def _kinetic(q: Any, c: Any) -> Any:
    """½ m ẋ·ẋ + ½ ω·Jω + Λᵀẋ·(ω × S): with S = m (mass center), the kinetic energy of a section at its axis."""
    centered = 0.5 * c.mass * dot(q.x_t, q.x_t) + 0.5 * dot(q.p_t, c.inertia @ q.p_t)
    return centered + dot(q.p.inverse_rotate(q.x_t), cross(q.p_t, c.first_moment))


def _weight(q: Any, c: Any) -> Any:
    """g·(m x + ΛS): gravity acts at the mass center."""
    return c.mass * dot(c.gravity, q.x) + dot(q.p.inverse_rotate(c.gravity), c.first_moment)


def _strain(q: Any, c: Any) -> Any:
    """ε − ε₀ = (Λᵀx′ − e₃, Ω) − ε₀, all six."""
    return np.concatenate([q.p.inverse_rotate(q.x_s) - E3, q.p_s]) - c.reference


@lagrangian(p=Rotation(), x=Vector(3), s=Interval, pose=("p", "x"), defaults=_CENTERED_AND_STRAIGHT)
def rod(q: Any, c: Any) -> Any:
    """Geometrically exact (Simo-Reissner) rod.

    L = ½ (m ẋ·ẋ + ω·Jω) + Λᵀẋ·(ω × S) − ½ (ε − ε₀)·C(ε − ε₀) + g·(m x + ΛS),   ε = (Γ, Ω),   Γ = Λ(p)ᵀx′ − e₃   [J/m]

    Constants: mass m [kg/m], inertia J about the axis (3×3) [kg m], stiffness C (6×6, order Γ1 Γ2 Γ3 Ω1 Ω2 Ω3), in N,
    N m and N m², gravity g [m/s²]; and, zero if left out, first_moment S = m (mass center, from the axis, in the body)
    [kg], and reference ε₀, the strain that is free of stress (6).

    Source: Simo (1985); Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 10.
    """
    strain = _strain(q, c)
    return _kinetic(q, c) - 0.5 * dot(strain, c.stiffness @ strain) + _weight(q, c)


def _no_shear(q: Any, c: Any) -> Any:
    """Γ₁ and Γ₂ are those of the reference: sections keep their angle to the axis."""
    return _strain(q, c)[:2]


def _rigid_axis(q: Any, c: Any) -> Any:
    """Γ is that of the reference: no shear and no stretch."""
    return _strain(q, c)[:3]


@lagrangian(
    p=Rotation(),
    x=Vector(3),
    s=Interval,
    pose=("p", "x"),
    constraint=_no_shear,
    defaults=_CENTERED_AND_STRAIGHT,
)
def unshearable_rod(q: Any, c: Any) -> Any:
    """Kirchhoff rod with elastic stretch: Γ₁ = Γ₂ = 0, or as in the reference.

    L = that of rod with ε = (Γ₃, Ω)        [J/m]

    Constants: as of rod, with stiffness C (4×4, order Γ3 Ω1 Ω2 Ω3); reference has all six entries.

    Source: Antman (2005), Nonlinear Problems of Elasticity, section 8.4.
    """
    strain = _strain(q, c)[2:]
    return _kinetic(q, c) - 0.5 * dot(strain, c.stiffness @ strain) + _weight(q, c)


@lagrangian(
    p=Rotation(),
    x=Vector(3),
    s=Interval,
    pose=("p", "x"),
    constraint=_rigid_axis,
    defaults=_CENTERED_AND_STRAIGHT,
)
def inextensible_rod(q: Any, c: Any) -> Any:
    """Inextensible Kirchhoff rod: Γ = 0, or as in the reference.

    L = that of rod with ε = Ω        [J/m]

    Constants: as of rod, with stiffness C (3×3, order Ω1 Ω2 Ω3); reference has all six entries.

    Source: Antman (2005), Nonlinear Problems of Elasticity, section 8.4.
    """
    strain = _strain(q, c)[3:]
    return _kinetic(q, c) - 0.5 * dot(strain, c.stiffness @ strain) + _weight(q, c)


@lagrangian(p=Rotation(), x=Vector(3))
def rigid_body(q: Any, c: Any) -> Any:
    """Rigid body about its mass center.

    L = ½ (m ẋ·ẋ + ω·Jω) + m g·x        [J]

    Constants: mass m [kg], inertia J (3×3, body frame) [kg m²], gravity g [m/s²].

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 10, without strain.
    """
    kinetic = 0.5 * c.mass * dot(q.x_t, q.x_t) + 0.5 * dot(q.p_t, c.inertia @ q.p_t)
    return kinetic + c.mass * dot(c.gravity, q.x)


@lagrangian(x=Vector(3), s=Interval)
def string(q: Any, c: Any) -> Any:
    """Elastic string: it resists stretch only.

    L = ½ m ẋ·ẋ − ½ k (‖x′‖ − 1)² + m g·x        [J/m]

    Constants: mass m [kg/m], stiffness k [N], gravity g [m/s²].

    Source: Antman (2005), Nonlinear Problems of Elasticity, chapter 2.
    """
    kinetic = 0.5 * c.mass * dot(q.x_t, q.x_t)
    return kinetic - 0.5 * c.stiffness * (norm(q.x_s) - 1.0) ** 2 + c.mass * dot(c.gravity, q.x)
