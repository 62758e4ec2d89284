"""A run made up of simple functions of the time, in the form of a Trajectory: a swinging, slightly bent rod."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from cayley import Body, joints, simulate, springs
from cayley.model import Material, Model, Rod, Section, loads, supports
from cayley.report import write_report


def series(time, values):
    dims = ("time", "axis")[: values.ndim]
    coordinates = {"time": ("time", time, {"units": "s"})}
    if values.ndim == 2:
        coordinates["axis"] = list("xyz")
    return xr.DataArray(values, coordinates, dims)


def rod_data(time, rod, dt):
    angle = np.sin(time)[:, None] * (1.0 + 0.1 * rod.nodes)
    position = np.stack([rod.nodes * np.sin(angle), 0.0 * angle, -rod.nodes * np.cos(angle)], axis=-1)
    rotation = np.stack([np.cos(0.5 * angle), 0.0 * angle, np.sin(0.5 * angle), 0.0 * angle], axis=-1)
    taper = 1.0 - rod.nodes / rod.length
    sigma = np.stack([np.outer(np.cos(k * time), taper) for k in (1, 2, 3)], axis=-1)
    fields = {"position": position, "moment": -sigma, "sigma": sigma, "Sigma": sigma}
    fields |= {"sigma_impulse": dt * sigma, "Sigma_impulse": dt * sigma}
    variables = {name: (("time", "node", "axis"), values) for name, values in fields.items()}
    variables["rotation"] = (("time", "node", "wxyz"), rotation)
    return xr.Dataset(variables, {"time": time, "s": ("node", rod.nodes), "axis": list("xyz"), "wxyz": list("wxyz")})


class FakeRun:
    rule, dt, steps, wall_time = "nodal", 1e-3, 4000, 0.048
    accounted = False

    def __init__(self, model, time):
        self.model, self.only = model, None
        self.data = {name: rod_data(time, rod, self.dt) for name, rod in zip(model.names, model.rods, strict=True)}
        loaded = np.clip(time, 0.0, 2.0)
        self.kinetic_energy = series(time, 1.0 + np.sin(time) ** 2)
        self.energy = series(time, loaded + 1e-7 * np.sin(40.0 * time))
        self.potential_energy = self.energy - self.kinetic_energy
        momenta = np.stack([np.sin(time), np.cos(time), loaded], axis=-1)
        self.linear_momentum, self.angular_momentum = series(time, momenta), series(time, 2.0 * momenta)

    def __getitem__(self, rod):
        return self.data[rod if isinstance(rod, str) else self.model.name_of(rod)]


@pytest.fixture(scope="session")
def make_run():
    def make(count=1, until=2.0, frames=201):
        rubber = Material(density=1000.0, youngs_modulus=5e6, poisson_ratio=0.35)
        section = Section.rectangle(0.01, 0.01, rubber)
        rods = [Rod(section, length=2.0, elements=11 - k, direction=(0, 0, -1), origin=(k, 0, 0)) for k in range(count)]
        model = Model(
            *rods,
            supports=[supports.pin(rods[0].start)],
            loads=[loads.gravity((0, 0, -9.81)), loads.moment(rods[0].start, (1, 0, 0), until=until)],
        )
        return FakeRun(model, np.linspace(0.0, 4.0, frames))

    return make


@pytest.fixture
def run(make_run):
    return make_run()


@pytest.fixture
def own_run(run):
    """A run of a Lagrangian of one's own: no model, no rods."""
    fields = xr.Dataset({"p": run["rod"].rotation, "p_t": run["rod"].position})
    names = ("rule", "dt", "steps", "wall_time", "accounted", "energy", "kinetic_energy", "potential_energy")
    momenta = ("linear_momentum", "angular_momentum")
    return SimpleNamespace(
        model=None, only=None, data=fields, **{name: getattr(run, name) for name in (*names, *momenta)}
    )


@pytest.fixture(scope="session")
def crane():
    """A run of all that a page can show: a tapered and a prismatic rod, a body on a joint, a spring, a support."""
    rubber = Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.4)
    mast = Rod(lambda s: Section.circle(0.05 - 0.03 * s, rubber), length=1.0, elements=6, name="mast")
    boom = Rod(
        Section.rectangle(0.02, 0.06, rubber),
        length=0.8,
        elements=6,
        direction=(1, 0, 0),
        origin=(0, 0, 1),
        name="boom",
    )
    ports = {"eye": (0, 0, 0.2), "hook": (0.05, 0, -0.05)}
    weight = Body(mass=0.4, inertia=[1e-3, 2e-3, 1.5e-3], position=(0.8, 0, 0.8), ports=ports, name="weight")
    model = Model(
        mast,
        boom,
        weight,
        supports=[supports.clamp(mast.start)],
        joints=[joints.ball(mast.end, boom.start), joints.ball(boom.end, weight.port("eye"))],
        springs=[springs.linear(boom.node(3), mast.node(3), stiffness=60.0, length=0.5)],
        loads=[loads.gravity((0, 0, -9.81)), loads.force(weight.centre, (0, 1, 0), until=0.2)],
    )
    return simulate(model, t_end=1.0, save_every=0.02, balance=True)


@pytest.fixture(scope="session")
def crane_report(crane, tmp_path_factory):
    return write_report(
        crane,
        tmp_path_factory.mktemp("report") / "report.html",
        title="A <crane> & more",
        scenario_text='[run]\nvalue = "<t>"',
        notes=("What we found", "One < two.", "Three."),
        times=[0.0, 0.3],
        nodes=[0, 3, 6],
    )
