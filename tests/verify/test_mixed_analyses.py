"""Models of several densities at rest, vibrating, buckling and stopped: what one density says in all of these."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cayley as cy
from cayley import damping, joints, loads, rules, supports
from cayley.density import library
from cayley.report.scene import Block, Strand
from cayley.report.stage import scene
from cayley.report.swing import extent
from verify.assemblies import THICK, WEIGHT

PULL = np.array(WEIGHT.acceleration)
LIGHT = 0.3
"""Gravity under which rods of rubber bend by no more than they can [m/s²]."""


def hung(*, own, damped=None):
    """A clamped arm with a body under its end, which may be written as a Lagrangian of one's own."""
    a = cy.Rod(THICK, length=1.0, elements=4, direction=(1, 0, 0), name="a", damping=damped)
    mass, inertia = 2.0, np.diag([0.05, 0.06, 0.09])
    place = {"position": (1, 0, -0.2), "ports": {"eye": (0, 0, 0.2)}, "name": "bob"}
    if own:
        constants = {"mass": mass, "inertia": inertia, "gravity": PULL}
        bob = cy.LagrangianPart(lagrangian=library.rigid_body, constants=constants, **place)
    else:
        bob = cy.Body(mass=mass, inertia=inertia, **place)
    swivel = joints.universal(a.end, bob.port("eye"), axis=(0, 1, 0), other=(1, 0, 0), name="swivel")
    push = loads.force(a.end, (0.0, 0.0, -20.0))
    return cy.Model(bob, a, supports=[supports.clamp(a.start)], joints=[swivel], loads=[WEIGHT, push])


def elbow():
    """A clamped rod with shear, and at its end another one without shear and stretch: gravity acts on both."""
    a = cy.Rod(THICK, length=1.0, elements=4, direction=(1, 0, 0), name="a", damping=damping.retardation(1e-3))
    bar = {"origin": (1, 0, 0), "direction": (0, 1, 0), "kinematics": "inextensible"}
    b = cy.Rod(THICK, length=0.8, elements=3, name="b", **bar)
    weld = joints.weld(a.end, b.start)
    return cy.Model(b, a, supports=[supports.clamp(a.start)], joints=[weld], loads=[loads.gravity((0, 0, -LIGHT))])


def test_statics_and_vibration_of_a_body_of_ones_own():
    """Equilibrium, matrices, modes and paths do not depend on who wrote the body."""
    models = [hung(own=own) for own in (False, True)]
    rests = [cy.equilibrium(model) for model in models]
    assert [len(rest.system.groups) for rest in rests] == [1, 2]
    for name in ("a", "bob"):
        assert_allclose(*(rest[name].position.values for rest in rests), rtol=0.0, atol=1e-12)
    assert_allclose(*(rest.joint("swivel").force.values for rest in rests), rtol=0.0, atol=1e-9)
    modes = [cy.modes(rest.model, about=rest, count=6) for rest in rests]
    assert_allclose(*(found.frequency.values for found in modes), rtol=1e-9)
    assert_allclose(*(abs(found["bob"].displacement.values) for found in modes), atol=1e-8)  # signs are free
    assert all(found.complete for found in modes)
    energies = []
    for rest in rests:
        found = cy.matrices(rest.model, about=rest)
        v = found.spread(np.ones(found.size))  # rows of the two are in another order
        assert v.sum() == found.size
        energies.append([found.mass.sum(), found.stiffness.diagonal().sum(), abs(found.constraint).sum()])
    assert_allclose(*energies, rtol=1e-9)
    paths = [cy.trace(model, model.loads[1], points=4) for model in models]
    assert_allclose(*(path["bob"].position.values for path in paths), rtol=0.0, atol=1e-9)


def test_a_path_of_gravity_in_two_kinematics():
    """Gravity is multiplied in both densities; a constant of that name in a Lagrangian of one's own stays."""
    model = elbow()
    path = cy.trace(model, model.loads[0], step=0.2)
    assert float(path.parameter[-1]) == pytest.approx(1.0)
    rest = cy.equilibrium(model)
    for name in ("a", "b"):
        assert_allclose(path[name].position.values[-1], rest[name].position.values, rtol=0.0, atol=1e-9)
    assert_allclose(path.equilibrium().frame.energy.values, rest.frame.energy.values, rtol=1e-9)
    assert_allclose(
        path.frames.reaction("a", "start").force.values[-1], rest.reaction("a", "start").force, rtol=0.0, atol=1e-7
    )
    own = hung(own=True)
    begin = cy.trace(own, own.loads[0], points=2, range=(0.5, 1.0)).equilibrium(0)
    half = own.replace(loads=[loads.gravity(0.5 * PULL), own.loads[1]])
    assert_allclose(begin["a"].position.values, cy.equilibrium(half)["a"].position.values, rtol=0.0, atol=1e-9)


def column(*, own):
    """A clamped column of two rods with a load on top; the upper one may be a density of one's own."""
    a = cy.Rod(THICK, length=0.6, elements=3, direction=(0, 0, 1), name="a")
    if own:
        constants = {"mass": THICK.mass_per_length, "inertia": THICK.inertia, "gravity": (0, 0, 0)}
        constants["stiffness"] = THICK.stiffness
        domain, place = cy.Interval(0.0, 0.6, elements=3), {"position": (0, 0, 0.6), "rotation": a.place(0)[1]}
        b = cy.LagrangianPart(lagrangian=library.rod, constants=constants, domain=domain, name="b", **place)
    else:
        b = cy.Rod(THICK, length=0.6, elements=3, origin=(0, 0, 0.6), direction=(0, 0, 1), name="b")
    push, weld = loads.force(b.end, (0, 0, -1.0)), joints.weld(a.end, b.start)
    return cy.Model(b, a, supports=[supports.clamp(a.start)], joints=[weld], loads=[push])


def test_buckling_of_a_column_of_two_densities():
    """The upper half of a column may be a density of one's own."""
    models = [column(own=own) for own in (False, True)]
    found = [cy.buckling(model, model.loads[0], count=2) for model in models]
    assert_allclose(found[0].factors, found[1].factors, rtol=1e-7)
    # Euler's column; six elements are 0.6 % too stiff, what shear and shortening change is less
    assert found[1].factors[0] == pytest.approx(np.pi**2 * THICK.stiffness[3, 3] / (4.0 * 1.2**2), rel=0.02)
    assert found[1].modes[0]["b"].displacement.shape == (4, 3)


def test_what_the_player_shows_of_parts_of_ones_own():
    """A ball with ports, and a thin chain; neither has a moment."""
    rest = cy.equilibrium(hung(own=True))
    bob, arm = scene(rest.frame).parts
    assert isinstance(bob, Block)
    assert (bob.sides, list(bob.ports)) == (None, ["eye"])
    assert extent(rest) > np.ptp(arm.position[0], axis=0).max()
    chain, _ = scene(cy.equilibrium(column(own=True)).frame).parts
    assert isinstance(chain, Strand)
    assert set(chain.quantities) == {"speed", "spin"}
    assert_allclose(chain.position[0, -1], (0, 0, 1.2), atol=1e-3)
    assert np.abs(chain.outlines).max() == pytest.approx(0.003)


def test_forces_of_long_steps():
    """Where steps do not resolve how stretching decays, each density is told its own part of the last three steps."""
    runs = [
        cy.simulate(hung(own=own, damped=damping.retardation(0.5)), 0.05, 5e-3, rule=rules.midpoint)
        for own in (False, True)
    ]
    for run in runs:
        assert np.isfinite(run.frames.rates[3:]).all()
        assert not np.array_equal(run.frames.rates[3:], run.observed.velocity[3:])
    assert_allclose(*(run["a"].force.values for run in runs), rtol=0.0, atol=1e-7)
    assert_allclose(*(run.joint("swivel").force.values for run in runs), rtol=0.0, atol=1e-7)
    assert_allclose(*(run.reaction("a", "start").force.values for run in runs), rtol=0.0, atol=1e-7)


@pytest.mark.parametrize(("rule", "dt"), [(rules.verlet, 2e-4), (rules.midpoint, 1e-3)], ids=["verlet", "midpoint"])
def test_stopped_and_gone_on(rule, dt, tmp_path):
    """A run stopped by hand goes on from its store bit for bit, with its accounts of work and its rates."""
    model, options = elbow(), {"rule": rule, "save_every": 10 * dt, "balance": True}
    whole = cy.simulate(model, 200 * dt, dt, **options)

    def stop(done, reached):
        if done > 0.1:
            raise KeyboardInterrupt

    with pytest.raises(cy.Interrupted) as caught:
        cy.simulate(model, 200 * dt, dt, store=tmp_path / "run", progress=stop, **options)
    assert 1 < len(caught.value.partial.time) < len(whole.time)
    run = cy.resume(tmp_path / "run")
    for name in ("values", "momenta", "work"):
        assert_array_equal(getattr(run.frames, name), getattr(whole.frames, name))
    if rule.implicit:
        assert run.frames.work.shape[1] == 1
        assert_array_equal(run.frames.rates, whole.frames.rates)
    assert np.abs(run.energy_balance.defect.values).max() < 1e-2 * np.abs(run.energy.values).max()


def test_elements_of_higher_degree_in_two_kinematics():
    """What constrained elements of degree 2 carry is that of their own multipliers, whatever stands beside them."""
    rest = cy.equilibrium(elbow(), rule=rules.galerkin(time=1, space=2))
    carried = rest["b"].force.values
    weight = LIGHT * THICK.mass_per_length * (0.8 - rest["b"].s.values)
    assert_allclose(np.linalg.norm(carried, axis=1), weight, atol=1e-6 * weight[0])
    assert np.abs(rest["a"].force.values[0]).max() > weight[0]
