"""cy.equilibrium on small models: what it finds, what it tells and what it refuses."""

import numpy as np
import pytest
import scipy.optimize

import cayley as cy
from cayley import joints, loads, supports
from cayley.lie import quaternion
from cayley.steppers.still import Still
from cayley.system.discretize import discretize

STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
TUBE = cy.Section.tube(outer_radius=0.02, thickness=0.002, material=STEEL)
GRAVITY = loads.gravity((0, 0, -9.81))


def frame(*more, weight=True):
    mast = cy.Rod(TUBE, length=2.0, direction=(0, 0, 1), elements=8, name="mast")
    arm = cy.Rod(TUBE, length=1.0, origin=(0, 0, 2), direction=(1, 0, 0), elements=6, name="arm")
    bob = cy.Body(
        mass=2.0, inertia=np.diag([0.01, 0.01, 0.01]), position=(1, 0, 1.7), name="bob", ports={"eye": (0, 0, 0.3)}
    )
    return cy.Model(
        mast,
        arm,
        bob,
        supports=[supports.clamp(mast.start)],
        joints=[joints.weld(mast.end, arm.start), joints.ball(arm.end, bob.port("eye"))],
        loads=[*([GRAVITY] if weight else []), *(load(mast, arm, bob) for load in more)],
    )


def everything():
    return frame(
        lambda mast, arm, bob: loads.force(arm.node(3), (3.0, 100.0, 10.0)),
        lambda mast, arm, bob: loads.moment(arm.node(4), (30.0, 10.0, 10.0)),
        lambda mast, arm, bob: loads.force(mast.node(5), (3.0, 100.0, 10.0), frame="body"),
        lambda mast, arm, bob: loads.force(arm.node(2).offset((0.1, 0.2, 0.3)), (3.0, 100.0, 10.0)),
    )


def moved(still, size=1e-2):
    generator = np.random.default_rng(3)
    still.put(still.values, generator.standard_normal(len(still.multipliers)))
    x, known = np.zeros(len(still.force())), np.concatenate([still.free, still.spots])
    x[known] = size * generator.standard_normal(len(known))
    still.move(x)
    return known


@pytest.mark.parametrize("rule", [cy.rules.midpoint, cy.rules.screw, cy.rules.galerkin(time=1, space=2)], ids=str)
def test_the_tangent_is_the_derivative_of_the_forces(rule):
    still = Still.at(discretize(everything(), rule), discretize(everything(), rule).reference)
    known = moved(still)
    tangent = still.matrix(0).toarray()
    still.made.struct.penalty = None
    values, multipliers, step = still.values, still.multipliers, 1e-6
    found = np.zeros_like(tangent)
    for k in known:
        x, forces = np.zeros(len(tangent)), []
        x[k] = 1.0
        for side in (step, -step):
            still.put(values, multipliers)
            still.move(x, side)
            forces.append(still.force())
        found[:, k] = (forces[0] - forces[1]) / (2.0 * step)
    inside = np.ix_(known, known)
    scale = np.abs(tangent[inside]).max()
    assert np.abs(tangent[inside] - found[inside]).max() < 1e-7 * scale


def test_the_tangent_is_symmetric_where_loads_are_conservative():
    rest = cy.equilibrium(frame())
    tangent = rest.still.matrix(0)
    assert np.abs((tangent - tangent.T).toarray()).max() < 1e-14 * np.abs(tangent.toarray()).max()


def test_positions_settle_with_rotations_held():
    """With rotations as they are, one correction balances all forces and closes joints; welds hold some for nothing."""
    system = discretize(everything(), cy.rules.midpoint)
    still = Still.at(system, system.reference)
    moved(still, 0.1)
    turned = still.values[:, system.layout.rows_of("p")]
    positions = still.dofs[:, system.layout.dofs_of("x")][system.free[:, system.layout.dofs_of("x")]]
    before = np.abs(still.force()[positions]).max()
    x = still.settle()
    rotations = still.dofs[:, system.layout.dofs_of("p")]
    assert np.all(x[rotations] == 0.0)
    still.move(x)
    np.testing.assert_array_equal(still.values[:, system.layout.rows_of("p")], turned)
    assert np.abs(still.force()[positions]).max() < 1e-9 * before
    assert np.abs(still.settle()).max() < 1e-9 * np.abs(x).max()


def test_loads_without_an_energy_are_told():
    assert cy.equilibrium(frame()).conservative
    rod = cy.Rod(TUBE, length=2.0, elements=4, direction=(1, 0, 0), normal=(0, 1, 0))
    moment = loads.moment(rod.end, (0, -np.pi * TUBE.stiffness[3, 3], 0))
    rest = cy.equilibrium(cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[moment]), rule=cy.rules.screw)
    assert not rest.conservative
    assert rest.free_motions == []
    assert "stability open under loads without an energy" in repr(rest)


def test_the_frame_hangs_as_by_hand():
    model = frame()
    mast, arm, _ = model.parts
    rest = cy.equilibrium(model)
    weight = TUBE.mass_per_length * 9.81
    down = 9.81 * (2.0 + TUBE.mass_per_length * 3.0)
    assert rest.reaction(model.supports[0]).force.values == pytest.approx([0, 0, down], abs=1e-6)
    assert rest.joint(model.joints[1]).force.values == pytest.approx([0, 0, 19.62], abs=1e-6)
    reach = rest[arm].position.values[:, 0]
    middles = 0.5 * (reach[1:] + reach[:-1])
    root = 19.62 * reach[-1] + weight / 6.0 * middles.sum()
    lean = rest[mast].position.values[:, 0]
    root += weight / 4.0 * 0.5 * (lean[1:] + lean[:-1]).sum()
    assert np.abs(rest[mast].moment.values[0]) == pytest.approx([0, root, 0], rel=1e-6, abs=1e-6)
    assert rest.stable
    assert rest.free_motions == ["bob turns about (0, 0, 1) through (1.007, 0, 1.692)"]
    assert rest.residual < 1e-6
    assert "4 corrections by newton" in repr(rest)


def test_a_run_from_an_equilibrium_stays_there():
    model = frame()
    rest = cy.equilibrium(model)
    for rule, dt in ((cy.rules.midpoint, 1e-3), (cy.rules.verlet, None)):
        run = cy.simulate(model, start=rest, t_end=0.05, dt=dt, rule=rule)
        assert np.abs(run["bob"].position.values - rest["bob"].position.values).max() < 1e-10


def test_relaxation_finds_the_hanging_pendulum_from_upright():
    bob = cy.Body(
        mass=1.0, inertia=np.diag([0.1, 0.1, 0.05]), position=(0.01, 0, 0.5), ports={"pivot": (-0.01, 0, -0.5)}
    )
    model = cy.Model(bob, joints=[joints.ball(bob.port("pivot"), cy.ground)], loads=[GRAVITY])
    rest = cy.equilibrium(model, relax=True)
    assert rest.stable
    assert rest[bob].position.values == pytest.approx([0, 0, -np.hypot(0.01, 0.5)], abs=1e-6)


def test_what_nothing_holds_is_told():
    rod = cy.Rod(TUBE, length=2.0, elements=4, name="mast")
    with pytest.raises(cy.EquilibriumError, match=r"nothing holds the model .*mast moves along \(0, 0, 1\)"):
        cy.equilibrium(cy.Model(rod, loads=[GRAVITY]))


def test_arguments_are_refused():
    model = frame()
    with pytest.raises(TypeError, match="no Model"):
        cy.equilibrium("frame")
    with pytest.raises(ValueError, match="spin is 'fast'"):
        cy.equilibrium(model, spin="fast")
    with pytest.raises(ValueError, match="time is nan"):
        cy.equilibrium(model, time=float("nan"))
    with pytest.raises(ValueError, match="start has values of shape"):
        cy.equilibrium(model, start=cy.equilibrium(model, rule=cy.rules.galerkin(time=1, space=2)))
    with pytest.raises(ValueError, match="start is a str"):
        cy.simulate(model, t_end=1.0, dt=1e-3, start="rest")


@pytest.mark.parametrize("rule", [cy.rules.midpoint, cy.rules.galerkin(time=1, space=2)], ids=str)
def test_a_slack_rope_that_starts_bent_is_found_at_once(rule):
    """Pinned at both ends it may turn about its own axis; signs of the given quaternions are whatever they are."""
    rope = cy.Material(density=1000.0, youngs_modulus=1e6, poisson_ratio=0.5)
    rod = cy.Rod(cy.Section.circle(0.005, rope), length=1.0, elements=30, direction=(1, 0, 0))
    half, span = 1.7, np.sin(1.7) / 1.7  # an arc of length 1
    nodes = 30 * rule.degree + 1
    angle = np.linspace(-half, half, nodes)
    places = np.column_stack(
        [span / 2 + np.sin(angle) / (2 * half), 0 * angle, (np.cos(half) - np.cos(angle)) / (2 * half)]
    )
    turns = quaternion.multiply(
        quaternion.from_rotation_vector(np.outer(-angle, (0.0, 1.0, 0.0))),
        np.broadcast_to(rod.rotation, (nodes, 4)),
    )
    turns *= np.where(np.arange(nodes) % 7 < 3, 1.0, -1.0)[:, None]
    model = cy.Model(rod, supports=[supports.pin(rod.start), supports.pin(rod.end)], loads=[GRAVITY])
    rest = cy.equilibrium(model, initial={rod: {"position": places, "rotation": turns}}, rule=rule)
    assert rest.iterations <= 12
    assert rest.stable
    tension = scipy.optimize.brentq(lambda a: 2 * a * np.sinh(span / (2 * a)) - 1.0, 0.01, 1.0)
    depth = tension * (np.cosh(span / (2 * tension)) - 1.0)
    assert rest[rod].position.values[:, 2].min() == pytest.approx(-depth, rel=0.015)
