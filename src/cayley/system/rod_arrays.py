"""A rod as arrays over its nodes: coordinates, constants of nodes and of elements, and where it is at the start."""

from dataclasses import dataclass

import numpy as np

from cayley.discrete.places import name_at
from cayley.discrete.rules import Rule, lagrange, lobatto, lobatto_weights
from cayley.model import Rod, Section
from cayley.model.samples import basis
from cayley.system.compile import chain_arrays, chain_nodes
from cayley.system.reference import reference_strain

CONSTRAINED = {"shearable": 0, "unshearable": 2, "inextensible": 3}
"""How many of the six strains each kinematics constrains, the first ones."""
STRAIN_CONSTANTS = ("stiffness", "reference")
"""Constants of the strain terms, which belong to an element and its strain points; the others belong to a node."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PartArrays:
    """One chain of nodes, or one node alone, as a system has it.

    Constants of inertia are those of a node; constants of strain (stiffness, reference) those of the element at its
    right, which the last node, without one, repeats: what is equal everywhere then stays so. Of elements with several
    strain points they are those of point 0, and NAME@k those of point k; for cells of several nodes NAME@k is, at the
    first, the constant of node k (see discrete.places). NAME@k may be left out where it is the same as NAME.

    Args:
        named: weight, 1/weight, length, here and inverse of every node, shape (nodes,) each (see System).
        constants: constants of the density by name, shape (nodes, *shape of the constant) each. All parts of a model
            have the same plain names; a node alone, without elements, repeats any constants of strain.
        position: at the start [m], shape (nodes, 3).
        rotation: at the start, unit quaternions, shape (nodes, 4).
    """

    named: dict[str, np.ndarray]
    constants: dict[str, np.ndarray]
    position: np.ndarray
    rotation: np.ndarray

    @property
    def size(self) -> int:
        """Number of nodes."""
        return len(self.position)


def rod_arrays(rod: Rod, rule: Rule, gravity: np.ndarray) -> PartArrays:
    """The arrays of a rod.

    Args:
        rod: the rod.
        rule: quadrature rule: its degree puts more nodes into every element.
        gravity: acceleration g [m/s²], shape (3,).

    Returns: its PartArrays; constants are mass (), inertia (3, 3), first_moment (3,), gravity (3,), stiffness (6 or
    fewer, square) and reference (6,), also as NAME@k where they may differ within an element.
    """
    coordinates = chain_nodes(np.asarray(rod.nodes), rule.degree)
    named = chain_arrays(coordinates, rule.degree)
    inverse = np.repeat(1.0 / rod.element_lengths, rule.degree)
    position, rotation = rod.reference(lobatto(rule.degree))
    if rod.shape is None:
        position = np.array(rod.origin) + np.outer(coordinates, rod.direction)
    constants = _inertias(rod, rule, named["weight"]) | {"gravity": _everywhere(gravity, len(coordinates))}
    return PartArrays(
        named=named | {"inverse": np.append(inverse, inverse[-1])},
        constants=constants | _stiffnesses(rod, rule) | _references(rod, rule, position, rotation),
        position=rod.stretch(position),
        rotation=rotation,
    )


def _inertias(rod: Rod, rule: Rule, weight: np.ndarray) -> dict[str, np.ndarray]:
    """Mass, inertia and first moment per length at every node, what its elements lump there divided by its weight.

    Degree 1: ∫ m φ ds with the hat function φ of the node, which keeps the mass and its first moment along the rod.
    Above: Σ Lobatto weight × m(node), of the order of the rule.
    """
    names = {"mass": "mass_per_length", "inertia": "inertia", "first_moment": "first_moment"}
    section = rod.stations
    if isinstance(section, Section):
        return {name: _everywhere(getattr(section, own), len(weight)) for name, own in names.items()}
    degree, shares = rule.degree, _shares(rule.degree, section.count)
    found = {}
    for name, own in names.items():
        samples = section.samples(own)
        lumped = np.einsum("e,ak,ek...->ea...", rod.element_lengths, shares, samples)
        total = np.zeros((len(weight), *lumped.shape[2:]))
        for a in range(degree + 1):
            total[a : len(weight) - degree + a : degree] += lumped[:, a]
        found[name] = total / weight.reshape(-1, *[1] * (total.ndim - 1))
    last = len(weight) - 1
    for k in range(1, rule.cell):
        inner = np.minimum(np.arange(len(weight)) + k, last)
        found |= {name_at(name, k): found[name][inner] for name in names}
    return found


def _shares(degree: int, stations: int) -> np.ndarray:
    """What each node of an element gets of each station, per unit of its length, shape (degree + 1, stations)."""
    if degree > 1:
        return lobatto_weights(degree)[:, None] * basis(stations, lobatto(degree))
    at, weights = np.polynomial.legendre.leggauss(stations // 2 + 1)  # exact for the stations' polynomials times φ
    hats, _ = lagrange(lobatto(1), 0.5 + 0.5 * at)
    shares: np.ndarray = np.einsum("g,ga,gk->ak", 0.5 * weights, hats, basis(stations, 0.5 + 0.5 * at))
    return shares


def _stiffnesses(rod: Rod, rule: Rule) -> dict[str, np.ndarray]:
    """Stiffness of what is not constrained, at every strain point; a rule of corners takes that of the middle."""
    first = CONSTRAINED[rod.kinematics]
    section = rod.stations
    if rod.residual_bending and rule.degree > 1:
        raise ValueError(
            f"{rod.label} has residual_bending, but elements of degree {rule.degree} ({rule}) bend themselves; leave "
            "it out"
        )
    if isinstance(section, Section) and rod.residual_bending:
        return {"stiffness": _at_first_nodes(_with_bending(np.asarray(section.stiffness), rod.element_lengths), 1)}
    if isinstance(section, Section):
        own = np.asarray(section.stiffness)[first:, first:]
        return {"stiffness": _everywhere(own, rod.elements * rule.degree + 1)}
    places = (0.5,) if rule.strain.between_ends else rule.strain.at
    found = section.at("stiffness", np.array(places))[..., first:, first:]
    if rod.residual_bending:
        found = np.stack([_with_bending(found[:, g], rod.element_lengths) for g in range(len(places))], axis=1)
    return {name_at("stiffness", g): _at_first_nodes(found[:, g], rule.degree) for g in range(len(places))}


def _with_bending(stiffness: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Stiffness of elements whose shear has the residual bending flexibility, shape (elements, 6, 6).

    Between its ends a beam with shear forces N bends by M = s e3 × N about the middle: per length the compliance
    F_ΓΓ + ds²/12 Kᵀ F_ΩΩ K, K = e3 ×.

    Args:
        stiffness: of a section, shape (6, 6), or of those of all elements.
        lengths: ds [m], shape (elements,).

    Source: MacNeal (1978), A simple quadrilateral shell element, on residual bending flexibility.
    """
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    compliance = np.broadcast_to(np.linalg.inv(stiffness), (len(lengths), 6, 6)).copy()
    bent = turn.T @ compliance[:, 3:, 3:] @ turn
    compliance[:, :3, :3] += lengths[:, None, None] ** 2 / 12.0 * bent
    found: np.ndarray = np.linalg.inv(compliance)
    return found


def _references(rod: Rod, rule: Rule, position: np.ndarray, rotation: np.ndarray) -> dict[str, np.ndarray]:
    """The strain without stress as the rule measures it, at every strain point."""
    if rod.shape is None:
        return {"reference": np.zeros((rod.elements * rule.degree + 1, 6))}
    found = reference_strain(rule, position, rotation, rod.element_lengths)
    return {name_at("reference", g): _at_first_nodes(found[:, g], rule.degree) for g in range(found.shape[1])}


def _at_first_nodes(values: np.ndarray, degree: int) -> np.ndarray:
    """Values of elements at all their nodes but the last, which the end of the chain repeats."""
    return np.concatenate([np.repeat(values, degree, axis=0), values[-1:]])


def _everywhere(value: object, count: int) -> np.ndarray:
    """The same value at every node, shape (nodes, *shape)."""
    array = np.asarray(value, dtype=float)
    return np.broadcast_to(array, (count, *array.shape)).copy()
