"""Contacts of a system for one call of a compiled stepper: struct contacts, and what is remembered of it."""

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np

from cayley.discrete.layout import Layout
from cayley.steppers.native import address, fill, library
from cayley.steppers.outcome import Outcome
from cayley.system.contact_limits import SOFT, inverse_masses, stiffness
from cayley.system.redundancy import ground_values
from cayley.system.system import System

SHEAR = 0.3
"""Tangential stiffness for a unit of the normal one: with the lever of a rod's surface, about as fast."""
RELAX = 0.995
"""Part of an overlap at the start that a step leaves."""
HEAD, RECORD = 2, 14
"""Numbers that are remembered of all contacts, and of each."""
TOLD = 7
"""Energy, loss, deepest now in radii, contacts, candidates, searches (0 at frames), deepest since the last frame."""
EACH, ROOM = 4, 512
"""Contacts of a segment that memory has room for, and how many more."""


@dataclass(slots=True)
class Contacts:
    """Arrays and struct; release it when the call is over.

    Args:
        system: the system, with contact and quaternions.
        arrays: by the names of the fields.
        struct: struct contacts.
    """

    system: System
    arrays: dict[str, Any]
    struct: Any

    @property
    def engine(self) -> Any:
        """The functions for it."""
        return library(self.system.kernels.lanes)

    def begin(self, values: np.ndarray, memory: np.ndarray | None) -> None:
        """Begin at values, shape (nodes, rows), with what a state remembers of contacts, flat, or nothing."""
        known = memory is not None and memory.shape == (memory_size(self.system),)
        if known and memory is not None:
            count = self.arrays["memory"].size
            self.arrays["memory"][:] = memory[:count]
            self.arrays["force"][:-1] = memory[count:].reshape(self.system.size, -1)
        begin, given = self.engine.begin_contacts, with_ground(self.system.layout, values)
        begin.restype = ctypes.c_int64
        self.struct.state = begin(ctypes.byref(self.struct), address(given), ctypes.c_int64(known))

    def remember(self) -> np.ndarray | None:
        """What a state remembers, flat; None if there are more contacts than room for them."""
        remember = self.engine.remember_contacts
        remember.restype = ctypes.c_int64
        if not remember(ctypes.byref(self.struct), ctypes.c_int64(self.struct.state)):
            return None
        return np.concatenate([self.arrays["memory"], self.arrays["force"][:-1].reshape(-1)])

    def close(self, outcome: Outcome, memory: np.ndarray) -> tuple[Outcome, np.ndarray, str]:
        """End a call of a stepper: its outcome, what a state remembers with that of contacts, and who went too fast.

        Args:
            outcome: how the call ended without a look at contacts.
            memory: what the state remembers otherwise, flat.
        """
        touching, partners = self.system.contact, ""
        assert touching is not None
        if outcome.hasty:
            partners = touching.described(*map(int, self.arrays["blame"]))
        elif outcome is Outcome.FINISHED:
            own = self.remember()
            outcome = Outcome.CROWDED if own is None else outcome
            memory = memory if own is None else np.concatenate([memory, own])
        self.end()
        return outcome, memory, partners

    def end(self) -> None:
        """Release what C keeps."""
        self.engine.end_contacts(ctypes.c_int64(self.struct.state))


def at_start(system: System, values: np.ndarray, h: float) -> np.ndarray | None:
    """What frames have of contacts (see Frames), of a start at values; None without contact."""
    if system.contact is None:
        return None
    made = make_contacts(system, h)
    made.begin(values, None)
    made.end()
    return np.concatenate([made.arrays["told"], made.arrays["force"][:-1].reshape(-1)])


def memory_size(system: System) -> int:
    """Length of what is remembered of contacts."""
    assert system.contact is not None
    return HEAD + RECORD * _capacity(system) + system.size * system.layout.dofs


def _capacity(system: System) -> int:
    assert system.contact is not None
    return ROOM + EACH * system.contact.segments


def make_contacts(system: System, h: float) -> Contacts:
    """Fill struct contacts for steps h [s]."""
    assert system.contact is not None
    touching, layout, nodes = system.contact, system.layout, system.size
    per_mass, least = stiffness(system, h)
    points, solids = inverse_masses(system)
    fixed = touching.arrays
    arrays: dict[str, Any] = {
        **{name: values if values.size else np.zeros(1, dtype=values.dtype) for name, values in fixed.items()},
        "inverse": np.append(points, 0.0),
        "yield": np.append(solids, 0.0),
        "force": np.zeros((nodes + 1, layout.dofs)),
        "told": np.zeros(TOLD),
        "blame": np.full(2, -1, dtype=np.int64),
        "memory": np.zeros(HEAD + RECORD * _capacity(system)),
        "nodes": nodes,
        "rows": layout.rows,
        "dofs": layout.dofs,
        "place_row": layout.rows_of("x").start,
        "turn_row": layout.rows_of("p").start,
        "place_dof": layout.dofs_of("x").start,
        "turn_dof": layout.dofs_of("p").start,
        "points": len(fixed["node"]),
        "segments": touching.segments,
        "solids": len(fixed["kind"]),
        "owners": len(touching.names),
        "apart_count": len(fixed["apart"]),
        "tied_count": len(fixed["tied"]),
        "per_mass": per_mass,
        "least": least,
        "soft": SOFT * touching.contact.penetration,
        "deepest": touching.deepest,
        "shear": SHEAR,
        "damping": touching.contact.damping,
        "relax": RELAX if touching.contact.allow_overlap else 0.0,
        "clearance": 0.5 * touching.unit,
        "capacity": _capacity(system),
        "state": 0,
    }
    return Contacts(system, arrays, fill("contacts", arrays))


def with_ground(layout: Layout, values: np.ndarray) -> np.ndarray:
    """Values of nodes and, behind them, of the ground."""
    return np.ascontiguousarray(np.vstack([values, ground_values(layout)]))


def view(system: System, values: np.ndarray, h: float) -> np.ndarray:
    """All contacts of a configuration: partners, slot, depth, its unit, normal, place, normal force, shape (k, 12)."""
    made = make_contacts(system, h)
    look = made.engine.view_contacts
    look.restype = ctypes.c_int64
    most, given = _capacity(system), with_ground(system.layout, values)
    found = np.zeros((most, 12))
    count = look(ctypes.byref(made.struct), address(given), ctypes.c_int64(most), address(found))
    return found[: min(count, most)]
