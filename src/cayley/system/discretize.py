"""From a Model to a compiled system: chains of nodes, constants, supports and loads as arrays."""

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cayley.codegen.kernels import Kernels, lanes_for
from cayley.density import library, trace
from cayley.discrete.equations import derive
from cayley.discrete.layout import Layout
from cayley.discrete.rules import Rule
from cayley.model import Model, Rod
from cayley.model.loads import Gravity, LineLoad, PointLoad
from cayley.system.compile import chain_arrays, chain_nodes, uniform_values
from cayley.system.rod_forces import with_forces
from cayley.system.system import LoadEntries, System
from cayley.system.tables import time_table


def discretize(model: Model, rule: Rule, *, rotation: str = "quaternion", account: bool = False) -> System:
    """Compile the equations of a model.

    All rods run in one sweep, a chain of nodes each; constants that differ between rods become arrays.

    Args:
        model: the model.
        rule: quadrature rule.
        rotation: "quaternion" or "matrix".
        account: keep account of the work of loads; it is kept anyway where there are forces beside the Lagrangian.

    Returns: the System; its nodes are those of the rods, one rod after the other.
    """
    rods = model.rods
    library_density, constrained = _KINEMATICS[_one_kinematics(rods)]
    gravity = sum(
        (np.asarray(load.acceleration) for load in model.loads if isinstance(load, Gravity)), start=np.zeros(3)
    )
    lagrangian, forces = with_forces(library_density, model, constrained)
    constants = [_rod_constants(rod, gravity) | own for rod, own in zip(rods, forces, strict=True)]
    pattern = {name: _union([c[name] for c in constants]) for name in constants[0]}
    density = trace(lagrangian, pattern)
    entries = {name: np.array([_entry(c, name) for c in constants]) for name in density.names}
    inverse = np.array([1.0 / rod.element_length for rod in rods])
    varying = [name for name, values in entries.items() if np.any(values != values[0])]
    varying += ["inverse"] if np.any(inverse != inverse[0]) else []
    equations = derive(density, rule, rotation=rotation, varying=varying, account=account)
    places = [chain_nodes(np.asarray(rod.nodes), rule.degree) for rod in rods]
    counts = [len(place) for place in places]
    chains = [chain_arrays(place, rule.degree) for place in places]
    named = {name: np.concatenate([chain[name] for chain in chains]) for name in chains[0]}
    named |= {name: np.repeat(entries[name] if name != "inverse" else inverse, counts) for name in varying}
    layout = equations.layout
    reference = np.zeros((sum(counts), layout.rows))
    for rod, place, nodes in zip(rods, places, spans(model, rule.degree), strict=True):
        reference[nodes, layout.rows_of("x")] = np.array(rod.origin) + np.outer(place, rod.direction)
        reference[nodes, layout.rows_of("p")] = layout.representation.from_quaternion(np.asarray(rod.rotation))
    first = {name: float(values[0]) for name, values in entries.items()} | {"inverse": float(inverse[0])}
    return System(
        equations=equations,
        kernels=Kernels(equations, lanes_for(rule.cell, sum((count - 1) // rule.cell + 1 for count in counts))),
        uniforms=uniform_values(equations, first),
        named=named,
        free=_free(model, layout, rule.degree),
        chains=tuple(counts),
        loads=_loads(model, layout, named["weight"], rule.degree),
        reference=reference,
    )


def spans(model: Model, degree: int) -> list[slice]:
    """Nodes of each rod among all nodes, with degree nodes more in every element."""
    edges = np.cumsum([0, *[rod.elements * degree + 1 for rod in model.rods]])
    return [slice(int(a), int(b)) for a, b in itertools.pairwise(edges)]


def initial_values(model: Model, system: System, initial: Mapping[Any, Mapping[str, Any]]) -> tuple[np.ndarray, ...]:
    """Values, velocities and momenta at the start.

    Args:
        model: the model.
        system: its system.
        initial: rod or its name -> {"position", "rotation", "velocity", "angular_velocity", "momentum",
            "angular_momentum"}; arrays that broadcast to (nodes, 3) (rotation: (nodes, 4)), or functions of s. Momenta
            are per length [kg/s, kg m/s], the angular ones, like angular velocities, in the body frame.

    Returns: values (nodes, rows), velocities (nodes, dofs), nodal momenta (nodes, dofs) with NaN where not given.

    Raises:
        ValueError: for an unknown rod or key, a wrong shape, or a quantity given twice.
    """
    layout = system.layout
    values = system.reference.copy()
    velocity = np.zeros((system.size, layout.dofs))
    momenta = np.full((system.size, layout.dofs), np.nan)
    among = spans(model, system.equations.rule.degree)
    by_name = dict(zip(model.names, among, strict=True))
    for key, given in initial.items():
        name = model.name_of(key) if isinstance(key, Rod) else key
        if name not in by_name:
            raise ValueError(f"initial: {key!r} is no rod of the model; its rods are {', '.join(by_name)}")
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


_KINEMATICS = {
    "shearable": (library.rod, 0),
    "unshearable": (library.unshearable_rod, 2),
    "inextensible": (library.inextensible_rod, 3),
}
"""The density of each kinematics, and how many of the six strains are constrained, the first ones."""


def _one_kinematics(rods: Sequence[Rod]) -> str:
    """The kinematics of all rods.

    Raises:
        ValueError: if they differ; a model is stepped by one set of kernels.
    """
    found = sorted({rod.kinematics for rod in rods})
    if len(found) > 1:
        raise ValueError(f"Model: its rods are {' and '.join(found)}; give all rods of one model the same kinematics")
    return found[0]


def _rod_constants(rod: Rod, gravity: np.ndarray) -> dict[str, np.ndarray]:
    section = rod.section
    constrained = _KINEMATICS[rod.kinematics][1]
    return {
        "mass": np.asarray(section.mass_per_length, dtype=float),
        "inertia": np.asarray(section.inertia, dtype=float),
        "stiffness": np.asarray(section.stiffness, dtype=float)[constrained:, constrained:],
        "gravity": gravity,
    }


def _union(arrays: list[np.ndarray]) -> np.ndarray:
    """Non-zero where any is; of equal arrays, the array itself."""
    return arrays[0] if all(np.array_equal(a, arrays[0]) for a in arrays) else sum(np.abs(a) for a in arrays)


def _entry(constants: Mapping[str, np.ndarray], label: str) -> float:
    """The number behind a label such as 'c.stiffness[0,1]'."""
    name, _, index = label.removeprefix("c.").rstrip("]").partition("[")
    return float(constants[name][tuple(int(i) for i in index.split(",") if i)])


def _free(model: Model, layout: Layout, degree: int) -> np.ndarray:
    among = spans(model, degree)
    free = np.ones((among[-1].stop, layout.dofs), dtype=bool)
    starts = {id(rod): nodes.start for rod, nodes in zip(model.rods, among, strict=True)}
    for support in model.supports:
        node = starts[id(support.port.part)] + support.port.node * degree
        free[node, layout.dofs_of("x")] &= ~np.array(support.held_position)
        free[node, layout.dofs_of("p")] &= ~np.array(support.held_rotation)
    return free


def _loads(model: Model, layout: Layout, weight: np.ndarray, degree: int) -> LoadEntries | None:
    timed = [load for load in model.loads if isinstance(load, PointLoad | LineLoad)]
    if not timed:
        return None
    by_rod = {id(rod): nodes for rod, nodes in zip(model.rods, spans(model, degree), strict=True)}
    rows: list[tuple[int, int, int, int, int, float]] = []
    for k, load in enumerate(timed):
        moment = load.kind == "moment"
        dof = layout.dofs_of("p" if moment else "x").start
        form = {(True, "body"): 0, (True, "space"): 1, (False, "space"): 0, (False, "body"): 2}[(moment, load.frame)]
        nodes = by_rod[id(load.part)]
        turn = layout.rows_of("p").start
        if isinstance(load, PointLoad):
            rows.append((nodes.start + load.port.node * degree, dof, turn, form, 3 * k, 1.0))
        else:
            rows += [(n, dof, turn, form, 3 * k, float(weight[n])) for n in range(nodes.start, nodes.stop)]
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    return LoadEntries(time_table(timed), 3 * len(timed), *columns)


__all__ = ["discretize", "initial_values", "spans"]
