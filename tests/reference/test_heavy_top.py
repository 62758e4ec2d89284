"""The fast heavy top of Bruels, Cardona and Arnold (2012) against published and independent values at 2 s."""

import numpy as np

import cayley as cy
from cayley.lie import quaternion
from verify.problems import CENTER, TOP, TOP_START, heavy_top, rotation_distance

KYNEMA_DISPLACEMENT = (-0.150416985652933, -1.724164450779749, -0.673023460701136)
"""Of the mass center from (0, 1, 0), by kynema (generalized α, dt = 2e-6 s)."""
INDEPENDENT = np.array((0.12294713, -0.49107989, 0.35043003, -0.78798689))
"""By DOP853 on Euler's equations, tolerance 1e-12."""


def test_displacement_and_rotation():
    system = cy.compile(heavy_top, rule=cy.rules.nodal, constants=TOP)
    found = []
    for dt in (2e-5, 1e-5):
        run = cy.integrate(system, TOP_START, t_end=2.0, dt=dt, save_every=2.0)
        found.append(run.data["p"].values[-1])
    assert rotation_distance(found[1], INDEPENDENT) < 1e-3
    limit = (4.0 * found[1] - found[0]) / 3.0
    assert rotation_distance(limit, INDEPENDENT) < 1e-6
    center = quaternion.rotate(limit / np.linalg.norm(limit), CENTER)
    np.testing.assert_allclose(center - CENTER, KYNEMA_DISPLACEMENT, atol=3e-6)
