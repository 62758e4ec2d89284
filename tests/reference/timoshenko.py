"""Timoshenko's clamped rod in closed form: tip deflection and frequencies."""

import numpy as np
from scipy.optimize import brentq


def tip_compliance(section, length):
    """l³/(3 EI) + l/(κGA) [m/N]."""
    return length**3 / (3.0 * section.stiffness[3, 3]) + length / section.stiffness[1, 1]


def frequencies(section, length, count=3):
    """The lowest angular frequencies [rad/s] of bending about d1.

    With Ω = ω √(m l⁴/EI), g = EI/(κGA l²), j = J/(m l²): w is made of e^(±a s/l) and e^(±i c s/l),
    a² = √(H² + Ω² − Ω⁴ g j) − H, c² = a² + 2 H, H = Ω² (g + j)/2; clamped at s = 0, no moment and no force at s = l.
    """
    bending, shear = section.stiffness[3, 3], section.stiffness[1, 1]
    g = bending / (shear * length**2)
    j = section.inertia[0, 0] / (section.mass_per_length * length**2)

    def determinant(omega):
        half, square = 0.5 * omega**2 * (g + j), omega**2
        root = np.sqrt(half**2 + square * (1.0 - square * g * j))
        a, c = np.sqrt(root - half), np.sqrt(root + half)
        ka, kc = a + g * square / a, c - g * square / c  # θ of cosh and of cos, per unit
        moment = ka * a * np.cosh(a) + kc * c * np.cos(c), ka * (a * np.sinh(a) + c * np.sin(c))
        force = np.sin(c) / c - np.sinh(a) / a, -np.cosh(a) / a - ka / kc * np.cos(c) / c
        return moment[0] * force[1] - moment[1] * force[0]

    grid = np.linspace(0.5, min(65.0, 0.99 / np.sqrt(g * j)), 500)  # below the second spectrum
    signs = np.sign([determinant(omega) for omega in grid])
    changes = np.flatnonzero(signs[1:] != signs[:-1])[:count]
    found = [brentq(determinant, grid[k], grid[k + 1], xtol=1e-12, rtol=1e-13) for k in changes]
    return np.array(found) * np.sqrt(bending / section.mass_per_length) / length**2
