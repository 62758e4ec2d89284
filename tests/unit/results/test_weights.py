"""Forces of joints and supports against hand calculation: weights at rest, levers, driven hinges, closed loops."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import joints, loads, rules, springs, supports
from cayley.lie import quaternion
from cayley.model import Port

G = np.array([0.0, 0.0, -9.81])
STEEL = cy.Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
FOAM = cy.Material(density=50.0, youngs_modulus=2e7, poisson_ratio=0.3)
BAR = cy.Section.circle(0.02, STEEL)
SOFT = cy.Section.circle(0.03, FOAM)
RULES = [rules.verlet, rules.spectral(space=2), rules.midpoint, rules.galerkin(time=2, space=2)]


def block(x: float = 0.0, z: float = 0.0, *, mass: float = 2.0, name: str = "block") -> cy.Body:
    return cy.Body(mass=mass, inertia=[0.01, 0.02, 0.03], position=(x, 0, z), name=name)


def still(model: cy.Model, rule: object = rules.midpoint, dt: float = 1e-3) -> cy.Trajectory:
    return cy.simulate(model, t_end=0.02, dt=dt, rule=rule)


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint], ids=str)
def test_weight_at_a_ball_joint_and_a_clamp(rule):
    """A body of 2 kg hangs by a ball joint from one that is clamped: 19.62 N, and both weights at the clamp."""
    top, bob = block(z=0.3, mass=3.0, name="top"), block()
    tie = joints.ball(top.centre, bob.centre.offset((0, 0, 0.3)))
    clamp = supports.clamp(top.centre)
    run = still(cy.Model(top, bob, supports=[clamp], joints=[tie], loads=[loads.gravity(G)]), rule)
    frames = (len(run.time), 1)
    assert_allclose(run.joint(tie).force, np.tile([0, 0, 19.62], frames), atol=1e-10)
    assert_allclose(run.joint(tie).moment, 0.0, atol=1e-10)
    assert_allclose(run.reaction(clamp).force, np.tile([0, 0, 5 * 9.81], frames), atol=1e-10)
    assert_allclose(run.reaction(clamp).moment, 0.0, atol=1e-10)


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint], ids=str)
def test_moment_of_a_lever_in_welds(rule):
    """m g l about each weld; a clamp beside the node has it about its own place."""
    root, tip = block(mass=1.0, name="root"), block(x=0.7)
    weld = joints.weld(root.centre.offset((0.2, 0, 0)), tip.centre.offset((-0.5, 0, 0)))
    clamp = supports.clamp(root.centre.offset((-0.1, 0, 0)))
    run = still(cy.Model(root, tip, supports=[clamp], joints=[weld], loads=[loads.gravity(G)]), rule)
    assert_allclose(run.joint(weld).moment.values[-1], (0, -19.62 * 0.5, 0), atol=1e-9)
    assert_allclose(run.reaction(clamp).force.values[-1], (0, 0, 29.43), atol=1e-9)
    assert_allclose(run.reaction(clamp).moment.values[-1], (0, -19.62 * 0.8 - 9.81 * 0.1, 0), atol=1e-9)
    about_node = run.reaction("root", "centre")
    assert_allclose(about_node.moment.values[-1], (0, -19.62 * 0.7, 0), atol=1e-9)


@pytest.mark.parametrize("kinematics", ["shearable", "inextensible"])
def test_weight_on_the_end_of_a_rod(kinematics):
    """A rod that hangs in equilibrium with 2 kg by a ball joint at its end: 19.62 N there, all weights at the clamp."""
    rod = cy.Rod(BAR, length=1.0, direction=(0, 0, -1), elements=4, name="rod", kinematics=kinematics)
    bob, clamp = block(z=-1.0), supports.clamp(rod.start)
    tie = joints.ball(rod.end, bob.centre)
    model = cy.Model(rod, bob, supports=[clamp], joints=[tie], loads=[loads.gravity(G)])
    stretch = 0.0
    if kinematics == "shearable":
        below = rod.section.mass_per_length * 9.81 * (1.0 - (np.arange(4) + 0.5) / 4) + 19.62
        stretch = np.append(0.0, np.cumsum(0.25 * below / rod.section.stiffness[2, 2]))
    place = np.outer(np.linspace(0, 1, 5) + stretch, (0, 0, -1))
    initial = {rod: {"position": place}, bob: {"position": place[-1]}}
    run = cy.simulate(model, t_end=0.02, dt=1e-3, rule=rules.midpoint, initial=initial)
    assert_allclose(run.joint(tie).force.values[:, 2], 19.62, atol=1e-6)
    assert_allclose(run[rod].force.values[:, -1, 2], 19.62, atol=1e-6)
    weight = 19.62 + rod.mass * 9.81
    assert_allclose(run.reaction(clamp).force.values[:, 2], weight, atol=1e-6)
    assert_allclose(run[rod].force.values[:, 0, 2], weight, atol=1e-6)


@pytest.mark.parametrize("rule", RULES, ids=str)
@pytest.mark.parametrize("lossy", [False, True], ids=["", "lossy"])
def test_rods_that_are_welded_and_clamped(rule, lossy):
    """Change of momentum of all: the clamp and gravity; of the outer rod: the weld and gravity; losses count."""
    damping = cy.damping.mass_proportional(20.0) if lossy else None
    inner = cy.Rod(SOFT, length=0.4, direction=(1, 0, 0), elements=4, name="inner", damping=damping)
    outer = cy.Rod(SOFT, length=0.3, origin=(0.4, 0, 0), direction=(0, 1, 0), elements=4, name="outer", damping=damping)
    weld, clamp = joints.weld(inner.end, outer.start), supports.clamp(inner.start)
    wind = [loads.drag(outer, density=1.2, diameter=0.06, velocity=(0, 0, 30.0))] if lossy else []
    model = cy.Model(inner, outer, supports=[clamp], joints=[weld], loads=[loads.gravity(G), *wind])
    explicit = not rule.implicit
    run = cy.simulate(model, t_end=0.03, dt=None if explicit else 1e-4, rule=rule, save_every=1e-4)
    change = np.gradient(run.linear_momentum.values, run.time, axis=0)
    given = outside(run, model, lossy)
    scale = np.abs(change).max()
    assert_allclose((run.reaction(clamp).force.values + given["all"])[5:-5], change[5:-5], atol=0.02 * scale)
    nodes = run._parts["outer"]
    momentum = run.frames.momenta[:, nodes, run.outline.layout.dofs_of("x")].sum(axis=1)
    change = np.gradient(momentum, run.time, axis=0)
    assert_allclose((run.joint(weld).force.values + given["outer"])[5:-5], change[5:-5], atol=0.02 * scale)


def outside(run, model, lossy):
    """Gravity, decay and drag on all and on the outer rod, drag from one node to the next."""
    columns, outer = run.outline.layout.dofs_of("x"), run._parts["outer"]
    found = {"all": np.tile(model.mass * G, (len(run.time), 1))}
    found["outer"] = np.tile(model.parts[1].mass * G, (len(run.time), 1))
    if not lossy:
        return found
    x, v = run._values("x")[:, outer], run.observed.velocity[:, outer, columns]
    way = np.diff(x, axis=1)
    along = way / np.linalg.norm(way, axis=-1, keepdims=True)
    wind = np.array([0, 0, 30.0]) - 0.5 * (v[:, 1:] + v[:, :-1])
    across = wind - np.sum(wind * along, axis=-1, keepdims=True) * along
    spaces = run.system.named["length"][outer][:-1]
    speed = np.linalg.norm(across, axis=-1)
    push = 0.5 * 1.2 * 0.06 * 1.2 * np.einsum("te,tei,e->ti", speed, across, spaces)
    for name, nodes in {"all": slice(None), "outer": outer}.items():
        found[name] += push - 20.0 * run.frames.momenta[:, nodes, columns].sum(axis=1)
    return found


def test_joints_of_a_part_in_flight_balance():
    """What joins a rod to another acts on both, equal and opposite, whatever the parts of the model do."""
    left = cy.Rod(SOFT, length=0.4, direction=(1, 0, 0), elements=4, name="left")
    right = cy.Rod(SOFT, length=0.4, origin=(0.4, 0, 0), direction=(1, 0, 0), elements=4, name="right")
    weld = joints.weld(left.end, right.start)
    run = cy.simulate(
        cy.Model(left, right, joints=[weld]),
        t_end=0.02,
        rule=rules.verlet,
        initial={right: {"velocity": lambda s: (0.0, 0.0, 5.0 * s)}},
        save_every=1e-3,
    )
    ends = [(run[left].isel(node=-1), -1.0), (run[right].isel(node=0), -1.0)]
    for (end, sign), word in [(pair, word) for pair in ends for word in ("force", "moment")]:
        turned = quaternion.rotate(end.rotation.values, end[word].values)
        assert_allclose(sign * turned, run.joint(weld)[word], atol=1e-8)
    assert np.abs(run.joint(weld).force).max() > 0.1


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint], ids=str)
def test_torque_of_a_motor_between_bodies(rule):
    """A motor turns a rotor against a clamped stator: J φ'' on the rotor, and as much at the clamp."""
    stator, rotor = block(name="stator"), block(z=0.2, name="rotor")
    motor = joints.hinge(stator.centre, rotor.centre.offset((0, 0, -0.2)), axis=(0, 0, 1), angle=lambda t: 0.5 * t**3)
    clamp = supports.clamp(stator.centre)
    run = cy.simulate(cy.Model(stator, rotor, supports=[clamp], joints=[motor]), t_end=0.5, dt=1e-3, rule=rule)
    torque = 0.03 * 3.0 * run.time
    assert_allclose(run.joint(motor).moment.values[:, 2], torque, atol=1e-5)
    assert_allclose(run.reaction(clamp).moment.values[:, 2], torque, atol=1e-5)


def test_closed_four_bar_loop():
    """Newton's second law for each of three links of a closed loop, by its two joints."""
    corners = np.array([[0, 0, 0], [0, 0, 0.4], [0.6, 0, 0.7], [0.8, 0, 0.0]])
    middles = 0.5 * (corners[1:] + corners[:-1])
    links = [
        cy.Body(mass=1.0 + k, inertia=[0.02, 0.02, 0.02], position=place, name=f"link{k}")
        for k, place in enumerate(middles)
    ]

    def at(k: int, corner: int) -> Port:
        return links[k].centre.offset(corners[corner] - np.array(links[k].position))

    ties = [
        joints.hinge(at(0, 0), axis=(0, 1, 0), name="a"),
        joints.ball(at(0, 1), at(1, 1), name="b"),
        joints.universal(at(1, 2), at(2, 2), axis=(0, 1, 0), other=(1, 0, 0), name="c"),
        joints.hinge(at(2, 3), axis=(0, 1, 0), name="d"),
    ]
    model = cy.Model(*links, joints=ties, loads=[loads.gravity(G)])
    run = cy.simulate(model, t_end=0.2, dt=5e-4, rule=rules.midpoint)
    force = {name: run.joint(name).force.values for name in "bc"} | {n: run.reaction(n).force.values for n in "ad"}
    pulls = [force["a"] - force["b"], force["b"] - force["c"], force["c"] + force["d"]]
    for link, pull in zip(links, pulls, strict=True):
        change = link.mass * (np.gradient(run[link].velocity.values, run.time, axis=0) - G)
        assert_allclose(pull[2:-2], change[2:-2], atol=2e-3 * np.abs(change).max())


def test_held_components_of_a_spinning_body():
    """A body held to its third axis, which is none of its principal ones: the bearing carries ω × Jω."""
    inertia = np.array([[0.02, 0, 0.004], [0, 0.03, 0.002], [0.004, 0.002, 0.025]])
    wheel = cy.Body(mass=1.0, inertia=inertia, position=(0, 0, 0), name="wheel")
    bearing = supports.hold(wheel.centre, position="xyz", rotation="xy")
    push = loads.moment(wheel.centre, (0, 0, 0.1), frame="body")
    model = cy.Model(wheel, supports=[bearing], loads=[push])
    run = cy.simulate(model, t_end=0.5, dt=1e-4, initial={wheel: {"angular_velocity": (0, 0, 8.0)}}, save_every=5e-3)
    spin = run[wheel].angular_velocity.values
    rate = np.array([0, 0, 0.1 / 0.025])
    needed = inertia @ rate + np.cross(spin, spin @ inertia) - np.array([0, 0, 0.1])
    found = run.reaction(bearing).moment.values
    assert_allclose(found, quaternion.rotate(run[wheel].rotation.values, needed), atol=1e-9)


def test_supports_share_a_node():
    """Each support has the components that it holds, the place all of them, with what a guide adds."""
    body = block()
    ways = [supports.hold(body.centre, position="xy"), supports.hold(body.centre, rotation="xyz")]
    guide = supports.roll(body.centre.offset((0.3, 0, 0)), (0, 0, 1), name="roller")
    model = cy.Model(body, supports=[*ways, guide], loads=[loads.gravity(G), loads.force(body.centre, (1.0, 2.0, 0.1))])
    run = still(model)
    last = {"time": -1}
    assert_allclose(run.reaction(ways[0]).isel(last).force, (-1, -2, 0), atol=1e-10)
    assert_allclose(run.reaction(ways[1]).isel(last).moment, (0, 0.3 * (19.62 - 0.1), 0), atol=1e-10)
    assert_allclose(run.reaction("roller").isel(last).force, (0, 0, 19.52), atol=1e-10)
    whole = run.reaction(body.centre).isel(last)
    assert_allclose(whole.force, (-1, -2, 19.52), atol=1e-10)
    assert_allclose(whole.moment, 0.0, atol=1e-10)


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint], ids=str)
def test_stress_of_a_hot_rod_between_walls(rule):
    """N = −EA α ΔT, a stress beside the Lagrangian: in the rod, and on the walls."""
    rod = cy.Rod(SOFT, length=0.5, direction=(1, 0, 0), elements=4, name="rod")
    held = [supports.clamp(rod.start), supports.clamp(rod.end)]
    hot = loads.temperature(rod, expansion=1e-5, change=100.0)
    run = cy.simulate(
        cy.Model(rod, supports=held, loads=[hot]), t_end=0.01, dt=None if rule is rules.verlet else 1e-3, rule=rule
    )
    squeeze = 1e-3 * rod.section.stiffness[2, 2]
    assert_allclose(run[rod].force.values[-1, :, 2], -squeeze, rtol=1e-9)
    assert_allclose(run.reaction(held[0]).force.values[-1], (squeeze, 0, 0), atol=1e-9 * squeeze)
    assert_allclose(run.reaction(held[1]).force.values[-1], (-squeeze, 0, 0), atol=1e-9 * squeeze)


def test_spring_between_a_held_body_and_another():
    """The support carries what the spring pulls."""
    low, high = block(name="low"), block(z=1.0, name="high")
    pull = springs.linear(low.centre, high.centre, stiffness=100.0, length=0.4)
    clamp = supports.clamp(low.centre)
    run = cy.simulate(cy.Model(low, high, supports=[clamp], springs=[pull]), t_end=0.1, dt=1e-3, rule=rules.midpoint)
    force = 100.0 * (run[high].position.values[:, 2] - 0.4)
    assert_allclose(run.reaction(clamp).force.values[:, 2], -force, atol=1e-9)


def test_refusals():
    top, bob = block(z=0.3, name="top"), block(name="bob")
    tie = joints.ball(top.centre, bob.centre.offset((0, 0, 0.3)), name="pin")
    clamp = supports.clamp(top.centre)
    run = still(cy.Model(top, bob, supports=[clamp], joints=[tie]))
    with pytest.raises(KeyError, match=r"pin connects two parts; run.joint"):
        run.reaction(tie)
    with pytest.raises(KeyError, match=r"nothing holds bob.centre to the ground; held are top.centre"):
        run.reaction(bob.centre)
    with pytest.raises(KeyError, match=r"the run has no clamp at bob.centre; its supports are clamp at top.centre"):
        run.reaction(supports.clamp(bob.centre))
    with pytest.raises(KeyError, match=r"the run has no joint ball of bob.centre to ground; it has pin"):
        run.joint(joints.ball(bob.centre))


@pytest.mark.parametrize("rule", [rules.verlet, rules.midpoint], ids=str)
def test_pin_of_a_rod_with_its_mass_beside_the_axis(rule):
    """The held node turns, and the mass beside it with it: d/dt Σ m (ẋ + Λ (ω × c)) is the reaction and the weight."""
    offset, stiffness = np.array([0.02, 0.01, 0.0]), np.diag([3e3, 3e3, 1e4, 2.0, 2.0, 1.0])
    inertia = np.diag([4e-4, 5e-4, 9e-4])
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.2, inertia=inertia, mass_center=offset[:2])
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), elements=5, name="rod")
    pin = supports.pin(rod.start)
    model = cy.Model(rod, supports=[pin], loads=[loads.gravity(G)])
    run = cy.simulate(model, t_end=0.03, rule=rule, dt=1e-4 if rule.implicit else None, save_every=5e-4)
    data, weight = run[rod], run.system.named["weight"]
    swing = quaternion.rotate(data.rotation.values, np.cross(data.angular_velocity.values, offset))
    momentum = 1.2 * np.einsum("tni,n->ti", data.velocity.values + swing, weight)
    change = np.gradient(momentum, run.time, axis=0) - rod.mass * G
    assert_allclose(run.reaction(pin).force.values[3:-3], change[3:-3], atol=0.015 * np.abs(change).max())
