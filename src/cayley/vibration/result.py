"""Modes: frequencies, damping and shapes of small motions about an equilibrium."""

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cayley.lie import quaternion
from cayley.model import Model
from cayley.results.body import port_of
from cayley.results.record import name_of
from cayley.statics import Equilibrium
from cayley.statics.result import frame_velocity
from cayley.steppers.still import Still
from cayley.system.discretize import spans
from cayley.system.legendre import initial_state
from cayley.system.system import State
from cayley.vibration.eigen import Pairs
from cayley.vibration.linear import Linear

if TYPE_CHECKING:
    import xarray as xr

AXES = ("x", "y", "z")
DIRECTIONS = ("x", "y", "z", "turn about x", "turn about y", "turn about z")
ONLY_TURNS = 1e-6
"""A mode that displaces nodes less than so many radians turn over the extent only turns."""
CORRECTIONS = 8
"""Most corrections that bring a displaced state back onto constraints; each squares the error."""
EXACT = 1e-12
"""Violation of a constraint, in its units, that counts as none."""


class Modes:
    """Small free motions about an equilibrium, v(t) = Re(φₖ exp(sₖ t)), by rising |sₖ|, counted from 0.

    Shapes are mass-normalized, φᴴ M φ = 1, real where there is neither damping nor spin; then the largest entry of each
    is positive. ``modes[part]`` is the shape of a part, ``modes.shape(port)`` that of a place.
    """

    def __init__(self, linear: Linear, pairs: Pairs) -> None:
        """Hold what was found.

        Args:
            linear: the linearized equations.
            pairs: eigenvalues and vectors.
        """
        self.linear, self.pairs = linear, pairs

    @property
    def model(self) -> Model:
        """The model."""
        return self.about.model

    @property
    def about(self) -> Equilibrium:
        """The equilibrium."""
        return self.linear.about

    def __len__(self) -> int:
        """Number of modes."""
        return len(self.pairs.values)

    @property
    def complete(self) -> bool:
        """Whether a count by inertia says that none below the last is missing; never with damping or spin."""
        return self.pairs.checked

    @property
    def eigenvalue(self) -> "xr.DataArray":
        """Eigenvalues s [1/s], dims (mode,): Im s is the angular frequency, −Re s the decay."""
        return self._series(self.pairs.values, "eigenvalue", "1/s")

    @property
    def angular_frequency(self) -> "xr.DataArray":
        """Im s [rad/s], dims (mode,), with damping that of the decaying motion; 0 for free and creeping motions."""
        return self._series(self.pairs.values.imag.copy(), "angular frequency", "rad/s")

    @property
    def frequency(self) -> "xr.DataArray":
        """Im s/2π [Hz], dims (mode,)."""
        return self._series(self.pairs.values.imag / (2.0 * np.pi), "frequency", "Hz")

    @property
    def damping_ratio(self) -> "xr.DataArray":
        """ζ = −Re s/|s| [-], dims (mode,): 1 for a motion that creeps back, −1 for one that runs away; 0 for s = 0."""
        s = self.pairs.values
        size = np.where(np.abs(s) > 0.0, np.abs(s), 1.0)
        return self._series(0.0 - s.real / size, "damping ratio", "1")

    def __getitem__(self, part: Any) -> "xr.Dataset":
        """Shapes of a part, see shape."""
        return self.shape(part)

    def shape(self, place: Any) -> "xr.Dataset":
        """Shapes of a part, or of a port of one.

        Args:
            place: a rod or body, its name, or a port such as ``rod.end`` or ``body.port("eye")``.

        Returns: displacement in space and rotation about the body's axes, dims (mode, node, axis), without node for
        bodies and ports.

        Raises:
            KeyError: if there is no such part.
        """
        return moved(self.linear, self.pairs.vectors, place, "mode", self._modes)

    @functools.cached_property
    def participation(self) -> "xr.DataArray":
        """Γ = φᴴ M r for rigid motions r: unit displacements and turns about the origin, dims (mode, direction)."""
        import xarray as xr

        factors = self.pairs.vectors.conj().T @ (self.linear.mass @ rigid(self.linear))
        coordinates = {**self._modes, "direction": list(DIRECTIONS)}
        return xr.DataArray(factors, coordinates, ("mode", "direction"), "participation")

    @property
    def effective_mass(self) -> "xr.DataArray":
        """|Γ|² [kg, kg m²], dims (mode, direction): of all modes they add up to the mass, or inertia, that can move."""
        return (abs(self.participation) ** 2).rename("effective modal mass")

    def sizes(self, k: int) -> tuple[float, float]:
        """Largest displacement [m] and rotation [rad] of a node in a shape; of a mode that only turns 0 and that."""
        layout = self.about.system.layout
        moves = self.linear.spread(self.pairs.vectors[:, k])
        shift, turn = (float(np.linalg.norm(moves[:, layout.dofs_of(name)], axis=1).max()) for name in ("x", "p"))
        moving = shift > ONLY_TURNS * self.about.still.made.struct.extent * turn
        return (shift if moving else 0.0), turn

    def state(self, k: int, amplitude: float, phase: float = 0.0) -> State:
        """The equilibrium displaced along a mode, a start for cy.simulate: v = Re(a φ e^(iα)), v̇ = Re(s a φ e^(iα)).

        Args:
            k: the mode, from 0.
            amplitude: largest displacement of a node [m]; of a mode that only turns largest rotation [rad].
            phase: α [rad].

        Returns: values that satisfy the constraints, and momenta; in a turning frame with velocities of its turning.

        Raises:
            IndexError: if there is no such mode.
        """
        if not -len(self) <= k < len(self):
            raise IndexError(f"there is no mode {k}; there are {len(self)}, from 0")
        vector, s = self.pairs.vectors[:, k], self.pairs.values[k]
        shift, rotation = self.sizes(k)
        turn = np.exp(1j * phase) * amplitude / (shift or rotation)
        still, kept = self.about.still, (self.about.still.values, self.about.still.multipliers)
        try:
            values = _displaced(still, (turn * vector).real, self._softness(k))
        finally:
            still.put(*kept)
        rates = self.linear.spread((s * turn * vector).real) + frame_velocity(still, values)
        return initial_state(self.about.system, values, rates, time=self.about.time)

    def _softness(self, k: int) -> float:
        """|s|² of a mode, of a free one that of the first which is not [1/s²]; 0 if all are free."""
        size = np.abs(self.pairs.values) ** 2 + np.maximum(self.pairs.values.real, 0.0) ** 2  # K + |s|² M is singular
        moving = size[size > 0.0]  # along a motion that runs away, hence more of it
        return float(size[k] or (moving[0] if len(moving) else 0.0))

    def data(self) -> "xr.Dataset":
        """All in one Dataset: eigenvalue, frequency, damping_ratio, effective_mass, PART.displacement and .rotation."""
        import xarray as xr

        found = {"eigenvalue": self.eigenvalue, "frequency": self.frequency, "damping_ratio": self.damping_ratio}
        found["effective_mass"] = self.effective_mass
        for part in self.model.names:
            for name, field in self.shape(part).items():
                ends = {dim: f"{part}.{dim}" for dim in field.dims if dim == "node"}
                found[f"{part}.{name}"] = field.rename(ends).rename({"s": f"{part}.s"} if "s" in field.coords else {})
        return xr.Dataset(found, attrs={"about": repr(self.about)})

    def save(self, path: str | Path) -> None:
        """Write data() to a Zarr store, which ``xarray.open_zarr(path, consolidated=False)`` reads."""
        labels = {
            "axis": ", ".join(AXES),
            "direction": ", ".join(DIRECTIONS),
        }  # Zarr has no standard for arrays of text
        self.data().drop_vars(list(labels)).assign_attrs(labels).to_zarr(path, mode="w", consolidated=False)

    def __repr__(self) -> str:
        """How many, and from which frequency to which."""
        span = self.frequency.values
        what = f", {span.min():.4g} to {span.max():.4g} Hz" if len(self) else ""
        return f"<Modes: {len(self)} of {self.linear.motions} motions{what}, about {self.about!r}>"

    def __str__(self) -> str:
        """A line for each mode: frequency, damping, what moves most."""
        head = f"{'mode':>4} {'frequency [Hz]':>15} {'damping [-]':>12}  moves most"
        rows = zip(self.frequency.values, self.damping_ratio.values, self.moves_most(), strict=True)
        return "\n".join([head, *(f"{k:4d} {f:15.6g} {z:12.4g}  {word}" for k, (f, z, word) in enumerate(rows))])

    def moves_most(self) -> list[str]:
        """Of each mode part and kind of motion with most of φᴴ M φ: "bob turns", "mast along y"."""
        table = self.linear.table()
        energy = np.abs(self.pairs.vectors.conj() * (self.linear.mass @ self.pairs.vectors))
        words = np.where(np.char.startswith(table["dof"], "turn"), "turns", np.char.add("along ", table["dof"]))
        kinds, of = np.unique(np.char.add(np.char.add(table["part"], " "), words), return_inverse=True)
        sums = np.zeros((len(kinds), len(self)))
        np.add.at(sums, of, energy)
        return [str(kinds[k]) for k in sums.argmax(axis=0)] if len(kinds) else []

    @property
    def _modes(self) -> dict[str, Any]:
        return {"mode": np.arange(len(self))}

    def _series(self, values: np.ndarray, name: str, unit: str) -> "xr.DataArray":
        import xarray as xr

        return xr.DataArray(values, self._modes, ("mode",), name, {"units": unit})


def moved(linear: Linear, vectors: np.ndarray, place: Any, dim: str, coordinates: dict[str, Any]) -> "xr.Dataset":
    """Displacements in space and rotations about body axes of a part, or a port, for motions in columns.

    δP = v + Λ(η × o),   δθ = Λ(f)ᵀ η for a port at o with the frame f

    Args:
        linear: the linearized equations.
        vectors: shape (n, k).
        place: a part, its name, or a port.
        dim: what the columns are.
        coordinates: their coordinates.
    """
    import xarray as xr

    from cayley.model import Port

    about = linear.about
    model, layout, degree = about.model, about.system.layout, about.system.equations.rule.degree
    among = dict(zip(model.names, spans(model, degree), strict=True))
    moves = np.moveaxis(linear.spread(vectors), -1, 0)
    shift, turn = moves[..., layout.dofs_of("x")], moves[..., layout.dofs_of("p")]
    coordinates = {**coordinates, "axis": list(AXES)}
    if isinstance(place, Port):
        port, name = port_of(about.frame, place, None)
        node = among[model.name_of(port.part)].start + port.node * degree
        turned = about.still.values[node, layout.rows_of("p")]
        off = np.cross(turn[:, node], np.array(port.shift))
        shift = shift[:, node] + _rotated(quaternion.rotate, turned, off)
        turn = _rotated(quaternion.inverse_rotate, np.array(port.turn), turn[:, node])
        dims: tuple[str, ...] = (dim, "axis")
    else:
        name = place if isinstance(place, str) else str(name_of(place, model))
        if name not in among:
            raise KeyError(f"the model has no part {place!r}; it has {', '.join(among)}")
        shift, turn = shift[:, among[name]], turn[:, among[name]]
        dims = (dim, "node", "axis")
        if model.parts[model.names.index(name)].node_count > 1:
            coordinates["s"] = ("node", about.system.nodes[among[name]], {"units": "m"})
        else:
            shift, turn, dims = shift[:, 0], turn[:, 0], (dim, "axis")
    fields = {
        "displacement": (dims, shift, {"long_name": "displacement, space frame"}),
        "rotation": (dims, turn, {"long_name": "small rotation, body frame"}),
    }
    return xr.Dataset(fields, coordinates, {"name": name})


def rigid(linear: Linear) -> np.ndarray:
    """Rigid motions of all that is not held: unit displacements along x, y, z and turns about them, shape (n, 6)."""
    about = linear.about
    layout, values = about.system.layout, about.still.values
    found = np.zeros((len(values), layout.dofs, 6))
    for k, axis in enumerate(np.eye(3)):
        found[:, layout.dofs_of("x"), k] = axis
        found[:, layout.dofs_of("x"), 3 + k] = np.cross(axis, values[:, layout.rows_of("x")])
        turned = quaternion.inverse_rotate(values[:, layout.rows_of("p")], axis)
        found[:, layout.dofs_of("p"), 3 + k] = np.asarray(turned, dtype=float)
    return found[linear.dofs[:, 0], linear.dofs[:, 1]]


def _displaced(still: Still, v: np.ndarray, inertia: float) -> np.ndarray:
    """Values displaced by v, then brought back onto the constraints.

    First by motions that cost little, in the norm of K + inertia M at the equilibrium, as far as that leads; what is
    left then, by the least change in the mass norm.
    """
    x = np.zeros(len(still.made.arrays["unknown"]))
    x[still.free] = v
    multipliers, spots = still.multipliers, still.spots
    _, regular = still.tangent(inertia=inertia)
    still.move(x)

    def correct(force: np.ndarray) -> None:
        right = np.zeros_like(force)
        right[spots] = -force[spots]
        still.move(still.solve(right))
        still.put(still.values, multipliers)

    left = np.inf
    for _ in range(CORRECTIONS if len(spots) and inertia > 0.0 and regular else 0):
        force = still.force()
        before, left = left, float(np.abs(force[spots]).max())
        if left > 0.5 * before or left <= EXACT:
            break
        correct(force)
    stiff = still.fastest()
    for _ in range(CORRECTIONS if len(spots) else 0):
        force, _ = still.tangent(inertia=stiff)
        if np.abs(force[spots]).max() <= EXACT:
            break
        correct(force)
    return still.values


def _rotated(turn: Any, p: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vectors, of complex numbers perhaps, turned by rotations."""
    real = np.asarray(turn(p, v.real), dtype=float)
    return real + 1j * np.asarray(turn(p, v.imag), dtype=float) if np.iscomplexobj(v) else real
