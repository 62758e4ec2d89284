"""The fields a Lagrangian is made of: rotations, vectors, and the interval they live on."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Rotation:
    """A field of rotations: unit quaternions (scalar first) or, on request, matrices of SO(3).

    Its velocity ω = 2 p̄ ṗ and curvature Ω = 2 p̄ p′ are body-frame vectors of length 3.
    """

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return 3


@dataclass(frozen=True, slots=True)
class Vector:
    """A field of vectors in Rⁿ.

    Args:
        size: dimension n, at least 1.

    Raises:
        ValueError: if size is not a positive integer.
    """

    size: int = 3

    def __post_init__(self) -> None:
        """Check the size."""
        if isinstance(self.size, bool) or not isinstance(self.size, int) or self.size < 1:
            raise ValueError(f"Vector: size is {self.size!r}; give a whole number of at least 1")


Field = Rotation | Vector


@dataclass(frozen=True, slots=True)
class Interval:
    """An interval of the line, divided into equal elements; also the marker ``s=cy.Interval`` of a density.

    Args:
        start: first coordinate [m].
        stop: last coordinate [m], larger than start.
        elements: number of elements, at least 1.

    Raises:
        ValueError: if the interval is empty or has no elements.
    """

    start: float
    stop: float
    elements: int

    def __post_init__(self) -> None:
        """Check the bounds."""
        if not self.stop > self.start:
            raise ValueError(f"Interval: stop is {self.stop!r}, start is {self.start!r}; stop must be larger")
        if isinstance(self.elements, bool) or int(self.elements) != self.elements or self.elements < 1:
            raise ValueError(f"Interval: elements is {self.elements!r}; give a whole number of at least 1")
