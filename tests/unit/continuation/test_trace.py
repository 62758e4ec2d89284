"""cy.trace: what can be a parameter, where a path goes, what it tells, what it refuses."""

import numpy as np
import pytest

import cayley as cy
from cayley import joints, loads, springs, supports

SECTION = cy.Section.given(
    stiffness=np.diag([1e3, 1e3, 1e3, 2.0, 1.0, 1.0]), mass_per_length=1.0, inertia=np.diag([1e-3, 1e-3, 2e-3])
)


def cantilever(*make, supports_of=lambda rod: []):
    rod = cy.Rod(SECTION, length=1.0, direction=(1, 0, 0), elements=4, name="rod")
    found = [one(rod) for one in make]
    return cy.Model(rod, supports=[supports.clamp(rod.start), *supports_of(rod)], loads=found), found


def truss(**options):
    bob = cy.PointMass(mass=1.0, position=(0, 0, 0.3), name="bob")
    load = loads.force(bob.centre, (0, 0, -1.0))
    bars = [springs.linear(bob.centre, cy.ground.at((s, 0, 0)), stiffness=1000.0) for s in (-1.0, 1.0)]
    model = cy.Model(bob, supports=[supports.hold(bob.centre, position="y")], springs=bars, loads=[load])
    return model, cy.trace(model, load, **({"range": (-60.0, 60.0), "begin": 0.0} | options))


def push(value):
    return lambda rod: loads.force(rod.end, value, start=1.0, until=3.0)


@pytest.mark.parametrize(
    "load",
    [
        lambda f: lambda rod: loads.gravity((0, 0, -3.0 * f)),
        lambda f: lambda rod: loads.force(rod.end, (0, 0.5 * f, f), frame="body"),
        lambda f: lambda rod: loads.line_moment(rod, (0, f, 0)),
        lambda f: lambda rod: loads.distributed(rod, lambda s, t: (0.0, 0.0, 4.0 * f * s * (1.0 + t))),
        lambda f: lambda rod: loads.imposed_strain(rod, (0, 0, 0, 0, 1.0, 0), amount=f),
        lambda f: lambda rod: loads.tendon(rod, f, offset=(0.05, 0, 0)),
        lambda f: lambda rod: loads.density(rod, lambda q, c: [(c.f * q.x, q.x)], f=f),
    ],
    ids=["gravity", "force", "line_moment", "distributed", "imposed_strain", "tendon", "density"],
)
def test_a_load_is_multiplied_and_others_stay(load):
    weight = lambda rod: loads.line_force(rod, lambda t: (0, 0, -t))  # noqa: E731
    model, (own, _) = cantilever(load(1.0), weight)
    path = cy.trace(model, own, range=(0.0, 0.7), time=1.0, step=0.5)
    wanted = cy.equilibrium(cantilever(load(0.7), weight)[0], time=1.0)
    assert path.parameter[0] == 0.0
    assert path.parameter[-1] == pytest.approx(0.7, abs=1e-12)
    assert path["rod"].position.values[-1] == pytest.approx(wanted["rod"].position.values, abs=1e-9)
    assert path["rod"].moment.values[-1] == pytest.approx(wanted["rod"].moment.values, abs=1e-7)
    root = path.reaction(model.supports[0]).force.values[-1]
    assert root == pytest.approx(wanted.reaction(wanted.model.supports[0]).force.values, abs=1e-7)
    assert path.equilibrium().residual < 1e-9
    assert path.ended == "the range ends at 0.7"


def test_loads_together_and_outside_of_their_window():
    model, both = cantilever(push((0, 0, 1.0)), lambda rod: loads.gravity((0, 0, -1.0)))
    path = cy.trace(model, both, range=(0.0, 2.0), step=0.5)
    twice = cantilever(push((0, 0, 2.0)), lambda rod: loads.gravity((0, 0, -2.0)))[0]
    wanted = cy.equilibrium(twice, time=2.0)["rod"].position.values
    assert path["rod"].position.values[-1] == pytest.approx(wanted, abs=1e-9)


def test_a_motion_is_followed_and_another_stays():
    rod = cy.Rod(SECTION, length=1.0, direction=(1, 0, 0), elements=4, name="rod")
    lift = supports.drive(rod.end, position=lambda t: (0.0, 0.0, 0.2 * t), name="lift")
    turn = supports.turn(rod.start, (0, 1, 0), angle=lambda t: 0.1 * t, name="turn")
    model = cy.Model(rod, supports=[lift, turn])
    path = cy.trace(model, "lift", range=(0.0, 1.0), time=2.0, step=0.5)
    data = path["rod"]
    assert data.position.values[:, -1, 2] == pytest.approx(0.2 * path.parameter, abs=1e-12)
    assert data.rotation.values[:, 0] == pytest.approx(np.repeat(data.rotation.values[:1, 0], len(path), axis=0))
    both = cy.trace(model, [lift, turn], range=(0.0, 1.0), step=0.5)
    times = cy.trace(model, "time", range=(0.0, 1.0), step=0.5)
    assert times.unit == "s"
    assert both["rod"].position.values[-1] == pytest.approx(times["rod"].position.values[-1], abs=1e-9)
    rest = cy.equilibrium(model, time=1.0)
    assert times.joint(lift).force.values[-1] == pytest.approx(rest.joint(lift).force.values, abs=1e-8)
    pulled = times.joint(lift).force.values[-1] + times.joint(turn).force.values[-1]
    assert pulled == pytest.approx(np.zeros(3), abs=1e-8)


def test_a_path_turns_at_limit_points_and_begins_where_it_is_told():
    model, path = truss()
    assert [one.kind for one in path.critical] == ["limit", "limit"]
    assert [path.parameter[one.point] for one in path.limits] == [one.parameter for one in path.limits]
    assert np.array_equal(path.stable, path.unstable == 0)
    assert repr(path).startswith(f"<Path: {len(path)} points of the load factor, limit at 9.94992, limit at -9.94992")
    mode = path.mode(path.limits[0])["bob"]
    assert mode.displacement.values[0] == pytest.approx([0, 0, 1])
    other = truss(direction=-1)[1]
    assert other.parameter[-1] == -60.0
    assert other.critical == []
    middle = int(np.flatnonzero(path.unstable)[0])
    at = float(path.parameter[middle])
    again = truss(start=path.equilibrium(middle), begin=at, points=3)[1]
    assert again["bob"].position.values[0] == pytest.approx(path["bob"].position.values[middle], abs=1e-9)
    assert again.ended == "3 points"
    assert path.equilibrium(middle).unstable == 1
    assert path.state(middle).time == 0.0
    assert cy.simulate(model, start=path.state(-1), t_end=1e-3, dt=1e-4).time[0] == 0.0


def test_a_path_is_saved_as_a_run_over_its_parameter(tmp_path):
    path = truss()[1]
    path.save(tmp_path / "path.zarr")
    run = cy.Trajectory.open(tmp_path / "path.zarr")
    assert np.array_equal(run.time, path.parameter)
    assert np.array_equal(run["bob"].position.values, path["bob"].position.values)
    told = run.info["path"]
    assert told["unstable"] == path.unstable.tolist()
    assert [one["point"] for one in told["critical"]] == [one.point for one in path.critical]


def test_gravity_is_stored_as_it_was_observed(tmp_path):
    model, (own,) = cantilever(lambda rod: loads.gravity((0, 0, -3.0)))
    path = cy.trace(model, own, range=(0.0, 0.5), step=0.5)
    path.save(tmp_path / "path.zarr")
    run = cy.Trajectory.open(tmp_path / "path.zarr")
    root = run.reaction("rod", "start").force.values[-1]
    assert root == pytest.approx([0, 0, 1.5], abs=1e-9)
    assert np.array_equal(root, path.reaction("rod", "start").force.values[-1])


def test_branches_leave_to_both_sides():
    rod = cy.Rod(SECTION, length=1.0, direction=(0, 0, 1), elements=8, name="rod")
    load = loads.force(rod.end, (0, 0, -1.0))
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[load])
    path = cy.trace(model, load, range=(2.0, 3.0), step=0.2)
    ends = []
    for side in (1, -1):
        branch = path.branch(direction=side, points=6)
        assert branch.parameter[0] == path.bifurcations[0].parameter
        ends.append(branch["rod"].position.values[-1, -1, 0])
        assert np.all(branch.stable)
        assert np.all(np.diff(branch.parameter) > 0.0)
    assert ends[0] == pytest.approx(-ends[1], rel=1e-6)
    assert abs(ends[0]) > 0.1
    with pytest.raises(ValueError, match="there are 1 bifurcation points, none is 3"):
        path.branch(3)
    with pytest.raises(ValueError, match="direction is 0; give 1 or -1"):
        path.branch(direction=0)
    with pytest.raises(ValueError, match="mode is 1; this point has 1"):
        path.branch(mode=1)
    with pytest.raises(TypeError, match="width is no option"):
        path.branch(width=1.0)
    with pytest.raises(ValueError, match="is no bifurcation point of this path"):
        path.branch(truss()[1].limits[0])


def test_arguments_are_refused():
    model, (own,) = cantilever(push((0, 0, 1.0)))
    stranger = cantilever(push((0, 0, 2.0)))[1][0]
    cases = [
        (TypeError, "'frame' is no Model", ("frame", own), {}),
        (TypeError, "parameter is 3.0; give a load or driven joint", (model, 3.0), {}),
        (TypeError, "parameter is 'speed'", (model, "speed"), {}),
        (ValueError, "force on rod.end is not in the model", (model, stranger), {}),
        (ValueError, "parameter is empty", (model, []), {}),
        (ValueError, "range = .* must be two different", (model, own), {"range": (1.0, 1.0)}),
        (ValueError, "begin = 3.0 must be in the range", (model, own), {"begin": 3.0}),
        (ValueError, "direction = 2 must be 1 or -1", (model, own), {"direction": 2}),
        (ValueError, "points = 1 must be at least 2", (model, own), {"points": 1}),
        (ValueError, "step = 0.0 must be a positive", (model, own), {"step": 0.0}),
        (ValueError, "turn = -1.0 must be a positive", (model, own), {"turn": -1.0}),
        (ValueError, "both start and initial", (model, own), {"start": 1, "initial": {}}),
    ]
    for kind, text, arguments, options in cases:
        with pytest.raises(kind, match=text):
            cy.trace(*arguments, **options)


def test_parameters_that_cannot_be_multiplied_are_refused():
    drag = lambda rod: loads.drag(rod, density=1.0, diameter=0.1)  # noqa: E731
    model, (own,) = cantilever(drag)
    with pytest.raises(ValueError, match="drag on rod has no value to multiply"):
        cy.trace(model, own)
    lift = lambda rod: loads.buoyancy(rod, density=1.0, area=0.1)  # noqa: E731
    model, (own, _) = cantilever(lambda rod: loads.gravity((0, 0, -1.0)), lift)
    with pytest.raises(ValueError, match="gravity is multiplied, but there is buoyancy"):
        cy.trace(model, own)
    rod = model.parts[0]
    ball = joints.ball(rod.end)
    with pytest.raises(ValueError, match=r"no motion of ball of rod\.end to ground is prescribed"):
        cy.trace(model.replace(joints=[ball]), ball)
