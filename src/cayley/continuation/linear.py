"""Linear buckling: loads at which a motion has no stiffness, by the rate at which a load changes the stiffness."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array, lil_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, splu

from cayley.continuation.mode import Mode
from cayley.continuation.parameter import Scaled
from cayley.continuation.prepare import prepared
from cayley.discrete import rules
from cayley.discrete.rules import Rule
from cayley.lie import quaternion
from cayley.lie.skew import hat
from cayley.model import Model, validate
from cayley.statics import EquilibriumError
from cayley.statics.free import free_motions
from cayley.statics.newton import solve
from cayley.steppers.still import Still

DIFFERENCE = 1e-4
"""Step of λ for the rate of the forces, and size of the motion (radians, lengths over the extent) for that of the
stiffness."""
PART = 0.05
"""Most of the critical load over which it is."""
REAL = 1e-6
"""Imaginary over real part of a number that counts as real."""
SPARE = 6
"""More eigenvalues than are wanted: some belong to no motion, or to negative factors."""
SMALL = 60
"""Size below which all eigenvalues are computed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Buckling:
    """Critical factors of a load, and how the model buckles.

    Attributes:
        factors: λ at which a motion has no stiffness, rising, shape (k,).
        modes: the motions, ``buckling.modes[0][rod].displacement``.
    """

    factors: np.ndarray
    modes: tuple[Mode, ...]

    def __repr__(self) -> str:
        """The factors."""
        return f"<Buckling: factors {', '.join(f'{factor:.6g}' for factor in self.factors) or 'none'}>"


def buckling(
    model: Model,
    load: Any,
    *,
    count: int = 1,
    about: float = 0.0,
    start: Any = None,
    initial: Mapping[Any, Mapping[str, Any]] | None = None,
    time: float = 0.0,
    rule: Rule = rules.midpoint,
) -> Buckling:
    """Find the smallest factors of a load at which a model buckles, if what it does before is linear in the load.

    (K + (λ − λ₀) dK/dλ) v = 0 about the equilibrium at λ₀, dK/dλ along the equilibria through it.

    Args:
        model: rods, bodies, joints, supports and loads.
        load: what is multiplied by λ, as the parameter of cy.trace.
        count: number of factors.
        about: λ₀; the nearer to the critical load, the less it matters that what goes before is not linear.
        start: an Equilibrium, a Trajectory (its last frame) or a State to begin near; the reference without it.
        initial: positions and rotations to begin near by part, as of cy.simulate.
        time: time at which all other loads are taken [s].
        rule: says how strain is measured along an element, as in a run.

    Returns: the Buckling: as many factors above λ₀ as there are, at most count.

    Raises:
        TypeError: if the load is none.
        ValueError: if an argument does not fit.
        EquilibriumError: if there is no equilibrium at λ₀.

    Source: K. J. Bathe, Finite Element Procedures (1996), section 6.8.2.
    """
    validate.count("buckling", "count", count)
    about = validate.number("buckling", "about", about, "-")
    made = prepared("buckling", model, load, about, start=start, initial=initial, time=time, rule=rule)
    still, inertia = made.still, made.inertia
    if not solve(still, inertia=inertia).found:
        raise EquilibriumError(f"buckling: no equilibrium found at {made.scaled.name} = {about:g}; give another about")
    if not len(free_motions(still, inertia)):
        inertia = 0.0
    rate = _rate(still, made.scaled, about, inertia)
    size = still.measure(rate)[0]
    step = DIFFERENCE / size if size > 0.0 else 1.0
    factors, vectors = _pencil(still, made.scaled, about, rate, step, inertia, count)
    if len(factors) and step > PART * abs(factors[0] - about):
        step = PART * abs(factors[0] - about)
        factors, vectors = _pencil(still, made.scaled, about, rate, step, inertia, count)
    modes = tuple(Mode(model, made.parts, still, vector) for vector in vectors)
    return Buckling(factors=factors, modes=modes)


def _rate(still: Still, scaled: Scaled, about: float, inertia: float) -> np.ndarray:
    """du/dλ = −K⁻¹ df/dλ by central differences, exact for loads, which are linear in λ."""
    forces = []
    for side in (DIFFERENCE, -DIFFERENCE):
        scaled.put(still, about + side)
        forces.append(still.force())
    scaled.put(still, about)
    still.tangent(inertia=inertia)
    return still.solve(forces[1] - forces[0]) / (2.0 * DIFFERENCE)


def _pencil(
    still: Still, scaled: Scaled, about: float, rate: np.ndarray, step: float, inertia: float, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Factors above λ₀ and motions: A v = −(λ − λ₀) B v by the largest −1/(λ − λ₀) of A⁻¹ B."""
    values, multipliers = still.values, still.multipliers
    sides = []
    for side in (step, -step):
        still.put(values, multipliers)
        still.move(rate, side)
        scaled.put(still, about + side)
        sides.append(-still.matrix(0))
    still.put(values, multipliers)
    scaled.put(still, about)
    known = np.concatenate([still.free, still.spots])
    here = -still.matrix(0)
    frames = _frames(still, rate)
    slope = csr_array((sides[0] - sides[1]) / (2.0 * step) + here @ frames + frames.T @ here)[known][:, known]
    here = csr_array(here + inertia * -still.matrix(2))[known][:, known]
    scale = 1.0 / np.sqrt(np.maximum(np.abs(here).max(axis=1).toarray().ravel(), 1e-300))
    scaling = diags_array(scale)
    inverse, change = splu(csc_array(scaling @ here @ scaling)), csr_array(scaling @ slope @ scaling)
    mu, found = _largest(inverse, change, count + SPARE)
    real = (np.abs(mu.imag) <= REAL * np.abs(mu)) & (mu.real < 0.0)
    order = np.flatnonzero(real)[np.argsort(-1.0 / mu.real[real])][:count]
    vectors = np.zeros((len(order), len(still.made.arrays["unknown"])))
    vectors[:, known] = (scale[:, None] * found.real[:, order]).T
    return about - 1.0 / mu.real[order], vectors


def _frames(still: Still, rate: np.ndarray) -> csr_array:
    """X: motions are told in frames that go along with the nodes, by 1 + (λ − λ₀) X, but do not turn about their d3.

    A bar that turns then keeps its stiffness, and so does a round one that is twisted, to first order in λ.
    """
    layout, values = still.system.layout, still.values
    found = lil_array((len(rate), len(rate)))
    turns, places = layout.dofs_of("p"), layout.dofs_of("x")
    rates = rate[still.dofs[:, turns]]
    across = rates * np.array([1.0, 1.0, 0.0])
    turned = layout.representation.to_quaternion(values[:, layout.rows_of("p")])
    in_space = np.asarray(quaternion.rotate(turned, across), dtype=float)
    for node, (dofs, free) in enumerate(zip(still.dofs, still.system.free, strict=True)):
        for own, vector in ((places, in_space[node]), (turns, across[node] - rates[node])):
            if free[own].all():
                found[np.ix_(dofs[own], dofs[own])] = hat(vector)
    return csr_array(found)


def _largest(inverse: Any, change: Any, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues μ of A⁻¹ B with the least real part, and vectors."""
    size = change.shape[0]
    if size < SMALL:
        found: tuple[np.ndarray, np.ndarray] = np.linalg.eig(inverse.solve(change.toarray()))
        return found
    operator = LinearOperator((size, size), matvec=lambda x: inverse.solve(change @ x), dtype=float)
    begin = np.random.default_rng(1).standard_normal(size)
    try:
        return eigs(operator, k=count, which="SR", v0=operator.matvec(begin), maxiter=50 * size)
    except ArpackNoConvergence as error:
        return error.eigenvalues, error.eigenvectors
