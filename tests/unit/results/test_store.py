"""Runs saved and opened: bit for bit, with plain refusals, and fit to go on."""

import json
import shutil
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import cayley as cy
from cayley.results import append, arrays
from cayley.results.trajectory import Trajectory


def whirl(t: float) -> np.ndarray:
    return np.array([0.01 * np.sin(40 * t), 0.02 * np.cos(30 * t), 0.0])


def frame_of_rods() -> tuple[Any, Any, Any]:
    """Two rods of different sections with every kind of support and load."""
    rubber = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
    stiffness = np.diag([300.0, 320.0, 900.0, 0.05, 0.06, 0.04])
    stiffness[2, 3] = stiffness[3, 2] = 1.5
    given = cy.Section.given(stiffness=stiffness, mass_per_length=0.2, inertia=np.diag([2e-5, 3e-5, 5e-5]))
    one = cy.Rod(cy.Section.circle(0.01, rubber), length=0.3, elements=3, direction=(1, 2, 3), normal=(0, 0, 1))
    two = cy.Rod(given, length=0.7, elements=7, origin=(0.1, 0, 1 / 3), direction=(0.3, -1, 0.1), name="long one")
    supports = [cy.supports.clamp(one.start), cy.supports.hold(two.end, position="xz", rotation="y")]
    loads = [
        cy.loads.gravity((0.1, 0.2, -9.81)),
        cy.loads.moment(one.end, whirl, frame="body", until=0.013),
        cy.loads.force(two.node(2), (0.1, 0.2, 0.3), frame="body", start=0.002),
        cy.loads.line_force(one, (0.0, 1 / 3, 0.0)),
        cy.loads.line_moment(two, lambda t: (0.0, 0.001 * t, 0.0)),
    ]
    return cy.Model(one, two, supports=supports, loads=loads), one, two


def simulated(rule: Any = cy.rules.verlet, rotation: str = "quaternion") -> Trajectory:
    return cy.simulate(frame_of_rods()[0], t_end=0.02, dt=1e-4, rule=rule, rotation=rotation, save_every=1e-3)


@cy.lagrangian(p=cy.Rotation(), x=cy.Vector(2))
def top(q: Any, c: Any) -> Any:
    kinetic = 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) + 0.5 * cy.dot(q.x_t, q.x_t)
    return kinetic - q.p.rotate(cy.E2)[2] - 0.5 * cy.dot(q.x, q.x)


@cy.lagrangian(x=cy.Vector(3), w=cy.Interval)
def string(q: Any, c: Any) -> Any:
    return 0.5 * cy.dot(q.x_t, q.x_t) - 0.5 * c.k * (cy.norm(q.x_w) - 1.0) ** 2


def top_system(rotation: str = "quaternion") -> Any:
    inertia = np.diag([1.0, 2.0, 1.5])
    return cy.compile(top, rule=cy.rules.nodal, constants={"inertia": inertia}, rotation=rotation)


def integrated(kind: str) -> Trajectory:
    if kind == "string":
        system = cy.compile(
            string, rule=cy.rules.verlet, domain=cy.Interval(0, 1, elements=5), constants={"k": 3.0}, held={"x": 0}
        )
        shape = np.stack([system.nodes**2, np.sin(system.nodes), system.nodes], axis=1)
        return cy.integrate(system, {"x": shape}, t_end=2.0, t_start=0.5)
    start = {"p": (1, 0, 0, 0), "p_t": (0.1, 5, -0.3), "x": (1, 2)}
    return cy.integrate(top_system(kind), start, t_end=1.0, dt=0.01, save_every=0.1)


MAKERS = {
    "rods": simulated,
    "rods as matrices, nodal": lambda: simulated(cy.rules.nodal, "matrix"),
    "top": lambda: integrated("quaternion"),
    "top as matrix": lambda: integrated("matrix"),
    "string": lambda: integrated("string"),
}


def same(one: Trajectory, other: Trajectory) -> None:
    """All of the public face, bit for bit."""
    for name in ("rule", "dt", "steps", "wall_time", "info"):
        assert getattr(one, name) == getattr(other, name), name
    assert repr(one) == repr(other)
    for name in ("energy", "kinetic_energy", "potential_energy", "linear_momentum", "angular_momentum", "data"):
        assert getattr(one, name).identical(getattr(other, name)), name
    assert one._parts == other._parts
    for part in one._parts:
        assert one[part].identical(other[part])
    for name in ("values", "momenta"):
        assert np.array_equal(getattr(one.state, name), getattr(other.state, name))
    assert (one.state.origin, one.state.step, one.state.h) == (other.state.origin, other.state.step, other.state.h)


@pytest.mark.parametrize("kind", MAKERS)
def test_opens_as_it_was_saved(kind: str, tmp_path: Path) -> None:
    run = MAKERS[kind]()
    run.save(tmp_path / "run.zarr")
    opened = Trajectory.open(str(tmp_path / "run.zarr"))
    same(opened, run)
    assert str(opened.model) == str(run.model)
    opened.save(tmp_path / "again.zarr")
    same(Trajectory.open(tmp_path / "again.zarr"), run)


@pytest.fixture(scope="module")
def rods(tmp_path_factory: pytest.TempPathFactory) -> tuple[Trajectory, Path]:
    run = simulated()
    path = tmp_path_factory.mktemp("runs") / "rods.zarr"
    run.save(path)
    return run, path


def test_opened_model_is_that_of_the_run(rods: tuple[Trajectory, Path]) -> None:
    run, path = rods
    opened = cy.Trajectory.open(path)
    for mine, yours in zip(opened.model.rods, run.model.rods, strict=True):
        for name in ("positions", "rotation", "nodes"):
            assert np.array_equal(getattr(mine, name), getattr(yours, name))
        for name in ("stiffness", "inertia", "outline", "mass_per_length", "name"):
            assert np.array_equal(getattr(mine.section, name), getattr(yours.section, name))
    for node in range(4):
        ports = opened.model.rods[0].node(node), run.model.rods[0].node(node)
        assert opened.model.held(ports[0]) == run.model.held(ports[1])
    for mine, yours in zip(opened.model.loads, run.model.loads, strict=True):
        assert all(np.array_equal(mine.at(t), yours.at(t)) for t in run.time)
    assert np.array_equal(opened.system.reference, run.system.reference)
    assert np.array_equal(opened.system.free, run.system.free)
    assert opened.system.equations.signature == run.system.equations.signature


def test_opened_rods_answer_to_the_rods_of_the_model_that_ran(rods: tuple[Trajectory, Path]) -> None:
    run, path = rods
    opened = cy.Trajectory.open(path)
    for rod in run.model.rods:
        assert opened[rod].identical(run[rod])


def test_xarray_opens_the_store_alone(rods: tuple[Trajectory, Path]) -> None:
    run, path = rods
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        root = xr.open_zarr(path, consolidated=False)
        field = xr.open_zarr(path, group="fields/x", consolidated=False)
    assert np.array_equal(root.kinetic_energy, run.kinetic_energy)
    assert root.kinetic_energy.attrs["units"] == "J"
    assert field.value.dims == ("time", "node", "axis")
    assert np.array_equal(field.value, run.data["x"])
    assert np.array_equal(field.time, run.time)
    assert "s" in field.coords
    assert field.resultant.attrs["units"] == "N"


def test_format_is_stated(rods: tuple[Trajectory, Path]) -> None:
    about = json.loads((rods[1] / "zarr.json").read_text())["attributes"]
    assert (about["format"], about["version"], about["rule"]) == ("cayley run", 2, "verlet")
    assert about["model"]["loads"][1]["value"] == {"function": "whirl"}


def test_frames_are_chunked_in_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import zarr

    monkeypatch.setattr(arrays, "CHUNK_BYTES", 1000)
    run = integrated("string")
    run.save(tmp_path / "run.zarr")
    root = zarr.open_group(tmp_path / "run.zarr", mode="r", use_consolidated=False)
    assert root["fields/x/value"].chunks == (1000 // (6 * 3 * 8), 6, 3)
    assert root["time"].chunks == root["kinetic_energy"].chunks == (1000 // (6 * 3 * 8),)
    same(Trajectory.open(tmp_path / "run.zarr"), run)


def test_a_path_that_exists_is_refused(tmp_path: Path) -> None:
    one, two = integrated("quaternion"), integrated("string")
    path = tmp_path / "deep" / "run.zarr"
    one.save(path)
    with pytest.raises(FileExistsError, match="is there already; give another path, or overwrite=True"):
        two.save(path)
    same(Trajectory.open(path), one)
    two.save(path, overwrite=True)
    same(Trajectory.open(path), two)
    assert [entry.name for entry in path.parent.iterdir()] == ["run.zarr"]


def test_only_runs_are_overwritten(tmp_path: Path) -> None:
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter").write_text("years of work")
    with pytest.raises(FileExistsError, match="is no run of cayley, so it is not overwritten"):
        integrated("string").save(tmp_path / "thesis", overwrite=True)
    assert (tmp_path / "thesis" / "chapter").read_text() == "years of work"


def test_a_save_that_fails_leaves_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, path = integrated("string"), tmp_path / "run.zarr"
    run.save(path)

    def fail(*_: Any, **__: Any) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(append, "observed_of_field", fail)
    with pytest.raises(OSError, match="disk full"):
        run.save(path, overwrite=True)
    monkeypatch.undo()
    same(Trajectory.open(path), run)
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.zarr"]


def lose_chunk(path: Path) -> None:
    _chunk(path).unlink()


def _chunk(path: Path) -> Path:
    return next(p for p in sorted((path / "fields" / "x" / "momentum" / "c").rglob("*")) if p.is_file())


def flip_bit(path: Path) -> None:
    chunk = _chunk(path)
    data = bytearray(chunk.read_bytes())
    data[len(data) // 2] ^= 1
    chunk.write_bytes(data)


def cut_chunk(path: Path) -> None:
    chunk = _chunk(path)
    chunk.write_bytes(chunk.read_bytes()[:-9])


def change(path: Path, **changes: Any) -> None:
    file = path / "zarr.json"
    whole = json.loads(file.read_text())
    whole["attributes"].update(changes)
    file.write_text(json.dumps(whole))


DAMAGES: dict[str, Callable[[Path], Any]] = {
    "a chunk is lost": lose_chunk,
    "a bit has flipped": flip_bit,
    "a chunk is cut off": cut_chunk,
    "a group is lost": lambda path: shutil.rmtree(path / "fields"),
    "a table of a load is lost": lambda path: shutil.rmtree(path / "loads" / "1"),
    "a field has another size": lambda path: change(path, fields=[["p", "rotation"], ["x", 4]]),
    "a field is unknown": lambda path: change(path, fields=[["p", "rotation"], ["y", 3]]),
    "the version is a word": lambda path: change(path, version="one"),
    "the model is cut": lambda path: change(path, model={"rods": []}),
    "the rotation form is unknown": lambda path: change(path, rotation="euler angles"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damage_is_told_in_one_line(damage: str, rods: tuple[Trajectory, Path], tmp_path: Path) -> None:
    path = shutil.copytree(rods[1], tmp_path / "copy.zarr")
    DAMAGES[damage](path)
    with pytest.raises(ValueError, match=r"copy\.zarr is damaged and can't be opened \(.+\)$") as caught:
        Trajectory.open(path)
    assert "\n" not in str(caught.value)


def test_what_was_observed_is_observed_again_where_it_is_lost(rods: tuple[Trajectory, Path], tmp_path: Path) -> None:
    path = shutil.copytree(rods[1], tmp_path / "copy.zarr")
    shutil.rmtree(path / "kinetic_energy")
    opened = Trajectory.open(path, model=rods[0].model)
    assert "kinetic_energy" in opened.info["damage"]
    assert opened.kinetic_energy.identical(rods[0].kinetic_energy)


def test_what_is_no_run_is_told(rods: tuple[Trajectory, Path], tmp_path: Path) -> None:
    import zarr

    with pytest.raises(FileNotFoundError, match=r"there is no run at .*nothing"):
        Trajectory.open(tmp_path / "nothing")
    (tmp_path / "file").write_text("text")
    zarr.create_group(tmp_path / "foreign.zarr", attributes={"format": "someone else's"})
    broken = shutil.copytree(rods[1], tmp_path / "broken.zarr")
    (broken / "zarr.json").write_text("{")
    for path in (tmp_path, tmp_path / "file", tmp_path / "foreign.zarr", broken):
        with pytest.raises(ValueError, match=r"is no run of cayley; give a directory that Trajectory\.save wrote$"):
            Trajectory.open(path)


def test_a_newer_format_is_refused(rods: tuple[Trajectory, Path], tmp_path: Path) -> None:
    path = shutil.copytree(rods[1], tmp_path / "newer.zarr")
    change(path, version=3, cayley="7.0")
    with pytest.raises(ValueError, match=r"has format 3, .* reads formats up to 2; .*written by 7\.0") as caught:
        Trajectory.open(path)
    assert "damaged" not in str(caught.value)


def test_an_opened_run_goes_on_bit_for_bit(tmp_path: Path) -> None:
    """The same frames as a run that was never stopped: the loads that are functions come with the model."""
    model, *_ = frame_of_rods()
    whole = cy.simulate(model, t_end=0.02, dt=1e-4, save_every=1e-3)
    half = cy.simulate(model, t_end=0.01, dt=1e-4, save_every=1e-3)
    half.save(tmp_path / "half.zarr")
    opened = Trajectory.open(tmp_path / "half.zarr", model=model)
    assert opened.model is model
    rest = cy.integrate(opened.system, opened.state, t_end=0.02, save_every=1e-3)
    assert np.array_equal(rest.frames.values, whole.frames.values[10:])
    assert np.array_equal(rest.frames.momenta, whole.frames.momenta[10:])
    assert np.array_equal(rest.time, whole.time[10:])


def test_an_opened_lagrangian_goes_on_when_compiled_again(tmp_path: Path) -> None:
    whole = integrated("quaternion")
    whole.save(tmp_path / "run.zarr")
    opened = Trajectory.open(tmp_path / "run.zarr")
    with pytest.raises(ValueError, match="has no system; compile it again"):
        _ = opened.system
    rest = cy.integrate(top_system(), opened.frames.state(4), t_end=1.0, save_every=0.1)
    assert np.array_equal(rest.frames.values, whole.frames.values[4:])


def test_a_load_that_was_a_function_is_known_at_the_frames_only(rods: tuple[Trajectory, Path]) -> None:
    opened = Trajectory.open(rods[1])
    load = opened.model.loads[1]
    assert np.array_equal(load.at(opened.time[3]), whirl(opened.time[3]))
    assert not np.any(load.at(0.019))  # after its time
    with pytest.raises(ValueError, match=r"the load function whirl is not in the store.*open the run with model="):
        load.at(0.00123)
    with pytest.raises(ValueError, match="is not in the store"):
        cy.integrate(opened.system, opened.frames.state(2), t_end=0.02)


def test_another_model_is_refused(rods: tuple[Trajectory, Path], tmp_path: Path) -> None:
    run, path = rods
    other = run.model.replace(loads=run.model.loads[:-1])
    with pytest.raises(ValueError, match="the model given is not the one that ran; leave it out") as caught:
        Trajectory.open(path, model=other)
    assert "damaged" not in str(caught.value)
    integrated("string").save(tmp_path / "string.zarr")
    with pytest.raises(ValueError, match="the model given is not the one that ran"):
        Trajectory.open(tmp_path / "string.zarr", model=run.model)


def test_what_was_saved_before_a_failure_can_be_stored(tmp_path: Path) -> None:
    model, *_ = frame_of_rods()
    with pytest.raises(cy.SimulationError) as caught:
        cy.simulate(model, t_end=5.0, dt=5e-3, allow_unstable=True)
    partial = caught.value.partial
    partial.save(tmp_path / "partial.zarr")
    same(Trajectory.open(tmp_path / "partial.zarr"), partial)


def test_a_run_that_has_only_begun_opens(tmp_path: Path) -> None:
    """Its loads that are functions of time have no table yet: with the model all is there, without it states are."""
    model, _, two = frame_of_rods()
    path, seen = tmp_path / "run", []

    def look(fraction: float, time: float) -> None:
        if not seen and 0.0 < fraction < 1.0:
            alone = Trajectory.open(path)
            with pytest.raises(ValueError, match="open the run with model="):
                alone.energy  # noqa: B018
            seen.append((len(alone.time), Trajectory.open(path, model=model)))

    run = cy.simulate(model, t_end=0.02, dt=1e-4, save_every=1e-3, store=path, progress=look)
    ((count, begun),) = seen
    assert 1 < count == len(begun.time) < len(run.time)
    np.testing.assert_array_equal(begun[two].force.values, run[two].force.values[:count])
