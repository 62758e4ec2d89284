"""Steps by the implicit rules: every density, loads, supports, several rods, how runs are cut, and how they end."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads, supports
from cayley.lie import cayley, quaternion
from cayley.steppers import implicit_run
from cayley.steppers.outcome import Outcome
from cayley.system.discretize import discretize, spans
from cayley.system.legendre import initial_state
from unit.density.examples import EXAMPLES
from unit.steppers.test_action import LENGTH, Action, start_of
from unit.system.rods import round_rod, three_rods

midpoint, nodal_midpoint, galerkin = cy.rules.midpoint, cy.rules.nodal_midpoint, cy.rules.galerkin
RULES = [midpoint, nodal_midpoint, galerkin(time=2), galerkin(time=3), galerkin(time=2, space=2)]
each_rule = pytest.mark.parametrize("rule", RULES, ids=str)
SPAN = 0.2


def end_of(name, rule, steps):
    """Last values of an example on three elements, from 0.3 s on."""
    lagrangian, constants = EXAMPLES[name]
    domain = None if lagrangian.interval is None else cy.Interval(0.0, LENGTH, elements=3)
    system = cy.compile(lagrangian, rule=rule, domain=domain, constants=constants)
    start = start_of(Action(name, cy.rules.verlet))
    run = cy.integrate(
        system, start, 0.3 + SPAN, SPAN / steps, save_every=SPAN, t_start=0.3, allow_unstable=not rule.implicit
    )
    return run.frames.values[-1]


def limit_of(name, rule=cy.rules.verlet, steps=2000):
    """The same for a step that tends to zero, by extrapolation from two."""
    return (4.0 * end_of(name, rule, 2 * steps) - end_of(name, rule, steps)) / 3.0


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_density_moves_as_it_does_explicitly(name):
    """Coupled, gyroscopic, explicit in s and t, quartic in the velocity: the limit is that of verlet."""
    assert_allclose(end_of(name, galerkin(time=3), 40), limit_of(name), rtol=0, atol=3e-9)


@pytest.mark.parametrize("name", ["rod", "mixed", "two_bodies", "driven"])
def test_midpoint_tends_to_the_same_limit(name):
    expected = limit_of(name)
    errors = [np.abs(end_of(name, midpoint, steps) - expected).max() for steps in (100, 200)]
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.1)


def loaded(frame):
    """Two rods of different materials and sections, held in parts, with loads that are functions of time."""
    a = round_rod(3, radius=0.04, modulus=4e6, name="a")
    b = round_rod(4, length=0.8, radius=0.03, name="b", origin=(0, 1, 0))
    held = [supports.clamp(a.start), supports.hold(b.start, position="xz", rotation="xy"), supports.pin(b.end)]

    def pulse(t):
        return np.array([6.0 * np.sin(40.0 * t), 4.0 * t, -3.0])

    acting = [
        loads.gravity((0.3, 0.0, -9.81)),
        loads.force(a.end, pulse, frame=frame),
        loads.moment(a.node(2), lambda t: 0.3 * pulse(t), frame=frame),
        loads.line_force(b, pulse, frame=frame),
        loads.line_moment(b, (0.2, 0.3, 0.5), frame=frame),
        loads.moment(b.start, (0.3, -0.2, 0.8), frame=frame),
    ]
    return cy.Model(a, b, supports=held, loads=acting)


@pytest.mark.parametrize("frame", ["space", "body"])
def test_loads_and_supports_act_as_they_do_explicitly(frame):
    """Forces and moments at nodes and along rods of different materials, at the limit of small explicit steps."""
    model, span = loaded(frame), 0.04

    def end(rule, steps):
        return cy.simulate(model, span, span / steps, rule=rule, save_every=span).frames.values[[0, -1]]

    expected = (4.0 * end(cy.rules.verlet, 16_000)[1] - end(cy.rules.verlet, 8000)[1]) / 3.0
    found = end(galerkin(time=3), 200)
    assert np.abs(found[1] - found[0]).max() > 0.05
    assert_allclose(found[1], expected, rtol=0, atol=2e-9)
    corners = (4.0 * end(cy.rules.nodal, 16_000)[1] - end(cy.rules.nodal, 8000)[1]) / 3.0
    halving = [np.abs(end(nodal_midpoint, steps)[1] - corners).max() for steps in (500, 1000)]
    assert halving[0] / halving[1] == pytest.approx(4.0, abs=0.4)


@each_rule
@pytest.mark.parametrize(("start", "until"), [(0.0, 7.3), (3.2, 3.9), (11.5, 60.25), (2.0, 1e9)])
def test_window(start, until, rule):
    """A constant force between two times gives its impulse, wherever steps and saves fall."""
    rod, h, force = round_rod(2, name="rod"), 1e-4, np.array([0.3, -0.2, 0.5])
    push = loads.force(rod.end, force, start=start * h, until=until * h)
    start_it = {"rod": {"velocity": lambda s: (1.0, -2.0, s), "angular_velocity": (0.0, 30.0, -20.0)}}
    run = cy.simulate(cy.Model(rod, loads=[push]), 70 * h, h, rule=rule, save_every=7 * h, initial=start_it)
    momentum = run.linear_momentum.values
    assert_allclose(momentum[-1] - momentum[0], force * (min(until, 70) - start) * h, rtol=0, atol=1e-11)


def test_function_of_time_is_taken_at_the_stages():
    """Gauss points of every step; a function that branches is taken as well as one that is traced."""
    rod, h, steps = round_rod(2, name="rod"), 1e-3, 20
    rule = galerkin(time=2)
    times = h * (np.arange(steps)[:, None] + np.array(rule.time.at))
    expected = h * (np.sin(70.0 * times) @ np.array(rule.time.weights)).sum() * np.array([0.3, -0.2, 0.5])
    for value in (lambda t: np.array([0.3, -0.2, 0.5]) * np.sin(70.0 * t), branching):
        model = cy.Model(rod, loads=[loads.force(rod.end, value)])
        run = cy.simulate(model, steps * h, h, rule=rule, save_every=steps * h)
        assert_allclose(run.linear_momentum.values[-1], expected, rtol=0, atol=1e-12)


def branching(t):
    return np.array([0.3, -0.2, 0.5]) * np.sin(70.0 * t) if t > 0.0 else np.zeros(3)


def held_rod(support, rule, h=2e-4):
    """A rod under weight and moments with node 2 supported, saved at every step; values of that node."""
    rod = round_rod(4, name="rod", direction=(1, 2, -1))
    acting = [
        loads.gravity((1.0, 2.0, -9.81)),
        loads.line_moment(rod, (0.1, 0.2, 0.05)),
        loads.force(rod.end, (1.0, 1.0, 1.0)),
    ]
    model = cy.Model(rod, supports=[support(rod)], loads=acting)
    run = cy.simulate(model, 60 * h, h, save_every=h, rule=rule)
    return run["rod"].isel(node=2 * rule.degree), run


@each_rule
@pytest.mark.parametrize("letters", ["x", "yz", "xyz"])
def test_positions_held_bit_for_bit(letters, rule):
    data, _ = held_rod(lambda rod: supports.hold(rod.node(2), position=letters), rule)
    position = data.position.values
    for axis, letter in enumerate("xyz"):
        if letter in letters:
            assert np.array_equal(position[:, axis], np.full(len(position), position[0, axis]))
        else:
            assert abs(position[-1, axis] - position[0, axis]) > 1e-6


@each_rule
def test_clamp_held_bit_for_bit(rule):
    data, run = held_rod(lambda rod: supports.clamp(rod.node(2)), rule)
    assert np.array_equal(data.rotation.values, np.broadcast_to(data.rotation.values[0], data.rotation.shape))
    assert np.array_equal(data.position.values, np.broadcast_to(data.position.values[0], data.position.shape))
    assert np.abs(run.frames.values[-1] - run.frames.values[0]).max() > 1e-4


@each_rule
def test_a_clamp_stays_for_a_thousand_steps(rule):
    """What a step leaves of a held component must not grow in the steps after it."""
    rod = round_rod(2, radius=0.05, name="rod", origin=(0.3, 0.2, 0.1))
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[loads.gravity((0.0, 0.0, -9.81))])
    run = cy.simulate(model, 1.0, 1e-3, rule=rule, save_every=0.1)
    assert np.abs(run.frames.values[:, 0] - run.frames.values[0, 0]).max() < 1e-13


@each_rule
@pytest.mark.parametrize("letters", ["x", "z"])
def test_one_axis_of_a_rotation_held(letters, rule):
    """No step turns about a held body axis."""
    data, _ = held_rod(lambda rod: supports.hold(rod.node(2), rotation=letters), rule)
    p = data.rotation.values
    f = cayley.cay_inv(quaternion.multiply(quaternion.conjugate(p[:-1]), p[1:]))
    for axis, letter in enumerate("xyz"):
        assert (np.abs(f[:, axis]).max() < 1e-15) == (letter in letters)


def test_a_hinge():
    """Two body axes held: the third stays where it is in space."""
    data, _ = held_rod(lambda rod: supports.hold(rod.node(2), rotation="xy"), midpoint)
    axis = quaternion.to_matrix(data.rotation.values)[..., 2]
    assert_allclose(axis, np.broadcast_to(axis[0], axis.shape), rtol=0, atol=1e-13)
    assert np.abs(data.angular_velocity.values[:, 2]).max() > 1.0


@each_rule
def test_rods_of_one_model_do_not_disturb_each_other(rule):
    """Three rods of different sections, materials, lengths, supports and loads, together and each by itself."""
    together, alone = three_rods()
    run = cy.simulate(together, 0.03, 1e-3, rule=rule, save_every=0.01)
    for model, nodes in zip(alone, spans(together, rule.degree), strict=True):
        one = cy.simulate(model, 0.03, 1e-3, rule=rule, save_every=0.01)
        assert_allclose(run.frames.values[:, nodes], one.frames.values, rtol=0, atol=1e-10)
        scale = np.abs(one.frames.momenta).max()
        assert_allclose(run.frames.momenta[:, nodes], one.frames.momenta, rtol=0, atol=1e-8 * scale)


@each_rule
def test_how_a_run_is_cut_does_not_change_a_bit(rule, monkeypatch):
    """Calls of the driver, saves and a stop in between."""
    model = loaded("body")
    whole = cy.simulate(model, 0.024, 1e-3, rule=rule, save_every=0.024)
    monkeypatch.setattr(implicit_run, "CHUNK", 5)
    often = cy.simulate(model, 0.024, 1e-3, rule=rule, save_every=2e-3)
    assert np.array_equal(whole.frames.values[-1], often.frames.values[-1])
    half = cy.simulate(model, 0.012, 1e-3, rule=rule, save_every=0.012)
    rest = cy.integrate(half.system, half.state, 0.024, 1e-3, save_every=0.012)
    assert np.array_equal(whole.frames.values[-1], rest.frames.values[-1])
    assert np.array_equal(whole.frames.momenta[-1], rest.frames.momenta[-1])


def test_absurd_step():
    """Time, step, node, rod, reason and remedy in one line; what was saved before is a good run."""
    a, b = round_rod(2, name="a"), round_rod(4, name="b", origin=(0, 1, 0))
    model = cy.Model(a, b, supports=[supports.pin(b.start)], loads=[loads.gravity((0, 0, -9.81))])
    with pytest.raises(cy.SimulationError) as caught:
        cy.simulate(model, 400.0, 2.0, rule=galerkin(time=2), save_every=2.0)
    message, partial = str(caught.value), caught.value.partial
    assert "\n" not in message
    for part in ("stopped at t = ", "at node ", " of b: ", "Newton's method did not converge", "give dt below 1 s"):
        assert part in message
    stopped = float(message.split("t = ")[1].split(" s")[0])
    assert stopped == pytest.approx(2.0 * int(message.split("(step ")[1].split(")")[0]))
    assert partial.time[-1] == pytest.approx(stopped)
    assert np.isfinite(partial.frames.values).all()


@pytest.mark.parametrize("rule", [midpoint, galerkin(time=2)], ids=str)
def test_not_a_number_stops_the_run(rule):
    """A load of the square root of less than nothing, from 0.5 s on."""

    @cy.lagrangian(x=cy.Vector(1))
    def falling(q, c):
        return 0.5 * q.x_t[0] ** 2 + q.x[0] * np.sqrt(0.5 - q.t)

    system = cy.compile(falling, rule=rule)
    with pytest.raises(cy.SimulationError, match=r"stopped at t = 0\.5 s \(step 5\)"):
        cy.integrate(system, {"x": 1.0}, 1.0, 0.1, save_every=0.1)


@each_rule
def test_result_of_a_stretch(rule):
    """Steppers report; they do not raise."""
    system = discretize(loaded("space"), rule)
    start = initial_state(system, system.reference, np.zeros((system.size, 6))).at_step(1e-3)
    received, told = [], []
    result = implicit_run.run(
        system,
        start,
        stride=5,
        saves=3,
        receive=lambda *frames: received.append(frames),
        progress=lambda *done: told.append(done),
    )
    assert result.outcome is Outcome.FINISHED
    assert (result.step, result.node) == (15, -1)
    assert result.state.time == pytest.approx(15e-3)
    assert sum(len(frames[0]) for frames in received) == 3
    assert told[-1] == (1.0, pytest.approx(15e-3))
    bad = initial_state(system, system.reference, np.full((system.size, 6), np.nan)).at_step(1e-3)
    result = implicit_run.run(system, bad, stride=5, saves=3, receive=lambda *frames: received.append(frames))
    assert result.outcome is Outcome.NOT_CONVERGED
    assert result.step == 0
    assert np.array_equal(result.state.values, bad.values)
    assert sum(len(frames[0]) for frames in received) == 3


@each_rule
def test_matrices_move_as_quaternions_do(rule):
    """Loads in the body frame, held components, results along the rods, and a run that goes on bit for bit."""
    model = loaded("body")
    runs = [
        cy.simulate(model, 0.02, 1e-3, rule=rule, rotation=form, save_every=0.01) for form in ("quaternion", "matrix")
    ]
    for name in model.names:
        for quantity in ("position", "rotation", "velocity", "angular_velocity", "moment", "force"):
            one, other = (run[name][quantity].values for run in runs)
            rounding = 1e-9 if quantity == "force" else 0.0  # of a strain, times 2e4 N
            assert_allclose(other, one, rtol=0, atol=1e-12 * np.abs(one).max() + rounding)
    whole = runs[1]
    turned = whole.frames.values[..., whole.system.layout.rows_of("p")].reshape(*whole.frames.values.shape[:2], 3, 3)
    assert_allclose(turned @ np.swapaxes(turned, -1, -2), np.broadcast_to(np.eye(3), turned.shape), rtol=0, atol=1e-14)
    half = cy.simulate(model, 0.01, 1e-3, rule=rule, rotation="matrix", save_every=0.01)
    rest = cy.integrate(half.system, half.state, 0.02, 1e-3, save_every=0.01)
    assert np.array_equal(whole.frames.values[-1], rest.frames.values[-1])
    assert np.array_equal(whole.frames.momenta[-1], rest.frames.momenta[-1])
