"""How runs end badly: when, where, what is left, and what the message says."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads
from cayley.steppers import decoupled_run
from cayley.steppers.outcome import Outcome
from cayley.system.discretize import discretize
from cayley.system.legendre import initial_state
from unit.system.rods import round_rod


@cy.lagrangian(x=cy.Vector(1))
def oscillator(q, c):
    return 0.5 * q.x_t[0] ** 2 - 0.5 * q.x[0] ** 2


def spun() -> tuple[cy.Model, float, float]:
    """A rod that a moment about its axis spins up; steps of h can be solved while h ω < 1."""
    rod, moment = round_rod(3, name="drill"), 0.2
    return (
        cy.Model(rod, loads=[loads.line_moment(rod, (0, 0, moment), frame="body")]),
        moment,
        rod.section.inertia[2, 2],
    )


def test_newton_failure():
    """ω = m t/J; the discrete momentum 2 f/(1 + f·f) has a largest value, reached at h ω = 1."""
    model, moment, inertia = spun()
    h = 1e-4
    t_fail = inertia / (moment * h)
    save = 100 * h
    with pytest.raises(cy.SimulationError) as caught:
        cy.simulate(model, 2.0 * t_fail, h, save_every=save)
    message, partial = str(caught.value), caught.value.partial
    assert "\n" not in message
    for part in ("stopped at t = ", "at node ", " of drill: ", "Newton's method did not converge", "give ", ".partial"):
        assert part in message
    stopped = float(message.split("t = ")[1].split(" s")[0])
    step = int(message.split("(step ")[1].split(")")[0])
    assert stopped == pytest.approx(t_fail, rel=0.01)
    assert stopped == pytest.approx(step * partial.dt, rel=1e-5)
    assert partial.time[-1] <= stopped < partial.time[-1] + save
    omega = partial["drill"].angular_velocity.values[-1, :, 2]
    assert_allclose(omega, moment * partial.time[-1] / inertia, rtol=1e-6)


def test_partial_run_is_the_run_so_far():
    """What was saved before a failure is bit for bit what a shorter run gives, and one can go on from it."""
    model, _, _ = spun()
    h = 1e-4
    save = 100 * h
    with pytest.raises(cy.SimulationError) as caught:
        cy.simulate(model, 2000 * save, h, save_every=save)
    partial = caught.value.partial
    whole = cy.simulate(model, partial.time[-1], h, save_every=save)
    assert np.array_equal(partial.frames.values, whole.frames.values)
    assert np.array_equal(partial.frames.momenta, whole.frames.momenta)
    assert np.isfinite(partial.energy.values).all()
    system = discretize(model, cy.rules.verlet)
    gone_on = cy.integrate(system, partial.state, partial.time[-1] + save, 0.1 * h)
    assert gone_on.time[-1] == pytest.approx(partial.time[-1] + save)


def test_failure_before_the_first_save():
    rod = round_rod(2, name="top")
    with pytest.raises(
        cy.SimulationError, match=r"stopped at t = 0 s \(step 0\) at node \d of top: .* did not conv"
    ) as caught:
        cy.simulate(cy.Model(rod), 0.1, 1e-4, initial={"top": {"angular_velocity": (0, 0, 2e4)}})
    assert len(caught.value.partial.time) == 1
    assert caught.value.partial["top"].position.shape == (1, 3, 3)


def test_failing_node_is_named():
    """Only the end node turns too fast."""
    rod = round_rod(12, name="whip")
    omega = np.zeros((13, 3))
    omega[9, 0] = 3e4
    with pytest.raises(cy.SimulationError, match=r"\(step 0\) at node 9 of whip"):
        cy.simulate(cy.Model(rod), 0.1, 1e-4, initial={"whip": {"angular_velocity": omega}})


def test_failing_rod_is_named():
    a, b = round_rod(4, name="a"), round_rod(5, origin=(0, 1, 0), name="b")
    omega = np.zeros((6, 3))
    omega[2, 1] = 3e4
    with pytest.raises(cy.SimulationError, match=r"at node 2 of b:"):
        cy.simulate(cy.Model(a, b), 0.1, 1e-4, initial={"b": {"angular_velocity": omega}})


def test_blow_up():
    """Over the limit by a factor the oscillation grows by a known one until it overflows."""
    system = cy.compile(oscillator, rule=cy.rules.nodal)
    assert system.stable_dt() == pytest.approx(2.0)
    h = 2.5
    growth = (h**2 - 2 + np.sqrt((h**2 - 2) ** 2 - 4)) / 2
    with pytest.raises(cy.SimulationError) as caught:
        cy.integrate(system, {"x": 1.0}, 2000 * h, h, save_every=10 * h, allow_unstable=True)
    message, partial = str(caught.value), caught.value.partial
    assert "\n" not in message
    assert (
        "the state is no longer finite: the motion blew up; dt is over the step limit 2 s there: give less" in message
    )
    assert "node" not in message
    step = int(message.split("(step ")[1].split(")")[0])
    assert step == pytest.approx(np.log(1e308) / np.log(growth), abs=3)
    assert np.isfinite(partial.frames.values).all()
    assert partial.frames.steps[-1] == step - step % 10
    assert abs(partial.frames.values[-1, 0, 0]) > 1e290


def test_not_a_number_is_found():
    """A force of 0/0 is caught at the next save, and the step and node are those where it arose."""

    @cy.lagrangian(x=cy.Vector(1), s=cy.Interval)
    def falling(q, c):
        return 0.5 * q.x_t[0] ** 2 - 0.5 * q.x_s[0] ** 2 + q.x[0] * np.sqrt(0.85 - q.t * q.s)

    domain = cy.Interval(0.0, 1.0, elements=4)
    system = cy.compile(falling, rule=cy.rules.verlet, domain=domain)
    with pytest.raises(cy.SimulationError, match="the state is no longer finite") as caught:
        cy.integrate(system, {"x": np.zeros((5, 1))}, 1.0, 0.1, save_every=0.5)
    assert "stopped at t = 0.8 s (step 8) at node 4: " in str(caught.value)
    assert caught.value.partial.time.tolist() == [0.0, 0.5]


def test_result_of_a_stretch():
    """Steppers report; they do not raise."""
    system = discretize(spun()[0], cy.rules.verlet)
    start = initial_state(system, system.reference, np.zeros((4, 6))).at_step(1e-4)
    received = []
    result = decoupled_run.run(system, start, stride=5, saves=3, receive=lambda *frames: received.append(frames))
    assert result.outcome is Outcome.FINISHED
    assert result.step == 15
    assert result.node == -1
    assert result.state.time == pytest.approx(1.5e-3)
    assert sum(len(frames[0]) for frames in received) == 3
    momenta = np.full((4, 6), 1e6)
    bad = initial_state(system, system.reference, momenta).at_step(1e-4)
    result = decoupled_run.run(system, bad, stride=5, saves=3, receive=lambda *frames: received.append(frames))
    assert result.outcome is Outcome.NOT_CONVERGED
    assert result.step == 0
    assert np.array_equal(result.state.values, bad.values)
    assert sum(len(frames[0]) for frames in received) == 3
