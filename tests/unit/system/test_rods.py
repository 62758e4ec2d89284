"""Several rods in one sweep of the lanes give what each rod gives alone."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads
from cayley.lie import quaternion
from unit.system.rods import round_rod, three_rods

RUN = dict(t_end=0.04, dt=2e-5, save_every=0.01, allow_unstable=True)


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
@pytest.mark.parametrize("rule", [cy.rules.nodal, cy.rules.verlet], ids=str)
def test_different_rods(rule, rotation):
    """Constants in lanes instead of uniform ones round otherwise, in the last place."""
    together, alone = three_rods()
    run = cy.simulate(together, rule=rule, rotation=rotation, **RUN)
    for model in alone:
        own = cy.simulate(model, rule=rule, rotation=rotation, **RUN)
        (name,) = model.names
        for quantity, scale in (("position", 1.0), ("rotation", 1.0), ("velocity", 10.0), ("angular_velocity", 100.0)):
            found, expected = run[name][quantity].values, own[name][quantity].values
            if quantity == "rotation":  # p and -p are one rotation
                found, expected = quaternion.to_matrix(found), quaternion.to_matrix(expected)
            assert np.ptp(expected[..., -1]) > 0.0
            assert_allclose(found, expected, rtol=0, atol=1e-12 * scale, err_msg=f"{name} {quantity}")


@pytest.mark.parametrize("place", ["first", "last"])
def test_equal_rods_bit_for_bit(place):
    """Same section and element length, none held: the same bits wherever the rod stands in the lanes."""
    rod = round_rod(9, length=9 / 8, name="rod")
    others = [round_rod(n, length=n / 8, origin=(0, k, 0), name=f"other{k}") for k, n in ((1, 4), (2, 1), (3, 13))]
    acting = [loads.gravity((0, 0, -9.81)), loads.force(rod.end, (0.1, 0.2, 0.3))]
    own = cy.simulate(cy.Model(rod, loads=acting), **RUN)
    rods = [rod, *others] if place == "first" else [*others, rod]
    run = cy.simulate(cy.Model(*rods, loads=acting), **RUN)
    for quantity in ("position", "rotation", "velocity", "angular_velocity"):
        assert np.array_equal(run["rod"][quantity].values, own["rod"][quantity].values)


def test_a_rod_does_not_feel_its_neighbor_in_memory():
    """A violent motion of one rod leaves the last node of the one before and the first of the one after alone."""
    a, b, c = (round_rod(3, origin=(0, k, 0), name=name) for k, name in enumerate("abc"))
    model = cy.Model(a, b, c)
    rest = cy.simulate(model, **RUN)
    run = cy.simulate(model, initial={"b": {"velocity": lambda s: (30 * s, -20.0, 15 * s**2)}}, **RUN)
    for name in "ac":
        for quantity in ("position", "rotation", "velocity", "angular_velocity"):
            assert np.array_equal(run[name][quantity].values, rest[name][quantity].values)
    assert np.abs(run["b"].velocity.values).max() > 10.0
