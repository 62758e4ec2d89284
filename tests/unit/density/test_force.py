"""Tracing of non-conservative forces: rates, pairs, places, and what is refused."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.density import trace
from cayley.density.expression import to_sx

E3 = np.array([0.0, 0.0, 1.0])


def inertia(q, c):
    return 0.5 * c.m * (cy.dot(q.x_t, q.x_t) + cy.dot(q.p_t, q.p_t))


def density_of(force, **constants):
    made = cy.lagrangian(x=cy.Vector(3), p=cy.Rotation(), s=cy.Interval, force=force)
    return trace(made(inertia), {"m": 2.0, **constants})


def numbers(values, density, **at):
    """Columns of symbols evaluated at slots, rates and frames given by name, all others zero."""
    symbols, given = [], []
    for name, slot in {**density.slots, **density.places}.items():
        symbols.append(to_sx(slot))
        given.append(np.atleast_1d(np.asarray(at.get(name, np.zeros(slot.shape)), dtype=float)))
    for name, slot in density.force.rates.items():
        symbols.append(to_sx(slot))
        given.append(np.asarray(at.get(f"rate of {name}", np.zeros(slot.shape)), dtype=float))
    for name, frame in density.frames.items():
        symbols.append(ca.vec(to_sx(frame).T))
        given.append(np.asarray(at.get(f"frame of {name}", np.eye(3)), dtype=float).reshape(-1))
    inputs = ca.vertcat(*symbols, density.parameters)
    column = np.concatenate([*given, density.values])
    return np.array(ca.Function("f", [inputs], [ca.densify(values)])(column))[:, 0]


def test_rate_of_a_strain_is_its_derivative_along_a_motion():
    """d/dt (Λᵀx′) = Λᵀẋ′ − ω × Λᵀx′."""
    density = density_of(lambda q, c: [(cy.rate(q.p.inverse_rotate(q.x_s)), q.x)])
    f = density.force.terms["spread", "moving"]["x"]
    rng = np.random.default_rng(0)
    frame, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    frame *= np.linalg.det(frame)
    slope, turning, mixed = rng.normal(size=(3, 3))
    found = numbers(f, density, **{"frame of p": frame, "x_s": slope, "p_t": turning, "rate of x_s": mixed})
    assert_allclose(found, frame.T @ mixed - np.cross(turning, frame.T @ slope), atol=1e-14)


def test_pairs_are_sorted_by_place_and_kind():
    def force(q, c):
        return [
            (-c.k * q.x_t, q.x),
            (np.sin(q.t) * E3, q.p),
            (-cy.rate(q.p_s), q.p_s),
            (q.p.rotate(E3), q.x_s),
            (q.x_s, q.x),
        ]

    density = density_of(force, k=0.5)
    terms = {key: set(own) for key, own in density.force.terms.items()}
    assert terms == {
        ("node", "moving"): {"x"},
        ("node", "still"): {"p"},
        ("strain", "moving"): {"p_s"},
        ("strain", "still"): {"x_s"},
        ("spread", "still"): {"x"},
    }
    assert density.timed
    assert_allclose(numbers(density.force.terms["node", "moving"]["x"], density, x_t=[1.0, 2.0, 3.0]), [-0.5, -1, -1.5])


def test_a_rotated_vector_gives_force_times_arm():
    """F on Λ r: the body moment r × ΛᵀF."""
    r, load = np.array([0.1, 0.2, 0.3]), np.array([1.0, -2.0, 0.5])
    density = density_of(lambda q, c: [(load, q.x + q.p.rotate(r))])
    own = density.force.terms["node", "still"]
    assert_allclose(numbers(own["x"], density), load)
    assert_allclose(numbers(own["p"], density), np.cross(r, load))


def test_rate_counts_explicit_time():
    density = density_of(lambda q, c: [(cy.rate(q.t * q.x), q.x)])
    found = numbers(density.force.terms["node", "moving"]["x"], density, t=2.0, x=[1, 2, 3], x_t=[1, 0, 0])
    assert_allclose(found, [3, 2, 3])


def test_forces_are_part_of_the_signature_and_nothing_else_changes():
    forces = [None, lambda q, c: [(-q.x_t, q.x)], lambda q, c: [(-q.x_t, q.x), (E3, q.x)]]
    plain, drag, more = (density_of(force).signature for force in forces)
    assert drag.startswith(plain)
    assert len({plain, drag, more}) == 3


@pytest.mark.parametrize(
    ("force", "told"),
    [
        (lambda q, c: q.x, "must return a list of pairs"),
        (lambda q, c: [(q.x, 1.0)], "shape"),
        (lambda q, c: [(q.x, q.x_t)], "the quantity depends on a velocity"),
        (lambda q, c: [(cy.rate(q.x_t), q.x)], "acceleration"),
        (lambda q, c: [(q.y, q.x)], "unknown name q.y"),
        (lambda q, c: [(c.k * q.x, q.x)], "unknown constant c.k"),
        (lambda q, c: [(q.p, q.p)], "the force is the rotation q.p"),
    ],
)
def test_misuse_is_told(force, told):
    with pytest.raises(ValueError, match=told):
        density_of(force)


def test_rate_outside_a_force_is_refused():
    with pytest.raises(TypeError, match="no motion here"):
        cy.rate(1.0)


def test_force_must_be_a_function():
    with pytest.raises(TypeError, match="force is 3"):
        cy.lagrangian(x=cy.Vector(3), force=3)
