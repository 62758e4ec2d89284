"""Lagrangians of every kind the library must take: coupled, gyroscopic, explicit in s and t, of any dimension."""

from typing import Any, NamedTuple

import numpy as np

import cayley as cy
from cayley import densities
from cayley.density.lagrangian import Lagrangian

INERTIA = np.array([[1.2, 0.1, -0.2], [0.1, 0.9, 0.05], [-0.2, 0.05, 1.5]])
STIFFNESS = np.diag([4.0, 5.0, 6.0, 1.0, 2.0, 3.0]) + 0.1


class Example(NamedTuple):
    """A Lagrangian with numbers."""

    lagrangian: Lagrangian
    constants: dict[str, Any]


@cy.lagrangian(x=cy.Vector(1))
def shifted(q, c):
    """A square of 1 + v: its cross term is inertia, its constant is load."""
    return 0.5 * c.m * (1.0 + q.x_t[0]) ** 2 * (1.0 + q.x[0] ** 2)


@cy.lagrangian(x=cy.Vector(3))
def charge(q, c):
    """A charge in a magnetic field, gyroscopic: linear in the velocity."""
    return 0.5 * c.m * q.x_t @ q.x_t + 0.5 * c.e * q.x_t @ cy.cross(c.field, q.x) - c.k * np.exp(-(q.x @ q.x))


@cy.lagrangian(a=cy.Vector(2))
def double_pendulum(q, c):
    """Two angles, coupled through a mass matrix that depends on them."""
    a, b = q.a
    u, v = q.a_t
    kinetic = u**2 + 0.5 * v**2 + u * v * np.cos(a - b)
    return c.m * c.l**2 * kinetic + c.m * c.g * c.l * (2.0 * np.cos(a) + np.cos(b))


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3))
def offset_body(q, c):
    """A body whose mass center is not its reference point: ẋ meets ω through the frame."""
    along = q.p.rotate(cy.cross(q.p_t, c.center))
    kinetic = 0.5 * c.m * q.x_t @ q.x_t + c.m * q.x_t @ along + 0.5 * q.p_t @ c.inertia @ q.p_t
    return kinetic - c.m * c.g * (q.x[2] + q.p.rotate(c.center)[2])


@cy.lagrangian(p=cy.Rotation(), r=cy.Rotation())
def two_bodies(q, c):
    """Two rotations: a joint stiffness and an inertia that couples their velocities."""
    relative = q.p.inverse_rotate(q.r.rotate(q.r_t)) - q.p_t
    hinge = cy.dot(q.p.rotate(c.axis), q.r.rotate(c.axis))
    return (
        0.5 * q.p_t @ c.inertia @ q.p_t + c.m * relative @ relative + c.k * hinge**2 + c.k * (q.p.T @ q.r.matrix)[0, 1]
    )


@cy.lagrangian(p=cy.Rotation())
def quartic_top(q, c):
    """Kinetic energy that is not quadratic in ω, and one that knows its frame."""
    w = q.p_t
    return (
        0.5 * w @ c.inertia @ w + c.quartic * (w @ w) ** 2 + 0.1 * (q.p @ w)[2] ** 2 - c.weight * q.p[2, 2] + c.spin @ w
    )


@cy.lagrangian(p=cy.Rotation())
def gyrostat(q, c):
    """A body with a flywheel: a term linear in ω, and nothing that knows the frame."""
    return 0.5 * q.p_t @ c.inertia @ q.p_t + c.spin @ q.p_t


@cy.lagrangian(p=cy.Rotation())
def quartic_spin(q, c):
    """A momentum that is not linear in ω, without the frame."""
    return 0.5 * q.p_t @ c.inertia @ q.p_t + c.quartic * (q.p_t @ q.p_t) ** 2


@cy.lagrangian(p=cy.Rotation(), r=cy.Rotation())
def coupled_spins(q, c):
    """Two rotations whose body velocities share a kinetic energy, without their frames."""
    return 0.5 * q.p_t @ c.inertia @ q.p_t + 0.5 * q.r_t @ c.inertia @ q.r_t + 0.3 * q.p_t @ c.inertia @ q.r_t


@cy.lagrangian(x=cy.Vector(1))
def driven(q, c):
    """Explicit in time, in the inertia as well as in the load."""
    return 0.5 * c.m * (2.0 + np.sin(q.t)) * q.x_t[0] ** 2 + c.f * np.cos(3.0 * q.t) * q.x[0] + q.t * q.x_t[0]


@cy.lagrangian(x=cy.Vector(2), y=cy.Vector(1), z=cy.Vector(5), s=cy.Interval)
def mixed(q, c):
    """Fields of several dimensions, explicit in s and t, with strain, load and their products."""
    kinetic = 0.5 * c.m * (1.0 + q.s**2) * (q.x_t @ q.x_t + q.y_t @ q.y_t + q.z_t @ c.inertia @ q.z_t)
    strain = 0.5 * (q.x_s @ q.x_s) * (2.0 + np.sin(q.y[0])) + np.exp(-q.t) * q.z_s @ q.z_s + q.y_s[0] * q.x[1] * q.s
    return kinetic - strain - c.k * np.log(2.0 + q.z @ q.z) * q.t + q.x[0] * q.z[4] * q.s


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), s=cy.Interval)
def bent(q, c):
    """A rod whose strain meets values: curvature against position, a load along the turned tangent."""
    gamma = q.p.inverse_rotate(q.x_s) - cy.E3
    kinetic = 0.5 * c.m * q.x_t @ q.x_t + 0.5 * q.p_t @ c.inertia @ q.p_t + q.p_t @ q.p.inverse_rotate(q.x_t) * 0.1
    stored = gamma @ gamma * (1.0 + 0.2 * q.p_s @ q.p_s) + (q.p_s @ q.p.inverse_rotate(q.x)) ** 2 + q.p_s @ q.p_s
    return kinetic - c.k * stored + np.where(q.x[2] > 0.0, q.x[2] ** 2, 0.0) + c.k * q.p.matrix[1, 2]


ROD = Example(
    densities.rod,
    dict(mass=0.7, inertia=INERTIA, stiffness=STIFFNESS, gravity=np.array([0.3, -0.2, -9.81])),
)
STRING = Example(densities.string, dict(mass=0.1, stiffness=20.0, gravity=np.array([0.0, 0.0, -9.81])))
BODY = Example(densities.rigid_body, dict(mass=2.0, inertia=INERTIA, gravity=np.array([0.0, 0.0, -9.81])))

EXAMPLES = {
    "rod": ROD,
    "string": STRING,
    "rigid_body": BODY,
    "shifted": Example(shifted, dict(m=1.3)),
    "charge": Example(charge, dict(m=1.1, e=0.8, k=0.5, field=np.array([0.2, -0.4, 1.0]))),
    "double_pendulum": Example(double_pendulum, dict(m=1.5, l=0.7, g=9.81)),
    "offset_body": Example(offset_body, dict(m=1.2, inertia=2 * INERTIA, g=9.81, center=np.array([0.1, 0.2, -0.3]))),
    "two_bodies": Example(two_bodies, dict(m=0.3, k=2.0, inertia=INERTIA, axis=np.array([0.6, 0.0, 0.8]))),
    "quartic_top": Example(
        quartic_top, dict(inertia=INERTIA, quartic=0.05, weight=3.0, spin=np.array([0.3, 0.1, -0.5]))
    ),
    "gyrostat": Example(gyrostat, dict(inertia=INERTIA, spin=np.array([0.3, 0.1, -0.5]))),
    "quartic_spin": Example(quartic_spin, dict(inertia=INERTIA, quartic=0.05)),
    "coupled_spins": Example(coupled_spins, dict(inertia=INERTIA)),
    "driven": Example(driven, dict(m=1.0, f=2.0)),
    "mixed": Example(mixed, dict(m=0.9, k=1.4, inertia=np.diag([1.0, 2.0, 3.0, 4.0, 5.0]))),
    "bent": Example(bent, dict(m=0.8, k=1.7, inertia=INERTIA)),
}


def rod_strain(q, c):
    """W of the rod; those below, the other densities on an interval."""
    strain = np.concatenate([q.p.inverse_rotate(q.x_s) - cy.E3, q.p_s])
    return 0.5 * strain @ c.stiffness @ strain


def mixed_strain(q, c):
    stretch = 0.5 * q.x_s @ q.x_s * (2.0 + np.sin(q.y[0]))
    return stretch + np.exp(-q.t) * q.z_s @ q.z_s + q.y_s[0] * q.x[1] * q.s


def bent_strain(q, c):
    gamma = q.p.inverse_rotate(q.x_s) - cy.E3
    bending = (q.p_s @ q.p.inverse_rotate(q.x)) ** 2 + q.p_s @ q.p_s
    return c.k * (gamma @ gamma * (1.0 + 0.2 * q.p_s @ q.p_s) + bending)


STRAIN = {
    "rod": rod_strain,
    "string": lambda q, c: 0.5 * c.stiffness * (np.linalg.norm(q.x_s) - 1.0) ** 2,
    "mixed": mixed_strain,
    "bent": bent_strain,
}
