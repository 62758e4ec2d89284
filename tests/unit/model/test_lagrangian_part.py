"""Parts with a Lagrangian of their own: their nodes and ports, and lines that refuse what cannot be one."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.lie import quaternion


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(3))
def body(q, c):
    return 0.5 * c.mass * cy.dot(q.x_t, q.x_t) + 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t)


@cy.lagrangian(x=cy.Vector(3), s=cy.Interval)
def string(q, c):
    return 0.5 * cy.dot(q.x_t, q.x_t) - 0.5 * (cy.norm(q.x_s) - 1.0) ** 2


@cy.lagrangian(x=cy.Vector(3), y=cy.Vector(1))
def other(q, c):
    return 0.5 * cy.dot(q.x_t, q.x_t) + 0.5 * cy.dot(q.y_t, q.y_t)


@cy.lagrangian(x=cy.Vector(2))
def flat(q, c):
    return 0.5 * cy.dot(q.x_t, q.x_t)


@cy.lagrangian(x=cy.Vector(3))
def quartic(q, c):
    return 0.5 * cy.dot(q.x_t, q.x_t) + cy.dot(q.x_t, q.x_t) ** 2


LINE = cy.Interval(1.0, 3.0, elements=4)
TURN = quaternion.from_rotation_vector((0.3, -0.2, 0.5))


def test_one_node():
    part = cy.LagrangianPart(
        lagrangian=body,
        constants={"mass": 2, "inertia": np.eye(3)},
        position=(1, 2, 3),
        rotation=TURN,
        ports={"eye": (0, 0, 0.5), "lug": ((0, 1, 0), TURN)},
        name="top",
    )
    assert (part.node_count, part.noun, part.label) == (1, "part", "LagrangianPart 'top'")
    assert np.isnan(part.mass)
    assert part.held == (False, False)
    assert str(part.centre) == "top.centre"
    position, rotation = part.port("eye").place
    assert_allclose(position, np.array((1, 2, 3)) + quaternion.rotate(TURN, (0, 0, 0.5)))
    assert_allclose(rotation, TURN)
    assert_allclose(part.port("lug").place[1], quaternion.multiply(TURN, TURN))
    assert repr(part) == "LagrangianPart(name='top', lagrangian=body)"


def test_a_chain():
    part = cy.LagrangianPart(lagrangian=string, domain=LINE, position=(1, 0, 0), rotation=TURN)
    assert (part.node_count, part.held) == (5, (False, True))
    assert [str(port) for port in (part.start, part.node(1), part.end)] == ["part.start", "part.node(1)", "part.end"]
    assert part.port("end") == part.end
    assert_allclose(part.place(4)[0], np.array((1, 0, 0)) + quaternion.rotate(TURN, (0, 0, 2.0)))
    bent = cy.LagrangianPart(lagrangian=string, domain=LINE, position=lambda s: (s, s**2, 0), rotation=lambda s: TURN)
    assert_allclose(bent.place(2)[0], (2.0, 4.0, 0.0))
    assert_allclose(bent.place(2)[1], TURN)
    assert cy.Model(bent).mass == 0


@pytest.mark.parametrize(
    ("options", "error", "line"),
    [
        ({"lagrangian": lambda q, c: 0}, TypeError, "must be a function decorated with @cy.lagrangian"),
        ({"lagrangian": other}, ValueError, r"other has the field y = Vector\(size=1\), but must have fields p = cy"),
        ({"lagrangian": flat}, ValueError, r"flat has the field x = Vector\(size=2\), but must have fields p = cy"),
        (
            {"lagrangian": string},
            ValueError,
            r"domain = None must be a cy.Interval\(start, stop, elements=n\), for str",
        ),
        ({"lagrangian": body, "domain": LINE}, ValueError, "must be left out, for body has no interval"),
        ({"lagrangian": body, "position": lambda s: (s, 0, 0)}, TypeError, "is for a part on an interval"),
        ({"lagrangian": body, "position": (1, 2)}, ValueError, r"position = \(1, 2\) must be 3 finite numbers"),
        ({"lagrangian": body, "rotation": (1, 1, 0, 0)}, ValueError, "rotation = .* must be a unit quaternion"),
        ({"lagrangian": body, "constants": {"m 1": 1.0}}, ValueError, "'m 1' must be named like variables"),
        ({"lagrangian": body, "constants": {"mass": "1"}}, TypeError, "mass = '1' must be finite numbers"),
        ({"lagrangian": string, "domain": LINE, "ports": {"a": (0, 0, 0)}}, ValueError, "ports = .* must be left out"),
        ({"lagrangian": string, "domain": LINE, "position": lambda s: (s, 0)}, ValueError, "must be 3 finite numbers"),
    ],
)
def test_refusals(options, error, line):
    with pytest.raises(error, match="^LagrangianPart 'one'.*" + line):
        cy.LagrangianPart(name="one", **options)


def test_ports_that_are_not_there():
    one, chain = cy.LagrangianPart(lagrangian=flat_free), cy.LagrangianPart(lagrangian=string, domain=LINE)
    with pytest.raises(ValueError, match="port = 'eye' must be one of centre"):
        one.port("eye")
    with pytest.raises(ValueError, match="port = 'centre' must be one of start, end"):
        _ = chain.centre


@cy.lagrangian(x=cy.Vector(3))
def flat_free(q, c):
    return 0.5 * cy.dot(q.x_t, q.x_t)


def test_momenta_must_be_linear_in_velocities():
    with pytest.raises(ValueError, match="LagrangianPart 'one': quartic has terms of higher than second order"):
        cy.simulate(cy.Model(cy.LagrangianPart(lagrangian=quartic, name="one")), 0.1, 1e-3)
