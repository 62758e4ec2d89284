"""Campbell diagrams: frequencies of a model that turns steadily, over its speed."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from cayley.discrete import rules
from cayley.discrete.rules import Rule
from cayley.model import Model
from cayley.statics import equilibrium
from cayley.vibration.eigen import Pairs, eigenpairs
from cayley.vibration.linear import Linear

if TYPE_CHECKING:
    import xarray as xr

SPARE = 2
"""Modes beyond those wanted that are followed, too, so that one which comes down from above finds its curve."""


@dataclass(frozen=True, slots=True)
class Campbell:
    """Frequencies over the speed of turning, each mode followed by its shape.

    Args:
        speed: [rad/s], shape (n,).
        eigenvalue: s in the frame that turns [1/s], shape (n, modes).
        model: the model.
    """

    speed: np.ndarray
    eigenvalue: np.ndarray
    model: Model

    @property
    def frequency(self) -> "xr.DataArray":
        """Im s/2π [Hz] in the frame that turns, dims (speed, mode)."""
        return self._labeled(self.eigenvalue.imag / (2.0 * np.pi), "frequency", "Hz")

    @property
    def damping_ratio(self) -> "xr.DataArray":
        """−Re s/|s| [-], dims (speed, mode)."""
        size = np.abs(self.eigenvalue)
        return self._labeled(0.0 - self.eigenvalue.real / np.where(size > 0.0, size, 1.0), "damping ratio", "1")

    def crossings(self, order: int = 1) -> np.ndarray:
        """Speeds [rad/s] at which a mode meets the line order × Ω: a load fixed in space excites it there."""
        found = []
        for curve in (self.eigenvalue.imag - order * np.abs(self.speed)[:, None]).T:
            for k in np.flatnonzero(curve[:-1] * curve[1:] < 0.0):
                part = curve[k] / (curve[k] - curve[k + 1])
                found.append(self.speed[k] + part * (self.speed[k + 1] - self.speed[k]))
        return np.sort(np.array(found))

    def _labeled(self, values: np.ndarray, name: str, unit: str) -> "xr.DataArray":
        import xarray as xr

        coordinates = {"speed": ("speed", self.speed, {"units": "rad/s"}), "mode": np.arange(values.shape[1])}
        return xr.DataArray(values, coordinates, ("speed", "mode"), name, {"units": unit})

    def __repr__(self) -> str:
        """How many modes, over which speeds."""
        low, high = self.speed[0], self.speed[-1]
        return f"<Campbell: {self.eigenvalue.shape[1]} modes, {len(self.speed)} speeds from {low:g} to {high:g} rad/s>"


def campbell(
    model: Model, speeds: Any, count: int = 6, *, axis: Any = (0.0, 0.0, 1.0), rule: Rule = rules.midpoint
) -> Campbell:
    """Frequencies of a model at speeds of turning about an axis through the origin, in the frame that turns with it.

    At each speed the equilibrium is found from that before, and the modes about it; curves go on where shapes agree
    best, by the largest sum of |φᴴ M φ'|.

    Args:
        model: the model; what holds it turns with it.
        speeds: [rad/s], shape (n,).
        count: number of modes.
        axis: about which it turns, in space.
        rule: as for cy.equilibrium.

    Raises:
        ValueError: if an argument does not fit.
        EquilibriumError: if a speed has no equilibrium.
    """
    speed, unit = _speeds(speeds), _unit(axis)
    rest, last, rows = None, None, []
    for omega in speed:
        rest = equilibrium(model, start=rest, spin=float(omega) * unit, rule=rule)
        linear = Linear.of(rest)
        pairs = eigenpairs(linear, count + SPARE)
        order = np.arange(len(pairs.values)) if last is None else _continued(linear, last, pairs)
        last = Pairs(pairs.values[order], pairs.vectors[:, order], pairs.checked)
        rows.append(last.values[:count])
    return Campbell(speed, np.array(rows), model)


def _continued(linear: Linear, last: Pairs, pairs: Pairs) -> np.ndarray:
    """Order of pairs in which each agrees best with the one before."""
    agree = np.abs(last.vectors.conj().T @ (linear.mass @ pairs.vectors))
    return linear_sum_assignment(agree, maximize=True)[1]


def _speeds(given: Any) -> np.ndarray:
    try:
        found = np.atleast_1d(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.ndim != 1 or not len(found) or not np.all(np.isfinite(found)):
        raise ValueError(f"campbell: speeds is {given!r}; give numbers [rad/s]")
    return found


def _unit(axis: Any) -> np.ndarray:
    try:
        found = np.asarray(axis, dtype=float)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape != (3,) or not np.all(np.isfinite(found)) or not np.any(found):
        raise ValueError(f"campbell: axis is {axis!r}; give three numbers, not all zero")
    return found / np.linalg.norm(found)
