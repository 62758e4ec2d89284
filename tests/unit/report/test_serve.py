"""The server of `cayley view`, asked as a browser would."""

import urllib.error
import urllib.request

import pytest
from numpy.testing import assert_array_equal

import cayley as cy
from cayley.report.serve import Source, server
from unit.report.growing import first_frames, serving


def ask(address):
    try:
        with urllib.request.urlopen(address, timeout=10) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read()


def test_answers(crane, tmp_path):
    crane.save(tmp_path / "run.zarr")
    with serving(tmp_path / "run.zarr", title="Crane & <Co>", scenario_text="[run]") as address:
        status, page = ask(address)
        assert status == 200
        assert "Crane &amp; &lt;Co&gt;" in page.decode()
        assert '"live":true' in page.decode()
        assert b"[run]" in page
        assert ask(f"{address}frames?scene=0&from=0")[1][:2] == b"\x1f\x8b"
        assert ask(f"{address}frames?scene=0&from=51")[0] == 204
        assert ask(f"{address}frames?scene=0&from=52")[0] == 205
        assert ask(f"{address}frames?from=x")[0] == 400
        assert ask(f"{address}other")[0] == 404


def test_follows_a_run_in_progress(crane, tmp_path):
    store = tmp_path / "run.zarr"
    first_frames(crane, 20).save(store)
    with serving(store) as address:
        assert ask(f"{address}frames?from=20")[0] == 204
        (store / "zarr.json").rename(store / "away")  # half written: what is known stays
        assert ask(f"{address}frames?from=20")[0] == 204
        (store / "away").rename(store / "zarr.json")
        first_frames(crane, 35).save(store, overwrite=True)
        assert ask(f"{address}frames?from=20")[0] == 200
        assert ask(f"{address}frames?from=35")[0] == 204


@pytest.mark.parametrize("only", [None, ["mast"]], ids=["all parts", "one part"])
def test_follows_while_the_run_writes(crane, tmp_path, only):
    """Frames come out while simulate goes on, and at the end all of them, with the numbers of the run."""
    store, seen, sources = tmp_path / "run.zarr", [], []

    def look(fraction, time):
        if fraction > 0.0:
            sources.append(sources[0] if sources else Source(store))
            seen.append(len(sources[0].scene().time))

    options = {"save_every": 0.02, "balance": True, "save_only": only}
    run = cy.simulate(crane.model, t_end=1.0, **options, store=store, progress=look)
    assert 1 < seen[0] < seen[-1]
    assert seen == sorted(seen)
    last = sources[0].scene()
    assert_array_equal(last.time, run.time)
    assert_array_equal(last.parts[0].quantities["moment"].values, run["mast"].moment)


def test_nothing_there(tmp_path):
    with pytest.raises(FileNotFoundError, match="there is no run"):
        server(tmp_path / "none.zarr")
