"""The scene of a run: its rods and bodies with what can color them, joints, supports, springs, and graphs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from cayley.discrete.rules import by_name
from cayley.lie import quaternion
from cayley.model import Body, LagrangianPart, Model, Plane, PointMass, Rod
from cayley.model.loads import Gravity
from cayley.model.port import Port
from cayley.model.skins import skin
from cayley.model.stations import Stations
from cayley.report.bodies import box_sides
from cayley.report.conserved import Array, load_free, saved_parts
from cayley.report.own_stage import THIN, field_graphs, field_parts
from cayley.report.scene import BYTES, Block, Flat, Graph, Link, Mark, Place, Quantity, Scene, Skin, Strand
from cayley.results.body import motion, node_of

_SPACE = ("x", "y", "z")
_VECTORS = {  # of a rod: label and unit
    "moment": ("moment", "N m"),
    "force": ("force", "N"),
    "curvature": ("curvature", "1/m"),
    "strain": ("strain", "1"),
}
_RATES = {"velocity": ("speed", "speed", "m/s"), "angular_velocity": ("spin", "angular speed", "rad/s")}


def scene(run: Any, *, stride: int | None = None, name: str = "", graphs: bool = True) -> Scene:
    """The scene of a run.

    Args:
        run: a Trajectory.
        stride: every which saved frame is shown; by default as many as fit into BYTES.
        name: of the scene.
        graphs: whether energies and momenta are plotted.
    """
    every = default_stride(run) if stride is None else stride
    frames = slice(None, None, every)
    model, time = run.model, run.time[frames]
    window = load_free(run)
    loaded = window.free and not window.frames.all()
    return Scene(
        name=name,
        time=time,
        parts=tuple(field_parts(run, frames) if model is None else _parts(run, frames)),
        marks=() if model is None else tuple(_marks(run)),
        links=() if model is None else tuple(_links(run)),
        solids=() if model is None else tuple(_solids(model)),
        graphs=tuple(_graphs(run, frames)) if graphs else (),
        up=(0, 0, 1) if model is None else upward(model),
        shade=(float(run.time[0]), float(run.time[window.frames][0])) if loaded else None,
        note=" ".join(_notes(run, every)),
    )


def _notes(run: Any, every: int) -> Iterator[str]:
    if every > 1:
        yield f"One in {every} of {len(run.time)} saved frames is shown."
    if run.only is not None:
        yield "What was not saved (save_only) is not shown."


def default_stride(run: Any) -> int:
    """Every which frame is shown so that a scene is not too large."""
    # a node has 4 * 3 bytes of position, 2 * 4 of rotation, 2 * 3 of each vector, 2 of each number
    node = 12 + 8 + 6 * len(_VECTORS) + 2 * (len(_RATES) + 1)
    return max(1, -(-len(run.time) * node * int(run.frames.values.shape[1]) // BYTES))


def upward(model: Model) -> tuple[int, int, int]:
    """The axis that is against gravity, or z."""
    gravity = sum((np.array(load.acceleration) for load in model.loads if isinstance(load, Gravity)), start=np.zeros(3))
    k = int(np.abs(gravity).argmax())
    if gravity[k] == 0.0:
        return (0, 0, 1)
    x, y, z = (int(-np.sign(gravity[k])) * (i == k) for i in range(3))
    return (x, y, z)


def _parts(run: Any, frames: slice) -> Iterator[Strand | Block]:
    for name in saved_parts(run):
        part, data = run._part(name), run[name].isel(time=frames)
        if isinstance(part, Rod):
            yield _strand(run, part, name, data, frames)
        elif part.node_count > 1:
            yield _thread(part, name, data)
        else:
            shaped = any(obstacle.on is part for obstacle in run.model.obstacles)
            yield replace(_block(part, name, data), shaped=shaped)
    yield from _points(run, frames)


def _points(run: Any, frames: slice) -> Iterator[Block]:
    """Nodes that were saved without the others of their parts."""
    whole = {node for name in saved_parts(run) for node in range(run.spans[name].start, run.spans[name].stop)}
    for node in () if run.only is None else run.only.tolist():
        if node in whole:
            continue
        name = next(name for name, span in run.spans.items() if span.start <= node < span.stop)
        k = (node - run.spans[name].start) // by_name(run.rule).degree
        x, p, v, turning = (one[frames] for one in motion(run, run.index_of(node)))
        yield Block(
            name=f"{name}.{run._part(name).node_name(k)}",
            position=x[:, None],
            rotation=p[:, None],
            quantities={
                key: Quantity(label=label, unit=unit, values=np.linalg.norm(rate, axis=-1)[:, None])
                for rate, (key, label, unit) in zip((v, turning), _RATES.values(), strict=True)
            },
        )


def _strand(run: Any, rod: Rod, name: str, data: Any, frames: slice) -> Strand:
    nodes, s = run._parts[name], data["s"].values
    quantities = {
        key: Quantity(label=label, unit=unit, values=_at_nodes(data[key])) for key, (label, unit) in _VECTORS.items()
    }
    quantities |= _speeds(data, lambda sizes: sizes)
    energy = 0.5 * np.sum(run.frames.momenta[frames, nodes] * run.observed.velocity[frames, nodes], axis=-1)
    ends = np.concatenate([s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]])
    quantities["kinetic"] = Quantity(label="kinetic energy per length", unit="J/m", values=energy / np.diff(ends))
    return Strand(
        name=name,
        position=data["position"].values,
        rotation=data["rotation"].values,
        outlines=node_outlines(rod, by_name(run.rule).degree),
        s=s - s[0],
        quantities=quantities,
    )


def _thread(part: LagrangianPart, name: str, data: Any) -> Strand:
    """A chain of one's own: its Lagrangian says nothing of a cross-section, so it is drawn thin."""
    s = data["s"].values - data["s"].values[0]
    thin = THIN * s[-1] * np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
    return Strand(
        name=name,
        position=data["position"].values,
        rotation=data["rotation"].values,
        outlines=thin[None],
        s=s,
        quantities=_speeds(data, lambda sizes: sizes),
    )


def _speeds(data: Any, shaped: Callable[[Array], Array]) -> dict[str, Quantity]:
    """Speed and angular speed, from an array over the time to one over time and nodes."""
    return {
        key: Quantity(label=label, unit=unit, values=shaped(np.linalg.norm(data[rate].values, axis=-1)))
        for rate, (key, label, unit) in _RATES.items()
    }


def _at_nodes(values: Any) -> Array:
    """Values at the nodes; of those of elements the mean of the two beside a node, at an end that of the one."""
    found: Array = values.values
    if "element" not in values.dims:
        return found
    ends = (found[:, :1], 0.5 * (found[:, 1:] + found[:, :-1]), found[:, -1:])
    return np.concatenate(ends, axis=1)


def node_outlines(rod: Rod, degree: int = 1) -> Array:
    """Outlines of the cross-sections [m], shape (1, k, 2) if they are the same everywhere, else at each node."""
    section = rod.stations
    if not isinstance(section, Stations):
        return section.outline[None]
    places = np.linspace(0.0, 1.0, degree + 1)
    each = section.at("outline", places)
    starts, stops = each[:, :-1], each[:, 1:]
    inner = starts.reshape(-1, *each.shape[2:])
    joined = np.concatenate([inner, stops[-1:, -1]])
    joined[degree:-1:degree] = 0.5 * (each[1:, 0] + each[:-1, -1])  # sections that jump from element to element
    return joined


def _block(part: Body | PointMass | LagrangianPart, name: str, data: Any) -> Block:
    """A body as the box of its inertia; of a point mass, or what has a Lagrangian of its own, nobody knows a shape."""
    common = dict(
        name=name,
        position=data["position"].values[:, None],
        rotation=data["rotation"].values[:, None],
        quantities=_speeds(data, lambda sizes: sizes[:, None]),
    )
    if isinstance(part, PointMass):
        return Block(**common)
    ports = {port: tuple(np.asarray(shift).tolist()) for port, (shift, _) in part.ports.items()}
    if isinstance(part, LagrangianPart):
        return Block(**common, ports=ports)
    sides, axes = box_sides(part)
    axes = axes * np.sign(np.linalg.det(axes))  # eigenvectors may be left-handed
    return Block(
        **common,
        sides=sides,
        turn=tuple(quaternion.from_matrix(axes).tolist()),
        ports=ports,
    )


def _place(run: Any, port: Any) -> Place:
    """Where a port is, or a point of the ground."""
    if not isinstance(port, Port):
        return Place(part=None, shift=tuple(port.position))
    name = run.model.name_of(port.part)
    return Place(
        part=saved_parts(run).index(name), node=node_of(run, port) - int(run._parts[name].start), shift=port.shift
    )


def _shown(run: Any, *places: Any) -> bool:
    """Whether the parts of places were saved."""
    return all(not isinstance(one, Port) or run.model.name_of(one.part) in saved_parts(run) for one in places)


def _marks(run: Any) -> Iterator[Mark]:
    model = run.model
    for support in model.supports:
        where = support.port.called(model.name_of(support.port.part))
        if _shown(run, support.port):
            yield Mark(kind="support", name=f"{support.kind} at {where}", place=_place(run, support.port))
    for joint in model.connections:
        sides = [one for one in (joint.first, joint.second) if isinstance(one, Port) and _shown(run, one)]
        if sides:
            yield Mark(kind="joint", name=model.described(joint, short=True), place=_place(run, sides[0]))


def _links(run: Any) -> Iterator[Link]:
    """Springs of two points that are not the same at the start."""
    for spring in run.model.springs:
        if spring.distance > 0.0 and _shown(run, spring.first, spring.second):
            name = run.model.described(spring, short=True)
            yield Link(name=name, first=_place(run, spring.first), second=_place(run, spring.second))


def _solids(model: Model) -> Iterator[Skin | Flat]:
    """The surfaces of all obstacles."""
    for obstacle, name in zip(model.obstacles, model.obstacle_names, strict=True):
        part = next((k for k, own in enumerate(model.parts) if own is obstacle.on), None)
        if isinstance(obstacle, Plane):
            yield Flat(name=name, part=part, point=obstacle.point, normal=obstacle.normal)
            continue
        mesh = skin(obstacle)
        sheer = mesh.closed and mesh.volume < 0.0
        yield Skin(name=name, part=part, vertices=mesh.vertices, triangles=mesh.triangles, sheer=sheer)


def _graphs(run: Any, frames: slice) -> Iterator[Graph]:
    def columns(*series: Any) -> Array:
        return np.column_stack([one.values for one in series])[frames]

    energies = columns(run.kinetic_energy, run.potential_energy, run.energy)
    yield Graph(title="Energy", unit="J", names=("kinetic", "potential", "total"), values=energies)
    if run.model is None:
        yield from field_graphs(run, frames)
    sums = (
        ()
        if run.only is not None
        else (
            ("Linear momentum", "kg m/s", run.linear_momentum),
            ("Angular momentum about the origin", "kg m²/s", run.angular_momentum),
        )
    )
    for title, unit, series in sums:
        yield Graph(title=title, unit=unit, names=_SPACE, values=series.transpose("time", "axis").values[frames])
    if run.accounted:
        balance = run.energy_balance
        values = columns(balance.energy - balance.energy[0], balance.work, balance.dissipated, balance.defect)
        names = ("change of energy", "work", "dissipated", "defect")
        yield Graph(title="Energy balance", unit="J", names=names, values=values)
