"""Free of locking: the errors of a clamped rod against Timoshenko's do not know how slender it is."""

import functools

import numpy as np
import pytest

import cayley as cy
from reference import timoshenko
from reference.straight_rod import slender
from verify.problems import fitted

galerkin = cy.rules.galerkin
ELEMENTS = {1: 10, 2: 4, 3: 4}
SLENDERNESS = (10, 100, 1000, 10_000)
BOUNDS = {1: 0.1, 2: 2e-3, 3: 1e-5}
"""Of the relative error of a frequency, times (k ds)^(2m) with k = √Ω/l the wave number of a slender rod."""
RULES = [
    *(cy.rules.verlet, cy.rules.midpoint, cy.rules.screw, cy.rules.screw_midpoint),
    *(galerkin(time=1, space=m) for m in ELEMENTS),
]
every_rule = pytest.mark.parametrize("rule", RULES, ids=str)


@functools.cache
def errors(rule, slenderness, elements):
    """Relative errors of the tip deflection and of three frequencies; slenderness is l √(A/I)."""
    section = slender(2.0 / slenderness)
    rod = cy.Rod(section, length=1.0, elements=elements)
    still = cy.equilibrium(cy.Model(rod, supports=[cy.supports.clamp(rod.start)]), rule=rule).still
    layout = still.system.layout
    along, about = (still.dofs[1:, k] for k in (layout.dofs_of("x").start + 1, layout.dofs_of("p").start))
    plane = np.ix_(np.r_[along, about], np.r_[along, about])
    flexibility = np.linalg.inv(-still.matrix(0).toarray()[plane])  # whose largest eigenvalues survive rounding
    root = np.sqrt(-still.matrix(2).toarray()[plane].diagonal())
    tip = len(along) - 1
    squares = np.linalg.eigvalsh(0.5 * root[:, None] * (flexibility + flexibility.T) * root)[::-1][:3]
    deflection = flexibility[tip, tip] / timoshenko.tip_compliance(section, 1.0) - 1.0
    return deflection, squares**-0.5 / timoshenko.frequencies(section, 1.0) - 1.0


def rounding(slenderness):
    """What the stiffness of a slender rod loses, some ε GA l²/EI."""
    return 1e-14 * slenderness**2


@pytest.mark.parametrize(
    ("radius", "expected"),
    [
        (0.02, (3.502641, 21.469824, 58.149832)),
        (0.04, (3.463579, 20.014730, 50.561942)),
        (0.08, (3.321388, 16.233135, 36.534573)),
        (1e-4, (3.516015, 22.034477, 61.697116)),
    ],
)
def test_closed_form(radius, expected):
    """Of Timoshenko's frequencies: those of an independent program, and Euler's and Bernoulli's in the limit."""
    section = slender(2.0 * radius)
    unit = np.sqrt(section.stiffness[3, 3] / section.mass_per_length)
    np.testing.assert_allclose(timoshenko.frequencies(section, 1.0) / unit, expected, rtol=2e-7)


@every_rule
@pytest.mark.parametrize("slenderness", SLENDERNESS)
def test_tip_deflection(rule, slenderness):
    """Short by 1/(4 n²) of bending for two-node elements, exact for longer ones, at any slenderness."""
    elements, section = ELEMENTS[rule.degree], slender(2.0 / slenderness)
    bending = 1.0 / (3.0 * section.stiffness[3, 3]) / timoshenko.tip_compliance(section, 1.0)
    expected = -0.25 / elements**2 * bending if rule.degree == 1 else 0.0
    assert abs(errors(rule, slenderness, elements)[0] - expected) < rounding(slenderness)


@every_rule
def test_frequencies(rule):
    """Within the order of the mesh at every slenderness, and the same at any above 100."""
    elements, degree = ELEMENTS[rule.degree], rule.degree
    wave = np.sqrt([3.516015, 22.034477, 61.697116]) / elements
    limit = errors(rule, 1000, elements)[1]
    for slenderness in SLENDERNESS:
        found = errors(rule, slenderness, elements)[1]
        assert np.all(np.abs(found) < BOUNDS[degree] * wave ** (2 * degree) + rounding(slenderness)), found
        if slenderness >= 100:
            assert np.all(np.abs(found - limit) < 0.15 * np.abs(limit) + rounding(slenderness)), (found, limit)


@pytest.mark.parametrize("slenderness", [10, 100])
@pytest.mark.parametrize(("degree", "meshes"), [(1, (20, 28, 40, 56)), (2, (8, 12, 16, 20)), (3, (8, 10, 12, 14))])
def test_order_of_frequencies(degree, meshes, slenderness):
    """2m in the second and third frequency, thick rod or wire."""
    rule = galerkin(time=1, space=degree)
    found = np.array([np.abs(errors(rule, slenderness, n)[1][1:]) for n in meshes])
    assert found.min() > 3.0 * rounding(slenderness), found
    for mode in range(2):
        assert abs(fitted(1.0 / np.array(meshes), found[:, mode]) - 2 * degree) < 0.2, found


def test_nodal_locks():
    """A rule that locks is told by the same means: at 1e4 the paper's bends a hundred-thousandth of what it should."""
    assert errors(cy.rules.nodal, 10_000, 10)[0] < -0.9999
