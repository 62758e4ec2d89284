"""Motions that nothing resists: found as null vectors of the stiffness, and told in words."""

import numpy as np

from cayley.lie import quaternion
from cayley.model import Model, PointMass
from cayley.statics.newton import CLEAR
from cayley.steppers.still import Still
from cayley.system.discretize import spans

MOST = 12
"""Most motions looked for: two parts that are free have as many."""
ROUNDS = 3
"""Steps of inverse iteration; each leaves 1e-6 or less of a motion that is 1000 times stiffer than rounding."""
RESTING = 0.05
"""Part of the largest motion below which a part of the model is at rest."""


def free_motions(still: Still, inertia: float) -> np.ndarray:
    """Motions without stiffness at an equilibrium, orthonormal in the mass norm, shape (k, unknowns).

    The smallest singular values of K, seen in the mass norm, by inverse iteration of a few vectors on K + σM. Not its
    eigenvalues: a motion that loads drive, or that lowers the energy, has stiffness, too.

    Args:
        still: the system.
        inertia: σ [1/s²], about the rounding error of K.
    """
    mass, free = -still.matrix(2), still.free
    count = min(MOST, len(free))
    stiffness = -still.matrix(0)
    _, regular = still.tangent(inertia=inertia)
    if not regular or not count:
        return np.zeros((0, len(still.force())))
    x = np.zeros((count, mass.shape[0]))
    x[:, free] = np.random.default_rng(1).standard_normal((count, len(free)))
    for _ in range(ROUNDS):
        x = np.array([-still.solve(mass @ row) for row in x])
        x[:, still.spots] = 0.0
        x = _orthonormal(x, x @ (mass @ x.T))
    _, values, rows = np.linalg.svd(x @ (stiffness @ x.T))
    return rows[values < CLEAR * inertia] @ x


def tell(still: Still, model: Model, motions: np.ndarray) -> list[str]:
    """Motions in words, simplified by rotation among themselves: "bob turns about (0, 0, 1) through (1, 0, 2)"."""
    return [_describe(still, model, motion) for motion in simplified(motions)]


def _orthonormal(x: np.ndarray, gram: np.ndarray) -> np.ndarray:
    values, vectors = np.linalg.eigh(gram)
    good = values > 1e-13 * values[-1]
    return (vectors[:, good] / np.sqrt(values[good])).T @ x


def simplified(motions: np.ndarray) -> np.ndarray:
    """The same space, spanned by vectors with many zeros: reduced row echelon form with the largest pivots."""
    x = motions.copy()
    for k in range(len(x)):
        row, column = np.unravel_index(np.argmax(np.abs(x[k:])), x[k:].shape)
        x[k : k + row + 1] = np.roll(x[k : k + row + 1], 1, axis=0)
        x[k] /= x[k, column]
        others = np.arange(len(x)) != k
        x[others] -= np.outer(x[others, column], x[k])
    return x


def _describe(still: Still, model: Model, motion: np.ndarray) -> str:
    layout, moves = still.system.layout, motion[still.dofs]
    values, degree = still.values, still.system.equations.rule.degree
    rates = np.asarray(quaternion.rotate(values[:, layout.rows_of("p")], moves[:, layout.dofs_of("p")]), dtype=float)
    places, shifts = values[:, layout.rows_of("x")], moves[:, layout.dofs_of("x")]
    told, largest = [], np.abs(moves).max()
    for part, name, nodes in zip(model.parts, model.names, spans(model, degree), strict=True):
        if np.abs(moves[nodes]).max() < RESTING * largest:
            continue
        turn = np.zeros((nodes.stop - nodes.start, 3)) if isinstance(part, PointMass) else rates[nodes]
        told.append((name, _twist(places[nodes], shifts[nodes], turn)))
    words = dict.fromkeys(text for _, text in told)
    return "; ".join(f"{', '.join(n for n, text in told if text == word)} {word}" for word in words)


def _twist(places: np.ndarray, shifts: np.ndarray, turns: np.ndarray) -> str:
    """What motion some nodes make: a shift, a turn about an axis, or another one."""
    turn = turns.mean(axis=0)
    middle, shift = places.mean(axis=0), shifts.mean(axis=0)
    size = max(np.abs(turns).max(), np.abs(shifts).max())
    rigid = np.abs(turns - turn).max() < 1e-3 * size
    rigid &= np.abs(shifts - shift - np.cross(turn, places - middle)).max() < 1e-3 * size
    if not rigid:
        return "deforms without resistance"
    rate = float(np.linalg.norm(turn))
    if rate < 1e-3 * np.linalg.norm(shift):
        return f"moves along {_axis(shift)}"
    axis = turn / rate
    through = middle + np.cross(axis, shift) / rate
    return f"turns about {_axis(turn)} through ({', '.join(f'{c:.4g}' for c in np.round(through, 9) + 0.0)})"


def _axis(v: np.ndarray) -> str:
    unit = v / np.linalg.norm(v)
    unit = unit * np.sign(unit[np.argmax(np.abs(unit))])
    return f"({', '.join(f'{c:.3g}' for c in np.round(unit, 6) + 0.0)})"
