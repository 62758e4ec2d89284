"""Orders of the rules: error against step and against time for one heavy top.

The same Lagrangian under the rules of order 2, 4, 6 and 8. Halving the step makes the error 4, 16, 64 and 256 times
smaller.

Insight: where errors below 1e-4 are wanted a rule of high order is the cheaper one, for smooth motions of a few
bodies.
"""

import matplotlib.pyplot as plt
import numpy as np

import cayley as cy


@cy.lagrangian(p=cy.Rotation())
def heavy_top(q, c):
    """A body of inertia c.inertia about a fixed point, its weight acting at c.center (body frame)."""
    return 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) - c.weight * cy.dot(cy.E3, q.p.rotate(c.center))


constants = {"inertia": np.diag([15.234375, 0.46875, 15.234375]), "weight": 15.0 * 9.81, "center": np.array([0, 1, 0])}
start = {"p": (1, 0, 0, 0), "p_t": (0, 150, -4.61538)}
known = np.array([-0.70827915, 0.43878109, 0.5457284, 0.08939975])  # at 0.2 s, an independent solution of eight digits


def last(rule, steps):
    """The quaternion at 0.2 s."""
    system = cy.compile(heavy_top, rule=rule, constants=constants)
    return [cy.integrate(system, start, t_end=0.2, dt=0.2 / n, save_every=0.2).data["p"].values[-1] for n in steps]


def distance(p, q):
    """Of two rotations; p and -p are the same."""
    return min(np.linalg.norm(p - q), np.linalg.norm(p + q))


(exact,) = last(cy.rules.galerkin(time=5), [200])
assert distance(exact, known) < 2e-8

figure, axes = plt.subplots(figsize=(6.0, 3.8), layout="constrained")
rules = {"nodal": cy.rules.nodal} | {f"galerkin(time={r})": cy.rules.galerkin(time=r) for r in (1, 2, 3, 4)}
for (name, rule), mark in zip(rules.items(), "osd^v", strict=True):
    steps = {2: 800, 4: 50, 6: 20, 8: 10}[rule.order] * 2 ** np.arange(4)
    errors = np.array([distance(end, exact) for end in last(rule, steps)])
    axes.loglog(0.2 / steps, errors, f"{mark}-", label=f"{name}, order {rule.order}")
    slope = np.log2(errors[1] / errors[2])
    print(f"{name}: errors {' '.join(f'{e:.0e}' for e in errors)}, slope {slope:.2f}")
    assert abs(slope - rule.order) < 0.4
axes.set(xlabel="step [s]", ylabel="error of the quaternion at 0.2 s", title="heavy top, 4.8 turns")
axes.legend()
plt.show()
