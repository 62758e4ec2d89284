"""Columns of all four ends against the closed forms of a rod with shear and stretch, and beyond, against the elastica.

EI k² = P (1 − P/EA + P/GA), with k L = π/2, π, 2π, or for one clamped and one pinned end
tan kL = kL (1 − P/EA)/(1 − P/EA + P/GA): the column of J. A. Haringx (1942), with the shortening before it buckles; see
Z. P. Bažant and L. Cedolin, Stability of Structures (2010), section 1.7.
"""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

import cayley as cy
from cayley import loads, supports

EI, GA, EA = 1.0, 2000.0, 4000.0


def column(ends, elements, *, stiff=1.0):
    stiffness = np.diag([stiff * GA, stiff * GA, stiff * EA, 2.0 * EI, EI, EI])
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=np.diag([1e-3, 1e-3, 2e-3]))
    rod = cy.Rod(section, length=1.0, direction=(0, 0, 1), elements=elements, name="rod")
    clamp = supports.clamp(rod.start)
    held = {
        "free": [clamp],
        "pinned": [
            supports.hold(rod.start, position="xyz", rotation="xz"),
            supports.hold(rod.end, position="xy", rotation="xz"),
        ],
        "clamped": [clamp, supports.hold(rod.end, position="xy", rotation="xyz")],
        "propped": [clamp, supports.hold(rod.end, position="xy", rotation="xz")],
    }
    push = loads.force(rod.end, (0, 0, -1.0))
    return cy.Model(rod, supports=held[ends], loads=[push]), push, rod


def exact(ends):
    def wave(load):
        return np.sqrt(load * (1.0 - load / EA + load / GA) / EI)

    if ends == "propped":

        def zero(load):
            k, shortened = wave(load), 1.0 - load / EA
            return np.sin(k) - np.cos(k) * k * shortened / (shortened + load / GA)

        return brentq(zero, 17.0, 22.0)
    return brentq(lambda load: wave(load) - {"free": 0.5, "pinned": 1.0, "clamped": 2.0}[ends] * np.pi, 0.1, 60.0)


@pytest.mark.parametrize("rule", [cy.rules.midpoint, cy.rules.screw], ids=str)
@pytest.mark.parametrize("ends", ["free", "pinned", "clamped", "propped"])
def test_critical_loads_of_columns(ends, rule):
    """8 and 16 elements, extrapolated; linear buckling about the straight column under 95 % of the load."""
    load, found = exact(ends), []
    for elements in (8, 16):
        model, push, _ = column(ends, elements)
        path = cy.trace(model, push, range=(0.9 * load, 1.15 * load), rule=rule, step=0.2)
        linear = cy.buckling(model, push, about=0.95 * load, rule=rule)
        assert [one.kind for one in path.critical] == ["bifurcation"]
        assert list(np.unique(path.unstable)) == [0, 1]
        found.append([path.bifurcations[0].parameter, linear.factors[0]])
    coarse, fine = np.array(found)
    assert fine == pytest.approx(load, rel=3e-2)
    assert (4.0 * fine - coarse) / 3.0 == pytest.approx(load, rel=2.5e-3 if ends == "clamped" else 7e-4)
    assert fine[1] == pytest.approx(fine[0], rel=2e-4)


def test_a_column_of_high_degree_meets_the_closed_form():
    """4 elements of degree 3."""
    for ends in ("free", "pinned", "propped"):
        model, push, _ = column(ends, 4)
        rule = cy.rules.galerkin(time=1, space=3)
        path = cy.trace(model, push, range=(0.9 * exact(ends), 1.1 * exact(ends)), rule=rule, step=0.2)
        assert path.bifurcations[0].parameter == pytest.approx(exact(ends), rel=1e-4), ends


def test_the_mode_of_a_column():
    model, push, rod = column("pinned", 16)
    path = cy.trace(model, push, range=(8.0, 11.0), step=0.2)
    wave = np.sin(np.pi * rod.nodes)
    for mode in (path.mode(path.bifurcations[0]), cy.buckling(model, push).modes[0]):
        shape = mode[rod].displacement.values
        assert shape[:, 0] == pytest.approx(wave, abs=1e-4)
        assert np.abs(shape[:, 1:]).max() < 1e-6


def test_the_buckled_column_is_the_elastica():
    """Clamped at both ends, 8 elements of degree 3, nearly rigid in stretch: √(P/EI) L = 4 K(k), chord 2 E/K − 1."""
    model, push, rod = column("clamped", 8, stiff=500.0)
    rule = cy.rules.galerkin(time=1, space=3)
    straight = cy.trace(model, push, range=(38.0, 41.0), rule=rule, step=0.2)
    sides = []
    for direction in (1, -1):
        branch = straight.branch(direction=direction, range=(30.0, 60.0), step=0.2)
        position = branch[rod].position.values
        beside = position[:, :, 0]
        sides.append(beside[-1])
        for k in range(1, len(branch)):
            whole = 0.25 * np.sqrt(branch.parameter[k] / EI)
            m = brentq(lambda m, whole=whole: ellipk(m) - whole, 1e-9, 0.99)
            assert position[k, -1, 2] == pytest.approx(2.0 * ellipe(m) / whole - 1.0, abs=4e-4)
            assert np.abs(beside[k]).max() == pytest.approx(np.sqrt(m) / whole, abs=5e-4)
        assert np.all(branch.unstable[1:] == 0)
        assert len(branch) > 5
    assert sides[0] == pytest.approx(-sides[1], abs=1e-6)


def test_a_column_buckles_under_its_own_weight():
    """ρA g L³/EI = 7.837347, the first root of J₋₁⸝₃(⅔ √x) (A. G. Greenhill, 1881), gravity as the parameter."""
    rod = column("free", 4, stiff=50.0)[2]
    weight = loads.gravity((0, 0, -1.0))
    bob = cy.PointMass(mass=1.0, position=(1, 0, 0), name="bob")
    hung = cy.springs.linear(bob.centre, cy.ground.at((1, 0, 1)), stiffness=100.0)
    sides = supports.hold(bob.centre, position="xy")
    model = cy.Model(rod, bob, supports=[supports.clamp(rod.start), sides], springs=[hung], loads=[weight])
    rule = cy.rules.galerkin(time=1, space=3)
    path = cy.trace(model, weight, range=(0.0, 9.0), rule=rule, step=0.2)
    assert [one.parameter for one in path.bifurcations] == pytest.approx([7.837347], rel=1e-4)
    assert cy.buckling(model, weight, rule=rule).factors == pytest.approx([7.837347], rel=1e-3)
    assert path[bob].position.values[:, 2] == pytest.approx(-path.parameter / 100.0, abs=1e-9)
