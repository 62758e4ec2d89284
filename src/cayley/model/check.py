"""What a model checks of its parts together: names, joints that do not meet or say the same, loose parts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from cayley.model.joints import Joint
from cayley.model.part import Part
from cayley.model.shapes import Obstacle
from cayley.model.springs import Spring

GAP = 1e-9
"""Of the size of the model: joints that miss by more do not meet."""


def part_names(parts: Sequence[Part]) -> tuple[str, ...]:
    """A name for each part: its own, or the first of rod, rod2, ... (body, mass) that is free.

    Raises:
        ValueError: no parts; one twice; two of one name.
    """
    if not parts:
        raise ValueError("Model: there are no parts; give at least one Rod or Body")
    seen: set[int] = set()
    for part in parts:
        if id(part) in seen:
            raise ValueError(f"Model: the same {part.noun} is given twice; give each part once")
        seen.add(id(part))
    return _numbered([(part.name, part.noun) for part in parts], "parts")


def joint_names(joints: Sequence[Joint | Spring]) -> tuple[str, ...]:
    """A name for each joint or spring: its own, or its kind with a number.

    Raises:
        ValueError: two of one name.
    """
    what = "springs" if joints and isinstance(joints[0], Spring) else "joints"
    return _numbered([(joint.name, joint.kind) for joint in joints], what)


def obstacle_names(obstacles: Sequence[Obstacle]) -> tuple[str, ...]:
    """A name for each obstacle: its own, or its kind with a number.

    Raises:
        ValueError: two of one name.
    """
    return _numbered([(obstacle.name, obstacle.kind) for obstacle in obstacles], "obstacles")


def members(name: str, values: Any, kind: Any, example: str) -> tuple[Any, ...]:
    """A tuple of supports, joints, springs or loads.

    Raises:
        TypeError: it is no list, or has something else in it.
    """
    if isinstance(values, kind) or not isinstance(values, Iterable):
        raise TypeError(f"Model: {name} is a {type(values).__name__}, but must be a list, such as {name}=[{example}]")
    found = tuple(values)
    for member in found:
        if not isinstance(member, kind):
            raise TypeError(f"Model: {name} has a {type(member).__name__} in it, but wants such as {example}")
    return found


def refuse_gaps(parts: Sequence[Part], joints: Sequence[tuple[str, Joint]]) -> None:
    """Refuse joints whose sides do not meet at the start.

    Args:
        parts: of the model.
        joints: how messages call each, and the joint.

    Raises:
        ValueError: with the gap and what would be right.
    """
    if not joints:
        return
    size = extent(parts, [joint for _, joint in joints])
    for called, joint in joints:
        if joint.gap <= GAP * size:
            continue
        first, second = (f"({', '.join(f'{c:.9g}' for c in point)})" for point in joint.points)
        if joint.kind == "link":
            raise ValueError(
                f"Model: {called} is {joint.length:g} m long, but its ends are {joint.distance:.9g} m apart at the "
                "start; leave length out or move a part"
            )
        raise ValueError(
            f"Model: {called} has a gap of {joint.gap:.3g} m at the start: {first} and {second}; move a part, or give "
            "a port there with port.offset(...)"
        )


def refuse_same(joints: Sequence[tuple[str, Joint]]) -> None:
    """Refuse two joints of one kind at one place between the same nodes.

    Raises:
        ValueError: there are two.
    """
    seen: dict[Any, str] = {}
    for called, joint in joints:
        ends = frozenset((id(port.part), port.node) for port in joint.ports)
        place = tuple(np.round(np.concatenate([*joint.points, joint.axis or ()]), 9).tolist())
        key = (joint.kind, ends, joint.grounded, place)
        if key in seen:
            raise ValueError(f"Model: {called} says the same as {seen[key]}; leave one out")
        seen[key] = called


def loose(parts: Sequence[Part], held: Iterable[Part], pairs: Iterable[tuple[Part, ...]]) -> list[int]:
    """Numbers of the parts that are neither held nor connected to another part or the ground."""
    tied = {id(part) for part in held}
    for pair in pairs:
        tied |= {id(part) for part in pair}
    return [k for k, part in enumerate(parts) if id(part) not in tied]


def extent(parts: Sequence[Part], joints: Sequence[Joint]) -> float:
    """Diagonal of the box around all nodes at ends and all joints at the start [m]; 1 if that is a point."""
    points = [part.place(node)[0] for part in parts for node in (0, part.node_count - 1)]
    points += [point for joint in joints for point in joint.points]
    size = float(np.linalg.norm(np.ptp(np.array(points), axis=0)))
    return size if size > 0.0 else 1.0


def _numbered(given: Sequence[tuple[str, str]], what: str) -> tuple[str, ...]:
    """Names as given, or a word with the first free number."""
    taken: set[str] = set()
    for name in (name for name, _ in given if name):
        if name in taken:
            raise ValueError(f"Model: two {what} have the name {name!r}; give each a name of its own")
        taken.add(name)
    found = []
    for name, noun in given:
        k = 1
        while not name:
            candidate = noun if k == 1 else f"{noun}{k}"
            name, k = ("" if candidate in taken else candidate), k + 1
        taken.add(name)
        found.append(name)
    return tuple(found)
