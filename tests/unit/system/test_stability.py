"""The step limit: an upper bound of the highest frequency, sharp, and what happens on either side of it."""

import numpy as np
import pytest

import cayley as cy
from cayley import loads, supports
from cayley.discrete.rules import nodal, spectral, verlet
from cayley.system.discretize import discretize
from cayley.system.legendre import momenta_of
from cayley.system.system import State, System, by_node, pack
from unit.density.evaluation import turned
from unit.density.examples import EXAMPLES, INERTIA
from unit.system.rods import pendulum, round_rod, three_rods


def forces(system: System, values: np.ndarray) -> np.ndarray:
    """Forces on all nodes by the compiled kernel, shape (nodes, dofs)."""
    state = State(values=values, momenta=np.zeros((system.size, system.layout.dofs)))
    data, kernel = pack(system, state), system.kernels["kick"]
    uniforms = np.zeros(kernel.width)
    uniforms[: len(system.uniforms)] = system.uniforms
    uniforms[0] = 1.0
    kernel(data, uniforms, 1, len(data) - 1)
    return by_node(system, data[1:-1], system.equations.rows.momenta)


def highest_frequency(system: System) -> float:
    """ω_max of M δq̈ = −K δq about the reference, from differences of forces on the group and dense eigenvalues."""
    layout, n, d = system.layout, system.size, system.layout.dofs
    step = 1e-6
    stiffness, masses = np.zeros((n * d, n * d)), np.zeros((n, d, d))
    for node in range(n):
        for dof in range(d):
            sides = []
            for sign in (1.0, -1.0):
                values = system.reference.copy()
                for name in layout.fields:
                    part = np.zeros(d)
                    part[dof] = sign * step
                    by, rows = part[layout.dofs_of(name)], layout.rows_of(name)
                    turns = name in layout.rotations
                    values[node, rows] = turned(values[node, rows], by) if turns else values[node, rows] + by
                sides.append(forces(system, values).reshape(-1))
            stiffness[:, node * d + dof] = (sides[1] - sides[0]) / (2.0 * step)
    for dof in range(d):
        unit = np.zeros((n, d))
        unit[:, dof] = 1.0
        masses[:, :, dof] = momenta_of(system, system.reference, unit, 0.0)
    free = np.flatnonzero(system.free.reshape(-1))
    mass = np.zeros((n, d, n, d))
    mass[np.arange(n), :, np.arange(n), :] = masses
    mass = mass.reshape(n * d, n * d)[np.ix_(free, free)]
    values = np.linalg.eigvals(np.linalg.solve(mass, stiffness[np.ix_(free, free)]))
    return float(np.sqrt(values.real.max()))


def assert_limit(system: System) -> None:
    """2/ω_max is never exceeded, and given away by less than 2.5 %."""
    exact = 2.0 / highest_frequency(system)
    assert exact / 1.025 <= system.stable_dt() <= exact * (1.0 + 1e-6)


@pytest.mark.parametrize("rule", [nodal, verlet, spectral(space=2)], ids=str)
@pytest.mark.parametrize("radius", [1e-3, 1e-2, 1e-1, 1.0])
def test_rods_of_every_slenderness(rule, radius):
    """From a thread, where shear against rotation decides, to a block, where the element length does."""
    assert_limit(discretize(pendulum(5, radius=radius), rule))


@pytest.mark.parametrize("elements", [1, 2, 12])
@pytest.mark.parametrize("support", [None, supports.pin, supports.clamp])
def test_supports(elements, support):
    rod = round_rod(elements, radius=0.03)
    held = [] if support is None else [support(rod.start), supports.hold(rod.end, position="y")]
    assert_limit(discretize(cy.Model(rod, supports=held), verlet))
    assert_limit(discretize(cy.Model(rod, supports=held), spectral(space=3)))


def test_full_stiffness_and_inertia():
    """Shear, bending and twist coupled by a full 6 × 6, the inertia by a full 3 × 3."""
    constants = EXAMPLES["rod"].constants
    section = cy.Section.given(
        stiffness=constants["stiffness"], mass_per_length=constants["mass"], inertia=constants["inertia"]
    )
    rod = cy.Rod(section, length=2.0, elements=4, direction=(1, 2, 3))
    assert_limit(discretize(cy.Model(rod), verlet))
    assert_limit(discretize(cy.Model(rod), nodal))


@pytest.mark.parametrize("rule", [nodal, verlet, spectral(space=2)], ids=str)
def test_several_rods(rule):
    assert_limit(discretize(three_rods()[0], rule))


def test_more_nodes_than_dense_eigenvalues_are_taken_for():
    """The certified bisection: 86 nodes of two rods."""
    a, b = round_rod(40, name="a"), round_rod(44, radius=0.02, origin=(0, 1, 0), name="b")
    model = cy.Model(a, b, supports=[supports.pin(a.start)])
    assert_limit(discretize(model, verlet))
    assert_limit(discretize(model, spectral(space=2)))


def test_matrix_form_has_the_same_limit():
    model = pendulum(6)
    one, other = (discretize(model, verlet, rotation=form).stable_dt() for form in ("quaternion", "matrix"))
    assert one == pytest.approx(other, rel=1e-9)


@cy.lagrangian(p=cy.Rotation(), r=cy.Rotation())
def hinged(q, c):
    """Two bodies that want to be aligned, one of them also upright."""
    kinetic = 0.5 * q.p_t @ c.inertia @ q.p_t + 0.1 * q.r_t @ c.inertia @ q.r_t
    return kinetic + c.k * np.trace(q.p.T @ q.r.matrix) + c.w * q.p[2, 2]


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
def test_two_rotations(rotation):
    constants = dict(inertia=INERTIA, k=3.0, w=0.5)
    system = cy.compile(hinged, rule=nodal, constants=constants, rotation=rotation)
    quaternions = cy.compile(hinged, rule=nodal, constants=constants)
    assert system.stable_dt() == pytest.approx(2.0 / highest_frequency(quaternions), rel=1e-6)


def test_coupled_inertia():
    lagrangian, constants = EXAMPLES["double_pendulum"]
    system = cy.compile(lagrangian, rule=nodal, constants=constants)
    assert system.stable_dt() == pytest.approx(2.0 / highest_frequency(system), rel=1e-5)


def test_string_with_known_frequency():
    """Axial waves on n elements of length ds: ω_max = 2 c/ds on lumped masses with free ends."""
    mass, stiffness, n = 0.1, 20.0, 9
    system = cy.compile(
        EXAMPLES["string"].lagrangian,
        rule=verlet,
        domain=cy.Interval(0.0, 1.0, elements=n),
        constants=dict(mass=mass, stiffness=stiffness, gravity=np.zeros(3) + 1.0),
    )
    assert system.stable_dt() == pytest.approx(1.0 / n / np.sqrt(stiffness / mass), rel=1e-6)


@cy.lagrangian(x=cy.Vector(2))
def oscillators(q, c):
    """Two springs, one of them to the fourth power."""
    return 0.5 * q.x_t @ q.x_t - 0.5 * c.k * q.x[0] ** 2 - 0.25 * q.x[1] ** 4


def test_limit_about_a_state():
    """The linearization is about the state given: a hardening spring has a smaller limit further out."""
    system = cy.compile(oscillators, rule=nodal, constants=dict(k=4.0))
    assert system.stable_dt() == pytest.approx(1.0, rel=1e-8)
    far = State(values=np.array([[0.0, 3.0]]), momenta=np.zeros((1, 2)))
    assert system.stable_dt(far) == pytest.approx(2.0 / np.sqrt(27.0), rel=1e-8)


def test_nothing_that_oscillates_has_no_limit():
    body, constants = EXAMPLES["rigid_body"]
    system = cy.compile(body, rule=nodal, constants=constants)
    assert system.stable_dt() == np.inf
    with pytest.raises(ValueError, match=r"Lagrangian rigid_body has no step limit.*; give dt \[s\]$"):
        cy.integrate(system, {"x": (0, 0, 0)}, 1.0)


def test_enough_is_enough():
    """A limit that need not be sharp is still a limit, and lets the step asked for pass."""
    system = discretize(pendulum(20), verlet)
    sharp = system.stable_dt()
    for part in (1e-3, 0.5, 0.9, 1.0, 2.0):
        found = system.stable_dt(enough=part * sharp)
        assert found <= sharp * (1.0 + 1e-9)
        assert found >= min(part, 1.0) * sharp * (1.0 - 1e-9)


def test_limit_knows_the_smallest_inertia():
    """Two threads that differ only in their tiny rotary inertia: the smaller one decides, whichever comes first."""

    def thread(inertia: float, name: str) -> cy.Rod:
        section = cy.Section.given(
            stiffness=np.diag([1.0, 1.0, 1.0, 1e-9, 1e-9, 1e-9]), mass_per_length=1e-3, inertia=inertia * np.eye(3)
        )
        return cy.Rod(section, length=1.0, elements=4, name=name)

    small = discretize(cy.Model(thread(1e-13, "a")), verlet).stable_dt()
    for inertias in ((4e-13, 1e-13), (1e-13, 4e-13)):
        model = cy.Model(*(thread(inertia, name) for inertia, name in zip(inertias, "ab", strict=True)))
        assert discretize(model, verlet).stable_dt() == pytest.approx(small, rel=1e-6)


def noisy(model: cy.Model) -> dict:
    """A small kick that excites everything."""
    rng = np.random.default_rng(7)
    return {
        name: {
            "velocity": 1e-4 * rng.normal(size=(rod.elements + 1, 3)),
            "angular_velocity": 1e-2 * rng.normal(size=(rod.elements + 1, 3)),
        }
        for name, rod in zip(model.names, model.rods, strict=True)
    }


@pytest.mark.parametrize("rule", [nodal, verlet], ids=str)
@pytest.mark.parametrize("radius", [3e-3, 0.3])
def test_either_side_of_the_limit(rule, radius):
    """Just below it small vibrations stay small; just above they blow up, and the message says what to do."""
    rod = round_rod(6, radius=radius, name="mast")
    model = cy.Model(rod, supports=[supports.pin(rod.start)])
    limit = discretize(model, rule).stable_dt()
    start = noisy(model)
    dt = 0.995 * limit
    run = cy.simulate(model, 4000 * dt, dt, save_every=40 * dt, rule=rule, initial=start)
    assert run.dt == pytest.approx(dt)
    energy = run.energy.values
    assert energy.max() < 10.0 * energy[0]
    dt = 1.04 * limit
    with pytest.raises(cy.SimulationError) as caught:
        cy.simulate(model, 1000 * dt, dt, save_every=5 * dt, rule=rule, initial=start, allow_unstable=True)
    message = str(caught.value)
    assert "\n" not in message
    for part in ("stopped at t = ", "(step ", "at node ", " of mast: ", "give "):
        assert part in message
    assert any(reason in message for reason in ("did not converge", "no longer finite"))
    assert 1 < len(caught.value.partial.time) < 200


@pytest.mark.parametrize("factor", [1.001, 1.5, 100.0])
def test_step_over_the_limit_is_refused(factor):
    model = pendulum(6)
    limit = discretize(model, verlet).stable_dt()
    with pytest.raises(ValueError, match="over the step limit") as caught:
        cy.simulate(model, 1.0, factor * limit)
    message = str(caught.value)
    assert f"over the step limit {limit:.4g} s of the rule verlet" in message
    assert "allow_unstable=True" in message
    assert "\n" not in message


def test_step_of_a_run_that_chooses_itself():
    model = cy.Model(round_rod(6), loads=[loads.gravity((0, 0, -9.81))])
    limit = discretize(model, verlet).stable_dt()
    run = cy.simulate(model, 100 * limit, save_every=10 * limit)
    assert 0.5 * limit < run.dt <= 0.9 * limit
    assert np.isfinite(run.energy.values).all()


@cy.lagrangian(x=cy.Vector(1))
def inverted(q, c):
    """A spring that pushes."""
    return 0.5 * q.x_t[0] ** 2 + 0.5 * q.x[0] ** 2


def test_nothing_but_growth_has_no_limit():
    assert cy.compile(inverted, rule=nodal).stable_dt() == np.inf
