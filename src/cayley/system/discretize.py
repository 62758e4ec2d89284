"""From a Model to a compiled system: chains of nodes, constants, supports and loads as arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cayley.codegen.kernels import Kernels, lanes_for
from cayley.density import Density, trace
from cayley.density.lagrangian import Lagrangian
from cayley.discrete.equations import derive
from cayley.discrete.layout import Layout
from cayley.discrete.places import name_at, placed, plain
from cayley.discrete.representation import REPRESENTATIONS
from cayley.discrete.rules import Rule
from cayley.model import LagrangianPart, Model, Part, PointMass, Rod
from cayley.model.loads import Gravity, LineLoad, PointLoad
from cayley.system.body_arrays import body_arrays
from cayley.system.compile import uniform_values
from cayley.system.connect import connect
from cayley.system.contact_arrays import touching
from cayley.system.couplings import Coupling
from cayley.system.groups import KINEMATICS, Group, groups_of
from cayley.system.mixed import mixed
from cayley.system.own_arrays import own_arrays
from cayley.system.redundancy import redundant
from cayley.system.rod_arrays import STRAIN_CONSTANTS, PartArrays, rod_arrays
from cayley.system.rod_forces import with_forces
from cayley.system.system import LoadEntries, System
from cayley.system.tables import time_table
from cayley.system.turned import as_quaternions


def discretize(model: Model, rule: Rule, *, rotation: str = "quaternion", account: bool = False) -> System:
    """Compile the equations of a model.

    Parts of one density run in one sweep, a chain of nodes each, of one node a body; constants that differ become
    arrays. Rods of another kinematics and parts with a Lagrangian of their own have densities of theirs, members of the
    system.

    Args:
        model: the model.
        rule: quadrature rule.
        rotation: "quaternion" or "matrix".
        account: keep account of the work of loads; it is kept anyway where there are forces beside the Lagrangian.

    Returns: the System; its nodes are those of the parts, one part after the other, density by density.

    Raises:
        ValueError: joints or several densities with matrices, a Lagrangian that does not work, or redundant constraints
            of joints.
    """
    gravity = sum(
        (np.asarray(load.acceleration) for load in model.loads if isinstance(load, Gravity)), start=np.zeros(3)
    )
    drafts = [_draft(group, model, rule, gravity) for group in groups_of(model)]
    cells = sum((part.size - 1) // rule.cell + 1 for draft in drafts for part in draft.parts)
    lanes = lanes_for(rule.cell, cells)
    # explicit rules take two sweeps a step for all or for none
    forced = account or (len(drafts) > 1 and any(draft.density.force is not None for draft in drafts))
    members = [_member(draft, rule, rotation, lanes, account=forced) for draft in drafts]
    whole = members[0] if len(members) == 1 else mixed(members)
    layout, free = whole.layout, _free(model, whole.layout, rule.degree)
    if whole.members:
        _check_form(layout, "parts of several densities")
        owned = [replace(member, free=free[nodes]) for member, nodes in whole.spans]
        whole = replace(whole, members=tuple(owned))
    joints, springs = connect(model, first_nodes(model, rule.degree), rule.degree)
    if joints or springs:
        _check_joints(layout, whole.reference, free, joints)
    loads = _loads(model, layout, whole.named["weight"], rule.degree)
    contact = touching(model, spans(model, rule.degree), whole.reference, layout) if model.contact else None
    if contact is not None:
        _check_form(layout, "contact")
    return replace(whole, free=free, loads=loads, joints=joints, springs=springs, contact=contact, account=account)


@dataclass(frozen=True, slots=True)
class _Draft:
    """A group of parts on the way to its system."""

    density: Density
    parts: list[PartArrays]
    entries: dict[str, np.ndarray]
    named: dict[str, np.ndarray]


def _draft(group: Group, model: Model, rule: Rule, gravity: np.ndarray) -> _Draft:
    """Trace the density of a group with the forces on its parts, its constants as arrays."""
    lagrangian, forces = with_forces(group.lagrangian, model, group.parts, group.constrained)
    parts = _arrays(group.parts, rule, gravity)
    constants = _joined(parts) | _forced(forces, parts)
    patterns = {name: _pattern(constants, name) for name in constants if name == plain(name)}
    density = _traced(lagrangian, patterns)
    entries = {name: _entry(constants, name) for name in density.names}
    entries |= _within(constants, entries, rule)
    named = {name: np.concatenate([part.named[name] for part in parts]) for name in parts[0].named}
    entries["inverse"] = named.pop("inverse")
    return _Draft(density, parts, entries, named)


_TRACED: dict[tuple[Any, ...], Density] = {}
"""Densities of the library that this process has traced, by what of the constants goes into expressions."""


def _traced(lagrangian: Lagrangian, constants: Mapping[str, np.ndarray]) -> Density:
    """Trace a Lagrangian; one of the library once for all constants that are zero and symmetric in the same places."""
    if all(lagrangian is not known for known in KINEMATICS.values()):
        return trace(lagrangian, constants)
    kinds = ((n, v.shape, (v != 0.0).tobytes(), v.ndim == 2 and np.array_equal(v, v.T)) for n, v in constants.items())
    key = (lagrangian.name, *kinds)
    if key not in _TRACED:
        _TRACED[key] = trace(lagrangian, constants)
    found = _TRACED[key]
    at_node = {name: value[None] for name, value in constants.items()}
    return replace(found, values=np.array([_entry(at_node, label)[0] for label in found.names], dtype=float))


def _arrays(parts: Sequence[Part], rule: Rule, gravity: np.ndarray) -> list[PartArrays]:
    rods = {id(part): rod_arrays(part, rule, gravity) for part in parts if isinstance(part, Rod)}
    beside = next(iter(rods.values()), None)

    def arrays(part: Part) -> PartArrays:
        if isinstance(part, Rod):
            return rods[id(part)]
        return own_arrays(part, rule) if isinstance(part, LagrangianPart) else body_arrays(part, gravity, beside)  # type: ignore[arg-type]

    return [arrays(part) for part in parts]


def _member(draft: _Draft, rule: Rule, rotation: str, lanes: int, *, account: bool) -> System:
    """The system of a group, without supports and ties."""
    entries, parts = draft.entries, draft.parts
    within = {plain(name) for name in placed(entries)}
    varying = [n for n, values in entries.items() if plain(n) in within or np.any(values != values[0])]
    equations = derive(draft.density, rule, rotation=rotation, varying=varying, account=account)
    layout = equations.layout
    reference = np.zeros((sum(part.size for part in parts), layout.rows))
    reference[:, layout.rows_of("x")] = np.concatenate([part.position for part in parts])
    turned = np.concatenate([part.rotation for part in parts])
    reference[:, layout.rows_of("p")] = layout.representation.from_quaternion(turned)
    first = {name: float(values[0]) for name, values in entries.items()}
    return System(
        equations=equations,
        kernels=Kernels(equations, lanes),
        uniforms=uniform_values(equations, first),
        named=draft.named | {name: entries[name] for name in varying},
        free=np.ones((len(reference), layout.dofs), dtype=bool),
        chains=tuple(part.size for part in parts),
        reference=reference,
        account=account,
    )


def spans(model: Model, degree: int) -> list[slice]:
    """Nodes of each part among all nodes, with degree − 1 nodes inside every element; group follows group."""
    found, first = {}, 0
    for part in (part for group in groups_of(model) for part in group.parts):
        count = (part.node_count - 1) * degree + 1
        found[id(part)] = slice(first, first + count)
        first += count
    return [found[id(part)] for part in model.parts]


def first_nodes(model: Model, degree: int) -> dict[int, int]:
    """First node of each part, by its id."""
    return {id(part): nodes.start for part, nodes in zip(model.parts, spans(model, degree), strict=True)}


def _check_joints(layout: Layout, reference: np.ndarray, free: np.ndarray, joints: Sequence[Coupling]) -> None:
    """Refuse constraints that follow from others."""
    form = Layout(layout.fields, REPRESENTATIONS["quaternion"])
    lines = redundant(form, as_quaternions(layout, reference), free, joints)
    if lines:
        raise ValueError(
            f"Model: {len(lines)} joint{'s are' if len(lines) > 1 else ' is'} redundant at the start, so their forces "
            f"are not unique ({'; '.join(lines)}); hold less, such as by a ball instead of a hinge"
        )


def _check_form(layout: Layout, what: str) -> None:
    if layout.representation.name != "quaternion":
        raise ValueError(f"Model: {what} want rotation='quaternion'; leave rotation out")


def initial_values(model: Model, system: System, initial: Mapping[Any, Mapping[str, Any]]) -> tuple[np.ndarray, ...]:
    """Values, velocities and momenta at the start.

    Args:
        model: the model.
        system: its system.
        initial: part or its name -> {"position", "rotation", "velocity", "angular_velocity", "momentum",
            "angular_momentum"}; arrays that broadcast to (nodes, 3) (rotation: (nodes, 4)), or functions of s. Momenta
            are per length [kg/s, kg m/s], of a body as they are [kg m/s, kg m²/s], the angular ones, like angular
            velocities, in the body frame.

    Returns: values (nodes, rows), velocities (nodes, dofs), nodal momenta (nodes, dofs) with NaN where not given.

    Raises:
        ValueError: for an unknown part or key, a wrong shape, or a quantity given twice.
    """
    layout = system.layout
    values = system.reference.copy()
    velocity = np.zeros((system.size, layout.dofs))
    momenta = np.full((system.size, layout.dofs), np.nan)
    among = spans(model, system.equations.rule.degree)
    by_name = dict(zip(model.names, among, strict=True))
    for key, given in initial.items():
        name = model.name_of(key) if isinstance(key, Part) else key
        if name not in by_name:
            raise ValueError(f"initial: {key!r} is no part of the model; its parts are {', '.join(by_name)}")
        nodes = by_name[name]
        for quantity, value in given.items():
            where = f"initial[{name!r}][{quantity!r}]"
            array = _nodal(value, system.nodes[nodes], 4 if quantity == "rotation" else 3, where)
            if quantity == "position":
                values[nodes, layout.rows_of("x")] = array
            elif quantity == "rotation":
                length = np.linalg.norm(array, axis=1, keepdims=True)
                worst = float(length.flat[np.argmax(np.abs(length - 1.0))])
                if abs(worst - 1.0) > 1e-6:
                    raise ValueError(f"{where}: quaternions must have length 1, one has {worst:.6g}")
                values[nodes, layout.rows_of("p")] = layout.representation.from_quaternion(array / length)
            elif quantity in ("velocity", "angular_velocity"):
                velocity[nodes, layout.dofs_of("x" if quantity == "velocity" else "p")] = array
            elif quantity in ("momentum", "angular_momentum"):
                dofs = layout.dofs_of("x" if quantity == "momentum" else "p")
                momenta[nodes, dofs] = array * system.named["weight"][nodes, None]
            else:
                allowed = "position, rotation, velocity, angular_velocity, momentum, angular_momentum"
                raise ValueError(f"{where} is unknown; give {allowed}")
        for both in (("velocity", "momentum"), ("angular_velocity", "angular_momentum")):
            if all(k in given for k in both):
                raise ValueError(f"initial[{name!r}] gives both {both[0]} and {both[1]}; give one")
    return values, velocity, momenta


def _nodal(value: Any, nodes: np.ndarray, width: int, where: str) -> np.ndarray:
    given = np.array([value(float(s)) for s in nodes]) if callable(value) else value
    try:
        array = np.broadcast_to(np.asarray(given, dtype=float), (len(nodes), width))
    except (TypeError, ValueError):
        raise ValueError(f"{where} has shape {np.shape(given)}; give ({len(nodes)}, {width}) or ({width},)") from None
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{where} has an entry that is not finite")
    return array


def _joined(parts: Sequence[PartArrays]) -> dict[str, np.ndarray]:
    """Constants of all nodes; a part without values of its own at a place of an element has those of place 0 there."""
    names = dict.fromkeys(name for part in parts for name in part.constants)
    return {
        name: np.concatenate([part.constants.get(name, part.constants[plain(name)]) for part in parts])
        for name in names
    }


def _forced(forces: Sequence[Mapping[str, np.ndarray]], parts: Sequence[PartArrays]) -> dict[str, np.ndarray]:
    """Constants of damping and of loads along rods, the same at all nodes of a part."""
    pairs = list(zip(forces, parts, strict=True))
    names = forces[0] if forces else {}
    return {
        name: np.concatenate([np.broadcast_to(own[name], (part.size, *np.shape(own[name]))) for own, part in pairs])
        for name in names
    }


def _pattern(constants: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """A constant that is equal everywhere; of another, values that are zero only where all are."""
    values = np.concatenate([own for other, own in constants.items() if plain(other) == name])
    return values[0] if np.all(values == values[0]) else np.abs(values).max(axis=0)


def _within(
    constants: Mapping[str, np.ndarray], entries: Mapping[str, np.ndarray], rule: Rule
) -> dict[str, np.ndarray]:
    """Entries that differ within an element, by their names at each place (see discrete.places)."""
    found = {}
    for label, values in entries.items():
        constant, _, index = label.removeprefix("c.").partition("[")
        for k in range(1, len(rule.strain.at) if constant in STRAIN_CONSTANTS else rule.cell):
            key = name_at(constant, k)
            own = _entry(constants, f"c.{key}[{index}") if key in constants else values
            if np.any(own != values):
                found[name_at(label, k)] = own
    return found


def _entry(constants: Mapping[str, np.ndarray], label: str) -> np.ndarray:
    """The numbers behind a label such as 'c.stiffness[0,1]', shape (nodes,)."""
    name, _, index = label.removeprefix("c.").rstrip("]").partition("[")
    place: Any = (slice(None), *(int(i) for i in index.split(",") if i))
    return constants[name][place]


def _free(model: Model, layout: Layout, degree: int) -> np.ndarray:
    among = spans(model, degree)
    free = np.ones((max(nodes.stop for nodes in among), layout.dofs), dtype=bool)
    starts = first_nodes(model, degree)
    for part, nodes in zip(model.parts, among, strict=True):
        if isinstance(part, PointMass):
            free[nodes, layout.dofs_of("p")] = False
        elif isinstance(part, LagrangianPart):
            for name, held in zip(("x", "p"), part.held, strict=True):
                if held:
                    free[nodes, layout.dofs_of(name)] = False
    for support in model.supports:
        node = starts[id(support.port.part)] + support.port.node * degree
        free[node, layout.dofs_of("x")] &= ~np.array(support.held_position)
        free[node, layout.dofs_of("p")] &= ~np.array(support.held_rotation)
    return free


def _loads(model: Model, layout: Layout, weight: np.ndarray, degree: int) -> LoadEntries | None:
    timed = [load for load in model.loads if isinstance(load, PointLoad | LineLoad)]
    if not timed:
        return None
    by_part = {id(part): nodes for part, nodes in zip(model.parts, spans(model, degree), strict=True)}
    rows: list[tuple[int, int, int, int, int, float]] = []
    levers: list[tuple[float, float, float]] = []
    for k, load in enumerate(timed):
        moment = load.kind == "moment"
        dof = layout.dofs_of("p" if moment else "x").start
        form = {(True, "body"): 0, (True, "space"): 1, (False, "space"): 0, (False, "body"): 2}[(moment, load.frame)]
        nodes = by_part[id(load.part)]
        turn = layout.rows_of("p").start
        if isinstance(load, PointLoad):
            node = nodes.start + load.port.node * degree
            rows.append((node, dof, turn, form, 3 * k, 1.0))
            if not moment and not load.port.at_node:  # its moment o × Λᵀ F about the node
                levers += [_NO_LEVER] * (len(rows) - len(levers)) + [load.port.shift]
                rows.append((node, layout.dofs_of("p").start, turn, int(load.frame == "space"), 3 * k, 1.0))
        else:
            rows += [(n, dof, turn, form, 3 * k, float(weight[n])) for n in range(nodes.start, nodes.stop)]
    levers += [_NO_LEVER] * (len(rows) - len(levers))
    columns = [np.array(column) for column in zip(*rows, strict=True)] + [np.array(levers)]
    return LoadEntries(time_table(timed), 3 * len(timed), *columns)


_NO_LEVER = (0.0, 0.0, 0.0)


__all__ = ["discretize", "first_nodes", "initial_values", "spans"]
