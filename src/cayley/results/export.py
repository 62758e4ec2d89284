"""A run for other programs: CSV tables, one netCDF file, or ParaView files."""

import csv
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.lie import quaternion
from cayley.model import Obstacle, Plane, Rod, Section
from cayley.model.skins import patch, skin
from cayley.results.trajectory import Trajectory

if TYPE_CHECKING:
    import xarray as xr

ROUND = 24
"""Points around a section without an outline of its own: a circle."""
NODAL = ("velocity", "angular_velocity", "force", "moment")
"""What ParaView files have at every point of a rod."""


def export(run: Trajectory, kind: str, target: str | Path) -> list[Path]:
    """Write a run for other programs.

    Args:
        run: the run, of a model.
        kind: "csv": a table for each part, a row for each time (and node) with all its fields; "netcdf": one file with
            a group for each part, and energies and momenta; "vtk": for ParaView, tubes with their true sections,
            and force, moment, velocity, angular velocity, radius and frame at their points, a time series (.pvd);
            obstacles, too.
        target: a folder (csv, vtk), or the file (netcdf; NAME.nc).

    Returns: the files to open.

    Raises:
        ValueError: the kind is unknown, the run is of no model, or the extra "export" is not installed.
    """
    writers: dict[str, Callable[[Trajectory, Path], list[Path]]] = {"csv": _csv, "netcdf": _netcdf, "vtk": _vtk}
    if kind not in writers:
        raise ValueError(f"kind is {kind!r}; give one of {', '.join(writers)}")
    if run.model is None:
        raise ValueError("a run of a Lagrangian of your own has no parts to export; use run.data, an xarray.Dataset")
    return writers[kind](run, Path(target))


def _summary(run: Trajectory) -> "xr.Dataset":
    import xarray as xr

    series = [run.kinetic_energy, run.potential_energy, run.energy, run.linear_momentum, run.angular_momentum]
    return xr.Dataset({str(one.name): one for one in series})


def _csv(run: Trajectory, folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    datasets = {name: run[name] for name in run._parts} | {"energies_and_momenta": _summary(run)}
    return [path for name, data in datasets.items() for path in _tables(data, folder, name)]


def _tables(data: "xr.Dataset", folder: Path, name: str) -> list[Path]:
    """A table of what is given at nodes (or for the whole), and one of what is given for elements."""
    found = []
    for place in ("node", "element"):
        nodal = place == "node"
        own = {key: v for key, v in data.data_vars.items() if ("element" in v.dims) != nodal}
        if not own:
            continue
        along = place in data.dims
        columns: dict[str, np.ndarray] = {}
        count = data.sizes[place] if along else 1
        shape = (data.sizes["time"], count)
        columns["time"] = np.repeat(data["time"].values, count)
        if along:
            columns[place] = np.tile(np.arange(count), shape[0])
            if place == "node" and "s" in data.coords:
                columns["s"] = np.tile(data["s"].values, shape[0])
        for key, values in own.items():
            last = values.dims[-1]
            if last in ("axis", "wxyz"):
                for letter in data[last].values:
                    columns[f"{key}_{letter}"] = values.sel({last: letter}).values.reshape(-1)
            else:
                columns[str(key)] = values.values.reshape(-1)
        path = folder / (f"{name}.csv" if place == "node" else f"{name}_elements.csv")
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
        found.append(path)
    return found


def _netcdf(run: Trajectory, target: Path) -> list[Path]:
    try:
        import h5netcdf
        import h5py
    except ImportError:
        raise ValueError("netcdf needs h5netcdf; install cayley[export]") from None
    assert h5netcdf, h5py
    path = target if target.suffix else target.with_name(target.name + ".nc")
    path.parent.mkdir(parents=True, exist_ok=True)
    _summary(run).assign_attrs(rule=run.rule, dt=run.dt).to_netcdf(path, mode="w", engine="h5netcdf")
    for name in run._parts:
        run[name].to_netcdf(path, mode="a", group=name, engine="h5netcdf")
    return [path]


def _vtk(run: Trajectory, folder: Path) -> list[Path]:
    try:
        import meshio
    except ImportError:
        raise ValueError("vtk needs meshio; install cayley[export]") from None
    folder.mkdir(parents=True, exist_ok=True)
    assert run.model is not None

    def series(name: str, meshes: Iterable[tuple[np.ndarray, list[Any], dict[str, np.ndarray]]]) -> Path:
        """Write a file for each time, and one that names them."""
        lines = []
        for k, (points, cells, fields) in enumerate(meshes):
            file = folder / f"{name}_{k:06}.vtu"
            meshio.Mesh(points, cells, point_data=fields).write(file, file_format="vtu")
            lines.append(f'    <DataSet timestep="{float(run.time[k])!r}" part="0" file="{file.name}"/>')
        path = folder / f"{name}.pvd"
        head = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
        path.write_text(head + "\n".join(lines) + "\n  </Collection>\n</VTKFile>\n", encoding="utf-8")
        return path

    found = []
    for part, name in zip(run.model.parts, run.model.names, strict=True):
        frames = (run[name].isel(time=k) for k in range(len(run.time)))
        found.append(series(name, (_tube(part, one) if isinstance(part, Rod) else _axes(one) for one in frames)))
    for obstacle, name in zip(run.model.obstacles, run.model.obstacle_names, strict=True):
        points, faces = _obstacle(run, obstacle)
        if obstacle.on is None:
            found.append(folder / f"obstacle_{name}.vtu")
            meshio.Mesh(points, [faces]).write(found[-1], file_format="vtu")
            continue
        data = run[run.model.name_of(obstacle.on)]
        placed = quaternion.rotate(data["rotation"].values[:, None], points) + data["position"].values[:, None]
        found.append(series(f"obstacle_{name}", ((one, [faces], {}) for one in placed)))
    return found


def _obstacle(run: Trajectory, obstacle: Obstacle) -> tuple[np.ndarray, tuple[str, np.ndarray]]:
    """Points and faces of an obstacle in the frame of what carries it; of a plane a square as large as the run."""
    if not isinstance(obstacle, Plane):
        mesh = skin(obstacle)
        return mesh.vertices, ("triangle", mesh.triangles)
    assert run.model is not None
    places = np.concatenate([run[name].position.values.reshape(-1, 3) for name in run.model.names])
    point, right, up = patch(obstacle)
    middle, half = 0.5 * (places.min(axis=0) + places.max(axis=0)), float(np.ptp(places, axis=0).max()) or 1.0
    along = np.stack([right, up])
    foot = point if obstacle.on is not None else point + along.T @ (along @ (middle - point))
    corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return foot + corners @ along, ("quad", np.array([[0, 1, 2, 3]]))


def _tube(rod: Rod, data: "xr.Dataset") -> tuple[np.ndarray, list[Any], dict[str, np.ndarray]]:
    """Surface of a rod: at every node the outline of its section, joined by quadrilaterals."""
    position, turn = data["position"].values, data["rotation"].values
    outlines = [section_outline(rod, node) for node in range(len(position))]
    around = len(outlines[0])
    local = np.array([np.column_stack([own, np.zeros(around)]) for own in outlines])
    points = position[:, None] + np.asarray(quaternion.rotate(turn[:, None], local), dtype=float)
    k, j = np.meshgrid(np.arange(len(position) - 1), np.arange(around), indexing="ij")
    after = (j + 1) % around
    quads = np.stack([k * around + j, k * around + after, (k + 1) * around + after, (k + 1) * around + j], axis=-1)
    fields = {name: np.repeat(data[name].values, around, axis=0) for name in NODAL}
    for number in range(3):
        axis = np.asarray(quaternion.rotate(turn, np.eye(3)[number]), dtype=float)
        fields[f"d{number + 1}"] = np.repeat(axis, around, axis=0)
    fields["s"] = np.repeat(data["s"].values, around)
    return points.reshape(-1, 3), [("quad", quads.reshape(-1, 4))], fields


def section_outline(rod: Rod, node: int) -> np.ndarray:
    """Outline of the section at a node in its plane [m], shape (points, 2); a thin circle where none is known."""
    stations = rod.stations
    own = stations if isinstance(stations, Section) else stations.sections[min(node, len(stations.sections) - 1)][0]
    outline = np.asarray(own.outline, dtype=float)
    if outline.size:
        return outline
    radius = 0.02 * rod.length
    angle = 2.0 * np.pi * np.arange(ROUND) / ROUND
    return np.asarray(radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def _axes(data: "xr.Dataset") -> tuple[np.ndarray, list[Any], dict[str, np.ndarray]]:
    """A body, or a chain with a Lagrangian of one's own: places, with their axes as vectors there."""
    points, turn = (np.atleast_2d(data[name].values) for name in ("position", "rotation"))
    fields = {
        f"d{number + 1}": np.asarray(quaternion.rotate(turn, np.eye(3)[number]), dtype=float) for number in range(3)
    }
    fields |= {name: np.atleast_2d(data[name].values) for name in ("velocity", "angular_velocity")}
    nodes = np.arange(len(points))
    chain = len(points) > 1
    cells = ("line", np.column_stack([nodes[:-1], nodes[1:]])) if chain else ("vertex", nodes[:, None])
    return points, [cells], fields
