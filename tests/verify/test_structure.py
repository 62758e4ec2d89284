"""What the discrete flow inherits from the action: bounded energy, reversibility, symplecticity, momentum maps."""

import numpy as np
import pytest

import cayley as cy
from cayley.lie import quaternion
from cayley.system.system import State
from verify.problems import TOP, TOP_START, assert_order, bend, heavy_top, in_flight, thick_rod, turned_around

BOTH_FORMS = pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
BOTH_RULES = pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)


@BOTH_FORMS
@BOTH_RULES
def test_energy_ripple_is_proportional_to_the_step_squared(rule, rotation):
    """The largest deviation of the energy, seen at the same times, of a clamped rod and of the heavy top."""
    rod, model = thick_rod(10)
    start = {rod: bend(rod, 4.0)}
    top = cy.compile(heavy_top, rule=rule, constants=TOP, rotation=rotation)
    ripples = []
    for steps in (500, 1000, 2000, 4000):
        run = cy.simulate(model, 0.05, 0.05 / steps, rule=rule, save_every=1e-4, initial=start, rotation=rotation)
        spin = cy.integrate(top, TOP_START, t_end=0.25, dt=0.25 / steps, save_every=5e-4)
        ripples.append([np.ptp(run.energy.values), np.ptp(spin.energy.values)])
    for kind in np.transpose(ripples):
        assert_order(kind)


@BOTH_FORMS
@BOTH_RULES
def test_time_reversal_returns_to_the_start(rule, rotation):
    """Forward, momenta reversed, the same number of steps again: back where it began."""
    rod, model = thick_rod(10)
    start = {rod: bend(rod, 4.0) | {"angular_velocity": lambda s: np.array([0.0, 3.0 * s**2, 5.0 * s**2])}}
    gravity = model.replace(loads=[cy.loads.gravity((1.0, -2.0, -9.81))])
    there = cy.simulate(gravity, 1.0, 1e-4, rule=rule, save_every=1.0, initial=start, rotation=rotation)
    back = cy.integrate(there.system, turned_around(there.state), 1.0, 1e-4, save_every=1.0)
    assert np.abs(there.frames.values[-1] - there.frames.values[0]).max() > 0.1
    np.testing.assert_allclose(back.frames.values[-1], there.frames.values[0], rtol=0, atol=1e-10)
    np.testing.assert_allclose(-back.frames.momenta[-1], there.frames.momenta[0], rtol=0, atol=1e-10)


@BOTH_FORMS
@BOTH_RULES
@pytest.mark.parametrize("problem", ["heavy top", "rod of two elements"])
def test_flow_is_symplectic(problem, rule, rotation):
    """JᵀΩ(z⁺)J = Ω(z) for the derivative J of some steps from z = (q, μ).

    Trivialized from the left, Ω((η₁, ν₁), (η₂, ν₂)) = ν₂·η₁ − ν₁·η₂ + μ·(η₁ × η₂): the last term for rotations alone.
    """
    if problem == "heavy top":
        system = cy.compile(heavy_top, rule=rule, constants=TOP, rotation=rotation)
        state, dt = cy.integrate(system, TOP_START, t_end=2e-3, dt=1e-3).state, 1e-3
    else:
        rod, model = thick_rod(2, clamped=False)
        start = in_flight(rod, bend(rod, 4.0), velocity=(0.3, -0.2, 0.5), spin=(1.0, 5.0, -8.0))
        run = cy.simulate(model, 0.01, 2e-4, rule=rule, initial={rod: start}, rotation=rotation)
        system, state, dt = run.system, run.state, 2e-4
    state = State(values=state.values, momenta=state.momenta)
    size = system.size * system.layout.dofs

    def flow(z):
        return cy.integrate(system, shifted(system, state, z), 5 * dt, dt, save_every=5 * dt, allow_unstable=True).state

    end = flow(np.zeros(2 * size))
    jacobian = np.empty((2 * size, 2 * size))
    scale = np.concatenate([np.ones(size), np.full(size, np.abs(state.momenta).max())])
    for k in range(2 * size):
        step = 2e-4 * scale[k] * np.eye(2 * size)[k]
        one, two = ([local(system, end, flow(sign * m * step)) for sign in (1, -1)] for m in (1, 2))
        jacobian[:, k] = (8 * (one[0] - one[1]) - (two[0] - two[1])) / (12 * 2e-4)  # times scale[k]
    before, after = two_form(system, state), two_form(system, end)
    expected = scale[:, None] * before * scale
    error = np.abs(jacobian.T @ after @ jacobian - expected).max() / np.abs(expected).max()
    assert error < 1e-8, error
    assert np.abs(jacobian / scale - np.eye(2 * size)).max() > 1e-2  # the steps do something


def shifted(system, state, z):
    """A state near another: p exp(η/2), x + ξ, μ + ν for z = (η and ξ of all nodes, ν)."""
    layout = system.layout
    change = z.reshape(2, system.size, layout.dofs)
    values = state.values.copy()
    for name in layout.fields:
        rows, own = layout.rows_of(name), change[0][:, layout.dofs_of(name)]
        if name in layout.rotations:
            p = layout.representation.to_quaternion(values[:, rows])
            turned = quaternion.multiply(p, quaternion.from_rotation_vector(own))
            values[:, rows] = layout.representation.from_quaternion(np.asarray(turned, dtype=float))
        else:
            values[:, rows] += own
    return State(values=values, momenta=state.momenta + change[1])


def local(system, state, other):
    """Coordinates of another state near a state, the inverse of shifted."""
    layout = system.layout
    change = np.empty((2, system.size, layout.dofs))
    change[1] = other.momenta - state.momenta
    for name in layout.fields:
        a, b = (each.values[:, layout.rows_of(name)] for each in (state, other))
        if name in layout.rotations:
            p, q = (layout.representation.to_quaternion(v) for v in (a, b))
            relative = quaternion.relative(p, q)
            change[0][:, layout.dofs_of(name)] = quaternion.to_rotation_vector(relative * np.sign(relative[:, :1]))
        else:
            change[0][:, layout.dofs_of(name)] = b - a
    return change.ravel()


def two_form(system, state):
    """Matrix of Ω at a state."""
    layout, n = system.layout, system.size * system.layout.dofs
    form = np.zeros((2 * n, 2 * n))
    form[:n, n:], form[n:, :n] = np.eye(n), -np.eye(n)
    for node in range(system.size):
        for name in layout.rotations:
            dofs = node * layout.dofs + np.arange(layout.dofs)[layout.dofs_of(name)]
            a, b, c = state.momenta[node, layout.dofs_of(name)]
            form[np.ix_(dofs, dofs)] = [[0, c, -b], [-c, 0, a], [b, -a, 0]]
    return form


@BOTH_FORMS
@BOTH_RULES
def test_a_top_keeps_the_two_momenta_it_has_symmetries_for(rule, rotation):
    """About the vertical and about its own axis e2, on which its weight stands; not the others."""
    system = cy.compile(heavy_top, rule=rule, constants=TOP, rotation=rotation)
    run = cy.integrate(system, TOP_START, t_end=10.0, dt=1e-4, save_every=0.01)
    vertical = run.angular_momentum.values[:, 2]
    assert np.ptp(vertical) < 1e-10 * np.abs(vertical[0])
    own = run.data["p_momentum"].values[:, 1]
    assert np.ptp(own) < 1e-10 * np.abs(own[0])
    assert np.ptp(run.angular_momentum.values[:, 0]) > 1.0
