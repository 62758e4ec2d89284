"""The derivative of constraints, from their kernel, against finite differences."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import rules
from cayley.lie import quaternion
from cayley.steppers.constrained_run import make_plan, violation
from cayley.system.discretize import discretize
from cayley.system.system import State, gather, pack
from unit.system.rods import round_rod


@pytest.mark.parametrize("rule", [rules.verlet, rules.screw], ids=str)
@pytest.mark.parametrize(("kinematics", "count"), [("unshearable", 2), ("inextensible", 3)])
def test_derivative(rule, kinematics, count):
    """G, left and right, along every degree of freedom: δp = ½ p η, δx."""
    system = discretize(cy.Model(round_rod(5, kinematics=kinematics)), rule)
    rng = np.random.default_rng(3)
    values = system.reference + rng.normal(scale=0.05, size=system.reference.shape)
    values[:, :4] /= np.linalg.norm(values[:, :4], axis=1, keepdims=True)
    data = pack(system, State(values=values, momenta=np.zeros((6, 6))))
    system.kernels["schur"](data, make_plan(system).uniforms[3], 1, data.shape[0] - 1)
    rows = system.equations.rows.constraint
    sides = [gather(data[1:-1], rows[name], 6).reshape(6, count, 6) for name in ("left", "right")]

    def moved(node: int, dof: int, step: float) -> np.ndarray:
        found = values.copy()
        if dof < 3:
            turn = np.append(1.0, 0.5 * step * np.eye(3)[dof])
            found[node, :4] = quaternion.multiply(values[node, :4], turn / np.linalg.norm(turn))
        else:
            found[node, 1 + dof] += step
        return violation(system, found)

    for node in range(6):
        for dof in range(6):
            slope = (moved(node, dof, 1e-5) - moved(node, dof, -1e-5)) / 2e-5
            expected = np.zeros_like(slope)
            expected[node] += sides[0][node, :, dof]
            if node:
                expected[node - 1] += sides[1][node - 1, :, dof]
            assert_allclose(slope, expected, atol=2e-8)
