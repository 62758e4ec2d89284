"""Systems of several densities: what their members share (docs/adr/0009)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.codegen.kernels import Kernels
from cayley.discrete.layout import Layout
from cayley.discrete.rules import Rule
from cayley.system.system import System

_EVERYWHERE = ("weight", "1/weight", "length", "here")
"""Numbers of nodes that mean the same in every density."""


@dataclass(frozen=True, slots=True)
class Shared:
    """What the equations of several densities have in common; what each has of its own is asked of its member."""

    rule: Rule
    layout: Layout

    def __getattr__(self, name: str) -> Any:
        """Refuse what only the equations of one density have."""
        raise AttributeError(f"several densities have no {name} in common; ask each of system.groups")


def mixed(members: Sequence[System]) -> System:
    """One system of several, whose nodes follow each other.

    Args:
        members: systems of one density each, with one rule, one layout and kernels of the same lanes.

    Returns: the System; joints, springs and loads are for the caller to add.
    """
    first = members[0]
    shared: Any = Shared(first.equations.rule, first.layout)
    return System(
        equations=shared,
        kernels=Kernels(shared, first.kernels.lanes),
        uniforms=np.zeros(0),
        named={name: np.concatenate([member.named[name] for member in members]) for name in _EVERYWHERE},
        free=np.concatenate([member.free for member in members]),
        chains=tuple(count for member in members for count in member.chains),
        reference=np.concatenate([member.reference for member in members]),
        account=first.account,
        members=tuple(members),
    )
