"""Rows of a node: where each field's values, momenta and unknowns stand."""

from collections.abc import Mapping
from dataclasses import dataclass

from cayley.density.fields import Field, Rotation
from cayley.discrete.representation import Representation


@dataclass(frozen=True, slots=True)
class Layout:
    """Order of the numbers at one node.

    Args:
        fields: the fields by name.
        representation: how rotations are stored.
    """

    fields: Mapping[str, Field]
    representation: Representation

    def rows_of(self, name: str) -> slice:
        """Rows of a field's values among all values."""
        return self._slices(stored=True)[name]

    def dofs_of(self, name: str) -> slice:
        """Degrees of freedom of a field among all: its unknowns, velocities and momenta."""
        return self._slices(stored=False)[name]

    @property
    def rows(self) -> int:
        """Number of values a node stores."""
        return sum(self._stored(kind) for kind in self.fields.values())

    @property
    def dofs(self) -> int:
        """Number of degrees of freedom of a node."""
        return sum(kind.size for kind in self.fields.values())

    @property
    def rotations(self) -> tuple[str, ...]:
        """Names of the rotation fields."""
        return tuple(name for name, kind in self.fields.items() if isinstance(kind, Rotation))

    @property
    def dof_names(self) -> tuple[str, ...]:
        """A word for every degree of freedom, such as 'x[2]'."""
        return tuple(f"{name}[{i}]" for name, kind in self.fields.items() for i in range(kind.size))

    def _stored(self, kind: Field) -> int:
        return self.representation.rows if isinstance(kind, Rotation) else kind.size

    def _slices(self, *, stored: bool) -> dict[str, slice]:
        found, start = {}, 0
        for name, kind in self.fields.items():
            size = self._stored(kind) if stored else kind.size
            found[name] = slice(start, start + size)
            start += size
        return found
