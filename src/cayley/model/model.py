"""A model: parts, what holds them and what acts on them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from cayley.model.loads import Gravity, Load, PointLoad
from cayley.model.rod import Port, Rod
from cayley.model.supports import Support
from cayley.model.validate import Mask

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Model:
    """Parts with their supports and loads; nothing in it changes, `replace` makes another one.

    Attributes:
        parts: the rods, in the order given.
        supports: what is held; several at one node add up.
        loads: what acts.
        names: of the parts; a rod without a name is called rod, rod2, ...

    Example:
        >>> from cayley.model import Material, Rod, Section, supports
        >>> steel = Material(density=7850.0, youngs_modulus=2e11, poisson_ratio=0.3)
        >>> rod = Rod(Section.circle(0.01, steel), length=1.0, elements=4)
        >>> print(Model(rod, supports=[supports.clamp(rod.start)]))
        Model: 1 rod, 4 elements, 5 nodes, 2.46615 kg
          parts
            rod: 1 m, 4 elements, circle of radius 0.01 m, 2.46615 kg
          supports
            clamp at rod.start
    """

    parts: tuple[Rod, ...]
    supports: tuple[Support, ...]
    loads: tuple[Load, ...]
    names: tuple[str, ...]

    def __init__(self, *parts: Rod, supports: Sequence[Support] = (), loads: Sequence[Load] = ()) -> None:
        """Put the parts together and check that all fits.

        Args:
            *parts: rods, at least one, with different names.
            supports: made by `supports.pin`, `supports.clamp`, `supports.hold`.
            loads: made by `loads.gravity`, `loads.force`, ...

        Raises:
            TypeError: something is not a part, a support or a load.
            ValueError: no parts; one twice; two of one name; a support or a load on a rod that is not among them; a
                load that cannot move anything because all it acts on is held.
        """
        for part in parts:
            if not isinstance(part, Rod):
                hint = "; write Model(*rods)" if isinstance(part, (list, tuple)) else ""
                raise TypeError(f"Model: a part is a {type(part).__name__}, but must be a Rod{hint}")
        object.__setattr__(self, "parts", parts)
        object.__setattr__(self, "names", _names(parts))
        object.__setattr__(self, "supports", _members("supports", supports, Support, "supports.pin(rod.start)"))
        object.__setattr__(self, "loads", _members("loads", loads, Load, "loads.gravity((0, 0, -9.81))"))
        for support in self.supports:
            self._require(support.port.part, f"{support.kind} at {support.port}")
        for load in self.loads:
            if not isinstance(load, Gravity):
                self._require(load.part, str(load))
            if isinstance(load, PointLoad):
                self._refuse_idle(load)

    def __repr__(self) -> str:
        """The counts, in one line."""
        return f"Model({', '.join(self.names)}; supports={len(self.supports)}, loads={len(self.loads)})"

    def __str__(self) -> str:
        """A tree of parts, supports and loads."""
        return "\n".join(_tree(self))

    @property
    def rods(self) -> tuple[Rod, ...]:
        """The rods, in the order given."""
        return self.parts

    @property
    def mass(self) -> float:
        """The mass of all parts [kg]."""
        return sum(rod.mass for rod in self.rods)

    def name_of(self, rod: Rod) -> str:
        """The name under which listings and results have a rod.

        Raises:
            ValueError: the rod is not in the model.
        """
        for part, name in zip(self.parts, self.names, strict=True):
            if part is rod:
                return name
        raise ValueError(f"Model: {rod!r} is not in the model; its parts are {', '.join(self.names)}")

    def held(self, port: Port) -> tuple[Mask, Mask]:
        """Which components of position and of rotation are held at a node, by all supports together.

        Returns: for position, along x, y, z in space; for rotation, about the body axes e1, e2, e3.
        """
        here = [support for support in self.supports if support.port == port]
        return _union(support.held_position for support in here), _union(support.held_rotation for support in here)

    def replace(
        self,
        *,
        parts: Sequence[Rod] | None = None,
        supports: Sequence[Support] | None = None,
        loads: Sequence[Load] | None = None,
    ) -> Model:
        """Another model in which what is given replaces what is here.

        Args:
            parts: instead of its parts; supports and loads on parts that are gone must be replaced with them.
            supports: instead of its supports.
            loads: instead of its loads.

        Raises:
            TypeError: as for Model.
            ValueError: as for Model.
        """
        return Model(
            *(self.parts if parts is None else parts),
            supports=self.supports if supports is None else supports,
            loads=self.loads if loads is None else loads,
        )

    def _require(self, rod: Rod, what: str) -> None:
        if not any(part is rod for part in self.parts):
            has = ", ".join(self.names)
            raise ValueError(f"Model: {what} belongs to a rod that is not in the model; add it (the model has {has})")

    def _refuse_idle(self, load: PointLoad) -> None:
        """Refuse a load that only pulls at a support: all components it can act on are held.

        Positions are held along space axes and rotations about body axes, so only a constant force in space and a
        constant moment in the body can be judged component by component; others only if all three are held.
        """
        position, rotation = self.held(load.port)
        if load.kind == "force":
            quantity, held, frame = "position", position, "space"
        else:
            quantity, held, frame = "rotation", rotation, "body"
        acting: tuple[bool, ...] = (True, True, True)
        if not callable(load.value) and load.frame == frame and any(load.value):
            acting = tuple(component != 0.0 for component in load.value)
        if all(is_held for is_held, acts in zip(held, acting, strict=True) if acts):
            where = load.port.called(self.name_of(load.part))
            raise ValueError(
                f"Model: {load.kind} on {where} has no effect, for the {quantity} it acts on is held there; "
                "move it to another node or hold less"
            )


def _names(parts: tuple[Rod, ...]) -> tuple[str, ...]:
    """A name for each part: its own, or the first of rod, rod2, ... that is free."""
    if not parts:
        raise ValueError("Model: there are no parts; give at least one Rod")
    if len({id(part) for part in parts}) < len(parts):
        raise ValueError("Model: the same rod is given twice; give each part once")
    taken: set[str] = set()
    for name in (part.name for part in parts if part.name):
        if name in taken:
            raise ValueError(f"Model: two parts have the name {name!r}; give each a name of its own")
        taken.add(name)
    free = (name for k in range(1, 2 * len(parts) + 1) if (name := f"rod{k}" if k > 1 else "rod") not in taken)
    return tuple(part.name or next(free) for part in parts)


def _members(name: str, values: Any, kind: Any, example: str) -> tuple[Any, ...]:
    """A tuple of supports or loads."""
    if isinstance(values, kind) or not isinstance(values, Iterable):
        raise TypeError(f"Model: {name} is a {type(values).__name__}, but must be a list, such as {name}=[{example}]")
    members = tuple(values)
    for member in members:
        if not isinstance(member, kind):
            raise TypeError(f"Model: {name} has a {type(member).__name__} in it, but wants such as {example}")
    return members


def _union(masks: Iterable[Mask]) -> Mask:
    x = y = z = False
    for mask in masks:
        x, y, z = x or mask[0], y or mask[1], z or mask[2]
    return (x, y, z)


def _tree(model: Model) -> list[str]:
    elements = sum(rod.elements for rod in model.rods)
    nodes = elements + len(model.rods)
    rods = _counted(len(model.rods), "rod")
    lines = [f"Model: {rods}, {_counted(elements, 'element')}, {nodes} nodes, {model.mass:g} kg", "  parts"]
    for rod in model.rods:
        size = f"{rod.length:g} m, {_counted(rod.elements, 'element')}"
        damped = "" if rod.damping is None else f", {rod.damping}"
        lines.append(f"    {model.name_of(rod)}: {size}, {rod.section.name}, {rod.mass:g} kg{damped}")
    if model.supports:
        lines.append("  supports")
    for support in model.supports:
        lines.append(f"    {support.kind} at {support.port.called(model.name_of(support.port.part))}")
    if model.loads:
        lines.append("  loads")
    for load in model.loads:
        text = str(load) if isinstance(load, Gravity) else load.described(model.name_of(load.part))
        lines.append(f"    {text}")
    return lines


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
