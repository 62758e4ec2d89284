"""Every misuse of a Lagrangian is told at once, in one line that names the culprit and what would be right."""

import math

import numpy as np
import pytest

import cayley as cy
from cayley import densities
from cayley.density import trace

E3 = np.array([0.0, 0.0, 1.0])


def refused(error: type[Exception], call, *parts: str) -> None:
    """Assert that a call fails with one line that holds all parts."""
    with pytest.raises(error) as caught:
        call()
    message = str(caught.value)
    assert "\n" not in message
    for part in parts:
        assert part in message, message


def of(body, **fields):
    """A Lagrangian with the kinetic energy of x and a body of the test's own."""

    @cy.lagrangian(**(fields or {"x": cy.Vector(3)}))
    def mine(q, c):
        return 0.5 * q.x_t @ q.x_t + body(q, c)

    return mine


class TestDeclaration:
    def test_unknown_kind_of_field(self):
        refused(TypeError, lambda: cy.lagrangian(x=3), "x is 3", "cy.Vector(n)")

    def test_class_without_size(self):
        refused(TypeError, lambda: cy.lagrangian(x=cy.Vector), "x is", "cy.Vector(n)")

    def test_no_field(self):
        refused(TypeError, lambda: cy.lagrangian(s=cy.Interval), "no field declared")

    def test_two_intervals(self):
        refused(TypeError, lambda: cy.lagrangian(x=cy.Vector(1), s=cy.Interval, r=cy.Interval), "s and r")

    def test_function_of_one_argument(self):
        refused(TypeError, lambda: cy.lagrangian(x=cy.Vector(1))(lambda q: q.x), "must be a function of (q, c)")

    def test_not_a_function(self):
        refused(TypeError, lambda: cy.lagrangian(x=cy.Vector(1))(3), "must be a function of (q, c)")

    @pytest.mark.parametrize(
        ("fields", "name"),
        [
            ({"t": cy.Vector(1)}, "t"),
            ({"x": cy.Vector(1), "x_t": cy.Vector(1)}, "x_t"),
            ({"x": cy.Vector(1), "x_s": cy.Vector(1), "s": cy.Interval}, "x_s"),
        ],
    )
    def test_name_with_two_meanings(self, fields, name):
        refused(TypeError, lambda: cy.lagrangian(**fields)(lambda q, c: 0), f"the name {name} has two meanings")

    @pytest.mark.parametrize("size", [0, -1, 2.0, True, "3"])
    def test_size_of_a_vector(self, size):
        refused(ValueError, lambda: cy.Vector(size), f"size is {size!r}", "at least 1")

    @pytest.mark.parametrize(
        ("arguments", "part"),
        [((0.0, 0.0, 3), "stop"), ((1.0, 0.0, 3), "stop"), ((0.0, math.nan, 3), "stop"), ((0.0, 1.0, 0), "elements")],
    )
    def test_interval(self, arguments, part):
        refused(ValueError, lambda: cy.Interval(*arguments), part)

    @pytest.mark.parametrize("elements", [True, 2.5, -4])
    def test_elements(self, elements):
        refused(ValueError, lambda: cy.Interval(0.0, 1.0, elements=elements), f"elements is {elements!r}")

    def test_described_in_one_line(self):
        text = "Lagrangian rod (p: rotation, x: vector(3)) on the interval s"
        assert str(densities.rod) == text
        assert densities.rod.names == ("p", "p_t", "p_s", "x", "x_t", "x_s", "s", "t")


class TestBody:
    """What goes wrong when the function is called on symbols."""

    def test_unknown_name_with_suggestion(self):
        refused(
            ValueError,
            lambda: trace(of(lambda q, c: q.x_tt[0]), {}),
            "Lagrangian mine: unknown name q.x_tt",
            "there are t, x, x_t",
            "did you mean x_t?",
        )

    def test_slope_without_an_interval(self):
        refused(ValueError, lambda: trace(of(lambda q, c: q.x_s[0]), {}), "unknown name q.x_s", "there are t, x, x_t")

    def test_unknown_name_without_suggestion(self):
        with pytest.raises(ValueError, match=r"unknown name q\.velocity, there are t, x, x_t$"):
            trace(of(lambda q, c: q.velocity), {})

    def test_unknown_constant_with_suggestion(self):
        refused(
            ValueError,
            lambda: trace(of(lambda q, c: c.stiff), {"stiffness": 1.0}),
            "Lagrangian mine: unknown constant c.stiff",
            "did you mean stiffness?",
        )

    def test_missing_constant(self):
        refused(ValueError, lambda: trace(of(lambda q, c: c.k), {}), "unknown constant c.k, there are none")

    def test_unused_constant(self):
        refused(
            ValueError,
            lambda: trace(of(lambda q, c: c.k * q.x[0]), {"k": 1.0, "damping": 2.0}),
            "the constant damping is given but never used",
            "it uses k",
        )

    def test_vector_returned(self):
        refused(ValueError, lambda: trace(of(lambda q, c: q.x), {}), "returns shape (3,)", "must return one number")

    def test_rotation_returned(self):
        @cy.lagrangian(p=cy.Rotation())
        def mine(q, c):
            return q.p

        refused(ValueError, lambda: trace(mine, {}), "returns shape (3, 3)")

    def test_nothing_returned(self):
        @cy.lagrangian(x=cy.Vector(1))
        def forgot(q, c):
            0.5 * q.x_t[0] ** 2

        refused(ValueError, lambda: trace(forgot, {}), "Lagrangian forgot returns None", "must return one number")

    @pytest.mark.parametrize(
        ("body", "part"),
        [
            (lambda q, c: 1.0 if q.x[0] > 0 else 0.0, "cannot branch on a symbol: use cy.where(condition, a, b)"),
            (lambda q, c: max(q.x[0], q.x[1]), "cannot branch on a symbol"),
            (lambda q, c: math.sin(q.x[0]), "use NumPy's functions (np.sin, ...), not those of math"),
            (lambda q, c: q.x @ c.k, "mismatch"),
            (lambda q, c: q.x[5], "out of bounds"),
            (lambda q, c: np.spacing(q.x[0]), "numpy.spacing does not work on symbols"),
        ],
    )
    def test_errors_tell_the_line(self, body, part):
        constants = {"k": np.eye(2)} if part == "mismatch" else {}
        refused(ValueError, lambda: trace(of(body), constants), "Lagrangian mine: ", part, "in line ", "lambda q, c:")

    @pytest.mark.parametrize("value", [math.nan, math.inf, [1.0, -math.inf], None])
    def test_constant_that_is_not_finite(self, value):
        refused(
            ValueError, lambda: trace(of(lambda q, c: 0), {"k": value}), "constant k has an entry that is not finite"
        )

    @pytest.mark.parametrize("value", ["stiff", [1.0, [2.0, 3.0]], {"a": 1.0}])
    def test_constant_that_is_no_number(self, value):
        refused(
            ValueError,
            lambda: trace(of(lambda q, c: 0), {"k": value}),
            f"constant k is {value!r}; give a number, a vector or a matrix",
        )


class TestCompile:
    """What only the compiler can see."""

    def test_field_without_inertia(self):
        @cy.lagrangian(x=cy.Vector(3), p=cy.Rotation())
        def light(q, c):
            return 0.5 * q.x_t @ q.x_t - q.p.rotate(E3) @ q.x

        refused(
            ValueError,
            lambda: cy.compile(light, rule=cy.rules.nodal),
            "Lagrangian light: the mass matrix is singular, p[0] has no inertia",
            "in every component of q.p_t",
        )

    def test_one_component_without_inertia(self):
        refused(
            ValueError,
            lambda: cy.compile(
                densities.rigid_body,
                rule=cy.rules.nodal,
                constants=dict(mass=1.0, inertia=np.diag([1.0, 0.0, 2.0]), gravity=E3),
            ),
            "p[1] has no inertia",
        )

    def test_negative_inertia(self):
        refused(
            ValueError,
            lambda: cy.compile(of(lambda q, c: -(q.x_t[1] ** 2)), rule=cy.rules.nodal),
            "x[1] has inertia -1;",
        )

    def test_indefinite_inertia(self):
        refused(
            ValueError,
            lambda: cy.compile(of(lambda q, c: 3.0 * q.x_t[0] * q.x_t[1]), rule=cy.rules.nodal),
            "not positive definite",
        )

    def test_only_linear_in_the_velocity(self):
        @cy.lagrangian(x=cy.Vector(1))
        def linear(q, c):
            return q.x_t[0] * q.x[0]

        refused(ValueError, lambda: cy.compile(linear, rule=cy.rules.nodal), "x[0] has no inertia")

    def test_density_without_domain(self):
        refused(
            ValueError,
            lambda: cy.compile(densities.string, rule=cy.rules.verlet),
            "Lagrangian string is a density on an interval; give domain=cy.Interval(start, stop, elements=n)",
        )

    def test_domain_that_is_no_interval(self):
        refused(
            ValueError,
            lambda: cy.compile(densities.string, rule=cy.rules.verlet, domain=10),
            "give domain=cy.Interval(",
        )

    def test_domain_without_density(self):
        refused(
            ValueError,
            lambda: cy.compile(of(lambda q, c: 0), rule=cy.rules.verlet, domain=cy.Interval(0.0, 1.0, elements=2)),
            "has no interval, but a domain is given; leave it out or declare s=cy.Interval",
        )

    @pytest.mark.parametrize("rule", ["verlet", None, cy.rules])
    def test_wrong_rule(self, rule):
        refused(TypeError, lambda: cy.compile(of(lambda q, c: 0), rule=rule), "rule is", "such as cy.rules.verlet")

    def test_function_that_was_not_decorated(self):
        refused(TypeError, lambda: cy.compile(lambda q, c: 0, rule=cy.rules.nodal), "decorate", "@cy.lagrangian(...)")

    def test_wrong_form_of_rotation(self):
        refused(
            ValueError,
            lambda: cy.compile(of(lambda q, c: 0), rule=cy.rules.nodal, rotation="euler"),
            "rotation is 'euler'; give one of quaternion, matrix",
        )

    def test_velocities_coupled_with_slopes(self):
        lagrangian = of(lambda q, c: q.x_t @ q.x_s, x=cy.Vector(3), s=cy.Interval)
        refused(
            ValueError,
            lambda: cy.compile(lagrangian, rule=cy.rules.verlet, domain=cy.Interval(0.0, 1.0, elements=2)),
            "Lagrangian mine: velocities are coupled with derivatives along s in one term",
            "rule verlet",
        )


class TestHeld:
    @pytest.fixture
    def held(self):
        constants = dict(mass=1.0, stiffness=1.0, gravity=E3)

        def compiled(value):
            domain = cy.Interval(0.0, 1.0, elements=4)
            return cy.compile(densities.string, rule=cy.rules.verlet, domain=domain, constants=constants, held=value)

        return compiled

    def test_unknown_field(self, held):
        refused(ValueError, lambda: held({"x_": "start"}), "held names 'x_'; its fields are x", "did you mean 'x'?")

    @pytest.mark.parametrize("place", ["middle", 5, -6, 1.0, None])
    def test_unknown_node(self, held, place):
        refused(ValueError, lambda: held({"x": place}), "held['x'] has", f"{place!r}", "a node number from 0 to 4")

    @pytest.mark.parametrize(
        ("places", "nodes"),
        [
            ("start", [0]),
            ("end", [4]),
            (("start", "end"), [0, 4]),
            (2, [2]),
            ([1, -1], [1, 4]),
            (np.arange(3), [0, 1, 2]),
        ],
    )
    def test_nodes_held(self, held, places, nodes):
        free = held({"x": places}).free
        assert np.flatnonzero(~free.any(axis=1)).tolist() == nodes
        assert free[[k for k in range(5) if k not in nodes]].all()
