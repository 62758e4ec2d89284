"""What is drawn, looked up in the figures' own data."""

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import LineCollection

import cayley as cy
from cayley.report import figures
from cayley.report.snapshots import nearest_frames


def lines(axes):
    return {line.get_label(): line.get_xydata() for line in axes.lines}


def test_loads_are_shaded(run):
    for figure, count in ((figures.energy(run), 1), (figures.momenta(run), 2)):
        assert [len(axes.patches) for axes in figure.axes] == [1] * count  # the time in which the torque acts
        assert figure.axes[-1].get_xlabel() == "time [s]"


def test_resultants(run):
    grid = np.array(figures.resultants(run, "rod", [0, 5, 11]).axes).reshape(3, 2)
    assert grid[1, 0].get_ylabel() == r"$\sigma$ at node 5 [N]"
    assert grid[2, 1].get_ylabel() == r"$\Sigma$ at node 11 [N m]"
    np.testing.assert_array_equal(lines(grid[1, 0])[r"$\sigma_2$"][:, 1], run["rod"].sigma[:, 5, 1].values)
    assert grid[2, 0].get_ylim() == (-1.0, 1.0)  # a free end: zero, at the scale of the others


def test_resultants_as_impulses(run):
    axes = figures.resultants(run, run.model.rods[0], impulse=True).axes
    assert [a.get_ylabel() for a in axes[:2]] == [r"$\sigma$ at node 0 [N s]", r"$\Sigma$ at node 0 [N m s]"]
    np.testing.assert_allclose(lines(axes[0])[r"$\sigma_1$"][0, 1], 1e-3)


def test_default_nodes():
    assert figures.default_nodes(11) == (0, 5, 11)
    assert figures.default_nodes(1) == (0, 1)


def test_deformed():
    """One panel without a time: the reference as lines over which the rods are drawn."""
    material = cy.Material(density=1000.0, youngs_modulus=1e7, poisson_ratio=0.3)
    rod = cy.Rod(cy.Section.circle(0.01, material), length=1.0, elements=4, direction=(1, 0, 0))
    gravity = cy.loads.gravity((0, 0, -9.81))
    rest = cy.equilibrium(cy.Model(rod, supports=[cy.supports.clamp(rod.start)], loads=[gravity]))
    panel, bar = figures.deformed(rest).axes
    assert panel.get_title() == ""
    reference = lines(panel)["reference"]
    np.testing.assert_allclose(np.diff(reference, 2, axis=0), 0.0, atol=1e-12)  # straight, of equal elements
    assert len(reference) == 5
    colored = [c for c in panel.collections if c.get_array() is not None]
    assert colored[0].get_array().max() == pytest.approx(np.linalg.norm(rest[rod].moment.values[0]), rel=0.1)
    assert bar.get_ylabel() == "moment ‖Σ‖ [N m]"


def test_snapshots(run):
    *panels, bar = figures.snapshots(run, times=[0.0, 0.3, 0.6, 0.9]).axes
    assert [axes.get_title() for axes in panels] == ["$t$ = 0 s", "$t$ = 0.3 s", "$t$ = 0.6 s", "$t$ = 0.9 s"]
    colored = [
        c for axes in panels for c in axes.collections if isinstance(c, LineCollection) and c.get_array() is not None
    ]
    assert len(colored) == 4
    assert {c.norm for c in colored} == {colored[0].norm}  # one color bar is right for all
    moment = np.linalg.norm(run["rod"].moment.sel(time=[0.0, 0.3, 0.6, 0.9], method="nearest"), axis=-1)
    assert colored[0].norm.vmax == pytest.approx(moment.max())
    assert bar.get_ylabel() == "moment ‖Σ‖ [N m]"


def test_snapshots_have_one_scale(make_run):
    figure = figures.snapshots(make_run(count=2))
    scales = []
    for axes in figure.axes[:4]:
        box = axes.get_position()
        width, height = box.width * figure.get_figwidth(), box.height * figure.get_figheight()
        scales += [width / np.ptp(axes.get_xlim()), height / np.ptp(axes.get_ylim())]
    np.testing.assert_allclose(scales, scales[0])


def test_nearest_frames():
    time = np.linspace(0.0, 1.0, 11)
    assert nearest_frames(time, [0.0, 0.31, 0.28, 5.0]) == [0, 3, 10]
    assert nearest_frames(time, None) == [0, 3, 7, 10]


def test_long_runs_are_thinned_to_their_envelope():
    values = np.sin(np.arange(100_000.0))
    values[54_321] = 7.0
    shown = figures.thinned(values)
    assert len(shown) <= 1502
    assert shown[0] == 0
    assert shown[-1] == 99_999
    assert values[shown].max() == 7.0
    assert np.all(np.diff(shown) > 0)


def test_settings_of_the_user_stay(run):
    with mpl.rc_context({"font.size": 17.0, "axes.grid": False}):
        figures.energy(run)
        assert mpl.rcParams["font.size"] == 17.0
        assert not mpl.rcParams["axes.grid"]
