"""Loads over time: exact impulses whatever the step, and functions traced or called one by one."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cayley import loads
from cayley.discrete.rules import gauss
from cayley.system.tables import _traced, time_table
from unit.system.rods import round_rod

ROD = round_rod(4)


def impulse(table, h: float, steps: int, origin: float) -> np.ndarray:
    """What the steps hand to a node: h × load at every step, half of it at the two ends of the run."""
    times = origin + h * np.arange(steps + 1)
    weights = np.full(steps + 1, h)
    weights[[0, -1]] *= 0.5
    return weights @ table(times, h, origin)


@given(
    h=st.floats(1e-4, 0.3),
    origin=st.floats(-1.0, 1.0),
    begin=st.floats(0.5, 5.0),
    length=st.floats(1e-3, 20.0),
)
def test_impulse_of_a_constant_force_is_exact(h, origin, begin, length):
    """Window and steps may lie as they like, also a window inside one step."""
    start = origin + begin * h
    force = loads.force(ROD.end, (2.0, 0.0, -1.0), start=start, until=start + length * h)
    steps = math.ceil(begin + length) + 2
    found = impulse(time_table([force]), h, steps, origin)
    assert_allclose(found, np.array([2.0, 0.0, -1.0]) * length * h, rtol=1e-8, atol=1e-9 * h)


@given(h=st.floats(1e-4, 0.3), origin=st.floats(-1.0, 1.0), before=st.floats(0.0, 3.0), length=st.floats(1.0, 20.0))
def test_load_that_starts_with_the_run_acts_from_its_first_moment(h, origin, before, length):
    force = loads.force(ROD.end, (0.0, 1.0, 0.0), start=origin - before, until=origin + length * h)
    found = impulse(time_table([force]), h, math.ceil(length) + 2, origin)
    assert_allclose(found, [0.0, length * h, 0.0], rtol=1e-8, atol=1e-9 * h)


def test_load_that_starts_within_the_first_half_step():
    force = loads.force(ROD.end, (1.0, 0.0, 0.0), start=0.02, until=0.5)
    assert impulse(time_table([force]), 0.1, 7, 0.0)[0] == pytest.approx(0.48, rel=1e-9)


@given(
    h=st.floats(1e-4, 0.3),
    origin=st.floats(-1.0, 1.0),
    begin=st.floats(-3.0, 5.0),
    length=st.floats(1e-3, 20.0),
    stages=st.integers(1, 4),
)
def test_impulse_of_implicit_rules_is_exact(h, origin, begin, length, stages):
    """Gauss points of a step share what the window leaves of it."""
    start, until = origin + begin * h, origin + (begin + length) * h
    force = loads.force(ROD.end, (2.0, 0.0, -1.0), start=start, until=until)
    points = gauss(stages)
    steps = math.ceil(max(begin + length, 0.0)) + 1
    times = origin + h * (np.arange(steps)[:, None] + np.asarray(points.at))
    found = time_table([force]).at_stages(times, h, origin)
    assert found.shape == (steps, stages, 3)
    inside = max(until - max(start, origin), 0.0)
    impulse = h * np.einsum("s,jsk->k", np.asarray(points.weights), found)
    assert_allclose(impulse, np.array([2.0, 0.0, -1.0]) * inside, rtol=1e-8, atol=1e-8 * h)


def test_stages_take_the_function_at_their_times():
    points = gauss(3)
    times = 0.1 * (np.arange(5)[:, None] + np.asarray(points.at))
    found = time_table([loads.force(ROD.end, lambda t: (t, t**2, 1.0))]).at_stages(times, 0.1, 0.0)
    assert_allclose(found, np.stack([times, times**2, np.ones_like(times)], axis=-1), rtol=1e-14)


@pytest.mark.parametrize("last", range(1, 12))
def test_stages_of_a_window_that_ends_on_a_step(last):
    """The steps behind it get nothing, not even rounding errors."""
    times = 0.1 * (np.arange(13)[:, None] + np.asarray(gauss(2).at))
    found = time_table([loads.force(ROD.end, (1.0, 1.0, 1.0), until=last / 10)]).at_stages(times, 0.1, 0.0)
    assert_allclose(found[:last], 1.0)
    assert not np.any(found[last:])


def test_window_that_ends_on_a_step():
    """A rounding error of a time on the edge of a window leaves nothing behind."""
    h = 0.1
    table = time_table([loads.force(ROD.end, (1.0, 1.0, 1.0), start=0.0, until=0.25)])
    found = table(h * np.arange(6), h, 0.0)
    assert_allclose(found[:, 0], [1.0, 1.0, 1.0, 0.0, 0.0, 0.0], rtol=0, atol=1e-12)
    assert found[3, 0] == 0.0


def test_three_columns_for_each_load():
    first = loads.force(ROD.end, (1.0, 2.0, 3.0))
    second = loads.line_moment(ROD, lambda t: (t, 0.0, t * t), start=0.5)
    found = time_table([first, second])(np.array([0.0, 1.0, 2.0]), 0.01, 0.0)
    assert_allclose(found, [[1, 2, 3, 0, 0, 0], [1, 2, 3, 1, 0, 1], [1, 2, 3, 2, 0, 4]])


def test_values_are_asked_for_only_inside_the_window():
    asked = []

    def value(t):
        asked.append(float(t))
        return (1.0, 0.0, 0.0)

    table = time_table([loads.force(ROD.end, value, start=0.5, until=1.0)])
    asked.clear()
    table(np.linspace(0.0, 2.0, 41), 0.05, 0.0)
    assert asked == [] or (min(asked) >= 0.5 and max(asked) <= 1.0)


def branching(t):
    return np.array([1.0, 2.0, 0.0]) * (t if t < 1.0 else 2.0 - t)


def guarded(t):
    """Works with symbols, and gives something else there than with numbers."""
    try:
        return (math.sin(t), 0.0, 1.0)
    except TypeError:
        return (0.0 * t, 0.0, 1.0)


TRACED = {
    "NumPy": lambda t: 1.5 * np.sin(np.pi * t / 2) * np.array([np.cos(t), np.sin(t), 0.0]),
    "tuple": lambda t: (t, t**2, 1.0),
    "list": lambda t: [np.exp(-t), 0.0, np.sqrt(1.0 + t)],
    "where": lambda t: np.array([1.0, 0.0, 1.0]) * np.where(t < 0.7, t, 1.0 - t),
    "constant": lambda t: (1.0, 2.0, 3.0),
}
CALLED = {
    "branch": branching,
    "math": lambda t: (math.sin(t), math.cos(t), 0.0),
    "table": lambda t: np.array([np.interp(t, [0.0, 1.0, 3.0], [0.0, 1.0, -1.0]), 0.0, 0.0]),
    "max": lambda t: (max(0.0, 1.0 - t), 0.0, 0.0),
    "float": lambda t: (float(t), 0.0, 0.0),
    "rounding": lambda t: (round(t), 0.0, 0.0),
}


@pytest.mark.parametrize("name", [*TRACED, *CALLED])
def test_functions_of_time(name):
    """Traced or called, the values are those of the function; a traced one is not called for every step."""
    function = (TRACED | CALLED)[name]
    calls = []

    def counted(t):
        calls.append(t)
        return function(t)

    table = time_table([loads.force(ROD.end, counted)])
    calls.clear()
    times = np.linspace(0.0, 2.5, 301)
    found = table(times, 0.01, 0.0)
    assert_allclose(found, [np.asarray(function(float(t)), dtype=float) for t in times], rtol=1e-13, atol=1e-15)
    assert len(calls) == (0 if name in TRACED else len(times))


def test_function_that_differs_on_symbols_is_called():
    assert _traced(guarded) is not None
    times = np.linspace(0.0, 2.0, 21)
    found = time_table([loads.force(ROD.end, guarded)])(times, 0.1, 0.0)
    assert_allclose(found[:, 0], np.sin(times), rtol=1e-13)


def test_function_that_returns_nonsense_is_told_with_its_place():
    with pytest.raises(ValueError, match=r"force on rod\.end"):
        time_table([loads.force(ROD.end, lambda t: (1.0, 2.0))])(np.array([0.0]), 0.1, 0.0)
