"""The public face of a run: names, dimensions, units, and what is refused."""

from typing import Any

import numpy as np
import pytest

import cayley as cy
from cayley.results.trajectory import Trajectory

UNITS = {
    "position": "m",
    "rotation": "1",
    "velocity": "m/s",
    "angular_velocity": "rad/s",
    "force": "N",
    "moment": "N m",
    "sigma": "N",
    "Sigma": "N m",
    "sigma_impulse": "N s",
    "Sigma_impulse": "N m s",
    "strain": "1",
    "curvature": "1/m",
}


def test_dataset_of_a_rod(thrown: Any) -> None:
    data = thrown.run[thrown.rod]
    assert {name: values.attrs["units"] for name, values in data.data_vars.items()} == UNITS
    assert all(values.attrs["long_name"] for values in data.data_vars.values())
    for name, values in data.data_vars.items():
        place = "element" if name in ("strain", "curvature") else "node"
        assert values.dims == ("time", place, "wxyz" if name == "rotation" else "axis")
        assert values.dtype == np.float64
        assert np.isfinite(values).all()
    assert dict(data.sizes) == {"time": 201, "node": 11, "element": 10, "axis": 3, "wxyz": 4}
    assert list(data.axis.values) == list("xyz")
    assert list(data.wxyz.values) == list("wxyz")
    assert np.array_equal(data.s, thrown.rod.nodes)
    assert (data.s.attrs["units"], data.time.attrs["units"]) == ("m", "s")
    assert np.allclose(np.linalg.norm(data.rotation, axis=-1), 1.0, atol=1e-14)


def test_rotations_are_continuous_along_the_rod(thrown: Any) -> None:
    p = thrown.run[thrown.rod].rotation.values
    assert np.all(np.sum(p[:, 1:] * p[:, :-1], axis=-1) > 0)


def test_series(thrown: Any) -> None:
    run = thrown.run
    for name, unit in (("energy", "J"), ("kinetic_energy", "J"), ("potential_energy", "J")):
        series = getattr(run, name)
        assert (series.dims, series.attrs["units"], series.name) == (("time",), unit, name)
    for name, unit in (("linear_momentum", "kg m/s"), ("angular_momentum", "kg m^2/s")):
        series = getattr(run, name)
        assert (series.dims, series.attrs["units"], series.name) == (("time", "axis"), unit, name)
    total = run.kinetic_energy + run.potential_energy
    assert np.allclose(run.energy, total, rtol=1e-14)
    assert np.ptp(run.energy) == run.energy.values.max() - run.energy.values.min()
    assert float(run.energy.sel(time=0.01, method="nearest")) == run.energy.values[100]


def test_facts_and_repr(thrown: Any) -> None:
    run = thrown.run
    assert (run.rule, run.steps, run.model.rods) == (thrown.rule, 200, (thrown.rod,))
    assert run.dt == pytest.approx(1e-4, rel=1e-12)
    assert 0.0 < run.wall_time < 10.0
    rule = thrown.rule
    assert repr(run) == f"<Trajectory: rule {rule}, 200 steps of 0.0001 s, 201 frames, t = 0 to 0.02 s, parts rod>"


def test_parts_by_name_by_rod_and_by_equal_rod(thrown: Any) -> None:
    run, rod = thrown.run, thrown.rod
    assert run["rod"].identical(run[rod])
    twin = cy.Rod(rod.section, length=0.8, elements=10, origin=(0.1, 0.2, 0.3), direction=(1, 2, 2), normal=(0, 0, 1))
    assert run[twin].identical(run[rod])
    for stranger in ("mast", 7, cy.Rod(rod.section, length=0.9, elements=10)):
        with pytest.raises(KeyError, match=r"the run has no part .*; it has rod"):
            run[stranger]


def test_data_of_an_own_lagrangian() -> None:
    @cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3), y=cy.Vector(2))
    def body(q: Any, c: Any) -> Any:
        return 0.5 * (cy.dot(q.p_t, q.p_t) + cy.dot(q.x_t, q.x_t) + 3.0 * cy.dot(q.y_t, q.y_t)) - q.y[0] ** 2

    system = cy.compile(body, rule=cy.rules.nodal)
    start = {"p": (1, 0, 0, 0), "x": (1, 2, 3), "y": (0.5, 0), "p_t": (1, 2, 3), "x_t": (1, 0, 0), "y_t": (0, 2)}
    run = cy.integrate(system, start, t_end=1.0, dt=0.01, save_every=0.1)
    dims = {name: values.dims[1:] for name, values in run.data.data_vars.items()}
    assert dims == {
        "p": ("wxyz",),
        "p_t": ("axis",),
        "p_momentum": ("axis",),
        "x": ("axis",),
        "x_t": ("axis",),
        "x_momentum": ("axis",),
        "y": ("y_component",),
        "y_t": ("y_component",),
        "y_momentum": ("y_component",),
    }
    first = run.data.isel(time=0)
    for name in ("p", "x", "y", "p_t", "x_t", "y_t"):
        assert np.allclose(first[name], start[name], atol=1e-15)
    assert np.allclose(first.y_momentum, (0.0, 6.0))
    assert np.allclose(run.linear_momentum, (1.0, 0.0, 0.0))  # x is a position, y is none
    assert repr(run) == "<Trajectory: rule nodal, 100 steps of 0.01 s, 11 frames, t = 0 to 1 s>"
    with pytest.raises(KeyError, match=r"none \(use run\.data\)"):
        run["rod"]


def test_data_on_an_interval() -> None:
    @cy.lagrangian(u=cy.Vector(1), z=cy.Interval)
    def bar(q: Any, c: Any) -> Any:
        return 0.5 * q.u_t[0] ** 2 - 0.5 * q.u_z[0] ** 2

    system = cy.compile(bar, rule=cy.rules.verlet, domain=cy.Interval(1.0, 2.0, elements=4))
    run = cy.integrate(system, {"u": np.zeros((5, 1))}, t_end=1.0)
    assert run.data["u"].dims == ("time", "node", "u_component")
    assert np.array_equal(run.data.z, np.linspace(1.0, 2.0, 5))


def test_needs_a_system_or_what_was_seen_of_it(thrown: Any) -> None:
    with pytest.raises(TypeError, match="give the system, or its outline"):
        Trajectory(frames=thrown.run.frames, info={})
