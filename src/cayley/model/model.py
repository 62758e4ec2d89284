"""A model: parts, what holds them and what acts on them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from types import EllipsisType
from typing import Any

from cayley.model import check
from cayley.model.body import Body, PointMass
from cayley.model.contact import Contact, check_contact, odd_contact
from cayley.model.joints import Joint
from cayley.model.lagrangian_part import LagrangianPart
from cayley.model.loads import Gravity, LineLoad, Load, PointLoad, RodLoad
from cayley.model.part import Part
from cayley.model.port import Port
from cayley.model.rod import Rod
from cayley.model.shapes import Obstacle
from cayley.model.springs import Spring
from cayley.model.supports import Support
from cayley.model.validate import Mask


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Model:
    """Parts with what holds, connects and moves them; nothing in it changes, `replace` makes another one.

    Attributes:
        parts: rods, bodies, point masses and parts with a Lagrangian of their own, in the order given.
        supports: components that are held; several at one node add up.
        guides: guides and drives given among the supports; they are joints to the ground.
        joints: between parts, or parts and the ground.
        springs: springs and dampers.
        loads: what acts.
        obstacles: shapes that rods and bodies touch, fixed in space or carried by a body.
        contact: how they touch, and rods each other; None: nothing touches.
        names: of the parts; a rod without a name is called rod, rod2, ..., a body body, body2, ...

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

    parts: tuple[Part, ...]
    supports: tuple[Support, ...]
    guides: tuple[Joint, ...]
    joints: tuple[Joint, ...]
    springs: tuple[Spring, ...]
    loads: tuple[Load, ...]
    obstacles: tuple[Obstacle, ...]
    contact: Contact | None
    names: tuple[str, ...]

    def __init__(
        self,
        *parts: Part,
        supports: Sequence[Support | Joint] = (),
        joints: Sequence[Joint] = (),
        springs: Sequence[Spring] = (),
        loads: Sequence[Load] = (),
        obstacles: Sequence[Obstacle] = (),
        contact: Contact | None = None,
    ) -> None:
        """Put the parts together and check that all fits.

        Args:
            *parts: rods, bodies, point masses and parts with a Lagrangian of their own, at least one, with different
                names.
            supports: made by `supports.pin`, `supports.clamp`, `supports.hold`, `supports.slide`, ...
            joints: made by `joints.weld`, `joints.ball`, `joints.hinge`, ...
            springs: made by `springs.linear`, `springs.rotational`, `springs.bushing`.
            loads: made by `loads.gravity`, `loads.force`, ...
            obstacles: Plane, Sphere, Capsule, Cylinder, Box and Mesh, in space or on bodies.
            contact: a Contact, with which rods touch each other and themselves, too; with obstacles it need not be
                given.

        Raises:
            TypeError: something is not a part, a support, a joint, a spring, a load, an obstacle or a Contact.
            ValueError: no parts; one twice; two of one name; a support, a joint or a load on a part that is not among
                them; a joint whose sides do not meet, or one that says the same as another; a load that cannot move
                anything because all it acts on is held; a shape on a body, or a rod of the Contact, that is not among
                them; with contact, a rod without a round section or a radius.
        """
        for part in parts:
            if not isinstance(part, Part):
                hint = "; write Model(*parts)" if isinstance(part, (list, tuple)) else ""
                raise TypeError(f"Model: a part is a {type(part).__name__}, but must be a Rod or a Body{hint}")
        object.__setattr__(self, "parts", parts)
        object.__setattr__(self, "names", check.part_names(parts))
        wanted: dict[str, tuple[Any, Any, str]] = {
            "supports": (supports, (Support, Joint), "supports.pin(rod.start)"),
            "joints": (joints, (Joint,), "joints.weld(mast.end, arm.start)"),
            "springs": (springs, (Spring,), "springs.linear(rod.end, stiffness=10.0)"),
            "loads": (loads, (Gravity, PointLoad, LineLoad, RodLoad), "loads.gravity((0, 0, -9.81))"),
            "obstacles": (obstacles, (Obstacle,), "Plane()"),
        }
        for name, (given, kind, example) in wanted.items():
            object.__setattr__(self, name, check.members(name, given, kind, example))
        held: Any = self.supports
        object.__setattr__(self, "supports", tuple(support for support in held if isinstance(support, Support)))
        object.__setattr__(self, "guides", tuple(support for support in held if isinstance(support, Joint)))
        if contact is not None and not isinstance(contact, Contact):
            raise TypeError(f"Model: contact is a {type(contact).__name__}, but must be a Contact or None")
        object.__setattr__(self, "contact", Contact() if contact is None and self.obstacles else contact)
        self._check_membership()
        check_contact(self)
        connections = [(self.described(joint, short=True), joint) for joint in self.connections]
        for ties in (self.connections, self.springs):
            check.joint_names(ties)
        check.refuse_gaps(parts, connections)
        check.refuse_same(connections)
        for load in self.loads:
            if isinstance(load, PointLoad):
                self._refuse_idle(load)

    def __repr__(self) -> str:
        """The counts, in one line."""
        held = (*self.supports, *self.guides)
        counts = {"supports": held, "joints": self.joints, "springs": self.springs, "loads": self.loads}
        counts["obstacles"] = self.obstacles
        told = [f"{name}={len(found)}" for name, found in counts.items() if found or name in ("supports", "loads")]
        return f"Model({', '.join(self.names)}; {', '.join(told)})"

    def __str__(self) -> str:
        """A tree of parts, supports, joints, springs, loads and obstacles, with what looks odd at its end."""
        from cayley.model.tree import tree

        return "\n".join(tree(self))

    def _repr_html_(self) -> str:
        """The tree as a table, in a notebook."""
        from cayley.model.notebook import html_table
        from cayley.model.tree import tree

        title, *lines = tree(self)
        rows, heading = [], ""
        for line in lines:
            if line.startswith("    "):
                rows.append((heading, line.strip()))
            else:
                heading = line.strip()
        return html_table(title, rows)

    @property
    def rods(self) -> tuple[Rod, ...]:
        """The rods, in the order given."""
        return tuple(part for part in self.parts if isinstance(part, Rod))

    @property
    def bodies(self) -> tuple[Body | PointMass, ...]:
        """Rigid bodies and point masses, in the order given."""
        return tuple(part for part in self.parts if isinstance(part, (Body, PointMass)))

    @property
    def own_parts(self) -> tuple[LagrangianPart, ...]:
        """Parts with a Lagrangian of their own, in the order given."""
        return tuple(part for part in self.parts if isinstance(part, LagrangianPart))

    @property
    def mass(self) -> float:
        """The mass of all parts [kg], but for those with a Lagrangian of their own, which alone knows it."""
        return sum(part.mass for part in self.parts if not isinstance(part, LagrangianPart))

    @property
    def ties(self) -> tuple[Joint | Spring, ...]:
        """All joints and springs."""
        return (*self.connections, *self.springs)

    @property
    def connections(self) -> tuple[Joint, ...]:
        """All joints, guides first."""
        return (*self.guides, *self.joints)

    @property
    def connection_names(self) -> tuple[str, ...]:
        """Names of all joints, in the order of `connections`."""
        return check.joint_names(self.connections)

    @property
    def spring_names(self) -> tuple[str, ...]:
        """Names of the springs, in the order given."""
        return check.joint_names(self.springs)

    @property
    def obstacle_names(self) -> tuple[str, ...]:
        """Names of the obstacles, in the order given: their own, or plane, plane2, ..."""
        return check.obstacle_names(self.obstacles)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is legal but looks odd, a line each.

        Parts that nothing holds, that are connected to nothing and touch nothing; rods whose contact has one radius
        though theirs changes; closed meshes turned inside out.
        """
        odd = odd_contact(self)
        if self.contact is not None:
            return odd
        pairs = [tuple(port.part for port in tie.ports) for tie in self.ties]
        held = [support.port.part for support in self.supports]
        free = [self.names[k] for k in check.loose(self.parts, held, pairs)]
        return tuple(f"{name} is neither held nor connected to another part; it flies free" for name in free)

    def name_of(self, part: Part) -> str:
        """The name under which listings and results have a part.

        Raises:
            ValueError: the part is not in the model.
        """
        for other, name in zip(self.parts, self.names, strict=True):
            if other is part:
                return name
        raise ValueError(f"Model: {part!r} is not in the model; its parts are {', '.join(self.names)}")

    def described(self, tie: Joint | Spring, *, short: bool = False) -> str:
        """A joint or spring in one line, its ports called by the names of their parts; short: kind and ports only."""
        names = [port.called(self.name_of(port.part)) for port in tie.ports]
        sides = (names[0], names[1] if len(names) > 1 else str(tie.second))
        return tie.called(*sides) if short else tie.described(*sides)

    def held(self, port: Port) -> tuple[Mask, Mask]:
        """Which components of position and of rotation are held at a node, by all supports together.

        Returns: for position, along x, y, z in space; for rotation, about the body axes e1, e2, e3.
        """
        here = [
            support for support in self.supports if (support.port.part, support.port.node) == (port.part, port.node)
        ]
        return _union(support.held_position for support in here), _union(support.held_rotation for support in here)

    def replace(
        self,
        *,
        parts: Sequence[Part] | None = None,
        supports: Sequence[Support | Joint] | None = None,
        joints: Sequence[Joint] | None = None,
        springs: Sequence[Spring] | None = None,
        loads: Sequence[Load] | None = None,
        obstacles: Sequence[Obstacle] | None = None,
        contact: Contact | EllipsisType | None = ...,
    ) -> Model:
        """Another model in which what is given replaces what is here.

        Args:
            parts: instead of its parts; what is on parts that are gone must be replaced with them.
            supports: instead of its supports.
            joints: instead of its joints.
            springs: instead of its springs.
            loads: instead of its loads.
            obstacles: instead of its obstacles.
            contact: instead of its contact; None: no contact, unless there are obstacles.

        Raises:
            TypeError: as for Model.
            ValueError: as for Model.
        """
        return Model(
            *(self.parts if parts is None else parts),
            supports=(*self.supports, *self.guides) if supports is None else supports,
            joints=self.joints if joints is None else joints,
            springs=self.springs if springs is None else springs,
            loads=self.loads if loads is None else loads,
            obstacles=self.obstacles if obstacles is None else obstacles,
            contact=self.contact if isinstance(contact, EllipsisType) else contact,
        )

    def _check_membership(self) -> None:
        """Refuse what belongs to a part that is not in the model."""
        for support in self.supports:
            self._require(support.port.part, f"{support.kind} at {support.port}")
        for guide in self.guides:
            if not guide.grounded:
                raise ValueError(f"Model: {guide} is no support, for it connects two parts; give it among the joints")
        for tie in self.ties:
            for port in tie.ports:
                self._require(port.part, str(tie))
        for load in self.loads:
            if not isinstance(load, Gravity):
                self._require(load.part, str(load))

    def _require(self, part: Part, what: str) -> None:
        if not any(other is part for other in self.parts):
            has = ", ".join(self.names)
            raise ValueError(
                f"Model: {what} belongs to a {part.noun} that is not in the model; add it (the model has {has})"
            )

    def _refuse_idle(self, load: PointLoad) -> None:
        """Refuse a load that only pulls at a support: all components it can act on are held.

        Positions are held along space axes and rotations about body axes, so only a constant force in space and a
        constant moment in the body can be judged component by component; others only if all three are held.
        """
        position, rotation = self.held(load.port)
        if not load.port.at_node and load.kind == "force" and not all(rotation):
            return  # it turns the node, whatever is held of its position
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


def _union(masks: Iterable[Mask]) -> Mask:
    x = y = z = False
    for mask in masks:
        x, y, z = x or mask[0], y or mask[1], z or mask[2]
    return (x, y, z)
