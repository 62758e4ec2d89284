"""From any Lagrangian and numbers to a compiled system."""

import difflib
from collections.abc import Iterable, Mapping
from typing import Any

import casadi as ca
import numpy as np

from cayley.codegen.kernels import Kernels, lanes_for
from cayley.density import Interval, Lagrangian, trace
from cayley.density.trace import Density
from cayley.discrete.equations import DiscreteEquations, derive
from cayley.discrete.layout import Layout
from cayley.discrete.node import mass_matrix
from cayley.discrete.rules import Rule, lobatto, lobatto_weights
from cayley.system.system import System


def compile_lagrangian(
    lagrangian: Lagrangian,
    *,
    rule: Rule,
    domain: Interval | None = None,
    constants: Mapping[str, Any] | None = None,
    held: Mapping[str, Any] | None = None,
    rotation: str = "quaternion",
) -> System:
    """Derive the discrete equations of a Lagrangian and compile them.

    μ_aʲ + Σ D_(a,j) L_d = 0 -> qʲ⁺¹,   μ_aʲ⁺¹ = Σ D_(a,j+1) L_d

    Args:
        lagrangian: made with ``@cy.lagrangian``.
        rule: quadrature rule, such as ``cy.rules.verlet``.
        domain: the interval and its elements; just for a Lagrangian density.
        constants: numbers, vectors and matrices by the names the Lagrangian uses.
        held: field -> nodes at which it keeps its value: "start", "end", node numbers, or several of them.
        rotation: "quaternion" or "matrix".

    Returns: the compiled System.

    Raises:
        ValueError: if anything does not fit; the message names the culprit and what would be right.

    Source: Leitz, Ober-Blöbaum, Leyendecker (2014), sections 4 and 5.
    """
    where = _checked(lagrangian, rule, domain)
    density = trace(lagrangian, constants or {})
    equations = derive(density, rule, rotation=rotation)
    if domain is None:
        count, length, coordinates = 1, 1.0, np.zeros(1)
    else:
        ends = np.linspace(domain.start, domain.stop, domain.elements + 1)
        length, coordinates = (domain.stop - domain.start) / domain.elements, chain_nodes(ends, rule.degree)
        count = len(coordinates)
    reference = straight(equations.layout, coordinates)
    check_inertia(density, equations.layout, reference[0], where)
    free = _free(lagrangian, equations.layout, held or {}, count, where)
    named = {"weight": np.ones(1), "1/weight": np.ones(1)}
    if domain is not None:
        named = chain_arrays(coordinates, rule.degree)
    uniforms = uniform_values(equations, {"inverse": 1.0 / length})
    return System(
        equations=equations,
        kernels=Kernels(equations, lanes_for(rule.cell, (count - 1) // rule.cell + 1)),
        uniforms=uniforms,
        named=named,
        free=free,
        chains=(count,),
        reference=reference,
    )


def chain_nodes(ends: np.ndarray, degree: int) -> np.ndarray:
    """Nodes of a chain of elements: their ends, and the Lobatto points inside them for a degree above 1.

    Args:
        ends: coordinates of the ends of the elements [m], shape (elements + 1,).
        degree: degree of the polynomials along an element.

    Returns: coordinates [m], shape (elements × degree + 1,).
    """
    inner = ends[:-1, None] + np.diff(ends)[:, None] * lobatto(degree)[None, :-1]
    return np.append(inner.reshape(-1), ends[-1])


def chain_arrays(coordinates: np.ndarray, degree: int = 1) -> dict[str, np.ndarray]:
    """Weights of the nodes (Lobatto quadrature) and lengths between them, of one chain, shape (nodes,) each."""
    lengths = np.diff(coordinates)
    weight = np.zeros(len(coordinates))
    shares = lobatto_weights(degree)
    for k, share in enumerate(shares):
        last = len(coordinates) - 1 - degree + k
        weight[k : last + 1 : degree] += share * lengths.reshape(-1, degree).sum(axis=1)
    return {"weight": weight, "1/weight": 1.0 / weight, "length": np.append(lengths, 0.0), "here": coordinates}


def uniform_values(equations: DiscreteEquations, other: Mapping[str, float]) -> np.ndarray:
    """Values of the uniform inputs of equations, h and the times still zero."""
    known = dict(zip(equations.density.names, equations.density.values, strict=True)) | dict(other)
    return np.array([known.get(name, 0.0) for name in equations.uniforms])


def straight(layout: Layout, coordinates: np.ndarray) -> np.ndarray:
    """A regular reference: rotations 1, vectors along their last axis at x = s, shape (nodes, rows)."""
    values = np.zeros((len(coordinates), layout.rows))
    for name in layout.fields:
        rows = layout.rows_of(name)
        if name in layout.rotations:
            values[:, rows] = layout.representation.from_quaternion(np.array([1.0, 0.0, 0.0, 0.0]))
        else:
            values[:, rows.stop - 1] = coordinates
    return values


def check_inertia(density: Density, layout: Layout, node: np.ndarray, where: str) -> None:
    """Refuse a singular mass matrix, naming the field.

    Raises:
        ValueError: if some velocity carries no inertia, or the mass matrix is not positive definite.
    """
    point: dict[str, Any] = {}
    for name in layout.fields:
        rows = node[layout.rows_of(name)]
        point[f"frame of {name}" if name in layout.rotations else name] = (
            np.asarray(layout.representation.matrix(rows), dtype=float) if name in layout.rotations else rows
        )
    matrix = mass_matrix(density, layout, point)
    numbers = np.array(ca.Function("mass", [density.parameters], [ca.densify(matrix)])(density.values))
    diagonal = np.diag(numbers)
    for k, name in enumerate(layout.dof_names):
        if not diagonal[k] > 0.0:
            field = name.split("[")[0]
            said = "no inertia" if not np.any(numbers[k]) else f"inertia {diagonal[k]:.3g}"
            raise ValueError(
                f"{where}: the mass matrix is singular, {name} has {said}; L must contain a positive kinetic energy in "
                f"every component of q.{field}_t"
            )
    scaled = numbers / np.sqrt(np.outer(diagonal, diagonal))
    values, vectors = np.linalg.eigh(0.5 * (scaled + scaled.T))
    if values[0] < 1e-12:
        worst = layout.dof_names[int(np.argmax(np.abs(vectors[:, 0])))]
        raise ValueError(f"{where}: the mass matrix is not positive definite (at rest), mostly in {worst}")


def _checked(lagrangian: Any, rule: Any, domain: Any) -> str:
    if not isinstance(lagrangian, Lagrangian):
        raise TypeError(f"compile: {lagrangian!r} is no Lagrangian; decorate the function with @cy.lagrangian(...)")
    where = f"Lagrangian {lagrangian.name}"
    if not isinstance(rule, Rule):
        raise TypeError(f"{where}: rule is {rule!r}; give one of cy.rules, such as cy.rules.verlet")
    if lagrangian.interval is None and domain is not None:
        raise ValueError(f"{where} has no interval, but a domain is given; leave it out or declare s=cy.Interval")
    if lagrangian.interval is None and rule.degree > 1:
        raise ValueError(
            f"{where} has no interval, but the rule {rule} is one for elements; leave out space={rule.degree}"
        )
    if lagrangian.interval is not None and not isinstance(domain, Interval):
        raise ValueError(f"{where} is a density on an interval; give domain=cy.Interval(start, stop, elements=n)")
    return where


def _free(lagrangian: Lagrangian, layout: Layout, held: Mapping[str, Any], count: int, where: str) -> np.ndarray:
    free = np.ones((count, layout.dofs), dtype=bool)
    for name, places in held.items():
        if name not in lagrangian.fields:
            near = difflib.get_close_matches(name, list(lagrangian.fields), n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise ValueError(f"{where}: held names {name!r}; its fields are {', '.join(lagrangian.fields)}{hint}")
        several = places if isinstance(places, Iterable) and not isinstance(places, str) else (places,)
        for place in several:
            free[_node(place, count, f"{where}: held[{name!r}]"), layout.dofs_of(name)] = False
    return free


def _node(place: Any, count: int, where: str) -> int:
    if place == "start":
        return 0
    if place == "end":
        return count - 1
    if isinstance(place, int | np.integer) and -count <= place < count:
        return int(place) % count
    raise ValueError(f"{where} has {place!r}; give 'start', 'end' or a node number from 0 to {count - 1}")
