"""Values of loads in and out of their time, and refusals."""

import math

import numpy as np
import pytest

from cayley.model import loads


def test_gravity():
    weight = loads.gravity(np.array([0, 0, -9.81]))
    assert weight.acceleration == (0.0, 0.0, -9.81)
    assert weight.at(3.0).tolist() == [0.0, 0.0, -9.81]
    assert weight == loads.gravity([0, 0, -9.81])


@pytest.mark.parametrize(
    ("make", "kind", "unit"),
    [
        (lambda rod, *a, **k: loads.force(rod.end, *a, **k), "force", "N"),
        (lambda rod, *a, **k: loads.moment(rod.end, *a, **k), "moment", "N m"),
        (loads.line_force, "force", "N/m"),
        (loads.line_moment, "moment", "N m/m"),
    ],
)
class TestEachLoadOnARod:
    def test_constant(self, rod, make, kind, unit):
        load = make(rod, [1, 2, 3])
        assert (load.kind, load.unit, load.part) == (kind, unit, rod)
        assert (load.value, load.frame, load.start, load.until) == ((1.0, 2.0, 3.0), "space", 0.0, math.inf)
        assert load.at(0.0).tolist() == load.at(1e9).tolist() == [1.0, 2.0, 3.0]
        assert load.at(0.0).dtype == np.float64

    def test_each_call_returns_a_fresh_array(self, rod, make, kind, unit):
        load = make(rod, (1, 2, 3))
        load.at(0.0)[0] = 7.0
        assert load.at(0.0)[0] == 1.0

    def test_acts_from_start_until_just_before_the_end(self, rod, make, kind, unit):
        load = make(rod, (1, 0, 0), frame="body", start=1, until=2)
        assert [load.at(t)[0] for t in (0.0, 0.999, 1.0, 1.999, 2.0, 3.0)] == [0, 0, 1, 1, 0, 0]
        assert load.frame == "body"

    def test_function_of_time(self, rod, make, kind, unit):
        called = []

        def value(t):
            called.append(t)
            return [t, 0, 0]

        load = make(rod, value, until=2.0)
        assert load.at(0.5).tolist() == [0.5, 0.0, 0.0]
        assert load.at(2.0).tolist() == [0.0, 0.0, 0.0]
        assert called == [0.5]  # not asked for what it is out of its time

    def test_refused_alike(self, refused, rod, make, kind, unit):
        for changes, line in (
            ({"frame": "world"}, 'frame = \'world\' must be "space" or "body"'),
            ({"start": 2.0, "until": 2.0}, "until = 2.0 must be later than start = 2 s"),
            ({"until": -1}, "until = -1 must be later than start = 0 s"),
            ({"start": math.inf}, "start = inf must be a finite number [s]"),
            ({"start": math.nan}, "start = nan must be a finite number [s]"),
            ({"until": math.nan}, "until = nan must be a finite number [s]"),
            ({"until": -math.inf}, "until = -inf must be a finite number [s]"),
        ):
            owner = str(make(rod, (0, 0, 1)))
            refused(lambda changes=changes: make(rod, (0, 0, 1), **changes), ValueError, f"{owner}: {line}")

    def test_results_are_checked(self, refused, rod, make, kind, unit):
        for result, error, shown in (
            ((1.0, 2.0), ValueError, "(1.0, 2.0)"),
            (np.zeros((3, 1)), ValueError, "array([[0.], [0.], [0.]])"),
            ([0.0, math.nan, 0.0], ValueError, "[0.0, nan, 0.0]"),
            ([0.0, math.inf, 0.0], ValueError, "[0.0, inf, 0.0]"),
            (None, TypeError, "None"),
            (2.0, ValueError, "2.0"),
        ):
            load = make(rod, lambda t, result=result: result)
            line = f"{load}: value(t = 0.25 s) = {shown} must be 3 finite numbers (x, y, z) [{unit}]"
            refused(lambda load=load: load.at(0.25), error, line)


def test_text(rod):
    assert str(loads.gravity((0, 0, -9.81))) == "gravity (0, 0, -9.81) m/s^2"
    assert str(loads.force(rod.end, (0, 0, 1))) == "force on mast.end"
    assert str(loads.line_moment(rod, (0, 0, 1))) == "line moment on mast"

    def torque(t):
        return (t, 0, 0)

    load = loads.moment(rod.start, torque, frame="body", until=2.0)
    assert load.described("boom") == "moment on boom.start: function torque [N m], body frame, 0 s <= t < 2 s"
    load = loads.line_force(rod, (0, 0.5, 0), start=1)
    assert load.described("boom") == "line force on boom: (0, 0.5, 0) N/m, space frame, 1 s <= t"


PORT = "a node of a rod, such as rod.start, rod.end or rod.node(k), or body.centre"


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (lambda rod: loads.force(rod, (0, 0, 1)), TypeError, "force: port = {rod!r} must be " + PORT),
        (lambda rod: loads.moment(None, (0, 0, 1)), TypeError, "moment: port = None must be " + PORT),
        (lambda rod: loads.line_force("mast", (0, 0, 1)), TypeError, "line force: rod = 'mast' must be a Rod"),
        (
            lambda rod: loads.PointLoad(kind="push", port=rod.end, value=(0, 0, 1)),
            ValueError,
            'PointLoad: kind = \'push\' must be "force" or "moment"',
        ),
        (
            lambda rod: loads.force(rod.end, (0, 1)),
            ValueError,
            "force on mast.end: value = (0, 1) must be 3 finite numbers (x, y, z) [N], "
            "or a function of the time [s] that returns them",
        ),
        (
            lambda rod: loads.line_moment(rod, (0, 1, math.nan)),
            ValueError,
            "line moment on mast: value = (0, 1, nan) must be 3 finite numbers (x, y, z) [N m/m], "
            "or a function of the time [s] that returns them",
        ),
        (
            lambda rod: loads.gravity(-9.81),
            ValueError,
            "gravity: acceleration = -9.81 must be 3 finite numbers (x, y, z) [m/s^2]",
        ),
        (
            lambda rod: loads.gravity((0, 0, math.nan)),
            ValueError,
            "gravity: acceleration = (0, 0, nan) must be 3 finite numbers (x, y, z) [m/s^2]",
        ),
        (
            lambda rod: loads.force(rod.end, (0, 0, 1)).at(math.nan),
            ValueError,
            "force on mast.end: t = nan must be a time [s]",
        ),
    ],
)
def test_refusals(refused, rod, call, error, line):
    refused(lambda: call(rod), error, line.format(rod=rod))
