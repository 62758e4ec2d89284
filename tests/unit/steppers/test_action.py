"""Steps are stationary points of the discrete action, written here in plain NumPy with the user's own function."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cayley as cy
from cayley.lie import quaternion
from unit.density.evaluation import Turn, slopes, turned, unit_quaternions, value_of
from unit.density.examples import EXAMPLES, STRAIN

H, ELEMENTS, LENGTH, TIME = 0.01, 3, 1.5, 0.3


class Action:
    """L_d(qʲ, qʲ⁺¹) of a chain of nodes (or of one), for fields given as dictionaries of arrays."""

    def __init__(self, name: str, rule: cy.rules.Rule) -> None:
        self.lagrangian, self.constants = EXAMPLES[name]
        self.rule, self.along = rule, self.lagrangian.interval
        self.s = np.zeros(1) if self.along is None else np.linspace(0.0, LENGTH, ELEMENTS + 1)
        self.ds = LENGTH / ELEMENTS
        self.weights = np.ones(1) if self.along is None else np.array([0.5, 1.0, 1.0, 0.5]) * self.ds
        self.turns = [n for n, f in self.lagrangian.fields.items() if isinstance(f, cy.Rotation)]

    def lagrangian_at(self, values, time, s, velocity=None, slope=None):
        sizes = {k: f.size for k, f in self.lagrangian.fields.items()}
        point = values | {f"{k}_t": np.zeros(n) for k, n in sizes.items()} | {"t": time}
        if self.along is not None:
            point |= {f"{k}_{self.along}": np.full(n, 0.1) for k, n in sizes.items()} | {self.along: s}
        return value_of(self.lagrangian, point | (velocity or {}) | (slope or {}), self.constants)

    def strain(self, values, time, s, slope):
        values = {k: Turn(v) if k in self.turns else v for k, v in values.items()}
        point = SimpleNamespace(**values, **slope, **{self.along: s}, t=time)
        return STRAIN[self.lagrangian.name](point, SimpleNamespace(**(self.lagrangian.defaults | self.constants)))

    def kinetic(self, before, after, time):
        velocity = {}
        for name, a in before.items():
            r = (
                quaternion.multiply(quaternion.conjugate(a), after[name])[:, 1:] * 2.0
                if name in self.turns
                else after[name] - a
            )
            velocity[name] = r / H
        total = 0.0
        for k, (weight, s) in enumerate(zip(self.weights, self.s, strict=True)):
            v = {f"{n}_t": rate[k] for n, rate in velocity.items()}
            for q, t in ((before, time), (after, time + H)):
                here = {n: value[k] for n, value in q.items()}
                total += 0.5 * weight * (self.lagrangian_at(here, t, s, v) - self.lagrangian_at(here, t, s))
        return total

    def potential(self, q, time):
        total = 0.0
        for k, (weight, s) in enumerate(zip(self.weights, self.s, strict=True)):
            here = {n: value[k] for n, value in q.items()}
            total -= weight * self.lagrangian_at(here, time, s)
            if self.along is not None:
                slope = {f"{n}_{self.along}": np.full(f.size, 0.1) for n, f in self.lagrangian.fields.items()}
                total -= weight * self.strain(here, time, s, slope)
        if self.along is not None:
            total += sum(self.ds * self.element(q, k, time) for k in range(ELEMENTS))
        return total

    def element(self, q, k, time):
        corners = self.rule.strain.corners
        slope, middle = {}, {}
        for name, value in q.items():
            a, b = value[k], value[k + 1]
            if name in self.turns:
                r = quaternion.multiply(quaternion.conjugate(a), b)
                slope[f"{name}_s"] = (2.0 if corners else 4.0 / (1.0 + r[0])) * r[1:] / self.ds
                middle[name] = (a + b) / np.linalg.norm(a + b)
            else:
                slope[f"{name}_s"], middle[name] = (b - a) / self.ds, 0.5 * (a + b)
        if not corners:
            return self.strain(middle, time, 0.5 * (self.s[k] + self.s[k + 1]), slope)
        ends = [{n: value[i] for n, value in q.items()} for i in (k, k + 1)]
        return sum(0.5 * self.strain(end, time, s, slope) for end, s in zip(ends, self.s[k : k + 2], strict=True))

    def __call__(self, before, after, time):
        potential = self.potential(before, time) + self.potential(after, time + H)
        return H * self.kinetic(before, after, time) - 0.5 * H * potential

    def moved(self, q, by):
        """All nodes moved, rotations in their body frames."""
        by = by.reshape(len(self.s), -1)
        found, at = {}, 0
        for name, value in q.items():
            step = by[:, at : at + self.lagrangian.fields[name].size]
            found[name] = turned(value, step) if name in self.turns else value + step
            at += step.shape[1]
        return found


def start_of(action: Action) -> dict:
    """Smooth fields with small differences from node to node, and velocities."""
    rng = np.random.default_rng(11)
    start = {}
    for name, field in action.lagrangian.fields.items():
        nodes = len(action.s)
        if name in action.turns:
            start[name] = turned(np.tile(unit_quaternions(rng), (nodes, 1)), rng.normal(scale=0.1, size=(nodes, 3)))
        else:
            start[name] = rng.normal(size=field.size) + rng.normal(scale=0.1, size=(nodes, field.size))
            start[name][:, -1] += action.s
        start[f"{name}_t"] = rng.normal(scale=0.7, size=(nodes, field.size))
    return start


CASES = [(name, rule, "quaternion") for name in EXAMPLES for rule in (cy.rules.nodal, cy.rules.verlet)]
CASES += [(name, cy.rules.verlet, "matrix") for name in ("rod", "bent", "two_bodies", "quartic_top")]


@pytest.mark.parametrize(("name", "rule", "rotation"), CASES, ids=lambda v: str(v))
def test_discrete_euler_lagrange_equations(name, rule, rotation):
    """μ¹ = D₁ L_d(q⁰, q¹) = −D₀ L_d(q¹, q²) at every node, by central differences of the action."""
    action = Action(name, rule)
    domain = None if action.along is None else cy.Interval(0.0, LENGTH, elements=ELEMENTS)
    system = cy.compile(action.lagrangian, rule=rule, domain=domain, constants=action.constants, rotation=rotation)
    start = start_of(action)
    run = cy.integrate(system, start, TIME + 2 * H, H, save_every=H, t_start=TIME, allow_unstable=True)
    layout, frames = system.layout, run.frames
    q = []
    for values in frames.values:
        fields = {n: values[:, layout.rows_of(n)] for n in layout.fields}
        q.append({n: layout.representation.to_quaternion(v) if n in action.turns else v for n, v in fields.items()})
    for n in action.turns:  # one sheet for all: differences must not jump
        for frame in q:
            frame[n] = frame[n] * np.sign(np.sum(frame[n] * q[0][n], axis=1, keepdims=True))
    size = frames.momenta[0].size
    given = slopes(lambda by: -action(action.moved(q[0], by), q[1], TIME), size)
    after = slopes(lambda by: action(q[0], action.moved(q[1], by), TIME), size)
    before = slopes(lambda by: -action(action.moved(q[1], by), q[2], TIME + H), size)
    scale = max(1e-2, np.abs(after).max())
    assert_allclose(frames.momenta[0].reshape(-1), given, atol=2e-7 * scale)
    assert_allclose(frames.momenta[1].reshape(-1), after, atol=2e-7 * scale)
    assert_allclose(frames.momenta[1].reshape(-1), before, atol=2e-7 * scale)
    assert np.abs(frames.momenta[2] - frames.momenta[0]).max() > 1e-5 * scale
