"""Springs and dampers between two ports, or a port and the ground; all of them without mass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.lie import quaternion
from cayley.model import validate
from cayley.model.joints import axis_frame
from cayley.model.port import Ground, Port, ground
from cayley.model.tie import Side, Tie
from cayley.model.validate import Array, Triple

__all__ = ["Spring", "bushing", "linear", "rotational"]

KINDS = ("linear", "rotational", "bushing")
_BUSHING = "along e1, e2, e3 and about them [N/m, N m/rad]"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Spring(Tie):
    """A spring, a damper, or both side by side; made by `linear`, `rotational` and `bushing`.

    linear:      V = ½ k (ℓ − ℓ₀)²,  F = −c ℓ̇        with ℓ the distance of the two points
    rotational:  V = ½ k (θ − θ₀)²,  M = −c θ̇        with θ the turn about the axis, seen from the first side
    bushing:     V = ½ ε·K ε,        F = −C ε̇        with ε = (Δ, θ): what the second side moved and turned since the
                 start, seen from the frame of the first; θ the rotation vector

    Attributes:
        kind: a word of KINDS.
        first: a port.
        second: another, or the ground.
        stiffness: k [N/m or N m/rad], or K, shape (6, 6).
        damping: c [N s/m or N m s/rad], or C, shape (6, 6).
        length: ℓ₀ of a linear spring [m].
        angle: θ₀ of a rotational one [rad]; θ is zero at the start.
        axis: of a rotational one, in space at the start; of a bushing the e3 of its frame, or None for that of the
            first port (of space, if the second side is the ground).
        name: in listings and results; empty: the model numbers the spring.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a value is out of range.
    """

    kind: str
    first: Port
    second: Side
    stiffness: Any
    damping: Any = 0.0
    length: float = 0.0
    angle: float = 0.0
    axis: Triple | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Check the values and bring them to their standard types."""
        validate.option("Spring", "kind", self.kind, KINDS)
        if not isinstance(self.name, str) or "/" in self.name:
            raise ValueError(validate.wrong(f"{self.kind} spring", "name", self.name, 'a text without "/"'))
        for word, side, kinds in (("first", self.first, Port), ("second", self.second, (Port, Ground))):
            if not isinstance(side, kinds):
                right = 'a port, such as rod.end or body.port("eye")' + (", or cy.ground" if word == "second" else "")
                raise TypeError(validate.wrong(f"{self.kind} spring", word, side, right))
        owner = str(self)
        for word in ("stiffness", "damping"):
            object.__setattr__(self, word, self._coefficient(owner, word, getattr(self, word)))
        if not np.any(self.stiffness) and not np.any(self.damping):
            raise ValueError(f"{owner}: neither stiffness nor damping; give one of them")
        if self.axis is not None:
            object.__setattr__(self, "axis", validate.direction(owner, "axis", self.axis))
        elif self.kind == "rotational":
            raise ValueError(validate.wrong(owner, "axis", self.axis, "an axis, a vector in space"))
        length = validate.number(owner, "length", self.length, "m")
        if length < 0.0:
            raise ValueError(validate.wrong(owner, "length", length, "a number from 0 [m]"))
        if self.kind == "linear" and self.distance == 0.0 and np.any(self.damping):
            raise ValueError(f"{owner}: both ends are at the same place, so a damper has no direction; move one")
        object.__setattr__(self, "length", length)
        object.__setattr__(self, "angle", validate.number(owner, "angle", self.angle, "rad"))

    def __str__(self) -> str:
        """Kind and sides."""
        return self.called(str(self.first), str(self.second))

    def called(self, first: str, second: str) -> str:
        """Kind and sides, if these have such names."""
        return f"{self.kind} spring of {first} and {second}"

    @property
    def frame(self) -> Array:
        """The frame in space at the start, unit quaternion, wxyz, shape (4,): e3 along the axis, if there is one."""
        if self.axis is not None:
            return axis_frame(np.array(self.axis))
        return quaternion.identity() if self.grounded else self.first.place[1]

    def described(self, first: str, second: str) -> str:
        """Kind, sides and coefficients, in one line."""
        unit = "m" if self.kind == "linear" else "rad"
        force = "N" if self.kind == "linear" else "N m"
        if self.kind == "bushing":
            words = [f"K diagonal {_diagonal(self.stiffness)}", f"C diagonal {_diagonal(self.damping)}"]
        else:
            words = [f"{self.stiffness:g} {force}/{unit}", f"{self.damping:g} {force} s/{unit}"]
        has = [word for word, value in zip(words, (self.stiffness, self.damping), strict=True) if np.any(value)]
        rest = {"linear": [f"unstressed at {self.length:g} m"], "rotational": [f"unstressed at {self.angle:g} rad"]}
        return ", ".join([self.called(first, second), *has, *rest.get(self.kind, [])])

    def _coefficient(self, owner: str, word: str, value: Any) -> Any:
        """A number from zero, or for a bushing a symmetric matrix without a negative eigenvalue."""
        if self.kind != "bushing":
            given = validate.number(owner, word, value, "N/m or N m/rad" + (" times s" if word == "damping" else ""))
            if given < 0.0:
                raise ValueError(validate.wrong(owner, word, value, "a number from 0"))
            return given
        right = f"six numbers from 0 or a symmetric 6 x 6 matrix without negative eigenvalues, {_BUSHING}"
        if np.ndim(value) == 0 and value == 0.0:
            return validate.frozen(np.zeros((6, 6)))
        if np.ndim(value) == 1:
            value = np.diag(validate.array(owner, word, value, (6,), right))
        matrix = validate.array(owner, word, value, (6, 6), right)
        size = np.abs(matrix).max()
        if np.abs(matrix - matrix.T).max() > 1e-9 * size or np.linalg.eigvalsh(matrix)[0] < -1e-12 * size:
            raise ValueError(validate.wrong(owner, word, value, right))
        return validate.frozen(0.5 * (matrix + matrix.T))


def linear(
    first: Port,
    second: Side = ground,
    *,
    stiffness: float = 0.0,
    damping: float = 0.0,
    length: float | None = None,
    name: str = "",
) -> Spring:
    """A spring or damper that pulls along the line between two ports.

    Args:
        first: a port, such as mast.end.
        second: another, or a point of the ground, `cy.ground.at((0, 0, 1))`.
        stiffness: k [N/m].
        damping: c [N s/m].
        length: at which it pulls nothing [m]; that at the start unless given.
        name: in listings and results.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a negative value, or neither stiffness nor damping.
    """
    made = Spring(kind="linear", first=first, second=second, stiffness=stiffness, damping=damping, name=name)
    unstressed = made.distance if length is None else length
    return Spring(
        kind="linear", first=first, second=second, stiffness=stiffness, damping=damping, length=unstressed, name=name
    )


def rotational(
    first: Port,
    second: Side = ground,
    *,
    axis: Any,
    stiffness: float = 0.0,
    damping: float = 0.0,
    angle: float = 0.0,
    name: str = "",
) -> Spring:
    """A spring or damper that turns one side against the other about an axis, such as that of a hinge.

    Args:
        first: a port.
        second: another, or the ground.
        axis: in space, at the start.
        stiffness: k [N m/rad].
        damping: c [N m s/rad].
        angle: at which there is no moment [rad], counted from the start, of the second side seen from the first (of
            the port seen from the ground); up to π either way.
        name: in listings and results.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: a negative value, or neither stiffness nor damping.
    """
    values: Any = {"stiffness": stiffness, "damping": damping, "angle": angle, "axis": axis, "name": name}
    return Spring(kind="rotational", first=first, second=second, **values)


def bushing(
    first: Port,
    second: Side = ground,
    *,
    stiffness: Any = 0.0,
    damping: Any = 0.0,
    axis: Any = None,
    name: str = "",
) -> Spring:
    """An elastic connection of two ports in all six directions.

    Args:
        first: a port, in whose frame the directions are.
        second: another, or the ground, in whose frame (that of space) they are then.
        stiffness: K, shape (6, 6), or its diagonal: along e1, e2, e3 [N/m], about e1, e2, e3 [N m/rad].
        damping: C likewise, times s.
        axis: e3 of the frame, in space at the start, instead.
        name: in listings and results.

    Raises:
        TypeError: a value has the wrong type.
        ValueError: not symmetric, a negative eigenvalue, or neither stiffness nor damping.
    """
    values: Any = {"stiffness": stiffness, "damping": damping, "axis": axis, "name": name}
    return Spring(kind="bushing", first=first, second=second, **values)


def _diagonal(matrix: Array) -> str:
    return "(" + ", ".join(f"{value:g}" for value in np.diagonal(matrix)) + ")"
