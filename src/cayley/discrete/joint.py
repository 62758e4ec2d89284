"""Joints g(q_a, q_b, t) = 0 between two nodes, or a node and the ground: the programs that evaluate them.

A joint has a point and a frame on either side: P = x + Λ(p) o, F = p f. With A the side the other is measured from,

    Δ = Λ(F_A)ᵀ (P_B − P_A) − d(t)        u = conj(F_A r(t)) F_B

are independent of where the whole is and how it is turned. Side A is node a; of a joint to the ground it is the ground,
which stands in the place of node b as a pose that does not move (p = 1, x = 0), so a prescribed motion d, r is one seen
from the ground. Each kind keeps some components of Δ (the joint frame's e1, e2, e3) and of u at zero; their
derivative has full rank wherever they are zero. With λ the multipliers, those of Δ are forces [N] along the axes of
F_A, those of 2 Im u moments [N m].

Source: Géradin, Cardona (2001), Flexible Multibody Dynamics, chapter 7; Haug (1989), section 9.4.
"""

import functools
from collections.abc import Callable
from typing import Any, TypeVar

import casadi as ca
import numpy as np

from cayley.density.expression import Expression, dot, symbols, to_sx, wrap
from cayley.discrete.embedded import normalized
from cayley.discrete.layout import Layout
from cayley.discrete.program import Program
from cayley.lie import quaternion

Parts = tuple[Expression, Expression]
"""Δ and u."""


def _point(parts: Parts, *axes: int) -> list[Expression]:
    """Components of Δ."""
    return [parts[0][axis] for axis in axes]


def _turned(parts: Parts) -> list[Expression]:
    """2 Im u: no relative rotation."""
    return [wrap(2.0 * parts[1][k]) for k in (1, 2, 3)]


def _aligned(parts: Parts) -> list[Expression]:
    """Components of e3 of B along e1, e2 of A: the third axes agree."""
    w, x, y, z = parts[1]
    return [2.0 * (x * z + w * y), 2.0 * (y * z - w * x)]


def _perpendicular(parts: Parts) -> list[Expression]:
    """e1 of A times e2 of B."""
    w, x, y, z = parts[1]
    return [2.0 * (x * y - w * z)]


KINDS: dict[str, Callable[[Parts], list[Expression]]] = {
    "weld": lambda parts: _point(parts, 0, 1, 2) + _turned(parts),
    "ball": lambda parts: _point(parts, 0, 1, 2),
    "hinge": lambda parts: _point(parts, 0, 1, 2) + _aligned(parts),
    "universal": lambda parts: _point(parts, 0, 1, 2) + _perpendicular(parts),
    "slider": lambda parts: _point(parts, 0, 1) + _turned(parts),
    "cylindrical": lambda parts: _point(parts, 0, 1) + _aligned(parts),
    "planar": lambda parts: _point(parts, 2) + _aligned(parts),
    "guide": lambda parts: _point(parts, 0, 1),
    "roller": lambda parts: _point(parts, 2),
    "orientation": _turned,
}
"""What each kind keeps at zero; "link" has its own form below."""
_PLACE, _TURN = ("along e1", "along e2", "along e3"), ("about e1", "about e2", "about e3")
DIRECTIONS: dict[str, tuple[str, ...]] = {
    "weld": (*_PLACE, *_TURN),
    "ball": _PLACE,
    "hinge": (*_PLACE, "about e2", "about e1"),
    "universal": (*_PLACE, "about e1 x e2"),
    "slider": (*_PLACE[:2], *_TURN),
    "cylindrical": (*_PLACE[:2], "about e2", "about e1"),
    "planar": ("along e3", "about e2", "about e1"),
    "link": ("along the link",),
    "guide": _PLACE[:2],
    "roller": ("along e3",),
    "orientation": _TURN,
}
"""What each constraint of a kind prevents, seen in the joint frame."""
COUNTS = {kind: len(words) for kind, words in DIRECTIONS.items()}
"""Number of constraints of each kind."""
DRIVE = 7
"""Numbers of a prescribed motion: d [m], then the quaternion r."""


Derived = TypeVar("Derived")
Evaluator = Callable[[np.ndarray], np.ndarray]
"""A program as a function of rows of inputs."""


def once(derive: Callable[..., Derived]) -> Callable[..., Derived]:
    """Derive what depends on a kind, a layout and words once a process."""
    known: dict[tuple[str, str, str], Derived] = {}

    @functools.wraps(derive)
    def derived(kind: str, layout: Layout, **options: Any) -> Derived:
        key = kind, repr(layout), repr(sorted(options.items()))
        if key not in known:
            known[key] = derive(kind, layout, **options)
        return known[key]

    return derived


def parameter_count(kind: str) -> int:
    """Number of parameters: offset and frame in a, offset and frame in b, and of a link its length."""
    return 15 if kind == "link" else 14


@once
def joint_program(kind: str, layout: Layout, *, grounded: bool, what: str = "") -> Program:
    """The constraints of a joint and their derivatives with respect to the values of its nodes.

    link: g = (|P_B − P_A|²/ℓ − ℓ)/2 with ℓ = length + d₃; the others as KINDS says.

    Quaternions may have any length but zero: they are normalized first.

    Args:
        kind: one of COUNTS.
        layout: rows of a node with the fields p and x, rotations as quaternions.
        grounded: whether side b is the ground.
        what: "" for all; "slope" without the Hessian; "drive" for ∂g/∂(d, r) alone, from which ∂g/∂t.

    Returns: a program on rows (values of a, of b, parameters, d, r, λ) -> (g, ∂g by rows, upper triangle of λ·∂²g)
    over the values of a and b, named joint_KIND, with _ground and _slope or _drive behind it; without uniforms.

    Raises:
        ValueError: for rotations stored as matrices.
    """
    if layout.representation.name != "quaternion":
        raise ValueError(f"joints want rotation='quaternion', not {layout.representation.name!r}")
    a, b = symbols("a", layout.rows), symbols("b", layout.rows)
    given, drive = symbols("c", parameter_count(kind)), symbols("d", DRIVE)
    g = ca.vertcat(*[to_sx(e) for e in joint_constraints(kind, layout, (a, b), given, drive, grounded=grounded)])
    multiplier = ca.SX.sym("lambda", g.numel())
    unknown = ca.vertcat(to_sx(a), to_sx(b))
    derivative = ca.densify(ca.jacobian(g, to_sx(drive) if what == "drive" else unknown))
    outputs = [*([] if what == "drive" else ca.vertsplit(ca.densify(g))), *ca.vertsplit(ca.vec(derivative.T))]
    inputs = [*ca.vertsplit(unknown), *ca.vertsplit(to_sx(given)), *ca.vertsplit(to_sx(drive))]
    if not what:
        hessian = ca.densify(ca.jacobian(ca.gradient(ca.dot(multiplier, g), unknown), unknown))
        size = 2 * layout.rows
        outputs += [hessian[i, k] for i in range(size) for k in range(i, size)]
        inputs += ca.vertsplit(multiplier)
    name = "_".join(["joint", kind, *(["ground"] if grounded else []), *([what] if what else [])])
    return plain_program(name, inputs, outputs)


def plain_program(name: str, inputs: list[ca.SX], outputs: list[ca.SX]) -> Program:
    """A program that reads rows and writes others behind them."""
    return Program(
        name=name,
        uniforms=(),
        lanes=tuple((s, i, 0) for i, s in enumerate(inputs)),
        steps=(),
        stores=tuple((len(inputs) + i, v) for i, v in enumerate(outputs)),
        rows=len(inputs) + len(outputs),
    )


def joint_constraints(
    kind: str, layout: Layout, nodes: Parts, given: Expression, drive: Expression, *, grounded: bool
) -> list[Expression]:
    """The constraints g of a joint, entry by entry."""
    sides = joint_sides(layout, nodes, given)
    (origin, frame), (point, other) = reversed(sides) if grounded else sides
    if kind == "link":
        length, apart = given[14] + drive[2], wrap(point - origin)
        return [0.5 * (dot(apart, apart) / length - length)]
    delta = quaternion.inverse_rotate(frame, wrap(point - origin)) - drive[:3]
    turn = quaternion.relative(quaternion.multiply(frame, drive[3:]), other)
    return KINDS[kind]((wrap(delta), wrap(np.asarray(turn))))


def joint_sides(layout: Layout, nodes: Parts, given: Expression) -> list[Parts]:
    """Point and frame of either side in space, from values of the nodes and offsets and frames in them."""
    sides = []
    for node, start in zip(nodes, (0, 7), strict=True):
        unit = normalized(layout, node)
        p, x = unit[layout.rows_of("p")], node[layout.rows_of("x")]
        point = wrap(x + quaternion.rotate(p, given[start : start + 3]))
        sides.append((point, wrap(quaternion.multiply(p, given[start + 3 : start + 7]))))
    return sides


def evaluator(program: Program) -> Evaluator:
    """A program without uniforms as a function of columns of inputs, (m, inputs) -> (m, outputs)."""
    inputs = ca.vertcat(*[symbol for symbol, _, _ in program.lanes])
    function = ca.Function(program.name, [inputs], [ca.vertcat(*[value for _, value in program.stores])])
    return lambda rows: np.array(function(np.atleast_2d(rows).T)).T
