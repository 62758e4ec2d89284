"""The derivative of constraints, from their kernel, against finite differences."""

import ctypes

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley import rules
from cayley.lie import quaternion
from cayley.steppers.problem import make_problem
from cayley.steppers.saddle import make_plan, violation
from cayley.system.discretize import discretize
from cayley.system.system import State
from unit.system.rods import round_rod


@pytest.mark.parametrize("rule", [rules.verlet, rules.screw], ids=str)
@pytest.mark.parametrize(("kinematics", "count"), [("unshearable", 2), ("inextensible", 3)])
def test_derivative(rule, kinematics, count):
    """G, left and right, along every degree of freedom: δp = ½ p η, δx."""
    system = discretize(cy.Model(round_rod(5, kinematics=kinematics)), rule)
    rng = np.random.default_rng(3)
    values = system.reference + rng.normal(scale=0.05, size=system.reference.shape)
    values[:, :4] /= np.linalg.norm(values[:, :4], axis=1, keepdims=True)
    made = make_problem(make_plan(system), State(values=values, momenta=np.zeros((6, 6)), h=1.0), 1, 1)
    zero = ctypes.c_int64(0)
    made.engine.saddle_point(ctypes.byref(made.struct), zero, zero, ctypes.c_double(0.0))
    slopes = np.moveaxis(made.couplings[0]["slopes"], -1, 1).reshape(-1, count, 2, 6)[:5]

    def moved(node: int, dof: int, step: float) -> np.ndarray:
        found = values.copy()
        if dof < 3:
            turn = np.append(1.0, 0.5 * step * np.eye(3)[dof])
            found[node, :4] = quaternion.multiply(values[node, :4], turn / np.linalg.norm(turn))
        else:
            found[node, 1 + dof] += step
        return violation(system, found)[0][1]

    for node in range(6):
        for dof in range(6):
            slope = (moved(node, dof, 1e-5) - moved(node, dof, -1e-5)) / 2e-5
            expected = np.zeros_like(slope)
            if node < 5:
                expected[node] += slopes[node, :, 0, dof]
            if node:
                expected[node - 1] += slopes[node - 1, :, 1, dof]
            assert_allclose(slope, expected, atol=2e-8)
