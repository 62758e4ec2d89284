"""Contacts in a problem of an implicit rule: elimination is planned anew where what is near changes."""

import ctypes
import itertools
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cayley.steppers.arrays import coupling_places, places
from cayley.steppers.blocks import Blocks, distinct
from cayley.steppers.contacts import Contacts
from cayley.steppers.native import address
from cayley.steppers.problem import Problem
from cayley.system.system import aligned

MOST = 8
"""Nodes of a candidate."""
_CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int64)


@dataclass(slots=True)
class ContactPlan:
    """What plans; keep it as long as the problem.

    Args:
        made: the problem.
        contacts: its contacts, begun.
        own: pairs of blocks without contacts.
        callback: what C calls.
        known: pairs of blocks that contacts couple now.
        failure: what went wrong in a call from C, or None.
    """

    made: Problem
    contacts: Contacts
    own: np.ndarray = field(init=False)
    callback: Any = None
    known: np.ndarray | None = None
    failure: BaseException | None = None

    def begin(self) -> None:
        """Tell the problem of its contacts."""
        struct = self.made.struct
        self.own = self.made.plan.blocks.pairs
        self.callback = _CALLBACK(self._renew)
        struct.contacts = ctypes.addressof(self.contacts.struct)
        struct.renew = ctypes.cast(self.callback, ctypes.c_void_p).value

    def _renew(self) -> int:
        try:
            self._plan()
        except BaseException as error:  # C can't let it through
            self.failure = error
            return 1
        return 0

    def _plan(self) -> None:
        made, engine = self.made, self.contacts.engine
        count = int(engine.contact_count(ctypes.byref(self.contacts.struct)))
        nodes = np.full((max(count, 1), MOST), -1, dtype=np.int64)
        engine.contact_nodes(ctypes.byref(self.contacts.struct), address(nodes))
        pairs = self._pairs(nodes)
        if self.known is None or not np.array_equal(pairs, self.known):
            self._eliminate(pairs)
            self.known = pairs
        known = np.where(nodes < 0, made.plan.size, nodes)
        self._give("contact_nodes", nodes)
        self._give("contact_places", places(made.plan, known))

    def _pairs(self, nodes: np.ndarray) -> np.ndarray:
        """Blocks that candidates couple, each pair once, shape (k, 2)."""
        found = [np.zeros((0, 2), dtype=np.int64)]
        for a, b in itertools.combinations(range(MOST), 2):
            both = nodes[:, [a, b]]
            found.append(self.made.plan.block_of[both[(both >= 0).all(axis=1)]])
        pairs = np.sort(np.concatenate(found), axis=1)
        return distinct(pairs[pairs[:, 0] != pairs[:, 1]], len(self.made.plan.blocks.sizes))

    def _eliminate(self, pairs: np.ndarray) -> None:
        """Plan the elimination with more pairs, and move everything to its new place."""
        made, first = self.made, self.made.plan.blocks
        blocks = Blocks(first.lanes, first.sizes, np.concatenate([self.own, pairs]), first.before)
        plan = made.plan = replace(made.plan, blocks=blocks)
        starts, terms = blocks.starts, made.alive[0]
        for cells, arrays, struct in zip(plan.terms, terms, made.alive[1], strict=True):
            arrays["places"] = places(plan, cells.nodes)
            struct.places = arrays["places"].ctypes.data
        for k, (cells, arrays, struct) in enumerate(zip(plan.constraints, made.couplings, made.alive[2], strict=True)):
            for name, values in coupling_places(plan, cells, k, starts).items():
                arrays[name] = np.ascontiguousarray(values)
                setattr(struct, name, arrays[name].ctypes.data)
        self._give("place", starts[plan.block_of] + plan.base)
        self._give("diagonal", blocks.diagonal())
        self._give("matrix", aligned((blocks.size,)))
        made.struct.fronts, made.struct.matrix_size = blocks.fronts, blocks.size

    def _give(self, name: str, array: np.ndarray) -> None:
        made = self.made
        made.arrays[name] = np.ascontiguousarray(array)
        setattr(made.struct, name, made.arrays[name].ctypes.data)
