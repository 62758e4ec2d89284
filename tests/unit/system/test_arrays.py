"""Arrays of a system: weights of chains, blocks of lanes and back, constants of several rods."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads
from cayley.discrete.rules import verlet
from cayley.lie import quaternion
from cayley.system.compile import chain_arrays
from cayley.system.discretize import discretize, spans
from cayley.system.system import State, aligned, by_node, gather, pack
from unit.density.examples import EXAMPLES
from unit.system.rods import pendulum, round_rod, three_rods


def strings(elements: int):
    return cy.compile(
        EXAMPLES["string"].lagrangian,
        rule=verlet,
        domain=cy.Interval(0.0, 2.0, elements=elements),
        constants=EXAMPLES["string"].constants,
        held={"x": "start"},
    )


def test_chain_of_unequal_elements():
    named = chain_arrays(np.array([0.0, 1.0, 3.0, 3.5]))
    assert_allclose(named["length"], [1.0, 2.0, 0.5, 0.0])
    assert_allclose(named["weight"], [0.5, 1.5, 1.25, 0.25])
    assert_allclose(named["weight"] * named["1/weight"], 1.0)
    assert named["weight"].sum() == pytest.approx(3.5)


@given(st.integers(1, 40), st.integers(0, 2**32 - 1))
def test_pack_and_gather(elements, seed):
    """Values come back from the blocks by node, bit for bit; the padding is at rest and has no element."""
    system = strings(elements)
    rng = np.random.default_rng(seed)
    n, rows, lanes = system.size, system.equations.rows, system.kernels.lanes
    state = State(values=rng.normal(size=(n, 3)), momenta=rng.normal(size=(n, 3)))
    data = pack(system, state)
    blocks = -(-n // lanes)
    assert data.shape == (blocks + 2, rows.count, lanes)
    assert data.ctypes.data % 64 == 0
    inner = data[1:-1]
    assert np.array_equal(gather(inner, rows.values, n), state.values)
    assert np.array_equal(gather(inner, rows.momenta, n), state.momenta)
    assert np.array_equal(gather(inner, rows.held, n), system.free.astype(float))
    for name, row in rows.named.items():
        assert np.array_equal(gather(inner, slice(row, row + 1), n)[:, 0], system.named[name])
    everything = np.moveaxis(data, 1, 2).reshape(-1, rows.count)
    padding = np.delete(everything, np.arange(lanes, lanes + n), axis=0)
    assert np.array_equal(padding[:, rows.momenta], np.zeros((len(padding), 3)))
    assert np.array_equal(padding[:, rows.named["length"]], np.zeros(len(padding)))
    assert np.array_equal(padding[:, rows.values], np.broadcast_to(state.values[-1], (len(padding), 3)))
    frames = np.stack([inner, 2.0 * inner])
    assert np.array_equal(gather(frames, rows.values, n), [state.values, 2.0 * state.values])


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_cells_of_several_nodes(degree):
    """Nodes come back by node from cells, and the last node of each rod is alone in a cell without length."""
    system = discretize(three_rods()[0], cy.rules.spectral(space=degree))
    rng = np.random.default_rng(degree)
    n, rows, layout = system.size, system.equations.rows, system.layout
    state = State(values=rng.normal(size=(n, layout.rows)), momenta=rng.normal(size=(n, layout.dofs)))
    inner = pack(system, state)[1:-1]
    assert np.array_equal(by_node(system, inner, rows.values), state.values)
    assert np.array_equal(by_node(system, inner, rows.momenta), state.momenta)
    assert np.array_equal(by_node(system, inner, rows.held), system.free)
    length = gather(inner, slice(rows.named["length"], rows.named["length"] + 1), system.cells)[:, 0]
    ends = np.cumsum([(count - 1) // degree + 1 for count in system.chains]) - 1
    assert np.array_equal(np.flatnonzero(length == 0.0), ends)
    last = gather(inner, rows.momenta, system.cells)[ends, layout.dofs :]
    assert not np.any(last)


def test_aligned_arrays():
    for shape in ((1, 1, 1), (3, 7, 2), (5, 13, 8)):
        array = aligned(shape)
        assert array.shape == shape
        assert array.flags.c_contiguous
        assert array.ctypes.data % 64 == 0


def test_one_point_is_a_chain_of_one_node():
    top = cy.compile(EXAMPLES["quartic_top"].lagrangian, rule=verlet, constants=EXAMPLES["quartic_top"].constants)
    assert top.size == 1
    assert top.chains == (1,)
    assert top.named["weight"].tolist() == [1.0]
    assert "length" not in top.named


def test_nodes_of_a_density():
    assert_allclose(strings(4).nodes, [0.0, 0.5, 1.0, 1.5, 2.0])
    assert_allclose(strings(4).reference[:, 2], strings(4).nodes)


@pytest.mark.parametrize("rotation", ["quaternion", "matrix"])
def test_rods_stand_one_after_the_other(rotation):
    model, _ = three_rods()
    system = discretize(model, verlet, rotation=rotation)
    layout = system.layout
    assert system.chains == (11, 6, 18)
    assert [(s.start, s.stop) for s in spans(model, 1)] == [(0, 11), (11, 17), (17, 35)]
    for rod, nodes in zip(model.rods, spans(model, 1), strict=True):
        assert_allclose(system.reference[nodes, layout.rows_of("x")], rod.positions)
        assert_allclose(system.named["weight"][nodes].sum(), rod.length)
        assert system.named["length"][nodes][-1] == 0.0
        p = layout.representation.to_quaternion(system.reference[nodes, layout.rows_of("p")])
        assert_allclose(
            quaternion.to_matrix(p),
            np.broadcast_to(quaternion.to_matrix(np.asarray(rod.rotation)), (len(p), 3, 3)),
            atol=1e-14,
        )
        assert_allclose(system.named["inverse"][nodes], 1.0 / rod.element_length)
        assert_allclose(system.named["c.mass"][nodes], rod.section.mass_per_length)


def test_what_is_equal_stays_uniform():
    """Constants become arrays just where rods differ."""
    a, b = round_rod(4, name="a"), round_rod(6, length=1.5, origin=(0, 1, 0), name="b")
    system = discretize(cy.Model(a, b), verlet)
    assert not system.equations.varying
    assert "inverse" in system.equations.uniforms
    other = discretize(cy.Model(a, round_rod(6, origin=(0, 1, 0), name="b")), verlet)
    assert other.equations.varying == {"inverse"}
    stiff = discretize(cy.Model(a, round_rod(4, modulus=1e7, origin=(0, 1, 0), name="b")), verlet)
    assert stiff.equations.varying == {f"c.stiffness[{i},{i}]" for i in range(6)}


def test_weights_add_up_and_gravities_sum():
    rod = round_rod(4)
    model = cy.Model(rod, loads=[loads.gravity((0, 0, -9.81)), loads.gravity((1.0, 0, 0.81))])
    system = discretize(model, verlet)
    known = dict(zip(system.equations.uniforms, system.uniforms, strict=True))
    assert known["c.gravity[0]"] == 1.0
    assert known["c.gravity[2]"] == pytest.approx(-9.0)
    assert "c.gravity[1]" not in known


def test_description():
    text = str(discretize(pendulum(4), verlet))
    assert "5 nodes, 30 degrees of freedom" in text
    assert "rule verlet (quaternion form)" in text
    assert "p[0], p[1], p[2] by Newton" in text
