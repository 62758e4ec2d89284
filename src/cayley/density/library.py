"""A library of densities: the rod with and without shear and stretch, the rigid body, the string."""

from typing import Any

import numpy as np

from cayley.density.expression import dot, norm
from cayley.density.fields import Interval, Rotation, Vector
from cayley.density.lagrangian import lagrangian

E1, E2, E3 = np.eye(3)


@lagrangian(p=Rotation(), x=Vector(3), s=Interval, pose=("p", "x"))
def rod(q: Any, c: Any) -> Any:
    """Geometrically exact (Simo-Reissner) rod.

    L = ½ (m ẋ·ẋ + ω·Jω) − ½ ε·Cε + m g·x,   ε = (Γ, Ω),   Γ = Λ(p)ᵀx′ − e₃        [J/m]

    Constants: mass m [kg/m], inertia J (3×3) [kg m], stiffness C (6×6, order Γ1 Γ2 Γ3 Ω1 Ω2 Ω3) [N, N m²],
    gravity g [m/s²].

    Source: Simo (1985); Leitz, Ober-Blöbaum, Leyendecker (2014), eq. 10.
    """
    strain = np.concatenate([q.p.inverse_rotate(q.x_s) - E3, q.p_s])
    kinetic = 0.5 * c.mass * dot(q.x_t, q.x_t) + 0.5 * dot(q.p_t, c.inertia @ q.p_t)
    return kinetic - 0.5 * dot(strain, c.stiffness @ strain) + c.mass * dot(c.gravity, q.x)


def _no_shear(q: Any, c: Any) -> Any:
    """Γ₁ = Γ₂ = 0: sections stay perpendicular to the axis."""
    return q.p.inverse_rotate(q.x_s)[:2]


def _rigid_axis(q: Any, c: Any) -> Any:
    """Γ = 0: x′ = Λ e₃, no shear and no stretch."""
    return q.p.inverse_rotate(q.x_s) - E3


@lagrangian(p=Rotation(), x=Vector(3), s=Interval, pose=("p", "x"), constraint=_no_shear)
def unshearable_rod(q: Any, c: Any) -> Any:
    """Kirchhoff rod with elastic stretch: Γ₁ = Γ₂ = 0.

    L = ½ (m ẋ·ẋ + ω·Jω) − ½ ε·Cε + m g·x,   ε = (Γ₃, Ω)        [J/m]

    Constants: as of rod, with stiffness C (4×4, order Γ3 Ω1 Ω2 Ω3).

    Source: Antman (2005), Nonlinear Problems of Elasticity, section 8.4.
    """
    strain = np.concatenate([q.p.inverse_rotate(q.x_s)[2:] - 1.0, q.p_s])
    kinetic = 0.5 * c.mass * dot(q.x_t, q.x_t) + 0.5 * dot(q.p_t, c.inertia @ q.p_t)
    return kinetic - 0.5 * dot(strain, c.stiffness @ strain) + c.mass * dot(c.gravity, q.x)


@lagrangian(p=Rotation(), x=Vector(3), s=Interval, pose=("p", "x"), constraint=_rigid_axis)
def inextensible_rod(q: Any, c: Any) -> Any:
    """Inextensible Kirchhoff rod: Γ = 0.

    L = ½ (m ẋ·ẋ + ω·Jω) − ½ Ω·CΩ + m g·x        [J/m]

    Constants: as of rod, with stiffness C (3×3, order Ω1 Ω2 Ω3).

    Source: Antman (2005), Nonlinear Problems of Elasticity, section 8.4.
    """
    kinetic = 0.5 * c.mass * dot(q.x_t, q.x_t) + 0.5 * dot(q.p_t, c.inertia @ q.p_t)
    return kinetic - 0.5 * dot(q.p_s, c.stiffness @ q.p_s) + c.mass * dot(c.gravity, q.x)


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
