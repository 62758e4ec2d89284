"""Series and closed forms against 50-digit arithmetic, on a log grid across every switch."""

import mpmath as mp
import numpy as np
import pytest

from cayley.lie import exponential, quaternion, rotation, series

mp.mp.dps = 50
EXACT = {
    "cosine": lambda t: mp.cos(mp.sqrt(t) / 2),
    "sine_ratio": lambda t: mp.sin(mp.sqrt(t) / 2) / mp.sqrt(t),
    "third_ratio": lambda t: (mp.sqrt(t) - mp.sin(mp.sqrt(t))) / mp.sqrt(t) ** 3,
    "cotangent_ratio": lambda t: (1 - mp.sqrt(t) / 2 * mp.cot(mp.sqrt(t) / 2)) / t,
    "arctan_ratio": lambda u: mp.atan(mp.sqrt(u)) / mp.sqrt(u),
}


def beside(x):
    """Return x with its neighbors among the floats, and points a little farther."""
    return [x * (1 - 1e-3), np.nextafter(x, 0), x, np.nextafter(x, 10), x * (1 + 1e-3)]


GRID = np.array(
    [*np.geomspace(1e-12, np.pi, 400), *beside(np.sqrt(series.NEAR)), *beside(np.sqrt(series.NEAR_TANGENT)), 0.5, 1.0]
)


@pytest.mark.parametrize("name", EXACT)
def test_relative_error_on_a_log_grid(name):
    t = GRID**2
    exact = [EXACT[name](mp.mpf(float(x))) for x in t]
    scale = [mp.mpf(1) if name == "cosine" else e for e in exact]
    values = getattr(series, name)(t)
    error = [float(abs((mp.mpf(float(v)) - e) / s)) for v, e, s in zip(values, exact, scale, strict=True)]
    assert max(error) < 1e-15


@pytest.mark.parametrize(
    ("name", "limit"),
    [(n, series.NEAR_TANGENT if n == "arctan_ratio" else series.NEAR) for n in EXACT],
)
def test_both_sides_agree_at_the_switch(name, limit):
    below, above = (getattr(series, name)(np.array([x])) for x in (np.nextafter(limit, 0), limit))
    assert below == pytest.approx(above, rel=1e-15)


@pytest.mark.parametrize(
    ("name", "value"),
    [("cosine", 1), ("sine_ratio", 1 / 2), ("third_ratio", 1 / 6), ("cotangent_ratio", 1 / 12), ("arctan_ratio", 1)],
)
@pytest.mark.parametrize("t", [0.0, 5e-324, 1e-300, 1e-30])
def test_limit_at_zero(name, value, t):
    assert getattr(series, name)(np.array([t]))[0] == pytest.approx(value, rel=2e-16)


def _exact_matrix(coefficients, eta):
    """Return I + a hat(η) + b hat(η)² in 50 digits, for functions a, b of θ."""
    x, y, z = (mp.mpf(float(e)) for e in eta)
    skew = mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = mp.sqrt(x * x + y * y + z * z)
    a, b = (f(angle) for f in coefficients)
    return mp.eye(3) + a * skew + b * skew * skew


MATRICES = {
    "dexp": (exponential.dexp, lambda a: -(1 - mp.cos(a)) / a**2, lambda a: (a - mp.sin(a)) / a**3),
    "dexp_inv": (exponential.dexp_inv, lambda a: mp.mpf(1) / 2, lambda a: (1 - a / 2 * mp.cot(a / 2)) / a**2),
    "exp": (rotation.exp, lambda a: mp.sin(a) / a, lambda a: (1 - mp.cos(a)) / a**2),
}


@pytest.mark.parametrize("name", MATRICES)
def test_matrices_on_a_log_grid(name, rng):
    """Check every entry relative to itself, or to the angle where terms of both signs meet."""
    function, *coefficients = MATRICES[name]
    axes = rng.normal(size=(GRID.size, 3))
    eta = GRID[:, None] * axes / np.linalg.norm(axes, axis=-1, keepdims=True)
    for value, vector in zip(function(eta), eta, strict=True):
        exact = _exact_matrix(coefficients, vector)
        for i in range(3):
            for k in range(3):
                error = float(abs(mp.mpf(float(value[i, k])) - exact[i, k]))
                assert error <= 1e-15 * max(abs(float(exact[i, k])), min(np.linalg.norm(vector), 1.0))


@pytest.mark.parametrize(
    ("exp", "log"),
    [(exponential.exp, exponential.log), (rotation.exp, rotation.log), (quaternion.from_rotation_vector, None)],
)
def test_log_undoes_exp_on_a_log_grid(exp, log, rng):
    log = log or quaternion.to_rotation_vector
    axes = rng.normal(size=(GRID.size, 3))
    eta = (GRID * (1 - 1e-15))[:, None] * axes / np.linalg.norm(axes, axis=-1, keepdims=True)
    back = log(exp(eta))
    half_turn = np.sum(back * eta, axis=-1) < 0
    assert np.all(np.linalg.norm(eta[half_turn], axis=-1) > np.pi - 1e-14)
    back[half_turn] *= -1
    error = np.linalg.norm(back - eta, axis=-1) / np.linalg.norm(eta, axis=-1)
    assert error.max() < 1e-15


@pytest.mark.parametrize("gap", [0.0, 1e-15, 1e-12, 1e-8, 1e-4])
def test_matrix_log_up_to_half_turns(gap, rng):
    axes = np.vstack([np.eye(3), -np.eye(3), rng.normal(size=(20, 3))])
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    angle = np.pi - gap
    back = rotation.log(rotation.exp(angle * axes))
    assert np.linalg.norm(back, axis=-1) == pytest.approx(angle, abs=2e-15)
    distance = np.minimum(
        np.linalg.norm(back - angle * axes, axis=-1),
        np.linalg.norm(back + angle * axes, axis=-1) if gap < 1e-14 else np.inf,
    )
    assert distance.max() < 4e-15


def test_defect_of_the_inverse_tangent():
    """Without a switch: one formula from zero to a turn of π, where tan(θ/4) = 1."""
    u = np.array([0.0, *np.geomspace(1e-30, 1.0, 400)])
    with mp.workdps(100):
        exact = [mp.mpf(1) / 3, *((1 - mp.atan(mp.sqrt(x)) / mp.sqrt(x)) / x for x in map(mp.mpf, u[1:].tolist()))]
        error = [
            abs(float(v / e - 1)) for v, e in zip(map(mp.mpf, series.arctan_defect(u).tolist()), exact, strict=True)
        ]
    assert max(error) < 1e-15
