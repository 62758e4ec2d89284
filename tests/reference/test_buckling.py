"""Frames, narrow beams, twisted rods, trusses and toggles that buckle or snap through."""

import numpy as np
import pytest

import cayley as cy
from cayley import joints, loads, springs, supports

CUBIC = cy.rules.galerkin(time=1, space=3)


def section(*stiffness):
    return cy.Section.given(stiffness=np.diag(stiffness), mass_per_length=1.0, inertia=np.diag([1e-3, 1e-3, 2e-3]))


def test_argyris_right_angle_frame():
    """Two legs of 8 elements: 1.088 N (J. H. Argyris et al., 1979; K. Nachbagauer, 2013), here to 0.3 %."""
    young, shear, height, width = 7.124e10, 7.124e10 / 2.62, 0.03, 0.0006
    area, weak, strong = height * width, height * width**3 / 12, width * height**3 / 12
    blade = cy.Section.given(
        stiffness=np.diag(
            [shear * area, shear * area, young * area, young * weak, young * strong, shear * height * width**3 / 3]
        ),
        mass_per_length=2700.0 * area,
        inertia=2700.0 * np.diag([weak, strong, weak + strong]),
    )
    first = cy.Rod(blade, length=0.24, direction=(1, 0, 0), normal=(0, 1, 0), elements=8, name="first")
    second = cy.Rod(
        blade, length=0.24, origin=(0.24, 0, 0), direction=(0, -1, 0), normal=(1, 0, 0), elements=8, name="second"
    )
    load = loads.force(second.end, (1.0, 0.0, 0.0))
    corner = joints.weld(first.end, second.start)
    model = cy.Model(first, second, supports=[supports.clamp(first.start)], joints=[corner], loads=[load])
    path = cy.trace(model, load, range=(0.0, 2.0), step=0.2)
    assert [one.parameter for one in path.bifurcations] == pytest.approx([1.088], rel=3e-3)
    assert cy.buckling(model, load).factors == pytest.approx([1.088], rel=3e-3)
    mode = path.mode(path.bifurcations[0])["second"].displacement.values
    assert np.abs(mode[:, :2]).max() < 0.01 * np.abs(mode[:, 2]).max()


def test_a_narrow_cantilever_tips_over():
    """P L² = 4.0126 √(EI GJ) (L. Prandtl, A. G. M. Michell, 1899), 4 elements of degree 3."""
    rod = cy.Rod(section(1e6, 1e6, 1e7, 1.0, 1e6, 0.7), length=1.0, direction=(1, 0, 0), elements=4, name="rod")
    load = loads.force(rod.end, (0, 0, -1.0))
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[load])
    wanted = 4.01260 * np.sqrt(0.7)
    path = cy.trace(model, load, range=(0.0, 5.0), rule=CUBIC, step=0.2)
    assert [one.parameter for one in path.bifurcations] == pytest.approx([wanted], rel=1e-4)
    assert cy.buckling(model, load, rule=CUBIC).factors == pytest.approx([wanted], rel=1e-4)


@pytest.mark.parametrize("thrust", [0.0, 5.0])
def test_a_twisted_shaft(thrust):
    """(M L/2πEI)² + P L²/π²EI = 1 (A. G. Greenhill, 1883), ends free to turn to any side, 4 elements of degree 3."""
    rod = cy.Rod(section(1e5, 1e5, 1e5, 1.0, 1.0, 0.8), length=1.0, direction=(0, 0, 1), elements=4, name="rod")
    twist = [loads.moment(rod.end, (0, 0, 1.0)), loads.moment(rod.start, (0, 0, -1.0))]
    held = [
        supports.pin(rod.start),
        supports.hold(rod.end, position="xy"),
        supports.hold(rod.node(2), rotation="z"),
    ]
    model = cy.Model(rod, supports=held, loads=[*twist, loads.force(rod.end, (0, 0, -thrust))])
    wanted = 2.0 * np.pi * np.sqrt(1.0 - thrust / np.pi**2)
    path = cy.trace(model, twist, range=(0.0, 1.05 * wanted), rule=CUBIC, turn=2.0, step=0.5)
    assert path.bifurcations[0].parameter == pytest.approx(wanted, rel=1e-4)
    assert path.bifurcations[0].change == 2
    assert cy.buckling(model, twist, about=0.9 * wanted, rule=CUBIC).factors == pytest.approx([wanted], rel=1e-4)


def test_a_twisted_rod_with_clamped_ends():
    """M L/EI = 8.98682, the first root of tan x/2 = x/2 (A. G. Greenhill, 1883), 8 elements of degree 3."""
    rod = cy.Rod(section(1e5, 1e5, 1e5, 1.0, 1.0, 0.8), length=1.0, direction=(0, 0, 1), elements=8, name="rod")
    turned = joints.cylindrical(rod.end, cy.ground, axis=(0, 0, 1), angle=lambda t: t, name="chuck")
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], joints=[turned])
    path = cy.trace(model, "chuck", range=(0.0, 11.4), rule=CUBIC, turn=2.0, step=0.5)
    first = path.bifurcations[0]
    assert first.parameter * 0.8 == pytest.approx(8.98682, rel=1e-4)
    assert path.joint(turned).moment.values[first.point] == pytest.approx([0, 0, -8.98682], rel=1e-3, abs=1e-3)


def test_von_mises_truss():
    """Two springs of length l₀ meet at the height h: P = 2 k y (l₀/l − 1) is greatest where l³ = l₀ a²."""
    half, height, stiffness = 1.0, 0.3, 1000.0
    bob = cy.PointMass(mass=1.0, position=(0, 0, height), name="bob")
    load = loads.force(bob.centre, (0, 0, -1.0))
    bars = [springs.linear(bob.centre, cy.ground.at((s, 0, 0)), stiffness=stiffness) for s in (-half, half)]
    model = cy.Model(bob, supports=[supports.hold(bob.centre, position="y")], springs=bars, loads=[load])
    path = cy.trace(model, load, range=(-60.0, 60.0), begin=0.0)
    rest = np.hypot(half, height)
    at = (rest * half**2) ** (1 / 3)
    y = np.sqrt(at**2 - half**2)
    most = 2.0 * stiffness * y * (rest / at - 1.0)
    assert [one.parameter for one in path.limits] == pytest.approx([most, -most], rel=1e-9)
    low = path[bob].position.values[:, 2]
    assert low[[one.point for one in path.limits]] == pytest.approx([y, -y], rel=1e-4)
    lengths = np.hypot(half, low)
    assert path.parameter == pytest.approx(2.0 * stiffness * low * (rest / lengths - 1.0), abs=1e-8)
    inside = (np.abs(low) < 0.99 * y) & (lengths > 0.0)
    assert np.array_equal(path.unstable[inside] > 0, np.ones(inside.sum(), dtype=bool))
    assert np.all(path.unstable[np.abs(low) > 1.01 * y] == 0)
    assert path.bifurcations == []


def test_a_toggle_frame_by_load_and_by_displacement():
    """Williams' frame, 2 × 8 elements: the limit loads are the extremes of the force that drives it down."""
    span, rise = 12.943, 0.386
    blade = section(7e5, 7e5, 1.885e6, 9.27e3, 9.27e5, 5e5)
    rod = cy.Rod.polyline(blade, [(-span, 0, 0), (0, 0, rise), (span, 0, 0)], normal=(0, 1, 0), elements=16, name="rod")
    apex = rod.node(8)
    load = loads.force(apex, (0, 0, -1.0))
    held = [supports.clamp(rod.start), supports.clamp(rod.end)]
    path = cy.trace(cy.Model(rod, supports=held, loads=[load]), load, range=(-10.0, 60.0), begin=0.0)
    pushed = supports.drive(apex, position=lambda t: (0.0, 0.0, -t), name="pushed")
    model = cy.Model(rod, supports=[*held, pushed])
    driven = cy.trace(model, pushed, range=(0.0, 0.8), step=0.02)
    force = -driven.joint(pushed).force.values[:, 2]
    most = [one.parameter for one in path.limits]
    assert len(most) == 2
    inner = np.flatnonzero(np.diff(np.sign(np.diff(force)))) + 1
    peaks = []
    for k in inner:
        fit = np.polyfit(driven.parameter[k - 1 : k + 2] - driven.parameter[k], force[k - 1 : k + 2], 2)
        peaks.append(fit[2] - fit[1] ** 2 / (4.0 * fit[0]))
    assert np.abs(peaks) == pytest.approx(np.abs(most), rel=2e-4)
