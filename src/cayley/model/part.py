"""What rods and bodies have in common: nodes, each with a place at the start, to which everything else attaches."""

from __future__ import annotations

from abc import ABC, abstractmethod

from cayley.model import validate
from cayley.model.validate import Array


class Part(ABC):
    """Something with mass: one node or more, each a rotation and a position.

    Attributes:
        name: in listings and results; empty: the model numbers the part.
    """

    __slots__ = ()  # the dataclasses hold the values
    name: str

    @property
    @abstractmethod
    def noun(self) -> str:
        """What it is, in one word: "rod", "body"; an unnamed part is called so."""

    @property
    @abstractmethod
    def mass(self) -> float:
        """Its mass [kg]."""

    @property
    @abstractmethod
    def node_count(self) -> int:
        """Number of nodes; a rule of higher degree puts more between them."""

    @abstractmethod
    def place(self, node: int) -> tuple[Array, Array]:
        """Position x [m], shape (3,), and rotation p, wxyz, shape (4,), of a node before any motion."""

    @abstractmethod
    def node_name(self, node: int) -> str:
        """How a user gets at a node: "start", "node(3)", "centre"."""

    @property
    def label(self) -> str:
        """What messages call it."""
        kind = type(self).__name__
        return f"{kind} {self.name!r}" if self.name else kind


def checked_name(kind: str, name: object) -> None:
    """Refuse a name that is no text, or has a "/": it becomes the name of a group in the store.

    Raises:
        TypeError: it is no text.
        ValueError: it has a "/".
    """
    right = 'a text without "/"'
    if not isinstance(name, str):
        raise TypeError(validate.wrong(kind, "name", name, right))
    if "/" in name:
        raise ValueError(validate.wrong(kind, "name", name, right))
