"""Cells: what their kernels are found by in the cache."""

import cayley as cy
from cayley import joints, springs
from cayley.steppers import cells
from cayley.steppers.still import Still
from cayley.system.discretize import discretize


def test_kernels_of_joints_and_springs_are_found_by_the_next_process(monkeypatch):
    """The key says nothing of this process, such as addresses of objects."""
    seen, compiled = [], cells.compiled

    def noted(program, lanes, signature):
        seen.append(signature)
        return compiled(program, lanes, signature)

    monkeypatch.setattr(cells, "compiled", noted)
    body = cy.Body(mass=2.0, inertia=[0.1, 0.1, 0.1], ports={"side": (0, 0, 1.0)})
    tie, ball = springs.linear(body.centre, cy.ground.at((1, 0, 0)), stiffness=1.0), joints.ball(body.port("side"))
    system = discretize(cy.Model(body, springs=[tie], joints=[ball]), cy.rules.midpoint)
    Still.at(system, system.reference)
    assert len(seen) >= 4
    assert set(seen) == {"{'p': Rotation(), 'x': Vector(size=3)} quaternion"}
