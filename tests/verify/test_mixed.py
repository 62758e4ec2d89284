"""Models of several densities: rods of different kinematics, and parts with a Lagrangian of their own among others."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cayley as cy
from cayley import joints, loads, rules, springs, supports
from cayley.density import library
from verify.assemblies import AXIS, THICK, WEIGHT, driven, flight, followed, gap
from verify.problems import assert_order

STEPS = {rules.verlet: 2e-4, rules.midpoint: 5e-4}
RULES = pytest.mark.parametrize("rule", STEPS, ids=str)
PULL = np.array(WEIGHT.acceleration)


def own_body(mass, inertia, **place):
    """A rigid body written as a Lagrangian of one's own, under the weight of the shared assemblies."""
    constants = {"mass": mass, "inertia": np.diag(inertia), "gravity": PULL}
    return cy.LagrangianPart(lagrangian=library.rigid_body, constants=constants, **place)


def own_rod(lagrangian, section, first, gravity=PULL, **place):
    """A rod of 3 elements as a Lagrangian density of one's own; the strains before the first are constrained."""
    constants = {"mass": section.mass_per_length, "inertia": section.inertia, "gravity": gravity}
    constants["stiffness"] = section.stiffness[first:, first:]
    return cy.LagrangianPart(
        lagrangian=lagrangian, constants=constants, domain=cy.Interval(0.0, 0.8, elements=3), **place
    )


@cy.lagrangian(x=cy.Vector(3), s=cy.Interval)
def cable(q, c):
    """A string that resists stretch: it has no rotation."""
    return 0.5 * c.mass * cy.dot(q.x_t, q.x_t) - 0.5 * c.stiffness * (cy.norm(q.x_s) - 1.0) ** 2


def free():
    """Three rods, one without shear and stretch, a cable between two of them, and two bodies; nothing acts."""
    a = cy.Rod(THICK, length=1.0, elements=4, direction=(1, 0, 0), name="a")
    bar = {"origin": (1, 0, 0), "direction": (0, 1, 0), "kinematics": "inextensible"}
    b = cy.Rod(THICK, length=0.8, elements=3, name="b", **bar)
    c = cy.Rod(THICK, length=0.6, elements=2, direction=(0, 0, 1), name="c")
    inertia = np.diag([0.05, 0.06, 0.09])
    bob = cy.LagrangianPart(
        lagrangian=library.rigid_body,
        constants={"mass": 2.0, "inertia": inertia, "gravity": (0, 0, 0)},
        position=(1.1, 0.8, 0.2),
        ports={"eye": (-0.1, 0, -0.2)},
        name="bob",
    )
    wheel = cy.Body(
        mass=1.5, inertia=[0.03, 0.03, 0.05], position=(0, 0, 0.8), ports={"hub": (0, 0, -0.2)}, name="wheel"
    )
    line = cy.LagrangianPart(
        lagrangian=cable,
        constants={"mass": 3.0, "stiffness": 2e4},
        domain=cy.Interval(0.0, np.sqrt(0.36 + 1.0 + 0.64), elements=4),
        position=lambda s: np.array((0, 0, 0.6)) + s * np.array((1.0, 0.8, -0.6)) / np.sqrt(2.0),
        name="line",
    )
    ties = [
        joints.weld(a.end, b.start),
        joints.hinge(a.start, c.start, axis=AXIS),
        joints.ball(b.end, bob.port("eye")),
        joints.hinge(c.end, wheel.port("hub"), axis=(0, 0, 1)),
        joints.ball(line.start, c.end),
        joints.ball(line.end, b.end),
    ]
    return cy.Model(c, bob, a, line, b, wheel, joints=ties)


def pendulum():
    """A double pendulum: an elastic rod with shear, and below it on a hinge one without shear and stretch."""
    a = cy.Rod(THICK, length=1.0, elements=4, direction=(1, 0, 0), name="a")
    bar = {"origin": (1, 0, 0), "direction": (1, 0, 0), "kinematics": "inextensible"}
    b = cy.Rod(THICK, length=0.8, elements=3, name="b", **bar)
    return cy.Model(
        b, a, supports=[supports.pin(a.start)], joints=[joints.hinge(a.end, b.start, axis=(0, 1, 0.2))], loads=[WEIGHT]
    )


@RULES
def test_momenta_of_a_free_assembly(rule):
    """Over 4000 steps all six momenta keep to round-off, joints stay closed, rods without stretch keep their length."""
    model = free()
    start = flight(model)
    turned = np.array((2.0, 5.0, -3.0))  # the body in the ball joint turns on its own, too
    start[model.parts[1]]["angular_velocity"] += turned
    start[model.parts[1]]["velocity"] -= np.cross(turned, (-0.1, 0.0, -0.2))
    start[model.parts[3]].pop("angular_velocity")
    run = cy.simulate(model, 4000 * STEPS[rule], STEPS[rule], rule=rule, initial=start)
    for momentum in (run.linear_momentum.values, run.angular_momentum.values):
        assert np.abs(momentum - momentum[0]).max() < 1e-11 * np.linalg.norm(momentum[0])
    assert max(gap(run, joint) for joint in model.joints) < 1e-12
    lengths = np.linalg.norm(np.diff(run["b"].position.values, axis=1), axis=2)
    assert_allclose(lengths, 0.8 / 3, rtol=1e-12)
    assert np.ptp(run.energy.values) < 1e-3 * run.energy.values[0]
    bent = run["a"].curvature.values
    assert np.abs(bent - bent[0]).max() > 0.1


def distance(run, other, name):
    """Largest distance of a part in two runs, of positions [m] and of rotations [-]."""
    pairs = ((run[name][what].values, other[name][what].values) for what in ("position", "rotation"))
    return max(np.abs(first - second).max() for first, second in pairs)


@pytest.mark.parametrize(
    ("assembly", "rule"),
    [(driven, rules.midpoint), (followed, rules.verlet)],
    ids=["driven-midpoint", "followed-verlet"],
)
def test_a_body_of_ones_own_is_a_body(assembly, rule, monkeypatch):
    """Frames with drives and loads that follow move alike, whoever wrote the body."""
    with monkeypatch.context() as patch:
        patch.setattr(cy, "Body", own_body)
        own = assembly()
    runs = [
        cy.simulate(model, 500 * STEPS[rule], STEPS[rule], rule=rule, initial={}, balance=True)
        for model in (assembly(), own)
    ]
    assert [len(run.system.groups) for run in runs] == [1, 2]
    assert distance(*runs, "bob") < 1e-12
    assert distance(*runs, "b") < 1e-12
    for quantity in ("energy", "work", "dissipated"):
        values, others = (getattr(run, quantity).values for run in runs)
        assert_allclose(values, others, atol=1e-10 * max(1.0, np.abs(values).max()))
    limits = [run.system.stable_dt() for run in runs]
    assert limits[0] == pytest.approx(limits[1], rel=1e-2)  # either is sharp to 2 %
    joint = runs[0].model.connection_names[-1]
    first, second = (run.joint(joint).force.values for run in runs)
    assert_allclose(first, second, atol=1e-8 * np.abs(first).max())


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3))
def bare(q, c):
    """A round body under its weight."""
    kinetic = 0.5 * c.mass * cy.dot(q.x_t, q.x_t) + 0.5 * c.inertia * cy.dot(q.p_t, q.p_t)
    return kinetic - 9.81 * c.mass * q.x[2]


def braking(q, c):
    """Drag on both motions."""
    return [(-c.decay * q.x_t, q.x), (-c.decay * c.inertia * q.p_t, q.p)]


braked = cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), force=braking)(bare.function)


@RULES
def test_forces_in_one_density_only(rule):
    """A body without drag hangs on one with drag as if it had one of nothing; both have springs, dampers and loads."""
    shared = {"mass": 2.0, "inertia": 0.05}
    runs = []
    for drag in (True, False):
        one = cy.LagrangianPart(lagrangian=braked, constants=shared | {"decay": 0.8}, position=(1, 0, 0), name="one")
        options = {"lagrangian": braked, "constants": shared | {"decay": 0.0}} if drag else {"lagrangian": bare}
        other = cy.LagrangianPart(**{"constants": shared, **options}, position=(1, 0, -1), name="other")
        swivel = joints.ball(one.centre.offset((0, 0, -0.5)), other.centre.offset((0, 0, 0.5)))
        ties = [
            springs.linear(one.centre, cy.ground.at((1, 0.5, 1)), stiffness=200.0, damping=2.0),
            springs.rotational(one.centre, other.centre, axis=(0, 1, 0), stiffness=3.0, damping=0.1),
        ]
        pull = [loads.force(other.centre.offset((0.1, 0, 0)), lambda t: (3.0 * t, 1.0, 0.0))]
        model = cy.Model(
            other, one, joints=[swivel, joints.ball(one.centre.offset((-1, 0, 0)))], springs=ties, loads=pull
        )
        runs.append(cy.simulate(model, 0.5, 1e-3, rule=rule))
    assert [len(run.system.groups) for run in runs] == [1, 2]
    for name in ("one", "other"):
        assert distance(*runs, name) < 1e-13
    for quantity in ("energy", "work", "dissipated"):
        values, others = (getattr(run, quantity).values for run in runs)
        assert_allclose(values, others, atol=1e-12)
    assert runs[0].dissipated.values[-1] > 0.1
    assert np.abs(runs[1].energy_balance.defect.values).max() < 1e-2
    limits = [run.system.stable_dt(run.state) for run in runs]
    assert limits[0] == pytest.approx(limits[1], rel=1e-9)
    states = [cy.integrate(run.system, run.state, 0.6).state for run in runs]
    assert_allclose(states[0].work.sum(axis=0), states[1].work.sum(axis=0), atol=1e-12)


@RULES
@pytest.mark.parametrize(
    ("lagrangian", "kinematics", "first"),
    [(library.rod, "shearable", 0), (library.inextensible_rod, "inextensible", 3)],
    ids=["shearable", "inextensible"],
)
def test_a_rod_of_ones_own_is_a_rod(lagrangian, kinematics, first, rule):
    """A density of the library, given as one's own, moves under a rod as a rod does."""
    runs = []
    for own in (False, True):
        a = cy.Rod(THICK, length=1.0, elements=4, direction=(1, 0, 0), kinematics=kinematics, name="a")
        turn = a.place(0)[1]
        if own:
            b = own_rod(lagrangian, THICK, first, PULL, position=(1, 0, 0), rotation=turn, name="b")
        else:
            bar = {"origin": (1, 0, 0), "direction": (1, 0, 0), "kinematics": kinematics}
            b = cy.Rod(THICK, length=0.8, elements=3, name="b", **bar)
        ties = [joints.hinge(a.end, b.start, axis=(0, 1, 0.2))]
        pull = [WEIGHT, loads.force(b.end, lambda t: (0.0, 5.0 * t, 1.0))]
        model = cy.Model(a, b, supports=[supports.pin(a.start)], joints=ties, loads=pull)
        runs.append(cy.simulate(model, 500 * STEPS[rule], STEPS[rule], rule=rule))
    assert distance(*runs, "a") < 1e-11
    assert distance(*runs, "b") < 1e-11
    assert_allclose(runs[0].energy.values, runs[1].energy.values, atol=1e-9)


@RULES
def test_order_of_a_pendulum_of_two_kinematics(rule):
    """Halving the step quarters the error of positions, rotations and momenta."""
    model, span = pendulum(), 0.1
    final = {n: cy.simulate(model, span, span / n, rule=rule, save_every=span).frames for n in (500, 1000, 2000, 8000)}
    for what in ("values", "momenta"):
        best = getattr(final[8000], what)[-1]
        assert_order([np.abs(getattr(final[n], what)[-1] - best).max() for n in (500, 1000, 2000)], within=0.1)


@RULES
def test_restart_bit_for_bit(rule, tmp_path):
    """A run that was stored and goes on is the one that never stopped; a Lagrangian is given again with the model."""
    model = pendulum()
    bob = own_body(2.0, [0.05, 0.06, 0.09], position=(1.8, 0, -0.2), ports={"eye": (0, 0, 0.2)}, name="bob")
    hung = joints.ball(model.parts[0].end, bob.port("eye"))
    model = model.replace(parts=[bob, *model.parts], joints=[*model.joints, hung])
    start = {"a": {"momentum": (1.0, 2.0, 3.0)}}
    whole = cy.simulate(model, 200 * STEPS[rule], STEPS[rule], rule=rule, initial=start, save_every=20 * STEPS[rule])
    half = cy.simulate(model, 100 * STEPS[rule], STEPS[rule], rule=rule, initial=start, save_every=20 * STEPS[rule])
    half.save(tmp_path / "run")
    opened = cy.Trajectory.open(tmp_path / "run", model=model)
    rest = cy.integrate(opened.system, opened.state, whole.time[-1], save_every=20 * STEPS[rule])
    assert_array_equal(rest.frames.values[1:], whole.frames.values[6:])
    assert_array_equal(rest.frames.momenta[1:], whole.frames.momenta[6:])
    bare = cy.Trajectory.open(tmp_path / "run")
    for name in model.names:
        for what, values in half[name].data_vars.items():
            assert_array_equal(bare[name][what].values, values.values)
    assert_array_equal(bare.port("bob", "eye").velocity.values, half.port("bob", "eye").velocity.values)
    with pytest.raises(ValueError, match="the Lagrangian rigid_body of LagrangianPart 'bob' is not in the store"):
        _ = bare.system


@RULES
def test_parts_that_nothing_ties(rule):
    """Two rods of different kinematics that have nothing to do with each other move as each alone."""
    a, b = pendulum().rods[::-1]
    both = cy.Model(b, a, supports=[supports.pin(a.start), supports.pin(b.end)], loads=[WEIGHT])
    alone = [cy.Model(rod, supports=[supports.pin(end)], loads=[WEIGHT]) for rod, end in ((a, a.start), (b, b.end))]
    dt = STEPS[rule]
    together = cy.simulate(both, 200 * dt, dt, rule=rule)
    for model in alone:
        name = model.rods[0].name
        assert distance(together, cy.simulate(model, 200 * dt, dt, rule=rule), name) < 1e-12


@cy.lagrangian(p=cy.Rotation())
def top(q, c):
    """A heavy top about a fixed point."""
    return 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) - cy.dot(c.moment, q.p.rotate(cy.E3))


@RULES
def test_parts_of_one_field(rule):
    """A top without position and a cable without rotation move as alone; what they do not have stays where it is."""
    constants = {"inertia": np.diag([0.4, 0.5, 0.3]), "moment": (0.0, 0.0, 8.0)}
    given = {"mass": 3.0, "stiffness": 2e3}
    domain = cy.Interval(0.0, 1.0, elements=4)
    spin = {"angular_velocity": (1.0, 0.0, 20.0)}
    one = cy.LagrangianPart(lagrangian=top, constants=constants, position=(0, 0, 1), name="top")
    other = cy.LagrangianPart(
        lagrangian=cable, constants=given, domain=domain, rotation=(0.5**0.5, 0, 0.5**0.5, 0), name="cable"
    )
    model = cy.Model(one, other, supports=[supports.pin(other.start)])
    dt = STEPS[rule]
    pluck = {"velocity": lambda s: (0.5 * s, 0.0, s)}
    run = cy.simulate(model, 400 * dt, dt, rule=rule, initial={one: spin, other: pluck})
    alone = cy.integrate(
        cy.compile(top, rule=rule, constants=constants), {"p": (1, 0, 0, 0), "p_t": (1, 0, 20)}, 400 * dt, dt
    )
    assert_allclose(run["top"].rotation.values, alone.data["p"].values, atol=1e-12)
    system = cy.compile(cable, rule=rule, domain=domain, constants=given, held={"x": "start"})
    s = system.nodes[:, None]
    start = {"x": s * np.array((1, 0, 0)), "x_t": s * np.array((0.5, 0, 1))}
    alone = cy.integrate(system, start, 400 * dt, dt)
    assert_allclose(run["cable"].position.values, alone.data["x"].values, atol=1e-12)
    assert_array_equal(run["top"].position.values, np.broadcast_to((0, 0, 1), (101, 3)))
    assert np.ptp(run["cable"].rotation.values, axis=(0, 1)).max() == 0.0
    assert run["cable"].sizes == {"time": 101, "node": 5, "axis": 3, "wxyz": 4}


def test_refusals():
    """Every one is a line that says what would be right."""
    rod = cy.Rod(THICK, length=1.0, elements=4, direction=(1, 0, 0))
    whole = cy.LagrangianPart(lagrangian=top, constants={"inertia": np.eye(3), "moment": (0.0, 0.0, 8.0)})
    with pytest.raises(ValueError, match="parts of several densities want rotation='quaternion'"):
        cy.simulate(cy.Model(rod, whole), 0.1, 1e-4, rotation="matrix")
    with pytest.raises(ValueError, match="use verlet, screw, spectral, midpoint"):
        cy.simulate(pendulum(), 0.1, 1e-4, rule=rules.nodal)
    run = cy.simulate(cy.Model(rod, whole), 0.01, 1e-4)
    with pytest.raises(AttributeError, match="several densities have no density in common; ask each of"):
        _ = run.system.equations.density
    missing = cy.LagrangianPart(lagrangian=top, constants={"inertia": np.eye(3)})
    with pytest.raises(ValueError, match=r"Lagrangian top: unknown constant c.moment"):
        cy.simulate(cy.Model(missing), 0.1, 1e-3)
    weightless = cy.LagrangianPart(
        lagrangian=cable, constants={"mass": 0.0, "stiffness": 1.0}, domain=cy.Interval(0, 1, 2)
    )
    with pytest.raises(ValueError, match=r"LagrangianPart: the mass matrix is singular, x\[0\] has no inertia"):
        cy.simulate(cy.Model(weightless), 0.1, 1e-3)


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3))
def gyrostat(q, c):
    """A body with a rotor in it: its momentum has a part that does not depend on velocities."""
    kinetic = 0.5 * c.mass * cy.dot(q.x_t, q.x_t) + 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t)
    return kinetic + cy.dot(c.rotor, q.p_t) - 9.81 * c.mass * q.x[2]


@cy.lagrangian(p=cy.Rotation())
def pivoted(q, c):
    """The same about a fixed point, c.arm from it to the mass center in the body frame."""
    kinetic = 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) + cy.dot(c.rotor, q.p_t)
    return kinetic - 9.81 * c.mass * q.p.rotate(c.arm)[2]


@pytest.mark.parametrize(
    ("rule", "drag"),
    [(rules.verlet, 0.0), (rules.verlet, 1e-9), (rules.midpoint, 0.0)],
    ids=["verlet", "verlet-damper", "midpoint"],
)
def test_a_rotor_in_a_ball_joint(rule, drag):
    """A gyrostat in a ball joint converges to one whose Lagrangian knows that its point is fixed, with order 2.

    A damper too weak to matter takes the way of forces that need velocities from momenta.
    """
    arm, inertia, rotor, spin = (
        np.array((0.0, 0.0, -0.2)),
        np.diag([0.02, 0.02, 0.03]),
        (0.0, 0.0, 1.5),
        (0.5, 0.0, 0.0),
    )
    about = inertia + 2.0 * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    system = cy.compile(pivoted, rule=rule, constants={"mass": 2.0, "inertia": about, "rotor": rotor, "arm": arm})
    exact = cy.integrate(system, {"p": (1, 0, 0, 0), "p_t": spin}, 0.1, 1e-5, save_every=0.1).data["p"].values[-1]
    constants = {"mass": 2.0, "inertia": inertia, "rotor": rotor}
    one = cy.LagrangianPart(lagrangian=gyrostat, constants=constants, position=arm, ports={"eye": -arm})
    tied = [springs.linear(one.centre, cy.ground.at((1, 0, 0)), stiffness=1e-9, damping=drag)] if drag else []
    model = cy.Model(one, joints=[joints.ball(one.port("eye"))], springs=tied)
    start = {one: {"angular_velocity": spin, "velocity": np.cross(spin, arm)}}
    errors = []
    for steps in (250, 500):
        run = cy.simulate(model, 0.1, 0.1 / steps, rule=rule, initial=start, save_every=0.1)
        errors.append(np.abs(run[one].rotation.values[-1] - exact).max())
    assert_order(errors, within=0.1)
    assert errors[-1] < 1e-6
