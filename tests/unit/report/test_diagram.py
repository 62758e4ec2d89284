"""The bifurcation diagram, looked up in the figure's own data."""

import numpy as np
import pytest

import cayley as cy
from cayley import loads, supports
from cayley.report import figures


@pytest.fixture(scope="module")
def paths():
    stiffness = np.diag([1e3, 1e3, 1e3, 2.0, 1.0, 1.0])
    section = cy.Section.given(stiffness=stiffness, mass_per_length=1.0, inertia=np.diag([1e-3, 1e-3, 2e-3]))
    rod = cy.Rod(section, length=1.0, direction=(0, 0, 1), elements=4, name="rod")
    load = loads.force(rod.end, (0, 0, -1.0))
    model = cy.Model(rod, supports=[supports.clamp(rod.start)], loads=[load])
    straight = cy.trace(model, load, range=(0.0, 4.0), step=0.2)
    return rod, straight, straight.branch(points=6)


def drawn(figure):
    """Lines with what they look like, without those of the legend."""
    return [line for line in figure.axes[0].lines if len(line.get_xdata())]


def test_lines_are_solid_where_stable_and_points_are_marked(paths):
    rod, straight, bent = paths
    figure = figures.branches([straight, bent], (rod.end, "x"))
    below, above, branch, mark = drawn(figure)
    critical = straight.bifurcations[0]
    assert [line.get_linestyle() for line in (below, above, branch)] == ["-", "--", "-"]
    assert below.get_ydata()[-1] == above.get_ydata()[0] == critical.parameter
    assert np.array_equal(branch.get_ydata(), bent.parameter)
    shift = bent[rod].position.sel(axis="x").isel(node=-1).values
    assert branch.get_xdata() == pytest.approx(shift, abs=1e-12)
    assert mark.get_xydata() == pytest.approx(np.array([[0.0, critical.parameter]]), abs=1e-12)
    axes = figure.axes[0]
    assert axes.get_xlabel() == "displacement of rod.end along x [m]"
    assert axes.get_ylabel() == "load factor"
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["bifurcation point", "stable", "unstable"]


def test_other_quantities(paths):
    _, straight, bent = paths
    largest = drawn(figures.branches([straight, bent]))[2].get_xdata()
    place = bent["rod"].position.values - straight["rod"].position.values[0]
    assert largest == pytest.approx(np.linalg.norm(place, axis=-1).max(axis=1), abs=1e-12)
    figure = figures.branches(bent, lambda path: path["rod"].moment.values[:, 0, 1], label="moment [N m]")
    assert figure.axes[0].get_xlabel() == "moment [N m]"
    assert drawn(figure)[0].get_xdata() == pytest.approx(bent["rod"].moment.values[:, 0, 1])


def test_what_cannot_be_drawn_is_refused(paths):
    rod, straight, _ = paths
    with pytest.raises(ValueError, match="paths is empty"):
        figures.branches([])
    with pytest.raises(ValueError, match="quantity is 'x'; give"):
        figures.branches(straight, "x")
    with pytest.raises(ValueError, match="quantity is of a rod; give one of its ports"):
        figures.branches(straight, (rod, "x"))
    with pytest.raises(ValueError, match=r"quantity returns shape \(2,\)"):
        figures.branches(straight, lambda path: [1.0, 2.0])
