"""Runs that were killed, stopped, cut off or damaged: going on equals never having stopped, bit for bit."""

import errno
import functools
import os
import shutil
import signal
import threading
import time
import warnings

import numpy as np
import pytest

import cayley as cy
from cayley import joints, loads, supports
from cayley.results import arrays, journal
from cayley.simulation.record import Record

RUBBER = cy.Material(density=1100.0, youngs_modulus=5e6, poisson_ratio=0.4)
KILLS = int(os.environ.get("CAYLEY_KILLS", "2"))
"""Random kills of each of the five kinds of steppers; `make kills` takes 10, 50 in all."""


def model(*, jointed=False):
    section = cy.Section.circle(0.01, RUBBER)
    rod = cy.Rod(section, length=0.3, elements=6, name="rod")
    gravity, pull = loads.gravity((0, 0, -9.81)), loads.force(rod.end, (0.1, 0.05, 0))
    if not jointed:
        return cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[gravity, pull])
    other = cy.Rod(section, length=0.2, elements=4, origin=(0, 0, 0.3), direction=(1, 0, 0), name="other")
    tied = [joints.hinge(rod.end, other.start, axis=(0, 1, 0))]
    return cy.Model(rod, other, supports=[supports.clamp(rod.start)], joints=tied, loads=[gravity, pull])


CASES = {
    "verlet": (model(), {"rule": cy.rules.verlet, "t_end": 3.0}),
    "screw": (model(), {"rule": cy.rules.screw, "t_end": 1.0}),
    "midpoint": (model(), {"rule": cy.rules.midpoint, "dt": 1e-4, "t_end": 0.4}),
    "galerkin(time=2)": (model(), {"rule": cy.rules.galerkin(time=2), "dt": 2e-4, "t_end": 0.3}),
    "verlet with a joint": (model(jointed=True), {"rule": cy.rules.verlet, "t_end": 0.5}),
}


@pytest.fixture(scope="module", params=CASES)
def case(request):
    return begun(request.param)


@pytest.fixture(scope="module", params=["verlet", "midpoint"])
def short_case(request):
    return begun(request.param)


@functools.cache
def begun(name):
    own, options = CASES[name]
    options = options | {"save_every": options["t_end"] / 200}
    return own, options, cy.simulate(own, **options)


def same(run, whole):
    for name in ("times", "steps", "values", "momenta"):
        assert np.array_equal(getattr(run.frames, name), getattr(whole.frames, name)), name
    assert run["rod"].moment.identical(whole["rod"].moment)


def killed(own, options, path, seconds):
    """Run in a child process that is killed after so many seconds of running."""
    ready, told = os.pipe()
    child = os.fork()
    if child == 0:
        started = threading.Event()

        def tell(done, reached):
            if not started.is_set():
                started.set()
                os.write(told, b"x")

        try:
            cy.simulate(own, store=path, progress=tell, **options)
        finally:
            os._exit(0)
    os.close(told)
    os.read(ready, 1)
    os.close(ready)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)


def test_killed_at_random(case, tmp_path, monkeypatch):
    monkeypatch.setattr(arrays, "CHUNK_BYTES", 20_000)
    own, options, whole = case
    chance, reached, seen = np.random.default_rng(int(os.environ.get("CAYLEY_KILL_SEED", "5"))), [], []
    cy.simulate(own, store=tmp_path / "whole.zarr", progress=lambda *_: seen.append(time.perf_counter()), **options)
    span = 1.3 * (seen[-1] - seen[0])  # of the steps, and some of what is observed when they are done
    for k in range(KILLS):
        path = tmp_path / f"{k}.zarr"
        killed(own, options, path, chance.uniform(0.0, span))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            opened = cy.Trajectory.open(path, model=own)
        count = len(opened.time)
        reached.append(count)
        assert np.array_equal(opened.frames.values, whole.frames.values[:count])
        if count < len(whole.time):
            same(cy.resume(path, model=own), whole)
        else:
            same(opened, whole)
    assert KILLS < 10 or len(set(reached)) > 2, "kills came all at the same frame"


def test_stopped_by_hand(short_case, tmp_path):
    own, options, whole = short_case
    path = tmp_path / "run.zarr"

    def stop(done, reached):
        if done > 0.1:
            raise KeyboardInterrupt

    with pytest.raises(cy.Interrupted, match=r"stopped by hand at t = .* has all frames, cy\.resume\(") as caught:
        cy.simulate(own, store=path, progress=stop, **options)
    count = len(caught.value.partial.time)
    assert 1 < count < len(whole.time)
    assert np.array_equal(caught.value.partial.frames.values, whole.frames.values[:count])
    same(caught.value.partial.resume(), whole)


def test_extended(short_case, tmp_path):
    own, options, whole = short_case
    half = options | {"t_end": options["t_end"] / 2}
    run = cy.simulate(own, store=tmp_path / "run.zarr", **half)
    same(run.resume(options["t_end"]), whole)
    with pytest.raises(ValueError, match="give a later t_end"):
        cy.resume(tmp_path / "run.zarr")


def chunks_of(path):
    return sorted((path / "fields" / "x" / "value" / "c").iterdir(), key=lambda part: int(part.name))


def test_the_last_chunk_is_cut_off(short_case, tmp_path, monkeypatch):
    monkeypatch.setattr(arrays, "CHUNK_BYTES", 20_000)
    own, options, whole = short_case
    path = tmp_path / "run.zarr"
    cy.simulate(own, store=path, **options)
    last = next(part for part in chunks_of(path)[-1].rglob("*") if part.is_file())
    last.write_bytes(last.read_bytes()[:-7])
    with pytest.warns(cy.DamageWarning, match=r"fields/x/value is whole for \d+ of 201 frames only"):
        opened = cy.Trajectory.open(path, model=own)
    assert len(opened.time) == (len(chunks_of(path)) - 1) * chunk_of(path)
    assert np.array_equal(opened.frames.values, whole.frames.values[: len(opened.time)])
    with pytest.warns(cy.DamageWarning):
        same(cy.resume(path, model=own), whole)


def chunk_of(path):
    import zarr

    return zarr.open_group(path, mode="r", use_consolidated=False)["fields/x/value"].chunks[0]


def test_the_journal_is_cut_off(tmp_path):
    own, options = CASES["midpoint"]
    options = options | {"save_every": options["t_end"] / 200}
    whole, path = cy.simulate(own, **options), tmp_path / "run.zarr"
    killed(own, options, path, 0.02)
    record = journal.journals(path)[-1]
    os.truncate(record, record.stat().st_size - 11)
    same(cy.resume(path, model=own), whole)


def test_the_disk_is_full(tmp_path, monkeypatch):
    own, options = CASES["midpoint"]
    options = options | {"save_every": options["t_end"] / 200}
    whole, path, room = cy.simulate(own, **options), tmp_path / "run.zarr", [100_000]

    def write(file, content):
        if len(content) > room[0]:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        room[0] -= len(content)
        return os.pwrite(file, content, os.fstat(file).st_size)

    monkeypatch.setattr(journal, "_write", write)
    with pytest.raises(cy.WriteError, match=r"run\.zarr can't be written \(.*No space left on device\)"):
        cy.simulate(own, store=path, **options)
    monkeypatch.undo()
    opened = cy.Trajectory.open(path, model=own)
    assert 10 < len(opened.time) < len(whole.time)
    same(cy.resume(path, model=own), whole)


def test_saves_by_steps_and_at_times(tmp_path):
    own, _ = CASES["midpoint"]
    by_steps = cy.simulate(own, t_end=0.1, dt=1e-3, rule=cy.rules.midpoint, save_steps=7, store=tmp_path / "steps.zarr")
    assert by_steps.frames.steps.tolist() == [*range(0, 100, 7), 100]
    times = [0.0112, 0.05, 0.0731]
    at = cy.simulate(own, t_end=0.1, dt=1e-3, rule=cy.rules.midpoint, save_at=times, store=tmp_path / "at.zarr")
    assert at.frames.steps.tolist() == [0, 11, 50, 73, 100]
    with pytest.raises(ValueError, match="save_steps and save_at are given; give one"):
        cy.simulate(own, t_end=0.1, dt=1e-3, save_steps=7, save_at=times)
    with pytest.raises(ValueError, match="rising times"):
        cy.simulate(own, t_end=0.1, dt=1e-3, save_at=[0.2, 0.1])


def test_a_lagrangian_of_ones_own_goes_on(tmp_path, monkeypatch):
    inertia = np.diag([1.0, 2.0, 1.5])

    @cy.lagrangian(p=cy.Rotation())
    def top(q, c):
        return 0.5 * cy.dot(q.p_t, c.inertia @ q.p_t) - q.p.rotate(cy.E2)[2]

    system = cy.compile(top, rule=cy.rules.midpoint, constants={"inertia": inertia})
    start, options = {"p": (1, 0, 0, 0), "p_t": (0.1, 5, -0.3)}, {"dt": 0.01, "save_every": 0.1}
    whole = cy.integrate(system, start, t_end=4.0, **options)
    half = cy.integrate(system, start, t_end=2.0, store=tmp_path / "top.zarr", **options)
    rest = half.resume(4.0, system=system)
    assert np.array_equal(rest.frames.values, whole.frames.values)

    def die(*_):
        raise MemoryError

    with monkeypatch.context() as patch:
        patch.setattr("cayley.simulation.run.finish", die)  # what a killed run leaves: states, and nothing observed
        with pytest.raises(MemoryError):
            cy.integrate(system, start, t_end=2.0, store=tmp_path / "killed.zarr", **options)
    opened = cy.Trajectory.open(tmp_path / "killed.zarr")
    assert np.array_equal(opened.frames.values, half.frames.values)
    with pytest.raises(ValueError, match=r"go on with cy\.resume\(path, system=system\)"):
        _ = opened.energy
    assert np.array_equal(cy.resume(opened.path, 4.0, system=system).energy, whole.energy)


def test_a_store_that_is_there_is_not_replaced_unasked(tmp_path):
    own, _ = CASES["midpoint"]
    path = tmp_path / "run.zarr"
    options = {"dt": 1e-3, "rule": cy.rules.midpoint}
    cy.simulate(own, t_end=0.01, store=path, **options)
    with pytest.raises(FileExistsError, match="is there already"):
        cy.simulate(own, t_end=0.01, store=path, **options)
    again = cy.simulate(own, t_end=0.02, store=path, overwrite=True, **options)
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.zarr"]
    shutil.rmtree(path)
    with pytest.raises(ValueError, match="in no store"):
        cy.simulate(own, t_end=0.01, **options).resume()
    assert again.time[-1] == 0.02


def test_runs_are_logged(caplog):
    own, _ = CASES["midpoint"]
    with caplog.at_level("INFO", logger="cayley"):
        cy.simulate(own, t_end=0.01, dt=1e-3, rule=cy.rules.midpoint)
    first, last = (record for record in caplog.records if record.name == "cayley.run")
    assert "100 steps of 0.0001 s" in first.message
    assert (first.rule, first.nodes) == ("midpoint", 7)
    assert last.message.startswith("finished after")


@pytest.mark.parametrize("rule", [cy.rules.verlet, cy.rules.midpoint], ids=str)
def test_only_some_parts_are_saved(rule, tmp_path, monkeypatch):
    monkeypatch.setattr(arrays, "CHUNK_BYTES", 3_000)
    own = model(jointed=True)
    rod, other = own.parts
    options = {"rule": rule, "dt": 1e-4, "save_every": 1e-3, "allow_unstable": True}
    whole = cy.simulate(own, t_end=0.1, **options)
    path = tmp_path / "some.zarr"
    some = cy.simulate(own, t_end=0.05, store=path, save_only=[other, rod.node(2), rod.end], **options)
    for longer in (some, some.resume(0.1)):
        count = len(longer.time)
        for name in ("position", "velocity", "moment"):
            assert np.array_equal(longer[other][name], whole[other][name][:count])
        assert np.array_equal(longer.port(rod.node(2)).position, whole.port(rod.node(2)).position[:count])
        assert np.array_equal(longer.energy, whole.energy[:count])
        assert np.array_equal(longer.joint(own.joints[0]).force, whole.joint(own.joints[0]).force[:count])
    assert count == 101
    size = sum(file.stat().st_size for file in (path / "fields").rglob("*") if file.is_file())
    assert size > 0
    with pytest.raises(KeyError, match="the run has no part 'rod'; it has other"):
        longer["rod"]
    with pytest.raises(KeyError, match="were not saved"):
        longer.port(rod.node(3))
    with pytest.raises(ValueError, match="momenta are sums over all nodes"):
        _ = longer.linear_momentum


def test_some_parts_of_a_killed_run_go_on(tmp_path, monkeypatch):
    monkeypatch.setattr(arrays, "CHUNK_BYTES", 3_000)
    own = model(jointed=True)
    options = {"rule": cy.rules.midpoint, "dt": 1e-4, "t_end": 0.3, "save_every": 1e-3}
    whole = cy.simulate(own, **options)
    for seconds in (0.0, 0.1):
        path = tmp_path / f"{seconds}.zarr"
        killed(own, options | {"save_only": ["other"]}, path, seconds)
        opened = cy.Trajectory.open(path, model=own)
        assert np.array_equal(opened["other"].position, whole["other"].position[: len(opened.time)])
        if len(opened.time) < len(whole.time):
            opened = cy.resume(path, model=own)
        assert np.array_equal(opened["other"].position, whole["other"].position)


@pytest.mark.parametrize("chunk", [3_000, 2**22])
def test_some_parts_of_a_run_stopped_within_a_call_go_on(tmp_path, monkeypatch, chunk):
    """Its last frames have no memory of the step before; it goes on from the last one that has."""
    monkeypatch.setattr(arrays, "CHUNK_BYTES", chunk)
    own, calls, receive = model(jointed=True), [], Record.receive
    options = {"rule": cy.rules.midpoint, "dt": 1e-4, "t_end": 0.1, "save_every": 1e-3}
    whole = cy.simulate(own, **options)

    def stopped(self, *given, **more):
        receive(self, *given, **more)
        calls.append(len(self._blocks))
        if len(calls) == 3:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Record, "receive", stopped)
        with pytest.raises(cy.Interrupted) as caught:
            cy.simulate(own, store=tmp_path / "run.zarr", save_only=["other"], **options)
    assert 1 < len(caught.value.partial.time) < len(whole.time)
    run = cy.resume(tmp_path / "run.zarr", model=own)
    assert np.array_equal(run["other"].position, whole["other"].position)
    assert np.array_equal(run.energy, whole.energy)


def test_what_can_not_be_saved_alone_is_refused():
    own = model()
    with pytest.raises(ValueError, match="save_only wants a store"):
        cy.simulate(own, t_end=0.01, save_only=["rod"])
    with pytest.raises(ValueError, match=r"save_only has 'mast'; give parts of the model \(rod\)"):
        cy.simulate(own, t_end=0.01, save_only=["mast"], store="never.zarr")
