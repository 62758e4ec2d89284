"""Modes in motion: far enough to be seen, joints kept, nothing torn."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cayley import modes
from cayley.lie import quaternion
from cayley.report.swing import SHOWN, TURN, swing
from unit.test_vibration import frame, oscillator


@pytest.fixture(scope="module")
def found():
    return modes(frame(), count=6)


@pytest.mark.parametrize("k", range(6))
def test_a_mode_swings_as_far_as_is_seen_well(found, k):
    """Joints hold, elements keep their lengths, turns are moderate."""
    run, rest = swing(found, k, 4), found.about
    assert run.time[-1] == pytest.approx(1.0 / float(found.frequency[k]) if k else 1.0)
    eye, arm = run.port("bob", "eye").position.values, run["arm"].position.values
    assert_allclose(eye, arm[:, -1], atol=1e-10)
    for name in ("mast", "arm"):
        lengths = np.linalg.norm(np.diff(run[name].position.values, axis=1), axis=-1)
        before = np.linalg.norm(np.diff(rest[name].position.values, axis=0), axis=-1)
        assert np.abs(lengths / before - 1.0).max() < 0.04
    moves = max(np.abs(run[p].position - rest[p].position).values.max() for p in ("mast", "arm", "bob"))
    turn = quaternion.to_rotation_vector(quaternion.relative(rest["bob"].rotation.values, run["bob"].rotation.values))
    turns = np.linalg.norm(turn, axis=-1).max()
    assert turns < 1.1 * TURN
    assert moves < 1.1 * SHOWN * 2.1
    assert moves > 0.8 * SHOWN * 2.0 or turns > 0.8 * TURN


def test_a_mode_of_a_turning_frame_goes_around():
    """Complex shapes pass through other places on the way back: half a period later, the opposite side."""
    found = modes(oscillator(), count=6, spin=(0, 0, 0.5))
    assert np.iscomplexobj(found.pairs.vectors)
    k = next(k for k in range(6) if found.sizes(k)[0] > 0.0)
    away = swing(found, k, 8)["mass"].position.values - found.about["mass"].position.values
    assert_allclose(away[:4], -away[4:8], atol=1e-12)
    assert np.linalg.norm(away[2]) > 0.3 * np.linalg.norm(away[0]) > 0.0
    assert_allclose(away[8], away[0], atol=1e-12)
