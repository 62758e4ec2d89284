"""Order at steps that leave the fast modes of a rod unresolved, where the theory promises none."""

from dataclasses import dataclass

import numpy as np

import cayley as cy
from cayley.discrete.rules import Rule, galerkin
from verify.problems import slopes

ELEMENTS, SPAN, COARSEST, POINTS = 10, 1.0, 0.02, 6


@dataclass(frozen=True, slots=True)
class Convergence:
    """Error of the tip of the rubber pendulum at 1 s.

    Args:
        rule: name of the rule.
        expected: its order.
        steps: time steps [s].
        errors: largest component of the error of the tip [m]; NaN where a step was not solved.
    """

    rule: str
    expected: int
    steps: np.ndarray
    errors: np.ndarray

    @property
    def orders(self) -> np.ndarray:
        """Observed orders between successive points."""
        return slopes(self.errors)


def converge(rule: Rule) -> Convergence:
    """Run the pendulum of design at rest, horizontal, let go, with steps far above 2/ω of shear, 1.3e-4 s."""
    exact = tip(galerkin(time=4), 1e-3)
    steps = COARSEST * 0.5 ** np.arange(POINTS)
    errors = []
    for h in steps:
        try:
            errors.append(float(np.abs(tip(rule, h) - exact).max()))
        except cy.SimulationError:
            errors.append(np.nan)
    return Convergence(str(rule), rule.order, steps, np.array(errors))


def tip(rule: Rule, h: float) -> np.ndarray:
    """Position of the tip at 1 s [m]."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.5)
    section = cy.Section.circle(5e-3, rubber, shear_correction=27 / 28)
    rod = cy.Rod(section, length=1.0, direction=(1, 0, 0), normal=(0, 1, 0), elements=ELEMENTS)
    gravity = cy.loads.gravity((0.0, 0.0, -9.81))
    model = cy.Model(rod, supports=[cy.supports.pin(rod.start)], loads=[gravity])
    run = cy.simulate(model, SPAN, h, rule=rule, save_every=SPAN)
    return run.frames.values[-1, -1, run.system.layout.rows_of("x")]
