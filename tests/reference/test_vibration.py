"""Modes against closed forms and published tables; meshes are eight elements of degree 4 where nothing else is said."""

import numpy as np
import pytest

import cayley as cy
from cayley import joints, loads, springs, supports

SPECTRAL = cy.rules.galerkin(time=1, space=4)


def beam(r, *, axis=(1, 0, 0), elements=8, shear=(5.0 / 6.0) / 2.6, **more):
    """A rod of length 1 with EI = 1, mass 1 and radius of gyration r, nu = 0.3: frequencies are those of the tables."""
    stretch = 1.0 / r**2
    stiffness = np.diag([shear * stretch, shear * stretch, stretch, 1.0, 1.0, 2.0 / 2.6])
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=np.diag([r**2, r**2, 2.0 * r**2]))
    return cy.Rod(section, length=1.0, direction=axis, elements=elements, name="beam", **more)


def omegas(model, count, **options):
    rest = cy.equilibrium(model, rule=SPECTRAL, **options)
    return cy.modes(model, about=rest, count=count).angular_frequency.values


def assert_among(wanted, found, rel, times=1):
    for value in wanted:
        assert (np.abs(found / value - 1.0) < rel).sum() >= times, (value, found)


TABLE = {  # validation.md 2.1: clamped-free, free-free, pinned-pinned
    0.02: (
        [3.502641, 21.469824, 58.149832, 109.029143],
        [21.993182, 58.819927, 110.733166],
        [9.790536, 38.266761, 83.086521],
    ),
    0.04: (
        [3.463579, 20.014730, 50.561942, 88.195688],
        [20.986989, 52.432919, 91.965809],
        [9.566690, 35.306542, 71.468308, 113.427911],
    ),
    0.08: (
        [3.321388, 16.233135, 36.534573, 57.941383],
        [18.190682, 39.273842, 62.050870, 81.064702],
        [8.826635, 28.356978, 51.225672, 74.880985],
    ),
}


@pytest.mark.parametrize("r", TABLE)
def test_timoshenko_beams(r):
    clamped, free, pinned = TABLE[r]
    rod = beam(r)
    assert_among(clamped, omegas(cy.Model(rod, supports=[supports.clamp(rod.start)]), 14), 2e-6, times=2)
    found = omegas(cy.Model(rod), 20)
    assert np.all(found[:6] == 0.0)
    assert found[6] > 1.0
    assert_among(free, found, 2e-6, times=2)
    ends = [supports.pin(rod.start), supports.hold(rod.end, position="yz")]
    assert_among(pinned, omegas(cy.Model(rod, supports=ends), 16), 2e-6, times=2)


def test_axial_and_torsional_frequencies():
    rod = beam(0.02)
    found = omegas(cy.Model(rod, supports=[supports.clamp(rod.start)]), 20)
    odd = 0.5 * np.pi * np.array([1.0, 3.0])
    assert_among(odd / 0.02, found, 1e-6)  # c = sqrt(EA/m)
    assert_among(odd * np.sqrt(1.0 / 2.6) / 0.02, found, 1e-6)  # c = sqrt(GJ/J)


WRIGHT = {  # hub radius -> speed -> flap frequencies, validation.md 2.3
    0.0: {2.0: [4.1373, 22.6149, 62.2732], 6.0: [7.3604, 26.8091, 66.6839], 12.0: [13.1702, 37.6031, 79.6145]},
    1.0: {2.0: [4.8337, 23.3660, 63.0675], 5.0: [8.9404, 29.3528, 69.7607], 12.0: [19.7215, 51.0701, 98.5268]},
}


@pytest.mark.parametrize(("hub", "speed"), [(hub, speed) for hub, rows in WRIGHT.items() for speed in rows])
def test_rotating_cantilever(hub, speed):
    rod = beam(3e-4, shear=1.0, origin=(hub, 0, 0))
    found = omegas(cy.Model(rod, supports=[supports.clamp(rod.start)]), 6, spin=speed)
    flap = np.array(WRIGHT[hub][speed])
    lag = np.sqrt(flap**2 - speed**2)
    assert found == pytest.approx(np.sort([*flap, *lag]), rel=1e-4)


def test_whirl_of_a_rayleigh_shaft():
    """Forward and backward whirl in space: EI k⁴ − m ω² − J k² (ω² − 2 Ω ω) = 0, k = n π; in the frame |ω − Ω|."""
    r, speed = 0.05, 4.0
    rod = beam(r, axis=(0, 0, 1), shear=1e6 * r**2)
    model = cy.Model(rod, supports=[supports.pin(rod.start), supports.hold(rod.end, position="xy")])
    found = omegas(model, 10, spin=speed)
    for k in np.pi * np.array([1.0, 2.0]):
        whirl = np.roots([1.0 + (r * k) ** 2, -2.0 * speed * (r * k) ** 2, -(k**4)])
        assert_among(np.abs(whirl - speed), found, 1e-4)


def test_oscillator_in_a_turning_frame():
    """Coriolis and centrifugal terms: ω₀ ± Ω across the axis; a disc tilts with |ω − Ω|, I ω² − I₃ Ω ω − k = 0."""
    speed = 3.0
    disc = cy.Body(mass=2.0, inertia=[0.1, 0.1, 0.2], name="disc")
    tie = springs.bushing(disc.centre, stiffness=[50.0, 50.0, 72.0, 0.8, 0.8, 1.8])
    found = omegas(cy.Model(disc, springs=[tie]), 6, spin=speed)
    tilts = np.roots([0.1, -0.2 * speed, -0.8]) - speed
    assert found == pytest.approx(np.sort([2.0, 8.0, 6.0, 3.0, *np.abs(tilts)]), rel=1e-9)


def test_a_mass_in_a_turning_frame_whirls_the_right_way():
    """In space both whirl with ω₀; so the slow one, ω₀ − Ω, goes with the frame: y = −i x, the fast one against it."""
    mass = cy.PointMass(mass=2.0, name="mass")
    tie = springs.bushing(mass.centre, stiffness=[50.0, 50.0, 72.0, 0, 0, 0])
    modes = cy.modes(cy.Model(mass, springs=[tie]), count=3, spin=3.0)
    assert modes.angular_frequency.values == pytest.approx([2.0, 6.0, 8.0], rel=1e-12)
    shapes = modes[mass].displacement.values
    for k, way in ((0, -1j), (2, 1j)):
        assert shapes[k, 1] / shapes[k, 0] == pytest.approx(way, abs=1e-9)


@pytest.mark.parametrize(("tension", "count"), [(40.0, 3), (-5.0, 2)])
def test_beam_under_axial_load(tension, count):
    """ω_n² = (n π)⁴ + (n π)² T for EI = m = 1, pinned, T < 0 pressing."""
    rod = beam(1e-3, shear=1.0)
    ends = [supports.pin(rod.start), supports.hold(rod.end, position="yz")]
    found = omegas(cy.Model(rod, supports=ends, loads=[loads.force(rod.end, (tension, 0, 0))]), 8)
    k = np.pi * np.arange(1, count + 1)
    assert_among(np.sqrt(k**4 + k**2 * tension), found, 2e-4, times=2)  # shear and rotary inertia: r² k²


def test_stretched_string():
    """f_n = n/2l sqrt(T/m) (1 + n² π² EI/2Tl²) as EI/Tl² -> 0: a steel wire of 0.5 mm, 2 N."""
    steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
    section = cy.Section.circle(0.25e-3, steel)
    strain = 50.0 / section.stiffness[2, 2]
    wire = cy.Rod(section, length=1.0, direction=(1, 0, 0), elements=8, stretched=1.0 + strain)
    model = cy.Model(wire, supports=[supports.pin(wire.start), supports.pin(wire.end)])
    found = omegas(model, 9)
    n, length = np.arange(1, 5), 1.0 + strain
    mass, bending = section.mass_per_length / length, section.stiffness[3, 3]
    k = n * np.pi / length
    assert_among(np.sqrt((50.0 * k**2 + bending * k**4) / mass), found, 1e-5, times=2)


def test_buckled_beam():
    """Pinned between walls: v grows at ω₁ √(P/P₁ − 1) about the straight state, about the buckled one ω is √2 times it.

    Exact for one sine and quadratic strain (Nayfeh and Emam 2008, section 4); r² (P/P₁) is what is neglected.
    """
    r, over = 1e-3, 1.2
    rod = beam(r, shear=1.0, stretched=1.0 - over * (np.pi * r) ** 2)
    ends = [supports.hold(rod.start, position="xyz", rotation="z"), supports.pin(rod.end)]
    model = cy.Model(rod, supports=ends)
    straight = cy.equilibrium(model, rule=SPECTRAL, relax=False)
    growth = cy.modes(model, about=straight, count=2)
    lowest = np.pi**2 * np.sqrt(over - 1.0)
    assert straight.unstable == 2
    assert growth.eigenvalue.values == pytest.approx([lowest, lowest], rel=1e-3)
    assert growth.damping_ratio.values == pytest.approx([-1.0, -1.0])
    buckled = cy.equilibrium(model, rule=SPECTRAL, start=growth.state(0, 0.5 * r), relax=True)
    modes = cy.modes(model, about=buckled, count=3)
    assert buckled.stable
    assert modes.angular_frequency.values[0] == pytest.approx(0.0, abs=1e-3)  # the plane of the bow turns
    assert_among([np.sqrt(2.0) * lowest], modes.angular_frequency.values, 5e-3)


def test_damped_oscillator():
    calm, fast = cy.PointMass(mass=2.0, position=(1, 0, 0)), cy.PointMass(mass=2.0, position=(0, 1, 0))
    ties = [
        springs.linear(mass.centre, cy.ground.at((0, 0, 0)), stiffness=50.0, damping=damping)
        for mass, damping in ((calm, 1.0), (fast, 30.0))
    ]
    modes = cy.modes(cy.Model(calm, fast, springs=ties), count=10)
    s = modes.eigenvalue.values
    assert np.all(s[:4] == 0.0)
    slow, fast = np.sort(np.roots([2.0, 30.0, 50.0]))[::-1]
    pair = complex(-0.25, np.sqrt(25.0 - 0.0625))
    assert s[4:] == pytest.approx([slow, pair, fast], rel=1e-9)
    assert modes.damping_ratio.values[4:] == pytest.approx([1.0, 0.05, 1.0], rel=1e-9)


def test_material_damping():
    """Kelvin-Voigt: ζ = τ ω₀/2 of every mode, and |s| = ω₀."""
    tau = 1e-3
    plain = beam(0.02, elements=4)
    rod = beam(0.02, elements=4, damping=cy.damping.retardation(tau))
    alone = omegas(cy.Model(plain, supports=[supports.clamp(plain.start)]), 6)
    model = cy.Model(rod, supports=[supports.clamp(rod.start)])
    modes = cy.modes(model, about=cy.equilibrium(model, rule=SPECTRAL), count=6)
    assert np.abs(modes.eigenvalue.values) == pytest.approx(alone, rel=1e-6)
    assert modes.damping_ratio.values == pytest.approx(0.5 * tau * alone, rel=1e-6)


def test_pendulum_on_a_ball_joint():
    bob = cy.Body(mass=1.0, inertia=[0.1, 0.1, 0.05], position=(0, 0, -0.5), ports={"pivot": (0, 0, 0.5)}, name="bob")
    model = cy.Model(bob, joints=[joints.ball(bob.port("pivot"), cy.ground)], loads=[loads.gravity((0, 0, -9.81))])
    modes = cy.modes(model, count=10)
    assert len(modes) == 3
    assert modes.complete
    swing = np.sqrt(9.81 * 0.5 / (0.1 + 0.25))
    assert modes.angular_frequency.values == pytest.approx([0.0, swing, swing], rel=1e-12)


def test_free_bodies_keep_all_their_motions():
    bodies = [cy.Body(mass=1.0 + k, inertia=[0.1, 0.2, 0.3], position=(k, 0, 0), name=f"b{k}") for k in range(3)]
    modes = cy.modes(cy.Model(*bodies), count=30)
    assert np.array_equal(modes.frequency.values, np.zeros(18))


def test_effective_masses_add_up():
    rod = beam(0.05, elements=2)
    model = cy.Model(rod, supports=[supports.clamp(rod.start)])
    modes = cy.modes(model, about=cy.equilibrium(model, rule=SPECTRAL), count=1000)
    assert len(modes) == 48
    lost = 1.0 - cy.modes(model, about=modes.about).linear.mass.diagonal()[3::6].sum()  # of the clamped node
    total = modes.effective_mass.sum("mode").sel(direction=["x", "y", "z"]).values
    assert total == pytest.approx([1.0 - lost] * 3, rel=1e-9)
    first = modes.effective_mass.sel(direction="y").values[:2].sum()
    assert first == pytest.approx(0.61, abs=0.01)  # of a slender cantilever 0.613
