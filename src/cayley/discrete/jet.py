"""Derivatives through a chain of small maps: the chain rule by hand keeps the code of a Hessian small.

Differentiating a composed expression sends every unknown through all of it. Where a chain has a narrow place, such as
the six strains of an element with two nodes, the first and second derivatives of each link, multiplied, are far fewer
operations.
"""

from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True, slots=True, kw_only=True)
class Jet:
    """Values c of a point and their derivatives with respect to what they are functions of, m.

    Args:
        values: c, shape (k, 1).
        slope: ∂c/∂m, shape (k, n).
        weights: λ, shape (k, 1).
        curvature: Hessian of λ·c, shape (n, n); None where it is not asked for.
    """

    values: ca.SX
    slope: ca.SX
    weights: ca.SX
    curvature: ca.SX | None

    def through(self, inner: ca.SX, unknown: ca.SX, at: ca.SX) -> "Jet":
        """The same values as functions of x, with m = inner(x).

        ∂c/∂x = ∂c/∂m ∂m/∂x,   λ·∂²c/∂x² = (∂m/∂x)ᵀ (λ·∂²c/∂m²) ∂m/∂x + Σₖ (λ·∂c/∂mₖ) ∂²mₖ/∂x²

        Args:
            inner: m, an expression in the unknown, shape (n, 1).
            unknown: symbols x, shape (l, 1).
            at: where x stands.
        """
        pull = ca.SX.sym("pull", inner.numel())
        pulled = ca.gradient(ca.dot(pull, inner), unknown)
        if self.curvature is None and self.slope.size1() == 1:  # backward, without the Jacobian of m
            row = ca.densify(self.slope.T)
            slope = ca.substitute([pulled.T], [unknown, pull], [at, row])[0]
            return Jet(values=self.values, slope=slope, weights=self.weights, curvature=None)
        weighted = ca.densify(self.slope.T @ self.weights)
        found = [ca.jacobian(inner, unknown), *([] if self.curvature is None else [ca.jacobian(pulled, unknown)])]
        found = [ca.sparsify(m) for m in ca.substitute(found, [unknown, pull], [at, weighted])]
        curvature = None if self.curvature is None else congruent(self.curvature, found[0]) + found[1]
        return Jet(values=self.values, slope=self.slope @ found[0], weights=self.weights, curvature=curvature)


def jet(values: ca.SX, unknown: ca.SX, at: ca.SX, *, weights: ca.SX, second: bool) -> Jet:
    """Values with their derivatives, by differentiation.

    Args:
        values: expressions in the unknown, shape (k, 1).
        unknown: symbols, shape (n, 1).
        at: where they stand.
        weights: λ, shape (k, 1).
        second: whether the Hessian of λ·c is wanted.
    """
    found = [values, ca.jacobian(values, unknown)]
    if second:
        found.append(ca.jacobian(ca.gradient(ca.dot(weights, values), unknown), unknown))
    found = ca.substitute(found, [unknown], [at])
    return Jet(values=found[0], slope=found[1], weights=weights, curvature=found[2] if second else None)


def congruent(matrix: ca.SX, jacobian: ca.SX) -> ca.SX:
    """Jᵀ M J of a symmetric M, every entry once and by way of the emptier of its two columns of J."""
    product = matrix @ jacobian
    columns = [jacobian[:, i].T for i in range(jacobian.size2())]
    found = ca.SX(jacobian.size2(), jacobian.size2())
    for i, one in enumerate(columns):
        for k in range(i, len(columns)):
            row, column = (i, k) if one.nnz() <= columns[k].nnz() else (k, i)
            entry = columns[row] @ product[:, column]
            if entry.nnz():
                found[i, k] = found[k, i] = entry
    return found
