"""Joints, drives and springs in motion: closed to round-off, of the order of the rule, momenta kept, against other "
"ways."""

import functools
import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

import cayley as cy
from cayley import joints, loads, rules, springs, supports
from cayley.discrete.joint import evaluator, joint_program
from cayley.lie import quaternion
from cayley.steppers import coupled_run
from cayley.system.couplings import joint_inputs
from cayley.system.redundancy import ground_values

RULES = {rules.verlet: 2, rules.midpoint: 2, rules.galerkin(time=2): 4}
STEPS = (2e-2, 1e-2, 5e-3, 1e-3)
A = cy.Body(mass=2.0, inertia=[0.03, 0.02, 0.04], name="a")
TURN = quaternion.from_rotation_vector([0.3, 0.2, -0.4])
B = cy.Body(mass=1.0, inertia=[0.01, 0.03, 0.02], position=(0.5, 0.2, 0.1), rotation=TURN, name="b")
MIDDLE = np.array([0.3, 0.1, 0.2])
ON_A = A.centre.offset(MIDDLE)
ON_B = B.centre.offset(quaternion.inverse_rotate(TURN, MIDDLE - np.array(B.position)))
AXIS = np.array([0.3, -1.0, 0.5])
AXIS /= np.linalg.norm(AXIS)
PAIRS = {
    "weld": joints.weld(ON_A, ON_B),
    "ball": joints.ball(ON_A, ON_B),
    "hinge": joints.hinge(ON_A, ON_B, axis=AXIS),
    "universal": joints.universal(ON_A, ON_B, axis=(1, 0, 0), other=(0, 1, 0)),
    "slider": joints.slider(ON_A, ON_B, axis=AXIS),
    "cylindrical": joints.cylindrical(ON_A, ON_B, axis=AXIS),
    "planar": joints.planar(ON_A, ON_B, normal=AXIS),
    "link": joints.rigid_link(A.centre, B.centre),
}


def turned(t: float) -> float:
    return 2.0 * np.sin(3.0 * t)


def pushed(t: float) -> float:
    return 0.3 * t * t


def shaken(t: float) -> tuple[float, float, float]:
    return (0.1 * (1.0 - np.cos(5.0 * t)), 0.0, 0.05 * t * t)


DRIVEN = {
    "motor": joints.hinge(ON_A, ON_B, axis=AXIS, angle=turned),
    "ram": joints.slider(ON_A, ON_B, axis=AXIS, displacement=pushed),
    "screw": joints.cylindrical(ON_A, ON_B, axis=AXIS, angle=turned, displacement=pushed),
    "table": joints.hinge(ON_A, ON_B, axis=AXIS, angle=([0.0, 0.5, 1.0], [0.0, 1.0, 1.0])),
}


def violation(run: cy.Trajectory) -> float:
    """Largest |g| of all joints at all frames."""
    system, found = run.system, []
    for joint in system.joints:
        function = evaluator(joint_program(joint.kind, system.layout, grounded=joint.grounded, what="slope"))
        for values, time in zip(run.frames.values, run.time, strict=True):
            inputs = joint_inputs(joint, values, ground_values(system.layout), float(time))
            found.append(np.abs(function(inputs)[0, : joint.count]).max())
    return max(found)


def order(
    model: cy.Model, rule: cy.rules.Rule, initial=None, steps: tuple[float, ...] = STEPS
) -> tuple[float, cy.Trajectory]:
    """Observed order of the last states, and the finest run."""
    run = functools.partial(cy.simulate, model, t_end=1.0, rule=rule, save_every=0.1, initial=initial)
    runs = [run(dt=dt) for dt in steps]
    errors = [np.abs(one.frames.values[-1] - runs[-1].frames.values[-1]).max() for one in runs[:-1]]
    return float(np.log2(errors[-2] / errors[-1])), runs[-1]


@pytest.mark.parametrize("rule", RULES, ids=str)
@pytest.mark.parametrize("kind", PAIRS)
def test_two_bodies_in_flight(kind, rule):
    """A start that moves as one and then comes apart as the joint lets it: order, closure, momenta, energy."""
    spin, speed = np.array([1.0, 2.0, -1.5]), np.array([0.1, 0.2, 0.3])
    initial = {}
    for body in (A, B):
        x, p = body.place(0)
        initial[body] = {"velocity": np.cross(spin, x) + speed, "angular_velocity": quaternion.inverse_rotate(p, spin)}
    found, run = order(cy.Model(A, B, joints=[PAIRS[kind]]), rule, initial)
    assert found == pytest.approx(RULES[rule], abs=0.2)
    assert violation(run) < 1e-14
    assert np.ptp(run.linear_momentum.values, axis=0).max() < 1e-13
    assert np.ptp(run.angular_momentum.values, axis=0).max() < 1e-13
    assert np.ptp(run.energy.values) < {2: 1e-5, 4: 1e-11}[RULES[rule]]


@pytest.mark.parametrize("rule", RULES, ids=str)
@pytest.mark.parametrize("name", DRIVEN)
def test_driven_pair(name, rule):
    """A motor is an inner moment: it moves both parts as told and no momentum comes of it."""
    found, run = order(cy.Model(A, B, joints=[DRIVEN[name]]), rule)
    assert found == pytest.approx(RULES[rule], abs=0.3)
    assert violation(run) < 1e-13
    total = run.linear_momentum.values
    assert np.abs(total - total[0]).max() < 1e-12
    relative = quaternion.relative(run["a"].rotation.values, run["b"].rotation.values)
    start = quaternion.relative(relative[0], relative)
    told = DRIVEN[name].motion("angle", run.time)[:, 0]
    assert_allclose(np.linalg.norm(quaternion.to_rotation_vector(start), axis=1), np.abs(told), atol=1e-12)


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_shaken(rule):
    """A body moved as prescribed carries another on a ball joint."""
    shaker = supports.drive(A.centre, position=shaken, rotation=lambda t: (0.2 * t * t, 0.0, 0.0))
    found, run = order(cy.Model(A, B, supports=[shaker], joints=[PAIRS["ball"]]), rule)
    assert found == pytest.approx(RULES[rule], abs=0.2)
    assert_allclose(run["a"].position, [shaken(t) for t in run.time], atol=1e-14)
    assert violation(run) < 1e-13


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_double_pendulum(rule):
    """Two plates hinged in the plane, against SciPy on the two angles."""
    inertia, mass, half, g = 0.02, 1.5, 0.25, 9.81
    plates = [
        cy.Body(mass=mass, inertia=[inertia] * 3, position=(half * k, 0, 0), name=name)
        for k, name in ((1, "upper"), (3, "lower"))
    ]
    upper, lower = plates
    between = joints.hinge(upper.centre.offset((half, 0, 0)), lower.centre.offset((-half, 0, 0)), axis=(0, 1, 0))
    model = cy.Model(
        upper,
        lower,
        supports=[supports.turn(upper.centre.offset((-half, 0, 0)), (0, 1, 0))],
        joints=[between],
        loads=[loads.gravity((0, 0, -g))],
    )

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        """Angles below the horizontal; M q'' = f by Lagrange's equations."""
        a, b, va, vb = state
        cosine, sine = np.cos(a - b), np.sin(a - b)
        coupling = 2.0 * mass * half * half
        matrix = np.array(
            [
                [inertia + mass * half**2 + 4 * mass * half**2, coupling * cosine],
                [coupling * cosine, inertia + mass * half**2],
            ]
        )
        force = np.array(
            [
                -coupling * sine * vb**2 + 3 * mass * g * half * np.cos(a),
                coupling * sine * va**2 + mass * g * half * np.cos(b),
            ]
        )
        return np.array([va, vb, *np.linalg.solve(matrix, force)])

    known = solve_ivp(rates, (0.0, 1.0), np.zeros(4), method="DOP853", rtol=1e-12, atol=1e-12).y[:2, -1]
    found, run = order(model, rule, steps=(4e-3, 2e-3, 1e-3, 2.5e-4))
    assert found == pytest.approx(RULES[rule], abs=0.3)
    angles = [
        2.0 * np.arctan2(run[n].rotation[-1].values[2], run[n].rotation[-1].values[0]) for n in ("upper", "lower")
    ]
    error = np.abs((np.array(angles) - known + np.pi) % (2 * np.pi) - np.pi).max()
    assert error < {2: 1e-5, 4: 1e-9}[RULES[rule]]


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_spring_and_damper(rule):
    """m x'' = −k (x − l) − c x' against its solution; a rotational one against the same in an angle."""
    mass, k, c, stretched = 2.0, 50.0, 3.0, 0.2
    body = cy.Body(mass=mass, inertia=[0.4, 0.4, 0.4], position=(1.0 + stretched, 0, 0))
    ties = [
        springs.linear(body.centre, cy.ground.at((0, 0, 0)), stiffness=k, damping=c, length=1.0),
        springs.rotational(body.centre, axis=(1, 0, 0), stiffness=10.0, damping=0.6, angle=0.3),
    ]
    run = cy.simulate(cy.Model(body, springs=ties), t_end=2.0, dt=1e-3, rule=rule, save_every=0.05)

    def decay(m: float, k: float, c: float, start: float) -> np.ndarray:
        rate = 0.5 * c / m
        omega = np.sqrt(k / m - rate**2)
        return start * np.exp(-rate * run.time) * (np.cos(omega * run.time) + rate / omega * np.sin(omega * run.time))

    accuracy = {2: 2e-6, 4: 1e-11}[RULES[rule]]
    assert_allclose(run["body"].position[:, 0], 1.0 + decay(mass, k, c, stretched), atol=accuracy)
    angle = 2.0 * np.arctan2(run["body"].rotation[:, 1].values, run["body"].rotation[:, 0].values)
    assert_allclose(angle, 0.3 + decay(0.4, 10.0, 0.6, -0.3), atol=accuracy)
    assert np.all(np.diff(run.energy.values) < 1e-12)


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_bushing_between_two_bodies(rule):
    """Undamped it keeps energy and momenta, damped it takes energy and keeps momenta; order of the rule."""
    stiffness = [20.0, 30.0, 40.0, 1.0, 2.0, 3.0]
    initial = {B: {"velocity": (0.5, 0.2, 0.0), "angular_velocity": (0.0, 1.0, 2.0)}}
    for damping in (0.0, [1.0, 1.0, 1.0, 0.1, 0.1, 0.1]):
        tie = springs.bushing(ON_A, ON_B, stiffness=stiffness, damping=damping)
        found, run = order(cy.Model(A, B, springs=[tie]), rule, initial)
        assert found == pytest.approx(RULES[rule], abs=0.2)
        assert np.ptp(run.linear_momentum.values, axis=0).max() < 1e-13
        assert np.ptp(run.angular_momentum.values, axis=0).max() < 1e-13
        lost = run.energy.values[0] - run.energy.values[-1]
        assert abs(lost) < 1e-4 if np.ndim(damping) == 0 else lost > 0.01


@pytest.mark.parametrize("rule", [rules.verlet, rules.nodal, rules.spectral(space=2)], ids=str)
@pytest.mark.parametrize("damped", [0.0, 1.0])
@pytest.mark.parametrize("hung", [False, True])
def test_springs_on_a_damped_rod(rule, damped, hung):
    """The velocities that damping in the rod takes, predicted by explicit rules, know springs: order 2."""
    rubber = cy.Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.5)
    section = cy.Section.circle(0.05, rubber)
    rod = cy.Rod(section, length=1.0, elements=4, damping=cy.damping.retardation(1e-3), name="rod")
    bob = cy.Body(mass=0.5, inertia=[0.01] * 3, position=(0, 0, 1.2), name="bob")
    ties = [springs.linear(rod.node(2), bob.centre, stiffness=100.0, damping=damped)]
    joined = [joints.ball(rod.end, bob.centre.offset((0, 0, -0.2)))] if hung else []
    pulled = [loads.gravity((1.0, 1.0, -9.81))]
    model = cy.Model(rod, bob, supports=[supports.clamp(rod.start)], joints=joined, springs=ties, loads=pulled)
    runs = [cy.simulate(model, 0.1, dt, rule=rule, save_every=0.05) for dt in (1e-3, 5e-4, 2.5e-4, 1.25e-4)]
    changes = [np.abs(b.frames.values[-1] - a.frames.values[-1]).max() for a, b in itertools.pairwise(runs)]
    assert np.log2(changes[-2] / changes[-1]) == pytest.approx(2.0, abs=0.2)
    defects = [float(np.abs(run.energy_balance.defect).max()) for run in runs]
    assert np.log2(defects[-2] / defects[-1]) == pytest.approx(2.0, abs=0.3)


def test_springs_restrict_no_candidate():
    """A soft spring is stepped explicitly, and so is a stiff one beside it as long as that is cheap."""
    soft = springs.linear(ON_A, B.centre, stiffness=20.0, length=0.1)
    stiff = springs.linear(A.centre, ON_B, stiffness=1e9)
    for ties in ([soft], [soft, stiff]):
        run = cy.simulate(cy.Model(A, B, springs=ties), t_end=0.5, accuracy=1e-3)
        assert run.rule == "verlet"


def test_more_explicit_steps_with_springs_than_one_call_takes():
    """What is handed from call to call is nothing where there are no multipliers."""
    model = cy.Model(A, B, springs=[springs.linear(ON_A, B.centre, stiffness=1e4)])
    start = {B: {"velocity": (0.1, 0.0, 0.0)}}
    options = {"rule": rules.verlet, "dt": 1e-5, "initial": start}
    run = cy.simulate(model, t_end=0.3, save_every=0.1, **options)
    assert run.steps == 30_000 > coupled_run.CHUNK
    half = cy.simulate(model, t_end=0.15, save_every=0.15, **options)
    on = cy.integrate(half.system, half.state, t_end=0.3, save_every=0.15)
    assert_allclose(on.frames.values[-1], run.frames.values[-1], rtol=0.0, atol=1e-12)
    assert np.ptp(run.energy.values) < 1e-9


def test_frame_of_rods_with_a_body():
    """Welded tubes with a weight on a ball joint: three rules agree, and the ball stays closed."""
    steel = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
    tube = cy.Section.tube(outer_radius=0.02, thickness=0.002, material=steel)
    mast = cy.Rod(tube, length=2.0, direction=(0, 0, 1), elements=4, name="mast")
    arm = cy.Rod(tube, length=1.0, origin=(0, 0, 2), direction=(1, 0, 0), elements=3, name="arm")
    bob = cy.Body(mass=2.0, inertia=[0.01] * 3, position=(1, 0, 1.7), name="bob", ports={"eye": (0, 0, 0.3)})
    ties = [joints.weld(mast.end, arm.start), joints.ball(arm.end, bob.port("eye"))]
    held = [supports.clamp(mast.start)]
    model = cy.Model(mast, arm, bob, supports=held, joints=ties, loads=[loads.gravity((0, 0, -9.81))])
    places = []
    for rule, dt in ((rules.verlet, None), (rules.midpoint, 5e-4), (rules.galerkin(time=2), 2e-3)):
        run = cy.simulate(model, t_end=0.1, dt=dt, rule=rule, save_every=0.01)
        gap = run.port(arm, "end").position.values - run.port(bob, "eye").position.values
        assert np.abs(gap).max() < 1e-14
        places.append(run["bob"].position[-1].values)
    assert_allclose(places[1:], [places[0]] * 2, atol=5e-6)


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint], ids=str)
def test_goes_on_bit_for_bit(rule, tmp_path):
    """A run with a driven joint, saved half way, opened and continued."""
    model = cy.Model(A, B, joints=[DRIVEN["motor"]])
    options = {"dt": 1e-3, "rule": rule, "save_every": 0.05}
    whole = cy.simulate(model, t_end=0.2, **options)
    half = cy.simulate(model, t_end=0.1, **options)
    half.save(tmp_path / "run")
    opened = cy.Trajectory.open(tmp_path / "run", model=model)
    on = cy.integrate(opened.system, opened.state, t_end=0.2, save_every=0.05)
    assert_allclose(on.frames.values[-1], whole.frames.values[-1], rtol=0.0, atol=0.0)
    assert str(cy.Trajectory.open(tmp_path / "run").model) == str(model)


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_closed_loop(rule):
    """A four-bar linkage in a plane, without a redundant constraint: it stays closed and flat, energy is kept."""
    places = np.array([(0, 0, 0), (0, 0, 1), (2, 0, 1.4), (2, 0, 0)], dtype=float)
    bars = []
    for k, name in enumerate(("crank", "coupler", "rocker")):
        middle, half = 0.5 * (places[k] + places[k + 1]), 0.5 * (places[k + 1] - places[k])
        ports = {"near": tuple(-half), "far": tuple(half)}
        bars.append(cy.Body(mass=1.0, inertia=[0.02, 0.03, 0.04], position=tuple(middle), ports=ports, name=name))
    crank, coupler, rocker = bars
    out = (0, 1, 0)
    ties = [
        joints.hinge(crank.port("far"), coupler.port("near"), axis=out),
        joints.universal(coupler.port("far"), rocker.port("near"), axis=out, other=(1, 0, 0)),
        joints.ball(rocker.port("far")),
    ]
    held = [supports.turn(crank.port("near"), out)]
    model = cy.Model(*bars, supports=held, joints=ties, loads=[loads.gravity((0.5, 0, -9.81))])
    found, run = order(model, rule, steps=(1e-2, 5e-3, 2.5e-3, 5e-4))
    assert found == pytest.approx(RULES[rule], abs=0.3)
    assert violation(run) < 1e-13
    assert np.abs(run.port(rocker, "far").position - places[3]).max() < 1e-13
    assert np.abs(run[coupler].position[:, 1]).max() < 1e-9
    assert np.ptp(run.energy.values) < {2: 1e-4, 4: 1e-9}[RULES[rule]]
    assert np.ptp(run[crank].rotation.values[:, 2]) > 0.1
    last = supports.turn(rocker.port("far"), out)
    hinged = [ties[0], joints.hinge(coupler.port("far"), rocker.port("near"), axis=out), last]
    with pytest.raises(ValueError, match=r"joints? (are|is) redundant at the start"):
        cy.simulate(model.replace(joints=hinged), t_end=0.1, dt=1e-3, rule=rule)


@pytest.mark.parametrize("h", [1e-5, 1e-7])
@pytest.mark.parametrize("rule", [cy.rules.midpoint, cy.rules.galerkin(time=2)], ids=str)
def test_short_steps_are_no_redundant_joints(rule, h):
    """h²/m is far below rounding beside the derivatives of a joint; pivots are scaled so that it does not count."""
    spin = np.array([0.0, 150.0, -4.61538])
    inertia, pivot = np.diag([0.234375, 0.46875, 0.234375]), (0, -1, 0)
    top = cy.Body(mass=15.0, inertia=inertia, position=(0, 1, 0), ports={"pivot": pivot})
    model = cy.Model(top, joints=[joints.ball(top.port("pivot"), cy.ground)], loads=[loads.gravity((0, 0, -9.81))])
    start = {top: {"angular_velocity": spin, "velocity": np.cross(spin, (0, 1, 0))}}
    run = cy.simulate(model, t_end=20 * h, dt=h, rule=rule, initial=start, save_every=10 * h)
    assert np.abs(run.port(top, "pivot").position.values).max() < 1e-15


def test_joints_of_light_nodes_are_not_redundant():
    """A hair of 0.1 mm: nodes of 1e-16 kg m² beside derivatives of a joint of size one."""
    hair = cy.Section.circle(1e-4, cy.Material(density=1000.0, youngs_modulus=1e9, poisson_ratio=0.3))
    one = cy.Rod(hair, length=0.05, elements=10, direction=(1, 0, 0))
    two = cy.Rod(hair, length=0.05, elements=10, origin=(0.05, 0, 0), direction=(1, 0, 0))
    both = cy.Rod(hair, length=0.1, elements=20, direction=(1, 0, 0))
    weight, options = loads.gravity((0, 0, -9.81)), {"t_end": 0.01, "dt": 1e-3, "rule": cy.rules.midpoint}
    tied = cy.Model(
        one, two, supports=[supports.clamp(one.start)], joints=[joints.weld(one.end, two.start)], loads=[weight]
    )
    whole = cy.simulate(cy.Model(both, supports=[supports.clamp(both.start)], loads=[weight]), **options)
    run = cy.simulate(tied, **options)
    assert np.abs(run[two].position.values - whole[both].position.values[:, 10:]).max() < 1e-9
    assert np.isfinite(run.joint(tied.joints[0]).force.values).all()
