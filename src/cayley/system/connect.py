"""From the joints and springs of a model to those of a system: which nodes, which program, which numbers."""

from collections.abc import Callable, Mapping

import numpy as np

from cayley.lie import exponential, quaternion
from cayley.model import Model
from cayley.model.joints import Joint
from cayley.model.port import Port
from cayley.model.springs import Spring
from cayley.system.couplings import GROUND, STILL, Coupling, Elastic

_PRESCRIBED = {
    ("hinge", "angle"): "weld",
    ("slider", "displacement"): "weld",
    ("cylindrical", "angle"): "slider",
    ("cylindrical", "displacement"): "hinge",
    ("cylindrical", "angle", "displacement"): "weld",
    ("drive", "position"): "ball",
    ("drive", "rotation"): "orientation",
    ("drive", "position", "rotation"): "weld",
    ("sleeve",): "slider",
    ("sleeve", "position"): "slider",
    ("sleeve", "rotation"): "slider",
    ("sleeve", "position", "rotation"): "slider",
}
"""What is left of a joint where some of its freedom is prescribed; a link stays one."""


def connect(
    model: Model, first_nodes: Mapping[int, int], degree: int
) -> tuple[tuple[Coupling, ...], tuple[Elastic, ...]]:
    """The joints and springs of a model.

    Args:
        model: the model.
        first_nodes: first node of each part, by its id.
        degree: nodes from one end of an element to the next.

    Returns: joints in the order of model.connections, springs in that of model.springs.
    """

    def node_of(port: Port) -> int:
        return first_nodes[id(port.part)] + port.node * degree

    def ends(tie: Joint | Spring) -> tuple[int, int]:
        first, *second = (node_of(port) for port in tie.ports)
        return first, second[0] if second else GROUND

    joints = []
    for joint, name in zip(model.connections, model.connection_names, strict=True):
        first, second = ends(joint)
        kind = _PRESCRIBED.get((joint.kind, *joint.driven), joint.kind)
        length = [] if joint.length is None else [joint.length]
        given = np.concatenate([*_sides(joint), length])
        if (joint.driven and kind == "weld") or joint.kind == "cylindrical":
            given = _at_start(joint, given)
        drive = _drive(joint) if joint.driven else None
        joints.append(Coupling(kind=kind, name=name, first=first, second=second, parameters=given, drive=drive))
    springs = []
    for spring, name in zip(model.springs, model.spring_names, strict=True):
        first, second = ends(spring)
        rest = spring.angle if spring.kind == "rotational" else spring.length
        numbers = [np.atleast_1d(value).reshape(-1) for value in (spring.stiffness, spring.damping)]
        given = np.concatenate([*_sides(spring), *numbers, [] if spring.kind == "bushing" else [rest]])
        springs.append(Elastic(kind=spring.kind, name=name, first=first, second=second, parameters=given))
    return tuple(joints), tuple(springs)


def _sides(tie: Joint | Spring) -> list[np.ndarray]:
    """Offset and frame of either side in its node (of the ground: in space): both frames agree at the start."""
    found: list[np.ndarray] = []
    for k, point in enumerate(tie.points):
        if k < len(tie.ports):
            port = tie.ports[k]
            turned = quaternion.relative(port.part.place(port.node)[1], tie.frame)
            found += [np.array(port.shift), np.asarray(turned, dtype=float)]
        else:
            found += [point, np.asarray(tie.frame, dtype=float)]
    return found


def _at_start(joint: Joint, given: np.ndarray) -> np.ndarray:
    """Parameters with the point of the side others are measured from moved to where the joint is at the start.

    A displacement counts from there: d = 0 at the start.
    """
    measured = 1 if joint.grounded else 0
    first, second = joint.points
    apart = (first - second) if joint.grounded else (second - first)
    own = slice(7 * measured, 7 * measured + 3)
    moved = given.copy()
    if joint.grounded:
        moved[own] += apart
    else:
        moved[own] += quaternion.inverse_rotate(joint.first.part.place(joint.first.node)[1], apart)
    return moved


def _drive(joint: Joint) -> Callable[[np.ndarray], np.ndarray]:
    """D and r of a joint at times (m,), shape (m, 7), seen from its frame; that of a drive is space."""

    def drive(times: np.ndarray) -> np.ndarray:
        found = np.tile(STILL, (len(times), 1))
        found[:, 2] = joint.motion("displacement", times)[:, 0]
        found[:, :3] += joint.motion("position", times)
        turn = joint.motion("rotation", times)
        if joint.kind == "sleeve":
            found[:, :3], turn = (np.asarray(quaternion.inverse_rotate(joint.frame, v)) for v in (found[:, :3], turn))
        turn[:, 2] += joint.motion("angle", times)[:, 0]
        found[:, 3:] = exponential.exp(turn)
        return found

    return drive
