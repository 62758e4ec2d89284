"""Discrete equations: rows of a node, programs, signatures, and what cannot be derived."""

import casadi as ca
import numpy as np
import pytest

import cayley as cy
from cayley.density import trace
from cayley.discrete.equations import UNIFORMS, derive
from cayley.discrete.layout import Layout
from cayley.discrete.program import Assign, Carry, Newton
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import nodal, verlet
from unit.density.examples import EXAMPLES

PROGRAMS = ["step", "step_held", "kick", "observe"]


def equations(name="rod", rule=verlet, **options):
    return derive(trace(*EXAMPLES[name]), rule, **options)


@pytest.mark.parametrize("form", REPRESENTATIONS)
@pytest.mark.parametrize("name", EXAMPLES)
def test_layout(name, form):
    """Rows and degrees of freedom of the fields follow one another without gap."""
    fields = EXAMPLES[name].lagrangian.fields
    layout = Layout(fields, REPRESENTATIONS[form])
    rows = [i for field in fields for i in range(layout.rows)[layout.rows_of(field)]]
    dofs = [i for field in fields for i in range(layout.dofs)[layout.dofs_of(field)]]
    assert rows == list(range(layout.rows))
    assert dofs == list(range(layout.dofs))
    assert layout.rotations == tuple(n for n, f in fields.items() if isinstance(f, cy.Rotation))
    assert layout.dofs == sum(f.size for f in fields.values())
    stored = {"quaternion": 4, "matrix": 9}[form]
    assert layout.rows == layout.dofs + (stored - 3) * len(layout.rotations)
    assert len(layout.dof_names) == layout.dofs
    assert layout.dof_names[0] == f"{next(iter(fields))}[0]"


@pytest.mark.parametrize("name", ["rod", "mixed", "two_bodies"])
def test_every_row_has_one_use(name):
    found = equations(name, varying=["h"])
    rows = found.rows
    parts = [rows.values, rows.momenta, rows.carried, rows.held, *rows.observed.values()]
    used = [i for part in parts for i in range(rows.count)[part]] + list(rows.named.values())
    assert sorted(used) == list(range(rows.count))
    assert rows.values.start == 0
    assert rows.momenta.start == rows.values.stop  # frames are the first rows, values and momenta


@pytest.mark.parametrize("kernel", PROGRAMS)
@pytest.mark.parametrize("name", ["rod", "mixed", "two_bodies", "driven"])
def test_programs_use_what_is_defined(name, kernel):
    """Every symbol is an input or a target of a step before; nothing is defined twice."""
    program = equations(name).program(kernel)
    known = [s.name() for s in program.uniforms] + [s.name() for s, _, _ in program.lanes]

    def needs(values):
        assert {s.name() for s in ca.symvar(ca.vertcat(*values))} <= set(known)

    for step in program.steps:
        if isinstance(step, Assign):
            needs(step.values)
            known += [s.name() for s in step.targets]
        elif isinstance(step, Carry):
            needs(step.sources)
            known += [s.name() for s in step.targets]
        else:
            assert isinstance(step, Newton)
            needs(step.start)
            known += [s.name() for s in step.unknown]
            needs([*step.following, step.error, step.bound])
    needs([value for _, value in program.stores])
    assert len(set(known)) == len(known)
    assert program.rows == equations(name).rows.count
    assert len({row for row, _ in program.stores}) == len(program.stores)


def test_uniform_and_varying_inputs():
    found = equations(varying=["c.mass", "inverse"])
    assert found.uniforms[:3] == UNIFORMS
    assert "c.mass" not in found.uniforms
    assert "inverse" not in found.uniforms
    assert {"c.mass", "inverse"} <= set(found.rows.named)
    assert "c.inertia[0,0]" in found.uniforms
    assert "inverse" not in equations("two_bodies").uniforms


def test_signature_tells_equations_apart():
    signatures = {
        equations().signature,
        equations(rule=nodal).signature,
        equations(rotation="matrix").signature,
        equations(varying=["c.mass"]).signature,
        equations("string").signature,
    }
    assert len(signatures) == 5
    assert equations().signature == equations().signature


def test_programs_are_derived_once():
    found = equations()
    assert found.program("step") is found.program("step")
    assert found.blocks is found.blocks


def test_unknown_varying_name():
    with pytest.raises(ValueError, match=r"^varying names 'c\.weight'; inputs are h, t, t_next, inverse, c\.mass, "):
        equations(varying=["c.weight"])


def test_coupled_velocities_and_slopes():
    @cy.lagrangian(x=cy.Vector(1), s=cy.Interval)
    def coupled(q, c):
        return 0.5 * q.x_t[0] ** 2 * (1.0 + q.x_s[0] ** 2)

    with pytest.raises(ValueError, match="velocities are coupled with derivatives along s") as caught:
        derive(trace(coupled, {}), verlet)
    assert "\n" not in str(caught.value)


def test_slopes_times_velocities_of_another_field_too():
    @cy.lagrangian(x=cy.Vector(1), p=cy.Rotation(), r=cy.Interval)
    def coupled(q, c):
        return 0.5 * q.x_t[0] ** 2 + 0.5 * q.p_t @ q.p_t + q.p_t[0] * q.x_r[0]

    with pytest.raises(ValueError, match="velocities are coupled with derivatives along r"):
        derive(trace(coupled, {}), nodal)


def test_density_without_strain():
    @cy.lagrangian(x=cy.Vector(1), s=cy.Interval)
    def dust(q, c):
        return 0.5 * q.x_t[0] ** 2 - q.x[0] ** 2

    domain = cy.Interval(0.0, 1.0, elements=3)
    run = cy.integrate(cy.compile(dust, rule=verlet, domain=domain), {"x": np.ones((4, 1))}, 0.1, 0.01)
    assert run.data["x"].values[-1, :, 0] == pytest.approx(np.cos(np.sqrt(2.0) * 0.1), abs=1e-4)
