"""A million steps of a rod in free flight: momenta, unit length, energy."""

import numpy as np
import pytest

import cayley as cy
from verify.problems import bend, fitted, in_flight, thick_rod

STEPS, SAVES, DT = 1_000_000, 1000, 5e-5


@pytest.fixture(
    scope="module",
    params=[(rule, form) for rule in (cy.rules.nodal, cy.rules.verlet) for form in ("quaternion", "matrix")],
    ids=lambda p: f"{p[0]}-{p[1]}",
)
def flight(request):
    """A rubber rod of 15 elements, bent, thrown and spinning, for 50 s."""
    rule, form = request.param
    rod, model = thick_rod(15, clamped=False)
    start = in_flight(rod, bend(rod, 1.5), velocity=(0.3, -0.2, 0.5), spin=(1.0, 5.0, -8.0))
    t_end = STEPS * DT
    return cy.simulate(model, t_end, DT, rule=rule, save_every=t_end / SAVES, initial={rod: start}, rotation=form)


def relative(momentum):
    return np.abs(momentum - momentum[0]).max(axis=1) / np.linalg.norm(momentum[0])


def test_all_six_momenta_are_kept(flight):
    """Noether: to round-off, for 1e5 steps and for 1e6."""
    linear, angular = flight.linear_momentum.values, flight.angular_momentum.values
    assert np.abs(linear[0]).min() > 0.1
    assert np.abs(angular[0]).min() > 0.1
    assert flight.steps == STEPS
    early = flight.frames.steps <= 100_000
    assert max(relative(linear)[early].max(), relative(angular)[early].max()) < 1e-12
    assert relative(linear).max() < 1e-12
    assert (
        relative(angular).max() < 3e-11
    )  # about the origin, which the rod leaves: round-off times distance, like t^1.5


def test_rotations_stay_rotations_and_errors_grow_like_a_random_walk(flight):
    """‖p‖ = 1 and RᵀR = 1 without any constraint; Brouwer's law √n for the mean over the nodes."""
    size = flight.system.layout
    rows = flight.frames.values[..., size.rows_of("p")]
    if size.representation.name == "quaternion":
        error = np.abs(np.linalg.norm(rows, axis=-1) - 1.0)
    else:
        matrix = rows.reshape(*rows.shape[:-1], 3, 3)
        error = np.abs(matrix.swapaxes(-1, -2) @ matrix - np.eye(3)).max(axis=(-1, -2))
    assert error.max() < 1e-12
    seen = np.unique(np.geomspace(1, SAVES, 40).astype(int))
    exponent = fitted(flight.frames.steps[seen], np.sqrt((error[seen] ** 2).mean(axis=1)))
    assert 0.25 < exponent < 0.75, exponent


def test_energy_does_not_drift(flight):
    """A straight line through the energy of 50 s rises by less than a twentieth of its ripple."""
    energy = flight.energy.values
    ripple = np.ptp(energy)
    assert ripple < 1e-4 * energy[0]
    assert abs(np.polyfit(flight.time, energy, 1)[0] * flight.time[-1]) < 0.05 * ripple
    assert np.ptp(energy[: SAVES // 10]) > 0.5 * ripple  # a tenth of the run has already shown it
