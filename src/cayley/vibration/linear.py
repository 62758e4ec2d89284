"""The equations of motion linearized about an equilibrium: M, C, G, K and constraints, as sparse matrices."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import block_array, csc_array
from scipy.sparse.linalg import SuperLU, splu

from cayley.discrete.rules import Rule
from cayley.model import Model
from cayley.statics import Equilibrium, equilibrium
from cayley.system.discretize import spans

ASYMMETRY = 1e-12
"""Entries of this part of the largest one are rounding errors: of symmetry, and of zero."""
PIVOT = 0.1
"""A diagonal entry serves as pivot if it has this part of the largest in its column: less fill, errors no larger."""
KINDS = {"x": ("x", "y", "z"), "p": ("turn about d1", "turn about d2", "turn about d3")}
"""Degrees of freedom of a node in words: displacement in space, small rotation about its own axes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Linear:
    """Small motions v about an equilibrium, held degrees of freedom left out.

    M v̈ + (C + G) v̇ + K v + Aᵀ λ = f,   A v = 0

    Args:
        about: the equilibrium.
        mass: M, symmetric [kg, kg m, kg m²].
        damping: C, the symmetric part of what multiplies velocities; in a turning frame also of damping.
        gyroscopic: G = −Gᵀ, of Coriolis forces in a frame that turns and of forces that are no damping.
        stiffness: K, with geometric stiffness and centrifugal terms; symmetric where loads are conservative.
        constraint: A, derivatives of joints and of constraints of rods, shape (constraints, n).
        dofs: of each row node, degree of freedom of the node, shape (n, 2).
        order: rows of (v, λ) in an order in which elimination leaves few entries.
    """

    about: Equilibrium
    mass: csc_array
    damping: csc_array
    gyroscopic: csc_array
    stiffness: csc_array
    constraint: csc_array
    dofs: np.ndarray
    order: np.ndarray

    @classmethod
    def of(cls, about: Equilibrium) -> "Linear":
        """Of an equilibrium."""
        still = about.still
        free, spots = still.free, still.spots
        all_forces, rates, accelerations = (still.matrix(k) for k in range(3))
        velocity = -rates[free][:, free]
        stiffness, constraint = -all_forces[free][:, free], all_forces[spots][:, free]
        symmetric, skew = 0.5 * (velocity + velocity.T), 0.5 * (velocity - velocity.T)
        return cls(
            about=about,
            mass=_clean(-accelerations[free][:, free]),
            damping=_clean(symmetric, velocity),
            gyroscopic=_clean(skew, velocity),
            stiffness=csc_array(stiffness),
            constraint=csc_array(constraint),
            dofs=np.argwhere(still.system.free),
            order=np.argsort(np.concatenate([free, spots])),
        )

    @property
    def size(self) -> int:
        """Number of degrees of freedom that are not held."""
        return self.mass.shape[0]

    @property
    def motions(self) -> int:
        """Number of independent motions: degrees of freedom less constraints."""
        return self.size - self.constraint.shape[0]

    @property
    def rates(self) -> csc_array:
        """C + G."""
        return self.damping + self.gyroscopic

    @property
    def conservative(self) -> bool:
        """Whether there is neither C nor G, and K is symmetric: modes are real then."""
        skew = self.stiffness - self.stiffness.T
        return not self.rates.nnz and _largest(skew) <= ASYMMETRY * _largest(self.stiffness)

    def factorized(self, s: complex) -> "Factors":
        """s² M + s (C + G) + K with the constraints beside it, factorized.

        Raises:
            RuntimeError: if it is singular: s is an eigenvalue.
        """
        dynamic = s * s * self.mass + self.stiffness + (s * self.rates if self.rates.nnz else 0.0 * self.mass)
        return Factors(self, dynamic)

    def spread(self, v: np.ndarray) -> np.ndarray:
        """Values of all degrees of freedom, held ones zero: shape (n, ...) to (nodes, dofs of a node, ...)."""
        system = self.about.system
        found = np.zeros((system.size, system.layout.dofs, *v.shape[1:]), dtype=v.dtype)
        found[self.dofs[:, 0], self.dofs[:, 1]] = v
        return found

    def table(self) -> np.ndarray:
        """What each row is: a structured array with part, node of the part, and degree of freedom in words."""
        model, system = self.about.model, self.about.system
        layout, degree = system.layout, system.equations.rule.degree
        words = np.array([word for name in layout.fields for word in KINDS[name]])
        among = spans(model, degree)
        part = np.repeat(np.arange(len(among)), [s.stop - s.start for s in among])
        starts = np.array([s.start for s in among])
        node, dof = self.dofs.T
        columns = np.array(model.names)[part[node]], node - starts[part[node]], words[dof]
        kinds = [("part", columns[0].dtype), ("node", np.int64), ("dof", words.dtype)]
        found = np.empty(self.size, dtype=kinds)
        found["part"], found["node"], found["dof"] = columns
        return found


class Factors:
    """A dynamic stiffness with the borders of constraints, factorized for many right-hand sides."""

    def __init__(self, linear: Linear, dynamic: csc_array) -> None:
        """Factorize.

        Args:
            linear: whose constraints and order.
            dynamic: real or complex, shape (n, n).
        """
        a = linear.constraint
        bordered = dynamic if not a.shape[0] else block_array([[dynamic, a.T], [a, None]])
        ordered = csc_array(bordered)[linear.order][:, linear.order]
        self.linear, self.kind = linear, ordered.dtype
        self.factors: SuperLU = splu(csc_array(ordered), permc_spec="NATURAL", diag_pivot_thresh=PIVOT)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution v, A v = 0, for right-hand sides in the columns, shape (n, k) or (n,)."""
        linear = self.linear
        shape = (len(linear.order), *right.shape[1:])
        padded = np.zeros(shape, dtype=np.result_type(right, self.kind))
        padded[: linear.size] = right
        found = np.empty_like(padded)
        found[linear.order] = self.factors.solve(padded[linear.order])
        return found[: linear.size]


def find_equilibrium(model: Model, about: Any, spin: Any = None) -> Equilibrium:
    """The equilibrium meant by what is given as ``about``.

    Args:
        model: the model.
        about: an Equilibrium of it, which is taken as it is; an Equilibrium of another model with the same parts, a
            Trajectory or State, from which one is searched; None: from the reference.
        spin: of the turning frame, where none was given with an Equilibrium [rad/s].

    Raises:
        TypeError: if the model is none.
        ValueError: if about does not fit, or comes with another spin.
        EquilibriumError: if there is no equilibrium near.
    """
    if not isinstance(model, Model):
        raise TypeError(f"modes: {model!r} is no Model; make one with cy.Model(...)")
    if not isinstance(about, Equilibrium):
        return equilibrium(model, start=about, spin=spin)
    if spin is not None:
        raise ValueError("modes: spin and an equilibrium are given; give spin to cy.equilibrium, about=... has it")
    if about.model is model:
        return about
    rule: Rule = about.system.equations.rule
    return equilibrium(model, start=about, time=about.time, spin=about.still.spin, rule=rule)


def _clean(matrix: csc_array, beside: csc_array | None = None) -> csc_array:
    """The matrix without entries that are rounding errors of the larger one beside it."""
    found = csc_array(matrix)
    found.data[np.abs(found.data) <= ASYMMETRY * _largest(matrix if beside is None else beside)] = 0.0
    found.eliminate_zeros()
    return found


def _largest(matrix: csc_array) -> float:
    return float(np.abs(matrix.data).max(initial=0.0))
