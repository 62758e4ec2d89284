"""Damping and loads along rods in scenario files: every object can be written, and problems are told by place."""

import numpy as np
import pytest

import cayley as cy
from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import parse

HEAD = """
[section.rubber]
shape = "given"
stiffness = [30.0, 30.0, 60.0, 0.5, 0.4, 0.3]
mass_per_length = 1.0
inertia = [0.02, 0.02, 0.04]

[[rod]]
name = "arm"
section = "rubber"
length = 1.0
elements = 4
{damping}

[[support]]
kind = "clamp"
at = "arm.start"
{loads}
[run]
t_end = 0.5
dt = 1e-3
save_every = 0.1
{run}
"""
LOADS = """
[[load]]
kind = "distributed"
rod = "arm"
value = ["sin(t)*s", 0, 0.1]
frame = "body"
until = 0.3

[[load]]
kind = "pressure"
rod = "arm"
value = "0.1*s"
axis = "d2"

[[load]]
kind = "drag"
rod = "arm"
density = 1.2
diameter = 0.3
tangential = 0.1
velocity = ["2*z", 0, "0.1*sin(t)"]

[[load]]
kind = "buoyancy"
rod = "arm"
density = 1.2
area = 0.01

[[load]]
kind = "imposed_strain"
rod = "arm"
strain = [0, 0, 0, 0.2, 0, 0]
amount = "t*s"

[[load]]
kind = "temperature"
rod = "arm"
change = 30.0
expansion = 1e-4

[[load]]
kind = "tendon"
rod = "arm"
tension = "0.2*t"
offset = ["0.05*(1 - s)", 0, 0]

[[load]]
kind = "density"
rod = "arm"
on = "position"
force = ["-0.1*vx", 0, "0.05*sin(x)"]

[[load]]
kind = "density"
rod = "arm"
on = "strain"
force = [0, 0, 0, "-0.001*de4", "-0.001*de5*abs(e5)", 0]

[[load]]
kind = "gravity"
acceleration = [0, 0, -1]
"""


def text(damping="", loads="", run=""):
    return HEAD.format(damping=damping, loads=loads, run=run)


def read(**parts):
    return parse(text(**parts), name="test", file="test.toml")


def problem(**parts):
    with pytest.raises(ScenarioError) as caught:
        read(**parts)
    return "\n".join(caught.value.problems)


def test_every_load_runs_and_is_the_same_as_written_in_python():
    scenario = read(damping="damping = { retardation = 0.002, decay = 0.5 }", loads=LOADS)
    model = scenario.model()
    (arm,) = model.rods
    found = cy.simulate(model, **scenario.options())
    given = cy.damping.retardation(0.002) + cy.damping.mass_proportional(0.5)
    rod = cy.Rod(arm.section, length=1.0, elements=4, damping=given)
    zero = np.zeros(())
    make = cy.loads

    def own(q, c):
        return [(np.stack([-0.1 * q.x_t[0], zero * q.t, 0.05 * np.sin(q.x[0])]), q.x)]

    def stress(q, c):
        rates = cy.rate(q.p_s)
        return [(np.stack([-0.001 * rates[0], -0.001 * rates[1] * np.abs(q.p_s[1])]), q.p_s[:2])]

    acting = [
        make.distributed(rod, lambda s, t: np.stack([np.sin(t) * s, 0 * s, 0.1 + 0 * s]), frame="body", until=0.3),
        make.pressure(rod, lambda s, t: 0.1 * s, axis="d2"),
        make.drag(
            rod,
            density=1.2,
            diameter=0.3,
            tangential=0.1,
            velocity=lambda x, t: np.stack([2 * x[2], 0 * t, 0.1 * np.sin(t)]),
        ),
        make.buoyancy(rod, density=1.2, area=0.01),
        make.imposed_strain(rod, (0, 0, 0, 0.2, 0, 0), amount=lambda s, t: t * s),
        make.temperature(rod, 30.0, expansion=1e-4),
        make.tendon(rod, lambda t: 0.2 * t, offset=lambda s: np.stack([0.05 * (1 - s), 0 * s, 0 * s])),
        make.density(rod, own),
        make.density(rod, stress),
        make.gravity((0, 0, -1)),
    ]
    same = cy.simulate(cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=acting), 0.5, 1e-3, save_every=0.1)
    np.testing.assert_allclose(found["arm"].position.values, same[rod].position.values, atol=1e-13)
    assert np.abs(found["arm"].position.values[-1] - found["arm"].position.values[0]).max() > 0.01


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("damping = { ratio = 0.02, frequency = 5.0 }", cy.damping.ratio(0.02, frequency=5.0)),
        ("damping = { rayleigh = [[0.03, 2.0], [0.05, 20.0]] }", cy.damping.rayleigh((0.03, 2.0), (0.05, 20.0))),
        ("damping = { viscosity = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0] }", cy.damping.viscous(np.arange(1.0, 7.0))),
    ],
)
def test_damping(written, meant):
    (arm,) = read(damping=written).model().rods
    assert arm.damping.retardation == meant.retardation
    assert arm.damping.decay == meant.decay
    assert np.array_equal(arm.damping.viscosity, meant.viscosity) or meant.viscosity is None


def test_balance_of_a_scenario():
    load = '[[load]]\nkind = "force"\nat = "arm.end"\nvalue = ["0.1*t", 0, 0]\n'
    scenario = read(loads=load, run="balance = true")
    balance = cy.simulate(scenario.model(), **scenario.options()).energy_balance
    assert float(abs(balance.defect[-1])) < 1e-3 * float(balance.work[-1])


def test_settling_of_a_scenario():
    assert "settle" not in read().options()
    assert read(run="settle = true").options()["settle"] is True
    assert read(run="settle = 3\nrest = 1e-3").options()["settle"] == 3.0
    assert read(run="settle = 3\nrest = 1e-3").options()["rest"] == 1e-3
    with pytest.raises(ScenarioError, match=r"run.settle.*true or false, or a positive number"):
        read(run="settle = -1.0")


@pytest.mark.parametrize(
    ("parts", "told"),
    [
        ({"damping": "damping = { retard = 1.0 }"}, "rod #1.damping.retard: is no key"),
        ({"damping": "damping = { retardation = -1.0 }"}, "rod #1: retardation"),
        ({"damping": "damping = { ratio = 0.1 }"}, "rod #1: ratio and frequency must be given together"),
        ({"damping": "damping = {}"}, "rod #1: is empty"),
        ({"loads": LOADS.replace('"0.1*s"', '"0.1*r"')}, 'load #2.value: "0.1*r" uses the unknown name "r"'),
        ({"loads": LOADS.replace('"2*z"', '"2*vz"')}, 'load #3.velocity #1: "2*vz" uses the unknown name "vz"'),
        ({"loads": LOADS.replace('"-0.1*vx", 0,', '"-0.1*vx",')}, "load #8: force holds 2 components"),
        ({"loads": LOADS.replace('on = "strain"', 'on = "stress"')}, "load #9.on"),
        ({"loads": LOADS.replace('kind = "drag"', 'kind = "drug"')}, 'did you mean "drag"'),
        ({"loads": LOADS.replace('rod = "arm"', 'rod = "leg"', 1)}, "load #1.rod"),
    ],
)
def test_problems(parts, told):
    assert told in problem(**parts)
