"""A straight clamped rod, linearized in its plane: stiffness and mass matrices from the discrete equations."""

import casadi as ca
import numpy as np
from scipy.linalg import eigh

import cayley as cy
from cayley.density import library, trace
from cayley.density.expression import symbols, to_sx, wrap
from cayley.discrete.element import element_forces
from cayley.discrete.equations import derive

STIFFENING = {"nodal": 4.0, "verlet": np.inf}
"""The divisor of GA ds² in the bending stiffness that a rule shows."""


def slender(radius):
    material = cy.Material(density=1000.0, youngs_modulus=2.6e6, poisson_ratio=0.3)
    return cy.Section.circle(radius, material, shear_correction=5.0 / 6.0)


def stiffnesses(section):
    """(EI, κGA) of bending about d1."""
    return section.stiffness[3, 3], section.stiffness[1, 1]


def plane_matrices(section, length, elements, rule):
    """Stiffness and lumped mass of a straight rod clamped at s = 0: w along d2 and θ about d1 of the other nodes."""
    constants = {
        "mass": section.mass_per_length,
        "inertia": section.inertia,
        "stiffness": section.stiffness,
        "gravity": np.zeros(3),
    }
    density = trace(library.rod, constants)
    layout = derive(density, rule).layout
    ends = symbols("a", layout.rows), symbols("b", layout.rows)
    names = {n: wrap(ca.SX.sym(n)) for n in ("inverse", "left", "right", "t")}
    forces = element_forces(density, rule.strain, layout, ends, names)
    z = np.zeros((2, layout.rows))
    z[:, layout.rows_of("p")] = (1, 0, 0, 0)
    z[1, layout.rows_of("x")] = (0, 0, length / elements)
    inputs = [*ends, *names.values()]
    jacobian = ca.jacobian(ca.vertcat(*[to_sx(f) for f in forces]), ca.vertcat(*[to_sx(e) for e in ends]))
    numbers = [*z.ravel(), elements / length, 0.0, 0.0, 0.0]
    function = ca.Function("k", [ca.vertcat(*[to_sx(i) for i in inputs]), density.parameters], [ca.densify(jacobian)])
    tangent = np.zeros((layout.rows, 2))  # of w and of θ, with δp = ½ p θ e1
    tangent[layout.rows_of("x").start + 1, 0], tangent[layout.rows_of("p").start + 1, 1] = 1.0, 0.5
    picked = [layout.dofs_of("x").start + 1, layout.dofs_of("p").start]
    pick = [*picked, *(layout.dofs + i for i in picked)]
    ds = length / elements
    element = -ds * np.array(function(numbers, density.values))[pick] @ np.kron(np.eye(2), tangent)
    stiffness = np.zeros((2 * elements + 2, 2 * elements + 2))
    for e in range(elements):
        stiffness[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += element
    weight = np.full(elements + 1, ds)
    weight[[0, -1]] *= 0.5
    mass = np.kron(weight, [section.mass_per_length, section.inertia[0, 0]])
    return stiffness[2:, 2:], mass[2:]


def frequencies(section, length, elements, rule):
    """Angular frequencies [rad/s], ascending."""
    stiffness, mass = plane_matrices(section, length, elements, rule)
    return np.sqrt(eigh(stiffness, np.diag(mass), eigvals_only=True))


def tip_compliance(section, length, elements, rule):
    """Deflection of the tip under a unit force there [m/N]."""
    stiffness, _ = plane_matrices(section, length, elements, rule)
    return np.linalg.solve(stiffness, np.eye(2 * elements)[-2])[-2]


def predicted_compliance(section, length, elements, rule):
    """l³/(3 (EI + GA ds²/4)) (1 − 1/(4 n²)) + l/(κGA) [m/N], the last factor of the first for a chain of n bars."""
    bending, shear = stiffnesses(section)
    shown = bending + shear * (length / elements) ** 2 / STIFFENING[rule.name]
    return length**3 * (1.0 - 0.25 / elements**2) / (3.0 * shown) + length / shear
