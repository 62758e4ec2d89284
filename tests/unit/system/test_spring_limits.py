"""What springs and dampers do to the step limit: exact frequencies, and what happens on either side of it."""

import itertools

import numpy as np
import pytest

import cayley as cy
from cayley import joints, springs, supports
from cayley.discrete.rules import verlet
from cayley.system.discretize import discretize
from cayley.system.stability import _inverse_roots, _matrices
from cayley.system.system import State, System
from unit.system.rods import round_rod

MASS, INERTIA, STIFFNESS = 2.0, (0.1, 0.2, 0.3), 50.0
ASKEW = (0.3, 0.2, 0.1)


def chain(count: int, *, stiffness: float = STIFFNESS, damping: float = 0.0) -> cy.Model:
    """Bodies in a row between two walls, a spring from each to the next."""
    bodies = [cy.Body(mass=MASS, inertia=INERTIA, position=(k + 1.0, 0.0, 0.0), name=f"body{k}") for k in range(count)]
    walls = [(bodies[0].centre, cy.ground.at((0, 0, 0))), (bodies[-1].centre, cy.ground.at((count + 1.0, 0, 0)))]
    pairs = [*walls, *((a.centre, b.centre) for a, b in itertools.pairwise(bodies))]
    return cy.Model(*bodies, springs=[springs.linear(*pair, stiffness=stiffness, damping=damping) for pair in pairs])


def mast(elements: int = 6, *, stiffness: float = 2e5, damping: float = 0.0) -> cy.Model:
    """A clamped rod with a spring from its end to the ground, askew."""
    rod = round_rod(elements, radius=0.03, name="mast")
    held = cy.ground.at(np.array(rod.end.place[0]) + np.array(ASKEW))
    tie = springs.linear(rod.end, held, stiffness=stiffness, damping=damping)
    return cy.Model(rod, supports=[supports.clamp(rod.start)], springs=[tie])


def bushed(*, stiffness: float = 1.0, damping: float = 0.0) -> cy.Model:
    """Two bodies with an elastic and damped element between them, off their centers."""
    a = cy.Body(mass=2.0, inertia=INERTIA, name="a")
    b = cy.Body(mass=1.0, inertia=(0.1, 0.1, 0.2), position=(1, 0, 0), name="b")
    given = {"stiffness": stiffness * np.array([200, 300, 400, 10, 20, 30]), "damping": [damping] * 6}
    tie = springs.bushing(a.centre.offset((0.5, 0.1, 0)), b.centre.offset((-0.5, 0.1, 0)), **given)
    return cy.Model(a, b, springs=[tie])


def limit_of(model: cy.Model) -> float:
    return discretize(model, verlet).stable_dt()


@pytest.mark.parametrize("count", [1, 2, 5, 100, 500])
def test_chain_of_bodies(count):
    """ω_max = 2 √(k/m) sin(πn/(2n + 2)); of dampers δ_max = 4 (c/m) sin²(πn/(2n + 2))."""
    sine = np.sin(0.5 * np.pi * count / (count + 1))
    exact = 1.0 / (np.sqrt(STIFFNESS / MASS) * sine)
    assert exact / 1.002 <= limit_of(chain(count)) <= exact * (1.0 + 1e-9)
    exact = 0.5 / (30.0 / MASS * sine**2)
    assert exact / 1.002 <= limit_of(chain(count, damping=30.0)) <= exact * (1.0 + 1e-9)


def test_body_on_a_lever():
    """A spring that pulls off the center turns the body, too: ω² = k (1/m + a²/J)."""
    body = cy.Body(mass=MASS, inertia=INERTIA)
    tie = springs.linear(body.centre.offset((0.0, 0.4, 0.0)), cy.ground.at((1.0, 0.4, 0.0)), stiffness=STIFFNESS)
    squared = STIFFNESS * (1.0 / MASS + 0.4**2 / INERTIA[2])
    assert limit_of(cy.Model(body, springs=[tie])) == pytest.approx(2.0 / np.sqrt(squared), rel=1e-6)


@pytest.mark.parametrize("unstressed", [0.0, 0.5])
def test_spring_without_length(unstressed):
    """It has no direction: what counts is its stiffness in any, not a geometric part that is not bounded."""
    body = cy.Body(mass=MASS, inertia=INERTIA)
    for arm in (0.0, 0.3):
        tie = springs.linear(
            body.centre.offset((arm, 0, 0)), cy.ground.at((arm, 0, 0)), stiffness=STIFFNESS, length=unstressed
        )
        squared = STIFFNESS * (1.0 / MASS + arm**2 / INERTIA[1])
        assert limit_of(cy.Model(body, springs=[tie])) == pytest.approx(2.0 / np.sqrt(squared), rel=1e-6)


def test_tension_across_a_spring():
    """k (1 − ℓ₀/ℓ) across a stretched one, held along its direction; nothing across a compressed one."""
    body = cy.Body(mass=MASS, inertia=INERTIA)
    held = [supports.hold(body.centre, position="x", rotation="xyz")]
    for unstressed, squared in ((0.6, STIFFNESS * 0.4 / MASS), (1.5, 0.0)):
        tie = springs.linear(body.centre, cy.ground.at((1, 0, 0)), stiffness=STIFFNESS, length=unstressed)
        exact = 2.0 / np.sqrt(squared) if squared else np.inf
        assert limit_of(cy.Model(body, supports=held, springs=[tie])) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("stiffness", [1e2, 1e6, 1e9])
@pytest.mark.parametrize("elements", [6, 90])
def test_certified_like_exact(elements, stiffness):
    """A rod with a spring: the bisection of long ones, to 2 % in frequency, against dense eigenvalues."""
    system = discretize(mast(elements, stiffness=stiffness), verlet)
    exact = 2.0 / np.sqrt(dense(system))
    assert exact / 1.025 <= system.stable_dt() <= exact * (1.0 + 1e-6)


def dense(system: System) -> float:
    """ω_max² with one spring to the ground at the end: elements by hand, the spring as k n nᵀ (it is not stretched)."""
    masses, (elements, nodes) = _matrices(system, system.reference)
    n, d = system.size, system.layout.dofs
    whole = np.zeros((n * d, n * d))
    for k in range(n):
        whole[k * d : (k + 1) * d, k * d : (k + 1) * d] += nodes[k]
        if k < n - 1:
            whole[k * d : (k + 2) * d, k * d : (k + 2) * d] += elements[k]
    direction = np.zeros(n * d)
    direction[-d:][system.layout.dofs_of("x")] = np.array(ASKEW) / np.linalg.norm(ASKEW)
    (spring,) = system.springs
    whole += spring.parameters[14] * np.outer(direction, direction)
    roots = _inverse_roots(masses) * system.free[:, :, None] * system.free[:, None, :]
    scale = np.zeros_like(whole)
    for k in range(n):
        scale[k * d : (k + 1) * d, k * d : (k + 1) * d] = roots[k]
    return float(np.linalg.eigvalsh(scale @ whole @ scale)[-1])


def test_where_a_spring_has_no_derivative():
    """A twist about an axis, half a turn about another: nothing is said, and a run without dt asks for it."""
    body = cy.Body(mass=MASS, inertia=INERTIA)
    model = cy.Model(body, springs=[springs.rotational(body.centre, axis=(0, 0, 1), stiffness=3.0)])
    system = discretize(model, verlet)
    values = system.reference.copy()
    values[0, system.layout.rows_of("p")] = (0.0, 1.0, 0.0, 0.0)
    assert np.isnan(system.stable_dt(State(values=values, momenta=np.zeros((1, 6)))))
    with pytest.raises(ValueError, match=r"give dt \[s\]$"):
        cy.simulate(model, 1.0, initial={body: {"rotation": (0.0, 1.0, 0.0, 0.0)}})


def test_joints_alone_have_no_limit():
    a, b = (cy.Body(mass=1.0, inertia=INERTIA, position=(k, 0, 0), name=f"b{k}") for k in range(2))
    model = cy.Model(a, b, joints=[joints.ball(a.centre.offset((0.5, 0, 0)), b.centre.offset((-0.5, 0, 0)))])
    with pytest.raises(ValueError, match=r"has no step limit under the rule verlet; give dt \[s\]$"):
        cy.simulate(model, 1.0)


CASES = {
    "chain": chain(5),
    "chain, damped": chain(5, damping=3.0),
    "chain, dampers decide": chain(5, damping=100.0),
    "rod": mast(),
    "rod, spring decides": mast(stiffness=1e9),
    "rod, damper decides": mast(stiffness=1.0, damping=1e5),
    "bushing": bushed(),
    "bushing, damping decides": bushed(stiffness=1e-3, damping=10.0),
}


def run(model: cy.Model, part: float, steps: int) -> cy.Trajectory:
    """Small vibrations of everything with a part of the step limit."""
    dt, rng = part * limit_of(model), np.random.default_rng(3)
    start = {
        one: {name: 1e-5 * rng.normal(size=(one.node_count, 3)) for name in ("velocity", "angular_velocity")}
        for one in model.parts
    }
    return cy.simulate(
        model, steps * dt, dt, rule=verlet, save_every=steps * dt / 50, initial=start, allow_unstable=True
    )


@pytest.mark.parametrize("name", CASES)
def test_just_below_vibrations_stay_small(name):
    energy = run(CASES[name], 0.95, 10_000).energy.values
    assert (
        energy.max() < 6.0 * energy[0]
    )  # what a step of 0.95 of the limit makes of a mode's energy: 1/(1 − 0.95²) at most


@pytest.mark.parametrize("name", CASES)
def test_above_they_blow_up(name):
    with pytest.raises(cy.SimulationError, match="stopped at t = "):
        run(CASES[name], 1.3, 10_000)
