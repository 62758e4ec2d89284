"""Loads along rods: listings and refusals."""

import math

import numpy as np
import pytest

from cayley.model import Material, Model, Rod, Section, loads

STEEL = Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
ROD = Rod(Section.circle(0.01, STEEL), length=1.0, elements=2, name="mast")
STIFF = Rod(Section.circle(0.01, STEEL), length=1.0, elements=2, kinematics="inextensible")


def test_listing():
    def wind(s, t):
        return np.stack([s, t, 0.0 * s])

    given = [
        loads.distributed(ROD, wind, frame="body", until=2.0),
        loads.pressure(ROD, 3.0, axis="d2"),
        loads.drag(ROD, density=1000.0, diameter=0.02, velocity=(1, 0, 0)),
        loads.decay(ROD, 3.0, until=2.0),
        loads.buoyancy(ROD, density=1000.0, area=3e-4),
        loads.temperature(ROD, 20.0, expansion=1.2e-5),
        loads.tendon(ROD, 5.0, offset=(0.01, 0, 0)),
        loads.density(ROD, lambda q, c: [(c.f * q.x_t, q.x)], f=1.0),
    ]
    text = str(Model(ROD, loads=given))
    for line in (
        "distributed on mast: function wind N/m, body frame, 0 s <= t < 2 s",
        "pressure on mast: 3 N/m along d2",
        "drag on mast: normal 1.2, tangential 0, stream (1, 0, 0) m/s",
        "decay on mast: 3 1/s, 0 s <= t < 2 s",
        "buoyancy on mast: 1000 kg/m^3 on 0.0003 m^2",
        "imposed strain on mast: (0, 0, 1.2e-05, 0, 0, 0) times 20",
        "tendon on mast: tension 5 N at (0.01, 0, 0) m",
        "density on mast: function <lambda>",
    ):
        assert line in text


def test_a_load_of_a_rod_that_is_not_there_is_refused():
    with pytest.raises(ValueError, match="drag on mast belongs to a rod that is not in the model"):
        Model(STIFF, loads=[loads.drag(ROD, density=1.0, diameter=1.0)])


@pytest.mark.parametrize(
    ("make", "error", "told"),
    [
        (lambda: loads.distributed("mast", (0, 0, 1)), TypeError, "a Rod"),
        (lambda: loads.distributed(ROD, (0, 1)), ValueError, "3 finite numbers"),
        (lambda: loads.distributed(ROD, lambda t: t), TypeError, r"function of \(s, t\)"),
        (lambda: loads.distributed(ROD, (0, 0, 1), frame="local"), ValueError, "frame"),
        (lambda: loads.pressure(ROD, 1.0, axis="d3"), ValueError, "axis"),
        (lambda: loads.pressure(ROD, math.nan), ValueError, "finite"),
        (lambda: loads.pressure(ROD, 1.0, start=2.0, until=1.0), ValueError, "until"),
        (lambda: loads.drag(ROD, density=0.0, diameter=1.0), ValueError, "density"),
        (lambda: loads.drag(ROD, density=1.0, diameter=1.0, normal=-1.0), ValueError, "normal"),
        (lambda: loads.drag(ROD, density=1.0, diameter=1.0, normal=0.0), ValueError, "at least one coefficient"),
        (lambda: loads.decay(ROD, -1.0), ValueError, "rate"),
        (lambda: loads.buoyancy(ROD, density=1.0, area=-1.0), ValueError, "area"),
        (lambda: loads.imposed_strain(ROD, (1, 2, 3)), ValueError, "6 finite numbers"),
        (lambda: loads.temperature(STIFF, 20.0, expansion=1e-5), ValueError, "inextensible has no such strains"),
        (lambda: loads.tendon(ROD, 5.0, offset=3.0), ValueError, "along d1, d2, d3"),
        (lambda: loads.tendon(ROD, lambda s, t: 1.0, offset=(0, 0, 0)), TypeError, r"function of \(t\)"),
        (lambda: loads.density(ROD, 3.0), TypeError, "function of"),
    ],
)
def test_refusals(make, error, told):
    with pytest.raises(error, match=told):
        make()
