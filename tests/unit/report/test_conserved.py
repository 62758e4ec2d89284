"""Windows without loads, symmetries, and the rows of the table."""

import numpy as np
import pytest

from cayley.model import Material, Model, Rod, Section, damping, loads, supports
from cayley.report.conserved import conservation, load_free, preserved, quaternion_defect
from cayley.simulation import simulate


def rows(run):
    return {row.quantity: row for row in conservation(run)}


def test_window_begins_after_the_last_load(run):
    window = load_free(run)
    assert window.free
    assert window.text == "t = 2 to 4 s, no loads"
    time = run.energy["time"].values
    assert time[window.frames][0] == pytest.approx(2.02)


def test_energy_is_that_of_the_window(run):
    table = rows(run)
    assert float(table["energy, mean"].value) == pytest.approx(2.0, abs=1e-6)
    assert float(table["energy, ripple (max - min)"].value) == pytest.approx(2e-7, rel=0.1)
    assert abs(float(table["energy, drift"].value)) < 1e-7


def test_drift_is_slope_times_length(run):
    time = run.energy["time"]
    run.energy = run.energy + 0.5 * time
    length = float(time[-1] - 2.02)
    assert float(rows(run)["energy, drift"].value) == pytest.approx(0.5 * length, rel=0.05)


def test_only_preserved_momenta_are_listed(run):
    table = rows(run)
    momenta = [name for name in table if "momentum" in name]
    assert momenta == ["angular momentum z, spread"]
    assert float(table[momenta[0]].value) == 0.0
    assert table[momenta[0]].note == "mean 4"


def test_speed(run):
    table = rows(run)
    assert table["steps"].value == "4000"
    assert table["time per node and step"].value == "1000.0"  # ns: 0.048 s / (4000 steps x 12 nodes)
    assert table["step"].note == "rule nodal"


def test_nothing_is_judged_while_loads_act(make_run):
    table = rows(make_run(until=np.inf))
    assert table["energy and momenta"].value == "not judged"
    assert "energy, mean" not in table


def test_quaternion_defect(run):
    assert quaternion_defect(run) < 1e-15
    run["rod"]["rotation"][3, 2, :] *= 1.0 + 1e-6
    assert quaternion_defect(run) == pytest.approx(1e-6, rel=1e-6)


def test_a_lagrangian_of_ones_own(own_run):
    table = rows(own_run)
    assert table["energy, mean"].note == "t = 0 to 4 s"
    assert len([name for name in table if "momentum" in name]) == 6
    assert table["time per node and step"].note == "12 nodes"


@pytest.mark.parametrize(
    ("origin", "hold", "gravity", "linear", "angular"),
    [
        ((0, 0, 0), None, (0, 0, 0), "xyz", "xyz"),
        ((0, 0, 0), None, (0, 0, -9.81), "xy", "z"),
        ((0, 0, 0), ("xyz", ""), (0, 0, 0), "", "xyz"),
        ((0, 0, 0), ("xyz", ""), (0, 0, -9.81), "", "z"),
        ((0, 0, 5), ("xyz", ""), (0, 0, -9.81), "", "z"),
        ((1, 0, 0), ("xyz", ""), (0, 0, -9.81), "", ""),
        ((1, 0, 0), ("xyz", ""), (0, 0, 0), "", "x"),
        ((1, 2, 3), ("z", ""), (0, 0, -9.81), "xy", "z"),
        ((0, 0, 0), ("xyz", "xyz"), (0, 0, 0), "", ""),
        ((0, 0, 0), None, (1, 1, 0), "z", ""),
    ],
)
def test_symmetries(origin, hold, gravity, linear, angular):
    steel = Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
    rod = Rod(Section.circle(0.01, steel), length=1.0, elements=2, origin=origin)
    held = [] if hold is None else [supports.hold(rod.start, position=hold[0], rotation=hold[1])]
    model = Model(rod, supports=held, loads=[loads.gravity(gravity)])
    found = ["".join(axis for axis, stays in zip("xyz", flags, strict=True) if stays) for flags in preserved(model)]
    assert found == [linear, angular]


def test_damping_is_balanced_not_judged():
    rubber = Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    rod = Rod(Section.circle(0.05, rubber), length=1.0, elements=3, damping=damping.retardation(1e-3))
    found = simulate(Model(rod), 0.01, initial={rod: {"angular_velocity": lambda s: (s, 0.0, 0.0)}})
    table = rows(found)
    assert table["energy and momenta"].value == "not judged"
    assert float(table["dissipated"].value) > 0.0
    assert float(table["energy balance, largest defect"].value) < 0.01 * float(table["dissipated"].value)
