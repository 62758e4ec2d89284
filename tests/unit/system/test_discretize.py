"""Supports, loads and initial values of a model as arrays, and what is refused."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import loads, supports
from cayley.discrete.rules import verlet
from cayley.lie import quaternion
from cayley.system.discretize import discretize, initial_values, spans
from unit.system.rods import pendulum, round_rod, three_rods

ROD = round_rod(4, name="rod")


def test_supports_hold_single_components():
    held = [
        supports.clamp(ROD.start),
        supports.hold(ROD.node(1), position="xz"),
        supports.hold(ROD.node(1), rotation="y"),
        supports.hold(ROD.node(2), rotation=(True, False, True)),
        supports.pin(ROD.end),
    ]
    system = discretize(cy.Model(ROD, supports=held), verlet)
    x, p = (system.free[:, system.layout.dofs_of(name)] for name in "xp")
    assert x.tolist() == [[False] * 3, [False, True, False], [True] * 3, [True] * 3, [False] * 3]
    assert p.tolist() == [[False] * 3, [True, False, True], [False, True, False], [True] * 3, [True] * 3]


def test_supports_find_their_rod():
    model, _ = three_rods()
    free = discretize(model, verlet).free
    a, b, c = spans(model, 1)
    assert np.flatnonzero(~free.all(axis=1)).tolist() == [a.start, b.start, b.stop - 1]
    assert free[c].all()


def test_entries_of_loads():
    """Node, rows, frame and factor of every load; line loads act on every node with its weight."""
    acting = [
        loads.gravity((0, 0, -9.81)),
        loads.force(ROD.end, (1, 0, 0)),
        loads.force(ROD.node(2), (1, 0, 0), frame="body"),
        loads.moment(ROD.end, (0, 1, 0)),
        loads.moment(ROD.start, (0, 1, 0), frame="body"),
        loads.line_force(ROD, (0, 0, 1)),
    ]
    system = discretize(cy.Model(ROD, loads=acting), verlet)
    entries, layout = system.loads, system.layout
    x, p = layout.dofs_of("x").start, layout.dofs_of("p").start
    assert entries.node.tolist() == [4, 2, 4, 0, 0, 1, 2, 3, 4]
    assert entries.dof.tolist() == [x, x, p, p, *[x] * 5]
    assert entries.form.tolist() == [0, 2, 1, 0, *[0] * 5]
    assert entries.column.tolist() == [0, 3, 6, 9, *[12] * 5]
    assert entries.turn.tolist() == [layout.rows_of("p").start] * 9
    assert_allclose(entries.scale, [1.0] * 4 + [0.125, 0.25, 0.25, 0.25, 0.125])
    assert entries.columns == 15


def test_weight_alone_is_no_entry():
    assert discretize(pendulum(), verlet).loads is None


def test_initial_values_of_all_kinds():
    model, _ = three_rods()
    system = discretize(model, verlet)
    a, b, c = spans(model, 1)
    turn = np.array([np.cos(0.2), np.sin(0.2), 0.0, 0.0])
    values, velocity, momenta = initial_values(
        model,
        system,
        {
            "a": {"velocity": (1, 2, 3), "rotation": turn * (1 + 1e-9)},
            model.rods[1]: {"angular_velocity": lambda s: (s, 0.0, -s), "momentum": (0.5, 0, 0)},
            "c": {"position": lambda s: (0.0, s, 0.0), "angular_momentum": np.full((18, 3), 0.2)},
        },
    )
    x, p = system.layout.dofs_of("x"), system.layout.dofs_of("p")
    assert_allclose(velocity[a, x], np.broadcast_to([1.0, 2.0, 3.0], (11, 3)))
    assert_allclose(values[a, system.layout.rows_of("p")], np.broadcast_to(turn, (11, 4)), atol=1e-15)
    s = np.linspace(0.0, 0.7, 6)
    assert_allclose(velocity[b, p], np.stack([s, 0 * s, -s], axis=1), atol=1e-15)
    weight = system.named["weight"]
    assert_allclose(momenta[b, x], weight[b, None] * [0.5, 0.0, 0.0])
    assert_allclose(momenta[c, p], weight[c, None] * [0.2, 0.2, 0.2])
    assert np.isnan(momenta[a]).all()
    assert np.isnan(momenta[b, p]).all()
    assert_allclose(values[c, system.layout.rows_of("x")][:, 1], np.linspace(0.0, 1.3, 18))
    assert_allclose(values[b], system.reference[b])


def test_initial_rotation_in_matrix_form():
    model = cy.Model(ROD)
    system = discretize(model, verlet, rotation="matrix")
    turn = quaternion.from_matrix(np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]))
    values, *_ = initial_values(model, system, {"rod": {"rotation": turn}})
    assert_allclose(values[0, system.layout.rows_of("p")], [0, 0, 1, 1, 0, 0, 0, 1, 0], atol=1e-15)


STRANGER = round_rod(4, name="stranger")


@pytest.mark.parametrize(
    ("initial", "message"),
    [
        ({"mast": {}}, r"initial: 'mast' is no part of the model; its parts are rod$"),
        ({"rod": {"speed": (1, 0, 0)}}, r"initial\['rod'\]\['speed'\] is unknown; give position, rotation, velocity, "),
        ({"rod": {"velocity": (1, 0)}}, r"initial\['rod'\]\['velocity'\] has shape \(2,\); give \(5, 3\) or \(3,\)$"),
        ({"rod": {"velocity": np.zeros((4, 3))}}, r"has shape \(4, 3\); give \(5, 3\) or \(3,\)$"),
        ({"rod": {"rotation": (1, 0, 0)}}, r"\['rotation'\] has shape \(3,\); give \(5, 4\) or \(4,\)$"),
        ({"rod": {"velocity": "fast"}}, r"\['velocity'\] has shape \(\); give"),
        ({"rod": {"velocity": lambda s: (s, s)}}, r"\['velocity'\] has shape \(5, 2\); give"),
        ({"rod": {"position": (0, np.nan, 0)}}, r"\['position'\] has an entry that is not finite$"),
        ({"rod": {"rotation": (1, 0.1, 0, 0)}}, r"quaternions must have length 1, one has 1\.00499$"),
        ({"rod": {"rotation": (0.9, 0, 0, 0)}}, r"quaternions must have length 1, one has 0\.9$"),
        ({"rod": {"velocity": 1, "momentum": 2}}, r"initial\['rod'\] gives both velocity and momentum; give one$"),
        ({"rod": {"angular_velocity": 1, "angular_momentum": 2}}, r"gives both angular_velocity and angular_momentum"),
    ],
)
def test_initial_values_refused(initial, message):
    model = cy.Model(ROD)
    with pytest.raises(ValueError, match=message) as caught:
        initial_values(model, discretize(model, verlet), initial)
    assert "\n" not in str(caught.value)


def test_initial_of_a_rod_outside_the_model():
    model = cy.Model(ROD)
    with pytest.raises((ValueError, KeyError), match="stranger"):
        initial_values(model, discretize(model, verlet), {STRANGER: {"velocity": (1, 0, 0)}})
